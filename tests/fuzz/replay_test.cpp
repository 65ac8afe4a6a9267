// What a run file says of random worlds between its frames, beside a simulation to the same times: all shapes, forces, places, wires,
// speeds. Where forces are constant the two are one to rounding; where an integrator drives a body, to its steps; runs that are
// stopped and gone on with say the same.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/run_scene.h"
#include "brink/scheduler/simulator/simulator.h"
#include "random_worlds.h"

namespace brink::replay_test {
namespace {

namespace fs = std::filesystem;

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

class Replays : public ::testing::Test {
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

/// Of single collisions of two free bodies: what each gained is the impulse, and the place is where the other stands off.
void check_momentum(const std::vector<Event>& events, const World& world) {
  for (std::size_t k = 0; k < events.size(); ++k) {
    const Event& e = events[k];
    if (e.kind != EventKind::collision || !e.body.known) continue;
    const auto at_this_time = [&](const Event& o) {
      return std::abs(o.contact.time - e.contact.time) <= 1e-12 * (1.0 + e.contact.time);
    };
    const bool alone =
        (k == 0 || !at_this_time(events[k - 1])) && (k + 1 == events.size() || !at_this_time(events[k + 1]));
    const Body& body = world.bodies[e.contact.body];
    if (!alone || body.lock_x || body.lock_y) continue;
    const Vec2 impulse = e.impulse_n * e.contact.normal + e.impulse_t * perp(e.contact.normal);
    const Vec2 gained = body.mass * (e.body.after.twist.velocity - e.body.before.velocity);
    const double scale =
        body.mass * (e.body.after.twist.velocity.norm() + e.body.before.velocity.norm()) + impulse.norm();
    EXPECT_LT((gained - impulse).norm(), 1e-9 * scale + 1e-300) << "event " << k << " at " << e.contact.time;
  }
}

bool same(const EventSide& a, const EventSide& b) {
  const auto numbers = [](const EventSide& s) {
    const Pose& p = s.after.pose;
    const Twist &v = s.after.twist, &w = s.before;
    return std::array<double, 9>{p.position.x(), p.position.y(), p.angle,
                                 v.velocity.x(), v.velocity.y(), v.omega,
                                 w.velocity.x(), w.velocity.y(), w.omega};
  };
  return a.known == b.known && (!a.known || numbers(a) == numbers(b));
}

// States at collisions are a part of what every exact policy and every resume gives with the same bits, contacts that last
// included.
TEST_F(Replays, StatesAtCollisionsAreTheSameInEveryWay) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1), count = from_environment("BRINK_WORLDS", 25);
  int sides = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    SCOPED_TRACE(seed);
    std::vector<Event> told;
    for (const std::string& policy : exact_policies()) {
      SCOPED_TRACE(policy);
      Scene scene;
      try {
        scene = parse_scene(worlds::random_world(seed), "random.toml");
        scene.solver.policy = policy;
        scene.solver.max_collisions = 300;
        scene.solver.persistent = seed % 2 == 0;
        scene.duration = std::min(scene.duration, 1.0);
        run(scene, 0.37 * scene.duration);
      } catch (const BadInput&) {
        break;  // refused
      }
      const std::vector<Event> events = RunFile(folder_ / "run.db").events();
      check_momentum(events, scene.world);
      if (told.empty()) told = events;
      ASSERT_EQ(events.size(), told.size());
      for (std::size_t k = 0; k < events.size(); ++k) {
        EXPECT_TRUE(same(events[k].body, told[k].body) && same(events[k].other, told[k].other))
            << "event " << k;
        sides += events[k].body.known + events[k].other.known;
      }
    }
  }
  std::cout << "seeds " << first << " .. " << first + count - 1 << ": " << sides << " sides\n";
  EXPECT_GT(sides, 0);
}

}  // namespace
}  // namespace brink::replay_test
