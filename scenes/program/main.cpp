/// The command-line program `brink`.

#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <csignal>
#include <cstdio>
#include <system_error>

#include "brink/core/base/error.h"
#include "brink/core/base/printable.h"
#include "brink/scenes/program/command_line.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/terminal.h"
#include "brink/scenes/scene/scene.h"

namespace {

/// Says what went wrong in one line on standard error, and returns the status.
int fail(brink::ExitStatus status, const char* what) {
  fmt::print(stderr, "{} {}\n", brink::paint(stderr, brink::Paint::bad, "brink:"), brink::printable(what));
  return status;
}

/// What was printed must have got out: a full disk behind standard output is told.
/// printf fails silently, and the exit status would say that all is well.
int flushed(int status) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
  return fail(brink::kIoFailed, "standard output could not be written");
}

/// The command line with every exception turned into an exit status (README). The order is
/// from the special to the general: SceneFaults is a BadInput.
int run(int argc, char** argv) {
  try {
    return flushed(brink::run_command_line(argc, argv));
  } catch (const brink::SceneFaults& e) {
    fmt::print(stderr, "{}\n", e.what());  // one line a fault, each with its place
    return brink::kBadInput;
  } catch (const brink::BadInput& e) {
    fmt::print(stderr, "{}\n", brink::printable(e.what()));
    return brink::kBadInput;
  } catch (const brink::IoError& e) {
    return fail(brink::kIoFailed, e.what());
  } catch (const std::system_error& e) {  // what fmt says of a stream that cannot be written
    return fail(brink::kIoFailed, e.what());
  } catch (const std::exception& e) {
    // What nobody expected: the run file, if there is one, holds all up to there.
    return fail(brink::kEndedEarly, e.what());
  }
}

/// Each step of a large island asks for lists of some megabytes and gives them back: kept by the process, they need not be
/// fetched from the system, and cleared by it, anew.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kMegabyte = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 * kMegabyte);
  mallopt(M_TRIM_THRESHOLD, 256 * kMegabyte);
  mallopt(M_TOP_PAD, 16 * kMegabyte);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of file size is then an error of the write, which is told
  return run(argc, argv);
}
