#include "brink/scheduler/run/recorder.h"
#include "brink/scheduler/run/trace.h"

namespace brink {

/// Words of run files: they are read back by these names.
const char* to_string(EventKind kind) {
  switch (kind) {
    case EventKind::collision:
      return "collision";
    case EventKind::zeno:
      return "zeno";
    case EventKind::group:
      return "group";
    case EventKind::undecided:
      return "undecided";
    case EventKind::persist:
      return "persist";
    case EventKind::sleep:
      return "sleep";
    case EventKind::wake:
      return "wake";
    case EventKind::stick:
      return "stick";
    case EventKind::slip:
      return "slip";
    case EventKind::lift:
      return "lift";
  }
  // Behind the switch, not a default case in it: so compilers warn of a kind that has no name.
  return "unknown";
}

/// Likewise.
const char* to_string(ContactMode mode) {
  switch (mode) {
    case ContactMode::none:
      return "none";
    case ContactMode::rest:
      return "rest";
    case ContactMode::stick:
      return "stick";
    case ContactMode::slip:
      return "slip";
    case ContactMode::roll:
      return "roll";
  }
  return "unknown";
}

/// What a timeline calls it (brink run --trace).
const char* to_string(TraceKind kind) {
  switch (kind) {
    case TraceKind::advance:
      return "advance";
    case TraceKind::back_up:
      return "back up";
    case TraceKind::roll_back:
      return "roll back";
    case TraceKind::pass:
      return "pass";
    case TraceKind::search:
      return "search";
    case TraceKind::collision:
      return "collision";
  }
  return "unknown";
}

std::string RunSummary::termination_text() const {
  switch (termination) {
    case Termination::not_run:
      return "not run";
    case Termination::reached_end:
      return "reached_end";
    case Termination::stopped:
      return "stopped";
    case Termination::failed:
      return "failed: " + why;
  }
  return "unknown";
}

}  // namespace brink
