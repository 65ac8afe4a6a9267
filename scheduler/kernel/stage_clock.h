#pragma once
/// Wall-clock seconds of a stage, added to a counter at the end of a scope.

#include <chrono>
#include <cstdint>
#include <optional>

namespace brink {

class StageClock {
 public:
  explicit StageClock(double& seconds, double weight = 1.0)
      : seconds_(seconds), weight_(weight), begin_(std::chrono::steady_clock::now()) {}
  ~StageClock() {
    seconds_ += weight_ * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  double& seconds_;
  double weight_;
  std::chrono::steady_clock::time_point begin_;
};

/// The same for a stage so short that reading the clock would be a part of it: one scope in sixteen is timed,
/// and counts for all of them.
class SampledClock {
 public:
  class Scope {
   public:
    Scope(SampledClock& clock, double& seconds) {
      if (clock.scopes_++ % kEvery == 0) timed_.emplace(seconds, kEvery);
    }

   private:
    std::optional<StageClock> timed_;
  };

 private:
  static constexpr unsigned kEvery = 16;
  unsigned scopes_ = 0;
};

}  // namespace brink
