#pragma once
/// The motion of a fixed site: still, a constant twist, or formulas in time.

#include <memory>
#include <string>

#include "brink/core/world/world.h"
#include "brink/integrators/motion.h"

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
  /// Covers [0, t]. Empty, or why it cannot.
  std::string extend(double t);

 private:
  Motion motion_;
  bool moves_ = false;
  std::unique_ptr<PrescribedMotion> prescribed_;
};

}  // namespace brink
