#include "brink/integrators/solver_probe.h"

#include <fmt/format.h>
#include <sundials/sundials_config.h>

#include <bit>
#include <cmath>
#include <cstdint>

namespace brink {

std::string solver_probe() {
  // FNV-1a, by words instead of bytes.
  std::uint64_t hash = 1469598103934665603ULL;
  const auto add = [&](std::uint64_t x) { hash = (hash ^ x) * 1099511628211ULL; };
  for (int k = 1; k <= 2000; ++k)
    for (const double power : {1.7, 0.2, 1.0 / 3.0})
      add(std::bit_cast<std::uint64_t>(std::pow(0.37 * k, power)));
  for (const char* letter = SUNDIALS_VERSION; *letter != '\0'; ++letter)
    add(static_cast<unsigned char>(*letter));
#if defined(__x86_64__)
  add(1);
#elif defined(__aarch64__)
  add(2);
#else
  add(3);
#endif
  return fmt::format("{:016x}", hash);
}

}  // namespace brink
