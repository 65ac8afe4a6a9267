/// The kernel holds a policy to the contacts that it has been told of.
#include <fmt/core.h>

#include "brink/core/base/error.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/kernel/kernel.h"

namespace brink {

void Kernel::watch() {
  if (!watched_) watched_ = std::make_unique<Agenda>();
}

void Kernel::hold_to_known(double t) {
  if (!watched_) return;
  const auto alive = [&](const Certificate& c) {  // of motions ahead of time, too
    return track(c.pair.body, c.version_body) &&
           (c.pair.with_site() || track(c.pair.other_body, c.version_other));
  };
  std::vector<Certificate> ahead;
  while (!watched_->empty() && watched_->earliest().time + 2.0 * same_instant(t) < t) {
    const Certificate c = watched_->pop();
    if (fresh(c))
      throw BadInput(
          fmt::format("policy \"{}\" skips a contact: it goes on to t = {:.17g}, but {} meet at t = {:.17g}, "
                      "as a search has found",
                      options_.policy, t, name_of(c.pair), c.time));
    if (alive(c)) ahead.push_back(c);
  }
  for (const Certificate& c : ahead) watched_->insert(c);
}

void Kernel::hold_to_end(double until) {
  if (!watched_ || halt_) return;
  hold_to_known(until);
  if (time_ < until)
    throw BadInput(fmt::format("policy \"{}\" returned at t = {:.17g}, before t = {:.17g}, without a halt",
                               options_.policy, time_, until));
}

}  // namespace brink
