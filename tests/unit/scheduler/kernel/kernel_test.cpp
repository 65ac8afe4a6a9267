// The kernel's verbs, and what a policy cannot do: it does not compile.
#include "brink/scheduler/kernel/kernel.h"

#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "brink/scheduler/kernel/run_kernel.h"
#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::kernel_test {
namespace {

using namespace testing;

template <class K>
concept Begins = requires(K& kernel, const RunOptions& options, Recorder* recorder) {
  kernel.begin(options, recorder);
};
template <class K>
concept Snapshots = requires(K& kernel) {
  kernel.snapshot();
};
template <class K>
concept Restores = requires(K& kernel, std::span<const std::byte> bytes) {
  kernel.restore(bytes);
};
template <class K>
concept Regroups = requires(K& kernel, std::vector<std::vector<int>> sets, std::vector<int>& changed) {
  kernel.regroup(sets, changed);
};
template <class K>
concept SetsStates = requires(K& kernel, const BodyState& state) {
  kernel.set_state(0, state);
};
template <class K>
concept ShowsParts = requires(K& kernel) {
  kernel.parts_;
};
template <class K>
concept Resolves = requires(K& kernel, const PairKey& pair, const FeatureContact& contact,
                            std::vector<int>& changed) {
  kernel.resolve(pair, contact, changed);
};

// the simulator's kernel can, so that each says what it seems to say
static_assert(Begins<RunKernel> && Snapshots<RunKernel> && Restores<RunKernel> && SetsStates<RunKernel>);
static_assert(!Begins<Kernel> && !Snapshots<Kernel> && !Restores<Kernel> && !Regroups<Kernel>);
static_assert(!SetsStates<Kernel> && !ShowsParts<Kernel>);
// whoever is shown the kernel alone cannot even do what policies can
static_assert(Resolves<Kernel> && !Resolves<KernelView> && !Resolves<const Kernel>);

/// A run of the two discs that has begun.
struct Begun {
  Begun() : kernel(two_discs(), {}) { kernel.begin(until(10.0), &events); }
  Certificate meeting() { return *kernel.search(kDiscs, kernel.time(), 10.0); }

  Events events;
  RunKernel kernel;
};

bool same_motion(const BodyTrack& a, const BodyTrack& b) {
  return a.version == b.version && a.motion.state(3.0).pose.position == b.motion.state(3.0).pose.position;
}

TEST(Kernel, AdvancingAndBackingUpSetClocksAndCountsAlone) {
  Begun run;
  const BodyTrack before = run.kernel.body(0);
  ASSERT_TRUE(run.kernel.extend_motions(2.0));
  run.kernel.advance_all(0.75);
  EXPECT_EQ(run.kernel.time(), 0.75);
  EXPECT_EQ(run.kernel.work().advances, 2U);
  run.kernel.back_up_all(0.5);
  EXPECT_EQ(run.kernel.time(), 0.5);
  EXPECT_EQ(run.kernel.work().backups, 2U);
  EXPECT_DOUBLE_EQ(run.kernel.work().body_seconds_thrown_away, 0.5);
  run.kernel.advance_pair(kWall, 0.625);  // the body of the pair, and the clock with it
  EXPECT_EQ(run.kernel.time(), 0.625);
  EXPECT_EQ(run.kernel.work().advances, 3U);
  EXPECT_TRUE(same_motion(run.kernel.body(0), before));
}

TEST(Kernel, NearPairsAreThoseThatMayMeet) {
  Begun run;
  const auto pairs = run.kernel.near_pairs(0.0, 1.5);
  EXPECT_NE(std::find(pairs.begin(), pairs.end(), kDiscs), pairs.end());
  for (const PairKey& pair : run.kernel.near_pairs(0.0, 0.25)) EXPECT_FALSE(pair == kDiscs);
  for (const PairKey& pair : run.kernel.near_pairs_of(0, 0.0, 1.5)) EXPECT_EQ(pair.body, 0);
}

TEST(Kernel, ASearchChangesNothingAndSaysWhen) {
  Begun run;
  const BodyTrack before = run.kernel.body(0);
  const Certificate c = run.meeting();
  EXPECT_EQ(c.kind, Certificate::Kind::contact);
  EXPECT_NEAR(c.time, 1.0, 1e-12);
  EXPECT_TRUE(run.kernel.fresh(c));
  EXPECT_EQ(run.kernel.time(), 0.0);
  EXPECT_TRUE(same_motion(run.kernel.body(0), before));
  EXPECT_FALSE(run.kernel.search(kDiscs, 0.0, 0.5).has_value());
}

TEST(Kernel, AResolveRaisesVersionsTellsWhoAndRecordsOneEvent) {
  Begun run;
  const Certificate c = run.meeting();
  run.kernel.advance_all(c.time);
  std::vector<int> changed;
  ASSERT_TRUE(run.kernel.resolve(c.pair, c.contact, changed));
  EXPECT_EQ(changed, (std::vector<int>{0, 1}));
  EXPECT_FALSE(run.kernel.fresh(c));
  ASSERT_EQ(run.events.events.size(), 1U);
  EXPECT_EQ(run.events.events[0].kind, EventKind::collision);
  EXPECT_EQ(run.kernel.collisions(), 1U);
  // equal masses hand on what they have
  EXPECT_NEAR(run.kernel.state(0, 1.5).twist.velocity.x(), 0.0, 1e-12);
  EXPECT_NEAR(run.kernel.state(1, 1.5).twist.velocity.x(), 2.0, 1e-12);
}

TEST(Kernel, WhatIsResolvedAheadIsToldWhenItIsCertainOrUndone) {
  Begun run;
  const Certificate c = run.meeting();
  const std::vector<std::uint64_t> before = run.kernel.versions(0);
  std::vector<int> changed;
  ASSERT_TRUE(run.kernel.resolve_ahead(c, 2.0, changed));
  EXPECT_TRUE(run.kernel.is_resolved_ahead(c));
  EXPECT_TRUE(run.events.events.empty());
  EXPECT_EQ(run.kernel.versions(0).size(), before.size() + 1);
  run.kernel.roll_back_all();
  EXPECT_EQ(run.kernel.versions(0), before);
  ASSERT_TRUE(run.kernel.resolve_ahead(c, 2.0, changed));
  ASSERT_TRUE(run.kernel.confirm(c, changed));
  EXPECT_EQ(run.kernel.time(), c.time);
  EXPECT_EQ(run.events.events.size(), 1U);
}

TEST(Kernel, DisplacesABodyAndHaltsForAReason) {
  Begun run;
  run.kernel.displace(1, {0.25, 0.5});
  EXPECT_EQ(run.kernel.state(1, 0.0).pose.position, Vec2(3.25, 0.5));
  EXPECT_FALSE(run.kernel.halt().has_value());
  run.kernel.stop(Termination::stopped, "enough");
  ASSERT_TRUE(run.kernel.halt().has_value());
  EXPECT_FALSE(run.kernel.poll());
}

TEST(Kernel, FramesAreThoseOfTheFrameClock) {
  Events events;
  RunKernel kernel(two_discs(), {});
  RunOptions options = until(1.0);
  options.frame_interval = 0.25;
  kernel.begin(options, &events);
  ASSERT_TRUE(kernel.extend_motions(1.0));
  const std::size_t at_start = events.frame_times.size();
  ASSERT_TRUE(kernel.record_frames(0.6));
  EXPECT_EQ(events.frame_times.size(), at_start + 2);
  EXPECT_EQ(events.frame_times.back(), 0.5);
}

}  // namespace
}  // namespace brink::kernel_test
