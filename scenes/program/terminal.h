#pragma once
/// What is done on a terminal only: colours and the progress bar.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

namespace brink {

/// True if `stream` goes to a terminal.
bool on_terminal(std::FILE* stream);

enum class Paint { heading, good, bad, faint };

/// `text`, printable, in colour if `stream` is a terminal that has colours and NO_COLOR is not set.
std::string paint(std::FILE* stream, Paint how, std::string_view text);

/// One line on standard error that says what is going on, wiped at the end. Draws nothing if not `shown`.
class StatusLine {
 public:
  explicit StatusLine(bool shown) : shown_(shown) {}
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  void say(const std::string& text);

 private:
  bool shown_, drawn_ = false;
};

/// What a bar says, no longer than `columns`: a bar as long as there is room for, how much of the whole is done (0 .. 1), the
/// time [s], collisions where they are counted, and how long it will take still.
std::string bar_line(int columns, double part, double t, std::optional<std::uint64_t> collisions,
                     const std::string& left);

/// How far a run has come, from the beginning on, redrawn at most ten times a second.
class ProgressBar {
 public:
  ProgressBar(double from, double until, bool shown);

  void show(double t, std::optional<std::uint64_t> collisions = {});
  /// It has been asked to stop; what it is, it will not show any more.
  void stopping();

 private:
  using Clock = std::chrono::steady_clock;
  StatusLine line_;
  double from_, until_;
  bool stopping_ = false;
  Clock::time_point start_ = Clock::now(), next_ = start_;
};

}  // namespace brink
