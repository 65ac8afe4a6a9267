#pragma once
/// Where the scenes are that come with Brink, and what they are called.

#include <filesystem>
#include <string>
#include <vector>

namespace brink {

struct GalleryScene {
  std::filesystem::path path;
  std::string title;
};

/// The scenes that come with Brink, by name: from BRINK_GALLERY if set, else the folder share/brink/gallery
/// of an installation, else scenes/gallery of the source tree. Empty if there is none.
std::vector<GalleryScene> gallery_scenes();

}  // namespace brink
