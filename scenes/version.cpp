#include "brink/scenes/version.h"

#include <fmt/format.h>

namespace brink {

std::string_view version() { return BRINK_VERSION; }

std::string version_details(std::string_view gl) {
  return fmt::format(
      "brink {}\n  commit    {}\n  compiler  {}\n  libraries {}\n"
      "  GL        {}",
      version(), BRINK_COMMIT, BRINK_COMPILER, BRINK_LIBRARIES, gl);
}

}  // namespace brink
