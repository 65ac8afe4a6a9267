#include "brink/scenes/program/run_folder.h"

#include <fmt/format.h>

#include "brink/core/base/error.h"
#include "brink/scenes/run_file/run_file.h"

namespace brink {
namespace fs = std::filesystem;

namespace {

/// n of a folder called <stem>-<n>; 0 for any other name.
int number_of(const std::string& name, const std::string& stem) {
  if (!name.starts_with(stem + '-')) return 0;
  const std::string digits = name.substr(stem.size() + 1);
  // Written as default_run_folder() writes it; of nine digits at most, stoi cannot overflow.
  if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos)
    return 0;
  return digits[0] == '0' ? 0 : std::stoi(digits);
}

}  // namespace

fs::path default_run_folder(const fs::path& scene, bool resume) {
  // Below the present folder, not the scene's: an installed gallery may not be written to.
  const fs::path runs = "runs";
  const std::string stem = scene.stem().string();
  const auto folder = [&](int n) { return runs / fmt::format("{}-{}", stem, n); };
  int n = 1;
  if (!resume) {
    // A gap in the numbers is used again; of two processes that find the same one RunFolder locks one out.
    while (fs::exists(folder(n))) ++n;
    return folder(n);
  }
  // Folders before the last one may have been deleted, so all that there are are looked at.
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(runs, none))
    // The largest number, not the newest folder: times of files may be those of a copy.
    if (const int found = number_of(entry.path().filename().string(), stem);
        found > n && fs::exists(entry.path() / "run.db"))
      n = found;
  return folder(n);
}

// A file is a run by its extension; whether it is one is found on opening it.
fs::path run_file_of(const fs::path& subject) {
  if (fs::is_directory(subject)) return subject / "run.db";
  return subject.extension() == ".db" ? subject : fs::path();
}

fs::path required_run_file(const fs::path& subject) {
  const fs::path file = run_file_of(subject);
  if (!file.empty()) return file;
  if (!fs::exists(subject)) throw IoError(subject.string() + ": cannot be opened for reading");
  throw BadInput(subject.string() + ": not a run; allowed: a run folder or a run file");
}

void tell_unknown(const RunFile& run) {
  if (const std::string unknown = run.unknown_between_frames(); !unknown.empty())
    fmt::print(stderr, "brink: {}\n", unknown);
}

}  // namespace brink
