#pragma once
/// Files that a command is told to write (pictures, traces): never one that it reads.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace brink {

/// Refuses `file`, asked for by `option` ("--trace"), if it is one of those that are read or kept, under
/// whatever name or link, or if it is a database already (a run file, the results of a sweep).
/// @throws BadInput naming both. Empty paths are nobody.
void refuse_overwriting(const std::filesystem::path& file, const std::string& option,
                        const std::vector<std::filesystem::path>& kept);

/// The folder, made if need be. @throws IoError naming it and the cause.
std::filesystem::path made_folder(const std::filesystem::path& dir);

/// Writes `text` beside the file, under a name that nobody has, and puts it in its place at once: it is whole whatever happens. Of
/// a link the file that it leads to. @throws IoError; the file of before is as it was.
void write_whole(const std::filesystem::path& file, std::string_view text);

/// After a write that went wrong: @throws IoError naming the file and what the system says of it ("disk
/// full"). Where there was no room for all of it, the file is removed.
[[noreturn]] void throw_not_written(const std::filesystem::path& file);

}  // namespace brink
