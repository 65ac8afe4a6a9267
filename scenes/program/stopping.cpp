#include "brink/scenes/program/stopping.h"

#include <csignal>

namespace brink {
namespace {

// Of a kind that a signal handler may write to.
volatile std::sig_atomic_t asked = 0;

}  // namespace

void stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { asked = 1; };
  // The default action comes back after the first signal: the second of a kind ends the program.
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool stop_asked() { return asked != 0; }

}  // namespace brink
