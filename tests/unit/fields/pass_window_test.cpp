// Pass windows against the definition: nearest site, whoever is left out, over random scenes.
#include "brink/core/fields/pass_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "brink/core/base/error.h"
#include "brink/core/fields/gl_context.h"
#include "brink/core/shapes/distance.h"
#include "tests/unit/fields/field_shapes.h"

namespace brink::pass_window_test {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Bodies of several shapes at random poses, in a square of side 10; the scene itself (owner 100) owns a
/// floor.
struct RandomScene {
  std::vector<std::shared_ptr<const Outline>> outlines;
  std::vector<PlacedOutline> placed;

  RandomScene(std::uint64_t seed, int bodies) {
    Random random(seed);
    outlines = {field_test::named("disc", make_disc(0.4)).outline,
                field_test::named("star", make_polygon(field_test::star(5, 0.8, 0.3))).outline,
                field_test::named("capsule", make_capsule(1.0, 0.2)).outline,
                field_test::named("rounded box", make_box(0.8, 0.5, 0.1)).outline,
                field_test::named("letters", field_test::letters()).outline,
                field_test::named("waves", field_test::waves()).outline,
                field_test::named("floor", make_segment({-1e4, 0}, {1e4, 0.0})).outline};
    for (int i = 0; i < bodies; ++i) {
      const Pose pose{Vec2(random.uniform(0, 10), random.uniform(0, 10)), random.uniform(-4.0, 4.0)};
      placed.push_back(
          {outlines[random.below(outlines.size() - 1)].get(), pose, static_cast<std::uint32_t>(i)});
    }
    placed.push_back({outlines.back().get(), Pose(), 100});
  }
};

double gap_to(const PlacedOutline& item, const Vec2& p) {
  return gap_by_brute_force(*item.outline, Frame(item.pose).to_local(p));
}

/// Unsigned distance less radius from p to the nearest site of everything but `excluded`.
double unsigned_distance(std::span<const PlacedOutline> scene, std::uint32_t excluded, const Vec2& p) {
  double least = kInfinite;
  for (const PlacedOutline& item : scene) {
    if (item.owner == excluded) continue;
    const Vec2 q = Frame(item.pose).to_local(p);
    for (const Site& site : item.outline->sites)
      least = std::min(least, nearest_on(site, q).distance - site.radius);
  }
  return least;
}

Box square(double low, double high) {
  Box box;
  box.add(Vec2(low, low));
  box.add(Vec2(high, high));
  return box;
}

Vec2 center_of(const FieldImage& image, std::size_t k) {
  const auto width = static_cast<std::size_t>(image.width);
  return image.window.low +
         image.pixel * Vec2(static_cast<double>(k % width) + 0.5, static_cast<double>(k / width) + 0.5);
}

class PassWindow : public ::testing::TestWithParam<std::string> {
 protected:
  PassWindow() {
    options_.context = GetParam();
    renderer_ = std::make_unique<PassRenderer>(options_, &work_);
  }
  FieldOptions options_;
  WorkCounters work_;
  std::unique_ptr<PassRenderer> renderer_;
};

// Brute force in double precision at every pixel centre, within the rounding that the image declares.
TEST_P(PassWindow, DistanceAtEveryPixelIsTheBruteForceDistance) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const RandomScene scene(seed, 12);
    const std::uint32_t excluded = seed % 2 == 0 ? 3 : FieldImage::kNone;
    const double band = seed % 3 == 0 ? 0.7 : kInfinite;
    const FieldImage image = renderer_->render(square(2, 8), 60, 60, scene.placed, excluded, band);
    EXPECT_LT(image.rounding, 0.02 * image.pixel);
    for (std::size_t k = 0; k < image.distance.size(); ++k) {
      const Vec2 p = center_of(image, k);
      const double expected = unsigned_distance(scene.placed, excluded, p);
      if (expected > band + image.rounding) {
        ASSERT_EQ(image.owner[k], FieldImage::kNone);
        ASSERT_EQ(image.distance[k], std::numeric_limits<float>::infinity());
        continue;
      }
      if (expected > band - image.rounding) continue;
      ASSERT_NEAR(image.distance[k], expected, image.rounding) << "seed " << seed << " pixel " << k;
      ASSERT_NE(image.owner[k], excluded);
    }
  }
}

// Away from the outline by more than the rounding, the altered interior is the sign of the exact gap to that
// owner.
TEST_P(PassWindow, InsideIsTheSignOfTheExactGap) {
  int inside = 0;
  for (std::uint64_t seed = 11; seed <= 14; ++seed) {
    const RandomScene scene(seed, 12);
    const FieldImage image = renderer_->render(square(2, 8), 64, 64, scene.placed, 5, kInfinite);
    for (std::size_t k = 0; k < image.distance.size(); ++k) {
      const auto item = std::find_if(scene.placed.begin(), scene.placed.end(),
                                     [&](const PlacedOutline& o) { return o.owner == image.owner[k]; });
      const double gap = gap_to(*item, center_of(image, k));
      if (std::abs(gap) < 2.0 * image.rounding) continue;
      ASSERT_EQ(image.inside[k] != 0, gap < 0.0) << "seed " << seed << " pixel " << k;
      inside += image.inside[k];
    }
  }
  EXPECT_GT(inside, 100);  // the scenes are crowded: the test has seen both signs
}

// Two layers replace one literal pass a body: body k reads the first layer where the owner is not k, else the
// second.
TEST_P(PassWindow, TwoLayersGiveEveryBodyItsLiteralPassPixelForPixel) {
  for (std::uint64_t seed = 21; seed <= 24; ++seed) {
    const RandomScene scene(seed, 9);
    const double band = seed % 2 == 0 ? 0.5 : kInfinite;
    const auto layers = renderer_->render_two_layers(square(0, 10), 96, 96, scene.placed, band);
    for (std::uint32_t k = 0; k < 9; ++k) {
      const FieldImage literal = renderer_->render(square(0, 10), 96, 96, scene.placed, k, band);
      for (std::size_t i = 0; i < literal.owner.size(); ++i) {
        const FieldImage& layer = layers[layers[0].owner[i] == k ? 1 : 0];
        ASSERT_EQ(layer.owner[i], literal.owner[i]) << "seed " << seed << " body " << k << " pixel " << i;
        ASSERT_EQ(layer.site[i], literal.site[i]);
        ASSERT_EQ(layer.distance[i], literal.distance[i]);
        ASSERT_EQ(layer.inside[i], literal.inside[i]);
      }
    }
  }
}

// The same on two hundred scenes, exact and mesh in turn, over windows that cut the bodies.
TEST_P(PassWindow, TwoLayersAreTheLiteralPassesOnTwoHundredScenes) {
  std::size_t different = 0, pixels = 0;
  FieldOptions mesh = options_;
  mesh.primitives = "mesh";
  PassRenderer by_mesh(mesh);
  for (std::uint64_t seed = 1000; seed < 1200; ++seed) {
    const RandomScene scene(seed, 6);
    PassRenderer& renderer = seed % 2 == 0 ? *renderer_ : by_mesh;
    const double band = seed % 3 == 0 ? 0.5 : kInfinite;
    const auto layers = renderer.render_two_layers(square(1, 9), 40, 40, scene.placed, band);
    for (std::uint32_t k = 0; k < 6; ++k) {
      const FieldImage literal = renderer.render(square(1, 9), 40, 40, scene.placed, k, band);
      for (std::size_t i = 0; i < literal.owner.size(); ++i, ++pixels) {
        const FieldImage& layer = layers[layers[0].owner[i] == k ? 1 : 0];
        different += layer.owner[i] != literal.owner[i] || layer.site[i] != literal.site[i] ||
                     layer.distance[i] != literal.distance[i] || layer.inside[i] != literal.inside[i];
      }
    }
  }
  EXPECT_EQ(different, 0U) << "of " << pixels << " pixels";
}

// Complete: whoever has a point within the margin of the window is named (sampled densely, exact gaps), and
// whoever is not named is at least others_at_least away.
TEST_P(PassWindow, NearOwnersNamesEveryOwnerWithinTheMargin) {
  Random random(31);
  std::size_t named = 0, all = 0;
  for (std::uint64_t seed = 41; seed <= 140; ++seed) {
    const RandomScene scene(seed, 20);
    const double low = random.uniform(0, 8), side = random.uniform(0.05, 3.0),
                 margin = random.uniform(0.0, 1.0);
    const Box window = square(low, low + side);
    const NearOwners near = renderer_->near_owners(window, margin, scene.placed, 7);
    EXPECT_TRUE(std::is_sorted(near.owners.begin(), near.owners.end()));
    EXPECT_GE(near.others_at_least, margin);
    named += near.owners.size();
    for (const PlacedOutline& item : scene.placed) {
      ++all;
      if (std::binary_search(near.owners.begin(), near.owners.end(), item.owner)) continue;
      if (item.owner == 7) continue;
      for (int k = 0; k < 400; ++k) {
        const Vec2 p = window.low + side * Vec2(random.uniform(), random.uniform());
        ASSERT_GT(gap_to(item, p), margin) << "seed " << seed << " owner " << item.owner;
      }
    }
  }
  EXPECT_LT(named, all / 2);  // and not simply everybody
}

// Owner 0 is a ring-shaped solid's opposite: a box of side 10 whose outline is 4 away from a window at its
// centre.
TEST_P(PassWindow, NearOwnersNamesASolidThatHoldsTheWindow) {
  const Shape box = make_box(10, 10), container = make_disc_container(6.0);
  const std::vector<PlacedOutline> scene = {{&box.outline, Pose(), 0}, {&container.outline, Pose(), 1}};
  const NearOwners near = renderer_->near_owners(square(-1, 1), 0.5, scene, FieldImage::kNone);
  EXPECT_EQ(near.owners, std::vector<std::uint32_t>{0});  // the container's solid is outside radius 6
  EXPECT_EQ(near.others_at_least, 0.5);
  const NearOwners outside = renderer_->near_owners(square(20, 22), 0.5, scene, FieldImage::kNone);
  EXPECT_EQ(outside.owners,
            std::vector<std::uint32_t>{1});  // a point beyond the circle is in the container's solid
}

TEST_P(PassWindow, EveryReadbackModeGivesTheSameValues) {
  const RandomScene scene(51, 10);
  const std::vector<Vec2> points = {{2.5, 3.5}, {4.0, 4.1}, {7.9, 2.1}, {50, 50}};
  std::vector<std::vector<PixelValue>> values;
  std::vector<std::uint64_t> read;
  for (const char* mode : {"full", "window", "pixel"}) {
    FieldOptions options = options_;
    options.readback = mode;
    WorkCounters work;
    PassRenderer renderer(options, &work);
    values.push_back(renderer.render_at(square(2, 8), 40, 40, scene.placed, 2, kInfinite, points));
    read.push_back(work.pixels_read);
    const FieldImage image = renderer.render(square(2, 8), 40, 40, scene.placed, 2, kInfinite);
    EXPECT_EQ(image.owner[19], renderer_->render(square(2, 8), 40, 40, scene.placed, 2, kInfinite).owner[19]);
  }
  for (std::size_t mode = 1; mode < 3; ++mode) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(values[mode][i].owner, values[0][i].owner);
      EXPECT_EQ(values[mode][i].site, values[0][i].site);
      EXPECT_EQ(values[mode][i].distance, values[0][i].distance);
    }
  }
  // 40 x 40 pixels lie in a target of 64 x 64.
  EXPECT_EQ(read, (std::vector<std::uint64_t>{64 * 64, 40 * 40, points.size()}));
}

TEST_P(PassWindow, WorkCountsPassesAndPixels) {
  const RandomScene scene(61, 3);
  renderer_->render(square(0, 10), 32, 16, scene.placed, 0, kInfinite);
  EXPECT_EQ(work_.passes, 1U);
  EXPECT_EQ(work_.pixels_drawn, 32U * 16U);
  EXPECT_EQ(work_.pixels_read, 32U * 16U);
  renderer_->render_two_layers(square(0, 10), 32, 16, scene.placed, kInfinite);
  EXPECT_EQ(work_.passes, 3U);
  EXPECT_EQ(work_.pixels_drawn, 3 * 32U * 16U);
}

TEST_P(PassWindow, BadWindowsAreRefusedByName) {
  const RandomScene scene(71, 2);
  EXPECT_THROW(renderer_->render(Box(), 8, 8, scene.placed, 0, 1.0), BadInput);
  EXPECT_THROW(renderer_->render(square(0, 1), 0, 8, scene.placed, 0, 1.0), BadInput);
  EXPECT_THROW(renderer_->render(square(0, 1), 8, 9000, scene.placed, 0, 1.0), BadInput);
  EXPECT_THROW(renderer_->render(square(0, 1), 8, 8, scene.placed, 0, -1.0), BadInput);
  const std::vector<Vec2> no_place{Vec2(0.5, std::nan(""))};
  EXPECT_THROW(renderer_->render_at(square(0, 1), 8, 8, scene.placed, 0, 1.0, no_place), BadInput);
  EXPECT_THROW(renderer_->near_owners(square(0, 1), std::nan(""), scene.placed, 0), BadInput);
}

TEST_P(PassWindow, EmptySceneShowsNothing) {
  const FieldImage image = renderer_->render(square(0, 1), 8, 8, {}, FieldImage::kNone, kInfinite);
  EXPECT_TRUE(
      std::all_of(image.owner.begin(), image.owner.end(), [](auto o) { return o == FieldImage::kNone; }));
  const NearOwners near = renderer_->near_owners(square(0, 1), 1.0, {}, FieldImage::kNone);
  EXPECT_TRUE(near.owners.empty());
  EXPECT_EQ(near.others_at_least, kInfinite);
}

INSTANTIATE_TEST_SUITE_P(Backends, PassWindow, ::testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const auto name : gl_backends()) names.emplace_back(name);
                           return names;
                         }()),
                         [](const auto& info_) { return info_.param; });

}  // namespace
}  // namespace brink::pass_window_test
