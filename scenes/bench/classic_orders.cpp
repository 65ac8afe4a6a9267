// brink bench classic: how the error of the first contact falls with pixel, step and spacing.
// One quantity is varied at a time, all others fine, so that it makes nearly all of the error; the order is
// the slope in logarithms. Where the pixel's error is larger than that of what is varied, no order shows
// (docs/classic.md).
#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "brink/core/base/random.h"
#include "brink/scenes/bench/classic.h"
#include "brink/scenes/bench/classic_worlds.h"
#include "brink/scenes/bench/csv.h"
#include "brink/scenes/bench/problems.h"
#include "brink/scenes/program/terminal.h"

namespace brink::bench {
namespace {

// Falls differ in where the pixels and the step's grid happen to lie: a single one would show that alone.
constexpr int kFalls = 16;
constexpr double kBeyondFirst = 0.62;  // [s]: beyond the latest first contact
constexpr double kFine = 1.0 / 256;    // side of pixels where something else is varied [m]
constexpr std::uint64_t kSeedOfOrders = 3;

/// Least-squares slope of log error against log of the varied quantity.
/// @pre more than one x, all errors > 0.
double fitted_order(const std::vector<double>& x, const std::vector<double>& error) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double lx = std::log(x[k]), ly = std::log(error[k]);
    sx += lx, sy += ly, sxx += lx * lx, sxy += lx * ly;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// Root mean square error [s] of the first contact's time of discs of radius 1/2 that fall onto a block from
/// heights drawn at random; one that never came is late by what was left of the run.
double fall_error(SolverOptions options, const Sampling& sampling) {
  // The first contact ends the run: what comes after it is not judged.
  options.max_collisions = 1;
  // The same falls for every setting: the errors differ by the setting alone.
  Random random(kSeedOfOrders);
  double sum = 0.0;
  for (int k = 0; k < kFalls; ++k) {
    const double height = random.uniform(0.8, 1.2), angle = random.uniform(0.0, 6.0);
    World world;
    world.gravity = {0.0, -kGravity};
    world.bodies.push_back(sampled_body(make_disc(0.5), {{0.0, 0.5 + height}, angle}, Twist(), 0.1));
    world.bodies[0].sampling = sampling;
    add_fixed(world, make_box(2.0, 0.5), {{0.0, -0.25}, 0.0});
    const std::vector<double> hits = hits_of(world, options, kBeyondFirst);
    // A drop from rest through `height` to first contact.
    const double off = (hits.empty() ? kBeyondFirst : hits[0]) - std::sqrt(2.0 * height / kGravity);
    sum += off * off;
  }
  return std::sqrt(sum / kFalls);
}

/// fall_error() of the classic detector with a pixel [m], a step [s] and an integrator.
double error_with(const char* policy, double step, double pixel, const char* integrator = "auto",
                  const Sampling& sampling = {}) {
  SolverOptions options = backing_up("depth", step);
  options.policy = policy;
  options.integrator = integrator;
  // A disc of radius 1/2 is 1 m across: so many pixels of that side.
  options.field.resolution = static_cast<int>(std::lround(1.0 / pixel));
  return fall_error(options, sampling);
}

/// The same over the spacing of particles [m], at the finest pixel, backing up.
double error_at_spacing(double spacing) {
  Sampling boundary;
  boundary.kind = Sampling::Kind::boundary;
  boundary.spacing = spacing;
  return error_with("global_backup", 0.01, kFine, "auto", boundary);
}

/// Measures, prints and writes one row: an error for each x, and the order fitted to them.
void add_order(Csv& csv, const char* what, const char* unit, const std::vector<double>& x,
               const std::function<double(double)>& error_at) {
  std::vector<double> errors;
  for (const double value : x) errors.push_back(error_at(value));
  const double order = fitted_order(x, errors);
  fmt::print("  {:<52}", what);
  for (const double e : errors) fmt::print(" {:>8.1e}", e);
  fmt::print("   order {:.2f}\n", order);
  std::fflush(stdout);
  for (std::size_t k = 0; k < x.size(); ++k)
    csv.row("\"{}\",{},{:g},{:.6g},{:.3f}", what, unit, x[k], errors[k], order);
}

}  // namespace

void measure_orders(const std::filesystem::path& folder) {
  fmt::print("{}  root mean square error of the first contact's time [s], {} discs falling about 1 m\n",
             paint(stdout, Paint::heading, "orders"), kFalls);
  Csv csv(folder / "classic_orders.csv", "what,unit,value,error,order");
  add_order(csv, "pixel 1/32 .. 1/256 m", "m", {1.0 / 32, 1.0 / 64, 1.0 / 128, 1.0 / 256},
            [](double pixel) { return error_with("global_backup", 0.01, pixel); });
  // whole parts of a quarter of the boundary, pi / 4 m, which the arcs are cut into
  add_order(csv, "spacing 0.79 .. 0.26 m of the disc's boundary", "m", {0.786, 0.393, 0.262},
            error_at_spacing);
  const std::vector<double> steps{0.04, 0.02, 0.01, 0.005};
  add_order(csv, "step 40 .. 5 ms, fixed_step", "s", steps,
            [](double step) { return error_with("fixed_step", step, kFine); });
  // Backing up finds the time of the contact within a step to step / 2^16: what is left of the step's error
  // is the integrator's.
  for (const char* integrator : {"euler", "semi_implicit_euler", "rk4", "erk"})
    add_order(csv, fmt::format("step 40 .. 5 ms, backing up, {}", integrator).c_str(), "s", steps,
              [&](double step) { return error_with("global_backup", step, kFine, integrator); });
  csv.close();
  fmt::print("table {}\n\n", (folder / "classic_orders.csv").string());
}

}  // namespace brink::bench
