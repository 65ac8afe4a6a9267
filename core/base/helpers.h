#pragma once
/// Threads that help one: they do small jobs ahead, before that one comes to need them.

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace brink {

/// All jobs are optional. Their owner, one thread, posts what it expects to need; when it needs it, it takes back what
/// nobody has begun and does that itself, or waits for who has. So whether, when and by whom a job is done changes how
/// long things take, and nothing else. A job is handed over in about a hundred nanoseconds while helpers look for work,
/// which they do for some tenths of a millisecond; then they sleep.
class Helpers {
 public:
  /// Once posted it must outlive the helpers.
  class Job {
   public:
    Job() = default;
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;
    virtual ~Job() = default;

   private:
    friend class Helpers;
    enum class State : std::uint8_t { idle, waiting, begun, done };
    /// On the thread of that helper, from 1 on, or of the owner: 0. What it throws would end the program: it keeps it.
    virtual void run(int helper) noexcept = 0;
    std::atomic<State> state_{State::idle};
  };

  explicit Helpers(int count);
  /// What has been begun is done; what waits stays undone.
  ~Helpers();
  Helpers(const Helpers&) = delete;
  Helpers& operator=(const Helpers&) = delete;

  int count() const { return static_cast<int>(threads_.size()); }

  // -- for the owner --
  /// From now on a helper may begin it. Of more than some hundreds that wait the first is not begun any more. @pre it is
  /// free: settle() has not said that it is late. Sleepers are told by wake().
  void post(Job& job);
  void wake();

  enum class Settled : std::uint8_t {
    undone,  ///< nobody has begun it, or it was not posted
    done,
    late,  ///< it is being done still, and the patience was at its end
  };
  enum class Patience : std::uint8_t {
    none,
    little,   ///< some microseconds: where a helper does not get on, another way is quicker
    endless,  ///< until it is done
  };
  /// Takes the job back; meanwhile the owner does others that wait. Unless it is late it is free then, and of a job that
  /// is done this is told once.
  Settled settle(Job& job, Patience patience);

 private:
  static constexpr std::size_t kPlaces = 256;

  void help(int helper);
  void sleep(std::uint32_t posted);
  bool do_next(int helper);
  Job* take();

  std::array<std::atomic<Job*>, kPlaces> jobs_{};  ///< that were posted, in a ring
  alignas(64) std::atomic<std::uint32_t> posted_{0};
  alignas(64) std::atomic<std::uint32_t> taken_{0};
  alignas(64) std::atomic<int> asleep_{0};
  std::atomic<std::uint32_t> woken_{0};
  std::atomic<bool> over_{false};
  std::vector<std::thread> threads_;
};

}  // namespace brink
