#include "brink/scheduler/first_contact/apart.h"

#include "brink/core/base/limits.h"
#include "brink/core/base/wide.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/site_step.h"

namespace brink::detail {

namespace {

/// Certified steps before the samples are looked at; each is safe, so it does not matter where they end.
constexpr int kMostStepsOfDiscs = 64, kMostStepsBeside = 16, kMostStepsBetween = 8;
/// Hulls of more corners are not held against each other, side by side.
constexpr std::size_t kMostCorners = 16;

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

/// True of what few corners hold.
bool has_few_corners(const Outline& o) {
  return !o.hull.corners.empty() && o.hull.corners.size() <= kMostCorners;
}

/// Corners by their coordinates, four side by side; behind the last stand others of them.
struct Corners {
  std::size_t count = 0;
  alignas(sizeof(Four)) double x[kMostCorners], y[kMostCorners];

  void add(const Vec2& p) {
    x[count] = p.x();
    y[count++] = p.y();
  }
  void fill() {
    for (std::size_t i = count; i % 4 != 0; ++i) {
      x[i] = x[0];
      y[i] = y[0];
    }
  }
};

/// Of a hull's sides that beyond which corners lie farthest.
struct Side {
  std::size_t number = 0;
  double gap = -kForever;  ///< to the nearest of them [m]
};

void find_side(const Hull& hull, const Corners& corners, Side& found) {
  Side widest;
  for (std::size_t side = 0; side < hull.normals.size(); ++side) {
    const double nx = hull.normals[side].x(), ny = hull.normals[side].y();
    Four nearest = Four{} + kForever;
    for (std::size_t i = 0; i < corners.count; i += 4) {
      const Four along =
          nx * reinterpret_cast<const Four&>(corners.x[i]) + ny * reinterpret_cast<const Four&>(corners.y[i]);
      for (int k = 0; k < 4; ++k) nearest[k] = std::min(nearest[k], along[k]);
    }
    const double gap = std::min(std::min(nearest[0], nearest[1]), std::min(nearest[2], nearest[3])) -
                       (nx * hull.corners[side].x() + ny * hull.corners[side].y());
    widest = gap > widest.gap ? Side{side, gap} : widest;
  }
  found = widest;
}

/// Corners of S's hull in the frame of T, and the line of that side of T's hull from which they are farthest.
class Beside {
 public:
  Beside(const Outline& s, const Placed& placed_s, const Outline& t, const Placed& placed_t)
      : t_(t.hull),
        thickness_(s.hull.thickness + t.hull.thickness),
        spin_(placed_s.twist.omega - placed_t.twist.omega) {
    const Frame& frame = placed_t.frame;
    const Vec2 origin = frame.to_local(placed_s.frame.origin);
    const Vec2 x = frame.direction_to_local(placed_s.frame.direction_to_world(Vec2::UnitX())), y = perp(x);
    for (const Vec2& p : s.hull.corners) corners_.add(origin + p.x() * x + p.y() * y);
    corners_.fill();
    drift_ = frame.direction_to_local(placed_s.twist.velocity - placed_t.twist.velocity) -
             placed_s.twist.omega * perp(origin);
    find_side(t_, corners_, side_);
  }

  /// From that line to the nearest corner, less the thickness of both [m]; far below 0 where T has no side.
  double gap() const { return side_.gap - thickness_; }
  /// How long all corners are sure to stay beyond the line by more than `rest` [s], if none bends by more than
  /// `acceleration` [m/s^2].
  double step(double rest, double acceleration) const {
    const Vec2& n = t_.normals[side_.number];
    const double from = n.dot(t_.corners[side_.number]) + thickness_ + rest, falls = n.dot(drift_);
    double least = kForever;
    for (std::size_t i = 0; i < corners_.count; ++i) {
      const Vec2 q(corners_.x[i], corners_.y[i]);
      least = std::min(least, safe_step(n.dot(q) - from, falls + spin_ * n.dot(perp(q)), acceleration));
    }
    return least;
  }

 private:
  const Hull& t_;
  double thickness_;
  double spin_;  ///< of S against T [rad/s]
  Vec2 drift_;   ///< of a corner at T's origin that turns with S, against T [m/s]
  Corners corners_;
  Side side_;
};

/// By a line between the two hulls, that of a side of either: a step that is safe for all corners of the one beyond a side
/// of the other is safe for the pair.
Apart clear_between(const Mover& a, const Mover& b, double from, double to, const SearchLimits& limits) {
  const Outline &oa = a.outline(), &ob = b.outline();
  if (!has_few_corners(oa) || !has_few_corners(ob)) return {from};
  if (oa.hull.normals.empty() && ob.hull.normals.empty()) return {from};  // two points have no side
  const double near = near_by(oa.bounding_radius + ob.bounding_radius, limits);
  Placed pa, pb;
  double t = from;
  for (int i = 0; t < to; ++i) {
    if (i == kMostStepsBetween || i == limits.max_iterations) return {t, i == limits.max_iterations};
    const BodyState sa = a.motion->state(t), sb = b.motion->state(t);
    // places and angles are told no better than that
    const double rounding =
        16.0 * kEpsilon *
        (sa.pose.position.lpNorm<1>() + sb.pose.position.lpNorm<1>() +
         std::abs(sa.pose.angle) * oa.bounding_radius + std::abs(sb.pose.angle) * ob.bounding_radius);
    if (rounding > 0.25 * near) break;
    Placed::move_both(pa, oa, sa, pb, ob, sb);
    const Beside a_beside(oa, pa, ob, pb), b_beside(ob, pb, oa, pa);
    const bool of_b = a_beside.gap() >= b_beside.gap();  // the line
    const Beside& beside = of_b ? a_beside : b_beside;
    const RelativeBounds whole = RelativeBounds::over(oa, *a.motion, ob, *b.motion, t, to);
    const double speed = whole.speed + whole.spin_s * oa.bounding_radius + whole.spin_t * ob.bounding_radius;
    // a step is told to a tick of the clock
    const double rest = std::max(0.5 * near, 8.0 * ulp(t) * speed);
    if (beside.gap() <= 2.0 * rest) break;
    SamplePath corner{};  // as far out as any
    corner.arm = (of_b ? oa : ob).hull.reach;
    corner.distance = (sa.pose.position - sb.pose.position).norm() + corner.arm;
    // no longer than the gap may last: bounds are tight then
    const double window = std::min(to - t, speed > 0.0 ? 8.0 * beside.gap() / speed : kForever);
    const PathBounds bounds = path_bounds(corner, of_b ? whole : whole.swapped(), window);
    t += std::min(window, rounded_down(beside.step(rest, bounds.acceleration)));
  }
  return {t};
}

}  // namespace

Apart apart_until(const Mover& a, const Mover& b, double from, double to, const SearchLimits& limits) {
  const Outline &oa = a.outline(), &ob = b.outline();
  // What is in a container is in its disc from the start.
  if (oa.container || ob.container) return {from};
  const bool beside_b = stands_beside(oa, ob), beside_a = !beside_b && stands_beside(ob, oa);
  // beside a wall that turns, not before it can come within its reach
  if (!beside_a && !beside_b) return clear_between(a, b, clear_by_discs(a, b, from, to, limits), to, limits);
  const Mover &body = beside_b ? a : b, &wall = beside_b ? b : a;
  if (!wall.motion->is_still() && wall.motion->twist(from).omega != 0.0)
    from = clear_by_discs(a, b, from, to, limits);
  return {clear_beside(body, wall, from, to, limits)};
}

}  // namespace brink::detail
