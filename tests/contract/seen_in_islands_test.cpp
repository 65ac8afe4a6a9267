// Where contacts last no event tells how bodies move. What a run file, and the replay page in a real browser, show of
// them between frames is held against simulations to those times, in gallery scenes and in random worlds.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "brink/core/query/outline_gap.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/run_moment.h"
#include "brink/scenes/run_file/run_scene.h"
#include "brink/scenes/view/replay_page.h"
#include "brink/scheduler/kernel/site_motion.h"
#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/simulator/simulator.h"
#include "tests/support/browser.h"
#include "tests/support/lasting_worlds.h"
#include "tests/support/same_events.h"

namespace brink::seen_in_islands_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(fs::temp_directory_path() / fmt::format("brink-{}-{}", name, ::getpid())) {}
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Where the bodies are at these times, by a simulation that stops at each. Nothing of a run that the watch ends: modes
/// are not yet sound in every world (docs/contacts-that-last.md).
std::vector<std::vector<BodyState>> simulated(const World& world, const SolverOptions& solver,
                                              const std::vector<double>& times) {
  std::vector<std::vector<BodyState>> all;
  Simulator simulator(world, solver);
  RunOptions options;
  options.checkpoint_seconds = -1.0;
  for (const double t : times) {
    options.until = t;
    if (simulator.run(options).termination != Termination::reached_end) return {};
    all.push_back(simulator.states());
  }
  return all;
}

std::vector<double> random_times(std::uint64_t seed, double duration, int count) {
  Random random(seed);
  std::vector<double> times;
  for (int k = 0; k < count; ++k) times.push_back(duration * random.uniform());
  std::sort(times.begin(), times.end());
  return times;
}

/// How far any point of the body is from where it should be [m].
double off(const Body& body, const Pose& a, const Pose& b) {
  return (a.position - b.position).norm() + body.outline->bounding_radius * std::abs(a.angle - b.angle);
}

/// Of the whole run [m].
double length_of(const RunFile& run) {
  const Box all = extent_of(run, run.world());
  return (all.high - all.low).norm();
}

struct Seen : ::testing::TestWithParam<const char*> {};

TEST_P(Seen, WhereContactsLastTheRunFileAndThePageShowWhatHappened) {
  const Folder folder(std::string("seen-") + GetParam());
  const Scene scene =
      load_scene(fs::path(BRINK_SOURCE_DIR) / "scenes/gallery" / (GetParam() + std::string(".toml")));
  RunRequest request;
  request.dir = folder.path();
  ASSERT_TRUE(run_scene(scene, request).summary.sound());
  const auto times = random_times(7, scene.duration, 1000);
  const auto states = simulated(scene.world, scene.solver, times);
  ASSERT_EQ(states.size(), times.size());
  const RunFile run(folder.path() / "run.db");
  const double length = length_of(run);
  const auto& bodies = scene.world.bodies;

  double of_file = 0.0, least_gap = 0.0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const auto seen = run.states_at(times[k]).states;
    for (std::size_t b = 0; b < seen.size(); ++b) {
      of_file = std::max(of_file, off(bodies[b], seen[b].pose, states[k][b].pose));
      if (k % 10 > 0) continue;
      for (const FixedSite& site : scene.world.sites)
        least_gap = std::min(
            least_gap,
            outline_gap(*bodies[b].outline, seen[b].pose, *site.outline, told_pose(site, times[k])).gap);
    }
  }
  std::printf("%s: %lld knots; run file off by %.1e m of %.2g m, deepest in a site %.1e m\n", GetParam(),
              static_cast<long long>(run.knot_count()), of_file, length, -least_gap);
  EXPECT_GT(run.knot_count(), 100);
  EXPECT_LT(of_file, 1e-9 * length);
  EXPECT_GT(least_gap, -1e-9 * length);

  if (!testing::has_browser()) GTEST_SKIP() << "chromium is not installed";
  const fs::path page = folder.path() / "page.html";
  write_replay_page(folder.path() / "run.db", page);
  const json answer =
      testing::in_browser(page, "const b = window.brink, times = " + json(times).dump() +
                                    "; return times.map(t => b.state(t).flatMap(s => [s.x, s.y, s.angle]));");
  ASSERT_TRUE(answer.is_array()) << answer.dump();
  double of_page = 0.0;
  for (std::size_t k = 0; k < times.size(); ++k)
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const auto at = [&](std::size_t c) { return answer[k][3 * b + c].get<double>(); };
      of_page = std::max(of_page, off(bodies[b], {{at(0), at(1)}, at(2)}, states[k][b].pose));
    }
  std::printf("%s: page off by %.1e m\n", GetParam(), of_page);
  EXPECT_LT(of_page, 1e-9 * length);
}

INSTANTIATE_TEST_SUITE_P(Gallery, Seen,
                         ::testing::Values("drum_with_friction", "house_of_cards", "hourglass", "dominoes",
                                           "curling"),
                         [](const auto& scene) { return std::string(scene.param); });

// Of more knots than a run may record, or a page holds, there are the first ones, and both say so.
TEST(SeenInIslands, OfTooManyKnotsThereAreTheFirst) {
  const Folder folder("seen-few");
  const fs::path gallery = fs::path(BRINK_SOURCE_DIR) / "scenes/gallery";
  const Scene scene = load_scene(gallery / "drum_with_friction.toml", {"output.max_knots=2000"});
  RunRequest request;
  request.dir = folder.path();
  ASSERT_TRUE(run_scene(scene, request).summary.sound());
  const RunFile run(folder.path() / "run.db");
  EXPECT_EQ(run.knot_count(), 2000);
  ASSERT_TRUE(run.knots_end().has_value());
  const double end = *run.knots_end();
  EXPECT_GT(end, 0.1);
  const auto times = random_times(11, end, 100);
  const auto states = simulated(scene.world, scene.solver, times);
  ASSERT_EQ(states.size(), times.size());
  for (std::size_t k = 0; k < times.size(); ++k) {
    const auto seen = run.states_at(times[k]).states;
    for (std::size_t b = 0; b < seen.size(); ++b)
      EXPECT_LT(off(scene.world.bodies[b], seen[b].pose, states[k][b].pose), 1e-9 * length_of(run));
  }
  const auto notice = [&](const ReplayLimits& limits) -> std::string {
    return json::parse(replay_page_data(folder.path() / "run.db", limits, false))["about"]["notice"];
  };
  EXPECT_EQ(notice({}),
            fmt::format("states within islands up to {} s: after it motions are interpolated", end));
  ReplayLimits few;
  few.knots = 100;
  EXPECT_EQ(notice(few), "the first 100 states within islands of 2000: after them motions are interpolated");
}

struct Knots final : Recorder {
  std::vector<Knot> all;
  void knot(const Knot& knot) override { all.push_back(knot); }
};

bool same(const Knot& a, const Knot& b) {
  const auto numbers = [](const Knot& k) {
    return std::array{k.time,         k.pose.position.x(),   k.pose.position.y(),
                      k.pose.angle,   k.before.velocity.x(), k.before.velocity.y(),
                      k.before.omega, k.after.velocity.x(),  k.after.velocity.y(),
                      k.after.omega};
  };
  return a.body == b.body && std::ranges::equal(numbers(a), numbers(b), testing::same_bits);
}

/// As tests of random worlds have it: forces by integrators left out, between whose frames a cubic is not exact.
bool in_closed_forms(const testing::LastingWorld& made) { return !made.pulls; }

SolverOptions options_of(const testing::LastingWorld& made, std::size_t modes) {
  SolverOptions solver;
  solver.order = made.order;
  solver.island_tolerance = made.island_tolerance;
  solver.modes_contacts = modes;
  return solver;
}

/// Contacts that islands move by modes.
struct SeenInRandomWorlds : ::testing::TestWithParam<std::size_t> {};

// Every policy: the same knots; and what is read of them is the motion.
TEST_P(SeenInRandomWorlds, BodiesAreSeenAsTheyMovedUnderEveryPolicy) {
  const std::size_t modes = GetParam();
  int worlds = 0;
  std::size_t knots = 0;
  double worst = 0.0;
  for (std::uint64_t seed = 1; worlds < 16; ++seed) {
    const testing::LastingWorld made = testing::LastingWorldMaker(seed).make();
    if (!in_closed_forms(made)) continue;
    const auto times = random_times(seed, made.duration, 200);
    const auto states = simulated(made.world, options_of(made, modes), times);
    if (states.empty()) continue;
    ++worlds;
    const Folder folder(fmt::format("seen-random-{}-{}", modes, seed));
    Scene scene;
    scene.world = made.world;
    scene.duration = made.duration;
    scene.solver = options_of(made, modes);
    scene.options_json = "{}";
    Knots whole;
    for (const std::string& policy : exact_policies()) {
      SolverOptions solver = options_of(made, modes);
      solver.policy = policy;
      Knots of;
      RunOptions options;
      options.frame_interval = made.duration / 5.0;
      options.checkpoint_seconds = -1.0;
      options.until = made.duration;
      Simulator(made.world, solver).run(options, &of);
      if (whole.all.empty()) whole = of;
      ASSERT_EQ(of.all.size(), whole.all.size()) << policy << ", seed " << seed;
      for (std::size_t k = 0; k < of.all.size(); ++k)
        ASSERT_TRUE(same(of.all[k], whole.all[k])) << policy << ", seed " << seed << ", knot " << k;
    }
    knots += whole.all.size();
    {
      RunFileRecorder recorder(folder.path(), scene, RunFileRecorder::Open::fresh);
      RunOptions options;
      options.frame_interval = made.duration / 5.0;
      options.checkpoint_seconds = -1.0;
      options.until = made.duration;
      Simulator(made.world, scene.solver).run(options, &recorder);
    }
    const RunFile run(folder.path() / "run.db");
    const double length = length_of(run);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const auto seen = run.states_at(times[k]).states;
      for (std::size_t b = 0; b < seen.size(); ++b) {
        const double share = off(made.world.bodies[b], seen[b].pose, states[k][b].pose) / length;
        worst = std::max(worst, share);
        ASSERT_LT(share, 1e-9) << "seed " << seed << ", t = " << times[k] << ", body " << b;
      }
    }
  }
  std::printf("%d worlds, %zu knots: off by %.1e of the scene's length at most\n", worlds, knots, worst);
  EXPECT_GT(knots, 1000U);
}

INSTANTIATE_TEST_SUITE_P(ByStepsAndByModes, SeenInRandomWorlds, ::testing::Values(0, 16));

}  // namespace
}  // namespace brink::seen_in_islands_test
