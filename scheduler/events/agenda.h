#pragma once
/// The agenda: certificates, earliest first, under one total order.

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "brink/core/base/periodic.h"
#include "brink/scheduler/first_contact/first_contact.h"

namespace brink {

/// Two owners that may meet: a body, and another body or a fixed site; in a periodic world one image of it.
struct PairKey {
  int body = -1;
  int other_body = -1;  ///< > body; -1: a fixed site
  int other_site = -1;
  Image image{};  ///< of the other that the body meets

  bool with_site() const { return other_body < 0; }
  auto order() const { return std::tuple(body, other_body < 0, other_body, other_site, image); }
  bool operator<(const PairKey& k) const { return order() < k.order(); }
  bool operator==(const PairKey& k) const { return order() == k.order(); }
};

/// What a pass found out about one pair: a contact, or where the search had to stop. It speaks of bodies at
/// the versions it names; a resolve raises those, and the certificate is stale.
struct Certificate {
  /// island: its step ends; of `pair` only `body` means something, its least member.
  enum class Kind : std::uint8_t { contact, island, undecided };
  double time = 0.0;
  Kind kind = Kind::contact;
  PairKey pair;
  std::uint64_t version_body = 0, version_other = 0;
  FeatureContact contact;
  PairAnswer::Why why = PairAnswer::Why::steps;  ///< of an undecided one

  /// The total order of events: (time, kind, body, other, site, sample).
  auto order() const {
    return std::tuple(time, kind, pair.order(), contact.site, contact.sample, contact.sample_on_a);
  }
};

/// A binary heap of certificates. Insert and pop cost O(log n).
class Agenda {
 public:
  void clear() { heap_.clear(); }
  bool empty() const { return heap_.empty(); }
  std::size_t size() const { return heap_.size(); }
  const Certificate& earliest() const { return heap_.front(); }
  void insert(const Certificate& c) {
    ++operations_;
    heap_.push_back(c);
    std::push_heap(heap_.begin(), heap_.end(), later);
  }
  Certificate pop() {
    ++operations_;
    std::pop_heap(heap_.begin(), heap_.end(), later);
    Certificate c = heap_.back();
    heap_.pop_back();
    return c;
  }

  /// Inserts and pops since this was last asked.
  std::uint64_t take_operations() { return std::exchange(operations_, 0); }

 private:
  static bool later(const Certificate& a, const Certificate& b) { return b.order() < a.order(); }
  std::vector<Certificate> heap_;
  std::uint64_t operations_ = 0;
};

}  // namespace brink
