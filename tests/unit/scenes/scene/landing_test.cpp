// Gaps of copies, computed once an offset: those that outline_gap() gives wherever the copies stand.
#include "brink/scenes/scene/landing.h"

#include <gtest/gtest.h>

#include "brink/core/query/outline_gap.h"
#include "tests/support/seeded_random.h"
#include "tests/support/worlds.h"

namespace brink::landing_test {
namespace {

TEST(CopyGaps, AreThoseOfTheOutlinesWhereverTheyStand) {
  SeededRandom random(20261124);
  const auto star =
      testing::outline(make_polygon({{1, 0}, {0.2, 0.3}, {-1, 0.8}, {-0.4, 0}, {-1, -0.8}, {0.2, -0.3}}));
  const auto box = testing::outline(make_box(0.5, 0.4));
  for (const auto& outline : {star, box})
    for (int k = 0; k < 20; ++k) {
      const double angle = k == 0 ? 0.0 : random.uniform(-4.0, 4.0);
      CopyGaps gaps(*outline);
      for (int n = 0; n < 50; ++n) {
        // to a power of two, so that both pairs have the same offset to the bit
        const Vec2 at = 8.0 * Vec2(random.below(1000), random.below(1000));
        const Vec2 way = std::exp2(-40) * Vec2(std::floor(random.uniform(-1.0, 1.0) * std::exp2(40)),
                                               std::floor(random.uniform(-1.0, 1.0) * std::exp2(40)));
        const OutlineGap here = outline_gap(*outline, {at, angle}, *outline, {at + way, angle});
        for (const Vec2& place : {at, Vec2::Zero().eval()}) {
          const CopyGaps::Gap& is = gaps.between({place, angle}, {place + way, angle});
          EXPECT_EQ(is.gap, here.gap);
          EXPECT_EQ(is.normal, here.normal);
        }
      }
    }
}

}  // namespace
}  // namespace brink::landing_test
