#pragma once
/// Scene and experiment files as text.

#include <filesystem>
#include <string>

namespace brink {

/// Everything in a file, which may also be a pipe.
/// @throws IoError if it cannot be read, is a folder, or holds more than 1e8 bytes.
std::string text_of_file(const std::filesystem::path& file);

}  // namespace brink
