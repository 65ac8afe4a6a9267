#include <brink/scenes/scene/scene.h>
#include <brink/scheduler/simulator/simulator.h>

#include <cstdio>

#include "earliest_first.h"

int main() {
  brink::register_policy("earliest_first", "from contact to contact, all bodies together",
                         [] { return std::make_unique<EarliestFirst>(); });
  const char* const text = R"(
[world]
duration = 3.0
gravity = [0.0, -9.81]
[[sites]]
name = "floor"
segment = [[-10.0, 0.0], [10.0, 0.0]]
[[bodies]]
name = "ball"
disc = { radius = 0.5 }
position = [0.0, 4.0]
grid = { columns = 4, rows = 3, spacing = [1.1, 1.3] }
)";
  std::uint64_t hashes[2];
  for (const int own : {0, 1}) {
    brink::Scene scene =
        brink::parse_scene(text, "own_policy", {own ? "solver.policy=earliest_first" : "world.seed=1"});
    brink::Simulator simulator(scene.world, scene.solver);
    brink::RunOptions options;
    options.until = scene.duration;
    hashes[own] = simulator.run(options).state_hash;
  }
  std::printf("the same end: %s\n", hashes[0] == hashes[1] ? "yes" : "no");
  return hashes[0] == hashes[1] ? 0 : 1;
}
