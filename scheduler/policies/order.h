#pragma once
/// Which of several simultaneous contacts is resolved first.

#include <limits>
#include <optional>

#include "brink/scheduler/kernel/kernel.h"

namespace brink {

/// Takes the next certificate from the agenda: drops stale ones, and among those of the same time (within a
/// few roundings) picks by the option `order`. Nothing if the agenda holds none up to `last`. @pre the agenda
/// holds all of an instant that begins by then.
std::optional<Certificate> take_earliest(Kernel& kernel, Agenda& agenda,
                                         double last = std::numeric_limits<double>::infinity());

/// Of contacts of one instant, in the total order of events, the one that the option `order` puts first; its
/// place in the group. @pre not empty.
std::size_t first_by_order(Kernel& kernel, const std::vector<Certificate>& group);

/// The certificate at the time at which it is resolved. Contacts of one instant are a rounding or so apart,
/// and the one that comes first by order need not be the earliest: it is resolved at its own time; but where
/// points may meet wires without thickness at the instant's earliest [s], or a body would be beyond another
/// wire by then.
Certificate at_its_time(const KernelView& kernel, Certificate c, double earliest);

}  // namespace brink
