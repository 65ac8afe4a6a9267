#include "brink/scheduler/kernel/start_places.h"

#include <cmath>

#include "brink/core/shapes/curve_site.h"
#include "brink/scheduler/kernel/tolerances.h"

namespace brink {

namespace {

/// An edge that leaves the tip at less than this slope runs along the wire.
constexpr double kAlong = 1e-9;
/// This part of the level at which a wire is met is rounding (nominal_level() of first_contact/tolerances.h).
constexpr double kByRounding = 0.125;

/// True if edges lead from the sample to the other side of a surface with that normal (world), and none away from it.
bool comes_back(const Outline& outline, const Sample& sample, const Frame& frame, const Vec2& normal) {
  bool back = false;
  const auto leads = [&](const Vec2& end, const Vec2& direction) {
    if ((end - sample.p).norm() > 1e-12 * outline.bounding_radius) return true;
    const double out = frame.direction_to_world(direction).dot(normal);
    back = back || out < -kAlong;
    return out <= kAlong;
  };
  for (const Site& s : outline.sites)
    if (s.kind != SiteKind::point && !(leads(s.a, direction_at_start(s)) && leads(s.b, -direction_at_end(s))))
      return false;
  return back;
}

/// The shift of the pair's first owner that takes its deepest corner, or the other's, out of a wire [m].
Vec2 shift_of(const PairKey& pair, ContactSearch& search, const Trajectories& trajectories, double reach,
              double t) {
  const Outline *a = &search.outline_of(pair.body), *b = &search.outline_of(search.other_owner(pair));
  if (a->is_point() || b->is_point()) return Vec2::Zero();
  const Frame frame_a(trajectories.motion_of(pair.body).pose(t)),
      frame_b(trajectories.motion_of(search.other_owner(pair)).pose(t));
  Vec2 shift = Vec2::Zero();
  for (const FeatureContact& f : search.touching(pair, reach, t)) {
    const Outline &of_sample = f.sample_on_a ? *a : *b, &of_site = f.sample_on_a ? *b : *a;
    const Site& site = of_site.sites[f.site];
    const Sample& sample = of_sample.samples[f.sample];
    const bool thin = !site.solid && site.radius + sample.radius == 0.0 && sample.arc_site < 0;
    // What is across by roundings is on its body's side already, with a gap below 0: it may stay.
    if (!thin || (f.gap <= 0.0 && -f.gap <= kByRounding * f.level)) continue;
    // from the side of the wire where a belongs to the one where b does
    const Vec2 across = f.gap > 0.0 ? f.normal : Vec2(-f.normal);
    const Vec2 to_tip = f.sample_on_a ? across : Vec2(-across);
    if (!comes_back(of_sample, sample, f.sample_on_a ? frame_a : frame_b, to_tip)) continue;
    const double deep = std::abs(f.gap) + search.limits().touch;
    if (deep > shift.norm()) shift = -deep * across;
  }
  return shift;
}

/// True if no lock of the body holds against that.
bool may_be_moved(const Body& b, const Vec2& shift) {
  return !(b.lock_x && shift.x() != 0.0) && !(b.lock_y && shift.y() != 0.0);
}

}  // namespace

std::vector<Vec2> shifts_out_of_wires(const World& world, const Trajectories& trajectories,
                                      const NearPairs& near, ContactSearch& search, double t) {
  std::vector<Vec2> shifts;
  if (!search.points_meet_wires()) return shifts;
  const double reach = kStartOverlap * world.length();
  near.each_at(t, [&](const PairKey& pair) {
    const Vec2 shift = shift_of(pair, search, trajectories, reach, t);
    if (shift.isZero(0.0)) return true;
    const auto add = [&](int k, const Vec2& by) {
      if (!may_be_moved(world.bodies[k], by)) return false;
      shifts.resize(world.bodies.size(), Vec2::Zero());
      // of several that ask, the farthest: the others are asked again from there
      if (by.norm() > shifts[k].norm()) shifts[k] = by;
      return true;
    };
    if (!add(pair.body, shift) && !pair.with_site()) add(pair.other_body, -shift);
    return true;
  });
  return shifts;
}

}  // namespace brink
