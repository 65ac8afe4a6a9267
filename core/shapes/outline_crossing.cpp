#include "brink/core/shapes/outline_crossing.h"

#include <algorithm>

namespace brink {

namespace {

struct Segment {
  Vec2 a, b;
};

/// How far the nearer end of the two reaches through the other, or 0 where they do not cross.
double reach_through(const Segment& s, const Segment& t, Vec2& point) {
  const Vec2 ds = s.b - s.a, dt = t.b - t.a;
  const double ls = ds.norm(), lt = dt.norm();
  if (ls == 0.0 || lt == 0.0) return 0.0;
  const double ta = cross(ds, t.a - s.a) / ls, tb = cross(ds, t.b - s.a) / ls;
  const double sa = cross(dt, s.a - t.a) / lt, sb = cross(dt, s.b - t.a) / lt;
  if (ta * tb >= 0.0 || sa * sb >= 0.0) return 0.0;
  point = s.a + ds * (sa / (sa - sb));
  return std::min({std::abs(ta), std::abs(tb), std::abs(sa), std::abs(sb)});
}

std::vector<Segment> segments(const Outline& outline, const Pose& pose) {
  const Frame frame(pose);
  std::vector<Segment> all;
  for (const Site& site : outline.sites)
    if (site.kind == SiteKind::segment) all.push_back({frame.to_world(site.a), frame.to_world(site.b)});
  return all;
}

}  // namespace

OutlineCrossing deepest_crossing(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b) {
  OutlineCrossing deepest;
  const std::vector<Segment> of_a = segments(a, pose_a), of_b = segments(b, pose_b);
  for (const Segment& s : of_a)
    for (const Segment& t : of_b) {
      Vec2 point = Vec2::Zero();
      const double depth = reach_through(s, t, point);
      if (depth > deepest.depth) deepest = {depth, point, perp((t.b - t.a).normalized())};
    }
  return deepest;
}

}  // namespace brink
