#pragma once
/// Policies: who is tested next, who is advanced, who is backed up. The research variable.

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "brink/scheduler/kernel/kernel.h"

namespace brink {

/// Drives the kernel's verbs; holds no world of its own.
class Policy {
 public:
  virtual ~Policy() = default;
  /// Takes the world to time `until`, or to Kernel::halt(), or to where Kernel::pause_point() says stop.
  /// Called again to go further; what a policy knows from before is void if Kernel::revision() has changed.
  virtual void run(Kernel& kernel, double until) = 0;
  /// Makes what it needs of the world, once, before the first run. @throws BadInput, IoError
  virtual void prepare(Kernel& /*kernel*/) {}
  /// What there is to say about that in the plan, in lines for people.
  virtual std::vector<std::string> plan() const { return {}; }
  /// True if it asks for Kernel::next_step(): contacts may last then.
  virtual bool steps_islands() const { return false; }
  /// True if it may skip contacts (the kernel then does not hold it to the exact order of events).
  virtual bool approximate() const { return false; }
  /// True if it asks for Kernel::near_pairs() of all bodies at once.
  virtual bool looks_at_all_pairs() const { return true; }
};

using PolicyMaker = std::function<std::unique_ptr<Policy>()>;

/// Adds a policy under a name of its own, for SolverOptions::policy, scene files and lists, from now until
/// the program ends. `summary`: one line that says what it is. Safe from any thread.
/// @throws BadInput on a name that is empty or taken, or an empty maker.
void register_policy(const std::string& name, const std::string& summary, PolicyMaker make);

/// True for a name that register_policy() was given. Such a policy is held to the contacts that it has been
/// told of, unless it is approximate: going past one throws (PolicyWatch).
bool is_added_policy(std::string_view name);

/// The policy of that name. Detector `depth` cannot tell when two bodies will meet, only that they do: it has
/// two policies of its own, one that steps and pushes apart (for fixed_step), and one that steps and backs up
/// by looking again (for all others).
/// @throws BadInput on a name that is not in policies().
std::unique_ptr<Policy> make_policy(std::string_view name, std::string_view detector = "field");

/// The names of those that give the same events, bit for bit: all that are not approximate, in the order of
/// policies().
std::vector<std::string> exact_policies();

std::unique_ptr<Policy> make_body_clocks();
std::unique_ptr<Policy> make_global_backup();
std::unique_ptr<Policy> make_island_backup();
std::unique_ptr<Policy> make_timewarp();
std::unique_ptr<Policy> make_fixed_step();

std::unique_ptr<Policy> make_classic_backup();
std::unique_ptr<Policy> make_classic_fixed_step();

}  // namespace brink
