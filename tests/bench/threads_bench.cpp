// What a second thread gives one run: discs, boxes, stars, and discs that springs join two and two. Wall-clock time of the
// same collisions with one thread and with two, in turn; of each part of them the least of several (BRINK_ROUNDS, 5). Where
// others use the machine, `ratio_undisturbed` is of those parts alone in which both threads had their processors, 0 and 1.
// A run whose bits differ from the first one's ends its benchmark with an error.
#include <benchmark/benchmark.h>

#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
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

/// A moment by three clocks [s].
struct Clocks {
  double wall = 0.0;
  double own = 0.0;  ///< CPU time of this thread
  double all = 0.0;  ///< CPU time of the program

  static Clocks now() {
    return {read(CLOCK_MONOTONIC), read(CLOCK_THREAD_CPUTIME_ID), read(CLOCK_PROCESS_CPUTIME_ID)};
  }
  Clocks since(const Clocks& begin) const { return {wall - begin.wall, own - begin.own, all - begin.all}; }
  /// True if nobody else had the processor of this thread, nor, where somebody helps, of the helper.
  bool undisturbed(bool helped) const { return own > 0.97 * wall && (!helped || all - own > 0.8 * wall); }

 private:
  static double read(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
};

/// The thread runs there, and those that it begins.
void stay_on(int processor) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(processor, &set);
  pthread_setaffinity_np(pthread_self(), sizeof set, &set);
}

/// Of each part of so many collisions. Between parts it sleeps a little: others who use the machine have their turn then,
/// and not so often in the midst of a part.
struct Timed {
  std::vector<Clocks> parts;
  std::uint64_t hash = 0;
};
Timed timed(const World& world, const SolverOptions& solver, std::uint64_t part, int threads) {
  Timed result;
  Simulator simulator(world, solver);
  RunOptions options = testing::until(1e9);
  options.threads = threads;
  static const bool rests = std::getenv("BRINK_RESTS") != nullptr;
  if (rests) stay_on(1);
  Clocks begin = Clocks::now();
  options.progress = [&](double, std::uint64_t collisions) {
    if (collisions < part * (result.parts.size() + 1)) return true;
    result.parts.push_back(Clocks::now().since(begin));
    if (rests) {
      stay_on(0);
      std::this_thread::sleep_for(std::chrono::milliseconds(3));
    }
    begin = Clocks::now();
    return true;
  };
  result.hash = simulator.run(options).state_hash;
  result.parts.resize(solver.max_collisions / part - 1);  // the last ends with a frame
  return result;
}

void compare(benchmark::State& state, const World& begin, std::uint64_t collisions) {
  const char* const asked = std::getenv("BRINK_ROUNDS");
  const int rounds = asked ? std::atoi(asked) : 5;
  SolverOptions solver;
  solver.max_collisions = collisions;
  const World world = later(begin, collisions);
  const std::uint64_t part = std::max<std::uint64_t>(collisions / 100, 1);
  for (auto _ : state) {
    constexpr double never = std::numeric_limits<double>::infinity();
    std::array<std::vector<double>, 2> least, undisturbed;
    std::uint64_t hash = 0;
    for (int round = 0; round < rounds; ++round)
      for (int more = 0; more < 2; ++more) {
        const Timed t = timed(world, solver, part, 1 + more);
        if (hash == 0) hash = t.hash;
        if (t.hash != hash) state.SkipWithError("the bits differ");
        least[more].resize(t.parts.size(), never);
        undisturbed[more].resize(t.parts.size(), never);
        for (std::size_t k = 0; k < t.parts.size(); ++k) {
          least[more][k] = std::min(least[more][k], t.parts[k].wall);
          if (t.parts[k].undisturbed(more == 1))
            undisturbed[more][k] = std::min(undisturbed[more][k], t.parts[k].wall);
        }
      }
    // the first part looks at everybody
    std::array<double, 2> all = {0.0, 0.0}, some = {0.0, 0.0};
    double parts = 0.0;
    for (std::size_t k = 1; k < least[0].size(); ++k) {
      for (int more = 0; more < 2; ++more) all[more] += least[more][k];
      if (undisturbed[0][k] == never || undisturbed[1][k] == never) continue;
      parts += 1.0;
      for (int more = 0; more < 2; ++more) some[more] += undisturbed[more][k];
    }
    state.counters["us_1"] = 1e6 * all[0] / static_cast<double>(part * (least[0].size() - 1));
    state.counters["ratio"] = all[0] / all[1];
    state.counters["ratio_undisturbed"] = some[0] / some[1];
    state.counters["us_1_undisturbed"] = 1e6 * some[0] / (parts * static_cast<double>(part));
    state.counters["parts_undisturbed"] = parts;
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
