#pragma once
/// Outlines on which fields are tested: thin, sharp, crowded, curved, tiny beside huge.

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "brink/core/shapes/outline.h"
#include "brink/core/shapes/shapes.h"

namespace brink::field_test {

struct NamedOutline {
  std::string name;
  std::shared_ptr<const Outline> outline;
};

inline Vec2 polar(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

inline std::vector<Vec2> star(int points, double outer, double inner) {
  std::vector<Vec2> v;
  for (int i = 0; i < 2 * points; ++i)
    v.push_back(polar(i % 2 == 0 ? outer : inner, i * std::numbers::pi / points));
  return v;
}

inline std::vector<Vec2> saw(int teeth) {
  std::vector<Vec2> v = {{0.0, -0.2}, {1.0, -0.2}};
  for (int i = teeth; i > 0; --i) {
    v.emplace_back(static_cast<double>(i) / teeth, 0.0);
    v.emplace_back((i - 0.5) / teeth, 0.05);
  }
  v.emplace_back(0.0, 0.0);
  return v;
}

inline std::vector<Vec2> spiral(int steps) {
  std::vector<Vec2> v;
  for (int i = 0; i <= steps; ++i)
    v.push_back(polar(0.1 + 0.8 * i / steps, 8.0 * std::numbers::pi * i / steps));
  return v;
}

/// Two parallel teeth whose facing edges are 1e-7 apart.
inline std::vector<Vec2> slit() {
  return {{0, 0}, {2, 0}, {2, 1}, {1 + 1e-7, 1}, {1 + 1e-7, 0.1}, {1, 0.1}, {1, 1}, {0, 1}};
}

/// A unit square with a tooth of 1e-5 in the middle of its lower side.
inline std::vector<Vec2> tiny_beside_huge() {
  return {{-1, -1}, {0, -1}, {5e-6, -1 - 1e-5}, {1e-5, -1}, {1, -1}, {1, 1}, {-1, 1}};
}

inline NamedOutline named(std::string name, Shape shape) {
  return {std::move(name), std::make_shared<const Outline>(std::move(shape.outline))};
}

/// Arcs seen from both sides: waves of half circles, a wire.
inline Shape waves() {
  return make_path("M0 0 A0.5 0.5 0 0 1 1 0 A0.5 0.5 0 0 0 2 0 A0.5 0.5 0 0 1 3 0 A0.5 0.5 0 0 0 4 0", 1.0,
                   1e-4);
}

/// Text-like: letters with holes and curves.
inline Shape letters() {
  return make_path(
      "M0 0 L0 10 L4 10 C8 10 8 5 4 5 C9 5 9 0 4 0 Z M2 2 L4 2 C6 2 6 4 4 4 L2 4 Z M2 6 L4 6 C5 6 5 8 4 8 L2 "
      "8 Z "
      "M12 0 L14 0 L14 4 L17 0 L20 0 L16 5 L20 10 L17 10 L14 6 L14 10 L12 10 Z",
      0.1, 1e-3);
}

/// A ring of two circles: the hole's arcs are seen from inside.
inline Shape ring() {
  return make_path(
      "M1 0 A1 1 0 0 1 -1 0 A1 1 0 0 1 1 0 Z M0.9 0 A0.9 0.9 0 0 1 -0.9 0 A0.9 0.9 0 0 1 0.9 0 Z", 1.0, 1e-6);
}

/// Arcs of circles far larger than the shape (lens), and far from its frame's origin.
inline Shape flat_lens() { return make_path("M-1 0 A4000 4000 0 0 1 1 0 A30 30 0 0 1 -1 0 Z", 1.0, 1e-6); }

inline std::vector<NamedOutline> all_shapes() {
  std::vector<NamedOutline> shapes;
  shapes.push_back(named("star", make_polygon(star(16, 1.0, 0.4))));
  shapes.push_back(named("needle", make_polygon({{0, 0}, {1, -1e-6}, {2, 0}, {1, 1e-6}})));
  shapes.push_back(named("saw", make_polygon(saw(1000))));
  shapes.push_back(named("spiral", make_chain(spiral(200))));
  shapes.push_back(named("ring", ring()));
  shapes.push_back(named("letters", letters()));
  shapes.push_back(named("slit", make_polygon(slit())));
  shapes.push_back(named("waves", waves()));
  shapes.push_back(named("tiny beside huge", make_polygon(tiny_beside_huge())));
  shapes.push_back(named("rounded star", make_polygon(star(8, 1.0, 0.5), 0.1)));
  shapes.push_back(named("round polygon", make_polygon(star(100, 1.0, 1.0))));
  shapes.push_back(named("thick spiral", make_chain(spiral(120), false, 0.02)));
  shapes.push_back(named("circle container", make_disc_container(2.0)));
  shapes.push_back(named("flat lens", flat_lens()));
  std::vector<Vec2> far = star(16, 1.0, 0.4);
  for (Vec2& p : far) p += Vec2(1e6, -2e6);
  shapes.push_back(named("star far from its origin", make_polygon(far)));
  return shapes;
}

/// A query point: mostly close to the outline at every scale, else anywhere near it, or far away.
inline Vec2 query_point(const Outline& outline, Random& random) {
  const double size = outline.bounds.extent().norm();
  const double choice = random.uniform();
  if (choice < 0.6) {
    const Site& site = outline.sites[random.below(outline.sites.size())];
    const double t = random.uniform();
    Vec2 on = site.a + t * (site.b - site.a);
    if (site.kind == SiteKind::arc) {
      const Vec2 from = site.a - site.center;
      const double c = std::cos(t * site.sweep), s = std::sin(t * site.sweep);
      on = site.center + Vec2(c * from.x() - s * from.y(), s * from.x() + c * from.y());
    }
    return on + polar(size * std::pow(10.0, random.uniform(-9.0, -0.5)),
                      random.uniform(0.0, 2 * std::numbers::pi));
  }
  const double spread = choice < 0.9 ? 0.7 : 5.0;
  const Vec2 half = outline.bounds.extent();
  return outline.bounds.center() +
         Vec2(random.uniform(-spread, spread) * half.x(), random.uniform(-spread, spread) * half.y());
}

}  // namespace brink::field_test
