#pragma once
/// What an island is made of: bodies joined by contacts that last.

#include <algorithm>
#include <iterator>
#include <limits>
#include <tuple>
#include <vector>

#include "brink/scheduler/events/agenda.h"
#include "brink/scheduler/islands/modes/mode_problem.h"
#include "brink/scheduler/islands/near_features.h"
#include "brink/scheduler/run/lasted_contact.h"

namespace brink {

/// Names a contact: pair, side, sample, site.
using ContactKey = std::tuple<PairKey, bool, int, int>;

/// A contact of an island, at the start of its step.
struct HeldContact {
  PairKey pair;
  NearFeature feature;
  double normal_force = 0.0, tangential_force = 0.0;  ///< [N]
  double rolling_torque = 0.0;                        ///< on the body [N m]
  double lasted = 0.0;                                ///< the step over which they are means [s]
  ContactMode mode = ContactMode::none;
  double since = 0.0;         ///< in this mode without a break [s]
  Vec2 place = Vec2::Zero();  ///< of the feature's point in the world [m]
  /// Of a step by modes: what it does in the step, and from its end on if nothing comes between.
  bool by_modes = false;
  MotionMode motion = MotionMode::open, next_motion = MotionMode::open;

  auto order() const { return std::tuple(pair.order(), feature.sample_on_a, feature.sample, feature.site); }
  ContactKey key() const { return {pair, feature.sample_on_a, feature.sample, feature.site}; }
};

inline bool in_order(const HeldContact& a, const HeldContact& b) { return a.order() < b.order(); }

/// What is known of contacts from the step before, in order.
class WarmContacts {
  template <class Known>
  static auto* find_in(Known& known, const HeldContact& c) {
    const auto found = std::lower_bound(known.begin(), known.end(), c, in_order);
    return found == known.end() || in_order(c, *found) ? nullptr : &*found;
  }

 public:
  /// Those of one more island. @pre they are in order, and none is known yet
  void add(const std::vector<HeldContact>& contacts) {
    const auto before = static_cast<std::ptrdiff_t>(known_.size());
    known_.insert(known_.end(), contacts.begin(), contacts.end());
    std::inplace_merge(known_.begin(), known_.begin() + before, known_.end(), in_order);
  }
  /// The contact of the same features; none: nullptr.
  const HeldContact* find(const HeldContact& c) const { return find_in(known_, c); }
  HeldContact* find(const HeldContact& c) { return find_in(known_, c); }
  bool empty() const { return known_.empty(); }
  void clear() { known_.clear(); }
  auto begin() const { return known_.begin(); }
  auto end() const { return known_.end(); }

 private:
  std::vector<HeldContact> known_;
};

/// How an island came on in the steps that it took last.
struct IslandPace {
  int hasty = 0;      ///< owed for steps by modes that hardly led on
  int agitation = 0;  ///< raised by a step that an impact cuts short, lowered by one in which there is none
  double step =
      std::numeric_limits<double>::infinity();  ///< the last, where forces that change bounded it [s]
  int waits = 0;                                ///< steps until it is asked again who of it stands
  int in_vain = 0;                              ///< how often nobody did, in a row

  /// Of islands that go on as one.
  void join(const IslandPace& other) {
    hasty = std::max(hasty, other.hasty);
    agitation = std::max(agitation, other.agitation);
    step = std::min(step, other.step);
    waits = std::max(waits, other.waits);
    in_vain = std::max(in_vain, other.in_vain);
  }
};

struct Island {
  std::vector<int> members;           ///< ascending
  std::vector<HeldContact> contacts;  ///< in order
  bool rests = false;
  /// Of one at rest: the contacts in which bodies that move lean on it, or are near it, in order. Their islands have them, too.
  std::vector<HeldContact> leaning;
  IslandPace pace;
  double due = std::numeric_limits<double>::infinity();  ///< when its step ends [s]
  /// The contact whose bounces come to their limit where the step ends; body < 0: none.
  double then = std::numeric_limits<double>::infinity();  ///< of one at rest: `due` after that [s]
  PairKey series;
  FeatureContact series_contact;
};

/// Of these those that press.
inline std::vector<HeldContact> pressing(const std::vector<HeldContact>& contacts) {
  std::vector<HeldContact> pressed;
  std::copy_if(contacts.begin(), contacts.end(), std::back_inserter(pressed),
               [](const HeldContact& c) { return c.mode != ContactMode::none; });
  return pressed;
}

inline bool has(const Island& island, int body) {
  return std::binary_search(island.members.begin(), island.members.end(), body);
}

/// Of the two of a contact that leans on the island the one who is not of it.
inline int who_leans(const Island& island, const HeldContact& c) {
  return has(island, c.pair.body) ? c.pair.other_body : c.pair.body;
}

/// What islands came to.
struct IslandTally {
  std::uint64_t captured = 0, steps = 0, by_modes = 0, slept = 0, woken = 0, factorisations = 0;
  std::uint64_t small_by_steps = 0;  ///< of order 1, though there were few enough contacts for modes
  double absorbed = 0.0;             ///< the largest approach that a step took without a rebound [m/s]
  double energy_won = 0.0;           ///< that steps made, by rounding and by faces that turn [J]
  double energy_of_rest = 0.0;       ///< that the option rest_speed took [J]
  double friction_residual = 0.0;    ///< the largest, of the largest force of its island
};

}  // namespace brink
