#pragma once
/// Who is to join an island before it steps: what comes to touch a member within the step, so slowly that the
/// step takes it as plastic. Else each would collide alone, and each collision begin the island's step anew.

#include <functional>
#include <vector>

#include "brink/core/base/go_on.h"
#include "brink/scheduler/kernel/island_members.h"

namespace brink {

/// The approach of a pair that a step of h takes without a rebound, at most [m/s].
using MostAbsorbed = std::function<double(const PairKey& pair)>;

/// Bodies that are no members and come to touch one within h [s], ascending. Their motions are followed to the
/// present; nothing on a halt, or where GoOn says no. Cost: a look at every body's box.
std::vector<int> joining(const World& world, Trajectories& trajectories, const ContactSearch& search,
                         const IslandMembers& members, double now, double h,
                         const MostAbsorbed& most_absorbed, const GoOn& go_on);

}  // namespace brink
