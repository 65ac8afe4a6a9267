/// The simulator as users see it: snapshots, limits, faults at the start, orders, the fixed-step baseline.
#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/base/error.h"
#include "brink/core/base/random.h"
#include "brink/scheduler/policies/policy.h"
#include "tests/support/worlds.h"

namespace brink::simulator_test {
namespace {

using testing::add;
using testing::body;
using testing::Events;
using testing::site;
using testing::until;

/// Boxes and discs in a square room, nothing touching.
World crowd(std::uint64_t seed, bool springs = false) {
  World world;
  Random r(seed);
  const Shape box = make_box(0.5, 0.3), disc = make_disc(0.2);
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j)
      testing::add(
          world, testing::body((i + j) % 2 ? box : disc, {i - 2.0, j - 2.0},
                               {r.uniform(-1, 1), r.uniform(-1, 1)}, 1.0, r.uniform(0, 6), r.uniform(-2, 2)));
  const Vec2 c[] = {{-3, -3}, {3, -3}, {3, 3}, {-3, 3}};
  for (int i = 0; i < 4; ++i) testing::add(world, testing::site(make_segment(c[i], c[(i + 1) % 4])));
  if (springs) {
    SpringForce spring;
    spring.body_a = 0;
    spring.body_b = 6;
    spring.stiffness = 3.0;
    spring.rest_length = 1.0;
    world.forces.push_back(spring);
  }
  return world;
}

TEST(Simulator, SnapshotGoesOnWithTheSameBits) {
  for (const std::string& policy : exact_policies())
    for (const bool springs : {false, true}) {
      SolverOptions options;
      options.policy = policy;
      Simulator whole(crowd(1, springs), options);
      whole.run(testing::until(6.0));
      Simulator first(crowd(1, springs), options);
      Events events;
      first.run(testing::until(2.5), &events);
      Simulator second(crowd(1, springs), options);
      second.restore(events.last_checkpoint);
      EXPECT_EQ(second.time(), 2.5);
      EXPECT_EQ(second.state_hash(), first.state_hash());
      second.run(testing::until(6.0));
      EXPECT_EQ(second.state_hash(), whole.state_hash()) << policy << ", springs " << springs;
    }
}

TEST(Simulator, SnapshotOfAnotherWorldIsRefused) {
  Simulator a(crowd(1), {}), b(crowd(2), {});
  EXPECT_THROW(b.restore(a.snapshot()), BadInput);
  const std::vector<std::byte> rubbish(40);
  EXPECT_THROW(b.restore(rubbish), BadInput);
}

TEST(Simulator, ElasticCrowdKeepsEnergyAndNeverOverlaps) {
  Simulator simulator(crowd(3), {});
  RunOptions options = testing::until(25.0);  // chaotic: a change of last bits changes the number
  options.frame_interval = 0.05;
  const RunSummary s = simulator.run(options);
  ASSERT_EQ(s.termination, Termination::reached_end) << s.why;
  EXPECT_GT(s.collisions, 300U);
  EXPECT_NEAR(s.energy_final / s.energy_initial, 1.0, 1e-13);
  EXPECT_LE(s.max_overlap, 1e-13);
}

TEST(Simulator, EveryOrderEndsAFlatLandingWithTheSameEnergyAndRepeats) {
  for (const char* order : {"index", "closing_speed", "depth", "random"}) {
    const auto run = [&] {
      World world;
      world.gravity = {0.0, -9.81};
      testing::add(world, testing::body(make_box(1.0, 0.5), {0.0, 2.0}, {0.3, 0.0}));
      testing::add(world, testing::body(make_box(1.0, 0.5), {3.0, 2.0}, {-0.3, 0.0}));
      testing::add(world, testing::site(make_segment({-20.0, 0.0}, {20.0, 0.0})));
      SolverOptions options;
      options.order = order;
      Simulator simulator(world, options);
      return simulator.run(testing::until(3.0));
    };
    const RunSummary a = run(), b = run();
    EXPECT_EQ(a.termination, Termination::reached_end) << order << ": " << a.why;
    EXPECT_NEAR(a.energy_final / a.energy_initial, 1.0, 1e-12) << order;
    EXPECT_EQ(a.state_hash, b.state_hash) << order;
  }
}

TEST(Simulator, OverlapAtTheStartIsRefusedByName) {
  World world;
  testing::add(world, testing::body(make_box(2.0, 0.1), {0.0, 0.0}, {0.0, 0.0}));
  testing::add(world, testing::body(make_box(0.1, 2.0), {0.0, 0.0},
                                    {0.0, 0.0}));  // a plus: no vertex inside the other
  Simulator simulator(world, {});
  EXPECT_NE(simulator.start_fault().find("'body0' and 'body1' overlap"), std::string::npos)
      << simulator.start_fault();
  EXPECT_THROW(simulator.run(testing::until(1.0)), BadInput);
}

// A question changes nothing: what somebody has put into somebody else in the middle of a run is told, asked for before or not.
TEST(Simulator, OverlapThatIsAskedForInTheMiddleIsToldAllTheSame) {
  for (const int asked : {0, 1, 2, 3}) {
    World world;
    add(world, body(make_disc(0.5), {0.0, 0.0}, {0.1, 0.0}));
    add(world, body(make_disc(0.5), {3.0, 0.0}, {-0.1, 0.0}));
    Simulator simulator(world, {});
    simulator.run(until(0.1));
    simulator.set_state(0, {{{2.3, 0.0}, 0.0}, {}});
    if (asked == 1) {
      EXPECT_NE(simulator.start_fault(), "");
    }
    if (asked == 2) {
      EXPECT_EQ(simulator.overlaps().size(), 1U);
    }
    if (asked == 3) simulator.plan();
    const RunSummary s = simulator.run(until(1.0));
    EXPECT_EQ(s.termination, Termination::failed) << asked;
    EXPECT_NE(s.why.find("overlaps"), std::string::npos) << asked << ": " << s.why;
    EXPECT_GT(s.max_overlap, 0.2) << asked;
  }
}

TEST(Simulator, BodiesAndSitesThatThereAreNotAreRefused) {
  World world;
  add(world, body(make_disc(0.5), {0.0, 0.0}, {0.1, 0.0}));
  Simulator simulator(world, {});
  for (const int k : {-1, 1, 99}) {
    EXPECT_THROW(simulator.state(k), BadInput) << k;
    EXPECT_THROW(simulator.set_state(k, {}), BadInput) << k;
    EXPECT_THROW(simulator.apply_impulse(k, {1.0, 0.0}, {0.0, 0.0}), BadInput) << k;
    EXPECT_THROW(simulator.site_pose(k), BadInput) << k;
  }
  EXPECT_THROW(simulator.site_pose(0), BadInput);
  const std::uint64_t before = simulator.state_hash();
  EXPECT_THROW(simulator.apply_impulse(0, {1e308, 1e308}, {1e308, 0.0}), BadInput);
  EXPECT_EQ(simulator.state_hash(), before);
  EXPECT_EQ(simulator.run(until(1.0)).termination, Termination::reached_end);
}

/// Asks the simulator for what only goes between runs, at the first collision.
class Meddler : public Recorder {
 public:
  explicit Meddler(Simulator& simulator) : simulator_(&simulator) {}
  void event(const Event&) override {
    EXPECT_THROW(simulator_->run(until(9.0)), BadInput);
    EXPECT_THROW(simulator_->set_state(0, simulator_->state(0)), BadInput);
    EXPECT_THROW(simulator_->apply_impulse(0, {1.0, 0.0}, {0.0, 0.0}), BadInput);
    EXPECT_THROW(simulator_->restore(simulator_->snapshot()), BadInput);
    EXPECT_THROW(simulator_->set_pair_filter({}), BadInput);
    ++events;
  }
  int events = 0;

 private:
  Simulator* simulator_;
};

TEST(Simulator, WhatGoesBetweenRunsIsRefusedWithinOne) {
  Simulator plain(crowd(3), {}), meddled(crowd(3), {});
  Meddler meddler(meddled);
  plain.run(until(2.0));
  meddled.run(until(2.0), &meddler);
  EXPECT_GT(meddler.events, 3);
  EXPECT_EQ(meddled.state_hash(), plain.state_hash());
  meddled.set_state(0, meddled.state(0));  // and afterwards it goes again
}

TEST(Simulator, WorldWithoutBodiesReachesItsEnd) {
  World world;
  add(world, site(make_segment({0, 0}, {1, 0})));
  for (const Choice& choice : policies()) {
    const std::string policy(choice.name);
    SolverOptions options;
    options.policy = policy;
    const RunSummary summary = Simulator(world, options).run(until(1.0));
    EXPECT_EQ(summary.termination, Termination::reached_end) << policy;
    EXPECT_EQ(summary.collisions, 0U) << policy;
  }
}

TEST(Simulator, BodiesOfAllSizesMeet) {  // on every level of the cells
  World world;
  for (const double r : {1e-3, 1e-2, 1.0, 1.0, 1.0, 1.0, 1e2, 1e3}) {
    const bool first = world.bodies.empty();
    const double x = first ? 0.0 : world.bodies.back().initial.pose.position.x() + 2e3 + r;
    add(world, body(make_disc(r), {x, 0.0}, {first ? 1e3 : 0.0, 0.0}));
  }
  SolverOptions options;
  options.policy = "body_clocks";
  EXPECT_EQ(Simulator(world, options).run(until(100.0)).collisions, 7U);
}

TEST(Simulator, StopsAtTheLimitOfCollisions) {
  SolverOptions options;
  options.max_collisions = 10;
  Simulator simulator(crowd(4), options);
  const RunSummary s = simulator.run(testing::until(20.0));
  EXPECT_EQ(s.termination, Termination::stopped);
  EXPECT_EQ(s.collisions, 10U);
  EXPECT_LT(s.end_time, 20.0);
}

// Event by event, under every exact policy: the same collisions and the same end as in one go.
TEST(Simulator, StepsFromEventToEventAndGoesOn) {
  for (const std::string& policy : exact_policies()) {
    SolverOptions options;
    options.policy = policy;
    Simulator at_once(crowd(4), options), by_steps(crowd(4), options);
    Events expected, met;
    at_once.run(testing::until(5.0), &expected);
    ASSERT_GT(expected.collisions().size(), 10U);
    for (int k = 0; k < 10; ++k) {
      const RunSummary s = by_steps.step_to_next_event(testing::until(5.0), &met);
      EXPECT_EQ(s.termination, Termination::stopped);
      ASSERT_EQ(met.events.size(), k + 1U);
      EXPECT_EQ(by_steps.time(), expected.events[k].contact.time);
    }
    EXPECT_EQ(by_steps.run(testing::until(5.0), &met).termination, Termination::reached_end);
    ASSERT_EQ(met.events.size(), expected.events.size());
    for (std::size_t k = 0; k < met.events.size(); ++k)
      EXPECT_EQ(met.events[k].contact.time, expected.events[k].contact.time);
    EXPECT_EQ(by_steps.state_hash(), at_once.state_hash());
    EXPECT_EQ(by_steps.step_to_next_event(testing::until(5.0)).termination, Termination::reached_end);
  }
}

// A ball that is stopped in its flight and pushed sideways: parabolas, by hand.
TEST(Simulator, StatesAndImpulsesFromOutsideAreGoneOnFrom) {
  for (const char* integrator : {"auto", "erk"}) {
    World world;
    world.gravity = {0.0, -2.0};
    add(world, body(make_disc(0.5), {0.0, 0.0}, {1.0, 0.0}, 2.0));
    add(world, body(make_disc(0.5), {9.0, 0.0}, {0.0, 0.0}, 2.0));
    SolverOptions options;
    options.integrator = integrator;
    Simulator simulator(world, options);
    simulator.run(testing::until(1.0));
    simulator.set_state(0, {{{3.0, 4.0}, 0.5}, {{0.0, 2.0}, 0.0}});
    EXPECT_EQ(simulator.state(0).pose.position, Vec2(3.0, 4.0));
    simulator.apply_impulse(0, {2.0, 0.0}, {3.0, 4.25});  // turns it, too: inertia 2 r^2 / 2
    simulator.run(testing::until(3.0));
    const BodyState s = simulator.state(0);
    EXPECT_NEAR(s.pose.position.x(), 3.0 + 2.0 * 1.0, 1e-9);
    EXPECT_NEAR(s.pose.position.y(), 4.0 + 2.0 * 2.0 - 4.0, 1e-9);
    EXPECT_NEAR(s.twist.omega, -0.25 * 2.0 / 0.25, 1e-9);
    EXPECT_NEAR(simulator.state(1).pose.position.y(), -9.0, 1e-9);
    EXPECT_THROW(simulator.set_state(0, {{{NAN, 0.0}, 0.0}, {}}), BadInput);
    EXPECT_THROW(simulator.apply_impulse(0, {INFINITY, 0.0}, {}), BadInput);
    world.bodies[1].lock_y = true;
    Simulator locked(world, options);
    EXPECT_THROW(locked.set_state(1, {{{9.0, 0.0}, 0.0}, {{0.0, 1.0}, 0.0}}), BadInput);
    EXPECT_NO_THROW(locked.set_state(1, {{{9.0, 1.0}, 0.0}, {{1.0, 0.0}, 0.0}}));
  }
}

// Discs of two teams in a room: those of one team pass through each other, and nobody feels the left wall.
TEST(Simulator, OwnersThatAFilterKeepsApartNeverMeet) {
  std::uint64_t hash = 0;
  for (const std::string& policy : exact_policies()) {
    World world;
    for (int k = 0; k < 6; ++k)
      add(world, body(make_disc(0.4), {k % 3 - 1.0, k / 3 - 0.5}, {k % 2 ? 1.1 : -1.3, 0.3 * k - 0.8}));
    const int left = add(world, site(make_segment({-3.0, -9.0}, {-3.0, 9.0})));
    add(world, site(make_segment({3.0, -9.0}, {3.0, 9.0})));
    SolverOptions options;
    options.policy = policy;
    Simulator simulator(world, options);
    simulator.set_pair_filter([&](int a, int b) { return b < 6 ? (a + b) % 2 == 1 : b != 6 + left; });
    Events events;
    EXPECT_EQ(simulator.run(testing::until(6.0), &events).termination, Termination::reached_end) << policy;
    EXPECT_GT(events.collisions().size(), 4U);
    for (const Event& e : events.collisions()) {
      if (e.contact.other_body >= 0) {
        EXPECT_EQ((e.contact.body + e.contact.other_body) % 2, 1);
      }
      EXPECT_NE(e.contact.other_site, left);
    }
    if (hash == 0) hash = simulator.state_hash();
    EXPECT_EQ(simulator.state_hash(), hash) << policy;
  }
}

// The watch beside the search looks at flights from where it last looked: what a filter let through a wire
// then is no fault later, in a program that knows of it by a snapshot alone either.
TEST(Simulator, ABodyThatWasLetThroughAWireIsNotBlamedAfterARestore) {
  World world;
  add(world, body(make_disc(0.25), {0.0, 0.0}, {1.0, 0.0}));
  add(world, site(make_segment({1.0, -9.0}, {1.0, 9.0})));
  add(world, site(make_segment({4.0, -9.0}, {4.0, 9.0})));
  Simulator first(world, {});
  first.set_pair_filter([](int, int b) { return b != 1; });
  EXPECT_EQ(first.run(testing::until(2.0)).collisions, 0U);
  Simulator second(world, {});
  second.restore(first.snapshot());
  const RunSummary summary = second.run(testing::until(5.0));
  EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
  EXPECT_EQ(summary.collisions, 1U);
  EXPECT_NEAR(second.state(0).pose.position.x(), 2.5, 1e-12);
}

// What a policy has in view of a body that was put elsewhere is void: it collides where it is now.
TEST(Simulator, ABodyPutElsewhereCollidesThere) {
  for (const std::string& policy : exact_policies()) {
    World world;
    add(world, body(make_disc(0.5), {0.0, 0.0}, {1.0, 0.0}));
    add(world, body(make_disc(0.5), {0.0, 50.0}, {0.0, 0.0}));
    SolverOptions options;
    options.policy = policy;
    Simulator simulator(world, options);
    simulator.run(testing::until(1.0));
    simulator.set_state(1, {{{5.0, 0.0}, 0.0}, {}});
    Events events;
    simulator.run(testing::until(9.0), &events);
    ASSERT_EQ(events.collisions().size(), 1U) << policy;
    EXPECT_NEAR(events.collisions()[0].contact.time, 4.0, 1e-12);
  }
}

TEST(Simulator, FramesComeOnTheFrameClockAndAtTheEnd) {
  Simulator simulator(crowd(5), {});
  Events events;
  RunOptions options = testing::until(1.05);
  options.frame_interval = 0.25;
  simulator.run(options, &events);
  EXPECT_EQ(events.frame_times, (std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0, 1.05}));
}

// Another interval, or none before: frames are those of the time that is run, each once and in order.
TEST(Simulator, FramesOfASecondRunAreNotThoseOfThePast) {
  const auto frames = [](double first_interval, double first_end, double interval) {
    Simulator simulator(crowd(5), {});
    RunOptions options = testing::until(first_end);
    options.frame_interval = first_interval;
    simulator.run(options);
    Events events;
    options = testing::until(2.0);
    options.frame_interval = interval;
    options.first_frame = false;
    simulator.run(options, &events);
    return events.frame_times;
  };
  using Times = std::vector<double>;
  EXPECT_EQ(frames(0.0, 1.0, 0.25), (Times{1.25, 1.5, 1.75, 2.0}));
  EXPECT_EQ(frames(0.125, 1.0, 0.5), (Times{1.5, 2.0}));
  EXPECT_EQ(frames(0.5, 1.0, 0.25), (Times{1.25, 1.5, 1.75, 2.0}));
  EXPECT_EQ(frames(0.25, 1.1, 0.25), (Times{1.25, 1.5, 1.75, 2.0}));
}

// A box that rests on a floor is pushed right after the run has stopped at an event; and a pair of boxes on it comes
// to its limit of collisions as a group. The island is still there, and goes on.
TEST(Simulator, IslandIsKeptThroughAStopAtAnEvent) {
  for (const char* order : {"index", "lcp", "reflections"}) {
    World world;
    world.gravity = {0.0, -10.0};
    world.materials[0].restitution = 0.0;
    add(world, body(make_box(1.0, 1.0), {0.0, 0.5}, {0.0, 0.0}));
    add(world, body(make_box(1.0, 1.0), {0.0, 3.0}, {0.0, 0.0}));
    add(world, site(make_segment({-9, 0}, {9, 0})));
    SolverOptions options;
    options.order = order;
    Simulator simulator(world, options);
    Events events;
    for (int k = 0; k < 6; ++k) {
      simulator.step_to_next_event(testing::until(4.0), &events);
      simulator.apply_impulse(0, {0.0, -1e-3}, simulator.state(0).pose.position);
    }
    const RunSummary s = simulator.run(testing::until(4.0));
    EXPECT_EQ(s.termination, Termination::reached_end) << order << ": " << s.why;
    EXPECT_NEAR(simulator.state(0).pose.position.y(), 0.5, 1e-9) << order;
    EXPECT_NEAR(simulator.state(1).pose.position.y(), 1.5, 1e-9) << order;
  }
}

// The limit may be passed by a group: it is still the limit that is named.
TEST(Simulator, LimitPassedByAGroupIsNamed) {
  World world;
  for (int k = 0; k < 4; ++k) add(world, body(make_disc(0.5), {1.0 * k, 0.0}, {k == 0 ? 1.0 : 0.0, 0.0}));
  SolverOptions options;
  options.order = "lcp";
  options.max_collisions = 2;
  Simulator simulator(world, options);
  const RunSummary s = simulator.run(testing::until(1.0));
  EXPECT_EQ(s.termination, Termination::stopped);
  EXPECT_NE(s.why.find("max_collisions"), std::string::npos) << s.why;
}

// Bodies of infinite mass along x and in angle fall straight down whatever they hit.
// Two pairs on springs far apart, and a free disc that hits one of them once: what is started afresh is the
// disc and the pair that it hit.
TEST(Simulator, CollisionResetsTheTouchedComponentsAlone) {
  for (const std::string& policy : exact_policies()) {
    World world;
    for (const double y : {0.0, 10.0})
      for (const double x : {0.0, 1.0}) add(world, body(make_disc(0.3), {x, y}, {0.0, 0.0}));
    for (const int k : {0, 2}) {
      SpringForce spring;
      spring.body_a = k;
      spring.body_b = k + 1;
      spring.stiffness = 1.0;
      spring.rest_length = 1.0;
      world.forces.push_back(spring);
    }
    add(world, body(make_disc(0.3), {-2.0, 0.0}, {1.0, 0.0}));
    SolverOptions options;
    options.policy = policy;
    const RunSummary summary = Simulator(world, options).run(until(1.6));
    EXPECT_EQ(summary.collisions, 1U) << policy;
    EXPECT_EQ(summary.work.component_resets, 2U) << policy;
  }
}

TEST(Simulator, LockedCoordinatesStay) {
  World world = crowd(6);
  for (Body& b : world.bodies) {
    b.lock_x = b.lock_angle = true;
    b.initial.twist.velocity.x() = 0.0;
    b.initial.twist.omega = 0.0;
  }
  Simulator simulator(world, {});
  const RunSummary s = simulator.run(testing::until(5.0));
  ASSERT_EQ(s.termination, Termination::reached_end) << s.why;
  EXPECT_GT(s.collisions, 20U);
  for (int k = 0; k < 25; ++k) {
    EXPECT_EQ(simulator.state(k).pose.position.x(), world.bodies[k].initial.pose.position.x());
    EXPECT_EQ(simulator.state(k).pose.angle, world.bodies[k].initial.pose.angle);
  }
}

// The naive baseline errs by its step: a drop's bounce is late by up to a step, and a fast disc passes a thin
// plate.
TEST(FixedStep, ErrsByItsStepAndMissesThinPlates) {
  World drop;
  drop.gravity = {0.0, -9.81};
  testing::add(drop, testing::body(make_disc(0.5), {0.0, 10.0}, {0.0, 0.0}));
  testing::add(drop, testing::site(make_segment({-10, 0}, {10, 0})));
  Simulator exact(drop, {});
  exact.run(testing::until(2.0));
  double last = 1e9;
  for (const double step : {1e-2, 1e-3, 1e-4}) {
    SolverOptions options;
    options.policy = "fixed_step";
    options.step = step;
    Simulator naive(drop, options);
    naive.run(testing::until(2.0));
    const double error = std::abs(naive.state(0).pose.position.y() - exact.state(0).pose.position.y());
    EXPECT_LT(error, 20.0 * step);
    EXPECT_LT(error, last);
    last = error;
  }

  World shot;
  testing::add(shot, testing::body(make_disc(0.01), {-1.0, 0.0}, {1000.0, 0.0}));
  testing::add(shot, testing::body(make_box(0.01, 1.0), {0.0, 0.0}, {0.0, 0.0}));
  SolverOptions options;
  options.policy = "fixed_step";
  options.step = 0.0007;
  Simulator naive(shot, options);
  EXPECT_EQ(naive.run(testing::until(0.01)).collisions, 0U);
  EXPECT_EQ(Simulator(shot, {}).run(testing::until(0.01)).collisions, 1U);
}

}  // namespace
}  // namespace brink::simulator_test
