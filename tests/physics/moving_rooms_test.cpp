// Rooms that turn or go along evenly, and bodies that slide, hop and lie in their corners: of the energy that a room gives nothing is
// left in a frame that moves with it. So E - omega L - V . p, less what weight does against the room's motion, may only fall. Told from
// outside, by the places and speeds of frames. And where nothing pulls, what slides round in a hollow goes on without end, and does not
// bounce without end. BRINK_SEED moves the seeds, BRINK_WORLDS their number; BRINK_KEEP names a folder for the scenes that fail.
#include <fmt/core.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "tests/support/seeded_worlds.h"

namespace brink::moving_rooms_test {
namespace {

/// Between frames, and how many are looked at together: more than a step of first order, in whose middle bodies have the speeds of its
/// end already [s].
constexpr double kFrames = 4e-3;
constexpr std::size_t kTogether = 8;
/// Of a fall by 0.3 m, or of 1 J a kilogram, that the ledger may rise [1]. What steps of first order win beside a side that turns under
/// what slides along it is of second order in the step, and told (island_energy).
constexpr double kRise = 0.02;
/// A body of this kind has come to lasting contact long before.
constexpr std::int64_t kMostCollisions = 20000;

std::vector<std::array<double, 2>> polygon_of(Random& random, int corners, double size, double uneven) {
  std::vector<std::array<double, 2>> corner;
  const double from = random.uniform(0.0, 6.0);
  for (int k = 0; k < corners; ++k) {
    const double angle = from + 2.0 * std::numbers::pi * k / corners,
                 r = size * (1.0 + uneven * random.uniform(-1.0, 1.0));
    corner.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return corner;
}

std::string shape_of(Random& random) {
  switch (random.below(6)) {
    case 0:
      return fmt::format("box = {{ width = {:.3f}, height = {:.3f} }}", random.uniform(0.1, 0.35),
                         random.uniform(0.1, 0.3));
    case 1:
      return fmt::format("box = {{ width = {:.3f}, height = {:.3f} }}", random.uniform(0.2, 0.4),
                         random.uniform(0.01, 0.03));
    case 2:
      return fmt::format("polygon = {{ vertices = {} }}",
                         polygon_of(random, 3 + static_cast<int>(random.below(4)), 0.18, 0.0));
    case 3:
      return fmt::format("disc = {{ radius = {:.3f} }}", random.uniform(0.05, 0.18));
    case 4:
      return "polygon = { vertices = [[0,0],[0.3,0],[0.3,0.1],[0.1,0.1],[0.1,0.3],[0,0.3]] }";
    default:
      return "chain = { vertices = [[-0.2,0],[0,0.1],[0.2,0]] }";
  }
}

/// How a room moves: its turn about its origin [rad/s], or the way that it goes [m/s].
struct Motion {
  double omega = 0.0;
  Vec2 velocity = Vec2::Zero();
};

struct Room {
  std::string text;
  Motion motion;
};

Room room(std::uint64_t seed) {
  Random random(seed);
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  Room made;
  if (random.below(3) > 0)
    made.motion.omega = pick({-1.0, 1.0}) * random.uniform(0.2, 3.0);
  else
    made.motion.velocity = {random.uniform(-3.0, 3.0), random.uniform(-2.0, 2.0)};
  const double e = pick({0.0, 0.2, 0.5, 0.8}), friction = pick({0.0, 0.0, 0.2, 0.5, 1.0});
  made.text = fmt::format(
      "[world]\nduration = 2\ngravity = [0, {}]\nseed = {}\n[materials.default]\nrestitution = {}\nfriction "
      "= {}\n"
      "[[sites]]\nname = \"room\"\n",
      pick({-9.81, -9.81, -9.81, -1e-3, 0.0}), seed, e, friction);
  const int corners = 3 + static_cast<int>(random.below(6));
  const double size = random.uniform(0.9, 1.5);
  auto walls = polygon_of(random, corners, corners == 3 ? 1.4 : size, pick({0.0, 0.1}));
  switch (random.below(4)) {
    case 0:
      made.text += fmt::format("chain = {{ vertices = {}, closed = true }}\n", walls);
      break;
    case 1:
      made.text += fmt::format("polygon = {{ vertices = {} }}\ninside_of = true\n", walls);
      break;
    case 2:
      made.text += "disc = { radius = 1.1 }\ninside_of = true\n";
      break;
    default:
      walls.push_back(walls.front());  // two ends at one place
      made.text += fmt::format("chain = {{ vertices = {} }}\n", walls);
  }
  made.text += fmt::format("motion = {{ angular_velocity = {}, velocity = [{}, {}] }}\n", made.motion.omega,
                           made.motion.velocity.x(), made.motion.velocity.y());
  const int bodies = 1 + static_cast<int>(random.below(3));
  const std::array<Vec2, 3> places{Vec2(-0.25, -0.15), Vec2(0.28, -0.15), Vec2(-0.1, 0.3)};
  for (int k = 0; k < bodies; ++k)
    made.text += fmt::format(
        "[[bodies]]\nname = \"b{}\"\n{}\nmass = {:.3f}\nposition = [{}, {}]\nangle = {:.4f}\n"
        "velocity = [{:.3f}, {:.3f}]\nangular_velocity = {:.3f}\n",
        k, shape_of(random), random.uniform(0.3, 3.0), places[k].x(), places[k].y(), random.uniform(0.0, 7.0),
        random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-2.0, 2.0));
  return made;
}

/// The energy that bodies have in the room's frame, as far as it may only fall: kinetic and of weight, less the room's share.
class Ledger : public Recorder {
 public:
  Ledger(const World& world, const Motion& room) : world_(&world), room_(room) {
    double mass = 0.0;
    for (const Body& b : world.bodies) mass += b.mass;
    scale = mass * std::max(1.0, 0.3 * world.gravity.norm());
  }

  void frame(double t, std::span<const BodyState> states) override {
    double energy = 0.0, turning = 0.0, torque = 0.0;
    for (std::size_t k = 0; k < states.size(); ++k) {
      const Body& b = world_->bodies[k];
      const Vec2 place = states[k].pose.position - t * room_.velocity,
                 velocity = states[k].twist.velocity - room_.velocity;
      const double omega = states[k].twist.omega;
      energy += 0.5 * (b.mass * velocity.squaredNorm() + b.inertia * omega * omega) -
                b.mass * world_->gravity.dot(place);
      turning += b.mass * cross(place, velocity) + b.inertia * omega;
      torque += b.mass * cross(place, world_->gravity);
    }
    if (!seen_.empty()) given_ += 0.5 * (torque + torque_) * (t - time_);
    time_ = t;
    torque_ = torque;
    seen_.push_back(energy - room_.omega * (turning - given_));
  }

  /// The most by which the least of some frames is above the most of as many before them [J].
  double rise() const {
    double most = 0.0;
    for (std::size_t k = kTogether; k + kTogether <= seen_.size(); ++k) {
      const auto here = seen_.begin() + static_cast<std::ptrdiff_t>(k);
      most = std::max(most,
                      *std::min_element(here, here + kTogether) - *std::max_element(here - kTogether, here));
    }
    return most;
  }
  std::size_t frames() const { return seen_.size(); }
  double scale = 0.0;  ///< [J]

 private:
  const World* world_;
  Motion room_;
  std::vector<double> seen_;
  double given_ = 0.0, torque_ = 0.0, time_ = 0.0;
};

TEST(MovingRooms, GiveNoEnergyInTheirOwnFrame) {
  int ended = 0;
  std::uint64_t worlds = 0;
  testing::for_each_world(
      140, [](std::uint64_t seed) { return room(seed).text; },
      [&](std::uint64_t seed) {
        const Room made = room(seed);
        const Scene scene = parse_scene(made.text, "room");
        Simulator simulator(scene.world, scene.solver);
        if (!simulator.start_fault().empty()) return;  // somebody begins in a wall
        ++worlds;
        Ledger ledger(scene.world, made.motion);
        RunOptions options = testing::until(scene.duration);
        options.frame_interval = kFrames;
        const RunSummary summary = simulator.run(options, &ledger);
        EXPECT_EQ(summary.why, "");
        EXPECT_LE(ledger.rise(), kRise * ledger.scale);
        EXPECT_LE(summary.collisions, kMostCollisions);
        ended += summary.termination == Termination::reached_end;
        if (seed % 8 == 0) testing::expect_same_bits(made.text, seed);
      });
  EXPECT_GE(ended, static_cast<int>(worlds * 9 / 10));
}

// A corner of a body that slides round in a still arc, with no weight: it keeps its energy, but for the bounces at first, and where it
// is follows from an arm that swings about the arc's centre: the centre of mass goes on at one speed.
TEST(MovingRooms, WhatSlidesRoundInAHollowWithoutWeightStaysAtTheWall) {
  for (const double e : {0.0, 0.3, 0.8}) {
    const Scene scene = parse_scene(
        fmt::format(
            "[world]\nduration = 4\ngravity = [0, 0]\n[materials.default]\nrestitution = {}\nfriction = 0\n"
            "[[sites]]\ndisc = {{ radius = 1 }}\ninside_of = true\n"
            "[[bodies]]\ndisc = {{ radius = 0.1 }}\nmass = 1\nposition = [0, -0.88]\nvelocity = [1, 0]\n",
            e),
        "hollow");
    Simulator simulator(scene.world, scene.solver);
    const RunSummary summary = simulator.run(testing::until(scene.duration));
    EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
    EXPECT_LE(summary.collisions, 300) << e;
    const BodyState end = simulator.states()[0];
    EXPECT_NEAR(end.pose.position.norm(), 0.9, 1e-9) << e;
    // The first touch is where the straight way meets the circle of the disc's centre; there it has the part along the wall left, once
    // the bounces are over, as each of these keeps it: 0.88 of 0.9.
    const double along = 0.88 / 0.9;
    EXPECT_NEAR(end.twist.velocity.norm(), along, 1e-9) << e;
    EXPECT_NEAR(end.pose.position.dot(end.twist.velocity), 0.0, 1e-9) << e;
  }
}

}  // namespace
}  // namespace brink::moving_rooms_test
