#include "brink/scheduler/first_contact/straight_wall.h"

#include <algorithm>
#include <cmath>

#include "brink/core/base/limits.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/sixteen_probes.h"
#include "brink/scheduler/first_contact/straight_way.h"

namespace brink {

namespace {

/// Times a span of time: less, by more than it is rounded.
constexpr double kLessByRoundings = 1.0 - 1e-9;

/// A disc's centre on its way, `side` times its distance from the wall's middle line being what closes.
BRINK_WIDE void take(const StraightWay& of_disc, const StraightWall& of_wall, double side, double reach,
                     SixteenProbes& probes) {
  const StraightWay disc = of_disc;  // nothing that is written is read by these
  const double origin_x = of_wall.frame.origin.x(), origin_y = of_wall.frame.origin.y();
  const double cosine = of_wall.frame.cosine, sine = of_wall.frame.sine;
  const double begin_x = of_wall.begin.x(), begin_y = of_wall.begin.y();
  const double way_x = of_wall.way.x(), way_y = of_wall.way.y(), length = of_wall.length;
  // Frame::to_local() and nearest_on(): the same operations in the same order
  const auto distance_at = [&](const Four& t, Four& distance) __attribute__((always_inline)) {
    const Four s = t - disc.origin;
    const Four x = disc.x + s * disc.vx - origin_x, y = disc.y + s * disc.vy - origin_y;
    const Four local_x = cosine * x + sine * y - begin_x, local_y = -sine * x + cosine * y - begin_y;
    distance = side * ((way_x * local_y - way_y * local_x) / length);
  };
  probes.take(distance_at, reach);
}

/// Its centre over the wall's line, as its motion begins.
struct Above {
  Vec2 start, velocity;  ///< from the wall's beginning, in its frame
  double side;           ///< 1 to the left of the wall's way, else -1
  double height;         ///< >= 0 [m]
  double closing;        ///< [m/s]
  double noise;          ///< of that

  Above(const StraightWay& way, double velocity_rounding, const StraightWall& wall)
      : start(wall.frame.to_local({way.x, way.y}) - wall.begin),
        velocity(wall.frame.direction_to_local({way.vx, way.vy})) {
    const double left = cross(wall.way, start) / wall.length;
    side = left < 0.0 ? -1.0 : 1.0;
    height = side * left;
    closing = -side * cross(wall.way, velocity) / wall.length;
    noise = velocity_rounding + 16.0 * kEpsilon * way.speed();
  }
};

bool is_straight(const Motion& motion, const StraightWall& wall) {
  return motion.acceleration().linear.isZero(0.0) && motion.origin() >= wall.since;
}

}  // namespace

std::optional<StraightWall> StraightWall::of(const Outline& outline, const Motion& motion) {
  const Site& site = outline.sites[0];
  if (outline.sites.size() != 1 || site.kind != SiteKind::segment || site.solid || !motion.is_still())
    return std::nullopt;
  const Vec2 way = site.b - site.a;
  const Vec2 place = motion.start().pose.position;
  return StraightWall{Frame(motion.start().pose),
                      site.a,
                      way,
                      std::sqrt(way.squaredNorm()),
                      site.radius,
                      outline.bounding_radius,
                      MotionRounding(motion, false).place(motion.origin(), place),
                      motion.origin()};
}

/// The gap to the wall's line is linear. The disc is clear of the wall and its ends until that closes, where its centre is
/// abreast of the wall, farther from the ends than it reaches.
bool straight_wall_met(const DiscMover& disc, const StraightWall& wall, double from, double to,
                       const SearchLimits& limits, WallContact& contact) {
  if (!is_straight(*disc.motion, wall)) return false;
  const StraightWay way(*disc.motion);
  const Above above(way, disc.velocity_rounding, wall);
  const double reach = wall.radius + disc.radius, apart = above.height - reach, closing = above.closing;
  if (!((reach > 0.0) & (apart >= limits.tolerance) & (closing > 16.0 * above.noise))) return false;
  const double s = apart / closing, t = way.origin + s;
  const double along = wall.way.dot(above.start + s * above.velocity) / wall.length,
               margin = reach + limits.tolerance;
  const bool is_abreast = (along >= margin) & (along <= wall.length - margin);
  // at any time of the flight
  const double place_noise =
      wall.place_noise + kRoundoff * (5.0 * s * way.speed() + std::abs(way.x) + std::abs(way.y));
  const double far = above.start.lpNorm<1>() + s * way.speed() + 2.0 * wall.size;
  const double rounding = place_noise + kRoundoff * (8.0 * far + 4.0 * wall.size);
  const double instant = same_instant(t), slow = 0.5 * kSlowOfSize * smallest_radius(disc.radius, wall.size);
  const bool in_time = (t >= from) & (t <= to), is_slow = way.speed() * instant <= slow,
             is_near =
                 (place_noise <= kFarOfTolerance * limits.tolerance) & (2.0 * rounding <= limits.tolerance);
  if (!(is_abreast & in_time & is_slow & is_near)) return false;
  ClearTime met;
  const auto take_both = [&](SixteenProbes& probes) { take(way, wall, above.side, reach, probes); };
  const auto itself = [](double distance) { return distance; };
  if (!last_clear_time_by_sixteens(take_both, itself, reach, t, std::max(way.origin, 0.0), rounding, closing,
                                   met) ||
      met.time > to)
    return false;
  contact = {{met.time, met.distance - wall.radius - disc.radius, closing},
             wall.frame.direction_to_world(Vec2(-wall.way.y(), wall.way.x()) * (above.side / wall.length))};
  return true;
}

double soonest_at_wall(const DiscMover& disc, const StraightWall& wall, const SearchLimits& limits) {
  const double begin = disc.motion->origin();
  if (!is_straight(*disc.motion, wall)) return begin;
  const StraightWay way(*disc.motion);
  const Above above(way, disc.velocity_rounding, wall);
  const double reach = wall.radius + disc.radius;
  const double far = std::abs(way.x) + std::abs(way.y) + 2.0 * wall.size;
  const double near = limits.tolerance + wall.place_noise + 64.0 * kRoundoff * far;
  // Who is over the line by less than it reaches is in the wall, or beyond an end, to which it may come though it goes away from
  // the line. What touches may have sunk by as much as nothing tells.
  if (!(above.height - reach > -near)) return begin;
  if (above.closing < -16.0 * above.noise) return kForever;
  const double apart = above.height - reach - near;
  return apart > 0.0 && above.closing > 16.0 * above.noise ? begin + apart / above.closing * kLessByRoundings
                                                           : begin;
}

}  // namespace brink
