#pragma once
/// When the watch looks at all pairs between frames.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "brink/core/base/limits.h"
#include "brink/scheduler/run/run_options.h"

namespace brink {

/// Looks at multiples of an interval of the run, of which as many are left out as the run is too short for: a look costs
/// about as much as a collision for each owner, and all of them may cost a hundredth of the collisions. Which are left out
/// depends on time and collisions alone, so that every policy, and a run that goes on, looks at the same times.
class LookClock {
 public:
  /// From time t on [s]. None where frames come as often.
  void begin(const RunOptions& options, int owners, double t) {
    interval_ = options.look_interval > 0.0 ? options.look_interval : options.until / RunOptions::kLooks;
    owners_ = static_cast<double>(std::max(owners, 1));
    const bool frames_do = options.frame_interval > 0.0 && options.frame_interval <= interval_;
    if (frames_do || !(interval_ > 0.0) || t / interval_ >= 0x1p53) {
      next_ = kForever;
      return;
    }
    look_ = static_cast<std::uint64_t>(t / interval_);
    wind();
  }

  /// The next look that is due up to t [s], which is told once, after so many collisions.
  std::optional<double> due(double t, std::uint64_t collisions) {
    while (next_ <= t) {
      const double at = next_;
      const std::uint64_t look = look_, every = every_so_many(look, collisions);
      // those in between are left out; later ones may be worth while after more collisions
      look_ = look % every == 0 ? look : std::min((look / every + 1) * every - 1, multiple_at(t));
      wind();
      if (look % every == 0) return at;
    }
    return std::nullopt;
  }

 private:
  /// Looks at one owner: in any run, and for each collision.
  static constexpr double kOwnersAtLeast = 4096.0, kOwnersOfCollision = 1.0 / 64.0;

  /// A power of two, so that those of fewer looks are among those of more.
  std::uint64_t every_so_many(std::uint64_t look, std::uint64_t collisions) const {
    const double looks = (kOwnersAtLeast + kOwnersOfCollision * static_cast<double>(collisions)) / owners_;
    return std::bit_ceil(
        static_cast<std::uint64_t>(std::min(std::ceil(static_cast<double>(look) / looks), 0x1p62)));
  }
  /// The number of the last multiple up to t, or about there.
  std::uint64_t multiple_at(double t) const {
    return std::max(look_, static_cast<std::uint64_t>(std::min(t / interval_, 0x1p53)));
  }
  void wind() { next_ = static_cast<double>(++look_) * interval_; }

  double interval_ = 0.0, owners_ = 1.0;
  std::uint64_t look_ = 0;  ///< the number of the next
  double next_ = kForever;  ///< when that is due [s]
};

}  // namespace brink
