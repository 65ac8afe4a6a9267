#include "brink/scenes/program/gallery.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace brink {
namespace fs = std::filesystem;
namespace {

/// Where the gallery is, in the order that gallery_scenes() names; it need not exist.
fs::path gallery_folder() {
  if (const char* chosen = std::getenv("BRINK_GALLERY")) return chosen;
  std::error_code error;
  // An installed program stands in PREFIX/bin.
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = program.parent_path().parent_path() / "share/brink/gallery";
  // Not installed: the program stands in a build folder, and the source tree is where it was when it was
  // built.
  return fs::is_directory(installed) ? installed : fs::path(BRINK_SOURCE_GALLERY);
}

/// What stands between the quotes of the first line `title = "..."`; enough for a list, no need to load the
/// scene.
std::string title_of(const fs::path& scene) {
  std::ifstream in(scene);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("title", 0) != 0) continue;
    // Of both quotes, as titles may hold the other kind.
    const auto first = line.find_first_of("\"'"), last = line.find_last_of("\"'");
    if (first < last && last != std::string::npos) return line.substr(first + 1, last - first - 1);
  }
  return {};
}

}  // namespace

std::vector<GalleryScene> gallery_scenes() {
  std::vector<GalleryScene> scenes;
  std::error_code error;
  // With `error` a folder that is not there has no entries, and does not throw.
  for (const auto& entry : fs::directory_iterator(gallery_folder(), error)) {
    if (entry.path().extension() != ".toml") continue;
    // Paths below the present folder are short ones, to be typed.
    const fs::path near = entry.path().lexically_proximate(fs::current_path());
    // Others are told in full: "../../.." is no shorter, and depends on where one is.
    const bool below = !near.empty() && *near.begin() != "..";
    scenes.push_back({below ? near : entry.path(), title_of(entry.path())});
  }
  std::sort(scenes.begin(), scenes.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return scenes;
}

}  // namespace brink
