#pragma once
/// Which pairs may have come to overlap since the last frame. It is told by how far their points have gone from frame to
/// frame, from places alone: the motions in between, of which searches are made, have no part in it.

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "brink/scheduler/kernel/near_pairs.h"

namespace brink {

class FramePairs {
 public:
  /// What is given must outlive it.
  FramePairs(const World& world, const Trajectories& trajectories, const ContactSearch& search,
             const NearPairs& near, RunControl& run);

  /// Nothing is known: all pairs are to be seen at the next frame.
  void clear();

  /// The gap of two [m], or a bound below it such as `at_least`, which is known to rounding; `at_most` where it is more;
  /// nothing: no more pairs are to be seen.
  using Look = std::function<std::optional<double>(const PairKey& pair, double at_least, double at_most)>;
  /// Calls look for each pair that may overlap at t: not for two that have not moved since they were seen, nor for two
  /// that were further apart than they have come since. Cost: a pose of every owner, what is left of all near pairs,
  /// and, once somebody has gone as far as the list of these holds, NearPairs::each_at().
  void each(double t, const Look& look);

 private:
  struct Near {
    PairKey pair;
    double clear_until =
        -1.0;  ///< how far both together may have gone before they can overlap [m]; below 0: unseen
  };

  double go_to(double t);
  void list(double reach);
  void each_once(const Look& look);
  double way(const PairKey& pair) const;
  double apart(const PairKey& pair, double enough) const;
  double margin(const PairKey& pair) const;
  double rounding(const PairKey& pair) const;

  const Trajectories* trajectories_;
  const ContactSearch* search_;
  const NearPairs* near_;
  RunControl* run_;
  double length_;                 ///< of the world [m]
  std::vector<Pose> poses_;       ///< of every owner at the last frame; empty: there was none
  std::vector<double> way_;       ///< of any point of an owner at most, since the pairs were listed [m]
  std::vector<Near> near_pairs_;  ///< in order; all that can overlap while nobody has gone half of reach_
  double reach_ = -1.0;           ///< [m]; below 0: not listed
  std::vector<std::pair<PairKey, double>> close_;  ///< of one frame, each with a bound below its gap [m]
};

}  // namespace brink
