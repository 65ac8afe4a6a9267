#pragma once
/// Where a scheduler of single collisions comes to an end: bounces that shrink to nothing, groups of
/// collisions that never finish, and the limit of the option max_collisions. Endings are told, not carried
/// out: whoever asks may stop there, or take over.

#include <optional>

#include "brink/scheduler/kernel/speculation.h"
#include "brink/scheduler/resolve/instant_bodies.h"
#include "brink/scheduler/resolve/zeno.h"

namespace brink {

/// What a collision was the end of.
struct Ending {
  enum class Kind {
    zeno,           ///< of bounces: `time` is their limit
    group,          ///< the next collisions of this instant are to be taken together
    endless_group,  ///< taken together, they go on all the same; or time hardly goes on between them
  };
  Kind kind = Kind::zeno;
  double time = 0.0;        ///< [s]
  std::uint64_t count = 0;  ///< bounces, or collisions of the group
};

class Endings {
 public:
  Endings(double contact_tolerance, std::uint64_t max_collisions)
      : zeno_(contact_tolerance), max_collisions_(max_collisions) {}

  /// To be told of every collision at the present time, in order. One that a picture shows is in no
  /// series of bounces: flights lower than a pixel say nothing about a limit.
  std::optional<Ending> collided(const Outcome& outcome, double now, BounceLoss loss, double rounding = 0.0);
  /// True of an instant in which another collision is nothing unusual.
  bool is_plain(double now) const;
  /// collided() of one that is in no series of bounces (ZenoWatch), in such an instant: nothing ends.
  void collided_plainly(const PairKey& pair, double now) { count_in_instant(pair, now); }
  /// True at so many collisions in all, or more, as set_limit() said.
  bool at_limit(std::uint64_t collisions) const {
    return max_collisions_ > 0 && collisions >= max_collisions_;
  }
  /// 0: never.
  void set_limit(std::uint64_t collisions) { max_collisions_ = collisions; }
  /// True if the present instant has had so many collisions that they are to be taken together, or instants have hardly followed each
  /// other so often.
  bool collapsed(double now) const;
  /// True while instants hardly follow each other: any collision may be one of those that are taken together.
  bool is_crawling() const;

  struct Saved {
    double instant = -1.0;
    std::uint64_t in_instant = 0, crawling = 0;
    std::vector<int> bodies;
    bool often = false;
    ZenoWatch::Bounces bounces;
  };
  Saved saved() const {
    return {instant_, in_instant_, crawling_, bodies_.list(), bodies_.often(), zeno_.bounces()};
  }
  void restore(Saved saved);

 private:
  /// Collisions of one instant that are taken to be without end: a row of n touching bodies can need n^2 / 2.
  std::uint64_t endless() const;
  void count_in_instant(const PairKey& pair, double now);
  bool crawls(const Outcome& o, double now);
  /// One more collision that comes hardly later, or not.
  bool crawls_on(bool once_more);

  ZenoWatch zeno_;
  std::uint64_t max_collisions_;
  double instant_ = -1.0;  ///< time of the present group of collisions [s]
  std::uint64_t in_instant_ = 0;
  InstantBodies bodies_;  ///< that have collided in it
  std::uint64_t crawling_ = 0;
};

}  // namespace brink
