#include "brink/scheduler/policies/policy.h"

#include <fmt/core.h>

#include "brink/core/base/error.h"

namespace brink {

std::unique_ptr<Policy> make_policy(std::string_view name, std::string_view detector) {
  if (detector == "depth") return name == "fixed_step" ? make_classic_fixed_step() : make_classic_backup();
  if (name == "body_clocks") return make_body_clocks();
  if (name == "global_backup") return make_global_backup();
  if (name == "fixed_step") return make_fixed_step();
  throw BadInput(fmt::format("policy \"{}\" is not known; see policies()", name));
}

}  // namespace brink
