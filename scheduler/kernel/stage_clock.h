#pragma once
/// Wall-clock seconds of a stage, added to a counter at the end of a scope.

#include <chrono>

namespace brink {

class StageClock {
 public:
  explicit StageClock(double& seconds) : seconds_(seconds), begin_(std::chrono::steady_clock::now()) {}
  ~StageClock() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point begin_;
};

}  // namespace brink
