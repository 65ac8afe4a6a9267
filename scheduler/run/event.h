#pragma once
/// What happened, one record each.

#include <cstdint>

#include "brink/core/base/geometry.h"
#include "brink/core/contacts/contact.h"

namespace brink {

enum class EventKind {
  collision,
  zeno,
  group,
  undecided,
  persist,  ///< a contact lasts from now on
  sleep,    ///< an island comes to rest: `body` is its least member
  wake,     ///< it moves again
  stick,    ///< a contact that lasts begins to stick, or to roll
  slip,     ///< it begins to slip
  lift,     ///< it is no more
};
const char* to_string(EventKind kind);

/// How one body comes out of an event, and with what twist it came into it.
struct EventSide {
  bool known = false;  ///< else there is no such body, or the event has not changed how it moves by itself
  BodyState after;
  Twist before;
};

struct Event {
  std::uint64_t seq = 0;  ///< counts from 0
  EventKind kind = EventKind::collision;
  Contact contact;
  double impulse_n = 0.0, impulse_t = 0.0;  ///< [N s]
  /// Of collisions. Of several that are resolved together, each tells what all of them came to.
  EventSide body, other;
};

}  // namespace brink
