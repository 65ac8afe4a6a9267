#pragma once
/// What a collision does to the motions of those whom it concerns.

#include <optional>
#include <utility>
#include <vector>

#include "brink/core/contacts/impulse.h"
#include "brink/scheduler/kernel/certificate_watch.h"
#include "brink/scheduler/kernel/contact_search.h"
#include "brink/scheduler/kernel/near_pairs.h"
#include "brink/scheduler/kernel/speculation.h"
#include "brink/scheduler/resolve/disc_rebound.h"
#include "brink/scheduler/resolve/extended_contact.h"
#include "brink/scheduler/resolve/pair_materials.h"
#include "brink/scheduler/resolve/zeno.h"

namespace brink {

class CollisionResponse {
 public:
  /// What is given must outlive it.
  CollisionResponse(const World& world, const SolverOptions& options, Trajectories& trajectories,
                    ContactSearch& search, const NearPairs& near, CertificateWatch& watch, RunControl& run);

  /// One collision at the present time: the law's impulse, and motions that begin anew with it. Bodies whose
  /// motion changed are appended to `changed`. Nothing on a halt: neither side can move, or the watch has
  /// seen what must not be.
  std::optional<Outcome> collide(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed);

  /// True if what comes of it depends on where other bodies are now: a push out of each other must lead past no wire.
  bool asks_others(const FeatureContact& found) const {
    const bool any = !wires_.empty() && wires_.front() < trajectories_->body_count();
    return any && !found.seen && found.sunk() > 0.0 && !(found.nominal() > 0.0);
  }

  // -- two plain discs --
  /// A centred disc of which nothing is locked, where no law but that of impulses is asked for.
  bool is_plain_disc(int body) const { return plain_[body].inverse_mass > 0.0; }
  double radius_of_plain_disc(int body) const { return plain_[body].radius; }
  /// collide() of two plain discs in free flight that started clear of each other, to the bit, where nobody is to be
  /// told what comes of it. False, and nothing has changed, where that is not sure: ask collide(). May halt.
  bool collide_discs(const PairKey& pair, const DiscContact& found);
  /// A straight wall that stands still, where discs are plain.
  bool is_plain_wall(int site) const { return !plain_walls_.empty() && plain_walls_[site].is_plain; }
  /// The same of a plain disc and such a wall.
  bool collide_with_wall(const PairKey& pair, const WallContact& found);
  /// Starts to fetch what that reads of a body beside its motion.
  void expect(int body) const { prefetch(&plain_[body]); }

  // -- what collisions of single pairs and of groups share --
  const Material& material_of(const PairKey& pair);
  /// What a collision of the pair takes of the approach.
  BounceLoss loss_of(const PairKey& pair);
  /// What gaps of the pair are rounded by where they touch, by the numbers that their outlines are made of [m].
  double gap_rounding(const PairKey& pair) const;
  /// From the clock's present double to the exact moment of contact: a fraction of a rounding [s]. The
  /// collision is resolved there, and the new motion is the one that passes through that moment, so that long
  /// runs do not drift by roundings of time. None where sharp points may meet wires without thickness: there
  /// a motion must not begin, not even by such a fraction, beside the path on which everybody is tested.
  Real delay_to_contact(const FeatureContact& found, const ExtendedContact& c) const;
  /// The ways by which a body and what it met are pushed apart if they have sunk into each other [m]: each
  /// side as an impulse along the normal n would move its centre.
  std::pair<RealVec, RealVec> push_apart(const PairKey& pair, const FeatureContact& found, const RealVec& n);
  /// Notes that a body has been resolved now, with owner `partner`, by speeds up to `magnitude`; returns the
  /// time since its last [s].
  double note_resolve(int body, int partner, double magnitude);

 private:
  struct Change;
  struct PlainDisc {            ///< what is asked of the world's body, in little memory
    double inverse_mass = 0.0;  ///< [1/kg]; 0: it is none
    double radius = 0.0;        ///< [m]
    int material = -1;
  };
  struct PlainWall {
    bool is_plain = false;
    WallSide side;  ///< its normal is the last disc's
    int material = -1;
  };
  Change change(const PairKey& pair, const FeatureContact& found, const Material& material);
  PlainDisc plain_disc(int body) const;
  PlainWall plain_wall(int site) const;
  bool may_rebound_plainly(const Material& material, const DiscContact& found, double last) const;
  bool has_flown(int body, const Motion& motion);
  DiscSide free_disc(int body) const;
  std::optional<DiscRebound> disc_rebound(const PairKey& pair, const FeatureContact& found,
                                          const Material& material);
  std::optional<DiscRebound> wall_rebound(const PairKey& pair, const FeatureContact& found,
                                          const Material& material);
  std::optional<Outcome> part(const PairKey& pair, const FeatureContact& found, const Material& material,
                              const DiscRebound& discs, std::vector<int>& changed);
  void note_sides(Outcome& outcome) const;
  void deflect(const PairKey& pair, const Change& change, std::vector<int>& changed);
  double part_of_push(int body, const RealVec& way, bool solids);
  double room_before_wire(int body, const RealVec& way);
  ForeseenLimit foresee(const PairKey& pair, const FeatureContact& found, double e, Real delay);

  const World* world_;
  Trajectories* trajectories_;
  ContactSearch* search_;
  const NearPairs* near_;
  CertificateWatch* watch_;
  RunControl* run_;
  bool reflects_;  ///< response "reflection"
  PairMaterials materials_;
  LargeVector<PlainDisc> plain_;        ///< of every body
  std::vector<PlainWall> plain_walls_;  ///< of every site; empty: nobody asks
  DiscRebound after_;                   ///< of the last plain discs
  std::vector<int> wires_;              ///< owners that have a wire without thickness
};

}  // namespace brink
