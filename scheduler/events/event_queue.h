#pragma once
/// When each body must be looked at next: an indexed priority queue, one entry a body.

#include <algorithm>
#include <array>
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
    rivals_of_ = kNobody;
    nodes_.assign(leaves_ + (n + 7) / 4 * 4, {});  // the last has its brothers
    for (std::size_t k = 0; k < n; ++k) nodes_[leaves_ + k] = {bits(time), k};
    for (std::size_t level = leaves_; level > 1; level /= 4)
      for (std::size_t i = level; i < std::min(2 * level, nodes_.size()); i += 4) {
        nodes_[i / 4] = nodes_[i];
        take_earlier(nodes_[i / 4], first_of_brothers(i));
      }
  }
  /// The least time of all bodies; infinite where there are none.
  double time() const { return std::bit_cast<double>(nodes_[1].time); }
  /// The body whose time that is. @pre there are bodies.
  int body() const { return static_cast<int>(nodes_[1].body); }

  /// Who comes next after the first; where there is no other, at an infinite time nobody. Whom the first has met on its
  /// way to the root is kept: its own update(), if it is the next, has no other to compare it with.
  Entry second() {
    Key second{kNever + 1, kNobody};  // after all others
    const Key* const end = meet_rivals(body());
    for (const Key* rival = rivals_.data(); rival != end; ++rival) take_earlier(second, *rival);
    return {std::bit_cast<double>(std::min(second.time, kNever)), static_cast<int>(second.body)};
  }
  /// Calls visit(entry) of every body that is due by that time, in no order. Cost: O(log N) each.
  template <class Visit>
  void visit_until(double time, Visit&& visit) const {
    visit_until(1, bits(time), visit);
  }
  /// Changes a body's time. @pre time >= 0.
  void update(int body, double time) {
    Key first{bits(time), static_cast<std::uint64_t>(body)};
    std::size_t i = leaf(body);
    nodes_[i] = first;
    if (first.body == rivals_of_) {
      for (const Key* rival = rivals_.data(); i > 1; ++rival) {
        take_earlier(first, *rival);
        nodes_[i /= 4] = first;
      }
      return;
    }
    rivals_of_ = kNobody;  // others meet this body on their ways
    while (i > 1) {
      take_earlier(first, first_of_brothers(i));
      nodes_[i /= 4] = first;
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
  static constexpr std::uint64_t kNobody = std::numeric_limits<int>::max();
  static constexpr std::size_t kMostLevels = 16;  ///< of more bodies than an int can tell
  struct Key {
    std::uint64_t time = kNever;  ///< bits of the double: in their order, where it is >= 0
    std::uint64_t body = kNobody;
  };
  static std::uint64_t bits(double time) { return std::bit_cast<std::uint64_t>(time + 0.0); }
  std::size_t leaf(int body) const { return leaves_ + static_cast<std::size_t>(body); }

  template <class Visit>
  void visit_until(std::size_t node, std::uint64_t time, Visit& visit) const {
    if (nodes_[node].time > time) return;
    if (node >= leaves_)
      return visit(Entry{std::bit_cast<double>(nodes_[node].time), static_cast<int>(nodes_[node].body)});
    for (std::size_t i = 4 * node; i < std::min(4 * node + 4, nodes_.size()); ++i)
      visit_until(i, time, visit);
  }
  /// `a` becomes b if b's time is below `limit`. Which of two is the first cannot be foreseen, and of a choice in C++
  /// compilers make a branch, or need twice the instructions.
  static void take_below(Key& a, const Key& b, std::uint64_t limit) {
#if defined(__x86_64__) && defined(__GNUC__)
    asm("cmpq %[limit], %[time]\n\tcmovbq %[time], %[a_time]\n\tcmovbq %[body], %[a_body]"
        : [a_time] "+&r"(a.time), [a_body] "+r"(a.body)
        : [time] "rm"(b.time), [body] "rm"(b.body), [limit] "r"(limit)
        : "cc");
#else
    const std::uint64_t mask = -static_cast<std::uint64_t>(b.time < limit);
    a = {a.time ^ ((a.time ^ b.time) & mask), a.body ^ ((a.body ^ b.body) & mask)};
#endif
  }
  /// The earlier of two; at one time the lower body. All bodies of one node are lower than those of the next.
  static void take_earlier(Key& a, const Key& b) { take_below(a, b, a.time + (b.body < a.body ? 1 : 0)); }
  /// The first of the three brothers of node i.
  Key first_of_brothers(std::size_t i) const {
    const std::size_t pair = (i ^ 2) & ~std::size_t{1};
    Key first = nodes_[pair];
    take_below(first, nodes_[pair + 1], first.time);  // at one time the former stays
    take_earlier(first, nodes_[i ^ 1]);
    return first;
  }
  /// Writes down whom a body meets on its way to the root; returns the end of the list.
  const Key* meet_rivals(int body) {
    rivals_of_ = static_cast<std::uint64_t>(body);
    Key* rival = rivals_.data();
    for (std::size_t i = leaf(body); i > 1; i /= 4) *rival++ = first_of_brothers(i);
    return rival;
  }

  std::size_t leaves_ = 4;                        ///< a power of four: bodies from node leaves_ on
  LargeVector<Key> nodes_ = LargeVector<Key>(8);  ///< of node i: 4 i to 4 i + 3; the root is 1
  std::uint64_t rivals_of_ = kNobody;             ///< whose rivals are known
  std::array<Key, kMostLevels> rivals_;  ///< from the leaf up, the first of the brothers of each node
};

}  // namespace brink
