#pragma once
/// A generator for random tests: every failure while it lives names its seed.

#include <gtest/gtest.h>

#include <cstdint>
#include <source_location>
#include <string>

#include "brink/core/base/random.h"

namespace brink {

class SeededRandom : public Random {
 public:
  explicit SeededRandom(std::uint64_t seed, std::source_location here = std::source_location::current())
      : Random(seed),
        trace_(here.file_name(), static_cast<int>(here.line()), "seed " + std::to_string(seed)) {}

 private:
  ::testing::ScopedTrace trace_;
};

}  // namespace brink
