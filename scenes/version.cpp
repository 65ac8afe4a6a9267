#include "brink/scenes/version.h"

#include <fmt/format.h>

namespace brink {

std::string_view version() { return BRINK_VERSION; }

std::string version_details() {
  return fmt::format(
      "brink {}\n  commit    {}\n  compiler  {}\n  libraries {}\n"
      "  fields    OpenGL off screen by OSMesa or EGL, as [field] context says",
      version(), BRINK_COMMIT, BRINK_COMPILER, BRINK_LIBRARIES);
}

}  // namespace brink
