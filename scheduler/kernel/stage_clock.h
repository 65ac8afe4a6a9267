#pragma once
/// Wall-clock seconds of the stages of a run, each without those within it.

#include <chrono>

namespace brink {

/// Which stage goes on. One of every run.
class StageTimer {
 public:
  /// From here to the end of the scope is that stage's, whose seconds it adds to.
  class Scope {
   public:
    Scope(StageTimer& timer, double& seconds) : Scope(timer, seconds, 1.0) {}
    ~Scope() {
      if (weight_ == 0.0) return;
      const Time now = Clock::now();
      leave(now);
      timer_.innermost_ = outer_;
      if (outer_) outer_->begin_ = now;
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   protected:
    /// `weight`: how many like it are counted by this one; 0: it is counted by another.
    Scope(StageTimer& timer, double& seconds, double weight)
        : timer_(timer), seconds_(seconds), weight_(weight) {
      if (weight_ == 0.0) return;
      begin_ = Clock::now();
      outer_ = timer_.innermost_;
      if (outer_) outer_->leave(begin_);
      timer_.innermost_ = this;
    }

   private:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;
    void leave(Time now) { seconds_ += weight_ * std::chrono::duration<double>(now - begin_).count(); }

    StageTimer& timer_;
    double& seconds_;
    double weight_;
    Time begin_;
    Scope* outer_ = nullptr;
  };

  /// Of a stage so short that reading the clock would be a part of it one in sixty-four is timed, and counts for
  /// all. Each place has a counter of its own.
  class Sampled : public Scope {
   public:
    static constexpr unsigned kEvery = 64;
    Sampled(StageTimer& timer, double& seconds, unsigned& count)
        : Scope(timer, seconds, count++ % kEvery == 0 ? kEvery : 0.0) {}
  };

 private:
  Scope* innermost_ = nullptr;
};

}  // namespace brink
