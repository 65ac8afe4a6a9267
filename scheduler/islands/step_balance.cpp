#include "brink/scheduler/islands/step_balance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "brink/core/base/disjoint_sets.h"
#include "brink/scheduler/islands/tolerances.h"

namespace brink {

namespace {

/// A gap that stays larger than so many times the way that is added to it is not missed by that.
constexpr double kFarOff = 100.0;

}  // namespace

double contact_impulse(const Vec3& mass, const Vec3& force, const Vec3& before, const Vec3& after, double h,
                       double arm) {
  const double moves = std::min(mass[0], mass[1]),
               gyration = std::isinf(moves) ? arm : std::sqrt(mass[2] / moves);
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
    : step_(&step), h_(h), contacts_(std::move(contacts)) {
  find_groups(velocity);
  int groups = 0;
  for (const int g : group_) groups = std::max(groups, g + 1);
  for (int g = 0; g < groups; ++g) lines_.push_back(line_of_pushes(g, velocity));
}

/// Two who are pushed are of one group where a contact between them pushes; what lies on one site is not, for that. Who are joined by
/// springs are of one in any case: what they win they win together.
void StepBalance::find_groups(const std::vector<Vec3>& velocity) {
  const std::size_t bodies = step_->mass.size();
  std::vector<double> impulse, arm(bodies, 0.0);
  double largest = 0.0;
  const auto reaches = [&](int body, const Vec3& normal, const Vec3& tangent) {
    arm[body] = std::max(arm[body], Vec2(normal[2], tangent[2]).norm());
  };
  for (const PushingContact& c : contacts_) {
    const LastingContact& rows = step_->contacts[c.contact].rows;
    reaches(rows.body, rows.normal_on_body, rows.tangent_on_body);
    if (rows.other >= 0) reaches(rows.other, rows.normal_on_other, rows.tangent_on_other);
  }
  for (std::size_t i = 0; i < bodies; ++i) {
    impulse.push_back(
        contact_impulse(step_->mass[i], step_->force[i], step_->velocity[i], velocity[i], h_, arm[i]));
    largest = std::max(largest, impulse.back());
  }
  const auto is_pushed = [&](int k) { return impulse[k] > kOnePush * largest; };
  DisjointSets together;
  together.reset(static_cast<int>(bodies));
  for (const PushingContact& c : contacts_) {
    const LastingContact& rows = step_->contacts[c.contact].rows;
    const double push = std::max(c.load.normal, std::abs(c.load.tangential));
    if (rows.other >= 0 && push > kOnePush * largest && is_pushed(rows.body) && is_pushed(rows.other))
      together.unite(rows.body, rows.other);
  }
  std::vector<bool> joined(bodies, false);
  for (std::size_t i = 0; i < step_->joined_to.size(); ++i) {
    const int first = step_->joined_to[i];
    if (first == static_cast<int>(i)) continue;
    together.unite(first, static_cast<int>(i));
    joined[first] = joined[i] = true;
  }
  group_.assign(bodies, -1);
  int groups = 0;
  for (int i = 0; i < static_cast<int>(bodies); ++i) {
    if ((!is_pushed(i) && !joined[i]) || group_[i] >= 0) continue;
    for (const int k : together.of(i)) group_[k] = groups;
    ++groups;
  }
}

/// The greater number is left without members.
void StepBalance::unite(int body, int other, const std::vector<Vec3>& velocity) {
  const int a = group_[body], b = group_[other], to = a < 0 || (b >= 0 && b < a) ? b : a;
  for (int k = 0; k < static_cast<int>(group_.size()); ++k)
    if (k == body || k == other || (group_[k] >= 0 && (group_[k] == a || group_[k] == b))) group_[k] = to;
  lines_[to] = line_of_pushes(to, velocity);
}

/// The direction in which sites push the group, or hold somebody of it (unit), by all but roundings of the momentum that there is; 0:
/// none does. Nothing where that is more than one line. What is squeezed between sites is pushed much harder than anything moves it.
std::optional<Vec2> StepBalance::line_of_pushes(int group, const std::vector<Vec3>& velocity) const {
  double momentum = 0.0;
  bool held_x = false, held_y = false;
  for (std::size_t i = 0; i < step_->mass.size(); ++i) {
    if (group_[i] != group) continue;
    const Vec3& mass = step_->mass[i];
    held_x = held_x || std::isinf(mass.x());
    held_y = held_y || std::isinf(mass.y());
    if (held_x && held_y) return std::nullopt;
    momentum +=
        std::min(mass.x(), mass.y()) * velocity[i].head<2>().norm() + h_ * step_->force[i].head<2>().norm();
  }
  std::vector<Vec2> pushes;
  Vec2 largest = Vec2::Zero();
  for (const PushingContact& c : contacts_) {
    const LastingContact& rows = step_->contacts[c.contact].rows;
    if (rows.other >= 0 || group_[rows.body] != group) continue;
    const Vec3 push = c.load.normal * rows.normal_on_body + c.load.tangential * rows.tangent_on_body;
    pushes.emplace_back(push.head<2>());
    if (pushes.back().norm() > largest.norm()) largest = pushes.back();
  }
  const bool is_held = held_x || held_y;
  if (largest.isZero(0.0) && !is_held) return Vec2(Vec2::Zero());
  const Vec2 along = held_x ? Vec2(Vec2::UnitX()) : held_y ? Vec2(Vec2::UnitY()) : Vec2(largest.normalized());
  const bool one = std::all_of(pushes.begin(), pushes.end(), [&](const Vec2& push) {
    return std::abs(cross(along, push)) <= kOnePush * std::min(momentum, largest.norm());
  });
  return one ? std::optional<Vec2>(along) : std::nullopt;
}

Vec2 StepBalance::common_velocity(int group, const std::vector<Vec3>& velocity) const {
  return lines_[group] ? common_across(group, velocity, *lines_[group]) : Vec2(Vec2::Zero());
}

Vec2 StepBalance::common_across(int group, const std::vector<Vec3>& velocity, const Vec2& line) const {
  Vec2 common = Vec2::Zero();
  for (int k = 0; k < 2; ++k) {
    double mass = 0.0, momentum = 0.0;
    for (std::size_t i = 0; i < velocity.size(); ++i) {
      // what is held along one axis goes with the others along the other
      if (group_[i] != group || std::isinf(step_->mass[i][k])) continue;
      mass += step_->mass[i][k];
      momentum += step_->mass[i][k] * velocity[i][k];
    }
    if (mass > 0.0) common[k] = momentum / mass;
  }
  return common - line.dot(common) * line;
}

/// True if the contact's gap may be missed by more than counts where all of the group go faster by so much [m/s].
bool StepBalance::misses(const IslandContact& c, int group, const Vec2& faster, double tolerance,
                         const std::vector<Vec3>& velocity) const {
  const LastingContact& rows = c.rows;
  const bool body = group_[rows.body] == group, other = rows.other >= 0 && group_[rows.other] == group;
  if (rows.other >= 0 ? body == other : !body) return false;
  // beside an end, and where a site bends, the way along the tangent may change the gap by all of it
  const bool straight = c.convex && !c.at_end;
  const double way = h_ * (straight ? std::abs(faster.dot(rows.normal_on_body.head<2>())) : faster.norm());
  if (way <= kMissCounts * tolerance) return false;
  double opens = rows.normal_on_body.dot(velocity[rows.body]) - c.normal_support;
  if (rows.other >= 0) opens += rows.normal_on_other.dot(velocity[rows.other]);
  return std::min(c.gap, c.gap + h_ * opens) < kFarOff * way;
}

/// What a push too small to make a group has changed is shared by the two.
void StepBalance::keep_momentum(double tolerance, std::vector<Vec3>& velocity) {
  const std::vector<Vec3> as_solved = velocity;
  while (const LastingContact* between = give_back(tolerance, velocity)) {
    unite(between->body, between->other, as_solved);
    velocity = as_solved;
  }
}

/// To each group what it lost. If one would meet another by that: the contact of the two.
const LastingContact* StepBalance::give_back(double tolerance, std::vector<Vec3>& velocity) const {
  std::vector<Vec3> without = step_->velocity;
  for (std::size_t i = 0; i < without.size(); ++i)
    without[i] += h_ * step_->force[i].cwiseQuotient(step_->mass[i]);
  double speed = 0.0;
  for (const Vec3& v : velocity) speed = std::max(speed, v.head<2>().norm());
  for (int g = 0; g < static_cast<int>(lines_.size()); ++g) {
    if (!lines_[g]) continue;
    const Vec2 lost = common_across(g, without, *lines_[g]) - common_across(g, velocity, *lines_[g]);
    // more is none of the solver's digits
    if (lost.norm() > std::max(kResidual * speed, kMissCounts * tolerance / h_)) continue;
    const auto missed =
        std::find_if(step_->contacts.begin(), step_->contacts.end(),
                     [&](const IslandContact& c) { return misses(c, g, lost, tolerance, velocity); });
    if (missed == step_->contacts.end()) {
      for (std::size_t i = 0; i < velocity.size(); ++i)
        if (group_[i] == g) velocity[i].head<2>() += lost;
    } else if (missed->rows.other >= 0 && group_[missed->rows.body] >= 0 && group_[missed->rows.other] >= 0) {
      return &missed->rows;
    }
  }
  return nullptr;
}

double StepBalance::won(const std::vector<Vec3>& velocity, double tolerance, double& of) const {
  double sum = 0.0;
  for (int g = 0; g < static_cast<int>(lines_.size()); ++g) sum += won_by(g, velocity, tolerance, of);
  return sum;
}

double StepBalance::won_by(int group, const std::vector<Vec3>& velocity, double tolerance, double& of) const {
  double change = 0.0;
  for (std::size_t i = 0; i < velocity.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double mass = step_->mass[i][k], force = spending(i)[k];
      if (group_[i] != group || std::isinf(mass)) continue;
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
    // A contact that pushes has J_n w = support + (lift - gap) / h. Of that a site's work is what its point does, as it is one rigid
    // body: two of its faces that squeeze somebody win nothing. The rest is a loss or a gain of the bodies and stays in the sum.
    if (c.driven && group_[c.rows.body] == group)
      change -=
          (pushing.load.normal * c.rows.normal_on_body + pushing.load.tangential * c.rows.tangent_on_body)
              .head<2>()
              .dot(c.site_velocity);
  }
  return change;
}

double StepBalance::rise_of_thin() const {
  double rise = 0.0;
  for (int g = 0; g < static_cast<int>(lines_.size()); ++g) rise += rise_of_thin(g);
  return rise;
}

double StepBalance::rise_of_thin(int group) const {
  double rise = 0.0;
  for (const PushingContact& pushing : contacts_) {
    const IslandContact& c = step_->contacts[pushing.contact];
    if (c.thin && pushing.lift > 0.0 && group_[c.rows.body] == group)
      rise += pushing.load.normal / h_ * std::min(pushing.lift, c.tolerance - std::min(c.gap, 0.0));
  }
  return rise;
}

Vec3 StepBalance::Common::at(const Vec2& place) const {
  const Vec2 there = velocity + cross(omega, Vec2(place - about));
  return {there.x(), there.y(), omega};
}

/// With their turning, where places are known, no site pushes, and nobody is held.
StepBalance::Common StepBalance::common_motion(int group, const std::vector<Vec3>& velocity) const {
  Common common{common_velocity(group, velocity), 0.0, Vec2::Zero()};
  if (step_->place.empty() || !lines_[group] || !lines_[group]->isZero(0.0)) return common;
  double mass = 0.0, inertia = 0.0, angular = 0.0;
  Vec2 moment = Vec2::Zero();
  const auto each = [&](auto&& visit) {
    for (std::size_t i = 0; i < velocity.size(); ++i)
      if (group_[i] == group) visit(step_->mass[i], step_->place[i], velocity[i]);
  };
  each([&](const Vec3& m, const Vec2& at, const Vec3&) { mass += m.x(), moment += m.x() * at; });
  common.about = moment / mass;
  each([&](const Vec3& m, const Vec2& at, const Vec3& v) {
    const Vec2 arm = at - common.about;
    inertia += m.x() * arm.squaredNorm() + m.z();
    angular += m.x() * cross(arm, Vec2(v.head<2>() - common.velocity)) + m.z() * v.z();
  });
  if (inertia > 0.0 && std::isfinite(inertia)) common.omega = angular / inertia;
  return common;
}

StepBalance::Slowed StepBalance::win_nothing(std::vector<Vec3>& velocity, bool keep_turning) const {
  Slowed slowed;
  for (int g = 0; g < static_cast<int>(lines_.size()); ++g) {
    double of = 0.0;
    const double free = rise_of_thin(g);
    const bool won = won_by(g, velocity, 0.0, of) > free;
    const auto is_one = [&](std::size_t i) { return group_[i] == g; };
    Common common = keep_turning ? common_motion(g, velocity) : Common();
    const bool turns = won && common.omega != 0.0 && slow_down(common, free, is_one, velocity);
    common = {common_velocity(g, velocity), 0.0, Vec2::Zero()};
    if (won && !turns) slow_down(common, free, is_one, velocity);
    slowed.groups.push_back(won);
    slowed.common.push_back(common.velocity);
    slowed.turns.push_back(turns);
  }
  return slowed;
}

void StepBalance::win_nothing_together(std::vector<Vec3>& velocity) const {
  slow_down(
      {}, rise_of_thin(), [](std::size_t) { return true; }, velocity);
}

/// Of some bodies, relative to what they have in common; `given` is theirs to keep [J]. False: that cannot be, as what they have in
/// common is more than there was, and nothing has changed.
template <class IsOne>
bool StepBalance::slow_down(const Common& common, double given, IsOne&& is_one,
                            std::vector<Vec3>& velocity) const {
  const auto together = [&](std::size_t i) {
    return common.at(step_->place.empty() ? Vec2(Vec2::Zero()) : step_->place[i]);
  };
  double before = 2.0 * given, after = 0.0, work = 0.0;  // twice the kinetic energies [J]
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    if (!is_one(i)) continue;
    const Vec3 of_all = together(i);
    for (int k = 0; k < 3; ++k) {
      const double mass = step_->mass[i][k], force = spending(i)[k], was = step_->velocity[i][k];
      if (std::isinf(mass)) continue;
      const double apart = velocity[i][k] - of_all[k];
      before += mass * (was + of_all[k]) * (was - of_all[k]) + 2.0 * h_ * force * of_all[k];
      after += mass * apart * apart;
      work += h_ * force * apart;
    }
  }
  // At s times these velocities the kinetic energy less the work, which has s times the way, is what it was:
  // after s^2 / 2 - work s - before / 2 = 0
  const double root = work * work + after * before;
  if (!(after > 0.0) || !(root >= 0.0)) return false;
  // where all have the same velocity `before` and `after` are roundings
  const double slower = (work + std::sqrt(root)) / after;
  if (common.omega != 0.0 && !(slower >= 0.0 && slower <= 1.0)) return false;
  for (std::size_t i = 0; i < velocity.size(); ++i)
    if (is_one(i)) {
      const Vec3 of_all = together(i);
      velocity[i] = of_all + std::clamp(slower, 0.0, 1.0) * (velocity[i] - of_all);
    }
  return true;
}

}  // namespace brink
