#include "brink/scheduler/islands/step_balance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "brink/scheduler/islands/tolerances.h"

namespace brink {

double contact_impulse(const Vec3& mass, const Vec3& force, const Vec3& before, const Vec3& after, double h) {
  const double gyration = std::isinf(mass[2]) || std::isinf(mass[0]) ? 0.0 : std::sqrt(mass[2] / mass[0]);
  double square = 0.0;
  for (int k = 0; k < 3; ++k) {
    if (std::isinf(mass[k])) continue;
    const double given = mass[k] * (after[k] - before[k]) - h * force[k];
    if (k < 2) square += given * given;
    if (k == 2 && gyration > 0.0) square += given * given / (gyration * gyration);
  }
  return std::sqrt(square);
}

StepBalance::StepBalance(const IslandStep& step, double h, std::vector<PushingContact> contacts,
                         const std::vector<Vec3>& velocity)
    : step_(&step), h_(h), contacts_(std::move(contacts)), line_(line_of_pushes(velocity)) {
  std::vector<double> impulse;
  double largest = 0.0;
  for (std::size_t i = 0; i < step.mass.size(); ++i) {
    impulse.push_back(contact_impulse(step.mass[i], step.force[i], step.velocity[i], velocity[i], h));
    largest = std::max(largest, impulse.back());
  }
  for (const double p : impulse) pushed_.push_back(p > kOnePush * largest);
}

/// The direction in which sites push (unit), by all but roundings of the momentum that there is; 0: none does. Nothing where they push
/// along more than one line, or hold somebody. What is squeezed between sites is pushed much harder than anything moves it.
std::optional<Vec2> StepBalance::line_of_pushes(const std::vector<Vec3>& velocity) const {
  double momentum = 0.0;
  for (std::size_t i = 0; i < step_->mass.size(); ++i) {
    const Vec3& mass = step_->mass[i];
    if (std::isinf(mass.x()) || std::isinf(mass.y())) return std::nullopt;
    momentum += mass.x() * velocity[i].head<2>().norm() + h_ * step_->force[i].head<2>().norm();
  }
  std::vector<Vec2> pushes;
  Vec2 largest = Vec2::Zero();
  for (const PushingContact& c : contacts_) {
    const LastingContact& rows = step_->contacts[c.contact].rows;
    if (rows.other >= 0) continue;
    const Vec3 push = c.load.normal * rows.normal_on_body + c.load.tangential * rows.tangent_on_body;
    pushes.emplace_back(push.head<2>());
    if (pushes.back().norm() > largest.norm()) largest = pushes.back();
  }
  if (largest.isZero(0.0)) return Vec2(Vec2::Zero());
  const Vec2 along = largest.normalized();
  const bool one = std::all_of(pushes.begin(), pushes.end(), [&](const Vec2& push) {
    return std::abs(cross(along, push)) <= kOnePush * std::min(momentum, largest.norm());
  });
  return one ? std::optional<Vec2>(along) : std::nullopt;
}

Vec2 StepBalance::common_velocity(const std::vector<Vec3>& velocity) const {
  return line_ ? common_across(velocity, *line_) : Vec2(Vec2::Zero());
}

Vec2 StepBalance::common_across(const std::vector<Vec3>& velocity, const Vec2& line) const {
  Vec2 momentum = Vec2::Zero();
  double mass = 0.0;
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    if (!pushed_[i]) continue;
    mass += step_->mass[i].x();
    momentum += step_->mass[i].x() * velocity[i].head<2>();
  }
  const Vec2 common = mass > 0.0 ? Vec2(momentum / mass) : Vec2(Vec2::Zero());
  return common - line.dot(common) * line;
}

void StepBalance::keep_momentum(double tolerance, std::vector<Vec3>& velocity) const {
  if (!line_) return;
  std::vector<Vec3> without = step_->velocity;
  for (std::size_t i = 0; i < without.size(); ++i)
    without[i] += h_ * step_->force[i].cwiseQuotient(step_->mass[i]);
  const Vec2 lost = common_across(without, *line_) - common_across(velocity, *line_);
  double speed = 0.0;
  for (const Vec3& v : velocity) speed = std::max(speed, v.head<2>().norm());
  const bool alone = std::all_of(step_->contacts.begin(), step_->contacts.end(), [&](const IslandContact& c) {
    return c.rows.other >= 0 && pushed_[c.rows.body] == pushed_[c.rows.other];
  });
  // more is none of the solver's digits, and gaps with others have been looked at
  if (lost.norm() > (alone ? kResidual * speed : kMissCounts * tolerance / h_)) return;
  for (std::size_t i = 0; i < velocity.size(); ++i)
    if (pushed_[i]) velocity[i].head<2>() += lost;
}

double StepBalance::won(const std::vector<Vec3>& velocity, double tolerance, double& of) const {
  double change = 0.0;
  for (std::size_t i = 0; i < velocity.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double mass = step_->mass[i][k], force = step_->force[i][k];
      if (!pushed_[i] || std::isinf(mass)) continue;
      // Kinetic energy as m (after - before) (after + before) / 2, without the cancellation of two
      // squares. The work of a force is h f . after, as the step goes with the twist of its end.
      const double before = step_->velocity[i][k], after = velocity[i][k];
      change += 0.5 * mass * (after - before) * (after + before) - h_ * force * after;
      // The last term is what the force alone makes of a body at rest: a step from rest is measured by
      // that. The tolerance stands for the way by which gaps may be off.
      of += 0.5 * mass * (before * before + after * after) +
            std::abs(force) * (std::abs(h_ * after) + (k < 2 ? tolerance : 0.0)) +
            h_ * h_ * force * force / mass;
    }
  for (const PushingContact& pushing : contacts_) {
    const IslandContact& c = step_->contacts[pushing.contact];
    // A contact that pushes has J_n w = support + (lift - gap) / h. The support's part and the lift are
    // work of the site; the gap's part is a loss of the bodies and stays in the sum.
    if (c.driven)
      change -= pushing.load.normal * (c.normal_support + pushing.lift / h_) +
                pushing.load.tangential * c.tangential_support;
  }
  return change;
}

double StepBalance::rise_of_thin() const {
  double rise = 0.0;
  for (const PushingContact& pushing : contacts_) {
    const IslandContact& c = step_->contacts[pushing.contact];
    if (c.thin && pushing.lift > 0.0)
      rise += pushing.load.normal / h_ * std::min(pushing.lift, c.tolerance - std::min(c.gap, 0.0));
  }
  return rise;
}

void StepBalance::win_nothing(const Vec2& common, std::vector<Vec3>& velocity) const {
  const Vec3 together(common.x(), common.y(), 0.0);
  double before = 2.0 * rise_of_thin(), after = 0.0, work = 0.0;  // twice the kinetic energies [J]
  for (std::size_t i = 0; i < velocity.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double mass = step_->mass[i][k], force = step_->force[i][k], was = step_->velocity[i][k];
      if (!pushed_[i] || std::isinf(mass)) continue;
      const double apart = velocity[i][k] - together[k];
      before += mass * (was + together[k]) * (was - together[k]) + 2.0 * h_ * force * together[k];
      after += mass * apart * apart;
      work += h_ * force * apart;
    }
  // At s times these velocities the kinetic energy less the work, which has s times the way, is what it was:
  // after s^2 / 2 - work s - before / 2 = 0
  const double root = work * work + after * before;
  if (!(after > 0.0) || !(root >= 0.0)) return;
  const double slower = std::min(1.0, (work + std::sqrt(root)) / after);
  for (std::size_t i = 0; i < velocity.size(); ++i)
    if (pushed_[i]) velocity[i] = together + slower * (velocity[i] - together);
}

}  // namespace brink
