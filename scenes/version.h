#pragma once
/// Which Brink this is.

#include <string>
#include <string_view>

namespace brink {

/// "major.minor.patch" of this build.
std::string_view version();

/// The same with commit, compiler, and the libraries that decide bits or pictures.
std::string version_details();

}  // namespace brink
