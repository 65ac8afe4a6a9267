// Motions of so many pieces that the first are forgotten: nobody asks for them, and a run goes on from a snapshot. BRINK_SEED moves
// the seeds of the random worlds, BRINK_WORLDS their number; BRINK_KEEP names a folder for the scenes that fail.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <set>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/simulator/simulator.h"
#include "tests/support/seeded_worlds.h"
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

/// A light body on a stiff spring, shaken, in a room whose floor may move: thousands of steps between two walls, which it may
/// leave and come back to, or start at.
std::string shaken(std::uint64_t seed) {
  Random random(seed);
  const double size = random.uniform(0.02, 0.05), room = random.uniform(0.25, 0.5);
  const char* const shapes[] = {"disc = {{ radius = {0} }}", "capsule = {{ length = {1}, radius = {0} }}",
                                "box = {{ width = {1}, height = {0} }}",
                                "polygon = {{ vertices = [[{0}, 0], [-{2}, {0}], [0, 0], [-{2}, -{0}]] }}"};
  std::string text = fmt::format(
      "[world]\nduration = 1.5\n[solver]\npersistent = {}\n[materials.default]\nrestitution = {}\nfriction = "
      "{}\n",
      random.below(2) ? "true" : "false", std::array{0.0, 0.5, 0.9, 1.0}[random.below(4)],
      random.below(2) ? 0.2 : 0.0);
  if (random.below(2))
    text += fmt::format("[[sites]]\nbox = {{ width = {0}, height = {0} }}\ninside_of = true\n", 2.0 * room);
  else
    text += fmt::format(
        "[[sites]]\nchain = {{ vertices = [[{0}, {1}], [{1}, {1}], [{1}, {0}], [{0}, {0}]], closed = true "
        "}}\n",
        -room, room);
  if (random.below(2))
    text += fmt::format(
        "[[sites]]\nsegment = [[{}, 0], [{}, 0]]\nmotion = {{ y = \"{:.17g} + 0.02*sin({:.17g}*t)\" }}\n",
        -0.9 * room, 0.9 * room, -0.9 * room, random.uniform(2.0, 30.0));
  const std::uint64_t shape = random.below(4);
  const double to_right = std::array{1.0, 1.75, 0.75, 1.0}[shape] * size;
  // some begin at a wall
  const double x = random.below(2) ? room - to_right : random.uniform(-0.5, 0.5) * room;
  text += fmt::format(
      "[[bodies]]\nname = \"b\"\ndensity = 1.0\n{}\nposition = [{:.17g}, {:.17g}]\n"
      "velocity = [{:.17g}, {:.17g}]\n",
      fmt::format(fmt::runtime(shapes[shape]), size, 1.5 * size, 0.5 * size), x,
      random.uniform(-0.4, 0.4) * room, random.uniform(-0.5, 0.5), random.uniform(-1.0, 1.0));
  text += fmt::format(
      "[[forces]]\nkind = \"spring\"\nbody = \"b\"\nanchor = [{:.17g}, {:.17g}]\nstiffness = 100.0\n"
      "rest_length = {}\nat = [{:.17g}, 0.0]\n",
      random.uniform(-1.0, 1.0) * room, random.uniform(-1.0, 1.0) * room, random.below(2) ? 0.1 : 0.0,
      random.uniform(0.0, 0.8) * size);
  return text +
         fmt::format(
             "[[forces]]\nkind = \"formula\"\nfx = \"m*{:.17g}*sin({:.17g}*t)\"\nfy = \"m*{:.17g}*cos(t)\"\n",
             random.uniform(0.0, 5.0), random.uniform(1.0, 20.0), random.uniform(0.0, 5.0));
}

/// Bodies with corners that hardly fall, over a lift that hardly rises by a formula: each flight lasts thousands of its pieces, and a
/// search that begins late in it knows no more of the first.
std::string hardly_falling(std::uint64_t seed) {
  Random random(seed);
  // so that the lowest have come down two or three times
  const double pull = random.uniform(0.5, 2.0) * 2e-6, end = 1.8 * std::sqrt(2.0 / pull);
  const char* const lifts[] = {"{0}*t", "0.1*sin({0}*t)", "{0}*t*(1 + t/5000)"};
  const char* const shapes[] = {
      "box = { width = 0.45, height = 0.2 }",
      "polygon = { vertices = [[0, 0], [0.45, 0], [0.45, 0.16], [0.16, 0.16], [0.16, 0.45], [0, 0.45]] }",
      "polygon = { vertices = [[0, 0], [0.4, 0], [0.1, 0.3]] }",
      "chain = { vertices = [[0, 0], [0.4, 0.1]] }\nmass = 1.0"};
  std::string text = fmt::format(
      "[world]\nduration = {:.17g}\ngravity = [0, {:.17g}]\n[materials.default]\nrestitution = {}\nfriction "
      "= {}\n"
      "[[sites]]\n{}\nmotion = {{ y = \"{}\" }}\n",
      end, -pull, std::array{0.5, 0.8, 1.0}[random.below(3)], random.below(2) ? 0.5 : 0.0,
      random.below(2) ? "box = { width = 6.0, height = 0.4 }" : "segment = [[-3, 0], [3, 0]]",
      fmt::format(fmt::runtime(lifts[random.below(3)]), random.uniform(1.0, 5.0) * 1e-4));
  for (int k = 0; k < 2; ++k)
    text += fmt::format(
        "[[bodies]]\n{}\nposition = [{:.17g}, {:.17g}]\nangle = {:.17g}\nangular_velocity = {:.17g}\n",
        shapes[random.below(4)], -1.0 + 2.0 * k, random.uniform(1.0, 1.5), random.uniform(-3.0, 3.0),
        random.below(2) ? random.uniform(-2e-3, 2e-3) : 0.0);
  return text;
}

TEST(LongMotions, WhatWaitsForLongOverALiftMeetsIt) {
  testing::for_each_world(12, hardly_falling,
                          [](std::uint64_t seed) { testing::expect_same_bits(hardly_falling(seed), seed); });
}

TEST(LongMotions, GoOnWithTheSameBitsFromAnyTime) {
  testing::for_each_world(8, shaken,
                          [](std::uint64_t seed) { testing::expect_same_bits(shaken(seed), seed); });
}

}  // namespace
}  // namespace brink::long_motions_test
