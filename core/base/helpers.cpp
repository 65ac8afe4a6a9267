/// A ring of pointers: the owner posts at one end, everybody takes from the other. A job that was taken back stays in the
/// ring until its turn comes and is found not to wait any more.
#include "brink/core/base/helpers.h"

#include <csignal>

#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace brink {

namespace {

constexpr int kLooks = 20000;     ///< in vain, before a helper sleeps
constexpr int kPatient = 250;     ///< looks, if a little
constexpr int kBeforeYield = 64;  ///< looks, before others may have the processor

void rest() {
#ifdef __x86_64__
  _mm_pause();
#endif
}

/// Signals are for the program's own threads: while one lives, threads that begin take none.
class NoSignals {
 public:
  NoSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~NoSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  NoSignals(const NoSignals&) = delete;
  NoSignals& operator=(const NoSignals&) = delete;

 private:
  sigset_t before_;
};

}  // namespace

Helpers::Helpers(int count) {
  const NoSignals no_signals;
  for (int k = 1; k <= count; ++k) threads_.emplace_back([this, k] { help(k); });
}

Helpers::~Helpers() {
  over_ = true;
  ++woken_;
  woken_.notify_all();
  for (std::thread& t : threads_) t.join();
}

void Helpers::post(Job& job) {
  const std::uint32_t place = posted_.load(std::memory_order_relaxed);
  while (place - taken_.load(std::memory_order_acquire) >= kPlaces) take();
  job.state_.store(Job::State::waiting, std::memory_order_release);
  jobs_[place % kPlaces].store(&job, std::memory_order_relaxed);
  posted_.store(place + 1, std::memory_order_release);
}

/// Who goes to sleep right now may be missed: the job is done by the owner then, or by the next to wake.
void Helpers::wake() {
  if (asleep_.load(std::memory_order_relaxed) == 0) return;
  ++woken_;
  woken_.notify_all();
}

Helpers::Settled Helpers::settle(Job& job, Patience patience) {
  using State = Job::State;
  // what nobody else can have is looked at without a lock: that would wait until all that was written is seen
  State state = job.state_.load(std::memory_order_acquire);
  if (state == State::waiting &&
      job.state_.compare_exchange_strong(state, State::idle, std::memory_order_acquire))
    return Settled::undone;
  if (state == State::idle) return Settled::undone;
  for (int looks = 0; job.state_.load(std::memory_order_acquire) != State::done; ++looks) {
    if (patience == Patience::none || (patience == Patience::little && looks > kPatient))
      return Settled::late;
    if (do_next(0)) continue;
    looks % kBeforeYield == kBeforeYield - 1 && patience == Patience::endless ? std::this_thread::yield()
                                                                              : rest();
  }
  job.state_.store(State::idle, std::memory_order_relaxed);
  return Settled::done;
}

/// The life of a helper.
void Helpers::help(int helper) {
  for (int looks = 0; !over_.load(std::memory_order_relaxed);) {
    const std::uint32_t posted = posted_.load(std::memory_order_acquire);
    if (do_next(helper)) {
      looks = 0;
    } else if (++looks < kLooks) {
      looks % kBeforeYield == 0 ? std::this_thread::yield() : rest();
    } else {
      sleep(posted);
      looks = 0;
    }
  }
}

/// Until something is posted after so many.
void Helpers::sleep(std::uint32_t posted) {
  const std::uint32_t woken = woken_;
  ++asleep_;
  if (posted_.load() == posted && !over_) woken_.wait(woken);
  --asleep_;
}

/// False: nothing waits.
bool Helpers::do_next(int helper) {
  using State = Job::State;
  while (Job* const job = take()) {
    State state = State::waiting;
    if (!job->state_.compare_exchange_strong(state, State::begun, std::memory_order_acquire)) continue;
    job->run(helper);
    job->state_.store(State::done, std::memory_order_release);
    return true;
  }
  return false;
}

/// The first in the ring; null: none. While nobody else has taken it, its place is not given to another.
Helpers::Job* Helpers::take() {
  std::uint32_t place = taken_.load(std::memory_order_relaxed);
  do {
    if (place == posted_.load(std::memory_order_acquire)) return nullptr;
    Job* const job = jobs_[place % kPlaces].load(std::memory_order_relaxed);
    if (taken_.compare_exchange_weak(place, place + 1, std::memory_order_acq_rel)) return job;
  } while (true);
}

}  // namespace brink
