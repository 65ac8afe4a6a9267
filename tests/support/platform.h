#pragma once
/// Whether this machine computes as the one on which stored answers were made.

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace brink::testing {

/// A hash over values of the C library's functions that runs use, and of the width of long double: where it
/// is the same, stored answers must be met to the last bit; elsewhere chaotic scenes may go another way.
inline std::string platform_probe() {
  std::uint64_t hash = 1469598103934665603ULL;
  const auto add = [&](double x) { hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 1099511628211ULL; };
  for (int k = 1; k <= 2000; ++k) {
    const double x = 0.37 * k;
    for (const double y :
         {std::sin(x), std::cos(x), std::exp(-0.01 * x), std::pow(x, 1.7), std::atan2(x, 3.0)})
      add(y);
    const long double wide = x;
    for (const long double y : {std::sin(wide), std::cos(wide), std::sqrt(wide)}) {
      add(static_cast<double>(y));
      add(static_cast<double>(y - static_cast<double>(y)));
    }
  }
#if defined(__clang__)
  add(2.0);
#endif
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

/// The probe of the machine of tests/regression/answers.csv, in its first line.
inline std::string stored_probe() {
  std::ifstream in(std::filesystem::path(BRINK_SOURCE_DIR) / "tests/regression/answers.csv");
  std::string line;
  std::getline(in, line);
  return line.substr(line.rfind(' ') + 1);
}

}  // namespace brink::testing
