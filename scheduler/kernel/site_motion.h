#pragma once
/// The motion of a fixed site: still, a constant twist, or formulas in time.

#include <memory>
#include <string>

#include "brink/core/world/world.h"
#include "brink/integrators/integrator.h"

namespace brink {

class PrescribedMotion;

/// Extends a site's motion as far as it is asked; the site is never resolved, so its motion depends on time
/// alone.
class SiteMotion {
 public:
  explicit SiteMotion(const FixedSite& site);
  ~SiteMotion();
  SiteMotion(SiteMotion&&) noexcept;

  const Motion& motion() const { return motion_; }
  /// True if it moves at all.
  bool moves() const { return moves_; }
  /// True if it is given by formulas: its motion is made as it is asked for. All others reach for ever.
  bool is_prescribed() const { return prescribed_ != nullptr; }
  /// Goes on towards t by `most_cells` cells of the fit at most.
  Extent extend(double t, std::uint64_t most_cells = std::numeric_limits<std::uint64_t>::max());
  /// When a step from t to `until` at most must end, so that it is not much longer than the pieces of the motion that it leads
  /// over [s]: a corner of a formula is a piece of next to no width, and what is as quick as a step takes is several narrow ones.
  double even_until(double t, double until) const;
  /// True if its motion has failed because nothing bounds a formula, which may be continuous.
  bool lacks_bounds() const;
  /// Nobody will ask for a time before t any more.
  void forget_before(double t);

 private:
  Motion motion_;
  bool moves_ = false;
  std::unique_ptr<PrescribedMotion> prescribed_;
};

/// Where a fixed site is told to be at time t: its formulas themselves, without a motion made of them (within
/// rounding the same place, at the cost of one evaluation). May be inf or NaN where a formula is.
Pose told_pose(const FixedSite& site, double t);

}  // namespace brink
