#pragma once
/// When each body must be looked at next: an indexed priority queue, one entry a body.

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace brink {

/// A 4-ary heap of (time, body) with the place of every body, so that a body's time can be changed. Ties: the
/// lower body first. Cost O(log N) a change; four children share a cache line. (Measured against a binary
/// heap and a calendar queue in tests/bench; see docs/scheduling.md.)
class EventQueue {
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

  /// The body whose time is the least but the first's, or the first where there is no other.
  int second() const {
    std::size_t least = 1;
    for (std::size_t k = 2; k < 5 && k < heap_.size(); ++k)
      if (heap_[k] < heap_[least]) least = k;
    return heap_.size() > 1 ? heap_[least].body : heap_.front().body;
  }
  /// The least time of all bodies but the first.
  double second_time() const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 1; k < 5 && k < heap_.size(); ++k) least = std::min(least, heap_[k].time);
    return least;
  }
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

}  // namespace brink
