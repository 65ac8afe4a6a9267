// Collisions a second of the event engine: hard discs at packing 0.5 in a box, boxes and stars at 0.4, beside
// a minimal loop that can do nothing but equal discs (single_purpose.h). Same initial state, same number of
// collisions.
#include <benchmark/benchmark.h>

#include <malloc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>

#include "tests/bench/single_purpose.h"
#include "tests/support/gases.h"

namespace brink {
namespace {

/// Bytes that are allocated now.
double heap() { return static_cast<double>(mallinfo2().uordblks) + static_cast<double>(mallinfo2().hblkhd); }

SolverOptions options_of(const char* policy, std::uint64_t collisions) {
  SolverOptions options;
  options.policy = policy;
  options.max_collisions = collisions;
  return options;
}

/// Begins where so many collisions have made it forget its lattice.
World later(World world, const SolverOptions& options) {
  Simulator warm(world, options);
  warm.run(testing::until(1e9));
  for (std::size_t k = 0; k < world.bodies.size(); ++k)
    world.bodies[k].initial = warm.state(static_cast<int>(k));
  return world;
}

/// Rate over `collisions`, after as many again to forget the lattice.
void run_for(benchmark::State& state, const World& world, const char* policy, std::uint64_t collisions) {
  for (auto _ : state) {
    state.PauseTiming();
    const SolverOptions options = options_of(policy, collisions);
    const World begin = later(world, options);
    const double held = heap();
    Simulator simulator(begin, options);
    state.ResumeTiming();
    const RunSummary summary = simulator.run(testing::until(1e9));
    state.PauseTiming();
    state.counters["bytes_a_body"] = (heap() - held) / static_cast<double>(world.bodies.size());
    if (summary.collisions != collisions) state.SkipWithError(summary.why.c_str());
    state.counters["drift"] = std::abs(summary.energy_final / summary.energy_initial - 1.0);
    state.counters["overlap"] = summary.max_overlap;
    state.counters["searches"] =
        static_cast<double>(summary.work.pair_searches) / static_cast<double>(collisions);
    state.counters["iterations"] =
        static_cast<double>(summary.work.search_iterations) / static_cast<double>(collisions);
    state.counters["evaluations"] =
        static_cast<double>(summary.work.candidate_evaluations) / static_cast<double>(collisions);
    state.counters["passes"] = static_cast<double>(summary.work.passes) / static_cast<double>(collisions);
    state.counters["served"] =
        static_cast<double>(summary.work.queue_operations) / static_cast<double>(collisions);
    state.ResumeTiming();
  }
  state.counters["rate"] = benchmark::Counter(
      static_cast<double>(collisions) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

std::uint64_t collisions_for(int n) { return static_cast<std::uint64_t>(std::min(20 * n, 4000000) + 200000); }

void discs(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  run_for(state, testing::boxed(testing::lattice_gas(n, make_disc(0.5), 0.5)), "body_clocks",
          collisions_for(n));
}
BENCHMARK(discs)->Arg(100)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond)->Iterations(1);

/// Bodies that are neighbours in memory are none in the plane: what numbering them by place could win at most.
void discs_in_no_order(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  World world = testing::boxed(testing::lattice_gas(n, make_disc(0.5), 0.5));
  Random random(5);
  for (std::size_t k = world.bodies.size() - 1; k > 0; --k)
    std::swap(world.bodies[k], world.bodies[random.below(k + 1)]);
  run_for(state, world, "body_clocks", collisions_for(n));
}
BENCHMARK(discs_in_no_order)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond)->Iterations(1);

/// Where coordinates are so large that all searches see a pair from its own place.
void discs_far_away(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  World world = testing::boxed(testing::lattice_gas(n, make_disc(0.5), 0.5));
  const Vec2 by(2000.0, 1000.0);
  for (Body& b : world.bodies) b.initial.pose.position += by;
  for (FixedSite& s : world.sites) s.pose.position += by;
  run_for(state, world, "body_clocks", collisions_for(n));
}
BENCHMARK(discs_far_away)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond)->Iterations(1);

void discs_periodic(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  run_for(state, testing::lattice_gas(n, make_disc(0.5), 0.5), "body_clocks", collisions_for(n));
}
BENCHMARK(discs_periodic)
    ->Arg(100)
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

void boxes(benchmark::State& state) {
  run_for(state, testing::boxed(testing::lattice_gas(1000, make_box(1.0, 0.6), 0.4, 1.0)), "body_clocks",
          50000);
}
BENCHMARK(boxes)->Unit(benchmark::kMillisecond)->Iterations(1);

void stars(benchmark::State& state) {
  run_for(state, testing::boxed(testing::lattice_gas(200, testing::star(10, 0.5, 0.7), 0.4, 1.0)),
          "body_clocks", 20000);
}
BENCHMARK(stars)->Unit(benchmark::kMillisecond)->Iterations(1);

/// A thousand discs in a box, spinning: none of them, every second or each of them has twelve teeth instead.
World discs_and_gears(int gears_of_two) {
  World world = testing::boxed(testing::lattice_gas(1024, make_disc(0.5), 0.5, 1.0));
  const Body gear = testing::body(testing::gear(12, 0.5, 0.4), {0.0, 0.0}, {0.0, 0.0});
  for (int k = 0; k < static_cast<int>(world.bodies.size()); ++k) {
    if ((k / 32 + k) % 2 >= gears_of_two) continue;
    Body& b = world.bodies[k];
    b.outline = gear.outline;
    b.inertia = gear.inertia;
  }
  return world;
}

/// Counts bodies that take part in collisions, by their kind.
struct TakingPart : Recorder {
  explicit TakingPart(const World& world) : of(world) {}
  void event(const Event& e) override {
    for (const int k : {e.contact.body, e.contact.other_body})
      if (k >= 0) (of.bodies[k].outline->sites.size() == 1 ? discs : gears) += 1.0;
  }
  const World& of;
  double discs = 0.0, gears = 0.0;
};

/// CPU time of a collision [s].
double time_of_a_collision(const World& world, const SolverOptions& options) {
  Simulator simulator(world, options);
  const std::clock_t begin = std::clock();
  simulator.run(testing::until(1e9));
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC /
         static_cast<double>(options.max_collisions);
}

/// Half discs, half gears. `keeps`: the rate, of that if a collision took as long as among discs alone and gears alone, by
/// how many of each take part. The least time of several of each kind, taken in turn.
void discs_and_gears(benchmark::State& state) {
  const SolverOptions options = options_of("body_clocks", 50000);
  const std::array<World, 3> worlds = {later(discs_and_gears(0), options), later(discs_and_gears(1), options),
                                       later(discs_and_gears(2), options)};
  TakingPart part(worlds[1]);
  Simulator(worlds[1], options).run(testing::until(1e9), &part);
  for (auto _ : state) {
    std::array<double, 3> times = {1.0, 1.0, 1.0};
    for (int round = 0; round < 3; ++round)
      for (int k = 0; k < 3; ++k) times[k] = std::min(times[k], time_of_a_collision(worlds[k], options));
    const double sum = (part.discs * times[0] + part.gears * times[2]) / (part.discs + part.gears);
    state.counters["rate"] = 1.0 / times[1];
    state.counters["rate_discs"] = 1.0 / times[0];
    state.counters["rate_gears"] = 1.0 / times[2];
    state.counters["discs_take_part"] = part.discs / (part.discs + part.gears);
    state.counters["keeps"] = sum / times[1];
  }
}
BENCHMARK(discs_and_gears)->Unit(benchmark::kMillisecond)->Iterations(1);

/// A thousand slow discs, and beside them a closed box in which eight are a thousand times as fast.
World two_speeds() {
  World world = testing::boxed(testing::lattice_gas(1024, make_disc(0.5), 0.3));
  for (Body& b : world.bodies) b.initial.twist.velocity *= 1e-3;
  World fast = testing::boxed(testing::lattice_gas(9, make_disc(0.5), 0.3));
  const Vec2 beside(60.0, 0.0);
  for (Body b : fast.bodies) {
    b.name.clear();
    b.initial.pose.position += beside;
    testing::add(world, std::move(b));
  }
  for (FixedSite s : fast.sites) {
    s.name.clear();
    s.pose.position = beside;
    testing::add(world, std::move(s));
  }
  return world;
}

void two_speeds(benchmark::State& state) {
  run_for(state, two_speeds(), state.range(0) ? "global_backup" : "body_clocks", 4000);
}
BENCHMARK(two_speeds)->ArgName("global_backup")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->Iterations(1);

/// The same on springs, each body on its own: nobody's motion is closed.
World two_speeds_on_springs() {
  World world = two_speeds();
  for (int k = 0; k < static_cast<int>(world.bodies.size()); ++k) {
    SpringForce spring;
    spring.body_a = k;
    spring.at_b = world.bodies[k].initial.pose.position;
    const bool slow = k < 1024;
    spring.stiffness = slow ? 1e-6 : 1.0;
    world.forces.emplace_back(spring);
  }
  return world;
}

void two_speeds_on_springs(benchmark::State& state) {
  // the first look at everybody counts too: as many collisions as make that little
  const bool all = state.range(0) != 0;
  run_for(state, two_speeds_on_springs(), all ? "global_backup" : "body_clocks", all ? 400 : 10000);
}
BENCHMARK(two_speeds_on_springs)
    ->ArgName("global_backup")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

void discs_single_purpose(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const World world = testing::boxed(testing::lattice_gas(n, make_disc(0.5), 0.5));
  const std::uint64_t collisions = collisions_for(n);
  for (auto _ : state) {
    state.PauseTiming();
    bench::SinglePurposeDiscs discs(0.5, world.sites[0].outline->sites[0].b.x());
    for (const Body& b : world.bodies)
      discs.add(b.initial.pose.position.x(), b.initial.pose.position.y(), b.initial.twist.velocity.x(),
                b.initial.twist.velocity.y());
    const double energy = discs.energy();
    discs.run(collisions);
    state.ResumeTiming();
    discs.run(2 * collisions);
    state.counters["drift"] = std::abs(discs.energy() / energy - 1.0);
  }
  state.counters["rate"] = benchmark::Counter(
      static_cast<double>(collisions) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(discs_single_purpose)
    ->Arg(100)
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

}  // namespace
}  // namespace brink
