#pragma once
/// Whether it is worth to tell helpers what is due soon: found out by doing without now and then.

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace brink {

/// Telling costs, and gains nothing where helpers get no processor, or jobs are too small. So servings are timed in rounds,
/// with and without; what takes less is done nearly always. Nothing but time depends on it: see Helpers.
class WorthTelling {
 public:
  using Clock = std::chrono::steady_clock;

  /// To be asked at each serving. True while helpers are to be told.
  bool asked() {
    if (++servings_ < kServings) return telling_;
    servings_ = 0;
    end_round(Clock::now());
    return telling_;
  }
  /// A round ends then.
  void end_round(Clock::time_point now) {
    if (timed_) note(telling_ ? with_ : without_, std::chrono::duration<double>(now - begun_).count());
    timed_ = true;
    begun_ = now;
    if (++rounds_ < kFirst)
      telling_ = !telling_;
    else
      telling_ = (with_ < without_) != (rounds_ % kBetween == 0);
  }

 private:
  static constexpr unsigned kServings = 1024;  ///< a round
  static constexpr unsigned kFirst = 8;        ///< rounds in turn
  static constexpr unsigned kBetween = 32;     ///< rounds in which one is the other way

  /// A mean in which the last counts a quarter, and none more than twice what is usual: others use the machine, too.
  static void note(double& mean, double seconds) {
    mean = mean == 0.0 ? seconds : mean + 0.25 * (std::min(seconds, 2.0 * mean) - mean);
  }

  unsigned servings_ = 0;
  unsigned rounds_ = 0;
  bool telling_ = true, timed_ = false;
  Clock::time_point begun_;
  double with_ = 0.0, without_ = 0.0;  ///< a round [s]
};

}  // namespace brink
