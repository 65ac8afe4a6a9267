#pragma once
#include <filesystem>

namespace brink {

/// runs/<scene>-<n>, below the present folder: the first n that is free; to resume, the last one that holds a
/// run file (n = 1 where there is none).
std::filesystem::path default_run_folder(const std::filesystem::path& scene, bool resume);

}  // namespace brink
