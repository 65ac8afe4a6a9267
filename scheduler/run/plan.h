#pragma once
/// What a run will do before it does it: lines for people.

#include <string>
#include <vector>

namespace brink {

/// What the simulator will do and what it leaves out, in lines for people (printed by `brink check`).
struct Plan {
  std::vector<std::string> lines;
};

}  // namespace brink
