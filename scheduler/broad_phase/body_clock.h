#pragma once
/// What one body has in view: who it may meet next, and until when that view holds.

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "brink/scheduler/broad_phase/site_lists.h"
#include "brink/scheduler/first_contact/canonical_time.h"

namespace brink {

/// "Clear of `other` until `time`" for a body: nothing can happen between the two before. Owners count bodies
/// first, then fixed sites.
struct Candidate {
  double time = std::numeric_limits<double>::infinity();
  double clear = 0.0;  ///< a search must begin here: from closer to the contact roundings would show
  int other = -1;
  Image image{};              ///< of the other
  unsigned version : 29 = 0;  ///< of the other body, when this was found
  unsigned exact : 1 = 0;     ///< `time` is the contact itself
};

/// Candidates, earliest first; of equal times the exact one. The first few lie in place.
class CandidateList {
 public:
  static constexpr std::size_t kInPlace = 4;

  bool empty() const { return count_ == 0; }
  std::size_t size() const { return count_; }
  Candidate& operator[](std::size_t k) { return k < kInPlace ? first_[k] : more_[k - kInPlace]; }
  const Candidate& operator[](std::size_t k) const { return k < kInPlace ? first_[k] : more_[k - kInPlace]; }
  const Candidate& front() const { return first_[0]; }
  const Candidate& back() const { return (*this)[count_ - 1]; }
  bool has_exact() const {
    bool exact = false;
    for (std::size_t k = 0; k < count_; ++k) exact |= (*this)[k].exact != 0;
    return exact;
  }
  void clear() {
    count_ = 0;
    more_.clear();
  }
  void insert(const Candidate& c) {
    if (count_ >= kInPlace) more_.emplace_back();
    std::size_t k = count_++;
    for (; k > 0 && before(c, (*this)[k - 1]); --k) (*this)[k] = (*this)[k - 1];
    (*this)[k] = c;
  }
  void pop_front() {
    for (std::size_t k = 1; k < count_; ++k) (*this)[k - 1] = (*this)[k];
    pop_back();
  }
  void pop_back() {
    if (count_-- > kInPlace) more_.pop_back();
  }

 private:
  static bool before(const Candidate& a, const Candidate& b) {
    return a.time < b.time || (a.time == b.time && a.exact && !b.exact);
  }
  std::uint32_t count_ = 0;
  std::array<Candidate, kInPlace> first_;
  std::vector<Candidate> more_;
};

/// A body's own clock. Every pair of bodies that may meet is in view of one of the two: clear until that
/// one's expiry(). So the body whose view expires first is the only one that must be looked at. Three cache lines; what
/// comes first is in one of them.
struct alignas(64) BodyClock {
  double exit = std::numeric_limits<double>::infinity();     ///< leaves its cell
  double horizon = std::numeric_limits<double>::infinity();  ///< the view ends: look at everything again
  CandidateList candidates;
  const std::vector<SiteImage>* sites = nullptr;  ///< of its cell, in the first period
  int level = 0;                                  ///< of cells
  unsigned undecided = 0;                         ///< searches in a row that met their cap

  double expiry() const {
    const double t = std::min(exit, horizon);
    return candidates.empty() ? t : std::min(t, candidates.front().time);
  }
  /// Takes a candidate into view. Where there is no room the latest falls out, and the view ends where a
  /// search for it must begin; but what must be searched within the instant `now` stays, so that a view does
  /// not end in the instant in which it begins.
  void see(const Candidate& c, double now) {
    if (c.time >= horizon) return;
    candidates.insert(c);
    if (candidates.size() <= CandidateList::kInPlace ||
        candidates.back().clear <= now + 4.0 * same_instant(now))
      return;
    horizon = std::min(horizon, candidates.back().clear);  // it may lie beyond an end that was set since
    candidates.pop_back();
  }
  void forget_all() {
    candidates.clear();
    horizon = std::numeric_limits<double>::infinity();
  }
};

}  // namespace brink
