#pragma once
/// Endings that a one-at-a-time scheduler cannot pass: bounces that shrink to nothing, and groups that never
/// finish.

#include <cstdint>
#include <map>
#include <optional>

#include "brink/scheduler/agenda.h"

namespace brink {

/// Bounces of one pair whose flights no longer rise above the contact tolerance.
struct ZenoEnding {
  PairKey pair;
  double limit_time = 0.0;    ///< sum of the geometric series of intervals [s]
  std::uint64_t bounces = 0;  ///< collisions of the pair so far
};

/// Watches the collisions of every pair. A pair is at its Zeno ending when ten flights in a row, each longer
/// than no time at all, rose less than the contact tolerance: closing speed * duration / 4 on a parabola.
class ZenoWatch {
 public:
  explicit ZenoWatch(double contact_tolerance = 1e-10) : tolerance_(contact_tolerance) {}

  /// To be told of every collision, in order. `rest`: a time that the pair's flight has lasted at least [s]
  /// (since either side was last resolved): flights that rise a million tolerances are not remembered, which
  /// keeps a gas out of the memory. ZenoEnding::bounces counts the remembered ones.
  std::optional<ZenoEnding> collided(const PairKey& pair, double time, double closing_speed,
                                     double rest = 0.0);

  struct Bounce {
    double last_time = 0.0;
    double last_interval = 0.0;
    std::uint32_t low_flights = 0;
    double limit_time =
        0.0;  ///< foreseen at the first low flight, where intervals are still far above rounding
    std::uint64_t count = 0;
  };
  const std::map<PairKey, Bounce>& bounces() const { return bounces_; }
  void restore(std::map<PairKey, Bounce> bounces) { bounces_ = std::move(bounces); }

 private:
  static constexpr std::uint32_t kLowFlights = 10;
  static constexpr double kHighFlight = 1e6;  ///< in tolerances
  double tolerance_;
  std::map<PairKey, Bounce> bounces_;
};

}  // namespace brink
