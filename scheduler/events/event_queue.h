#pragma once
/// When each body must be looked at next: an indexed priority queue, one entry a body.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "brink/core/base/large_vector.h"

namespace brink {

/// A tournament of (time, body): every node of a binary tree holds the earlier of its two children, the root
/// the first of all. Ties: the lower body first. Cost O(log N) a change, without a branch that could be
/// foreseen wrongly. (Measured against heaps and a calendar queue in tests/bench; see docs/scheduling.md.)
class EventQueue {
 public:
  struct Entry {
    double time;  ///< >= 0 [s]
    int body;
  };

  /// Holds bodies 0 .. n - 1, all at `time`.
  void reset(std::size_t n, double time) {
    leaves_ = std::bit_ceil(std::max<std::size_t>(n, 1));
    nodes_.assign(2 * leaves_, {});
    for (std::size_t k = 0; k < n; ++k) nodes_[leaves_ + k] = Key(time, static_cast<int>(k));
    for (std::size_t i = leaves_ - 1; i > 0; --i) nodes_[i] = earlier(nodes_[2 * i], nodes_[2 * i + 1]);
  }
  /// The least time of all bodies; infinite where there are none.
  double time() const { return nodes_[1].entry().time; }
  /// The body whose time that is. @pre there are bodies.
  int body() const { return nodes_[1].entry().body; }

  /// Who comes next after the first; where there is no other, at an infinite time nobody in particular.
  Entry second() const {
    Key least;
    for (std::size_t i = leaves_ + static_cast<std::size_t>(body()); i > 1; i /= 2)
      least = earlier(least, nodes_[i ^ 1]);
    return least.entry();
  }
  /// Changes a body's time. @pre time >= 0.
  void update(int body, double time) {
    std::size_t i = leaves_ + static_cast<std::size_t>(body);
    Key first(time, body);
    for (nodes_[i] = first; i > 1; nodes_[i] = first) {
      first = earlier(first, nodes_[i ^ 1]);
      i /= 2;
    }
  }

 private:
  /// Entries in their order, as integers: without a branch.
  struct Key {
    std::uint64_t body = std::numeric_limits<int>::max();
    std::uint64_t time = std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity());

    Key() = default;
    Key(double t, int b) : body(static_cast<std::uint64_t>(b)), time(std::bit_cast<std::uint64_t>(t + 0.0)) {}
    Entry entry() const { return {std::bit_cast<double>(time), static_cast<int>(body)}; }
    bool operator<(const Key& k) const { return (time < k.time) | ((time == k.time) & (body < k.body)); }
  };
  static Key earlier(const Key& a, const Key& b) {
    const std::uint64_t second = -static_cast<std::uint64_t>(b < a);
    Key k;
    k.body = a.body ^ ((a.body ^ b.body) & second);
    k.time = a.time ^ ((a.time ^ b.time) & second);
    return k;
  }

  std::size_t leaves_ = 1;
  LargeVector<Key> nodes_ = LargeVector<Key>(2);  ///< of node i: 2 i and 2 i + 1; bodies from leaves_ on
};

}  // namespace brink
