#pragma once
#include <string_view>
namespace brink {
/// "major.minor.patch" of this build.
std::string_view version();
}  // namespace brink
