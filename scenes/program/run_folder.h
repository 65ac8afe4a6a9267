#pragma once
/// Where runs are kept, and which one is meant.

#include <filesystem>

namespace brink {

class RunFile;

/// runs/<scene>-<n>, below the present folder: the first n that is free; to resume, the last one that holds a
/// run file (n = 1 where there is none).
std::filesystem::path default_run_folder(const std::filesystem::path& scene, bool resume);

/// The run file that `subject` names (the file, or the folder it is in), or an empty path.
std::filesystem::path run_file_of(const std::filesystem::path& subject);

/// The same for commands that know nothing but runs.
/// @throws IoError where there is nothing of that name; BadInput for what is no run.
std::filesystem::path required_run_file(const std::filesystem::path& subject);

/// Says on standard error what pictures between the run's frames cannot know of its motions, if there is such a thing.
void tell_unknown(const RunFile& run);

}  // namespace brink
