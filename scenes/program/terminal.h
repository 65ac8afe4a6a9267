#pragma once
/// What is done on a terminal only: colours and the progress bar.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace brink {

/// True if `stream` goes to a terminal.
bool on_terminal(std::FILE* stream);

enum class Paint { heading, good, bad, faint };

/// `text`, printable, in colour if `stream` is a terminal that has colours and NO_COLOR is not set.
std::string paint(std::FILE* stream, Paint how, std::string_view text);

/// One line on standard error, redrawn at most ten times a second, wiped at the end. Draws nothing if not
/// `shown`.
class ProgressBar {
 public:
  ProgressBar(double from, double until, bool shown);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(double t, std::uint64_t collisions);

 private:
  using Clock = std::chrono::steady_clock;
  double from_, until_;
  bool shown_, drawn_ = false;
  Clock::time_point start_ = Clock::now(), next_ = start_;
};

}  // namespace brink
