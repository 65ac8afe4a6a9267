// Two plain discs, or one and a straight wall, that are alone in their instant are searched and resolved in one go where nobody looks on
// (Kernel::has_quick_way): the same bits as by the common way, which a recorder of events, a switched-off closed form or
// another policy asks for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "brink/core/base/random.h"
#include "brink/scheduler/simulator/simulator.h"
#include "tests/support/gases.h"

namespace brink::quick_way_test {
namespace {

struct End {
  std::uint64_t hash, collisions, quick;
  double overlap;
};

End run(const World& world, const SolverOptions& options, double end, Recorder* recorder = nullptr) {
  Simulator simulator(world, options);
  const RunSummary s = simulator.run(testing::until(end), recorder);
  EXPECT_EQ(s.termination, Termination::reached_end) << s.why;
  return {s.state_hash, s.work.collisions, s.work.collisions_quick, s.max_overlap};
}

/// By the quick way; with somebody who looks on; by the general search; by another policy; stopped and gone on with.
void expect_same_ends(const World& world, double end, double part_quick) {
  SolverOptions options;
  const End quick = run(world, options, end);
  EXPECT_GE(static_cast<double>(quick.quick), part_quick * static_cast<double>(quick.collisions));
  EXPECT_GT(quick.collisions, 300U);
  testing::Events events;
  const End watched = run(world, options, end, &events);
  EXPECT_EQ(watched.quick, 0U);
  EXPECT_EQ(watched.hash, quick.hash);
  EXPECT_EQ(watched.collisions, quick.collisions);
  EXPECT_EQ(watched.overlap, quick.overlap);
  SolverOptions general = options;
  general.closed_forms = false;
  const End searched = run(world, general, end);
  EXPECT_EQ(searched.quick, 0U);
  EXPECT_EQ(searched.hash, quick.hash);
  SolverOptions backup = options;
  backup.policy = "global_backup";
  EXPECT_EQ(run(world, backup, end).hash, quick.hash);
  Simulator in_parts(world, options);
  for (int k = 1; k <= 7; ++k) {
    in_parts.run(testing::until(end * k / 7.0));
    const std::vector<std::byte> snapshot = in_parts.snapshot();
    if (k == 3) in_parts.restore(snapshot);
  }
  EXPECT_EQ(in_parts.state_hash(), quick.hash);
}

/// Every material with that restitution, and discs of several masses.
World uneven(World world, double restitution) {
  Random random(17);
  for (Material& m : world.materials) m.restitution = restitution;
  for (Body& b : world.bodies) {
    const double mass = random.uniform(0.5, 2.0);
    b.inertia *= mass / b.mass;
    b.mass = mass;
  }
  return world;
}

World gas(int count, double packing = 0.5) {
  return testing::boxed(testing::lattice_gas(count, make_disc(0.5), packing, 1.0));
}

TEST(QuickWay, OfElasticDiscsGivesTheBitsOfTheCommonWay) { expect_same_ends(gas(150), 4.0, 0.95); }

TEST(QuickWay, OfUnequalDiscsThatLoseEnergyGivesTheBitsOfTheCommonWay) {
  expect_same_ends(uneven(gas(150), 0.9), 4.0, 0.95);
}

TEST(QuickWay, UnderGravityGivesTheBitsOfTheCommonWay) {
  World world = uneven(gas(150, 0.4), 0.97);
  world.gravity = {0.5, -2.0};
  expect_same_ends(world, 4.0, 0.6);
}

TEST(QuickWay, InAPlaneThatRepeatsGivesTheBitsOfTheCommonWay) {
  expect_same_ends(testing::lattice_gas(150, make_disc(0.5), 0.5, 1.0), 4.0, 0.6);
}

/// The same world elsewhere.
World displaced(World world, const Vec2& by) {
  for (Body& b : world.bodies) b.initial.pose.position += by;
  for (FixedSite& s : world.sites) s.pose.position += by;
  return world;
}

// There searches see a pair from its own place, in extended precision; at 435 m a part of the pairs, as they move.
TEST(QuickWay, FarFromTheOriginGivesTheBitsOfTheCommonWay) {
  expect_same_ends(displaced(gas(150), {2000.0, -900.0}), 4.0, 0.85);
  expect_same_ends(displaced(uneven(gas(150), 0.9), {-3e4, 1e5}), 4.0, 0.85);
  expect_same_ends(displaced(gas(150), {435.0, 5.0}), 4.0, 0.85);
  expect_same_ends(displaced(testing::lattice_gas(150, make_disc(0.5), 0.5, 1.0), {3000.0, 0.0}), 4.0, 0.5);
}

/// Few discs between walls of any direction, thick and thin, that meet at sharp corners: most collisions are with these.
World in_a_triangle(double restitution) {
  World world = testing::lattice_gas(9, make_disc(0.5), 0.2, 1.0);
  world.periods = {};
  const Vec2 corners[] = {{-9.0, -4.0}, {9.5, -5.0}, {0.5, 9.0}};
  for (int k = 0; k < 3; ++k)
    testing::add(world, testing::site(make_segment(corners[k], corners[(k + 1) % 3], 0.1 * k)));
  return uneven(world, restitution);
}

/// With fins among them, whose tips discs come to beside the fins' lines.
World among_fins(double restitution) {
  World world = in_a_triangle(restitution);
  Random random(23);
  for (int k = 0; k < 12; ++k) {
    const Vec2 at(random.uniform(-5.0, 5.0), -4.0 + random.uniform(0.0, 5.0));
    const double turn = random.uniform(0.0, 7.0);
    const Vec2 way = 0.15 * Vec2(std::cos(turn), std::sin(turn));
    if (std::none_of(world.bodies.begin(), world.bodies.end(),
                     [&](const Body& b) { return (b.initial.pose.position - at).norm() < 0.7; }))
      testing::add(world, testing::site(make_segment(at - way, at + way, 0.02 * (k % 2))));
  }
  return world;
}

TEST(QuickWay, AmongFinsGivesTheBitsOfTheCommonWay) {
  expect_same_ends(among_fins(1.0), 120.0, 0.3);
  expect_same_ends(among_fins(0.99), 200.0, 0.3);
}

TEST(QuickWay, AtWallsGivesTheBitsOfTheCommonWay) {
  expect_same_ends(in_a_triangle(1.0), 120.0, 0.8);
  expect_same_ends(in_a_triangle(0.99), 200.0, 0.7);
}

// A cradle's contacts share instants, and a row that is hit from both ends has several in each.
TEST(QuickWay, LeavesInstantsThatAreSharedToTheCommonWay) {
  World world = gas(100);
  for (int k = 0; k < 12; ++k)
    testing::add(world, testing::body(make_disc(0.25), {20.0 + 0.5 * k, 0.0}, {0.0, 0.0}));
  testing::add(world, testing::body(make_disc(0.25), {18.0, 0.0}, {1.0, 0.0}));
  testing::add(world, testing::body(make_disc(0.25), {27.5, 0.0}, {-1.0, 0.0}));
  expect_same_ends(world, 5.0, 0.5);
}

TEST(QuickWay, AmongBoxesAndRoughDiscsIsForPlainDiscsAlone) {
  World world = gas(150, 0.4);
  const int rough = static_cast<int>(world.materials.size());
  Material material = world.materials[0];
  material.name = "rough";
  material.friction = 0.3;
  world.materials.push_back(material);
  const Shape box =
      make_box(0.6, 0.5, 0.05);  // a sharp corner and a bare wire would leave the quick way to nobody
  for (std::size_t k = 0; k < world.bodies.size(); k += 3) {
    Body& b = world.bodies[k];
    if (k % 2 == 0) {
      b.material = rough;
      continue;
    }
    Body other = testing::body(box, b.initial.pose.position, b.initial.twist.velocity);
    other.name = b.name;
    b = other;
  }
  expect_same_ends(world, 3.0, 0.2);
}

}  // namespace
}  // namespace brink::quick_way_test
