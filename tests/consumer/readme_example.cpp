#include <brink/core/world/make_body.h>
#include <brink/scheduler/simulator/simulator.h>

#include <cstdio>

int main() {
  brink::FixedSite floor;
  floor.name = "floor";
  floor.outline = std::make_shared<brink::Outline>(brink::make_segment({-10.0, 0.0}, {10.0, 0.0}).outline);
  brink::Body ball = brink::make_body(brink::make_disc(0.5), brink::Mass{1.0});
  ball.name = "ball";  // inertia 0.125 kg m^2; restitution 1, unless its material says otherwise
  ball.initial.pose.position = {0.0, 10.0};

  brink::World world;
  world.gravity = {0.0, -9.81};
  world.sites = {floor};
  world.bodies = {ball};

  brink::Simulator simulator(world, brink::SolverOptions());
  brink::RunOptions options;
  options.until = 5.0;
  const brink::RunSummary summary = simulator.run(options);
  std::printf("%d collisions, height %.12f m: %s\n", static_cast<int>(summary.collisions),
              simulator.state(0).pose.position.y(), summary.termination_text().c_str());
  return summary.termination == brink::Termination::reached_end ? 0 : 1;
}
