#pragma once
/// Materials of pairs, combined when a pair first needs them: of n materials few of the n^2 pairs ever meet.

#include <cstdint>
#include <unordered_map>

#include "brink/core/world/world.h"

namespace brink {

class PairMaterials {
 public:
  /// Of material a on material b of that world, always the same one. References stay good. Cost: a look-up;
  /// less if it is the pair that was asked for last.
  const Material& of(const World& world, int a, int b) {
    const auto key = (static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint32_t>(b);
    if (last_ && key == last_key_) return *last_;
    const auto [place, is_new] = made_.try_emplace(key);
    if (is_new) place->second = combined(world, a, b);
    last_key_ = key;
    return *(last_ = &place->second);
  }

 private:
  std::unordered_map<std::uint64_t, Material> made_;
  std::uint64_t last_key_ = 0;
  const Material* last_ = nullptr;
};

}  // namespace brink
