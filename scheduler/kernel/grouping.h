#pragma once
/// Which bodies are integrated together while a run goes on.

#include <functional>
#include <optional>
#include <vector>

#include "brink/scheduler/events/agenda.h"

namespace brink {

class KernelView;

/// Asked after every collision, when it is certain and has been recorded, in the order of events: the sets of
/// bodies that are integrated together from now on, beside those that forces couple; nothing: as before. What
/// it says must follow from the view and the pair alone, and from nothing that depends on how far motions have
/// been made or bodies have come: then every exact policy gives the same events, and so does a run that goes
/// on from a snapshot, which holds the sets.
using Grouping =
    std::function<std::optional<std::vector<std::vector<int>>>(const KernelView& view, const PairKey& pair)>;

}  // namespace brink
