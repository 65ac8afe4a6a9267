#include "brink/scenes/version.h"

#include <fmt/format.h>

#include "brink/core/base/error.h"
#include "brink/core/fields/gl_context.h"

namespace brink {
namespace {

/// The GL that fields are drawn by.
std::string gl_words() {
  try {
    return open_gl_context()->description();
  } catch (const IoError& none) {
    return fmt::format("none ({})", none.what());
  }
}

}  // namespace

std::string_view version() { return BRINK_VERSION; }

std::string version_details() {
  return fmt::format(
      "brink {}\n  commit    {}\n  compiler  {}\n  libraries {}\n"
      "  GL        {}",
      version(), BRINK_COMMIT, BRINK_COMPILER, BRINK_LIBRARIES, gl_words());
}

}  // namespace brink
