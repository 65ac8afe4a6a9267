#pragma once
/// Which of several simultaneous contacts is resolved first.

#include <limits>
#include <optional>

#include "brink/scheduler/kernel.h"

namespace brink {

/// Takes the next certificate from the agenda: drops stale ones, and among those of the same time (within a
/// few roundings) picks by the option `order`. Nothing if the agenda holds none up to `end`.
std::optional<Certificate> take_earliest(Kernel& kernel, Agenda& agenda,
                                         double end = std::numeric_limits<double>::infinity());

/// Of contacts of one instant, in the total order of events, the one that the option `order` puts first; its
/// place in the group. @pre not empty.
std::size_t first_by_order(Kernel& kernel, const std::vector<Certificate>& group);

}  // namespace brink
