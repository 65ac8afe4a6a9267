#include "brink/scheduler/kernel/site_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "brink/core/base/error.h"
#include "brink/integrators/prescribed.h"

namespace brink {

namespace {

/// Stages of an integration step see what takes this part of it.
constexpr double kOfStep = 0.125;
/// Parts of the clock's time.
constexpr double kRoundings = 8.0 * std::numeric_limits<double>::epsilon();

/// A coordinate without a formula stays as it is in the site's pose.
double value(const std::optional<Formula>& formula, double t) {
  return formula ? (*formula)(std::span<const double>(&t, 1)) : 0.0;
}

/// What messages call it: its formulas as written.
std::string description(const FixedSite& site, const FormulaMotion& m) {
  std::string text = fmt::format("fixed site '{}'", site.name);
  const auto add = [&](const char* what, const std::optional<Formula>& f) {
    if (f) text += fmt::format(", {} = \"{}\"", what, f->text());
  };
  add("x", m.x);
  add("y", m.y);
  add("angle", m.angle);
  return text;
}

}  // namespace

/// Only a motion by formulas is made piece by piece. @throws BadInput where formulas have none at t = 0.
SiteMotion::SiteMotion(const FixedSite& site) {
  if (const auto* constant = std::get_if<ConstantMotion>(&site.motion)) {
    // a straight line under no acceleration: it reaches for ever
    motion_ = Motion::ballistic(0.0, {site.pose, constant->twist}, {});
    moves_ = !constant->twist.velocity.isZero(0.0) || constant->twist.omega != 0.0;
    return;
  }
  motion_ = Motion::still(site.pose);
  if (const auto* formula = std::get_if<FormulaMotion>(&site.motion)) {
    moves_ = true;
    // where the site was put; formulas say how far it is from there
    const Eigen::Vector3d base(site.pose.position.x(), site.pose.position.y(), site.pose.angle);
    prescribed_ = std::make_unique<PrescribedMotion>(
        base,
        [f = *formula](double t) -> Eigen::Vector3d {
          return {value(f.x, t), value(f.y, t), value(f.angle, t)};
        },
        [f = *formula](int i, double from, double to, BoundOf highest) {
          const std::optional<Formula>& part = i == 0 ? f.x : (i == 1 ? f.y : f.angle);
          // of the formula's one variable, the time
          return part ? part->time_bound(0, from, to, highest) : TimeBound();
        },
        description(site, *formula));
    // formulas that have no motion at t = 0 are a fault of the world, not the end of a run
    if (const Extent extent = extend(0.0); extent.status != Extent::Status::reached)
      throw BadInput(extent.why);
  }
}

SiteMotion::~SiteMotion() = default;
SiteMotion::SiteMotion(SiteMotion&&) noexcept = default;

Pose told_pose(const FixedSite& site, double t) {
  Pose pose = site.pose;
  if (const auto* constant = std::get_if<ConstantMotion>(&site.motion)) {
    pose.position += t * constant->twist.velocity;
    pose.angle += t * constant->twist.omega;
  } else if (const auto* formula = std::get_if<FormulaMotion>(&site.motion)) {
    pose.position += Vec2(value(formula->x, t), value(formula->y, t));
    pose.angle += value(formula->angle, t);
  }
  return pose;
}

/// What does not go by formulas covers every time from the beginning.
Extent SiteMotion::extend(double t, std::uint64_t most_cells) {
  if (!prescribed_) return {Extent::Status::reached, t, {}};
  const Extent extent = prescribed_->extend(t, most_cells);
  // a motion needs a piece to be of; from then on it grows with the track
  if (prescribed_->begun()) motion_ = prescribed_->motion();
  return extent;
}

double SiteMotion::even_until(double t, double until) const {
  const Track* track = motion_.track();
  if (!track) return until;
  const auto is_narrow = [&](const PolynomialPiece& p) { return p.end - p.begin < kOfStep * (until - t); };
  // what ends within some roundings of t has ended
  auto piece = std::upper_bound(track->pieces.begin(), track->pieces.end(), t + kRoundings * std::abs(t),
                                [](double time, const PolynomialPiece& p) { return time < p.end; });
  if (piece != track->pieces.end() && is_narrow(*piece)) return std::min(until, piece->end);
  while (piece != track->pieces.end() && piece->begin < until && !is_narrow(*piece)) ++piece;
  return piece != track->pieces.end() ? std::min(until, piece->begin) : until;
}

bool SiteMotion::lacks_bounds() const { return prescribed_ && prescribed_->lacks_bounds(); }

void SiteMotion::forget_before(double t) {
  if (prescribed_) prescribed_->forget_before(t);
}

}  // namespace brink
