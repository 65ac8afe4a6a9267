// The cone QP: what rest and one step cost, from nothing and with the graph's symbolic part kept. `solves` are
// factorisations, `a_solve` all of the time by them; a wrong or undecided answer fails.
#include <benchmark/benchmark.h>

#include "tests/support/lasting_contacts.h"

namespace brink {
namespace {

void count(benchmark::State& state, int bodies, int contacts, int solves) {
  state.counters["bodies"] = bodies;
  state.counters["contacts"] = contacts;
  state.counters["solves"] = solves;
  state.counters["a_solve"] =
      benchmark::Counter(solves, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void rest(benchmark::State& state, const testing::RestIsland& island) {
  ConeQp qp;
  RestResult result;
  for (auto _ : state) result = qp.rest_forces(island.problem);
  if (result.status != RestResult::Status::rests) state.SkipWithError("does not rest");
  count(state, static_cast<int>(island.centres.size()), static_cast<int>(result.loads.size()),
        result.factorisations);
  state.counters["residual"] = result.residual;
}

void stack(benchmark::State& state) { rest(state, testing::stack(static_cast<int>(state.range(0)))); }
BENCHMARK(stack)->Arg(10)->Arg(50)->Arg(200)->Unit(benchmark::kMillisecond);

void stack_heavy_top(benchmark::State& state) { rest(state, testing::stack(10, 0.0, 1e6)); }
BENCHMARK(stack_heavy_top)->Unit(benchmark::kMillisecond);

void stack_critical_lean(benchmark::State& state) { rest(state, testing::stack(10, 0.1)); }
BENCHMARK(stack_critical_lean)->Unit(benchmark::kMillisecond);

void pyramid(benchmark::State& state) { rest(state, testing::pyramid(static_cast<int>(state.range(0)))); }
BENCHMARK(pyramid)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond);

/// How far the answer's gaps go below 0 [m].
double overlap(const StepProblem& problem, const StepResult& result) {
  double deepest = 0.0;
  for (const StepContact& s : problem.contacts) {
    const LastingContact& c = s.contact;
    double v = c.normal_on_body.dot(result.velocity[c.body]);
    if (c.other >= 0) v += c.normal_on_other.dot(result.velocity[c.other]);
    deepest = std::max(deepest, -(s.gap + problem.duration * v));
  }
  return deepest;
}

void step(benchmark::State& state, const StepProblem& problem, bool keep) {
  ConeQp qp;
  StepResult result;
  for (auto _ : state) {
    if (!keep) qp = ConeQp();
    result = qp.step(problem);
  }
  if (result.status != StepResult::Status::solved) state.SkipWithError("not solved");
  count(state, static_cast<int>(problem.mass.size()), static_cast<int>(result.loads.size()),
        result.factorisations);
  state.counters["overlap"] = overlap(problem, result);
}

/// A hexagonal heap with six neighbours to a disc.
void heap(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  step(state, testing::heap_step(n, n, 1e-3, 0.5, 1.0 / 120), true);
}
BENCHMARK(heap)->Arg(10)->Arg(32)->Unit(benchmark::kMillisecond);

/// Of its contacts between discs about three in five, as a settled pile has them.
StepProblem pile(int n) {
  StepProblem problem = testing::heap_step(n, n, 1e-3, 0.5, 1.0 / 120);
  std::uint32_t word = 1;
  std::erase_if(problem.contacts, [&](const StepContact& s) {
    word = word * 1664525U + 1013904223U;
    return s.contact.other >= 0 && (word >> 16) % 5 > 2;
  });
  return problem;
}

void pile(benchmark::State& state) { step(state, pile(32), state.range(0) != 0); }
BENCHMARK(pile)->ArgName("keep")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace brink
