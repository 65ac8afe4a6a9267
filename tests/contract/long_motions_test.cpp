// Motions of so many pieces that the first are forgotten: nobody asks for them, and a run goes on from a snapshot.
#include <gtest/gtest.h>

#include <cstdint>
#include <set>

#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/simulator/simulator.h"
#include "tests/support/worlds.h"

namespace brink::long_motions_test {
namespace {

/// Steps of a thousandth of a millimetre: a box slowed by drag in a ring of wire, 4 mm wide.
const char* const kSmallRing = R"(
[world]
duration = 0.8
[[sites]]
chain = { vertices = [[0.0023, 0.0], [0.001860739, 0.001351906], [0.0007107391, 0.00218743],
  [-0.0007107391, 0.00218743], [-0.001860739, 0.001351906], [-0.0023, 2.816688e-19], [-0.001860739, -0.001351906],
  [-0.0007107391, -0.00218743], [0.0007107391, -0.00218743], [0.001860739, -0.001351906]], closed = true }
[[bodies]]
box = { width = 0.000200139, height = 0.000111267 }
position = [-5e-05, 0.00095]
velocity = [-0.01580277, -0.04743704]
[[forces]]
kind = "drag"
linear = 0.2
quadratic = 0.1
angular = 0.01
)";

/// A stiff spring: thousands of steps a second.
const char* const kSpring = R"(
[world]
duration = 2.0
[[bodies]]
name = "b1"
disc = { radius = 0.109446 }
position = [1.05, -0.95]
density = 1.0
[[forces]]
kind = "spring"
stiffness = 1000.0
body = "b1"
anchor = [0.5600726, -0.1483287]
)";

/// Boxes that a spring throws at each other over several images, in steps that begin with some 1e-15 s, which the clock
/// rounds by a percent.
const char* const kThrown = R"(
[world]
duration = 2.0
periodic = [40.0, 4.0]
gravity = [0.0, -9.81]
[materials.m]
restitution = 0.5
[[bodies]]
name = "b0"
box = { width = 0.2, height = 0.1 }
mass = 1.0
material = "m"
position = [0.3, 0.3]
[[bodies]]
name = "b1"
box = { width = 0.2, height = 0.1 }
mass = 1.0
material = "m"
position = [0.7, 0.3]
velocity = [0.0, 0.39166573353688694]
[[bodies]]
disc = { radius = 0.1 }
mass = 1.0
material = "m"
position = [0.7, 0.7]
velocity = [-94.91082780130785, -0.98159012289123]
[[forces]]
kind = "spring"
bodies = ["b0", "b1"]
stiffness = 50.0
rest_length = 100.0
)";

TEST(LongMotions, AHorizonEndsBeforeABodyPassesManyPeriods) {
  std::set<std::uint64_t> hashes;
  for (const std::string& policy : exact_policies()) {
    const Scene scene = parse_scene(kThrown, "thrown.toml", {"solver.policy=" + policy});
    Simulator simulator(scene.world, scene.solver);
    const RunSummary s = simulator.run(testing::until(scene.duration));
    EXPECT_EQ(s.termination, Termination::reached_end) << policy << ": " << s.why;
    EXPECT_LT(s.work.pair_searches, 20'000u) << policy;
    hashes.insert(s.state_hash);
  }
  EXPECT_EQ(hashes.size(), 1u);
}

TEST(LongMotions, TheWatchAsksForNothingThatIsForgotten) {
  for (const std::string& policy : exact_policies()) {
    const Scene scene = parse_scene(kSmallRing, "ring.toml", {"solver.policy=" + policy});
    Simulator simulator(scene.world, scene.solver);
    RunOptions options = testing::until(scene.duration);
    options.frame_interval = 0.02;
    const RunSummary s = simulator.run(options);
    EXPECT_EQ(s.termination, Termination::reached_end) << policy << ": " << s.why;
  }
}

TEST(LongMotions, ASnapshotGoesOnWhereSpringsAreStiff) {
  for (const std::string& policy : exact_policies()) {
    const Scene scene = parse_scene(kSpring, "spring.toml", {"solver.policy=" + policy});
    Simulator whole(scene.world, scene.solver), first(scene.world, scene.solver),
        second(scene.world, scene.solver);
    const RunSummary expected = whole.run(testing::until(2.0));
    ASSERT_EQ(expected.termination, Termination::reached_end);
    first.run(testing::until(1.4));
    second.restore(first.snapshot());
    EXPECT_EQ(second.run(testing::until(2.0)).state_hash, expected.state_hash) << policy;
  }
}

}  // namespace
}  // namespace brink::long_motions_test
