// The classic detector against exact answers: what it misses, how it converges, what its options change.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "brink/scenes/scene/scene.h"
#include "tests/support/seeded_random.h"
#include "tests/support/worlds.h"

namespace brink::classic_test {
namespace {

namespace fs = std::filesystem;
using brink::testing::add;
using brink::testing::body;
using brink::testing::Events;
using brink::testing::site;
using brink::testing::until;

SolverOptions options_of(const std::string& detector, double step = 0.01) {
  SolverOptions options;
  options.policy = "global_backup";
  options.detector = detector;
  options.step = step;
  return options;
}

constexpr int kBoxes = 24;
constexpr double kReach = 0.2;  // [m]

/// The share of boxes of side 1 that, moving down onto a wedge at a random place of their lower side, are not
/// stopped within kReach of its tip. A box a world: the cost of backing a world up grows with its bodies.
double missed(double spacing, double degrees, const std::string& detector, Random random) {
  const double half = 0.6 * std::tan(0.5 * degrees * std::numbers::pi / 180.0);
  const Shape wedge = make_polygon({{-half, -0.6}, {half, -0.6}, {0.0, 0.0}});
  int stopped = 0;
  for (int k = 0; k < kBoxes; ++k) {
    World world;
    Body b = body(make_box(1, 1), {random.uniform(-0.25, 0.25), 0.53}, {0.0, -1.0});
    b.sampling.kind = Sampling::Kind::boundary;
    b.sampling.spacing = spacing;
    add(world, b);
    add(world, site(wedge));
    SolverOptions options = options_of(detector);
    options.max_collisions = 1;
    Simulator simulator(world, options);
    Events events;
    EXPECT_NE(simulator.run(until(0.03 + kReach), &events).termination, Termination::failed);
    stopped += events.collisions().empty() ? 0 : 1;
  }
  return 1.0 - static_cast<double>(stopped) / kBoxes;
}

// A particle u beside the tip meets the wedge's flank u / tan(half its angle) later than the tip meets the
// side; u is even in 0 .. spacing / 2. So the share missed is 1 - 2 reach tan / spacing, or none; a pixel
// (1/64 of 1.41 m) of tolerance makes it a little less, five standard errors of 24 draws a little more or
// less. The exact detectors stop every box at the tip.
TEST(Classic, MissesWhatFitsBetweenParticlesAndTheExactDetectorsMissNothing) {
  const SeededRandom random(17);
  for (const double degrees : {15.0, 45.0})
    for (const double spacing : {0.5, 0.25, 0.0625}) {
      const double slope = std::tan(0.5 * degrees * std::numbers::pi / 180.0);
      const double expected = std::max(0.0, 1.0 - 2.0 * kReach * slope / spacing);
      const double error = 5.0 * std::sqrt(std::max(expected * (1.0 - expected), 0.0) / kBoxes);
      const double share = missed(spacing, degrees, "depth", random);
      EXPECT_LE(share, expected + error) << degrees << " deg, " << spacing << " m";
      EXPECT_GE(share, expected - error - 4.0 * 0.022 / spacing) << degrees << " deg, " << spacing << " m";
    }
  for (const char* detector : {"field", "pass"})
    EXPECT_EQ(missed(0.5, 15.0, detector, random), 0.0) << detector;
}

/// Root mean square error [s] of the first contact of discs that fly at a block at 4 m/s, from distances
/// drawn at random.
double flight_error(SolverOptions options, Random random, const Sampling& sampling = {}) {
  constexpr int kDiscs = 16;
  constexpr double kSpeed = 4.0;
  options.max_collisions = 1;
  double sum = 0.0;
  for (int k = 0; k < kDiscs; ++k) {
    const double away = random.uniform(0.1, 0.42);
    World world;
    Body disc = body(make_disc(0.5), {0.0, 0.5 + away}, {0.0, -kSpeed}, 1.0, random.uniform(0.0, 6.0));
    disc.sampling = sampling;
    add(world, disc);
    add(world, site(make_box(2, 0.5), {0.0, -0.25}));
    Simulator simulator(world, options);
    Events events;
    simulator.run(until(0.2), &events);
    const std::vector<Event> collisions = events.collisions();
    if (collisions.empty()) return std::numeric_limits<double>::infinity();
    const double error = collisions.front().contact.time - away / kSpeed;
    sum += error * error;
  }
  return std::sqrt(sum / kDiscs);
}

// The error of a picture is a pixel over the closing speed: first order in the pixel. Stepping without
// backing up errs by a step: first order in the step. Between particles s apart a disc's edge reaches beyond
// the chord by s^2 / (8 R): second order in the spacing.
TEST(Classic, ConvergesAtFirstOrderInPixelAndStepAndSecondInSpacing) {
  const SeededRandom random(23);
  const auto with_pixels = [&](int resolution) {
    SolverOptions options = options_of("depth");
    options.field.resolution = resolution;
    return flight_error(options, random);
  };
  EXPECT_NEAR(std::log2(with_pixels(32) / with_pixels(128)) / 2.0, 1.0, 0.2);
  const auto with_step = [&](double step) {
    SolverOptions options = options_of("depth", step);
    options.policy = "fixed_step";
    options.field.resolution = 256;
    return flight_error(options, random);
  };
  EXPECT_NEAR(std::log2(with_step(0.04) / with_step(0.01)) / 2.0, 1.0, 0.35);
  const auto with_spacing = [&](double spacing) {
    SolverOptions options = options_of("depth");
    options.field.resolution = 256;
    Sampling boundary;
    boundary.kind = Sampling::Kind::boundary;
    boundary.spacing = spacing;
    return flight_error(options, random, boundary);
  };
  EXPECT_NEAR(std::log2(with_spacing(0.8) / with_spacing(0.4)), 2.0, 0.3);
}

/// Pairs that meet far from each other, and part: there is something to skip.
World pairs_that_part() {
  World world;
  for (int k = 0; k < 6; ++k) {
    Body b = body(k % 2 ? make_box(0.6, 0.4) : make_disc(0.3), {3.0 * (k / 2) + 0.8 * (k % 2), 0.1 * k},
                  {k % 2 ? -1.0 : 1.0, 0.2}, 1.0, 0.3 * k, 0.5 * k);
    b.sampling.kind = Sampling::Kind::boundary;
    b.sampling.spacing = 0.05;
    add(world, b);
  }
  add(world, site(make_segment({-0.5, -2}, {-0.5, 2})));
  return world;
}

// How a picture is read back, whether bodies without neighbours are drawn, and how far the diagram reaches
// change the work, not a bit of the answer.
TEST(Classic, PerformanceOptionsChangeTheWorkAlone) {
  const auto run = [](const char* readback, bool broad_phase, bool truncated) {
    SolverOptions options = options_of("depth");
    options.field.readback = readback;
    options.broad_phase = broad_phase;
    options.field.truncated = truncated;
    Simulator simulator(pairs_that_part(), options);
    const RunSummary summary = simulator.run(until(0.5));
    EXPECT_EQ(summary.termination, Termination::reached_end);
    EXPECT_GT(summary.collisions, 2U);
    return summary;
  };
  const RunSummary none = run("full", false, false);
  const RunSummary window = run("window", false, false);
  const RunSummary pixel = run("pixel", false, false);
  const RunSummary pruned = run("full", true, false);
  const RunSummary truncated = run("full", false, true);
  for (const RunSummary& s : {window, pixel, pruned, truncated}) EXPECT_EQ(s.state_hash, none.state_hash);
  EXPECT_LT(window.work.pixels_read, none.work.pixels_read);
  EXPECT_LT(pixel.work.pixels_read, window.work.pixels_read);
  EXPECT_LT(pruned.work.passes, none.work.passes);
  // the picture stays as large: what shrinks is how much of it each site covers, which is not counted
  EXPECT_EQ(truncated.work.pixels_drawn, none.work.pixels_drawn);
}

// The example body: eight samples from its data file, three an edge, mass 10, rotating at 20 rad/s.
TEST(Classic, ExampleBodyRunsFromItsDataFile) {
  const Scene scene = load_scene(fs::path(BRINK_SOURCE_DIR) / "scenes/gallery/classic_square.toml");
  const Body& square = scene.world.bodies.at(0);
  EXPECT_EQ(square.sampling.points.size(), 8U);
  EXPECT_EQ(square.mass, 10.0);
  EXPECT_NEAR(square.inertia, 10.0 / 6.0, 1e-12);  // m (a^2 + b^2) / 12
  EXPECT_EQ(square.initial.twist.omega, 20.0);
  EXPECT_NEAR(square.initial.pose.angle, std::numbers::pi / 6, 1e-15);
  Simulator simulator(scene.world, scene.solver);
  const RunSummary summary = simulator.run(until(3.0));
  EXPECT_EQ(summary.termination, Termination::reached_end);
  EXPECT_GT(summary.collisions, 3U);
  EXPECT_NEAR(summary.energy_final, summary.energy_initial, 1e-9 * summary.energy_initial);
}

}  // namespace
}  // namespace brink::classic_test
