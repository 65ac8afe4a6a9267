// What a user's program looks like: a scene from text, run, and asked.
#include <brink/scenes/scene/scene.h>
#include <brink/scheduler/simulator/simulator.h>

#include <cmath>
#include <cstdio>

int main() {
  // A disc of radius 0.5 m let go 10 m above the floor meets it after falling 9.5 m, at sqrt(2 h / g).
  const brink::Scene scene = brink::parse_scene(R"(
[world]
duration = 2.0
gravity = [0.0, -9.81]
[[sites]]
name = "floor"
segment = [[-10.0, 0.0], [10.0, 0.0]]
[[bodies]]
name = "ball"
disc = { radius = 0.5 }
position = [0.0, 10.0]
)",
                                                "consumer");
  struct FirstContact : brink::Recorder {
    double t = -1.0;
    void frame(double, std::span<const brink::BodyState>) override {}
    void event(const brink::Event& event) override {
      if (t < 0.0) t = event.contact.time;
    }
    void checkpoint(double, const std::vector<std::byte>&) override {}
  } recorder;
  brink::Simulator simulator(scene.world, scene.solver);
  brink::RunOptions options;
  options.until = scene.duration;
  const brink::RunSummary summary = simulator.run(options, &recorder);
  const double expected = std::sqrt(2.0 * 9.5 / 9.81);
  std::printf("first contact at %.12f s, expected %.12f s; %s\n", recorder.t, expected,
              summary.termination_text().c_str());
  return std::abs(recorder.t - expected) < 1e-9 && summary.termination == brink::Termination::reached_end ? 0
                                                                                                          : 1;
}
