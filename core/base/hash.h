#pragma once
/// The state hash: 64-bit FNV-1a over the bits of doubles and integers, in a fixed order.

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
  /// Eight at a time, in the machine's order; the last word is filled with zeros. Hash the length before, or zeros at the
  /// end of one text are taken for those.
  void add_bytes(std::span<const std::byte> bytes) {
    for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes.data(), 8);
      add(word);
    }
    std::uint64_t last = 0;
    if (!bytes.empty()) std::memcpy(&last, bytes.data(), bytes.size());
    add(last);
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

}  // namespace brink
