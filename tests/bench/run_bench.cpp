// Whole runs without recording. Counters: `error` or `drift` against what is known, `collisions`, rates of
// them, and the low 32 bits of the state hash. A run whose bits differ from the first one's, or that is
// wrong, ends its benchmark with an error, so a fast wrong answer fails.
#include <benchmark/benchmark.h>

#include <cmath>

#include "brink/core/base/random.h"
#include "tests/support/worlds.h"

namespace brink {
namespace {

World bouncing_ball() {
  World world;
  world.gravity = {0.0, -9.81};
  world.materials[0].restitution = 0.9;
  testing::add(world, testing::body(make_disc(0.5), {0.0, 1.5}, {0.0, 0.0}));
  testing::add(world, testing::site(make_segment({-10.0, 0.0}, {10.0, 0.0})));
  return world;
}

/// A square of bodies on a grid in a box, random speeds; about half of the plane is taken.
World gas(int count, const Shape& shape, double pitch, double spin) {
  World world;
  Random random(9);
  const int side = static_cast<int>(std::ceil(std::sqrt(count)));
  const double half = 0.5 * pitch * side;
  for (int k = 0; k < count; ++k) {
    const Vec2 at(pitch * (k % side + 0.5) - half, pitch * (k / side + 0.5) - half);
    const Vec2 v(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    testing::add(world, testing::body(shape, at, v, 1.0, 0.0, random.uniform(-spin, spin)));
  }
  const Vec2 corners[] = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  for (int k = 0; k < 4; ++k)
    testing::add(world, testing::site(make_segment(corners[k], corners[(k + 1) % 4])));
  return world;
}
World discs() { return gas(200, make_disc(0.5), 1.25, 0.0); }
World boxes() { return gas(100, make_box(0.8, 0.6), 1.1, 2.0); }

void put_hash(benchmark::State& state, std::uint64_t hash) {
  state.counters["hash"] = static_cast<double>(hash & 0xffffffffU);
}

/// The 44th impact's time is known: t1 (1 + 2 (e + ... + e^43)).
bool right(World world) {
  Simulator simulator(std::move(world), {});
  testing::Events events;
  simulator.run(testing::until(8.5), &events);
  const auto hits = events.collisions();
  return hits.size() == 44 && std::abs(hits.back().contact.time - 8.491374025648) < 5e-12;
}

/// 44 impacts; with or without building the simulator.
void ball_of_44_impacts(benchmark::State& state, bool with_construction) {
  const World world = bouncing_ball();
  if (!right(world)) return state.SkipWithError("impacts are not where they belong");
  std::uint64_t first = 0, collisions = 0;
  for (auto _ : state) {
    if (!with_construction) state.PauseTiming();
    Simulator simulator(world, {});
    if (!with_construction) state.ResumeTiming();
    const RunSummary summary = simulator.run(testing::until(8.5));
    if (first == 0) first = summary.state_hash;
    if (summary.state_hash != first) return state.SkipWithError("two runs differ in their bits");
    collisions = summary.collisions;
  }
  state.counters["collisions"] = static_cast<double>(collisions);
  put_hash(state, first);
}
BENCHMARK_CAPTURE(ball_of_44_impacts, run_alone, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ball_of_44_impacts, with_construction, true)->Unit(benchmark::kMicrosecond);

void elastic_gas(benchmark::State& state, World (*make)(), double until) {
  const World world = make();
  std::uint64_t first = 0, collisions = 0;
  double drift = 0.0;
  for (auto _ : state) {
    Simulator simulator(world, {});
    const RunSummary summary = simulator.run(testing::until(until));
    if (summary.termination != Termination::reached_end) return state.SkipWithError(summary.why.c_str());
    if (first == 0) first = summary.state_hash;
    if (summary.state_hash != first) return state.SkipWithError("two runs differ in their bits");
    collisions += summary.collisions;
    drift = std::abs(summary.energy_final / summary.energy_initial - 1.0);
    if (drift > 1e-12 || summary.max_overlap > 1e-12)
      return state.SkipWithError("energy drifts or bodies overlap");
  }
  state.counters["collisions"] = static_cast<double>(collisions) / static_cast<double>(state.iterations());
  state.counters["rate"] = benchmark::Counter(static_cast<double>(collisions), benchmark::Counter::kIsRate);
  state.counters["drift"] = drift;
  put_hash(state, first);
}
BENCHMARK_CAPTURE(elastic_gas, discs_200, discs, 5.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(elastic_gas, boxes_100, boxes, 3.0)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace brink
