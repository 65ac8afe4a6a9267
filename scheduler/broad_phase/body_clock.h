#pragma once
/// What one body has in view: who it may meet next, and until when that view holds.

#include <algorithm>
#include <array>
#include <cmath>
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
  /// Times of the first two; infinite where there are fewer. Kept so without a branch: how many there are cannot be
  /// foreseen.
  double first_time() const { return first_[0].time; }
  double second_time() const { return first_[1].time; }
  void clear() {
    count_ = 0;
    for (Candidate& c : first_) c.time = kNever;
    if (!more_.empty()) more_.clear();
  }
  void insert(const Candidate& c) {
    if (count_ >= kInPlace) more_.emplace_back();
    std::size_t k = count_++;
    for (; k > 0 && before(c, (*this)[k - 1]); --k) (*this)[k] = (*this)[k - 1];
    (*this)[k] = c;
  }
  /// The same of one that is not exact, where fewer than kInPlace are: whom it comes before cannot be foreseen, so all
  /// that there may be are moved, to where they are or one further on.
  void insert_in_place(const Candidate& c) {
    std::uint64_t place = 0;
    for (const Candidate& e : first_) place += e.time <= c.time ? 1 : 0;  // what is not there is at no time
    for (std::size_t k = kInPlace - 1; k-- > 0;)
      first_[k + ((place - k - 1) >> 63)] = first_[k];  // k >= place
    first_[place] = c;
    ++count_;
  }
  void pop_front() {
    for (std::size_t k = 1; k < count_; ++k) (*this)[k - 1] = (*this)[k];
    pop_back();
  }
  void pop_back() {
    if (count_-- > kInPlace)
      more_.pop_back();
    else
      first_[count_].time = kNever;
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
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
  static constexpr double kShortest = 0.01;                  ///< of a view's length: it is not ended before
  double exit = std::numeric_limits<double>::infinity();     ///< leaves its cell
  double horizon = std::numeric_limits<double>::infinity();  ///< the view ends: look at everything again
  CandidateList candidates;
  const std::vector<SiteImage>* sites = nullptr;  ///< of its cell, in the first period
  int level = 0;                                  ///< of cells
  unsigned undecided : 31 = 0;                    ///< searches of one view in a row that met their cap
  unsigned has_found : 1 = 0;                     ///< a contact may have been found since the view began

  double expiry() const { return std::min(std::min(exit, horizon), candidates.first_time()); }
  /// Takes a candidate into view. Where there is no room the latest falls out, and the view ends where a
  /// search for it must begin; but what must be searched within the instant `now` stays, so that a view does
  /// not end in the instant in which it begins, and so does what would end it after less than a hundredth of its length.
  void see(const Candidate& c, double now) {
    if (c.time >= horizon) return;
    candidates.insert(c);
    if (candidates.size() <= CandidateList::kInPlace) return;
    const double shortest = std::isfinite(horizon) ? kShortest * (horizon - now) : 0.0;
    if (candidates.back().clear <= now + std::max(shortest, 4.0 * same_instant(now))) return;
    horizon = std::min(horizon, candidates.back().clear);  // it may lie beyond an end that was set since
    candidates.pop_back();
  }
  /// The same of a body in free flight, where it is, from that time on.
  void see(double begin, int other, unsigned version, double now) {
    if (!(begin < horizon)) return;
    const Candidate c{begin, begin, other, {}, version, 0};
    if (candidates.size() < CandidateList::kInPlace)
      candidates.insert_in_place(c);
    else
      see(c, now);
  }
  void forget_all() {
    candidates.clear();
    undecided = 0;
    has_found = 0;
    horizon = std::numeric_limits<double>::infinity();
  }
};

}  // namespace brink
