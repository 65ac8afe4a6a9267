#include "brink/scheduler/crossing_outlines.h"

#include <algorithm>

namespace brink {

namespace {

struct Chord {
  Vec2 a, b;
};

/// How far the nearer end of the two chords reaches through the other, or 0 where they do not cross.
double reach_through(const Chord& s, const Chord& t, Vec2& point) {
  const Vec2 ds = s.b - s.a, dt = t.b - t.a;
  const double ls = ds.norm(), lt = dt.norm();
  if (ls == 0.0 || lt == 0.0) return 0.0;
  const double ta = cross(ds, t.a - s.a) / ls, tb = cross(ds, t.b - s.a) / ls;
  const double sa = cross(dt, s.a - t.a) / lt, sb = cross(dt, s.b - t.a) / lt;
  if (ta * tb >= 0.0 || sa * sb >= 0.0) return 0.0;
  point = s.a + ds * (sa / (sa - sb));
  return std::min({std::abs(ta), std::abs(tb), std::abs(sa), std::abs(sb)});
}

std::vector<Chord> chords(const Mover& m, double t) {
  const Frame frame(m.motion->pose(t));
  std::vector<Chord> all;
  for (const Site& site : m.outline().sites) all.push_back({frame.to_world(site.a), frame.to_world(site.b)});
  return all;
}

}  // namespace

std::optional<FeatureContact> crossing_of(const Mover& a, const Mover& b, double t) {
  std::optional<FeatureContact> deepest;
  const std::vector<Chord> of_a = chords(a, t), of_b = chords(b, t);
  for (std::size_t i = 0; i < of_a.size(); ++i)
    for (std::size_t j = 0; j < of_b.size(); ++j) {
      Vec2 point = Vec2::Zero();
      const double depth = reach_through(of_a[i], of_b[j], point);
      if (depth <= 0.0 || (deepest && depth <= -deepest->gap)) continue;
      deepest = FeatureContact{};
      deepest->time = t;
      deepest->sample = static_cast<int>(i);
      deepest->site = static_cast<int>(j);
      deepest->point = point;
      deepest->normal = perp((of_b[j].b - of_b[j].a).normalized());
      deepest->gap = -depth;
    }
  return deepest;
}

}  // namespace brink
