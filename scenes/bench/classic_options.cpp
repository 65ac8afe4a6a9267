// brink bench classic: the time that each performance option saves.
// Each option against plain() on one world, first alone, then together. Runs are short: what is timed is
// drawing and reading back, not what collisions make of the bodies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "brink/core/base/random.h"
#include "brink/scenes/bench/classic.h"
#include "brink/scenes/bench/classic_worlds.h"
#include "brink/scenes/bench/csv.h"
#include "brink/scenes/program/terminal.h"

namespace brink::bench {
namespace {

// The median of three: one slow round does not count.
constexpr int kRounds = 3;
// 25 bodies: enough that pruning by bounding circles has something to leave out.
constexpr int kSide = 5;                        // bodies along each side of the frame
constexpr double kApart = 1.0;                  // their cells [m]
constexpr double kUntil = 0.03, kStep = 0.002;  // [s]
constexpr double kSpacing = 0.05;               // [m]
constexpr double kHalf = 0.5 * kSide * kApart;  // of the frame [m]

/// Corners on two circles in turn, counter-clockwise [m].
std::vector<Vec2> star(int points, double outer, double inner) {
  std::vector<Vec2> corners;
  for (int k = 0; k < 2 * points; ++k) {
    const double angle = std::numbers::pi * k / points, r = k % 2 == 0 ? outer : inner;
    corners.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  return corners;
}

/// Bodies of four kinds, each with its own cell of a frame of short walls.
/// The seed is fixed, so that state hashes can be compared between runs of the program.
World crowd() {
  Random random(5);
  World world;
  const Shape shapes[] = {make_box(0.5, 0.3), make_disc(0.3), make_polygon(star(12, 0.4, 0.3)),
                          make_box(0.4, 0.2, 0.1)};
  for (int k = 0; k < kSide * kSide; ++k) {
    const Vec2 cell(k % kSide + 0.5, k / kSide + 0.5);
    const Vec2 shift(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1));
    // Somewhere near the middle of its cell, turned anyhow.
    const Pose pose{kApart * cell - Vec2(kHalf, kHalf) + shift, random.uniform(0.0, 6.0)};
    const Twist twist{{random.uniform(-4, 4), random.uniform(-4, 4)}, random.uniform(-4.0, 4.0)};
    // The star's radius and the shift make 0.5 m at most, half a cell: nothing overlaps at the start.
    world.bodies.push_back(sampled_body(shapes[k % 4], pose, twist, kSpacing));
    world.bodies.back().name = fmt::format("body{}", k);
  }
  // The walls of the lower side, turned to all four.
  for (int side = 0; side < 4; ++side)
    for (int k = 0; k < kSide; ++k)
      add_fixed(world, make_segment({-kHalf + k * kApart, -kHalf}, {-kHalf + (k + 1) * kApart, -kHalf}),
                {Vec2::Zero(), side * 0.5 * std::numbers::pi});
  return world;
}

/// One line of the table: what is switched on against plain(), and what came of it in each round.
struct Saving {
  const char* name;
  std::function<void(SolverOptions&)> set;
  std::vector<double> seconds;
  RunSummary summary;

  double median() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

/// The three options that change no bit of the answer (docs/classic.md), as they are by default.
void all_together(SolverOptions& o) {
  o.field.readback = "window";
  o.broad_phase = o.field.truncated = true;
}

// The first is the one that others are compared with.
std::vector<Saving> savings() {
  return {{"none: full read-back, whole diagram, every body", [](SolverOptions&) {}, {}, {}},
          {"read-back of the window", [](SolverOptions& o) { o.field.readback = "window"; }, {}, {}},
          {"read-back of single pixels", [](SolverOptions& o) { o.field.readback = "pixel"; }, {}, {}},
          {"bounding circles", [](SolverOptions& o) { o.broad_phase = true; }, {}, {}},
          {"truncated diagram", [](SolverOptions& o) { o.field.truncated = true; }, {}, {}},
          {"two layers for all bodies", [](SolverOptions& o) { o.field.passes = "two_layers"; }, {}, {}},
          {"cones and tents", [](SolverOptions& o) { o.field.primitives = "mesh"; }, {}, {}},
          {"window, bounding circles, truncated (the defaults)", all_together, {}, {}},
          {"the defaults with two layers",
           [](SolverOptions& o) {
             all_together(o);
             o.field.passes = "two_layers";
           },
           {},
           {}},
          {"the defaults with cones and tents",
           [](SolverOptions& o) {
             all_together(o);
             o.field.primitives = "mesh";
           },
           {},
           {}}};
}

/// Everything off.
SolverOptions plain() {
  SolverOptions none = backing_up("depth", kStep);
  // fixed_step: the number of pictures is the number of steps, whatever the contacts.
  none.policy = "fixed_step";
  none.broad_phase = false;
  none.field.truncated = false;
  none.field.readback = "full";
  return none;
}

/// One run from the beginning. The clock is the simulator's own, without planning.
void time_once(const World& world, Saving& saving) {
  SolverOptions options = plain();
  saving.set(options);
  Simulator simulator(world, options);
  RunOptions run;
  run.until = kUntil;
  run.checkpoint_seconds = -1.0;
  saving.summary = simulator.run(run);
  saving.seconds.push_back(saving.summary.wall_seconds);
}

}  // namespace

void measure_options(const std::filesystem::path& folder) {
  fmt::print(
      "{}  {} bodies in a frame, {:g} steps of {:g} ms; each option alone, then together; median of {}\n",
      paint(stdout, Paint::heading, "options"), kSide * kSide, kUntil / kStep, 1e3 * kStep, kRounds);
  const World world = crowd();
  std::vector<Saving> all = savings();
  // In rounds, so that a busy moment of the machine does not fall on one option alone.
  for (int round = 0; round < kRounds; ++round)
    for (Saving& saving : all) time_once(world, saving);
  Csv csv(folder / "classic_options.csv",
          "option,wall_seconds,of_none,collisions,passes,pixels_drawn,pixels_read,state_hash");
  for (const Saving& saving : all) {
    // Equal hashes show what changes no bit; those with two layers or meshes may differ.
    const double seconds = saving.median(), share = seconds / all.front().median();
    const RunSummary& s = saving.summary;
    fmt::print("  {:<52} {:>8.1f} ms  {:>6.3f} of none  {:>3} collisions  {:016x}\n", saving.name,
               1e3 * seconds, share, s.collisions, s.state_hash);
    csv.row("\"{}\",{:.6g},{:.4f},{},{},{},{},{:016x}", saving.name, seconds, share, s.collisions,
            s.work.passes, s.work.pixels_drawn, s.work.pixels_read, s.state_hash);
  }
  csv.close();
  fmt::print("table {}\n\n", (folder / "classic_options.csv").string());
}

}  // namespace brink::bench
