#pragma once
/// Snapshots: bytes from which a run goes on with the same bits.
///
/// Every motion is kept as what it was started from (time and states of its component); restoring starts the
/// integrators there again and lets them run on, which gives the same pieces, since their steps depend on
/// their own history alone.

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "brink/scheduler/kernel/kernel_parts.h"

namespace brink {

/// Everything that a run goes on from.
struct SavedRun {
  double time = 0.0, horizon = 0.0;  ///< [s]
  std::string failure;               ///< why it cannot go on from here; empty: it can
  CertificateWatch::Saved watch;
  Records::Saved records;
  Endings::Saved endings;
  TakenGroups taken;
  std::array<std::uint64_t, 4> random{};
  WorkCounters work;
  Islands::Saved islands;
  Trajectories::Saved trajectories;
};

/// What a snapshot must agree on with the world it is restored into: everything that decides the motion. Cost: a look
/// at all of the world, so it is kept.
std::uint64_t snapshot_fingerprint(const World& world, const SolverOptions& options);

std::vector<std::byte> encode(const SavedRun& saved, std::uint64_t fingerprint);

/// @throws BadInput if the bytes are no snapshot of this world and of what else the fingerprint is of.
SavedRun decode(std::span<const std::byte> bytes, const World& world, std::uint64_t fingerprint);

}  // namespace brink
