// brink bench classic: missed contacts, orders of convergence, and what each option saves.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "brink/core/base/error.h"
#include "brink/core/base/random.h"
#include "brink/core/shapes/shapes.h"
#include "brink/scenes/program/bench_classic.h"
#include "brink/scenes/program/bench_run.h"
#include "brink/scenes/program/terminal.h"

namespace brink::bench {
namespace {

/// A CSV file, written line by line.
class Table {
 public:
  Table(std::filesystem::path file, const std::string& head) : file_(std::move(file)), out_(file_) {
    out_ << head << '\n';
  }
  template <class... Values>
  void row(fmt::format_string<Values...> format, Values&&... values) {
    out_ << fmt::format(format, std::forward<Values>(values)...) << '\n';
  }
  void close() {
    out_.close();
    if (!out_) throw IoError(fmt::format("{}: could not be written", file_.string()));
    fmt::print("table {}\n\n", file_.string());
  }

 private:
  std::filesystem::path file_;
  std::ofstream out_;
};

Body body_of(const Shape& shape, const Vec2& position, const Vec2& velocity, double spacing) {
  Body body;
  body.outline = std::make_shared<const Outline>(shape.outline);
  body.inertia = body.mass * shape.measure.second_moment / shape.measure.size;
  body.initial = {{position, 0.0}, {velocity, 0.0}};
  body.sampling.kind = Sampling::Kind::boundary;
  body.sampling.spacing = spacing;
  return body;
}

SolverOptions options_of(const char* detector) {
  SolverOptions options;
  options.policy = "global_backup";
  options.detector = detector;
  return options;
}

class Hit : public Recorder {
 public:
  void frame(double, std::span<const BodyState>) override {}
  void event(const Event& e) override {
    if (e.kind != EventKind::collision) return;
    bodies.insert(e.contact.body);
    times.push_back(e.contact.time);
  }
  void checkpoint(double, const std::vector<std::byte>&) override {}
  std::set<int> bodies;
  std::vector<double> times;
};

Hit run_to(const World& world, const SolverOptions& options, double until, RunSummary* summary = nullptr) {
  Simulator simulator(world, options);
  Hit hit;
  RunOptions run;
  run.until = until;
  run.checkpoint_seconds = -1.0;
  const RunSummary s = simulator.run(run, &hit);
  if (summary) *summary = s;
  return hit;
}

constexpr int kFalls = 60;
constexpr double kReach = 0.2;  // [m] beyond first contact, in boxes of side 1

/// Boxes of side 1 move down onto upright wedges, each off its middle by an offset of its own, until they
/// would be kReach deep.
World boxes_on_wedges(double spacing, double degrees, std::uint64_t seed) {
  const double half = 0.6 * std::tan(0.5 * degrees * std::numbers::pi / 180.0);
  const auto wedge =
      std::make_shared<const Outline>(make_polygon({{-half, -0.6}, {half, -0.6}, {0.0, 0.0}}).outline);
  Random random(seed);
  World world;
  for (int k = 0; k < kFalls; ++k) {
    const Vec2 tip(4.0 * k, 0.0);
    world.bodies.push_back(
        body_of(make_box(1, 1), tip + Vec2(random.uniform(-0.2, 0.2), 0.6), {0.0, -1.0}, spacing));
    world.bodies.back().name = fmt::format("box{}", k);
    FixedSite site;
    site.name = fmt::format("wedge{}", k);
    site.kind = "polygon";
    site.outline = wedge;
    site.pose.position = tip;
    world.sites.push_back(site);
  }
  return world;
}

double missed_share(double spacing, double degrees, const char* detector) {
  SolverOptions options = options_of(detector);
  options.step = 0.01;
  const World world = boxes_on_wedges(spacing, degrees, 1);
  const Hit hit = run_to(world, options, 0.1 + kReach);
  return 1.0 - static_cast<double>(hit.bodies.size()) / kFalls;
}

/// Least-squares slope of log error against log of the varied quantity.
double fitted_order(const std::vector<double>& x, const std::vector<double>& error) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double lx = std::log(x[k]), ly = std::log(error[k]);
    sx += lx, sy += ly, sxx += lx * lx, sxy += lx * ly;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// Root mean square over falls from heights drawn at random of the error of the first contact's time, for
/// discs of radius 1/2 onto a floor.
double fall_error(SolverOptions options, const Sampling& sampling) {
  Random random(3);
  double sum = 0.0;
  constexpr int falls = 24;
  World world;
  world.gravity = {0.0, -9.81};
  std::vector<double> truth;
  for (int k = 0; k < falls; ++k) {
    const double height = random.uniform(0.8, 1.2);
    Body body = body_of(make_disc(0.5), {3.0 * k, 0.5 + height}, {0.0, 0.0}, 0.1);
    body.name = fmt::format("disc{}", k);
    body.initial.pose.angle = random.uniform(0.0, 6.0);
    body.sampling = sampling;
    world.bodies.push_back(body);
    truth.push_back(std::sqrt(2.0 * height / 9.81));
  }
  FixedSite floor;
  floor.name = "floor";
  floor.kind = "segment";
  floor.outline = std::make_shared<const Outline>(make_segment({-5.0, 0.0}, {80.0, 0.0}).outline);
  world.sites.push_back(floor);
  class First : public Recorder {
   public:
    void frame(double, std::span<const BodyState>) override {}
    void event(const Event& e) override { times.try_emplace(e.contact.body, e.contact.time); }
    void checkpoint(double, const std::vector<std::byte>&) override {}
    std::map<int, double> times;
  } first;
  Simulator simulator(world, options);
  RunOptions run;
  run.until = 0.62;
  run.checkpoint_seconds = -1.0;
  simulator.run(run, &first);
  for (int k = 0; k < falls; ++k) {
    const double off = first.times.contains(k) ? first.times[k] - truth[k] : run.until - truth[k];
    sum += off * off;
  }
  return std::sqrt(sum / falls);
}

void add_order(Table& table, const std::string& what, const char* unit, const std::vector<double>& x,
               const std::function<double(double)>& error_at) {
  std::vector<double> errors;
  for (const double value : x) errors.push_back(error_at(value));
  const double order = fitted_order(x, errors);
  fmt::print("  {:<58}", what);
  for (const double e : errors) fmt::print(" {:>8.1e}", e);
  fmt::print("   order {:.2f}\n", order);
  std::fflush(stdout);
  for (std::size_t k = 0; k < x.size(); ++k)
    table.row("\"{}\",{},{:g},{:.6g},{:.3f}", what, unit, x[k], errors[k], order);
}

/// Polygons of all kinds in a frame, for the time of options.
World crowd() {
  Random random(5);
  World world;
  const Shape shapes[] = {make_box(0.5, 0.3), make_disc(0.2), make_capsule(0.4, 0.1),
                          make_polygon({{0, 0}, {0.5, 0}, {0.5, 0.2}, {0.2, 0.2}, {0.2, 0.5}, {0, 0.5}})};
  for (int k = 0; k < 36; ++k) {
    const Vec2 at(k % 6 * 0.95 - 2.4, std::floor(k / 6.0) * 0.95 - 2.4);
    Body body = body_of(centered(shapes[k % 4]), at, {random.uniform(-1, 1), random.uniform(-1, 1)}, 0.05);
    body.name = fmt::format("body{}", k);
    body.initial.pose.angle = random.uniform(0.0, 6.0);
    body.initial.twist.omega = random.uniform(-2.0, 2.0);
    world.bodies.push_back(body);
  }
  FixedSite frame;
  frame.name = "frame";
  frame.kind = "chain";
  frame.outline =
      std::make_shared<const Outline>(make_chain({{-3, -3}, {3, -3}, {3, 3}, {-3, 3}}, true).outline);
  world.sites.push_back(frame);
  return world;
}

}  // namespace

void measure_missed(const std::filesystem::path& folder) {
  fmt::print("{}  share of {} boxes (side 1 m) not stopped within {:g} m of a wedge's tip\n",
             paint(stdout, Paint::heading, "missed contacts"), kFalls, kReach);
  Table table(folder / "classic_missed.csv", "detector,spacing,wedge_degrees,missed,expected");
  for (const double degrees : {10.0, 30.0, 60.0, 90.0, 120.0}) {
    fmt::print("  wedge {:>3} deg:", degrees);
    for (const double spacing : {0.5, 0.25, 0.125, 0.0625, 0.03125}) {
      const double missed = missed_share(spacing, degrees, "depth");
      // a particle at distance u from the tip meets the flank u / tan(half angle) beyond the first contact
      const double slope = std::tan(0.5 * degrees * std::numbers::pi / 180.0);
      const double expected = std::max(0.0, 1.0 - 2.0 * kReach * slope / spacing);
      fmt::print("  1/{:<2g} m {:>3.0f} %", 1.0 / spacing, 100.0 * missed);
      table.row("depth,{:g},{:g},{:.4f},{:.4f}", spacing, degrees, missed, expected);
    }
    for (const char* detector : {"pass", "field"}) {
      const double missed = missed_share(0.5, degrees, detector);
      fmt::print("  {} {:.0f} %", detector, 100.0 * missed);
      table.row("{},,{:g},{:.4f},0", detector, degrees, missed);
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
  table.close();
}

void measure_orders(const std::filesystem::path& folder) {
  fmt::print("{}  root mean square error of the first contact's time [s], 24 discs falling about 1 m\n",
             paint(stdout, Paint::heading, "orders"));
  Table table(folder / "classic_orders.csv", "what,unit,value,error,order");
  const Sampling centre;
  const auto with = [](const char* policy, double step, int resolution) {
    SolverOptions options = options_of("depth");
    options.policy = policy;
    options.step = step;
    options.field.resolution = resolution;
    return options;
  };
  add_order(table, "pixel (resolution 32 .. 512), global_backup", "m",
            {1.0 / 32, 1.0 / 64, 1.0 / 128, 1.0 / 256, 1.0 / 512}, [&](double pixel) {
              return fall_error(with("global_backup", 0.01, static_cast<int>(std::lround(1.0 / pixel))),
                                centre);
            });
  add_order(table, "step (fixed_step, resolution 1024)", "s", {0.04, 0.02, 0.01, 0.005},
            [&](double step) { return fall_error(with("fixed_step", step, 1024), centre); });
  add_order(table, "step (global_backup, resolution 512)", "s", {0.04, 0.02, 0.01, 0.005},
            [&](double step) { return fall_error(with("global_backup", step, 512), centre); });
  for (const char* integrator : {"euler", "semi_implicit_euler"})
    add_order(table, fmt::format("step of {} (global_backup, resolution 1024)", integrator), "s",
              {0.04, 0.02, 0.01}, [&](double step) {
                SolverOptions options = with("global_backup", step, 1024);
                options.integrator = integrator;
                return fall_error(options, centre);
              });
  add_order(table, "spacing on the disc's boundary (resolution 1024)", "m", {0.8, 0.4, 0.2},
            [&](double spacing) {
              Sampling boundary;
              boundary.kind = Sampling::Kind::boundary;
              boundary.spacing = spacing;
              return fall_error(with("global_backup", 0.01, 1024), boundary);
            });
  table.close();
}

void measure_options(const std::filesystem::path& folder) {
  fmt::print("{}  36 bodies in a frame, 0.2 s, steps of 2 ms; each option alone, then all\n",
             paint(stdout, Paint::heading, "options"));
  SolverOptions none = options_of("depth");
  none.step = 0.002;
  none.skip_broad_phase = false;
  none.field.truncated = false;
  none.field.readback = "full";
  struct Choice {
    const char* name;
    std::function<void(SolverOptions&)> set;
  };
  const std::vector<Choice> choices = {
      {"none: full read-back, whole diagram, a pass for each body", [](SolverOptions&) {}},
      {"read-back of the window", [](SolverOptions& o) { o.field.readback = "window"; }},
      {"read-back of single pixels", [](SolverOptions& o) { o.field.readback = "pixel"; }},
      {"bounding circles", [](SolverOptions& o) { o.skip_broad_phase = true; }},
      {"truncated diagram", [](SolverOptions& o) { o.field.truncated = true; }},
      {"two layers for all bodies", [](SolverOptions& o) { o.field.passes = "two_layers"; }},
      {"mesh primitives", [](SolverOptions& o) { o.field.primitives = "mesh"; }},
      {"window, bounding circles, truncated",
       [](SolverOptions& o) {
         o.field.readback = "window";
         o.skip_broad_phase = o.field.truncated = true;
       }},
      {"the same with two layers", [](SolverOptions& o) {
         o.field.readback = "window";
         o.skip_broad_phase = o.field.truncated = true;
         o.field.passes = "two_layers";
       }}};
  Table table(folder / "classic_options.csv",
              "option,wall_seconds,of_none,collisions,pixels_drawn,pixels_read,state_hash");
  const World world = crowd();
  double base = 0.0;
  for (const Choice& choice : choices) {
    SolverOptions options = none;
    choice.set(options);
    RunSummary summary;
    run_to(world, options, 0.2, &summary);
    if (base == 0.0) base = summary.wall_seconds;
    fmt::print("  {:<60} {:>9.1f} ms  {:>6.3f} of none  {:>4} collisions  {:016x}\n", choice.name,
               1e3 * summary.wall_seconds, summary.wall_seconds / base, summary.collisions,
               summary.state_hash);
    std::fflush(stdout);
    table.row("\"{}\",{:.6g},{:.4f},{},{},{},{:016x}", choice.name, summary.wall_seconds,
              summary.wall_seconds / base, summary.collisions, summary.work.pixels_drawn,
              summary.work.pixels_read, summary.state_hash);
  }
  table.close();
}

}  // namespace brink::bench
