// Contacts that last where they begin, end or go over from one feature to the next: edges, joints, supports
// that move, springs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/outside/frame_watch.h"
#include "tests/support/settling.h"

namespace brink::lasting_contacts_edges_test {
namespace {

using testing::add;
using testing::add_floor;
using testing::body;
using testing::go_on;
using testing::heavy_world;
using testing::kEarth;
using testing::lasting;
using testing::site;

/// A floor in two pieces that meet at x = 0.
void add_floor_in_two(World& world) {
  add(world, site(make_segment({-10.0, 0.0}, {0.0, 0.0})));
  add(world, site(make_segment({0.0, 0.0}, {10.0, 0.0})));
}

// ---- joints: two pieces of one straight floor are one floor

// The second floor's end is near before it is under the box.
TEST(Joint, OfTwoFloorsIsNotFeltByASlidingBox) {
  World world = heavy_world(0.0, 0.0);
  add_floor_in_two(world);
  add(world, body(make_box(0.4, 0.2), {-1.0, 0.1 + 1e-12}, {1.0, 0.0}));
  Simulator simulator(world, lasting());
  EXPECT_EQ(go_on(simulator, 2.0), "");
  const BodyState s = simulator.state(0);
  std::printf("sliding box: speed %.9f of 1, place off by %.1e m, turned by %.1e\n", s.twist.velocity.x(),
              s.pose.position.x() - 1.0, s.pose.angle);
  EXPECT_NEAR(s.twist.velocity.x(), 1.0, 1e-9);
  EXPECT_NEAR(s.pose.position.x(), 1.0, 1e-9);
  EXPECT_NEAR(s.pose.position.y(), 0.1, 1e-9);
}

TEST(Joint, OfTwoFloorsIsNotFeltByARollingWheel) {
  World world = heavy_world(0.0, 0.5);
  add_floor_in_two(world);
  const double v = 0.7, r = 0.25;
  add(world, body(make_disc(r), {-1.0, r + 1e-12}, {v, 0.0}, 1.0, 0.0, -v / r));
  Simulator simulator(world, lasting());
  EXPECT_EQ(go_on(simulator, 3.0), "");
  const BodyState s = simulator.state(0);
  std::printf("rolling wheel: speed %.9f of %.1f, place off by %.1e m, height by %.1e m\n",
              s.twist.velocity.x(), v, s.pose.position.x() - (-1.0 + 3.0 * v), s.pose.position.y() - r);
  EXPECT_NEAR(s.twist.velocity.x(), v, 1e-9);
  EXPECT_NEAR(s.pose.position.y(), r, 1e-9);
}

// ---- edges

/// Runs with frames watched, to the end.
std::string watched(const World& world, double end, outside::FrameWatch& watch) {
  Simulator simulator(world, lasting());
  RunOptions options = testing::until(end);
  options.frame_interval = 0.001;
  const RunSummary summary = simulator.run(options, &watch);
  std::printf("deepest %.1e m, gained %.1e at %.3f s: %s\n", static_cast<double>(watch.deepest),
              static_cast<double>(watch.gained), watch.when, summary.termination_text().c_str());
  return summary.termination == Termination::reached_end ? "" : summary.why;
}

// Over the edge its lower face turns about the corner.
TEST(Edge, BoxSlidesOverItAndFalls) {
  World world = heavy_world(0.0, 0.0);
  add(world, site(make_box(4.0, 1.0), {-2.0, -0.5}));
  add(world, body(make_box(0.4, 0.2), {-1.0, 0.1 + 1e-12}, {1.0, 0.0}));
  outside::FrameWatch watch(world, 2.0, 1e-9);
  EXPECT_EQ(watched(world, 2.0, watch), "");
  EXPECT_TRUE(watch.sound()) << watch.report();
  EXPECT_LE(watch.gained, 1e-10);
}

TEST(Edge, RodTipsOverAPeg) {
  World world = heavy_world(0.0, 0.6);
  add(world, site(make_disc(0.05), {0.0, -0.05}));
  add(world, body(make_box(1.0, 0.02), {0.05, 0.01 + 1e-12}, {0.0, 0.0}));
  outside::FrameWatch watch(world, 1.0, 1e-9);
  EXPECT_EQ(watched(world, 1.0, watch), "");
  EXPECT_TRUE(watch.sound()) << watch.report();
  EXPECT_LE(watch.gained, 1e-10);
}

// ---- supports that move

TEST(Table, ThatShakesGentlyCarriesItsLoad) {
  for (const bool upward : {true, false}) {
    World world = heavy_world(0.0, 0.5);
    FixedSite table = site(make_box(4.0, 0.5), {0.0, -0.25});
    FormulaMotion motion;
    (upward ? motion.y : motion.x).emplace("0.02*sin(6*t)", std::vector<std::string>{"t"});
    table.motion = motion;
    add(world, table);
    add(world, body(make_box(0.4, 0.2), {0.0, 0.1 + 1e-12}, {0.0, 0.0}));
    outside::FrameWatch watch(world, 3.0, 1e-9);
    EXPECT_EQ(watched(world, 3.0, watch), "") << upward;
    EXPECT_TRUE(watch.sound()) << watch.report();
  }
}

// Equal boxes, corner on corner, hold each other by their faces.
TEST(Lift, ThatRisesEvenlyCarriesAStack) {
  World world = heavy_world(0.0, 0.5);
  FixedSite lift = site(make_box(4.0, 0.5), {0.0, -0.25});
  lift.motion = ConstantMotion{{{0.0, 0.5}, 0.0}};
  add(world, lift);
  for (int k = 0; k < 3; ++k)
    add(world, body(make_box(0.4, 0.2), {0.0, 0.1 + 0.2 * k + 1e-10 * (k + 1)}, {0.0, 0.5}));
  outside::FrameWatch watch(world, 2.0, 1e-9);
  EXPECT_EQ(watched(world, 2.0, watch), "");
  EXPECT_TRUE(watch.sound()) << watch.report();
}

// ---- springs

// Two boxes that slide towards each other and apart: what one wins the other has, and energy stays.
TEST(Spring, BetweenSlidingBoxesKeepsMomentumAndAboutTheEnergy) {
  World world = heavy_world(0.0, 0.0);
  add_floor(world);
  for (const double x : {-0.6, 0.6}) add(world, body(make_box(0.2, 0.2), {x, 0.1 + 1e-12}, {0.0, 0.0}));
  SpringForce spring;
  spring.body_b = 1;
  spring.stiffness = 20.0;
  spring.rest_length = 0.8;
  world.forces.emplace_back(spring);
  Simulator simulator(world, lasting());
  double most = 0.0;
  const double energy = 0.5 * 20.0 * 0.4 * 0.4;
  for (double t = 0.05; t <= 5.0; t += 0.05) {
    ASSERT_EQ(go_on(simulator, t), "") << t;
    const BodyState a = simulator.state(0), b = simulator.state(1);
    const double stretch = (b.pose.position - a.pose.position).norm() - 0.8;
    EXPECT_NEAR((a.twist.velocity + b.twist.velocity).x(), 0.0, 1e-9) << t;
    most = std::max(most, 0.5 * (a.twist.velocity.squaredNorm() + b.twist.velocity.squaredNorm()) +
                              10.0 * stretch * stretch);
  }
  std::printf("most energy on the way: %.4f of it\n", most / energy);
  EXPECT_LE(most, 1.1 * energy);
}

}  // namespace
}  // namespace brink::lasting_contacts_edges_test
