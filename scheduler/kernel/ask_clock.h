#pragma once
/// When somebody who waits outside should be asked again whether to go on: by the wall clock. What is asked
/// never changes what happens, only whether the run is stopped.

#include <chrono>

namespace brink {

/// True ten times a second at most; a look at the clock every few calls, so that it can be asked in the
/// innermost loops (about 2 ns a call).
class AskClock {
 public:
  bool due() {
    if (++calls_ % kBetweenLooks != 0) return false;
    const auto now = Clock::now();
    if (now < next_) return false;
    next_ = now + std::chrono::milliseconds(100);
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr unsigned kBetweenLooks = 16;
  unsigned calls_ = 0;
  Clock::time_point next_ = Clock::now();
};

}  // namespace brink
