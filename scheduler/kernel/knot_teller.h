#pragma once
/// Tells how held bodies move, by knots between which a cubic is off by no more than was asked for.

#include <functional>

#include "brink/integrators/motion.h"
#include "brink/scheduler/run/knot.h"

namespace brink {

class KnotTeller {
 public:
  using Tell = std::function<void(const Knot&)>;

  /// Tells nobody.
  KnotTeller() = default;
  /// `tolerance`: what the cubic may be off in place [m], > 0.
  KnotTeller(Tell tell, double tolerance) : tell_(std::move(tell)), tolerance_(tolerance) {}

  /// Somebody is told.
  explicit operator bool() const { return static_cast<bool>(tell_); }
  /// Body k, which has come by `before`, moves on from `after` now.
  void begins_anew(int k, double now, const Motion& before, const BodyState& after) const;
  /// Knots within a motion of dense pieces, before `now`; other motions have none. `radius`: of the body's outline [m].
  void bends(int k, double now, const Motion& motion, double radius) const;

 private:
  Tell tell_;
  double tolerance_ = 0.0;
};

}  // namespace brink
