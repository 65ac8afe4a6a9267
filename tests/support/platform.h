#pragma once
/// Whether this machine's SUNDIALS computes as the one by which stored answers were made. What Brink itself computes
/// has the same bits everywhere.

#if __has_include(<sundials/sundials_config.h>)
#include <sundials/sundials_config.h>
#endif

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace brink::testing {

/// A hash over what the steps of SUNDIALS depend on: its version, powers of the C library, and the processor (where it
/// has fused products, the library was compiled with them). Where it is the same, stored answers of scenes that need a
/// solver must be met to the last bit, too; elsewhere these alone may go another way.
inline std::string platform_probe() {
  std::uint64_t hash = 1469598103934665603ULL;
  const auto add = [&](std::uint64_t x) { hash = (hash ^ x) * 1099511628211ULL; };
  for (int k = 1; k <= 2000; ++k)
    for (const double power : {1.7, 0.2, 1.0 / 3.0})
      add(std::bit_cast<std::uint64_t>(std::pow(0.37 * k, power)));
#ifdef SUNDIALS_VERSION
  for (const char* letter = SUNDIALS_VERSION; *letter != '\0'; ++letter)
    add(static_cast<unsigned char>(*letter));
#endif
#if defined(__x86_64__)
  add(1);
#elif defined(__aarch64__)
  add(2);
#else
  add(3);
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
