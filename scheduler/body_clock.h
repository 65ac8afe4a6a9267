#pragma once
/// What one body has in view: who it may meet next, and until when that view holds.

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <limits>
#include <vector>

#include "brink/scheduler/cell_grid.h"

namespace brink {

/// "Clear of `other` until `time`" for a body: nothing can happen between the two before. Owners count bodies
/// first, then fixed sites.
struct Candidate {
  double time = std::numeric_limits<double>::infinity();
  double end = std::numeric_limits<double>::infinity();  ///< they cannot meet later than this either
  int other = -1;
  unsigned version = 0;  ///< of the other body, when this was found
  bool exact = false;    ///< `time` is the contact itself ...
  double clear = 0.0;    ///< ... and a search for it must begin here: from closer by, roundings would show
};

/// A body's own clock. Every pair of bodies that may meet is in view of one of the two: clear until that
/// one's expiry(). So the body whose view expires first is the only one that must be looked at.
struct BodyClock {
  static constexpr std::size_t kCandidates = 4;  ///< kept in view; more only where they are due at once

  double exit = std::numeric_limits<double>::infinity();     ///< leaves its cell
  double horizon = std::numeric_limits<double>::infinity();  ///< the view ends: look at everything again
  boost::container::small_vector<Candidate, kCandidates> candidates;  ///< earliest first
  Cell cell;
  int level = 0;
  int previous = CellGrid::kNone;  ///< in the list of its cell
  const std::vector<int>* sites = nullptr;
  unsigned undecided = 0;  ///< searches in a row that met their cap

  double expiry() const {
    const double t = std::min(exit, horizon);
    return candidates.empty() ? t : std::min(t, candidates.front().time);
  }
  /// Takes a candidate into view. Where there is no room the latest falls out, and the view ends where a search
  /// for it must begin; but what must be searched from `now` on stays, so that a view never ends as it begins.
  void see(const Candidate& c, double now) {
    if (c.time >= horizon) return;
    auto place = candidates.end();
    // of equal times the exact one goes first: what is known needs no second search
    while (place != candidates.begin() &&
           (c.time < std::prev(place)->time || (c.exact && c.time == std::prev(place)->time)))
      --place;
    candidates.insert(place, c);
    if (candidates.size() <= kCandidates || candidates.back().clear <= now) return;
    horizon = candidates.back().clear;
    candidates.pop_back();
  }
  void forget(std::size_t k) { candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(k)); }
  void forget_all() {
    candidates.clear();
    horizon = std::numeric_limits<double>::infinity();
  }
};

}  // namespace brink
