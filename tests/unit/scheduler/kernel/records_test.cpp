// Frames on the clock, events in order, checkpoints when they are due.
#include "brink/scheduler/kernel/records.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::records_test {
namespace {

using namespace testing;

TEST(Records, FramesAreDueOnTheFrameClock) {
  KernelParts parts(two_discs(), {});
  EXPECT_FALSE(parts.records.frame_due(100.0));
  RunOptions options;
  options.frame_interval = 0.1;
  parts.run.begin(options);
  Events told;
  parts.records.begin(&told);
  while (const auto due = parts.records.frame_due(0.35)) parts.records.frame_of_clock(*due);
  EXPECT_EQ(told.frame_times, (std::vector<double>{0.1, 0.2, 0.30000000000000004}));
  EXPECT_EQ(parts.records.last_frame(), told.frame_times.back());
}

// Within an instant the clock may be a rounding back: times are told in order all the same, and what is left
// over says when it was.
TEST(Records, EventsAreNeverToldBeforeTheLast) {
  KernelParts parts(two_discs(), {});
  Events told;
  parts.records.begin(&told);
  const FeatureContact contact = meeting(parts).contact;
  parts.run.set_time(1.0);
  parts.records.event(EventKind::collision, kDiscs, contact, 1.0, 0.0, Real(0));
  parts.run.set_time(std::nextafter(1.0, 0.0));
  parts.records.event(EventKind::collision, kDiscs, contact, 2.0, 0.0, Real(0));
  ASSERT_EQ(told.events.size(), 2U);
  EXPECT_EQ(told.events[1].seq, 1U);
  EXPECT_EQ(told.events[1].contact.time, 1.0);
  EXPECT_EQ(told.events[1].contact.time_low, std::nextafter(1.0, 0.0) - 1.0);
}

TEST(Records, WhatIsHeldBackIsToldInOrderOrDropped) {
  KernelParts parts(two_discs(), {});
  Events told;
  parts.records.begin(&told);
  for (const bool tells : {true, false}) {
    Records::HeldBack held_back(parts.records);
    parts.records.event(EventKind::collision, kDiscs, {}, 1.0, 0.0, Real(0));
    parts.records.event(EventKind::collision, kWall, {}, 2.0, 0.0, Real(0));
    if (tells) held_back.told();
  }
  parts.records.event(EventKind::collision, kDiscs, {}, 3.0, 0.0, Real(0));
  ASSERT_EQ(told.events.size(), 3U);
  EXPECT_EQ(told.events[0].impulse_n, 1.0);
  EXPECT_EQ(told.events[1].impulse_n, 2.0);
  EXPECT_EQ(told.events[2].impulse_n, 3.0);
}

TEST(Records, EventsThatNobodyWantsAreCountedAllTheSame) {
  KernelParts parts(two_discs(), {});
  RunOptions options;
  options.record_events = false;
  parts.run.begin(options);
  Events told;
  parts.records.begin(&told);
  parts.records.event(EventKind::collision, kDiscs, {}, 1.0, 0.0, Real(0));
  EXPECT_TRUE(told.events.empty());
  EXPECT_EQ(parts.records.saved().seq, 1U);
}

TEST(Records, ARecorderThatOverridesNothingIsAsked) {
  KernelParts parts(two_discs(), {});
  Recorder nobody;
  RunOptions options;
  options.checkpoint_seconds = 0.0;
  parts.run.begin(options);
  parts.records.begin(&nobody);
  EXPECT_TRUE(parts.records.checkpoint_due());
  parts.records.checkpoint([] { return std::vector<std::byte>(); });
  parts.records.frame(0.0);
  options.checkpoint_seconds = -1.0;
  parts.run.begin(options);
  EXPECT_FALSE(parts.records.checkpoint_due());
}

// Of a million bodies each takes seconds: once a second would be all that the run does.
TEST(Records, CheckpointsThatTakeLongAreDueMoreSeldom) {
  for (const double seconds : {1e-3, 0.0}) {
    KernelParts parts(two_discs(), {});
    Recorder nobody;
    RunOptions options;
    options.checkpoint_seconds = seconds;
    parts.run.begin(options);
    parts.records.begin(&nobody);
    const auto sleep = [](int milliseconds) {
      std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    };
    sleep(2);
    EXPECT_TRUE(parts.records.checkpoint_due());
    parts.records.checkpoint([&] {
      sleep(100);
      return std::vector<std::byte>();
    });
    sleep(2);
    EXPECT_EQ(parts.records.checkpoint_due(), seconds == 0.0);  // at every chance
  }
}

// Whatever led there, and whichever number of the state it is.
TEST(Records, AStateThatIsNotFiniteIsNeverTold) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const BodyState still{{Vec2(3.0, 0.0), 0.0}, {Vec2(0.0, 0.0), 0.0}};
  std::vector<BodyState> bad(6, still);
  bad[0].pose.position.x() = nan;
  bad[1].pose.position.y() = inf;
  bad[2].pose.angle = -inf;
  bad[3].twist.velocity.x() = inf;
  bad[4].twist.velocity.y() = nan;
  bad[5].twist.omega = inf;
  for (std::size_t k = 0; k < bad.size(); ++k) {
    KernelParts parts(two_discs(), {});
    Events told;
    parts.records.begin(&told);
    const FeatureContact contact = meeting(parts).contact;
    parts.records.frame(0.0);
    parts.records.event(EventKind::collision, kDiscs, contact, 1.0, 0.0, Real(0), {true, still, {}},
                        {true, still, {}});
    ASSERT_FALSE(parts.run.halt());
    parts.run.set_time(0.5);
    parts.records.event(EventKind::collision, kDiscs, contact, 1.0, 0.0, Real(0), {true, still, {}},
                        {true, bad[k], {}});
    ASSERT_TRUE(parts.run.halt()) << k;
    EXPECT_EQ(parts.run.halt()->termination, Termination::failed);
    EXPECT_EQ(parts.run.halt()->why, "the state of 'body1' is not finite at t = 0.5 s");
    parts.run.forget_halt();
    parts.records.event(EventKind::collision, kDiscs, contact, nan, 0.0, Real(0));
    EXPECT_TRUE(parts.run.halt()) << "an impulse";
    EXPECT_EQ(told.events.size(), 1U) << k;
    parts.run.forget_halt();
    parts.records.knot({0.5, 0, bad[k].pose, {}, bad[k].twist});
    EXPECT_TRUE(parts.run.halt()) << k;
    parts.run.forget_halt();
    parts.trajectories.restart_free(1, bad[k], {});
    parts.records.frame(0.5);
    ASSERT_TRUE(parts.run.halt()) << k;
    EXPECT_EQ(parts.run.halt()->why, "the state of 'body1' is not finite at t = 0.5 s");
    EXPECT_EQ(told.frame_times, std::vector<double>{0.0}) << k;
  }
}

struct Lasted : Events {
  void contact_lasted(const LastedContact& c) override { lasted.push_back(c); }
  std::vector<LastedContact> lasted;
};

TEST(Records, AnEndingOrAContactThatLastedIsNeverToldWithANumberThatIsNotFinite) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  KernelParts parts(two_discs(), {});
  Lasted told;
  parts.records.begin(&told);
  parts.run.set_time(0.5);
  const FeatureContact good = meeting(parts).contact;
  std::vector<FeatureContact> bad(4, good);
  bad[0].point.x() = inf;
  bad[1].normal.y() = nan;
  bad[2].gap = nan;
  bad[3].closing_speed = -inf;
  parts.records.ending(EventKind::zeno, kDiscs, good, 0.75);
  ASSERT_FALSE(parts.run.halt());
  for (const FeatureContact& contact : bad) {
    parts.records.ending(EventKind::zeno, kDiscs, contact, 0.75);
    ASSERT_TRUE(parts.run.halt());
    EXPECT_EQ(parts.run.halt()->termination, Termination::failed);
    EXPECT_THAT(parts.run.halt()->why, ::testing::HasSubstr("is not finite at t = 0.5 s"));
    parts.run.forget_halt();
  }
  parts.records.ending(EventKind::zeno, kDiscs, good, nan);
  ASSERT_TRUE(parts.run.halt()) << "a limit";
  parts.run.forget_halt();
  EXPECT_EQ(told.events.size(), 1U);

  HeldContact held;
  held.pair = kDiscs;
  held.feature.normal = Vec2(1.0, 0.0);
  held.since = 0.25;
  std::vector<HeldContact> wrong(3, held);
  wrong[0].place.x() = nan;
  wrong[1].normal_force = inf;
  wrong[2].tangential_force = nan;
  parts.records.lasted(held);
  ASSERT_FALSE(parts.run.halt());
  for (const HeldContact& c : wrong) {
    parts.records.lasted(c);
    EXPECT_TRUE(parts.run.halt());
    parts.run.forget_halt();
  }
  EXPECT_EQ(told.lasted.size(), 1U);
}

}  // namespace
}  // namespace brink::records_test
