#pragma once
/// When each body must be looked at next: an indexed priority queue, one entry a body.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "brink/core/base/large_vector.h"

namespace brink {

/// A tournament of (time, body): every node is the earliest of its four children, which are one cache line; the leaves are
/// the bodies, in their order, and the root is the first of all. Ties: the lower body first. Cost O(log N) a change,
/// without a branch that could be foreseen wrongly. (Measured against heaps and a calendar queue in tests/bench; see
/// docs/scheduling.md.)
class EventQueue {
 public:
  struct Entry {
    double time;  ///< >= 0 [s]
    int body;
  };

  /// Holds bodies 0 .. n - 1, all at `time`.
  void reset(std::size_t n, double time) {
    for (leaves_ = 4; leaves_ < n;) leaves_ *= 4;
    nodes_.assign(leaves_ + (n + 7) / 4 * 4, {});  // the last has its brothers
    for (std::size_t k = 0; k < n; ++k) nodes_[leaves_ + k] = {bits(time), k};
    for (std::size_t level = leaves_; level > 1; level /= 4)
      for (std::size_t i = level; i < std::min(2 * level, nodes_.size()); i += 4)
        nodes_[i / 4] = first_of_four(nodes_[i], i);
  }
  /// The least time of all bodies; infinite where there are none.
  double time() const { return std::bit_cast<double>(nodes_[1].time); }
  /// The body whose time that is. @pre there are bodies.
  int body() const { return static_cast<int>(nodes_[1].body); }

  /// Who comes next after the first; where there is no other, at an infinite time nobody in particular.
  Entry second() const {
    Key second{kNever + 1, 0};  // after all others
    for (std::size_t i = leaf(body()); i > 1; i /= 4) second = first_of_four(second, i);
    return {std::bit_cast<double>(std::min(second.time, kNever)), static_cast<int>(second.body)};
  }
  /// Changes a body's time. @pre time >= 0.
  void update(int body, double time) {
    std::size_t i = leaf(body);
    Key first{bits(time), static_cast<std::uint64_t>(body)};
    for (nodes_[i] = first; i > 1; nodes_[i] = first) {
      first = first_of_four(first, i);
      i /= 4;
    }
  }
  /// Starts to fetch what an update of that body reads and is in no cache.
  void expect(int body) const {
    prefetch_line(&nodes_[leaf(body)]);
    prefetch_line(&nodes_[leaf(body) / 4]);
  }

 private:
  static constexpr std::uint64_t kNever =
      std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity());
  struct Key {
    std::uint64_t time = kNever;  ///< bits of the double: in their order, where it is >= 0
    std::uint64_t body = 0;
  };
  static std::uint64_t bits(double time) { return std::bit_cast<std::uint64_t>(time + 0.0); }
  std::size_t leaf(int body) const { return leaves_ + static_cast<std::size_t>(body); }

  /// The earlier of two, of which at one time b is the first if it `leads`. By masks: a compiler makes branches of less.
  static Key earlier(const Key& a, const Key& b, std::uint64_t leads) {
    const std::uint64_t mask = -static_cast<std::uint64_t>(b.time < a.time + leads);
    return {a.time ^ ((a.time ^ b.time) & mask), a.body ^ ((a.body ^ b.body) & mask)};
  }
  /// The first of a key in the place of node i and that node's three brothers. These are compared first: then all of
  /// a way to the root waits for `key` alone.
  Key first_of_four(const Key& key, std::size_t i) const {
    const std::size_t pair = (i ^ 2) & ~std::size_t{1};
    const Key other = earlier(nodes_[pair], nodes_[pair + 1], 0);
    return earlier(earlier(key, nodes_[i ^ 1], i & 1), other, i >> 1 & 1);
  }

  std::size_t leaves_ = 4;                        ///< a power of four: bodies from node leaves_ on
  LargeVector<Key> nodes_ = LargeVector<Key>(8);  ///< of node i: 4 i to 4 i + 3; the root is 1
};

}  // namespace brink
