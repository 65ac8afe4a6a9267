#pragma once
/// Numbers and points inside messages, in their shortest exact form.

#include <charconv>
#include <string>

#include "brink/core/base/geometry.h"

namespace brink {

/// The shortest decimal text that reads back as x.
inline std::string text(double x) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, x).ptr;
  return {buffer, end};
}

inline std::string text(const Vec2& p) {
  std::string s(1, '(');
  return s.append(text(p.x())).append(", ").append(text(p.y())).append(")");
}

}  // namespace brink
