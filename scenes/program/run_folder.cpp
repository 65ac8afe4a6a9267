#include "brink/scenes/program/run_folder.h"

#include <fmt/format.h>

namespace brink {
namespace fs = std::filesystem;

fs::path default_run_folder(const fs::path& scene, bool resume) {
  const auto folder = [&scene](int n) {
    return fs::path("runs") / fmt::format("{}-{}", scene.stem().string(), n);
  };
  // Numbers are looked at from 1 up to the first that is free.
  int free = 1;
  while (fs::exists(folder(free))) ++free;
  if (!resume) return folder(free);
  int last = free;
  while (last > 1 && !fs::exists(folder(last) / "run.db")) --last;
  return folder(last);
}

// A file is a run by its extension; whether it is one is found on opening it.
fs::path run_file_of(const fs::path& subject) {
  if (fs::is_directory(subject)) return subject / "run.db";
  return subject.extension() == ".db" ? subject : fs::path();
}

}  // namespace brink
