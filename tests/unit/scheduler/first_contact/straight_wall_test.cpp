// A disc that goes straight at a straight wall: the general search's contact, bit for bit.
#include "brink/scheduler/first_contact/straight_wall.h"

#include <gtest/gtest.h>

#include "brink/core/base/limits.h"
#include "brink/core/shapes/shapes.h"
#include "tests/support/flier.h"
#include "tests/support/seeded_random.h"

namespace brink::straight_wall_test {
namespace {

using testing::Flier;

// Walls of any direction, turned and moved, thin and thick; discs that come from either side, early and late.
TEST(StraightWall, IsMetAtTheGeneralSearchsTime) {
  SeededRandom r(31);
  SearchLimits limits;
  limits.closed_forms = false;
  SearchScratch scratch;
  WorkCounters work;
  int met = 0, told = 0;
  for (int k = 0; k < 40000; ++k) {
    const double late = std::pow(10.0, r.uniform(-3.0, 5.0)), speed = std::pow(10.0, r.uniform(-1.0, 1.0));
    const double half = r.uniform(1.0, 50.0), angle = k % 3 ? r.uniform(-4.0, 4.0) : 0.0;
    const double direction = k % 2 ? 0.0 : r.uniform(-3.0, 3.0);
    const Vec2 tangent(std::cos(direction), std::sin(direction));
    const Vec2 centre(r.uniform(-20.0, 20.0), r.uniform(-20.0, 20.0));
    const Flier wall(make_segment(centre - half * tangent, centre + half * tangent, k % 5 ? 0.0 : 0.1),
                     Motion::still({{r.uniform(-3.0, 3.0), r.uniform(-3.0, 3.0)}, angle}));
    const Frame frame(wall.motion.start().pose);
    const Vec2 along = frame.direction_to_world(tangent), across = (k % 7 ? 1.0 : -1.0) * perp(along);
    const double since = r.uniform(0.0, std::min(late, 1.0));
    const Vec2 velocity =
        (k % 11 ? speed : -speed) * (r.uniform(-1.0, 1.0) * along - r.uniform(0.05, 1.0) * across);
    const Vec2 place =
        frame.to_world(centre) + half * r.uniform(-1.1, 1.1) * along + r.uniform(1.0, 4.0) * across;
    const Flier disc(make_disc(r.uniform(0.2, 0.8)),
                     Motion::ballistic(late - since, {{place, 0.0}, {velocity, r.uniform(-1.0, 1.0)}}, {}));
    const double from = disc.motion.origin(), to = from + 40.0 / speed;
    const auto straight = StraightWall::of(wall.mover().outline(), wall.motion);
    ASSERT_TRUE(straight);
    WallContact contact;
    const bool quick = straight_wall_met({&disc.motion, disc.mover().outline().bounding_radius, 0.0},
                                         *straight, from, to, limits, contact);
    const PairAnswer slow = first_contact(disc.mover(), wall.mover(), from, to, limits, scratch, work);
    met += slow.status == PairAnswer::Status::contact;
    const double soonest =
        soonest_at_wall({&disc.motion, disc.mover().outline().bounding_radius, 0.0}, *straight, limits);
    ASSERT_EQ(soonest == kForever, k % 11 == 0) << "case " << k;
    if (slow.status == PairAnswer::Status::contact) {
      ASSERT_LE(soonest, slow.contact.time) << "case " << k;
    }
    told += quick;
    if (!quick) continue;
    ASSERT_EQ(slow.status, PairAnswer::Status::contact) << "case " << k;
    ASSERT_EQ(contact.time, slow.contact.time) << "case " << k;
    ASSERT_EQ(contact.gap, slow.contact.gap) << "case " << k;
    ASSERT_NEAR(contact.closing_speed, slow.contact.closing_speed, 1e-9 * speed) << "case " << k;
    ASSERT_GT(contact.normal.dot(slow.contact.normal), 1.0 - 1e-12) << "case " << k;
  }
  EXPECT_GT(met, 10000);
  EXPECT_GT(told, met * 8 / 10);
}

// Discs beside the wall's line, spanning it beyond an end, that go along it or away from it: where the end lies ahead it is met.
TEST(StraightWall, IsNotMetBeforeTheSoonest) {
  SeededRandom r(32);
  SearchLimits limits;
  SearchScratch scratch;
  WorkCounters work;
  int met = 0, never = 0;
  for (int k = 0; k < 20000; ++k) {
    const double turn = r.uniform(0.0, 7.0), radius = r.uniform(0.2, 0.8), half = r.uniform(0.1, 2.0);
    const Vec2 along(std::cos(turn), std::sin(turn));
    const Flier wall(make_segment(-half * along, half * along, k % 3 ? 0.0 : 0.1),
                     Motion::still({{r.uniform(-3.0, 3.0), r.uniform(-3.0, 3.0)}, 0.0}));
    const double reach = radius + (k % 3 ? 0.0 : 0.1);
    const Vec2 place = wall.motion.start().pose.position + (half + reach * r.uniform(1.0, 3.0)) * along +
                       reach * r.uniform(-1.2, 1.2) * perp(along);
    const Vec2 velocity = r.uniform(0.1, 5.0) * (r.uniform(-0.4, 0.4) * perp(along) - along);
    const Flier disc(make_disc(radius), Motion::ballistic(0.0, {{place, 0.0}, {velocity, 0.0}}, {}));
    const auto straight = StraightWall::of(wall.mover().outline(), wall.motion);
    ASSERT_TRUE(straight);
    const double soonest = soonest_at_wall({&disc.motion, radius, 0.0}, *straight, limits);
    never += soonest == kForever;
    const PairAnswer slow = first_contact(disc.mover(), wall.mover(), 0.0, 20.0, limits, scratch, work);
    if (slow.status != PairAnswer::Status::contact) continue;
    ++met;
    ASSERT_LE(soonest, slow.contact.time) << "case " << k;
  }
  EXPECT_GT(met, 8000);
  EXPECT_GT(never, 500);
}

TEST(StraightWall, IsOneSegmentThatStandsStill) {
  const Motion still = Motion::still({});
  EXPECT_TRUE(StraightWall::of(make_segment({0.0, 0.0}, {1.0, 0.0}).outline, still));
  EXPECT_FALSE(StraightWall::of(make_box(1.0, 1.0).outline, still));
  EXPECT_FALSE(StraightWall::of(make_segment({0.0, 0.0}, {1.0, 0.0}).outline,
                                Motion::ballistic(0.0, {{}, {{1.0, 0.0}, 0.0}}, {})));
}

}  // namespace
}  // namespace brink::straight_wall_test
