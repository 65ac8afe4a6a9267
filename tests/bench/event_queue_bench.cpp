// What the queue of local clocks costs: the tournament that is used, beside heaps and a calendar queue. A serving takes the first body, gives it a later time, and gives another body one too, as a
// collision does.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "brink/core/base/random.h"
#include "brink/scheduler/events/event_queue.h"

namespace brink {
namespace {

/// The same interface as EventQueue's, with the place of every body; four children share a cache line.
class FourAryHeap {
 public:
  /// Holds bodies 0 .. n - 1, all at `time`.
  void reset(std::size_t n, double time) {
    heap_.resize(n);
    place_.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      heap_[k] = {time, static_cast<int>(k)};
      place_[k] = static_cast<int>(k);
    }
  }
  /// The least time of all bodies; infinite where there are none.
  double time() const { return heap_.empty() ? std::numeric_limits<double>::infinity() : heap_.front().time; }
  /// The body whose time that is. @pre there are bodies.
  int body() const { return heap_.front().body; }

  /// Changes a body's time.
  void update(int body, double time) {
    std::size_t k = place_[body];
    const bool earlier = Entry{time, body} < heap_[k];
    heap_[k].time = time;
    earlier ? up(k) : down(k);
  }

 private:
  struct Entry {
    double time;
    int body;
    /// Without a branch: which of two comes first cannot be foreseen.
    bool operator<(const Entry& e) const { return (time < e.time) | ((time == e.time) & (body < e.body)); }
  };

  void up(std::size_t k) {
    const Entry e = heap_[k];
    while (k > 0) {
      const std::size_t parent = (k - 1) / 4;
      if (!(e < heap_[parent])) break;
      set(k, heap_[parent]);
      k = parent;
    }
    set(k, e);
  }
  void down(std::size_t k) {
    const Entry e = heap_[k];
    for (;;) {
      const std::size_t first = 4 * k + 1;
      if (first >= heap_.size()) break;
      const std::size_t last = std::min(first + 4, heap_.size());
      std::size_t least = first;
      for (std::size_t c = first + 1; c < last; ++c) least = heap_[c] < heap_[least] ? c : least;
      if (!(heap_[least] < e)) break;
      set(k, heap_[least]);
      k = least;
    }
    set(k, e);
  }
  void set(std::size_t k, const Entry& e) {
    heap_[k] = e;
    place_[e.body] = static_cast<int>(k);
  }

  std::vector<Entry> heap_;
  std::vector<int> place_;
};

/// The same interface, with two children a node.
class BinaryHeap {
 public:
  void reset(std::size_t n, double time) {
    times_.assign(n, time);
    heap_.resize(n);
    place_.resize(n);
    for (std::size_t k = 0; k < n; ++k) heap_[k] = place_[k] = static_cast<int>(k);
  }
  double time() const { return times_[heap_[0]]; }
  int body() const { return heap_[0]; }
  void update(int body, double time) {
    times_[body] = time;
    std::size_t k = place_[body];
    while (k > 0 && before(body, heap_[(k - 1) / 2])) {
      set(k, heap_[(k - 1) / 2]);
      k = (k - 1) / 2;
    }
    for (;;) {
      std::size_t child = 2 * k + 1;
      if (child >= heap_.size()) break;
      if (child + 1 < heap_.size() && before(heap_[child + 1], heap_[child])) ++child;
      if (!before(heap_[child], body)) break;
      set(k, heap_[child]);
      k = child;
    }
    set(k, body);
  }

 private:
  bool before(int a, int b) const { return times_[a] < times_[b] || (times_[a] == times_[b] && a < b); }
  void set(std::size_t k, int body) {
    heap_[k] = body;
    place_[body] = static_cast<int>(k);
  }
  std::vector<double> times_;
  std::vector<int> heap_, place_;
};

/// Brown's calendar (1988): days of equal length hold lists of bodies, a year as many days as bodies; the
/// first body is searched for from the present day on. The length of a day is given: of a gas, the mean time
/// between its servings.
class CalendarQueue {
 public:
  explicit CalendarQueue(double day) : day_(day) {}
  void reset(std::size_t n, double time) {
    days_ = 1;
    while (days_ < n) days_ *= 2;
    first_.assign(days_, -1);
    entries_.assign(n, {time, -1, -1, -1});
    now_ = number(time);
    for (std::size_t k = 0; k < n; ++k) link(static_cast<int>(k));
    body_ = -1;
  }
  double time() { return entries_[body()].time; }
  int body() {
    if (body_ < 0) find();
    return body_;
  }
  void update(int body, double time) {
    unlink(body);
    entries_[body].time = time;
    link(body);
    if (number(time) < now_) now_ = number(time);
    if (body_ >= 0 && (body == body_ || before(body, body_))) body_ = -1;
  }

 private:
  struct Entry {
    double time;
    int next, previous;
    std::int64_t list;
  };
  std::int64_t number(double time) const { return static_cast<std::int64_t>(time / day_); }
  void link(int k) {
    Entry& e = entries_[k];
    e.list = number(e.time) & static_cast<std::int64_t>(days_ - 1);
    e.next = first_[e.list];
    e.previous = -1;
    if (e.next >= 0) entries_[e.next].previous = k;
    first_[e.list] = k;
  }
  void unlink(int k) {
    const Entry& e = entries_[k];
    if (e.next >= 0) entries_[e.next].previous = e.previous;
    (e.previous >= 0 ? entries_[e.previous].next : first_[e.list]) = e.next;
  }
  void find() {
    for (std::size_t looked = 0; looked < days_; ++looked, ++now_) {
      body_ = -1;
      for (int k = first_[now_ & static_cast<std::int64_t>(days_ - 1)]; k >= 0; k = entries_[k].next)
        if (number(entries_[k].time) <= now_ && (body_ < 0 || before(k, body_))) body_ = k;
      if (body_ >= 0) return;
    }
    for (int k = 0; k < static_cast<int>(entries_.size()); ++k)  // a year without anybody
      if (body_ < 0 || before(k, body_)) body_ = k;
    now_ = number(entries_[body_].time);
  }
  bool before(int a, int b) const {
    const double s = entries_[a].time, t = entries_[b].time;
    return s < t || (s == t && a < b);
  }

  double day_;
  std::size_t days_ = 1;
  std::int64_t now_ = 0;
  int body_ = -1;
  std::vector<int> first_;
  std::vector<Entry> entries_;
};

/// Times between servings of one body, exponential with mean 1; every so often a very long one, as of a body
/// far from all others.
double wait(Random& random) {
  const double w = -std::log(1.0 - random.uniform());
  return random.uniform() < 0.02 ? 50.0 * w : w;
}

template <class Queue>
void serve(benchmark::State& state, Queue queue) {
  const int n = static_cast<int>(state.range(0));
  Random random(4);
  queue.reset(n, 0.0);
  for (int k = 0; k < n; ++k) queue.update(k, wait(random));
  double last = 0.0;
  for (auto _ : state) {
    const int first = queue.body();
    const double now = queue.time();
    if (now < last) state.SkipWithError("served out of order");
    last = now;
    queue.update(first, now + wait(random));
    queue.update(static_cast<int>(random.below(n)), now + wait(random));
  }
}

void tournament(benchmark::State& state) { serve(state, EventQueue()); }
void four_ary_heap(benchmark::State& state) { serve(state, FourAryHeap()); }
void binary_heap(benchmark::State& state) { serve(state, BinaryHeap()); }
void calendar_queue(benchmark::State& state) {
  serve(state, CalendarQueue(0.5 / static_cast<double>(state.range(0))));
}
BENCHMARK(tournament)->RangeMultiplier(10)->Range(100, 1000000);
BENCHMARK(four_ary_heap)->RangeMultiplier(10)->Range(100, 1000000);
BENCHMARK(binary_heap)->RangeMultiplier(10)->Range(100, 1000000);
BENCHMARK(calendar_queue)->RangeMultiplier(10)->Range(100, 10000);

}  // namespace
}  // namespace brink
