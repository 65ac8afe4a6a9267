#pragma once
/// The watch over what searches have certified: overlaps and sides of the pairs just resolved, all pairs at
/// frames and looks between them (LookClock), ways through wires. What it sees ends the run. Cost: below 1 % for collisions; for frames a pose of every
/// owner and a look at who is near another (FramePairs).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "brink/core/base/large_vector.h"
#include "brink/scheduler/kernel/frame_pairs.h"
#include "brink/scheduler/kernel/island.h"
#include "brink/scheduler/kernel/thin_walls.h"

namespace brink {

/// bool: false if the run was ended.
class CertificateWatch {
 public:
  /// What is given must outlive it.
  CertificateWatch(const World& world, const Trajectories& trajectories, ContactSearch& search,
                   const NearPairs& near, RunControl& run);

  /// From now on what is seen ends the run. Before, and under a policy that may miss contacts, overlaps are
  /// measured alone.
  void begin();
  /// Who is let through whom may be another: all pairs are to be seen at the next frame.
  void look_again() { pairs_.clear(); }
  /// The deepest overlap at any event or frame so far [m].
  double max_overlap() const { return max_overlap_; }
  void note_overlap(double gap) { max_overlap_ = std::max(max_overlap_, -gap); }
  /// Overlaps at the present time, deepest first; the search for them ends after so many.
  std::vector<Contact> overlaps(std::size_t most);
  /// Empty, or which pair overlaps by more than a file's rounding at the present time, where the run starts.
  std::string start_fault();

  /// Before body k is resolved, or shown, at time `to`: did its centre fly through a wire?
  bool flight(int k, double to);
  /// False unless such a flight from `from` to `to` [m] is sure to have met no wire: else flight() must look.
  bool is_clear_flight(int k, const Vec2& from, const Vec2& to) const {
    if (!on_ || walls_.empty()) return true;
    // without a branch: all of it is as good as always true
    const Box& box = clear_[k];
    const double left = std::min(from.x(), to.x()), right = std::max(from.x(), to.x());
    const double bottom = std::min(from.y(), to.y()), top = std::max(from.y(), to.y());
    const bool is_left = left >= box.low.x(), is_right = right <= box.high.x();
    const bool is_low = bottom >= box.low.y(), is_high = top <= box.high.y();
    return is_left & is_right & is_low & is_high;
  }
  /// That of all bodies. Nobody will be asked for a time before `to` by the watch any more.
  void flights(double to);
  /// Starts to fetch what that reads of the body.
  void expect(int k) const {
    if (!clear_.empty()) prefetch(&clear_[k]);
  }
  /// A contact that closes at that speed [m/s], `rounding` being what speeds are wrong by: does it approach?
  bool approaches(const PairKey& pair, double closing_speed, double rounding);
  /// The moment of contact as the response saw it: where both were, the other where its image is, and their gap [m].
  struct Moment {
    ExtendedState body, other;
    Real gap = 0;
  };
  /// After a collision at `delay` [s] from the present time. Where the new motions lead through the places of `moment`,
  /// to so little that its gap tells that nothing is deeper than what was seen before, no features are looked at again.
  bool resolved(const PairKey& pair, const FeatureContact& found, Real delay, const Moment* moment = nullptr);
  /// The same of two discs, whose gap is known.
  bool discs_resolved(const PairKey& pair, double gap);
  /// At a collision of a pair of which one has wires without thickness: the pair that each of the two met before is looked at,
  /// whether they cross by now, and this one will be when one of the two meets somebody else. No frame need see it.
  bool collided(const PairKey& pair);
  /// Where an island begins a step: whether two of its contacts' owners cross by now, as a wire that has gone through another does.
  bool step_begins(const std::vector<HeldContact>& contacts);
  /// Every pair at a frame; not those that cannot have come to overlap since the last.
  void frame(double t);

  /// What is kept of it in a snapshot.
  struct Saved {
    double max_overlap = 0.0, start_overlap = 0.0, flown_until = 0.0;
  };
  Saved saved() const { return {max_overlap_, start_overlap_, flown_until_}; }
  void restore(const Saved& saved) {
    max_overlap_ = saved.max_overlap;
    start_overlap_ = saved.start_overlap;
    pairs_.clear();
    met_last_.clear();
    flown_until_ = saved.flown_until;
  }

 private:
  void make_walls();
  /// The deepest overlap that is none [m]: the contact tolerance, on top of what the world started with.
  double allowed() const { return search_->limits().tolerance + start_overlap_; }
  bool is_nothing_new(double at_least) const;
  double pair_at_frame(const PairKey& pair, double t, double at_most);
  bool do_not_cross(const PairKey& pair);
  bool report(const PairKey& pair, double depth, double t, const char* what);

  const World* world_;
  const Trajectories* trajectories_;
  ContactSearch* search_;
  const NearPairs* near_;
  RunControl* run_;
  FramePairs pairs_;
  bool on_ = false;
  bool walls_made_ = false;
  ThinWalls walls_;                               ///< of still sites
  std::vector<bool> material_centre_;             ///< of bodies whose centre of mass is in them
  LargeVector<Box> clear_;                        ///< about each body, of walls
  std::vector<std::optional<PairKey>> met_last_;  ///< by body, see collided()
  double flown_until_ = 0.0;                      ///< flights before were looked at, at the last frame [s]
  double start_overlap_ = 0.0;                    ///< deepest overlap that the world started with [m]
  double max_overlap_ = 0.0;
};

}  // namespace brink
