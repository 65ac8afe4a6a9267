// A signal handler may do next to nothing, so it sets a flag. Whoever runs asks for it (stop_asked()) where
// it can stop: between events, with a checkpoint, or between two runs of a sweep.
#include "brink/scenes/program/stopping.h"

#include <csignal>

namespace brink {
namespace {

// Of a kind that a signal handler may write to.
volatile std::sig_atomic_t asked = 0;

/// Gives the default action back to both: a second signal ends the program, of whichever kind it is.
void ask(int) {
  asked = 1;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

}  // namespace

void stop_on_signals() {
  // No SA_RESTART: a call that waits in the system is interrupted.
  struct sigaction action {};
  action.sa_handler = ask;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool stop_asked() { return asked != 0; }

}  // namespace brink
