// What policies with horizons do ahead is for nothing where a motion begins anew before: of that there is a bound.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/simulator/simulator.h"
#include "tests/support/worlds.h"

namespace brink::policies_work_test {
namespace {

RunSummary run(const Scene& scene, const std::string& policy, double until, std::string* hash) {
  SolverOptions options = scene.solver;
  options.policy = policy;
  Simulator simulator(scene.world, options);
  const RunSummary summary = simulator.run(testing::until(until));
  EXPECT_EQ(summary.termination, Termination::reached_end) << policy << ": " << summary.why;
  *hash = fmt::format("{:.17g} {:.17g}", simulator.state(0).pose.position.x(), summary.energy_final);
  return summary;
}

/// Four times four discs on springs, at rest at first, which fall on a floor: no speed tells how long a horizon may be.
std::string jelly() {
  std::string text = R"(
[world]
duration = 10.0
gravity = [0.0, -9.81]
[materials.default]
restitution = 0.0
friction = 0.5
[[sites]]
name = "floor"
segment = [[-50.0, 0.0], [50.0, 0.0]]
)";
  const auto name = [](int x, int y) { return fmt::format("n{}_{}", x, y); };
  std::string springs;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y) {
      text += fmt::format(
          "[[bodies]]\nname = \"{}\"\ndisc = {{ radius = 0.1 }}\nmass = 1.0\nposition = [{}, {}]\n",
          name(x, y), 0.5 * x, 0.5 + 0.5 * y);
      for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1), std::pair(1, 1)})
        if (x + dx < 4 && y + dy < 4)
          springs += fmt::format(
              "[[forces]]\nkind = \"spring\"\nbodies = [\"{}\", \"{}\"]\nstiffness = 2000.0\nrest_length = "
              "{}\n",
              name(x, y), name(x + dx, y + dy), dx && dy ? 0.7071067811865476 : 0.5);
    }
  return text + springs;
}

TEST(PoliciesWork, WhatStartsAtRestIsNotIntegratedToTheEndAfterEveryCollision) {
  const Scene scene = parse_scene(jelly(), "jelly.toml");
  std::string expected, hash;
  const RunSummary own = run(scene, "body_clocks", 1.0, &expected);
  ASSERT_GT(own.collisions, 20U);
  for (const char* policy : {"global_backup", "island_backup", "timewarp"}) {
    const RunSummary summary = run(scene, policy, 1.0, &hash);
    EXPECT_EQ(hash, expected) << policy;
    EXPECT_EQ(summary.collisions, own.collisions) << policy;
    EXPECT_LT(summary.work.right_hand_sides, 4 * own.work.right_hand_sides) << policy;
  }
}

/// Three that gather in a corner, the last but one with round ends, which creeps along another.
const char* const kCreeps = R"scene(
[world]
duration = 2.0
gravity = [0.0, -9.81]
restitution_rule = "product"
seed = 300
[solver]
integrator = "adams"
tolerance = 1e-06
[materials.ma]
restitution = 0.5
friction = 0.3
rolling_resistance = 0.0016519018596440167
[materials.mb]
restitution = 0.8
friction = 0
rolling_resistance = 0.00022108867092147913
[materials.mc]
restitution = 0.8
friction = 0.5
rolling_resistance = 0.00026332475338569313
[[sites]]
name = "room"
polygon = { vertices = [[-2.5, -2.0], [2.5, -2.0], [2.5, 2.0], [-2.5, 2.0]] }
inside_of = true
material = "mc"
[[bodies]]
name = "b0"
box = { width = 0.470379697188799, height = 0.11542724912251418 }
position = [1.2048833645586663, -0.902274689714827]
mass = 1.5383706902595418
velocity = [-0.8531051389464892, 1.2671817515939456]
angle = 3.4256730720610817
material = "mb"
[[bodies]]
name = "b1"
path = { d = "M0 0 L 0.0707015 0 A 0.046037 0.046037 0 0 1 0.0707015 0.0920739 L 0 0.0920739 A 0.046037 0.046037 0 0 1 0 0 Z" }
position = [1.012749349711388, 0.4622114378677084]
mass = 1.1642597801403463
velocity = [1.7420612529319826, -0.31727288848675395]
[[bodies]]
name = "b2"
polygon = { vertices = [[0.0, 0.0], [0.2830555704731224, 0.0], [0.12085539292899593, 0.29356924284573044]] }
position = [-0.6506913676684002, 0.07331285013493712]
mass = 2.8804475821399302
velocity = [0.6032269582719496, 1.4249064390262984]
material = "mc"
[[forces]]
kind = "attract"
center = [0.0, 0.0]
strength = -2.7309917159284196
power = 1.0
[[forces]]
kind = "formula"
fx = "m*4*t"
fy = "12*m*sin(3*t)"
)scene";

TEST(PoliciesWork, SearchesAheadThatCreepAreCutShort) {
  const Scene scene = parse_scene(kCreeps, "creeps.toml");
  std::string expected, hash;
  const RunSummary own = run(scene, "body_clocks", 2.0, &expected);
  for (const char* policy : {"global_backup", "island_backup", "timewarp"}) {
    const RunSummary summary = run(scene, policy, 2.0, &hash);
    EXPECT_EQ(hash, expected) << policy;
    EXPECT_EQ(summary.collisions, own.collisions) << policy;
    EXPECT_LT(summary.work.search_iterations, 4000000U) << policy;
  }
}

}  // namespace
}  // namespace brink::policies_work_test
