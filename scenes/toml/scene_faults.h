#pragma once
/// What is wrong with a scene file, each fault with its place.

#include <filesystem>
#include <string>
#include <vector>

#include "brink/core/base/error.h"

namespace brink {

/// One fault of a scene file; line and column count from 1 (0: the command line's --set).
struct SceneFault {
  int line = 0, column = 0;
  std::string message;  ///< what is wrong, what was given, what is allowed
  std::string file;     ///< a data file that the scene names; empty: the scene file itself
};

/// Every fault of a file at once; what() has one "FILE:LINE:COLUMN: message" a line.
class SceneFaults : public BadInput {
 public:
  SceneFaults(const std::filesystem::path& file, std::vector<SceneFault> faults);
  const std::vector<SceneFault>& faults() const { return faults_; }

 private:
  std::vector<SceneFault> faults_;
};

}  // namespace brink
