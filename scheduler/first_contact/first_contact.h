#pragma once
/// First contact of one pair: certified Newton advancement.
///
///   every sample of both outlines starts with "safe until: from"
///   until all are safe to the end:
///     take the least safe time t; place both outlines there
///     for each sample due at t: its candidate sites, their gaps f and rates f'
///       touching and approaching -> polish the root, remember the earliest contact, end the search there
///       else safe until t + h: no site of the other outline can be reached before (safe_step.h)
///
/// For a site with convex distance, f(q(t+h)) >= f + f' h - a h^2 / 2 with a >= |q''| in the other outline's
/// turning frame; arcs seen from inside add v^2 / rho. Two-sided sampling makes it complete: every vertex and
/// every arc of both outlines. Starts in contact: separating pairs are stepped by the same formula;
/// approaching ones collide now. Sources: Mirtich 1996 (conservative advancement), Zhang et al. 2006 (bounds
/// under rotation); docs/first-contact.md.

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "brink/core/base/work.h"
#include "brink/core/fields/site_index.h"
#include "brink/integrators/motion.h"

namespace brink {

/// One side of a pair.
struct Mover {
  const SiteIndex* index = nullptr;
  const Motion* motion = nullptr;
  /// Bound on the rounding error of the velocities of this body's points, left by the last resolve [m/s].
  double velocity_rounding = 0.0;
  /// Of two such the gaps are kept to the tolerance, no better: what an island's steps hold, and sites.
  bool held = false;

  const Outline& outline() const { return index->outline(); }
};

struct SearchLimits {
  double touch = 1e-13;        ///< gaps below this count as touching [m]
  double tolerance = 1e-10;    ///< gap at which Newton steps give way to polishing the root [m]
  int max_iterations = 10000;  ///< then the answer is "clear until" where the search stood
  /// Before this time [s] it goes on for `min_iterations` at least: so far it must be known in any case.
  double needed_until = -std::numeric_limits<double>::infinity();
  int min_iterations = 64;
  bool closed_forms = true;  ///< use quadratics where the pair has them
};

/// Which features touch, and how.
struct FeatureContact {
  double time = 0.0;           ///< last double at which the gap is > 0, or the start if they touched there
  bool sample_on_a = true;     ///< sample on a and site on b, or the reverse
  bool seen = false;           ///< in a picture: no feature of the outlines, to be looked at more closely
  int sample = -1;             ///< into the carrying outline's samples
  int site = -1;               ///< into the other outline's sites
  Vec2 point = Vec2::Zero();   ///< world [m]
  Vec2 normal = Vec2::Zero();  ///< world, unit, from b into a
  double closing_speed = 0.0;  ///< [m/s], > 0 approaching
  double gap = 0.0;            ///< [m] at `time`
  double level = 0.0;          ///< the gap at which these features meet [m] (tolerances.h)
  double sink = 0.0;           ///< what of the level is sink_at_start() [m], <= 0

  /// The gap at which they met if their pair had not sunk before [m].
  double nominal() const { return level - sink; }
  /// How far these features have sunk into each other beyond that [m].
  double sunk() const { return std::max(0.0, nominal() - gap); }
};

struct PairAnswer {
  enum class Status {
    clear,      ///< no contact before `until`
    contact,    ///< see `contact`; until == contact.time
    undecided,  ///< the search stopped at `until`: clear so far
  };
  /// Why it is undecided.
  enum class Why : unsigned char {
    steps,  ///< the iteration cap was met: ask again from `until`
    place,  ///< they are close, and too far away for their gap to be told to the contact tolerance
    speed,  ///< they are close, and too fast for the clock: they move a part of their size between two
            ///< doubles
  };
  Status status = Status::clear;
  double until = 0.0;
  FeatureContact contact;
  Why why = Why::steps;
};

/// Reused memory of searches; one a thread.
struct SearchScratch {
  /// A site close to the sample that is being looked at, and its normal there (out of it, to the sample).
  struct Neighbour {
    int site = -1;
    Vec2 normal = Vec2::Zero();
    bool at_end = false;  ///< its nearest point is an end of it: the sample is on neither of its sides
  };
  SiteIndex::Scratch index;    ///< of the candidates that are being looked through
  SiteIndex::Scratch nearest;  ///< of single questions beside them
  std::vector<Neighbour> neighbours;
  Vec2 looked_from = Vec2::Zero();  ///< where the sample was when they were found, in their frame
  double looked_to = 0.0;           ///< how far off they were looked for [m]
  int flush_on = -1;                ///< the neighbour beside whose end a corner lay flush then; -1: none
  std::vector<double> safe_until;
  /// Samples, and whether they are a's, that may have met since they were last looked at.
  std::vector<std::pair<bool, int>> sinking;
};

/// First contact of a and b in [from, to]. @pre both motions cover [from, to], 0 <= from <= to.
PairAnswer first_contact(const Mover& a, const Mover& b, double from, double to, const SearchLimits& limits,
                         SearchScratch& scratch, WorkCounters& work);

/// Every feature pair that is within `tolerance` of its level at time t, nearest first; receding ones too.
/// Brute force over samples.
std::vector<FeatureContact> touching_features(const Mover& a, const Mover& b, double t, double tolerance,
                                              const SearchLimits& limits, SearchScratch& scratch);

/// The same two features, looked at at time t: their point, normal, closing speed, gap and level. Keeps
/// `like`'s normal where the new one is lost in rounding.
FeatureContact contact_at(const Mover& a, const Mover& b, double t, const FeatureContact& like,
                          const SearchLimits& limits, SearchScratch& scratch);

/// Signed gap of the pair at time t: the least over both sample sets [m], or `at_most` where it is more; touching
/// features' exactness.
double pair_gap(const Mover& a, const Mover& b, double t, const SearchLimits& limits, SearchScratch& scratch,
                double at_most = std::numeric_limits<double>::infinity());

/// How far below its level a pair that starts touching is met [m], <= 0: see start_sink() in tolerances.h. A
/// function of the two motions alone.
double sink_at_start(const Mover& a, const Mover& b, const SearchLimits& limits, SearchScratch& scratch);

}  // namespace brink
