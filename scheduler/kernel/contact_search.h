#pragma once
/// Who meets whom, and when: searches of one pair on the motions that its owners have, or had.

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "brink/core/contacts/contact.h"
#include "brink/scheduler/events/agenda.h"
#include "brink/scheduler/first_contact/closed_forms.h"
#include "brink/scheduler/first_contact/first_contact.h"
#include "brink/scheduler/first_contact/straight_wall.h"
#include "brink/scheduler/kernel/search_ahead.h"
#include "brink/scheduler/kernel/stage_clock.h"
#include "brink/scheduler/kernel/trajectories.h"

namespace brink {

/// Whether owners a and b (bodies first, then sites) may meet at all.
using PairFilter = std::function<bool(int a, int b)>;

/// A search that stops, undecided, after so many of its steps (0: as many as it takes), or where it is clear up to `until` [s]:
/// to go on later, if it then still matters. Before `needed_until` [s] it will be gone on with in any case, and stops less
/// soon.
struct Instalment {
  int most_steps = 0;
  double needed_until = -std::numeric_limits<double>::infinity();
  double until = std::numeric_limits<double>::infinity();
};

class ContactSearch {
 public:
  /// Makes a site index of each distinct outline. What is given must outlive it.
  /// @throws IoError if a field is needed and no GL context opens.
  ContactSearch(const World& world, const SolverOptions& options, const Trajectories& trajectories,
                RunControl& run);

  const SearchLimits& limits() const { return limits_; }
  /// True if a sharp corner or end of somebody may meet a wire without thickness of another: nobody may be
  /// moved past a contact, not even by the rounding of an instant.
  bool points_meet_wires() const { return points_meet_wires_; }
  /// Owners count bodies first, then sites.
  const Outline& outline_of(int owner) const { return *outlines_[owner]; }
  /// Starts to fetch what a search of the body reads.
  void expect(int k) const {
    prefetch(&outlines_[k]);
    prefetch(&indices_of_[k]);
  }

  // -- pairs --
  /// From now on owners whom it says no to never meet. It is asked with a < b.
  void set_filter(PairFilter filter);
  bool may_meet(int a, int b) const { return !filter_ || filter_(std::min(a, b), std::max(a, b)); }
  /// From now on, until search_again(), searches of the pair find nothing: somebody else keeps its gap.
  void leave_out(const PairKey& pair) { left_out_.insert(pair); }
  void search_again(const PairKey& pair) { left_out_.erase(pair); }
  bool is_left_out(const PairKey& pair) const { return !left_out_.empty() && left_out_.count(pair) > 0; }
  /// The pair of owner a with that image of owner b; nothing if they are one, two sites, or never meet.
  std::optional<PairKey> pair_of(int a, int b, const Image& image = {}) const;
  int other_owner(const PairKey& pair) const {
    return pair.with_site() ? trajectories_->body_count() + pair.other_site : pair.other_body;
  }
  bool is_on_fixed_site(const PairKey& pair) const {
    return pair.with_site() && !trajectories_->site(pair.other_site).moves();
  }
  /// From the other owner to its image [m].
  Vec2 shift_of(const PairKey& pair) const { return world_->periods.shift(pair.image); }
  /// True of a plane that repeats.
  bool repeats() const { return world_->periods.any(); }
  /// The state at t of the pair's other owner, where its image is.
  ExtendedState other_state(const PairKey& pair, double t) const;
  /// "'a' on 'b'".
  std::string name_of(const PairKey& pair) const;
  /// An owner on its newest motion.
  Mover mover(int owner) const;

  // -- searches --
  /// The certificate of a contact or of an undecided end, or nothing if clear to the end, on the motions of
  /// `body` and `other` (null: a site).
  std::optional<Certificate> search(const PairKey& pair, const BodyTrack& body, const BodyTrack* other,
                                    double from, double to, const Instalment& instalment = {});
  /// From now on searches that are expected may be made by these, who must end before this does; null: by nobody.
  void let_help(Helpers* helpers);
  /// That search will be asked for soon, of the newest motions. True if somebody may begin it meanwhile.
  bool expect_search(const PairKey& pair, double from, double to, int most_steps);
  /// The contact of two plain discs on their newest motions, as search() tells it; false: none that is told here,
  /// ask search(). @pre in free flight, and not left_out().
  bool search_discs(const PairKey& pair, double radius, double other_radius, double from, double to,
                    DiscContact& contact);
  /// All of that contact.
  FeatureContact contact_of_discs(const PairKey& pair, double radius, double other_radius, double time);
  /// The same of a plain disc and a site. @pre where it is, not an image.
  bool search_wall(const PairKey& pair, double radius, double from, double to, WallContact& contact);
  FeatureContact contact_with_wall(const PairKey& pair, const WallContact& contact);
  bool is_straight_wall(int site) const { return walls_[site].has_value(); }
  /// When such a disc can touch the wall at the soonest, or sooner [s]; infinity: never.
  double soonest_at_wall(int body, double radius, int site) const {
    const BodyTrack& disc = trajectories_->body(body);
    return brink::soonest_at_wall({&disc.motion, radius, disc.velocity_rounding}, *walls_[site], limits_);
  }
  /// True if everybody may meet everybody.
  bool is_unfiltered() const { return !filter_; }
  /// Other features of that pair that touch and approach at the certificate's time, each as one of its own.
  std::vector<Certificate> simultaneous(const Certificate& c, const BodyTrack& body, const BodyTrack* other);
  /// Contacts of the newest motions at time t with gap <= `tolerance`, deepest first.
  std::vector<FeatureContact> touching(const PairKey& pair, double tolerance, double t);
  /// The least signed gap at time t [m], or `at_most` where it is more.
  double gap(const PairKey& pair, double t, double at_most = std::numeric_limits<double>::infinity());
  /// Where the outlines cross at time t, by intersections of their boundaries; `gap`: what samples say of them [m].
  std::optional<Contact> crossing(const PairKey& pair, double t, double gap) const;

 private:
  /// The two sides of a pair, the second where its image is.
  struct Sides;
  void take_outlines(const std::vector<std::shared_ptr<const Outline>>& of_sites);
  Mover mover(int owner, const BodyTrack& track) const {
    return {indices_of_[owner], &track.motion, track.velocity_rounding, track.component == BodyTrack::kHeld};
  }

  const World* world_;
  const Trajectories* trajectories_;
  RunControl* run_;
  SearchLimits limits_;
  bool points_meet_wires_ = false;
  std::vector<const Outline*> outlines_;  ///< of every owner
  std::vector<const SiteIndex*> indices_of_;
  std::vector<std::optional<StraightWall>> walls_;  ///< of every site
  std::vector<std::unique_ptr<SiteIndex>> indices_;
  std::vector<std::shared_ptr<const Outline>> of_sites_;
  FieldOptions field_;
  bool share_fields_;
  SearchScratch scratch_;
  std::unique_ptr<SearchAhead> ahead_;  ///< null: nobody helps
  PairFilter filter_;
  std::set<PairKey> left_out_;
  unsigned timed_ = 0;  ///< searches, for one in some of them
};

/// The contact of a pair as it is told to the world.
Contact world_contact(const PairKey& pair, const FeatureContact& f);

}  // namespace brink
