#pragma once
/// The parts of the kernel, in the order in which they stand on one another. For the kernel alone.

#include "brink/core/base/random.h"
#include "brink/scheduler/kernel/certificate_watch.h"
#include "brink/scheduler/kernel/collision_response.h"
#include "brink/scheduler/kernel/contact_search.h"
#include "brink/scheduler/kernel/endings.h"
#include "brink/scheduler/kernel/group_response.h"
#include "brink/scheduler/kernel/grouping.h"
#include "brink/scheduler/kernel/islands.h"
#include "brink/scheduler/kernel/look_clock.h"
#include "brink/scheduler/kernel/near_pairs.h"
#include "brink/scheduler/kernel/policy_watch.h"
#include "brink/scheduler/kernel/records.h"
#include "brink/scheduler/kernel/run_control.h"
#include "brink/scheduler/kernel/speculation.h"
#include "brink/scheduler/kernel/trajectories.h"

namespace brink {

/// Groups of contacts that had to be taken together with a loss that their materials do not have.
struct TakenGroups {
  std::uint64_t count = 0;
  double energy = 0.0;  ///< that it took [J]
  PairKey first;        ///< the first group was found at this pair ...
  double time = 0.0;    ///< ... at this time [s]
};

struct KernelParts {
  /// @throws BadInput, IoError as Simulator.
  KernelParts(World given, SolverOptions chosen);
  KernelParts(const KernelParts&) = delete;
  KernelParts& operator=(const KernelParts&) = delete;

  World world;                     ///< its sites recentred()
  std::vector<Vec2> frames_moved;  ///< by which the frame of each site was moved for that [m]
  SolverOptions options;
  std::uint64_t fingerprint;  ///< of the two above (snapshot_fingerprint)
  Order order;
  RunControl run;
  Trajectories trajectories;
  ContactSearch search;
  NearPairs near;
  CertificateWatch watch;
  LookClock looks;  ///< of the watch, beside frames
  CollisionResponse response;
  GroupResponse groups;
  Speculation speculation;
  Endings endings;
  Records records;
  Islands islands;
  PolicyWatch policy_watch;
  Grouping grouping;            ///< may be empty
  std::uint64_t groupings = 0;  ///< that it made
  Random random;
  TakenGroups taken;
  double horizon = 0.0;
  std::uint64_t revision = 0;
  std::vector<std::byte> before_cut;  ///< snapshot of before the verb that was cut; empty: none was
  std::unique_ptr<Helpers> helpers;   ///< of a run of more threads than one; last: they end first
};

}  // namespace brink
