#pragma once
/// Checkpoints as a run file keeps them: sealed, so that a run never goes on from bytes that were damaged,
/// cut, or taken from another run. Internal to the run file.
///
/// A sealed state is a header and then the simulator's snapshot (little-endian, as the machine has it):
///
///     8 bytes   magic "BRINKCP\n"
///     u32       version of this layout: 3
///     u32       0
///     u64       length of the snapshot
///     u64       checksum (core/base/hash.h) of the run's identity, the snapshot,
///               and the row's other columns
///
/// It tells any single change of a byte for certain, others but for one in 2^64. It is no signature: who
/// can write the file can write a seal.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "brink/scenes/run_file/run_file.h"

namespace brink {

/// What a checkpoint belongs to: the version, options and world hash in `meta`, as written there.
std::uint64_t run_identity(const std::string& version, const std::string& options, const std::string& world);

/// `snapshot` with its header. `row`: the other columns; its state is not looked at.
std::vector<std::byte> sealed(const ResumePoint& row, std::span<const std::byte> snapshot,
                              std::uint64_t identity);

/// The snapshot in `point.state`, a sealed state; the other members are those of its row.
/// @throws BadInput: not sealed, of another version, cut, or damaged.
std::vector<std::byte> unsealed(const ResumePoint& point, std::uint64_t identity);

}  // namespace brink
