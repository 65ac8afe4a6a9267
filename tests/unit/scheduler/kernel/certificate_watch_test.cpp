// What the watch over a run sees, and what it lets pass.
#include "brink/scheduler/kernel/certificate_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::certificate_watch_test {
namespace {

using namespace testing;
using ::testing::HasSubstr;

TEST(CertificateWatch, AnOverlapAtAFrameEndsTheRunWithPairTimeAndDepth) {
  KernelParts parts(two_discs(), {});
  parts.watch.frame(1.5);
  EXPECT_FALSE(parts.run.halt()) << "before begin() overlaps are measured alone";
  EXPECT_NEAR(parts.watch.max_overlap(), 1.0, 1e-12);
  parts.watch.begin();
  parts.watch.frame(1.5);
  ASSERT_TRUE(parts.run.halt());
  EXPECT_THAT(parts.run.halt()->why, HasSubstr("'body0' overlaps 'body1' at t = 1.5"));
}

World two_that_stand(double apart) {
  World world = two_discs();
  world.bodies[0].initial.twist = {};
  world.bodies[1].initial.pose.position.x() = apart;
  return world;
}

TEST(CertificateWatch, TwoThatStandInEachOtherAreSeenOnceItWatches) {
  KernelParts parts(two_that_stand(0.9), {});
  parts.watch.frame(1.0);
  parts.watch.begin();
  parts.watch.frame(2.0);
  ASSERT_TRUE(parts.run.halt());
  EXPECT_THAT(parts.run.halt()->why, HasSubstr("overlaps"));
}

TEST(CertificateWatch, WhoIsPutIntoOneThatStandsIsSeenThoughBothStandStill) {
  KernelParts parts(two_that_stand(3.0), {});
  parts.watch.begin();
  for (const double t : {0.0, 0.5, 1.0}) parts.watch.frame(t);
  EXPECT_FALSE(parts.run.halt());
  std::vector<int> changed;
  ExtendedState inside = parts.trajectories.body(1).motion.extended_state(1.0);
  inside.position.x() = 0.9;
  parts.run.set_time(1.0);
  const Restart one[] = {{1, inside}};
  parts.trajectories.restart(one, changed);
  parts.watch.frame(1.5);
  ASSERT_TRUE(parts.run.halt());
  EXPECT_THAT(parts.run.halt()->why, HasSubstr("'body0' overlaps 'body1' at t = 1.5"));
}

TEST(CertificateWatch, AWayThroughAWireEndsTheRun) {
  World world = two_discs();
  world.bodies[1].initial.twist.velocity.x() = 50.0;
  KernelParts parts(world, {});
  parts.watch.begin();
  EXPECT_TRUE(parts.watch.flight(1, 0.03));
  EXPECT_FALSE(parts.watch.flight(1, 1.0));
  EXPECT_THAT(parts.run.halt()->why, HasSubstr("'body1' went through a wire of 'site0'"));
}

TEST(CertificateWatch, AWayThroughAnArcEndsTheRun) {
  World world = two_discs();
  world.bodies[1].initial.twist.velocity.x() = 50.0;
  // a bowl of wire that is open to the left
  world.sites[0].outline = std::make_shared<const Outline>(
      make_arc({3.0, 0.0}, 2.0, -0.5 * std::numbers::pi, 0.5 * std::numbers::pi, 0.0).outline);
  KernelParts parts(world, {});
  parts.watch.begin();
  EXPECT_TRUE(parts.watch.flight(1, 0.03));
  EXPECT_FALSE(parts.watch.flight(1, 1.0));
  EXPECT_THAT(parts.run.halt()->why, HasSubstr("'body1' went through a wire of 'site0'"));
}

TEST(CertificateWatch, AWayThroughTheImageOfAWireEndsTheRun) {
  World world = two_discs();
  world.bodies[1].initial.twist.velocity.x() = -50.0;
  world.bodies[0].initial.pose.position.y() = 5.0;
  world.periods.size = {20.0, 0.0};
  KernelParts parts(world, {});
  parts.watch.begin();
  // the wire at x = 5 stands at x = -15, too
  EXPECT_TRUE(parts.watch.flight(1, 0.3));
  EXPECT_FALSE(parts.watch.flight(1, 0.5));
  EXPECT_THAT(parts.run.halt()->why, HasSubstr("'body1' went through a wire of 'site0'"));
}

/// What the response saw, all of it fine: the discs touch.
CertificateWatch::Moment touching(const KernelParts& parts) {
  return {parts.trajectories.state_now(0), parts.trajectories.state_now(1), 0.0};
}

TEST(CertificateWatch, AMomentIsBelievedWhereTheMotionsLeadThroughItsPlaces) {
  KernelParts parts(two_discs(), {});
  const Certificate met = meeting(parts);
  parts.watch.begin();
  parts.run.set_time(met.time);
  CertificateWatch::Moment moment = touching(parts);
  EXPECT_TRUE(parts.watch.resolved(kDiscs, met.contact, 0.0, &moment));
  EXPECT_EQ(parts.watch.max_overlap(), 0.0);
  // what it says to be deep is looked at: these only touch
  moment.gap = -0.25;
  EXPECT_TRUE(parts.watch.resolved(kDiscs, met.contact, 0.0, &moment));
  EXPECT_LT(parts.watch.max_overlap(), 1e-15);
}

TEST(CertificateWatch, WhoIsElsewhereThanTheMomentSaysIsLookedAt) {
  KernelParts parts(two_discs(), {});
  const Certificate met = meeting(parts);
  parts.watch.begin();
  parts.run.set_time(met.time);
  const CertificateWatch::Moment moment = touching(parts);
  // a restart that puts it deeper, by next to nothing and by more than is allowed
  for (const double deeper : {1e-15, 1e-6}) {
    std::vector<int> changed;
    ExtendedState inside = moment.body;
    inside.position.x() += deeper;
    const Restart one[] = {{0, inside}};
    parts.trajectories.restart(one, changed);
    EXPECT_EQ(parts.watch.resolved(kDiscs, met.contact, 0.0, &moment), deeper < 1e-12) << deeper;
    EXPECT_NEAR(parts.watch.max_overlap() / deeper, 1.0, 0.5);
  }
  EXPECT_THAT(parts.run.halt()->why, HasSubstr("overlaps"));
}

TEST(CertificateWatch, AContactThatPartsIsNone) {
  KernelParts parts(two_discs(), {});
  parts.watch.begin();
  EXPECT_TRUE(parts.watch.approaches(kDiscs, -1e-12, 1e-9));
  EXPECT_FALSE(parts.watch.approaches(kDiscs, -1e-3, 1e-9));
}

TEST(CertificateWatch, AnOverlapAtTheStartIsNamedAndASmallOneAllowed) {
  World world = two_discs();
  world.bodies[1].initial.pose.position.x() = 0.9;
  EXPECT_THAT(KernelParts(world, {}).watch.start_fault(), HasSubstr("overlap by 0.1 m at the start"));
  world.bodies[1].initial.pose.position.x() = 1.0 - 1e-8;
  KernelParts parts(world, {});
  EXPECT_EQ(parts.watch.start_fault(), "");
  parts.watch.begin();
  parts.watch.frame(0.0);
  EXPECT_FALSE(parts.run.halt());
}

}  // namespace
}  // namespace brink::certificate_watch_test
