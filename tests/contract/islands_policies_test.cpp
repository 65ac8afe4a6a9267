// Random worlds in which contacts last: the same bits under every exact policy and after every resume, nobody
// in anybody else, and no energy from nowhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "tests/support/lasting_worlds.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/same_events.h"
#include "tests/support/seeded_random.h"

namespace brink::islands_policies_test {
namespace {

using testing::LastingWorld;

/// Seeds 0 .. kWorlds - 1; BRINK_WORLDS asks for more, BRINK_SEED for one alone; and heaps, BRINK_HEAPS asks for more. Each is broken off kBreaks times and
/// gone on with, BRINK_BREAKS asks for more; and as often it goes on from a checkpoint. BRINK_MODES:
/// solver.modes_contacts. The first kOrdered worlds and BRINK_ORDERED more come once more under each of the other orders
/// in turn.
constexpr std::uint64_t kWorlds = 32, kBreaks = 4, kHeaps = 8, kOrdered = 15;
/// Seeds from this one on: of another order than "index".
constexpr std::uint64_t kOtherOrder = 2 * testing::LastingWorldMaker::kHeaps;
/// Hollow corners, walls that rise from a joint, and a corner that comes along the floor of another were passed through in these;
/// in 110 two who met where a step by modes of both ended did so under some policies only.
constexpr std::array<std::uint64_t, 10> kOnceFailed{43, 44, 51, 58, 59, 76, 84, 98, 110, 153};

std::vector<std::uint64_t> seeds() {
  if (const char* one = std::getenv("BRINK_SEED")) return {std::stoull(one)};
  const char* more = std::getenv("BRINK_WORLDS");
  std::vector<std::uint64_t> all(more ? std::stoull(more) : kWorlds);
  std::iota(all.begin(), all.end(), 0);
  if (!more) all.insert(all.end(), kOnceFailed.begin(), kOnceFailed.end());
  const char* heaps = std::getenv("BRINK_HEAPS");
  for (std::uint64_t k = 0; k < (heaps ? std::stoull(heaps) : kHeaps); ++k)
    all.push_back(testing::LastingWorldMaker::kHeaps + k);
  const char* ordered = std::getenv("BRINK_ORDERED");
  for (std::uint64_t k = 0; k < (ordered ? std::stoull(ordered) : kOrdered); ++k)
    all.push_back(kOtherOrder + k);
  return all;
}

std::uint64_t breaks() {
  const char* more = std::getenv("BRINK_BREAKS");
  return more ? std::stoull(more) : kBreaks;
}

LastingWorld make(std::uint64_t seed) {
  const bool ordered = seed >= kOtherOrder;
  const std::uint64_t of_world = ordered ? seed - kOtherOrder : seed;
  LastingWorld w = testing::LastingWorldMaker(of_world).make();
  if (ordered) w.order = orders()[1 + of_world % (orders().size() - 1)].name;
  return w;
}

SolverOptions by(const LastingWorld& w, const std::string& policy) {
  SolverOptions options;
  options.policy = policy;
  options.order = w.order;
  options.persistent = true;
  options.max_collisions = 200000;
  options.island_tolerance = w.island_tolerance;
  if (const char* modes = std::getenv("BRINK_MODES")) options.modes_contacts = std::stoull(modes);
  return options;
}

/// Patience is for what would hang: a run that is broken off fails.
RunOptions options_to(double end, double frame_interval = 0.0) {
  RunOptions options = testing::until(end);
  options.frame_interval = frame_interval;
  const auto begin = std::chrono::steady_clock::now();
  options.progress = [begin](double t, std::uint64_t) {
    if (std::chrono::steady_clock::now() - begin < std::chrono::seconds(120)) return true;
    ADD_FAILURE() << "broken off at t = " << t;
    return false;
  };
  return options;
}

struct Told {
  std::vector<Event> events;
  RunSummary summary;
};

Told run(const LastingWorld& w, const std::string& policy) {
  Simulator simulator(w.world, by(w, policy));
  testing::Events events;
  const RunSummary summary = simulator.run(options_to(w.duration, w.duration / 7.0), &events);
  return {events.events, summary};
}

/// How the second differs from the first, in words; empty: not at all. It may have begun later: its events go
/// by their numbers.
std::string difference(const Told& whole, const Told& other) {
  const auto &a = whole.events, &b = other.events;
  const std::size_t skipped = b.empty() ? a.size() : std::min<std::size_t>(b.front().seq, a.size());
  for (std::size_t k = 0; k < std::min(a.size() - skipped, b.size()); ++k)
    if (!testing::same(a[k + skipped], b[k]))
      return "event " + std::to_string(k + skipped) + ": " + testing::text(b[k]) + ", not " +
             testing::text(a[k + skipped]);
  if (a.size() != b.size() + skipped)
    return std::to_string(b.size() + skipped) + " events, not " + std::to_string(a.size());
  if (whole.summary.termination_text() != other.summary.termination_text())
    return "ends '" + other.summary.termination_text() + "', not '" + whole.summary.termination_text() + "'";
  return whole.summary.state_hash == other.summary.state_hash ? "" : "another state at the end";
}

/// The world, or where a run cannot go on as much of it as can be looked at: SeenFromOutside counts those.
LastingWorld make_as_far_as_it_goes(std::uint64_t seed) {
  LastingWorld w = make(seed);
  const RunSummary summary = run(w, "body_clocks").summary;
  if (summary.termination != Termination::reached_end) w.duration = 0.95 * summary.end_time;
  return w;
}

std::string named(std::uint64_t seed, const LastingWorld& w) {
  return "seed " + std::to_string(seed) + ", " + w.ground + " of " + std::to_string(w.world.bodies.size()) +
         ", order " + w.order;
}

/// Tells of a difference; 1 if there is one.
int tell(const std::string& different, const std::string& of) {
  if (different.empty()) return 0;
  std::printf("%s: %s\n", of.c_str(), different.c_str());
  return 1;
}

TEST(Islands, UnderEveryPolicyGiveTheSameEvents) {
  int different = 0;
  for (const std::uint64_t seed : seeds()) {
    const LastingWorld w = make_as_far_as_it_goes(seed);
    const Told reference = run(w, "global_backup");
    for (const std::string& policy : testing::other_exact_policies())
      different += tell(difference(reference, run(w, policy)), named(seed, w) + ", " + policy);
  }
  EXPECT_EQ(different, 0);
}

/// Keeps some of the checkpoints, each of all as likely, and the events told before each.
class SomeCheckpoints : public testing::Events {
 public:
  SomeCheckpoints(Random& random, std::uint64_t most) : random_(&random), most_(most) {}
  void checkpoint(double, const std::vector<std::byte>& state) override {
    const std::uint64_t place = seen_++ < most_ ? seen_ - 1 : random_->below(seen_);
    if (place >= most_) return;
    kept.resize(std::max<std::size_t>(kept.size(), place + 1));
    kept[place] = state;
  }
  std::vector<std::vector<std::byte>> kept;

 private:
  Random* random_;
  std::uint64_t most_, seen_ = 0;
};

/// Goes on from `state` in a simulator that knows nothing else.
Told go_on(const LastingWorld& w, const std::string& policy, const std::vector<std::byte>& state) {
  Simulator simulator(w.world, by(w, policy));
  simulator.restore(state);
  RunOptions options = options_to(w.duration);
  options.first_frame = false;
  testing::Events events;
  const RunSummary summary = simulator.run(options, &events);
  return {events.events, summary};
}

/// Runs in pieces, each in a simulator that knows those before by a snapshot alone.
Told run_in_pieces(const LastingWorld& w, const std::string& policy, std::vector<double> ends) {
  std::sort(ends.begin(), ends.end());
  ends.push_back(w.duration);
  testing::Events events;
  RunSummary summary;
  std::vector<std::byte> state;
  for (const double end : ends) {
    Simulator simulator(w.world, by(w, policy));
    if (!state.empty()) simulator.restore(state);
    summary = simulator.run(options_to(end), &events);
    if (summary.termination != Termination::reached_end) break;
    state = simulator.snapshot();
  }
  return {events.events, summary};
}

/// Runs to the end, one collision at a time.
Told run_by_events(const LastingWorld& w, const std::string& policy) {
  Simulator simulator(w.world, by(w, policy));
  testing::Events events;
  RunSummary summary;
  do {
    RunOptions options = options_to(w.duration);
    options.first_frame = false;
    summary = simulator.step_to_next_event(options, &events);
  } while (summary.termination == Termination::stopped && !::testing::Test::HasFailure());
  return {events.events, summary};
}

TEST(Islands, SteppedFromCollisionToCollisionGoOnWithTheSameBits) {
  int different = 0;
  for (const std::uint64_t seed : seeds()) {
    const LastingWorld w = make_as_far_as_it_goes(seed);
    const std::string policy = exact_policies()[seed % exact_policies().size()];
    different += tell(difference(run(w, policy), run_by_events(w, policy)), named(seed, w) + ", " + policy);
  }
  EXPECT_EQ(different, 0);
}

// Times at random lie within steps and in rests; checkpoints at every chance, between events of one instant.
TEST(Islands, ResumedAnywhereGoOnWithTheSameBits) {
  int different = 0;
  for (const std::uint64_t seed : seeds()) {
    SeededRandom random(seed);
    const LastingWorld w = make_as_far_as_it_goes(seed);
    const std::string policy = exact_policies()[seed % exact_policies().size()];
    const std::string name = named(seed, w) + ", " + policy;
    const Told whole = run(w, policy);
    std::vector<double> ends;
    for (std::uint64_t k = 0; k < breaks(); ++k) ends.push_back(random.uniform(0.0, w.duration));
    different += tell(difference(whole, run_in_pieces(w, policy, ends)), name + ", in pieces");
    SomeCheckpoints checkpoints(random, breaks());
    RunOptions often = options_to(w.duration);
    often.checkpoint_seconds = 0.0;
    Simulator(w.world, by(w, policy)).run(often, &checkpoints);
    for (const auto& state : checkpoints.kept)
      different += tell(difference(whole, go_on(w, policy, state)), name + ", from a checkpoint");
  }
  EXPECT_EQ(different, 0);
}

/// Frames at even times, and others at random ones between.
RunSummary watched(const LastingWorld& w, Random& random, outside::FrameWatch& watch) {
  Simulator simulator(w.world, by(w, "body_clocks"));
  std::vector<double> ends{w.duration};
  for (int k = 0; k < 40; ++k) ends.push_back(random.uniform(0.0, w.duration));
  std::sort(ends.begin(), ends.end());
  RunSummary summary;
  for (const double end : ends) {
    summary = simulator.run(options_to(end, 0.01), &watch);
    if (summary.termination != Termination::reached_end) break;
  }
  return summary;
}

TEST(Islands, SeenFromOutsideKeepApartAndWinNothing) {
  constexpr double kOverlap = 1e-9, kWon = 1e-10;
  int stopped = 0, overlapping = 0;
  for (const std::uint64_t seed : seeds()) {
    SeededRandom random(seed);
    const LastingWorld w = make(seed);
    outside::FrameWatch watch(w.world, w.duration, kOverlap);
    const RunSummary summary = watched(w, random, watch);
    const bool conserves = !w.moves && !w.pulls;
    std::printf("%s: %llu collisions, %llu steps, deepest %.1e m, gained %.1e at %.4f s%s, %s\n",
                named(seed, w).c_str(), static_cast<unsigned long long>(summary.collisions),
                static_cast<unsigned long long>(summary.island_steps), static_cast<double>(watch.deepest),
                static_cast<double>(watch.gained), watch.when, conserves ? "" : " (may)",
                summary.termination_text().c_str());
    if (!watch.sound()) std::printf("  %s", watch.report().c_str());
    overlapping += !watch.sound();
    EXPECT_LE(conserves ? watch.gained : 0.0L, kWon) << named(seed, w) << " at " << watch.when;
    stopped += summary.termination != Termination::reached_end;
  }
  std::printf("%d could not go on, %d overlapped\n", stopped, overlapping);
  EXPECT_EQ(stopped, 0);
  EXPECT_EQ(overlapping, 0);
}

}  // namespace
}  // namespace brink::islands_policies_test
