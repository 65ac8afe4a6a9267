// Cones and tents against true distances: the stated bound holds at every pixel, cones never exceed.
#include "brink/core/fields/pass_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "brink/core/shapes/distance.h"
#include "tests/unit/fields/field_shapes.h"

namespace brink {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

Box square(double half) {
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

void compare(const Outline& outline, const char* primitives, double mesh_error, int side, double band,
             const Pose& pose, Errors& errors) {
  FieldOptions options;
  options.primitives = primitives;
  options.mesh_error = mesh_error;
  PassRenderer renderer(options);
  const PlacedOutline placed[] = {{&outline, pose, 0}};
  const FieldImage image = renderer.render(square(2.0), side, side, placed, FieldImage::kNone, band);
  const Frame frame(pose);
  const double bound = image.rounding + image.tessellation;
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i) {
      const std::size_t k = static_cast<std::size_t>(j) * side + i;
      const Vec2 p = frame.to_local(image.window.low + image.pixel * Vec2(i + 0.5, j + 0.5));
      double truth = kInfinite;
      for (const Site& site : outline.sites)
        truth = std::min(truth, nearest_on(site, p).distance - site.radius);
      if (image.owner[k] == FieldImage::kNone) {
        EXPECT_GT(truth, band - bound);
        continue;
      }
      const double off = image.distance[k] - truth;
      errors.worst_above = std::max(errors.worst_above, off / bound);
      errors.worst_below = std::max(errors.worst_below, -off / bound);
      errors.above_true = std::max(errors.above_true, off - image.rounding);
      ++errors.pixels;
    }
}

struct Case {
  const char* name;
  Outline outline;
};

std::vector<Case> primitives() {
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

// A million pixels and more for every kind of primitive, over two resolutions and three tessellations: never
// beyond the bound that the image states.
TEST(SiteMesh, EveryDepthIsWithinTheStatedBoundOfTheTrueDistance) {
  std::size_t pixels = 0;
  for (const Case& c : primitives())
    for (const char* kind : {"exact", "mesh"}) {
      Errors errors;
      for (const int side : {96, 250})
        for (const double mesh_error : {0.01, 0.1, 1.0}) {
          if (kind[0] == 'e' && mesh_error != 0.1) continue;
          compare(c.outline, kind, mesh_error, side, side == 96 ? 0.7 : kInfinite, Pose(), errors);
        }
      EXPECT_LT(errors.worst_above, 1.0) << c.name << ' ' << kind;
      EXPECT_LT(errors.worst_below, 1.0) << c.name << ' ' << kind;
      std::printf("%-14s %-6s %8zu pixels, worst above %.3f below %.3f of the bound\n", c.name, kind,
                  errors.pixels, errors.worst_above, errors.worst_below);
      pixels += errors.pixels;
    }
  EXPECT_GT(pixels, 1'000'000U);
}

// The rim lies at R / cos(pi / n): a cone's depth is at most the distance. Tents are exact. So outlines of
// points and segments are never drawn too far away, beyond rounding.
TEST(SiteMesh, ConesAndTentsNeverExceedTheTrueDistance) {
  for (const Case& c : primitives()) {
    if (std::any_of(c.outline.sites.begin(), c.outline.sites.end(),
                    [](const Site& s) { return s.kind == SiteKind::arc; }))
      continue;
    Errors errors;
    for (const double mesh_error : {0.1, 1.0, 10.0})
      compare(c.outline, "mesh", mesh_error, 300, kInfinite, Pose({0.01, -0.02}, 0.7), errors);
    EXPECT_LE(errors.above_true, 0.0) << c.name;
  }
}

/// True if sites that say "inside" and sites that say "outside" are within `bound` of each other in distance:
/// where the outline is thinner than that, a picture cannot tell.
bool undecided(const Outline& outline, const Vec2& p, double bound) {
  double least[2] = {kInfinite, kInfinite};
  for (const Site& site : outline.sites) {
    const Nearest n = nearest_on(site, p);
    double& best = least[side_of(site, n, p) < 0.0];
    best = std::min(best, n.distance - site.radius);
  }
  return std::abs(least[0] - least[1]) <= bound;
}

// Altered interior: by mesh as by exact primitives, away from the outline by more than both errors.
TEST(SiteMesh, InsideIsTheSignOfTheExactGap) {
  std::size_t inside = 0;
  for (const auto& shape : field_test::all_shapes()) {
    if (shape.outline->container || shape.outline->bounds.center().norm() > 100) continue;
    FieldOptions options;
    options.primitives = "mesh";
    PassRenderer renderer(options);
    const PlacedOutline placed[] = {{shape.outline.get(), Pose(), 0}};
    const FieldImage image =
        renderer.render(shape.outline->bounds.grown(0.05), 90, 90, placed, FieldImage::kNone, kInfinite);
    for (std::size_t k = 0; k < image.distance.size(); ++k) {
      const Vec2 p = image.window.low + image.pixel * Vec2(k % 90 + 0.5, static_cast<double>(k / 90) + 0.5);
      const double gap = gap_by_brute_force(*shape.outline, p);
      const double bound = 2.0 * (image.rounding + image.tessellation);
      if (std::abs(gap) < bound || undecided(*shape.outline, p, bound)) continue;
      ASSERT_EQ(image.inside[k] != 0, gap < 0.0) << shape.name << " pixel " << k << " gap " << gap;
      inside += image.inside[k];
    }
  }
  EXPECT_GT(inside, 1000U);
}

}  // namespace
}  // namespace brink
