#include "brink/scenes/version.h"
namespace brink {
std::string_view version() { return BRINK_VERSION; }
}  // namespace brink
