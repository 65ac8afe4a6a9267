#pragma once
/// The kernel as the simulator has it: begun and ended, saved and restored, and changed from outside.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "brink/scheduler/kernel/kernel.h"

namespace brink {

/// Bodies that were moved out of wires.
struct MovedAtStart {
  int bodies = 0;
  double most = 0.0;  ///< [m]
};

class RunKernel final : public Kernel {
 public:
  /// @throws BadInput, IoError as Simulator.
  RunKernel(World world, SolverOptions options);

  /// `recorder` may be null.
  void begin(const RunOptions& options, Recorder* recorder);
  /// At the start, where contacts may last: those that are there, press, and neither close nor part last.
  void let_touching_last();
  /// Records the last frame, at the present time, unless the frame clock has just done so, and a checkpoint.
  void end();
  /// Tells the recorder of contacts that last still, and of motions that go on still.
  void tell_lasting() const {
    parts_.islands.tell_lasting();
    parts_.trajectories.tell_lasting_knots();
  }
  WorkCounters& work() { return parts_.run.work(); }
  double max_overlap() const { return parts_.watch.max_overlap(); }
  const TakenGroups& taken() const { return parts_.taken; }

  /// Ends the run after so many collisions from now on, before max_collisions; 0: no more than that says.
  void stop_after_collisions(std::uint64_t count);

  /// From now on owners whom the filter says no to never meet.
  void set_pair_filter(PairFilter filter);

  /// From now on bodies are grouped as it says. Snapshots hold the groups, not the function.
  void set_grouping(Grouping grouping) { parts_.grouping = std::move(grouping); }

  // -- at the present time; the policy's knowledge is void afterwards --
  /// Body k goes on from this state. @throws BadInput if it is not finite, or moves along a lock.
  void set_state(int k, const BodyState& state);
  /// An impulse [N s] at a point of the world [m]; locks hold against it. @throws BadInput if it is not finite.
  void apply_impulse(int k, const Vec2& impulse, const Vec2& point);

  // -- checks --
  /// See Simulator.
  std::vector<Contact> overlaps(std::size_t most) { return parts_.watch.overlaps(most); }
  /// Empty, or the deepest of the first overlaps, if pairs overlap by more than rounding of a file. Cost: a look at all near
  /// pairs; asked again before the run has begun, where nothing was changed, none.
  const std::string& start_fault();
  /// At the start: bodies that stand a hair across a wire are moved to just before it (shifts_out_of_wires()).
  void move_out_of_wires();
  /// How many were, and by how much at most [m].
  const MovedAtStart& moved_at_start() const { return moved_at_start_; }
  /// From now on what searches certify is checked as the run goes on (CertificateWatch).
  void hold_to_certificates() { parts_.watch.begin(); }
  /// From now on contacts may last (Islands). The policy asks for next_step().
  void let_contacts_last() {
    parts_.islands.allow({options().tolerance, static_cast<std::size_t>(options().modes_contacts)});
  }
  const IslandTally& island_tally() const { return parts_.islands.tally(); }
  /// From now on the policy is held to the contacts that it has been told of (PolicyWatch).
  void hold_to_known_contacts() { parts_.policy_watch.begin(); }
  /// @throws BadInput if the policy, which has returned, came back too early or past a contact.
  void check_returned(double until);

  // -- snapshots --
  std::vector<std::byte> snapshot() const { return Kernel::snapshot(); }
  /// @throws BadInput if the bytes are not a snapshot of this world and options, or a motion cannot be made
  /// again; nothing has changed then.
  void restore(std::span<const std::byte> bytes);

 private:
  void let_help(int count);
  void tell_knots();
  void undo_cut();
  void go_on_from(int k, const ExtendedState& state);

  MovedAtStart moved_at_start_;
  struct StartFault {
    std::uint64_t revision = 0;  ///< of the state that was looked at
    std::string why;
  };
  std::optional<StartFault> start_fault_;
};

}  // namespace brink
