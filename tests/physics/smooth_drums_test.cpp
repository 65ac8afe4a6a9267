// A round drum without friction that turns about its own axis does no work: what lies in it comes to rest or swings as if the drum
// stood. Told from outside, by the energy of masses at the places and speeds of frames. BRINK_SEED moves the seeds, BRINK_WORLDS
// their number; BRINK_KEEP names a folder for the scenes that fail.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "tests/support/seeded_worlds.h"

namespace brink::smooth_drums_test {
namespace {

/// The farthest that the energy is above the least that it has been before [J].
class Rise : public Recorder {
 public:
  explicit Rise(const World& world) : world_(&world) {}
  void frame(double, std::span<const BodyState> states) override {
    double energy = 0.0;
    for (std::size_t k = 0; k < states.size(); ++k) {
      const Body& b = world_->bodies[k];
      const Twist& v = states[k].twist;
      energy += 0.5 * (b.mass * v.velocity.squaredNorm() + b.inertia * v.omega * v.omega) +
                b.mass * 9.81 * states[k].pose.position.y();
    }
    if (frames++ == 0) first = energy;
    least = std::min(least, energy);
    rise = std::max(rise, energy - least);
    last = energy;
  }

  int frames = 0;
  double first = 0.0, last = 0.0, least = std::numeric_limits<double>::infinity(), rise = 0.0;

 private:
  const World* world_;
};

/// `turns`: else it stands, with the same bodies in it.
std::string drum(std::uint64_t seed, bool turns) {
  Random random(seed);
  const char* const shapes[] = {
      "disc = { radius = 0.1 }", "box = { width = 0.25, height = 0.15 }",
      "polygon = { vertices = [[0.15, 0], [-0.08, 0.14], [-0.08, -0.14]] }",
      "path = { d = \"M -0.14 0 A 0.14 0.09 0 1 1 0.14 0 A 0.14 0.09 0 1 1 -0.14 0 Z\" }"};
  return fmt::format(
      "[world]\nduration = 3\ngravity = [0, -9.81]\nseed = {}\n[solver]\nmodes_contacts = {}\n"
      "[materials.default]\nrestitution = 0\nfriction = 0\n"
      "[[sites]]\ndisc = {{ radius = 1 }}\ninside_of = true\nmotion = {{ angular_velocity = {:.17g} }}\n"
      "[[bodies]]\n{}\ndensity = 10\n"
      "scatter = {{ count = {}, region = [[-0.55, -0.4], [0.55, 0.55]], random_angle = true }}\n",
      seed + 1, random.below(2) ? 0 : 8,
      (turns ? 1.0 : 0.0) * random.uniform(5.0, 40.0) * (random.below(2) ? 1.0 : -1.0),
      shapes[random.below(4)], std::array{1, 1, 3, 8}[random.below(4)]);
}

struct DrumRun {
  explicit DrumRun(const std::string& text) : scene(parse_scene(text, "drum")), energy(scene.world) {
    RunOptions options;
    options.until = scene.duration;
    options.frame_interval = 5e-3;
    const RunSummary summary = Simulator(scene.world, scene.solver).run(options, &energy);
    EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
    EXPECT_GT(energy.frames, 500);
  }

  Scene scene;
  Rise energy;
};

TEST(SmoothDrums, DoNoWorkThoughTheyTurn) {
  testing::for_each_world(
      12, [](std::uint64_t seed) { return drum(seed, true); },
      [](std::uint64_t seed) {
        const DrumRun turns(drum(seed, true)), stands(drum(seed, false));
        // a step of first order has one velocity from one end to the other: frames in it are off by what gravity does in it, which is
        // as much in a drum that stands
        EXPECT_LE(turns.energy.rise,
                  1.5 * stands.energy.rise + 0.01 * (turns.energy.first - turns.energy.last));
      });
}

}  // namespace
}  // namespace brink::smooth_drums_test
