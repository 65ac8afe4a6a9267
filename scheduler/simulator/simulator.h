#pragma once
/// The simulator: takes a world from contact to contact.

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "brink/core/world/world.h"
#include "brink/scheduler/run/options.h"
#include "brink/scheduler/run/plan.h"
#include "brink/scheduler/run/recorder.h"
#include "brink/scheduler/run/run_options.h"

namespace brink {

class Simulator {
 public:
  /// @throws BadInput on an invalid world or options; IoError if a field is needed and no GL context opens.
  Simulator(World world, SolverOptions options);
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;

  /// Runs on to options.until, telling `recorder` (may be null). May be called again to go further.
  /// @throws BadInput (brink/core/base/error.h) if `until` lies in the past, if at t = 0 bodies overlap by more than 1e-6 of
  /// the scene's length (naming the deepest pair), or if a run is going on already. What a recorder or a policy throws
  /// comes out of it: after that restore() is the only way to go on.
  RunSummary run(const RunOptions& options, Recorder* recorder = nullptr);

  double time() const;
  const World& world() const;
  /// State of body k at the present time. @throws BadInput if there is no such body; so do those below that name one.
  BodyState state(int k) const;
  std::vector<BodyState> states() const;
  /// Pose of fixed site k at the present time (constant unless the site moves).
  Pose site_pose(int k) const;
  /// Hash of the present time and all states.
  std::uint64_t state_hash() const;

  /// Why a run cannot start from the present state: bodies overlap by more than 1e-6 of the scene's length
  /// (the deepest pair of the first thousand found is named). Empty if it can.
  std::string start_fault() const;
  /// Overlaps at the present time, deepest first: contacts with gap < 0. The search ends when `most` are
  /// found, as all bodies may be in one place.
  std::vector<Contact> overlaps(std::size_t most = 1000) const;
  Plan plan() const;

  /// From now on two owners (bodies first, then sites; a < b) whom the filter says no to pass through each
  /// other; an empty one: everybody meets. It must always say the same of a pair. Snapshots do not hold it.
  /// @throws BadInput with detector "depth", which sees everybody.
  void set_pair_filter(std::function<bool(int a, int b)> filter);

  // -- at the present time, between runs: @throws BadInput from within one --
  /// Body k goes on from this state. @throws BadInput if a number of it is not finite, or it moves along what
  /// is locked.
  void set_state(int k, const BodyState& state);
  /// Gives body k an impulse [N s] at a point of the world [m]; what is locked stays. @throws BadInput if a
  /// number is not finite, or what it moves would not be.
  void apply_impulse(int k, const Vec2& impulse, const Vec2& point);
  /// Runs to the next collision, or to options.until if there is none before; the summary's `stopped` says
  /// that one was met. The present time is then that of the collision, which has been resolved.
  RunSummary step_to_next_event(RunOptions options, Recorder* recorder = nullptr);

  /// Everything needed to go on with the same bits.
  std::vector<std::byte> snapshot() const;
  /// @throws BadInput if the bytes are not a snapshot of this world and options, or have been damaged (any change of one
  /// byte is told, others but for one in 2^64); nothing has changed then.
  void restore(std::span<const std::byte> snapshot);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace brink
