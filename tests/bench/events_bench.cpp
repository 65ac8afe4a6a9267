// Collisions a second of the event engine: hard discs at packing 0.5 in a box, boxes and stars at 0.4, beside a
// minimal loop that can do nothing but equal discs (single_purpose.h). Same initial state, same number of collisions.
#include <benchmark/benchmark.h>

#include <cmath>

#include "brink/core/base/random.h"
#include "tests/bench/single_purpose.h"
#include "tests/support/worlds.h"

namespace brink {
namespace {

double gaussian(Random& r) {
  return std::sqrt(-2.0 * std::log(1.0 - r.uniform())) * std::cos(2.0 * M_PI * r.uniform());
}

/// `count` equal bodies on a square lattice in a box, so that they fill `packing` of it; Maxwellian velocities.
World gas(int count, const Shape& shape, double packing, double spin) {
  World world;
  Random random(9);
  const int side = static_cast<int>(std::ceil(std::sqrt(count)));
  const double pitch = std::sqrt(shape.measure.size / packing), half = 0.5 * pitch * side;
  const Body like = testing::body(shape, {0.0, 0.0}, {0.0, 0.0});
  for (int k = 0; k < count; ++k) {
    Body b = like;
    b.initial.pose.position = {pitch * (k % side + 0.5) - half, pitch * (k / side + 0.5) - half};
    b.initial.twist = {{gaussian(random), gaussian(random)}, spin * gaussian(random)};
    testing::add(world, std::move(b));
  }
  const Vec2 corners[] = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  for (int k = 0; k < 4; ++k)
    testing::add(world, testing::site(make_segment(corners[k], corners[(k + 1) % 4])));
  return world;
}

/// Rate over `collisions`, after as many again to forget the lattice.
void run_for(benchmark::State& state, const World& world, const char* policy, std::uint64_t collisions) {
  for (auto _ : state) {
    state.PauseTiming();
    SolverOptions options;
    options.policy = policy;
    options.max_collisions = collisions;
    Simulator warm(world, options);
    warm.run(testing::until(1e9));
    World later = world;
    for (std::size_t k = 0; k < later.bodies.size(); ++k) later.bodies[k].initial = warm.state(static_cast<int>(k));
    Simulator simulator(later, options);
    state.ResumeTiming();
    const RunSummary summary = simulator.run(testing::until(1e9));
    state.PauseTiming();
    if (summary.collisions != collisions) state.SkipWithError(summary.why.c_str());
    state.counters["drift"] = std::abs(summary.energy_final / summary.energy_initial - 1.0);
    state.counters["overlap"] = summary.max_overlap;
    state.counters["searches"] = static_cast<double>(summary.work.pair_searches) / static_cast<double>(collisions);
    state.counters["passes"] = static_cast<double>(summary.work.passes) / static_cast<double>(collisions);
    state.counters["served"] = static_cast<double>(summary.work.queue_operations) / static_cast<double>(collisions);
    state.ResumeTiming();
  }
  state.counters["rate"] = benchmark::Counter(static_cast<double>(collisions) * static_cast<double>(state.iterations()),
                                              benchmark::Counter::kIsRate);
}

void discs(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  run_for(state, gas(n, make_disc(0.5), 0.5, 0.0), "body_clocks", static_cast<std::uint64_t>(20 * n + 200000));
}
BENCHMARK(discs)->Arg(100)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond)->Iterations(1);


void discs_single_purpose(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const World world = gas(n, make_disc(0.5), 0.5, 0.0);
  const auto collisions = static_cast<std::uint64_t>(20 * n + 200000);
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
  state.counters["rate"] = benchmark::Counter(static_cast<double>(collisions) * static_cast<double>(state.iterations()),
                                              benchmark::Counter::kIsRate);
}
BENCHMARK(discs_single_purpose)
    ->Arg(100)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace brink
