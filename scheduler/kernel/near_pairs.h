#pragma once
/// Who can meet whom during a time: by moving bounds, or by rendered passes.

#include <functional>
#include <memory>
#include <vector>

#include "brink/core/fields/pass_window.h"
#include "brink/scheduler/kernel/contact_search.h"

namespace brink {

/// @throws BadInput where NearPairs::all() would be every pair, and there are too many to keep.
void check_all_pairs(const World& world, const SolverOptions& options);

class NearPairs {
 public:
  /// @throws IoError where detector "pass" opens no GL context. What is given must outlive it.
  NearPairs(const World& world, const SolverOptions& options, const Trajectories& trajectories,
            const ContactSearch& search, RunControl& run);

  /// True if pairs are found by rendered passes (detector "pass").
  bool by_passes() const { return passes_ != nullptr; }
  /// Pairs whose moving bounds meet during [from, to]; every pair, where the broad phase is off.
  std::vector<PairKey> all(double from, double to);
  /// Pairs of one body with everything else, `to` being the end of the last all(). `several_motions`: bodies
  /// have motions ahead of what is certain, whose bounds count together.
  std::vector<PairKey> of(int body, double from, double to, bool several_motions);
  /// Calls visit for each pair whose boxes at t overlap, until it returns false.
  void each_at(double t, const std::function<bool(const PairKey&)>& visit) const;
  /// The same of owners at these poses, their boxes `grown` to all sides [m].
  void each_among(const std::vector<Pose>& poses, const std::function<bool(const PairKey&)>& visit,
                  double grown = 0.0) const;
  /// What holds an owner at t; a still site's own box, not a disc's: it may lie far from its frame's origin.
  Box box_at(int owner, double t) const;
  /// Calls visit for each image of an owner, in that box, that may touch what is in the other box.
  template <class Visit>
  void each_image_near(const Box& other, int owner, const Box& box, Visit&& visit) const {
    // its solid part is everywhere outside: no box tells that it is not near
    if (search_->outline_of(owner).container) return visit(Image{});
    world_->periods.overlaps(other, box, visit);
  }

 private:
  void box_all(double from, double to);
  void box_changed(double to, bool several_motions);
  void add_images(int a, int b, std::vector<PairKey>& pairs) const;
  std::vector<PairKey> by_pass(int body, double from, double to);

  const World* world_;
  const Trajectories* trajectories_;
  const ContactSearch* search_;
  RunControl* run_;
  bool by_bounds_;                       ///< option broad_phase
  std::vector<Box> still_boxes_;         ///< of every site where it stands; empty if it moves
  std::vector<Box> boxes_;               ///< moving bounds of every owner over the present horizon
  double boxes_from_ = 0.0;              ///< where that horizon began [s]
  std::vector<std::uint64_t> versions_;  ///< of the bodies, when their box was made
  std::unique_ptr<PassRenderer> passes_;
};

}  // namespace brink
