#pragma once
/// Which of several simultaneous contacts is resolved first.

#include <optional>

#include "brink/scheduler/kernel.h"

namespace brink {

/// Takes the next certificate from the agenda: drops stale ones, and among those of the same time (within a
/// few roundings) picks by the option `order`. Nothing if the agenda is empty.
std::optional<Certificate> take_earliest(Kernel& kernel, Agenda& agenda);

}  // namespace brink
