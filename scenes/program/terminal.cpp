// Status lines and bars are on standard error alone: standard output is the result, and may be read by a
// program.
#include "brink/scenes/program/terminal.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "brink/core/base/printable.h"

namespace brink {
namespace {

// A longer bar tells no more; a shorter one than kLeast nothing, and is left out.
constexpr int kBarWidth = 28, kLeast = 5;
constexpr auto kRedraw = std::chrono::milliseconds(100);

/// Also false of pipes and files, whatever TERM says. NO_COLOR counts if it is set, even to nothing.
bool has_colours(std::FILE* stream) {
  const char* term = std::getenv("TERM");
  return on_terminal(stream) && !std::getenv("NO_COLOR") && term && std::string_view(term) != "dumb";
}

/// Escape sequences (SGR): 1 bold, 2 faint, 31 red, 32 green; 0 ends them.
const char* code(Paint how) {
  switch (how) {
    case Paint::heading:
      return "\033[1m";
    case Paint::good:
      return "\033[32m";
    case Paint::bad:
      return "\033[31m";
    case Paint::faint:
      return "\033[2m";
  }
  return "";
}

/// Columns of the terminal that standard error goes to; 80 where it does not tell.
int columns() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/// Time left [s] in the unit that people would use, without digits that the estimate does not have.
std::string remaining(double seconds) {
  if (seconds < 100) return fmt::format("{:.0f} s left", seconds);
  if (seconds < 6000) return fmt::format("{:.0f} min left", seconds / 60);
  return fmt::format("{:.0f} h left", seconds / 3600);
}

}  // namespace

bool on_terminal(std::FILE* stream) { return ::isatty(::fileno(stream)) != 0; }

// Made printable before colours are added, which are escapes themselves.
std::string paint(std::FILE* stream, Paint how, std::string_view text) {
  const std::string shown = printable(text);
  return has_colours(stream) ? fmt::format("{}{}\033[0m", code(how), shown) : shown;
}

StatusLine::~StatusLine() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void StatusLine::say(const std::string& text) {
  if (!shown_) return;
  drawn_ = true;
  // To the beginning of the line, cleared to its end, then written: a shorter text leaves nothing of a
  // longer one.
  // And no longer than the terminal is wide, as what wraps would not be wiped; a letter of several bytes is not cut.
  std::size_t end = std::min(text.size(), static_cast<std::size_t>(std::max(0, columns() - 1)));
  while (end > 0 && end < text.size() && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
  fmt::print(stderr, "\r\033[K{}", std::string_view(text).substr(0, end));
  std::fflush(stderr);
}

ProgressBar::ProgressBar(double from, double until, bool shown) : line_(shown), from_(from), until_(until) {
  show(from);
}

std::string bar_line(int columns, double part, double t, std::optional<std::uint64_t> collisions,
                     const std::string& left) {
  std::string words = fmt::format("{:3.0f}%  t = {:.4g} s", 100 * part, t);
  if (collisions) words += fmt::format("  {} collisions", *collisions);
  if (!left.empty()) words += "  " + left;
  // The last column stays free: a cursor that stands there wraps on some terminals.
  const int width = std::min(kBarWidth, columns - 1 - static_cast<int>(words.size()) - 3);
  if (width < kLeast) return words.substr(0, static_cast<std::size_t>(std::max(0, columns - 1)));
  const int full = static_cast<int>(part * width);
  return fmt::format("[{}{}] {}", std::string(full, '='), std::string(width - full, ' '), words);
}

void ProgressBar::show(double t, std::optional<std::uint64_t> collisions) {
  const auto now = Clock::now();
  // Nearly all calls end here.
  if (stopping_ || now < next_) return;
  next_ = now + kRedraw;
  // What has no length, as a film of one moment, is done.
  const double part = until_ > from_ ? std::clamp((t - from_) / (until_ - from_), 0.0, 1.0) : 1.0;
  const double spent = std::chrono::duration<double>(now - start_).count();
  // An estimate from less than a hundredth would jump.
  const std::string left = part > 0.01 ? remaining(spent / part * (1 - part)) : std::string();
  // Asked anew each time: terminals are resized.
  line_.say(bar_line(columns(), part, t, collisions, left));
}

void ProgressBar::stopping() {
  // Once; show() keeps away from then on.
  if (!stopping_) line_.say("stopping: a checkpoint is written, to go on from");
  stopping_ = true;
}

}  // namespace brink
