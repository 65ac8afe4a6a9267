// What contacts that last must keep: momentum where no site takes any, and energy that never grows where nothing gives any. Clouds of
// bodies that meet in free space and bodies on ice, of all shapes and of masses a million times apart; and bodies that strong springs
// press together, and that turn; looked at from outside at every frame. BRINK_SEED moves the seeds, BRINK_WORLDS their number.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <string>

#include "brink/core/base/random.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/seeded_worlds.h"

namespace brink::lasting_laws_test {
namespace {

constexpr double kEnd = 3.0, kFrames = 1.0 / 128.0;
/// A step of first order is shorter than so many frames, as bodies move here.
constexpr std::size_t kStepFrames = 20;
/// Of the largest momentum, and of the kinetic energy that there was.
constexpr double kMomentumLost = 1e-11, kEnergyWon = 1e-10;
/// Of the sum of all angular momenta about the origin: steps turn bodies to first order.
constexpr double kTurningLost = 1e-3;
/// The same of who are pressed together by hundreds of newtons. A step that begins with the twists of a turn takes them along its chord,
/// and pays for that with its turning. Frames are inside steps, where bodies have the twists of the end already: energy may be
/// higher there by what springs do in a step.
constexpr double kPressedMomentum = 1e-10, kPressedEnergy = 1e-2, kPressedTurning = 3e-2;

Shape shape_of(Random& random) {
  const double size = random.uniform(0.3, 0.8);
  switch (random.below(6)) {
    case 0:
      return make_disc(0.5 * size);
    case 1:
      return make_box(size, size * random.uniform(0.3, 1.0));
    case 2:
      return make_polygon({{-0.5 * size, -0.3 * size}, {0.5 * size, -0.3 * size}, {0.0, 0.6 * size}});
    case 3:
      return make_box(size, 0.5 * size, 0.1 * size);
    case 4:
      return make_chain({{-0.5 * size, 0.0}, {0.5 * size, 0.0}}, false, 0.1 * size);
    default:
      return make_polygon(
          {{0, 0}, {size, 0}, {size, 0.3 * size}, {0.3 * size, 0.3 * size}, {0.3 * size, size}, {0, size}});
  }
}

struct Made {
  World world;
  bool on_ice = false;
  bool pressed = false;       ///< together, by springs
  int held_axis = -1;         ///< along which some are held (lock), who take momentum: 0 x, 1 y
  bool held_turning = false;  ///< of some, who take angular momentum
};

double spring_energy(const World& world, std::span<const BodyState> states) {
  const auto end = [&](int body, const Vec2& at) {
    const Pose& pose = states[body].pose;
    const double c = std::cos(pose.angle), s = std::sin(pose.angle);
    return Vec2(pose.position + Vec2(c * at.x() - s * at.y(), s * at.x() + c * at.y()));
  };
  double sum = 0.0;
  for (const Force& force : world.forces) {
    const SpringForce& spring = std::get<SpringForce>(force);
    const double stretch =
        (end(spring.body_a, spring.at_a) - end(spring.body_b, spring.at_b)).norm() - spring.rest_length;
    sum += 0.5 * spring.stiffness * stretch * stretch;
  }
  return sum;
}

/// Two to five in a ring, which turns and drifts; each with its neighbour and some others on a spring, some of which do not pull at the
/// centres.
Made make_pressed(Random& random) {
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  Made made;
  made.pressed = true;
  World& w = made.world;
  w.materials[0].restitution = pick({0.0, 0.1, 0.9});
  w.materials[0].friction = pick({0.0, 0.3, 1.0, 10.0});
  const int bodies = 2 + static_cast<int>(random.below(4));
  const double turn = pick({0.0, 1.0, -3.0}), ring = 0.35 + 0.12 * bodies;
  for (int k = 0; k < bodies; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / bodies;
    const Vec2 at(ring * std::cos(angle), ring * std::sin(angle));
    testing::add(w, testing::body(shape_of(random), at, Vec2(0.5, 0.0) + turn * perp(at),
                                  pick({0.2, 1.0, 3.0}), random.uniform(-3.0, 3.0), pick({turn, 0.0, 4.0})));
  }
  for (int a = 0; a < bodies; ++a)
    for (int b = a + 1; b < bodies; ++b) {
      if (b != a + 1 && random.below(10) >= 7) continue;
      SpringForce spring;
      spring.body_a = a;
      spring.body_b = b;
      spring.stiffness = pick({5.0, 50.0, 500.0});
      spring.damping = pick({0.0, 0.0, 1.0, 5.0});
      spring.rest_length = pick({0.0, 0.2});
      if (random.below(2) == 0) spring.at_a = {0.1, 0.0}, spring.at_b = {0.0, -0.1};
      w.forces.emplace_back(spring);
    }
  return made;
}

Made make(Random& random) {
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  Made made;
  made.on_ice = random.below(2) == 0;
  World& w = made.world;
  w.materials[0].restitution = pick({0.0, 0.0, 0.3});
  w.materials[0].friction = made.on_ice ? 0.0 : pick({0.0, 0.3, 2.0});
  if (made.on_ice) w.gravity = {0.0, -9.81};
  if (made.on_ice) {
    if (random.below(2) == 0)
      testing::add(w, testing::site(make_segment({-300.0, 0.0}, {300.0, 0.0})));
    else
      testing::add(w, testing::site(make_box(600.0, 1.0), {0.0, -0.5}));
  }
  const int bodies = 2 + static_cast<int>(random.below(random.below(3) == 0 ? 12 : 4));
  const double drift = pick({0.0, 1.0, 10.0}), light = pick({1.0, 1.0, 1e-3, 1e-6});
  for (int k = 0; k < bodies; ++k) {
    // on a grid, so that nobody begins in anybody
    const Vec2 at(1.3 * (k % 4), 0.9 + 1.3 * (k / 4));
    testing::add(w, testing::body(shape_of(random), at,
                                  Vec2(drift - 0.5 * at.x() + random.uniform(-0.3, 0.3),
                                       made.on_ice ? 0.0 : -0.5 * at.y() + random.uniform(-0.3, 0.3)),
                                  random.below(3) == 0 ? light : random.uniform(0.5, 2.0),
                                  random.uniform(-3.0, 3.0), random.uniform(-2.0, 2.0)));
  }
  return made;
}

/// Clouds that meet, or that springs press together, of whom some are held along one axis, or in their turning.
Made make_held(Random& random) {
  const bool pressed = random.below(2) == 0;
  Made made = pressed ? make_pressed(random) : Made();
  if (!pressed) {
    do made = make(random);
    while (made.on_ice);
  }
  // rolling resistance is a matter of steps
  if (random.below(2) == 0) made.world.materials[0].rolling_resistance = random.uniform(0.0, 0.1);
  made.held_axis = static_cast<int>(random.below(3)) - 1;
  for (Body& b : made.world.bodies) {
    if (made.held_axis >= 0 && random.below(2) == 0) {
      (made.held_axis == 0 ? b.lock_x : b.lock_y) = true;
      b.initial.twist.velocity[made.held_axis] = 0.0;
    }
    if (random.below(3) > 0) continue;
    made.held_turning = b.lock_angle = true;
    b.initial.twist.omega = 0.0;
  }
  return made;
}

/// Sees by how much momentum has changed that nothing takes, and how far energy has risen above the least it was.
class LawWatch final : public outside::FrameWatch {
 public:
  /// `by_steps`: islands may take steps of first order.
  LawWatch(const Made& made, bool by_steps)
      : FrameWatch(made.world, kEnd, 1e-9), made_(made), by_steps_(by_steps) {}
  void frame(double t, std::span<const BodyState> states) override {
    FrameWatch::frame(t, states);
    Vec2 momentum = Vec2::Zero();
    double angular = 0.0, turning = 0.0;
    double largest = 0.0, energy = 0.0, kinetic = 0.0;
    for (std::size_t k = 0; k < states.size(); ++k) {
      const Body& b = made_.world.bodies[k];
      const Vec2 p = b.mass * states[k].twist.velocity;
      momentum += p;
      const double orbit = cross(states[k].pose.position, p), spin = b.inertia * states[k].twist.omega;
      angular += orbit + spin;
      turning += std::abs(orbit) + std::abs(spin);
      largest = std::max(largest, p.norm());
      kinetic +=
          0.5 * (p.dot(states[k].twist.velocity) + b.inertia * states[k].twist.omega * states[k].twist.omega);
      energy -= b.mass * made_.world.gravity.dot(states[k].pose.position);
    }
    energy += kinetic + spring_energy(made_.world, states);
    if (frames_++ == 0) {
      first_ = momentum;
      first_angular_ = angular;
      least_ = energy;
      of_ = std::max(kinetic, std::abs(energy));
    }
    const Vec2 change = momentum - first_;
    scale_ = std::max(scale_, largest);
    turning_ = std::max(turning_, turning);
    // of one that drifts the lever is long: what its momentum keeps it does not lose
    if (!made_.on_ice && made_.held_axis < 0 && !made_.held_turning)
      angular_lost = std::max(angular_lost, std::abs(angular - first_angular_));
    const int taken = made_.on_ice ? 1 : made_.held_axis;
    lost = std::max(lost, taken >= 0 ? std::abs(change[1 - taken]) : change.norm());
    // In the middle of a step of first order bodies have the velocity of its end already: gravity has done its work on that
    // before it does it on places, and what contacts take in the step is taken from its beginning on, but given back where an
    // impact cuts it short. So energy there is held against what it was a longest step before.
    while (seen_.size() >= (by_steps_ ? kStepFrames : 1)) {
      least_ = std::min(least_, seen_.front());
      seen_.pop_front();
    }
    seen_.push_back(energy);
    if (!made_.on_ice) won = std::max(won, (energy - least_) / of_);
  }
  double lost_part() const { return lost / std::max(scale_, 1e-9); }
  double angular_lost_part() const { return angular_lost / std::max(turning_, 1e-9); }
  double lost = 0.0, won = 0.0, angular_lost = 0.0;

 private:
  const Made& made_;
  bool by_steps_;
  std::deque<double> seen_;
  Vec2 first_ = Vec2::Zero();
  double least_ = 0.0, of_ = 0.0, scale_ = 0.0, first_angular_ = 0.0, turning_ = 0.0;
  int frames_ = 0;
};

/// "" where it is sound, else what is wrong.
std::string fault_of(std::uint64_t seed, Made (*make_world)(Random&) = make) {
  Random random(seed);
  const Made made = make_world(random);
  SolverOptions solver;
  solver.max_collisions = 20000;
  if (random.below(3) == 0) solver.modes_contacts = 0;
  Simulator simulator(made.world, solver);
  if (!simulator.start_fault().empty()) return "";
  const bool by_steps = solver.modes_contacts == 0 || made.pressed || made.world.bodies.size() > 8 ||
                        made.world.materials[0].rolling_resistance > 0.0;
  LawWatch watch(made, by_steps);
  RunOptions options = testing::until(kEnd);
  options.frame_interval = kFrames;
  const RunSummary summary = simulator.run(options, &watch);
  const std::string what =
      fmt::format("{} {} bodies{}: ",
                  made.on_ice    ? "on ice"
                  : made.pressed ? "pressed"
                                 : "free",
                  made.world.bodies.size(), solver.modes_contacts == 0 ? " by steps" : "");
  if (summary.termination == Termination::failed) return what + summary.why;
  if (!watch.sound()) return what + watch.report();
  if (watch.lost_part() > (made.pressed ? kPressedMomentum : kMomentumLost))
    return fmt::format("{}{:.3g} of the momentum lost", what, watch.lost_part());
  if (watch.angular_lost_part() > (made.pressed ? kPressedTurning : kTurningLost))
    return fmt::format("{}{:.3g} of the angular momentum lost", what, watch.angular_lost_part());
  if (watch.won > (made.pressed ? kPressedEnergy : kEnergyWon))
    return fmt::format("{}{:.3g} of the energy won", what, watch.won);
  if (summary.termination != Termination::reached_end) return "";  // more collisions than it may have
  const std::string other =
      testing::stopped_under_another_policy(made.world, solver, options, 4, seed, summary);
  return other.empty() ? "" : what + other;
}

TEST(LastingLaws, MomentumIsKeptAndEnergyNeverGrows) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      worlds = testing::from_environment("BRINK_WORLDS", 65);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed)
    EXPECT_EQ(fault_of(seed), "") << "seed " << seed;
}

TEST(LastingLaws, WhatSpringsPressTogetherKeepsItsTurning) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      worlds = testing::from_environment("BRINK_WORLDS", 25);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed)
    EXPECT_EQ(fault_of(seed, make_pressed), "") << "seed " << seed;
}

TEST(LastingLaws, WhoIsHeldAlongOneAxisKeepsTheMomentumOfTheOther) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      worlds = testing::from_environment("BRINK_WORLDS", 30);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed)
    EXPECT_EQ(fault_of(seed, make_held), "") << "seed " << seed;
}

// A step that solved for roundings alone made speeds up (51, 603), one met plastically what turned towards it (66, 189, 412, 799),
// and a light body between heavy ones was pushed to and fro without end (76, 212, 527, 597, 724, 794).
TEST(LastingLaws, ThatOnceFailed) {
  for (const std::uint64_t seed : {66, 76, 189, 212, 412, 515, 527, 597, 603, 724, 794, 799, 964})
    EXPECT_EQ(fault_of(seed), "") << "seed " << seed;
}

}  // namespace
}  // namespace brink::lasting_laws_test
