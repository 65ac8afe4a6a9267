// What a second thread gives one run: discs, boxes, stars, and discs that springs join two and two. Wall-clock time of the
// same collisions with one thread and with two, in turn; of each part of them the least of several (BRINK_ROUNDS, 5). A run
// whose bits differ from the first one's ends its benchmark with an error.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <thread>
#include <vector>

#include "tests/support/gases.h"

namespace brink {
namespace {

using testing::boxed;
using testing::lattice_gas;

/// Discs in a box, two and two in a row on a spring: `auto` drives them by erk.
World pairs_on_springs(int n) {
  const double packing = 0.3, pitch = std::sqrt(make_disc(0.5).measure.size / packing);
  World world = boxed(lattice_gas(n, make_disc(0.5), packing));
  const int side = static_cast<int>(std::ceil(std::sqrt(n)));
  for (int k = 0; k + 1 < n; k += 2) {
    if (k % side + 1 == side) continue;
    SpringForce spring;
    spring.body_a = k;
    spring.body_b = k + 1;
    spring.stiffness = 1.0;
    spring.rest_length = pitch;
    world.forces.emplace_back(spring);
  }
  return world;
}

/// Begins where so many collisions have made it forget its lattice.
World later(World world, std::uint64_t collisions) {
  SolverOptions options;
  options.max_collisions = collisions;
  Simulator warm(world, options);
  warm.run(testing::until(1e9));
  for (std::size_t k = 0; k < world.bodies.size(); ++k)
    world.bodies[k].initial = warm.state(static_cast<int>(k));
  return world;
}

/// Seconds of each part of so many collisions. Between parts it sleeps a little: others who use the machine have their turn
/// then, and not so often in the midst of a part.
struct Timed {
  std::vector<double> seconds;
  std::uint64_t hash = 0;
};
Timed timed(const World& world, const SolverOptions& solver, std::uint64_t part, int threads) {
  using Clock = std::chrono::steady_clock;
  Timed result;
  Simulator simulator(world, solver);
  RunOptions options = testing::until(1e9);
  options.threads = threads;
  Clock::time_point begin = Clock::now();
  const auto end_part = [&] {
    result.seconds.push_back(std::chrono::duration<double>(Clock::now() - begin).count());
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    begin = Clock::now();
  };
  options.progress = [&](double, std::uint64_t collisions) {
    if (collisions >= part * (result.seconds.size() + 1)) end_part();
    return true;
  };
  result.hash = simulator.run(options).state_hash;
  result.seconds.resize(solver.max_collisions / part - 1);  // the last ends with a frame
  return result;
}

void compare(benchmark::State& state, const World& begin, std::uint64_t collisions) {
  const char* const asked = std::getenv("BRINK_ROUNDS");
  const int rounds = asked ? std::atoi(asked) : 5;
  SolverOptions solver;
  solver.max_collisions = collisions;
  const World world = later(begin, collisions);
  const std::uint64_t part = collisions / 100;
  for (auto _ : state) {
    std::array<Timed, 2> least;
    for (int round = 0; round < rounds; ++round)
      for (int more = 0; more < 2; ++more) {
        const Timed t = timed(world, solver, part, 1 + more);
        if (round == 0) least[more] = t;
        if (t.hash != least[0].hash) state.SkipWithError("the bits differ");
        for (std::size_t k = 0; k < t.seconds.size(); ++k)
          least[more].seconds[k] = std::min(least[more].seconds[k], t.seconds[k]);
      }
    // the first part looks at everybody
    const auto sum = [](const Timed& t) {
      return std::accumulate(t.seconds.begin() + 1, t.seconds.end(), 0.0);
    };
    const double counted = static_cast<double>(part * (least[0].seconds.size() - 1));
    state.counters["us_1"] = 1e6 * sum(least[0]) / counted;
    state.counters["us_2"] = 1e6 * sum(least[1]) / counted;
    state.counters["ratio"] = sum(least[0]) / sum(least[1]);
    state.counters["first_ratio"] = least[0].seconds[0] / least[1].seconds[0];
  }
}

void discs(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  compare(state, boxed(lattice_gas(n, make_disc(0.5), 0.5)), 20 * n);
}
void boxes(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  compare(state, boxed(lattice_gas(n, make_box(1.0, 0.6), 0.4, 1.0)), 2 * n);
}
void stars(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  compare(state, boxed(lattice_gas(n, testing::star(10, 0.5, 0.7), 0.4, 1.0)), 2 * n);
}
void springs(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  compare(state, pairs_on_springs(n), n / 5);
}
BENCHMARK(discs)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(boxes)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(stars)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(springs)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace brink
