#pragma once
/// The state hash: 64-bit FNV-1a over the bits of doubles and integers, in a fixed order. And a checksum of bytes.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include "brink/core/base/geometry.h"

namespace brink {

class StateHash {
 public:
  void add(std::uint64_t word) {
    for (int i = 0; i < 8; ++i) {
      value_ ^= (word >> (8 * i)) & 0xffU;
      value_ *= 0x100000001b3ULL;
    }
  }
  /// -0.0 and 0.0 hash alike.
  void add(double x) { add(std::bit_cast<std::uint64_t>(x == 0.0 ? 0.0 : x)); }
  void add(const Vec2& v) {
    add(v.x());
    add(v.y());
  }
  void add(const BodyState& s) {
    add(s.pose.position);
    add(s.pose.angle);
    add(s.twist.velocity);
    add(s.twist.omega);
  }
  std::uint64_t value() const { return value_; }
  /// 16 hexadecimal digits.
  std::string text() const {
    static constexpr char digits[] = "0123456789abcdef";
    std::string s(16, '0');
    for (int i = 0; i < 16; ++i) s[i] = digits[(value_ >> (60 - 4 * i)) & 0xf];
    return s;
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

/// Tells bytes apart: any that differ within one word of eight for certain (each word is taken by operations that can be
/// undone), others but for one in 2^64. It is no signature. Words in the machine's order, the last filled with zeros; the
/// length counts, too. Cost: some 7 cycles a word.
inline std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t sum = bytes.size();
  const auto take = [&sum](std::span<const std::byte> some) {
    std::uint64_t word = 0;
    std::memcpy(&word, some.data(), some.size());
    sum = (sum ^ word) * 0x9e3779b97f4a7c15ULL;  // odd
    sum ^= sum >> 32;                            // else the highest bits would meet no others
  };
  for (; bytes.size() >= 8; bytes = bytes.subspan(8)) take(bytes.first(8));
  if (!bytes.empty()) take(bytes);
  return sum;
}

}  // namespace brink
