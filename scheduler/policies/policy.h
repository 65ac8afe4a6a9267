#pragma once
/// Policies: who is tested next, who is advanced, who is backed up. The research variable.

#include <memory>
#include <string_view>

#include "brink/scheduler/kernel.h"

namespace brink {

/// Drives the kernel's verbs; holds no world of its own.
class Policy {
 public:
  virtual ~Policy() = default;
  /// Takes the world to time `until`, or to Kernel::halt(), or to where Kernel::pause_point() says stop.
  virtual void run(Kernel& kernel, double until) = 0;
  /// True if it may skip contacts (the kernel then does not hold it to the exact order of events).
  virtual bool approximate() const { return false; }
};

std::unique_ptr<Policy> make_body_clocks();
std::unique_ptr<Policy> make_global_backup();
std::unique_ptr<Policy> make_fixed_step();

std::unique_ptr<Policy> make_classic_backup();
std::unique_ptr<Policy> make_classic_fixed_step();

/// The policy of that name. Detector `depth` cannot tell when two bodies will meet, only that they do: it has
/// two policies of its own, one that steps and pushes apart (for fixed_step), and one that steps and backs up
/// by looking again (for all others).
/// @throws BadInput on a name that is not in policies().
std::unique_ptr<Policy> make_policy(std::string_view name, std::string_view detector = "field");

}  // namespace brink
