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

// Windows that see a part of an arc alone: from next to it to some of its sizes away, large and small, on either side.
TEST(SiteMesh, WindowsAnywhereAboutArcsAreWithinTheStatedBound) {
  const Outline outlines[] = {
      make_path("M 0 -20 A 20 20 0 1 1 0 20 A 26 26 0 0 0 0 -20 Z", 0.05, 1e-4).outline,
      make_path("M -20 0 A 20 20 0 0 1 20 0 Z", 0.05, 1e-4).outline,
      make_disc_container(1.0).outline,
      make_arc({0, 0}, 1.0, 0.0, 7.0).outline,
      make_arc({0, 0}, 1.0, 0.0, 2.5, 0.01).outline,
      make_arc({0, 0}, 1.0, 2.0, -1.5).outline};
  Random random(5);
  for (const char* kind : {"exact", "mesh"}) {
    PassRenderer renderer(drawn_as(kind, 0.1));
    Errors errors;
    for (int k = 0; k < 1800; ++k) {
      const Outline& outline = outlines[k % std::size(outlines)];
      const Pose pose(Vec2::Zero(), random.uniform(-4.0, 4.0));
      const double away = std::pow(10.0, random.uniform(-2.0, 0.5)),
                   half = away * std::pow(10.0, random.uniform(-2.5, 0.0));
      const bool inside = random.uniform(0.0, 1.0) < 0.3;
      const Vec2 center =
          field_test::polar(inside ? 1.0 - std::min(away, 0.9) : 1.0 + away, random.uniform(0.0, 6.3));
      Box window;
      window.add(center - Vec2(half, half));
      window.add(center + Vec2(half, half));
      const PlacedOutline placed[] = {{&outline, pose, 0}};
      compare(outline, renderer.render(window, 40, 40, placed, FieldImage::kNone, kInfinite), kInfinite, pose,
              errors);
    }
    EXPECT_LT(errors.worst_above, 1.0) << kind;
    EXPECT_LT(errors.worst_below, 1.0) << kind;
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
