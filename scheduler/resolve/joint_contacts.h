#pragma once
/// All that a vertex touches at one moment, where a search names the nearest site alone.

#include <vector>

#include "brink/scheduler/first_contact/first_contact.h"

namespace brink {

/// The contacts of f's sample with every site of the other outline within `tolerance`, each with its own
/// normal: a disc in a corner touches both walls. Where two corners of solids meet, or one and a wire's end, one: with a
/// normal that parts the two wedges, the nearest such to f's; boxes stacked flush part along their faces, whatever way
/// they move. An arc's contact is returned as it is. Cost: all sites of the other outline.
std::vector<FeatureContact> joint_contacts(const Outline& a, const ExtendedState& state_a, const Outline& b,
                                           const ExtendedState& state_b, const FeatureContact& f,
                                           double tolerance);

}  // namespace brink
