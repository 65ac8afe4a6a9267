#pragma once
/// Endings that a one-at-a-time scheduler cannot pass: bounces that shrink to nothing, and groups that never
/// finish.

#include <cstdint>
#include <limits>
#include <map>
#include <optional>

#include "brink/scheduler/events/agenda.h"

namespace brink {

/// Bounces of one pair whose flights no longer rise above the contact tolerance.
struct ZenoEnding {
  PairKey pair;
  double limit_time = 0.0;    ///< sum of the geometric series of intervals [s]
  std::uint64_t bounces = 0;  ///< collisions of these features so far
};

/// The limit of a series of bounces by a closed form [s], 0 where there is none, and its own rounding [s].
struct ForeseenLimit {
  double time = 0.0, rounding = 0.0;
};

/// What a collision takes of the approach: where it takes nothing, no series of bounces has an end.
enum class BounceLoss { none, some, all };

/// Watches the collisions of every pair of features. Two features are at their Zeno ending after ten low
/// flights, of which each counts that is longer than no time at all, rose less than the contact tolerance
/// (closing speed * duration / 4 on a parabola), and either
///   - was shorter than all of the run before it, and ended slower as it was shorter: a series that shrinks. (In a slot hardly
///     wider than the body flights are as low, but they grow as the speed goes; and between two that close in on it they
///     shrink, but as fast as ever), or
///   - follows a collision that left nothing of the approach, or came back though neither body met anything
///     else, in no longer time than the last, or met below its level: the two are pressed together.
/// A flight that is not low begins the run anew.
class ZenoWatch {
 public:
  /// A sample of one outline and a site of the other.
  struct Feature {
    PairKey pair;
    int site = -1, sample = -1;
    bool sample_on_a = true;

    Feature() = default;
    Feature(const PairKey& p, const FeatureContact& f)
        : pair(p), site(f.site), sample(f.sample), sample_on_a(f.sample_on_a) {}
    auto order() const { return std::tuple(pair.order(), site, sample, sample_on_a); }
    bool operator<(const Feature& f) const { return order() < f.order(); }
  };
  struct Bounce {
    double last_time = 0.0;
    double last_interval = 0.0;
    double last_closing = 0.0;                                  ///< [m/s]
    double shortest = std::numeric_limits<double>::infinity();  ///< of this run of low flights [s]
    /// Foreseen by the first of the run that shrank, where intervals are still far above rounding; 0: none.
    double limit_time = 0.0;
    /// Foreseen by a closed form, at the earliest collision since which each has foreseen the same [s]; 0: none.
    double foreseen = 0.0;
    std::uint64_t low_flights = 0;  ///< of this run, those that count
    std::uint64_t count = 0;
  };
  using Bounces = std::map<Feature, Bounce>;

  explicit ZenoWatch(double contact_tolerance = 1e-10) : tolerance_(contact_tolerance) {}

  /// To be told of every collision, in order. `since_last`: a time that the pair's flight has lasted at least [s]
  /// (since either side was last resolved): flights that rise a million tolerances are not remembered, which
  /// keeps a gas out of the memory. ZenoEnding::bounces counts the remembered ones.
  /// `sunk`: the features met below their level, so are pressed together (FeatureContact::sunk).
  /// `foreseen`: high flights foresee the limit best, since it takes a low one long to fall by a rounding of
  /// the gap.
  /// `rounding`: of the pair's gaps [m]. A series that shrinks is at its end before a flight that rises to no more than some of it:
  /// when that ends is told by roundings.
  std::optional<ZenoEnding> collided(const Feature& feature, double time, double closing_speed,
                                     BounceLoss loss, double since_last = 0.0, bool sunk = false,
                                     const ForeseenLimit& foreseen = {}, double rounding = 0.0);

  /// True of a flight that rises so high that collided() does not remember it.
  static bool is_high(double closing_speed, double since_last, double contact_tolerance);

  const Bounces& bounces() const { return bounces_; }
  void restore(Bounces bounces) { bounces_ = std::move(bounces); }

 private:
  double tolerance_;
  Bounces bounces_;
};

}  // namespace brink
