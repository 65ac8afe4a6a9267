#include "brink/scheduler/first_contact/apart.h"

#include "brink/core/base/limits.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/site_step.h"

namespace brink::detail {

namespace {

/// Certified steps before the samples are looked at; each is safe, so it does not matter where they end.
constexpr int kMostStepsOfDiscs = 64, kMostStepsBeside = 16;

/// What is nearer than this is near [m]: as near as makes no difference.
double near_by(double reach, const SearchLimits& limits) { return 1e-3 * reach + limits.tolerance; }

/// Rounded down by more than the step's own roundings: it may be shorter than what is safe, never longer.
double rounded_down(double step) { return step * (1.0 - 4.0 * kEpsilon); }

/// True if the disc that holds `wall` is wide beside `body`, and a line tells more.
bool stands_beside(const Outline& body, const Outline& wall) {
  return wall.bounding_radius > 2.0 * body.bounding_radius && body.bounding_radius > 0.0 && has_facing(wall);
}

/// By the disc that holds a body, beside a wall.
double clear_beside(const Mover& body, const Mover& wall, double from, double to,
                    const SearchLimits& limits) {
  const double radius = body.outline().bounding_radius, near = near_by(radius, limits);
  Placed of_wall;
  double t = from;
  for (int i = 0; i < kMostStepsBeside && t < to; ++i) {
    const BodyState now = body.motion->state(t);
    of_wall.move(wall.outline(), wall.motion->state(t));
    const SamplePath path = origin_path(now, of_wall);
    const Facing line = facing(wall.outline(), path.q, path.rate);
    const double gap = line.gap - radius;
    // near, or so far from the world's origin that places are told no better than that
    const double rounding =
        16.0 * kEpsilon * (now.pose.position.lpNorm<1>() + of_wall.frame.origin.lpNorm<1>());
    if (gap <= near || rounding > 0.25 * near) break;
    const RelativeBounds relative =
        RelativeBounds::over(body.outline(), *body.motion, wall.outline(), *wall.motion, t, to);
    const PathBounds bounds = path_bounds(path, relative, to - t);
    t += rounded_down(safe_step(gap - 0.5 * near, line.rate, bounds.acceleration));
  }
  return t;
}

/// By the discs that hold the two.
double clear_by_discs(const Mover& a, const Mover& b, double from, double to, const SearchLimits& limits) {
  const double reach = a.outline().bounding_radius + b.outline().bounding_radius;
  const double near = near_by(reach, limits);
  const bool straight = a.motion->is_ballistic() && b.motion->is_ballistic() &&
                        a.motion->acceleration().linear == b.motion->acceleration().linear;
  double t = from;
  for (int i = 0; i < kMostStepsOfDiscs && t < to; ++i) {
    const BodyState sa = a.motion->state(t), sb = b.motion->state(t);
    const Vec2 d = sa.pose.position - sb.pose.position, v = sa.twist.velocity - sb.twist.velocity;
    const double distance = d.norm(), f = distance - reach;
    if (f <= near) break;
    // Under equal accelerations either sees the other go straight on: one root says when the discs meet.
    if (straight) return t + time_until_within(d, v, reach + 0.5 * near);  // no curvature: there at once
    const RelativeBounds bounds = RelativeBounds::over(a.outline(), *a.motion, b.outline(), *b.motion, t, to);
    t += rounded_down(safe_step(f - 0.5 * near, d.dot(v) / distance, bounds.acceleration));
  }
  return t;
}

}  // namespace

double apart_until(const Mover& a, const Mover& b, double from, double to, const SearchLimits& limits) {
  const Outline &oa = a.outline(), &ob = b.outline();
  // What is in a container is in its disc from the start.
  if (oa.container || ob.container) return from;
  const bool beside_b = stands_beside(oa, ob), beside_a = !beside_b && stands_beside(ob, oa);
  // beside a wall that turns, not before it can come within its reach
  if (!beside_a && !beside_b) return clear_by_discs(a, b, from, to, limits);
  const Mover &body = beside_b ? a : b, &wall = beside_b ? b : a;
  if (!wall.motion->is_still() && wall.motion->twist(from).omega != 0.0)
    from = clear_by_discs(a, b, from, to, limits);
  return clear_beside(body, wall, from, to, limits);
}

}  // namespace brink::detail
