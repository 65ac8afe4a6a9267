#pragma once
/// Rendered depths against true distances: how much of the bound that an image states its worst pixel uses.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "brink/core/base/random.h"
#include "brink/core/fields/pass_window.h"
#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/shapes.h"

namespace brink::mesh_test {

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

inline Box square(double half) {
  Box box;
  box.add(Vec2(-half, -half));
  box.add(Vec2(half, half));
  return box;
}

/// Where rendered depths lie against true distances, in the window's units.
struct Errors {
  double worst_above = 0.0, worst_below = 0.0;  ///< of the stated bound
  double above_true = 0.0;                      ///< beyond rounding [m]
  std::size_t pixels = 0;
};

/// Compares one image with the true distances at its pixel centres.
inline void compare(const Outline& outline, const FieldImage& image, double band, const Pose& pose,
                    Errors& errors) {
  const Frame frame(pose);
  const double bound = image.rounding + image.tessellation;
  for (std::size_t k = 0; k < image.distance.size(); ++k) {
    const auto width = static_cast<std::size_t>(image.width);
    const Vec2 center(static_cast<double>(k % width) + 0.5, static_cast<double>(k / width) + 0.5);
    const Vec2 p = frame.to_local(image.window.low + image.pixel * center);
    double truth = kInfinite;
    for (const Site& site : outline.sites)
      truth = std::min(truth, nearest_on(site, p).distance - site.radius);
    ++errors.pixels;
    if (image.owner[k] == FieldImage::kNone) {
      EXPECT_GT(truth, band - bound);
      continue;
    }
    const double off = image.distance[k] - truth;
    errors.worst_above = std::max(errors.worst_above, off / bound);
    errors.worst_below = std::max(errors.worst_below, -off / bound);
    errors.above_true = std::max(errors.above_true, off - image.rounding);
  }
}

inline FieldOptions drawn_as(const char* primitives, double mesh_error) {
  FieldOptions options;
  options.primitives = primitives;
  options.mesh_error = mesh_error;
  return options;
}

struct Case {
  const char* name;
  Outline outline;
};

inline std::vector<Case> primitives() {
  return {{"point", make_point({0.3, 0.1}).outline},
          {"thick point", make_point({-0.4, 0.2}, 0.5).outline},
          {"far point", make_point({7.0, 3.0}).outline},
          {"segment", make_segment({-1.3, -0.4}, {0.9, 0.7}).outline},
          {"long segment", make_segment({-900.0, -0.4}, {1000.0, 0.7}).outline},
          {"arc", make_arc({0.1, -0.2}, 1.2, 0.3, 4.0).outline},
          {"flat arc", make_arc({0.1, -60.0}, 60.3, 1.55, 1.6).outline},
          {"bezier", make_bezier({Vec2(-1.5, -1), Vec2(-0.5, 2), Vec2(0.5, -2), Vec2(1.5, 1)}, 1e-4).outline},
          {"rounded box", make_box(1.6, 0.9, 0.3).outline}};
}

/// Images of side x side pixels at random poses, whole and truncated in turn, until so many pixels are seen.
inline Errors errors_over(std::size_t pixels, const Outline& outline, const char* primitives, int side,
                          Random& random) {
  PassRenderer fine(drawn_as(primitives, 0.01)), usual(drawn_as(primitives, 0.1)),
      coarse(drawn_as(primitives, 1.0));
  PassRenderer* const renderers[] = {&usual, &fine, &coarse};
  Errors errors;
  for (int k = 0; errors.pixels < pixels; ++k) {
    const Pose pose{Vec2(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)), random.uniform(-4.0, 4.0)};
    const PlacedOutline placed[] = {{&outline, pose, 0}};
    const double band = k % 4 == 3 ? 0.7 : kInfinite;
    const FieldImage image =
        renderers[k % 3]->render(square(2.0), side, side, placed, FieldImage::kNone, band);
    compare(outline, image, band, pose, errors);
  }
  return errors;
}

/// Every kind of primitive, exact and by mesh, at every resolution given: never beyond the bound.
inline void expect_bounds(std::size_t pixels, std::initializer_list<int> sides, std::uint64_t seed) {
  std::printf("seed %d; share of the bound that the worst of %zu pixels uses\n", static_cast<int>(seed),
              pixels);
  Random random(seed);
  for (const Case& c : primitives())
    for (const char* kind : {"exact", "mesh"}) {
      std::printf("%-14s %-6s", c.name, kind);
      for (const int side : sides) {
        const Errors errors = errors_over(pixels, c.outline, kind, side, random);
        EXPECT_LT(errors.worst_above, 1.0) << c.name << ' ' << kind << ' ' << side;
        EXPECT_LT(errors.worst_below, 1.0) << c.name << ' ' << kind << ' ' << side;
        std::printf("  %4d px %.3f", side, std::max(errors.worst_above, errors.worst_below));
      }
      std::printf("\n");
    }
}

}  // namespace brink::mesh_test
