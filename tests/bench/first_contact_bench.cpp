// First contact of one pair, beside the brute-force alternative. Time is of one search, averaged over 64
// random meetings. Counters: `error`, the largest difference of a contact time from brute force [s];
// `contacts` of 64; `iterations` a search. A contact missed or wrong by more than a microsecond ends the
// benchmark with an error.
#include <benchmark/benchmark.h>

#include <cmath>

#include "brink/core/base/random.h"
#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/first_contact/first_contact.h"

namespace brink {
namespace {

constexpr int kEncounters = 64;
constexpr double kEnd = 3.0, kStep = 1e-3;

/// Two owners on their ways.
struct Encounter {
  Motion motion_a, motion_b;
};

/// A pair of shapes and 64 ways in which they come towards each other.
struct Pair {
  std::unique_ptr<SiteIndex> index_a, index_b;
  std::vector<Encounter> encounters;

  Pair(const Shape& a, const Shape& b)
      : index_a(make_brute_force_index(std::make_shared<const Outline>(a.outline))),
        index_b(make_brute_force_index(std::make_shared<const Outline>(b.outline))) {}
  Mover a(const Encounter& m) const { return {index_a.get(), &m.motion_a}; }
  Mover b(const Encounter& m) const { return {index_b.get(), &m.motion_b}; }
};

BodyState state(const Vec2& p, double angle, const Vec2& v, double omega) { return {{p, angle}, {v, omega}}; }

/// From 2 m to either side at about 1 m/s each, a little off the line, turning at up to `spin` rad/s.
void come_together(Pair& pair, double spin) {
  Random random(5);
  for (int k = 0; k < kEncounters; ++k) {
    const auto way = [&](double side) {
      return Motion::ballistic(
          0.0,
          state({side * 2.0, random.uniform(-0.2, 0.2)}, random.uniform(0.0, 6.0),
                {-side * random.uniform(0.8, 1.2), random.uniform(-0.1, 0.1)}, random.uniform(-spin, spin)),
          {});
    };
    const Motion a = way(1.0);
    pair.encounters.push_back({a, way(-1.0)});
  }
}

Pair spinning_boxes() {
  Pair pair(make_box(1.0, 0.6), make_box(0.8, 0.8));
  come_together(pair, 3.0);
  return pair;
}
Pair boxes_that_do_not_turn() {
  Pair pair(make_box(1.0, 0.6), make_box(0.8, 0.8));
  come_together(pair, 0.0);
  return pair;
}
Pair discs() {
  Pair pair(make_disc(0.5), make_disc(0.4));
  come_together(pair, 3.0);
  return pair;
}
/// The same discs, kept from meeting by 2 m to the side.
Pair discs_that_miss() {
  Pair pair = discs();
  for (Encounter& m : pair.encounters) {
    BodyState start = m.motion_a.start();
    start.pose.position.y() += 2.0;
    m.motion_a = Motion::ballistic(0.0, start, {});
  }
  return pair;
}
/// Discs that fall on a floor.
Pair disc_and_segment() {
  Pair pair(make_disc(0.5), make_segment({-10.0, 0.0}, {10.0, 0.0}));
  Random random(6);
  for (int k = 0; k < kEncounters; ++k) {
    const BodyState start = state({random.uniform(-1.0, 1.0), random.uniform(1.0, 3.0)}, 0.0,
                                  {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)}, 1.0);
    pair.encounters.push_back({Motion::ballistic(0.0, start, {{0.0, -9.81}, 0.0}), Motion::still({})});
  }
  return pair;
}

/// The slow way: look every millisecond, then halve.
double slow_contact(const Pair& pair, const Encounter& m, SearchScratch& scratch) {
  const Mover a = pair.a(m), b = pair.b(m);
  const auto apart = [&](double t) { return pair_gap(a, b, t, SearchLimits(), scratch) > 0.0; };
  double high = kStep;
  while (high < kEnd && apart(high)) high += kStep;
  if (high >= kEnd) return kEnd;
  double low = high - kStep;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (apart(middle) ? low : high) = middle;
  }
  return low;
}

PairAnswer fast_contact(const Pair& pair, const Encounter& m, bool closed_forms, SearchScratch& scratch,
                        WorkCounters& work) {
  SearchLimits limits;
  limits.closed_forms = closed_forms;
  return first_contact(pair.a(m), pair.b(m), 0.0, kEnd, limits, scratch, work);
}

/// Puts the counters; false on a wrong answer.
bool check(benchmark::State& state, const Pair& pair, bool closed_forms) {
  SearchScratch scratch;
  WorkCounters work;
  double worst = 0.0;
  int contacts = 0;
  for (const Encounter& m : pair.encounters) {
    const PairAnswer answer = fast_contact(pair, m, closed_forms, scratch, work);
    const double fast = answer.status == PairAnswer::Status::contact ? answer.until : kEnd;
    contacts += answer.status == PairAnswer::Status::contact;
    worst = std::max(worst, std::abs(fast - slow_contact(pair, m, scratch)));
  }
  state.counters["error"] = worst;
  state.counters["contacts"] = contacts;
  state.counters["iterations"] = static_cast<double>(work.search_iterations) / kEncounters;
  return worst < 1e-6;
}

void search(benchmark::State& state, Pair (*make)(), bool closed_forms) {
  const Pair pair = make();
  if (!check(state, pair, closed_forms)) return state.SkipWithError("differs from brute force");
  SearchScratch scratch;
  WorkCounters work;
  std::size_t k = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(
        fast_contact(pair, pair.encounters[k++ % kEncounters], closed_forms, scratch, work).until);
}
BENCHMARK_CAPTURE(search, spinning_boxes, spinning_boxes, true);
BENCHMARK_CAPTURE(search, boxes_that_do_not_turn, boxes_that_do_not_turn, true);
BENCHMARK_CAPTURE(search, discs, discs, true);
BENCHMARK_CAPTURE(search, discs_that_miss, discs_that_miss, true);
BENCHMARK_CAPTURE(search, discs_by_the_general_search, discs, false);
BENCHMARK_CAPTURE(search, disc_and_segment, disc_and_segment, true);
BENCHMARK_CAPTURE(search, disc_and_segment_by_the_general_search, disc_and_segment, false);

void search_brute_force(benchmark::State& state, Pair (*make)()) {
  const Pair pair = make();
  SearchScratch scratch;
  std::size_t k = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(slow_contact(pair, pair.encounters[k++ % kEncounters], scratch));
}
BENCHMARK_CAPTURE(search_brute_force, spinning_boxes, spinning_boxes);
BENCHMARK_CAPTURE(search_brute_force, discs, discs);
BENCHMARK_CAPTURE(search_brute_force, disc_and_segment, disc_and_segment);

}  // namespace
}  // namespace brink
