#include "brink/scheduler/kernel/policy_watch.h"

#include <fmt/core.h>

#include "brink/core/base/error.h"
#include "brink/scheduler/first_contact/canonical_time.h"

namespace brink {

bool is_fresh(const Speculation& speculation, const Certificate& c) {
  return c.version_body == speculation.certain(c.pair.body).version &&
         (c.pair.with_site() || c.version_other == speculation.certain(c.pair.other_body).version);
}

/// Of motions ahead of time, too.
bool PolicyWatch::alive(const Certificate& c) const {
  return speculation_->track(c.pair.body, c.version_body) &&
         (c.pair.with_site() || speculation_->track(c.pair.other_body, c.version_other));
}

/// Contacts that are due before t are asked one by one: stale ones are forgotten, those of guessed motions put
/// back.
void PolicyWatch::look_before(double t) {
  std::vector<Certificate> ahead;
  // contacts of one instant may be taken in any order: that is the option `order`
  while (!known_->empty() && known_->earliest().time + 2.0 * same_instant(t) < t) {
    const Certificate c = known_->pop();
    if (is_fresh(*speculation_, c))
      throw BadInput(
          fmt::format("policy \"{}\" skips a contact: it goes on to t = {:.17g}, but {} meet at t = {:.17g}, "
                      "as a search has found",
                      policy_, t, search_->name_of(c.pair), c.time));
    // of a motion that is only guessed it may yet come to nothing: kept until that is known
    if (alive(c)) ahead.push_back(c);
  }
  for (const Certificate& c : ahead) known_->insert(c);
}

/// A policy that returns early, without a halt, would have the run look finished.
void PolicyWatch::returned(double now, double until) {
  if (!known_) return;
  going_to(until);
  if (now < until)
    throw BadInput(fmt::format("policy \"{}\" returned at t = {:.17g}, before t = {:.17g}, without a halt",
                               policy_, now, until));
}

}  // namespace brink
