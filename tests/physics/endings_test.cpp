/// Endings: what looks like the end of a series and is not one, groups without end, starts that cannot be.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "brink/core/base/error.h"
#include "brink/scheduler/policies/policy.h"
#include "tests/support/worlds.h"

namespace brink::endings_test {
namespace {

using testing::add;
using testing::body;
using testing::Events;
using testing::site;
using testing::until;

std::string numbered(std::string name, int k) { return name.append(std::to_string(k)); }

SolverOptions by(const std::string& policy, const char* order = "index") {
  SolverOptions options;
  options.policy = policy;
  options.order = order;
  return options;
}

// A disc in a slot with 4e-11 m of play at 1 m/s: it meets a wall after 2e-11 s and then each 4e-11 s. All
// flights are lower than the contact tolerance.
TEST(Rattling, ElasticDiscInATightSlotGoesOn) {
  World world;
  add(world, body(make_disc(0.5), {0, 0}, {1.0, 0.5}));
  for (const double x : {-0.50000000002, 0.50000000002}) add(world, site(make_segment({x, -10}, {x, 10})));
  const double end = 1e-6;
  for (const std::string& policy : exact_policies()) {
    Simulator simulator(world, by(policy));
    const RunSummary summary = simulator.run(until(end));
    EXPECT_EQ(summary.termination, Termination::reached_end) << policy << ": " << summary.why;
    EXPECT_NEAR(static_cast<double>(summary.collisions), end / 4e-11, 0.02 * end / 4e-11) << policy;
    EXPECT_EQ(summary.energy_final, summary.energy_initial) << policy;
  }
}

/// Boxes of one width in a column: two at rest on each other, a third comes from below.
World column() {
  World world;
  for (const double y : {0.0, 1.0}) add(world, body(make_box(1, 1), {0, y}, {0, 0}));
  add(world, body(make_box(1, 1), {0, -3}, {0, 10}));
  return world;
}

// One at a time their corners collide without end; together they keep the energy, and nothing is taken.
TEST(GroupsWithoutEnd, ElasticBoxesKeepTheirEnergy) {
  std::vector<std::uint64_t> hashes;
  for (const std::string& policy : exact_policies()) {
    Simulator simulator(column(), by(policy));
    const RunSummary summary = simulator.run(until(0.5));
    EXPECT_TRUE(summary.sound()) << policy << ": " << summary.why;
    EXPECT_NEAR(summary.energy_final, 50.0, 1e-10) << policy;
    EXPECT_NEAR(summary.momentum.y(), 10.0, 1e-12) << policy;
    EXPECT_EQ(summary.groups_taken, 0U) << policy;
    hashes.push_back(summary.state_hash);
  }
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

// A disc in a hole of its own size has nowhere to go with its energy: it is taken, and the summary says how
// much and of whom.
TEST(GroupsWithoutEnd, DiscInATightHoleIsTakenAndNamed) {
  World world;
  add(world, body(make_disc(1), {0, 0}, {1.0, 0.3}));
  FixedSite hole = site(make_box(2, 2));
  hole.outline = std::make_shared<Outline>(as_container(make_box(2, 2).outline));
  hole.name = "hole";
  add(world, hole);
  for (const std::string& policy : exact_policies())
    for (const char* order : {"index", "reflections"}) {
      Simulator simulator(world, by(policy, order));
      const RunSummary summary = simulator.run(until(1.0));
      EXPECT_FALSE(summary.sound()) << policy << ", " << order;
      EXPECT_GE(summary.groups_taken, 1U) << policy << ", " << order;
      EXPECT_NEAR(summary.energy_taken, 0.545, 1e-15) << policy << ", " << order;
      EXPECT_NE(summary.first_taken.find("'body0' on 'hole' at t = 0"), std::string::npos)
          << summary.first_taken;
    }
}

// In a group, a disc that lies in a corner touches both walls at once.
TEST(Groups, DiscInACornerReboundsFromBothWalls) {
  World world;
  add(world, body(make_disc(0.5), {2, 2}, {-1.0, -1.0}));
  FixedSite room = site(make_box(6, 6), {3, 3});
  room.outline = std::make_shared<Outline>(as_container(make_box(6, 6).outline));
  add(world, room);
  for (const char* order : {"lcp", "reflections"}) {
    Simulator simulator(world, by("body_clocks", order));
    Events events;
    simulator.run(until(2.0), &events);
    EXPECT_NEAR(simulator.state(0).twist.velocity.x(), 1.0, 1e-12) << order;
    EXPECT_NEAR(simulator.state(0).twist.velocity.y(), 1.0, 1e-12) << order;
    EXPECT_EQ(events.collisions().size(), 2U) << order;
    EXPECT_EQ(events.collisions()[0].contact.time, events.collisions()[1].contact.time) << order;
  }
}

// A view that ends within the instant of a contact: whatever comes of it, the policy goes on or ends.
TEST(Instants, SiteThatTurnsWithinARoundingOfTheClockDoesNotCrash) {
  World world;
  FixedSite blade = site(make_box(0.5, 0.01), {1, 0});
  blade.motion = ConstantMotion{{Vec2::Zero(), 1e15}};
  add(world, blade);
  add(world, body(make_disc(0.1), {0, 0}, {1, 0}));
  for (const std::string& policy : exact_policies())
    for (const char* order : {"index", "closing_speed"}) {
      Simulator simulator(world, by(policy, order));
      RunOptions options = until(1.0);
      const auto begin = std::chrono::steady_clock::now();
      options.progress = [begin](double, std::uint64_t) {
        return std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(300);
      };
      EXPECT_NE(simulator.run(options).termination, Termination::not_run) << policy << ", " << order;
    }
}

// Stopped again and again, wherever it asks, and gone on with: every frame once and in order, and the state
// of the undisturbed run.
TEST(Stops, LeaveNoGapAndNothingTwiceInTheFrames) {
  World world;
  for (int k = 0; k < 12; ++k)
    add(world, body(make_box(0.3, 0.2), {0.6 * (k % 4), 0.6 * (k / 4)}, {10 * std::cos(k), 10 * std::sin(k)},
                    1.0, k, 1.0));
  FixedSite room = site(make_box(6, 6), {1, 1});
  room.outline = std::make_shared<Outline>(as_container(make_box(6, 6).outline));
  add(world, room);
  RunOptions whole = until(20.0);
  whole.frame_interval = 1.0 / 32.0;
  for (const std::string& policy : exact_policies()) {
    Simulator undisturbed(world, by(policy)), stopped(world, by(policy));
    Events all, pieces;
    undisturbed.run(whole, &all);
    RunOptions piece = whole;
    int asked = 0, stops = 0;
    piece.progress = [&](double, std::uint64_t) { return ++asked % 2 != 0; };
    while (stopped.run(piece, &pieces).termination == Termination::stopped && ++stops < 10000)
      piece.first_frame = false;
    EXPECT_GT(stops, 0) << policy;
    EXPECT_EQ(stopped.state_hash(), undisturbed.state_hash()) << policy << ", " << stops << " stops";
    EXPECT_TRUE(std::is_sorted(pieces.frame_times.begin(), pieces.frame_times.end())) << policy;
    for (const double t : all.frame_times)
      EXPECT_EQ(std::count(pieces.frame_times.begin(), pieces.frame_times.end(), t), 1)
          << policy << " at " << t;
  }
}

// A piston comes down on a box that lies on a floor, which nothing can keep both out of.
TEST(Endings, ABodyThatASiteCrushesIsTold) {
  World world;
  world.gravity = {0.0, -9.81};
  world.materials[0].restitution = 0.0;
  add(world, site(make_box(10.0, 1.0), {0.0, -0.5}));
  FixedSite piston = site(make_box(3.0, 0.5), {0.0, 2.0});
  piston.motion = ConstantMotion{{Vec2(0.0, -1.0), 0.0}};
  add(world, piston);
  add(world, body(make_box(1.0, 1.0), {0.0, 0.5}, {0.0, 0.0}));
  SolverOptions options;
  options.persistent = true;
  Simulator simulator(world, options);
  const RunSummary summary = simulator.run(until(3.0));
  EXPECT_EQ(summary.termination, Termination::failed);
  EXPECT_NE(summary.why.find("finds no step"), std::string::npos) << summary.why;
  EXPECT_NE(summary.why.find("'site1', which moves, leaves no room"), std::string::npos) << summary.why;
  EXPECT_NEAR(simulator.time(), 0.75, 1e-9);
}

// Fifty million overlapping pairs: the first are named.
TEST(Starts, TenThousandBodiesInOnePlaceAreRefusedByTheFirstFew) {
  World world;
  const Body disc = body(make_disc(0.1), {0, 0}, {1, 0});
  for (int k = 0; k < 10000; ++k) {
    add(world, disc);
    world.bodies.back().name = numbered("b", k);
  }
  Simulator simulator(world, {});
  EXPECT_NE(simulator.start_fault().find("overlap by 0.2 m"), std::string::npos) << simulator.start_fault();
  EXPECT_NE(simulator.start_fault().find("or more"), std::string::npos) << simulator.start_fault();
  EXPECT_EQ(simulator.overlaps(20).size(), 20U);
}

TEST(Starts, BoxesThatOverlapAlongTheirEdgesAreRefused) {
  for (const Vec2& by : {Vec2(0.5, 0), Vec2(0, 0.25), Vec2(0, 0)}) {
    World world;
    add(world, body(make_box(1, 1), {0, 0}, {0, 0}));
    add(world, body(make_box(1, 1), by, {0, 0}));
    EXPECT_NE(Simulator(world, {}).start_fault().find("'body0' and 'body1' overlap"), std::string::npos)
        << by.transpose();
  }
}

// In a plane that repeats a site is met where its images are, however far from the origin it was drawn; one
// that covers the plane a million million times is refused.
TEST(Starts, SitesFarAwayAndHugeInAPeriodicWorld) {
  World world;
  world.periods.size = {8, 8};
  add(world, body(make_disc(0.5), {1, 1}, {1, 0}));
  add(world, site(make_point({-8000 + 5, 1})));  // a thousand periods away
  Simulator simulator(world, {});
  EXPECT_EQ(simulator.run(until(4.0)).collisions, 1U);  // at x = 5, 3.5 m away
  EXPECT_NEAR(simulator.state(0).pose.position.x(), 4.5 - 0.5, 1e-9);
  add(world, site(make_segment({0, 0}, {1e7, 1e7})));
  EXPECT_THROW(Simulator(world, {}), BadInput);
}

// Ten thousand materials make a hundred million pairs, of which one meets.
TEST(Starts, MaterialsAreCombinedWhereTheyMeet) {
  World world;
  world.materials.assign(10000, Material{});
  for (int k = 0; k < 10000; ++k) world.materials[k].name = numbered("m", k);
  world.materials[7].restitution = 0.5;
  world.restitution_rule = Combine::min;
  add(world, body(make_disc(0.5), {0, 0}, {1, 0}));
  add(world, body(make_disc(0.5), {2, 0}, {0, 0}));
  world.bodies[0].material = 9999;
  world.bodies[1].material = 7;
  Simulator simulator(world, {});
  ASSERT_EQ(simulator.run(until(2.0)).collisions, 1U);
  EXPECT_NEAR(simulator.state(1).twist.velocity.x(), 0.75, 1e-14);
}

}  // namespace
}  // namespace brink::endings_test
