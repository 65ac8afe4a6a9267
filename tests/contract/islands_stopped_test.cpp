// A large island whose steps are cut by who says stop: nobody is told of half a step, and the run goes on from the
// checkpoint with the bits of one that nobody disturbed.
#include <gtest/gtest.h>

#include <cstdio>

#include "brink/scenes/scene/scene.h"
#include "tests/support/same_events.h"
#include "tests/support/seeded_random.h"

namespace brink::islands_stopped_test {
namespace {

// A wall of bricks that is hit, on both sides: steps of all of it, collisions with its members, and bounces that end.
const char* const kWall = R"(
[world]
duration = 0.25
gravity = [0, -9.81]
[materials.default]
friction = 0.4
restitution = 0.2
[[sites]]
name = "floor"
segment = [[-50, 0], [50, 0]]
[[bodies]]
name = "brick"
box = { width = 1, height = 0.5 }
wall = [24, 12]
touching = "floor"
position = [0, 5]
[[bodies]]
name = "left"
disc.radius = 0.4
position = [-14, 3]
velocity = [20, 0]
[[bodies]]
name = "right"
disc.radius = 0.3
position = [14, 2]
velocity = [-15, 2]
)";

struct Told {
  std::vector<Event> events;
  RunSummary summary;
  int stops = 0, stops_at_start = 0;
};

Told whole(const Scene& scene, const std::string& policy) {
  SolverOptions options = scene.solver;
  options.policy = policy;
  testing::Events events;
  Simulator simulator(scene.world, options);
  const RunSummary summary = simulator.run(testing::until(scene.duration), &events);
  return {events.events, summary};
}

/// The last checkpoint, and the events that were told before it.
class Keeper : public testing::Events {
 public:
  void checkpoint(double, const std::vector<std::byte>& state) override {
    kept = state;
    known = events.size();
  }
  std::vector<std::byte> kept;
  std::size_t known = 0;
};

/// Stopped at one in four of the times at which somebody is asked, and each time gone on with: by another simulator
/// that knows the checkpoint alone, or by the same one.
Told in_pieces(const Scene& scene, const std::string& policy, bool anew) {
  SolverOptions options = scene.solver;
  options.policy = policy;
  SeededRandom random(7);
  Told run;
  Keeper keeper;
  auto simulator = std::make_unique<Simulator>(scene.world, options);
  for (;;) {
    RunOptions to = testing::until(scene.duration);
    to.first_frame = false;
    to.progress = [&](double, std::uint64_t) { return random.below(4) > 0; };
    run.summary = simulator->run(to, &keeper);
    if (run.summary.termination != Termination::stopped) break;
    EXPECT_EQ(run.summary.why, "on request");
    ++run.stops;
    run.stops_at_start += simulator->time() == 0.0;
    // of what was told everything is before the checkpoint: nothing is told twice, and nothing is half told
    EXPECT_EQ(keeper.known, keeper.events.size());
    if (!anew) continue;
    simulator = std::make_unique<Simulator>(scene.world, options);
    simulator->restore(keeper.kept);
  }
  run.events = keeper.events;
  return run;
}

class StoppedIslands : public ::testing::TestWithParam<std::string> {};

TEST_P(StoppedIslands, GoOnWithTheSameBits) {
  const Scene scene = parse_scene(kWall, "wall.toml");
  const Told undisturbed = whole(scene, GetParam());
  ASSERT_EQ(undisturbed.summary.termination, Termination::reached_end) << undisturbed.summary.why;
  for (const bool anew : {true, false}) {
    const Told stopped = in_pieces(scene, GetParam(), anew);
    std::printf("%s: %d stops, %d of them at t = 0, %zu events\n", GetParam().c_str(), stopped.stops,
                stopped.stops_at_start, stopped.events.size());
    EXPECT_GT(stopped.stops, 0);
    EXPECT_EQ(stopped.summary.state_hash, undisturbed.summary.state_hash);
    EXPECT_EQ(stopped.summary.collisions, undisturbed.summary.collisions);
    EXPECT_EQ(stopped.summary.island_steps, undisturbed.summary.island_steps);
    ASSERT_EQ(stopped.events.size(), undisturbed.events.size());
    for (std::size_t k = 0; k < stopped.events.size(); ++k)
      ASSERT_TRUE(testing::same(stopped.events[k], undisturbed.events[k]))
          << k << ": " << testing::text(stopped.events[k]) << ", not "
          << testing::text(undisturbed.events[k]);
  }
}

INSTANTIATE_TEST_SUITE_P(Policies, StoppedIslands, ::testing::ValuesIn(exact_policies()),
                         [](const auto& policy) { return policy.param; });

}  // namespace
}  // namespace brink::islands_stopped_test
