// What a run file says of random worlds between its frames, beside a simulation to the same times: all shapes, forces, places, wires,
// speeds. Where forces are constant the two are one to rounding; where an integrator drives a body, to its steps; runs that are
// stopped and gone on with say the same.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/run_scene.h"
#include "brink/scheduler/simulator/simulator.h"
#include "random_worlds.h"

namespace brink {
namespace {

namespace fs = std::filesystem;

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

class Replays : public testing::Test {
 protected:
  Replays() : folder_(fs::temp_directory_path() / ("brink-replays-" + std::to_string(::getpid()))) {}
  ~Replays() override { fs::remove_all(folder_); }

  /// Runs in two parts, the first up to `stop`.
  void run(const Scene& scene, double stop) const {
    fs::remove_all(folder_);
    RunRequest request;
    request.dir = folder_;
    request.checkpoint_seconds = 0.0;
    request.until = stop;
    run_scene(scene, request);
    request.resume = true;
    request.until = std::nullopt;
    run_scene(scene, request);
  }

  fs::path folder_;
};

/// True if nothing but gravity and thrust acts: parabolas.
bool parabolic(const World& world) {
  return std::all_of(world.forces.begin(), world.forces.end(),
                     [](const Force& f) { return std::holds_alternative<ThrustForce>(f); });
}

TEST_F(Replays, OfRandomWorldsAreWhatHappened) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1), count = from_environment("BRINK_WORLDS", 40);
  int compared = 0, looks = 0;
  double worst = 0.0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    SCOPED_TRACE(seed);
    Scene scene;
    try {
      scene = parse_scene(worlds::random_world(seed), "random.toml");
      scene.solver.persistent = false;
      scene.solver.max_collisions = 2000;
      if (!parabolic(scene.world)) continue;
      run(scene, 0.37 * scene.duration);
    } catch (const BadInput&) {
      continue;  // refused
    }
    const RunFile file(folder_ / "run.db");
    const double end = file.end_time();
    if (!(end > 0.0) || file.frame_count() == 0) continue;
    Random random(seed);
    std::vector<double> times;
    for (int k = 0; k < 40; ++k) times.push_back(file.time_range().second * random.uniform());
    std::sort(times.begin(), times.end());
    Simulator simulator(scene.world, scene.solver);
    RunOptions options;
    options.checkpoint_seconds = -1.0;
    ++compared;
    for (const double t : times) {
      options.until = t;
      simulator.run(options);
      if (simulator.time() < t) break;
      const auto seen = file.states_at(t).states, is = simulator.states();
      for (std::size_t b = 0; b < is.size(); ++b) {
        const double speed = std::max(is[b].twist.velocity.norm(), 1e-3), length = scene.world.length();
        const double off = (seen[b].pose.position - is[b].pose.position).norm() /
                           (length + speed * (1.0 + end) + is[b].pose.position.norm());
        worst = std::max(worst, off);
        EXPECT_LT(off, 1e-9) << "body " << b << " at " << t;
        ++looks;
      }
    }
  }
  std::cout << "seeds " << first << " .. " << first + count - 1 << ": " << compared << " worlds, " << looks
            << " looks, farthest off " << worst << " of length, way and place\n";
  if (count >= 40) {
    EXPECT_GT(compared, static_cast<int>(count) / 10);
  }
}

}  // namespace
}  // namespace brink
