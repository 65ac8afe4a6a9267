// Cones and tents against true distances: the stated bound holds at every pixel, cones never exceed.
#include "tests/unit/fields/field_shapes.h"
#include "tests/unit/fields/mesh_errors.h"

namespace brink::site_mesh_test {
namespace {

using namespace mesh_test;

// site_mesh_stress.cpp sees a million pixels of each.
TEST(SiteMesh, EveryDepthIsWithinTheStatedBoundForEveryPrimitiveAndResolution) {
  expect_bounds(60'000, {16, 64, 240}, 77);
}

// The rim lies at R / cos(pi / n): a cone's depth is at most the distance. Tents are exact. So outlines of
// points and segments are never drawn too far away, beyond rounding.
TEST(SiteMesh, ConesAndTentsNeverExceedTheTrueDistance) {
  const Pose pose({0.01, -0.02}, 0.7);
  for (const Case& c : primitives()) {
    if (std::any_of(c.outline.sites.begin(), c.outline.sites.end(),
                    [](const Site& s) { return s.kind == SiteKind::arc; }))
      continue;
    Errors errors;
    for (const double mesh_error : {0.1, 1.0, 10.0})
      for (const int side : {16, 250, 1000}) {
        PassRenderer renderer(drawn_as("mesh", mesh_error));
        const PlacedOutline placed[] = {{&c.outline, pose, 0}};
        compare(c.outline, renderer.render(square(2.0), side, side, placed, FieldImage::kNone, kInfinite),
                kInfinite, pose, errors);
      }
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
}  // namespace brink::site_mesh_test
