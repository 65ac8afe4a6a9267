#pragma once
/// Contacts that lasted, one record each stretch.

#include <cstdint>

#include "brink/core/base/geometry.h"

namespace brink {

/// What two features do that press on each other.
enum class ContactMode : std::uint8_t {
  none,   ///< they do not press
  rest,   ///< their island is at rest
  stick,  ///< no sliding, no turning against each other
  slip,   ///< they slide
  roll,   ///< they turn against each other without sliding
};
const char* to_string(ContactMode mode);

/// A sample and a site that pressed on each other in one mode from one time to another.
///
/// A stretch begins where the two begin to press, or where their mode changes, at an event or a step of their
/// island; it ends where the next step finds otherwise. Forces are means over the last step of the stretch
/// (at rest: what they are), and place and normal are those at its start.
struct LastedContact {
  double from = 0.0, to = 0.0;  ///< [s], from < to
  ContactMode mode = ContactMode::none;
  int body = -1;        ///< the normal points into it
  int other_body = -1;  ///< or -1, and then
  int other_site = -1;  ///< the fixed site
  int sample = -1;      ///< into the carrying outline's samples
  int site = -1;        ///< into the other outline's sites
  bool sample_on_body = true;
  Vec2 point = Vec2::Zero();      ///< world [m]; in a plane that repeats, near `body`
  Vec2 normal = Vec2::Zero();     ///< world, unit
  double normal_force = 0.0;      ///< on `body` along the normal [N], > 0
  double tangential_force = 0.0;  ///< on `body` along the normal turned by +90 degrees [N]
};

}  // namespace brink
