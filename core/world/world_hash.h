#pragma once
/// A world's fingerprint: run files and snapshots are told by it which world they belong to.

#include <cstdint>
#include <string>

#include "brink/core/world/world.h"

namespace brink {

/// Hash of everything in a world that decides its motion: shapes, masses, initial states, materials, sites,
/// forces. Titles and names are left out. Two scenes with the same hash and the same options run alike.
std::uint64_t world_hash(const World& world);
/// The same as a run file has it: 16 hexadecimal digits.
std::string world_hash_text(const World& world);

}  // namespace brink
