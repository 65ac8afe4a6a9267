// The classic detector against exact answers: what it misses, how it converges, what its options change.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "brink/core/base/random.h"
#include "brink/scenes/scene.h"
#include "tests/support/worlds.h"

namespace brink {
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

constexpr int kBoxes = 80;
constexpr double kReach = 0.2;  // [m]

/// The share of boxes of side 1 that, moving down onto a wedge at a random place of their lower side, are not
/// stopped within kReach of its tip.
double missed(double spacing, double degrees, const std::string& detector) {
  Random random(17);
  World world;
  const double half = 0.6 * std::tan(0.5 * degrees * std::numbers::pi / 180.0);
  const Shape wedge = make_polygon({{-half, -0.6}, {half, -0.6}, {0.0, 0.0}});
  for (int k = 0; k < kBoxes; ++k) {
    Body b = body(make_box(1, 1), {4.0 * k + random.uniform(-0.25, 0.25), 0.6}, {0.0, -1.0});
    b.sampling.kind = Sampling::Kind::boundary;
    b.sampling.spacing = spacing;
    add(world, b);
    add(world, site(wedge, {4.0 * k, 0.0}));
  }
  Simulator simulator(world, options_of(detector));
  Events events;
  EXPECT_EQ(simulator.run(until(0.1 + kReach), &events).termination, Termination::reached_end);
  std::set<int> stopped;
  for (const Event& e : events.collisions()) stopped.insert(e.contact.body);
  return 1.0 - static_cast<double>(stopped.size()) / kBoxes;
}

// A particle u beside the tip meets the wedge's flank u / tan(half its angle) later than the tip meets the
// side; u is even in 0 .. spacing / 2. So the share missed is 1 - 2 reach tan / spacing, or none; a pixel
// (1/64 of 1.41 m) of tolerance makes it a little less, five standard errors of 80 draws a little more or
// less. The exact detectors stop every box at the tip.
TEST(Classic, MissesWhatFitsBetweenParticlesAndTheExactDetectorsMissNothing) {
  for (const double degrees : {15.0, 45.0})
    for (const double spacing : {0.5, 0.25, 0.0625}) {
      const double slope = std::tan(0.5 * degrees * std::numbers::pi / 180.0);
      const double expected = std::max(0.0, 1.0 - 2.0 * kReach * slope / spacing);
      const double error = 5.0 * std::sqrt(std::max(expected * (1.0 - expected), 0.0) / kBoxes);
      const double share = missed(spacing, degrees, "depth");
      EXPECT_LE(share, expected + error) << degrees << " deg, " << spacing << " m";
      EXPECT_GE(share, expected - error - 4.0 * 0.022 / spacing) << degrees << " deg, " << spacing << " m";
    }
  for (const char* detector : {"field", "pass"}) EXPECT_EQ(missed(0.5, 15.0, detector), 0.0) << detector;
}

/// Root mean square error [s] of the first contact of discs that fall from heights drawn at random.
double fall_error(const SolverOptions& options) {
  Random random(23);
  World world;
  world.gravity = {0.0, -9.81};
  std::vector<double> truth;
  for (int k = 0; k < 24; ++k) {
    const double height = random.uniform(0.8, 1.2);
    add(world, body(make_disc(0.5), {3.0 * k, 0.5 + height}, {0.0, 0.0}));
    truth.push_back(std::sqrt(2.0 * height / 9.81));
  }
  add(world, site(make_segment({-5, 0}, {80, 0})));
  Simulator simulator(world, options);
  Events events;
  simulator.run(until(0.62), &events);
  std::map<int, double> first;
  for (const Event& e : events.collisions()) first.try_emplace(e.contact.body, e.contact.time);
  EXPECT_EQ(first.size(), truth.size());
  double sum = 0.0;
  for (const auto& [k, t] : first) sum += (t - truth[k]) * (t - truth[k]);
  return std::sqrt(sum / 24);
}

// The error of a picture is a pixel over the closing speed: first order in the pixel. Stepping without
// backing up errs by a step: first order in the step.
TEST(Classic, ConvergesAtFirstOrderInPixelAndStep) {
  const auto with_pixels = [](int resolution) {
    SolverOptions options = options_of("depth");
    options.field.resolution = resolution;
    return fall_error(options);
  };
  EXPECT_NEAR(std::log2(with_pixels(32) / with_pixels(256)) / 3.0, 1.0, 0.2);
  const auto with_step = [](double step) {
    SolverOptions options = options_of("depth", step);
    options.policy = "fixed_step";
    options.field.resolution = 1024;
    return fall_error(options);
  };
  EXPECT_NEAR(std::log2(with_step(0.04) / with_step(0.01)) / 2.0, 1.0, 0.35);
}

// How a picture is read back, whether bodies without neighbours are drawn, and how far the diagram reaches
// change the work, not a bit of the answer.
TEST(Classic, PerformanceOptionsChangeTheWorkAlone) {
  const Scene scene = load_scene(fs::path(BRINK_SOURCE_DIR) / "scenes/gallery/classic_block.toml");
  std::set<std::uint64_t> hashes, read;
  for (int k = 0; k < 6; ++k) {
    SolverOptions options = scene.solver;
    if (k < 3) options.field.readback = std::vector{"full", "window", "pixel"}[k];
    options.skip_broad_phase = k != 3;
    options.field.truncated = k != 4;
    if (k == 5) options.field.primitives = "mesh";
    Simulator simulator(scene.world, options);
    const RunSummary summary = simulator.run(until(1.5));
    EXPECT_EQ(summary.termination, Termination::reached_end);
    EXPECT_GT(summary.collisions, 1U);
    if (k < 5) hashes.insert(summary.state_hash);
    read.insert(summary.work.pixels_read);
  }
  EXPECT_EQ(hashes.size(), 1U);
  EXPECT_GE(read.size(), 4U);
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
}  // namespace brink
