#pragma once
/// Which Brink this is.

#include <string>
#include <string_view>

namespace brink {

/// "major.minor.patch" of this build.
std::string_view version();

/// The same with commit, compiler, the libraries that decide bits or pictures or write tables, and the GL that fields
/// are drawn by.
std::string version_details(std::string_view gl);

}  // namespace brink
