#pragma once
/// The keys of a file, as its reader knows them.

#include <string>

namespace brink {

/// One key that a scene file may hold.
struct OptionInfo {
  std::string table;  ///< "world", "solver", "bodies", "disc" ...
  std::string key;
  std::string type;           ///< what is allowed, with the unit
  std::string default_value;  ///< as TOML, or in words; "needed" where there is none
  std::string meaning;
};

}  // namespace brink
