#pragma once
/// The plan: what a scene needs, and what is left out because it does not.

#include <string>
#include <vector>

#include "brink/scheduler/kernel/kernel_view.h"
#include "brink/scheduler/run/plan.h"

namespace brink {

/// `of_policy`: what the policy has to say.
Plan make_plan(const KernelView& kernel, const std::vector<std::string>& of_policy);

}  // namespace brink
