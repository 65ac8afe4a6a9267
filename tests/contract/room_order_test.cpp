// Includes run one way: which room may use which. An arrow that breaks the order is named with its file and
// line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace brink::room_order_test {
namespace {

namespace fs = std::filesystem;
using Rooms = std::vector<std::string>;

/// What every room may include from, beside itself. A folder that is not named belongs to the room above it.
const std::map<std::string, Rooms>& order() {
  static const std::map<std::string, Rooms> all = [] {
    const Rooms core{"core/base", "core/shapes", "core/query", "core/fields", "core/world", "core/contacts"};
    const auto with = [](Rooms some, const Rooms& more) {
      some.insert(some.end(), more.begin(), more.end());
      return some;
    };
    const Rooms below = with(core, {"integrators"});
    std::map<std::string, Rooms> rooms{
        {"core/base", {}},
        {"core/shapes", {"core/base"}},
        {"core/query", {"core/base", "core/shapes"}},
        {"core/fields", {"core/base", "core/shapes"}},
        {"core/world", {"core/base", "core/shapes"}},
        {"core/contacts", {"core/base", "core/world"}},
        {"integrators", {"core/base"}},
    };
    // each room of the scheduler may use those before it, and so may each of the scenes
    Rooms before = below;
    for (const char* room : {"run", "first_contact", "events", "broad_phase", "resolve", "islands", "kernel",
                             "policies", "policies/body_clocks", "classic", "simulator"}) {
      const std::string path = std::string("scheduler/") + room;
      rooms[path] = before;
      before.push_back(path);
    }
    rooms["scenes"] = {};
    before.push_back("scenes");
    for (const char* room :
         {"files", "toml", "draw", "scene", "run_file", "sweep", "regress", "view", "program", "bench"}) {
      const std::string path = std::string("scenes/") + room;
      rooms[path] = before;
      before.push_back(path);
    }
    return rooms;
  }();
  return all;
}

/// Headers that nobody includes but the rooms named: what is behind the kernel's face.
const std::map<std::string, Rooms>& closed_doors() {
  static const std::map<std::string, Rooms> all{
      {"scheduler/kernel/run_kernel.h", {"scheduler/kernel", "scheduler/simulator"}},
      {"scheduler/kernel/kernel_parts.h", {"scheduler/kernel", "scheduler/simulator"}},
  };
  return all;
}

/// The room that a folder, or a file in it, belongs to; empty: none.
std::string room_of(fs::path folder) {
  for (; !folder.empty(); folder = folder.parent_path())
    if (order().count(folder.generic_string())) return folder.generic_string();
  return {};
}

/// "file:line: room includes 'what'", for every include of a file that its room may not use.
std::vector<std::string> broken_arrows(const fs::path& file, std::istream& text) {
  static const std::string lead = "#include \"brink/";
  std::vector<std::string> broken;
  const std::string room = room_of(file.parent_path());
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    if (line.rfind(lead, 0) != 0) continue;
    const std::string what = line.substr(lead.size(), line.rfind('"') - lead.size());
    const std::string other = room_of(fs::path(what).parent_path());
    const auto among = [](const Rooms& rooms, const std::string& one) {
      return std::find(rooms.begin(), rooms.end(), one) != rooms.end();
    };
    const auto door = closed_doors().find(what);
    const bool open = door == closed_doors().end() || among(door->second, room);
    if (open && (other == room || among(order().at(room), other))) continue;
    broken.push_back(file.generic_string() + ":" + std::to_string(number) + ": " + room + " includes '" +
                     what + "'");
  }
  return broken;
}

TEST(RoomOrder, IncludesRunOneWay) {
  const fs::path root = BRINK_SOURCE_DIR;
  int files = 0;
  for (const char* top : {"core", "integrators", "scheduler", "scenes"})
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string ending = entry.path().extension().string();
      if (ending != ".h" && ending != ".cpp") continue;
      const fs::path file = fs::relative(entry.path(), root);
      ASSERT_NE(room_of(file.parent_path()), "") << file << " is in no room";
      std::ifstream text(entry.path());
      EXPECT_EQ(broken_arrows(file, text), Rooms{});
      ++files;
    }
  EXPECT_GT(files, 150);
}

TEST(RoomOrder, ABrokenArrowIsNamedWithItsLine) {
  std::istringstream text(
      "#pragma once\n#include <vector>\n#include \"brink/core/base/error.h\"\n"
      "#include \"brink/scheduler/policies/policy.h\"\n#include \"brink/nowhere/x.h\"\n");
  EXPECT_THAT(
      broken_arrows("core/shapes/outline.h", text),
      ::testing::ElementsAre("core/shapes/outline.h:4: core/shapes includes 'scheduler/policies/policy.h'",
                             "core/shapes/outline.h:5: core/shapes includes 'nowhere/x.h'"));
}

// Policies get kernel.h; the kernel's parts, and what begins and restores a run, are not theirs.
TEST(RoomOrder, TheKernelsPartsAreBehindItsFace) {
  for (const char* header : {"run_kernel.h", "kernel_parts.h"}) {
    const std::string line = std::string("#include \"brink/scheduler/kernel/") + header + "\"\n";
    const auto broken = [&](const char* file) {
      std::istringstream text(line);
      return broken_arrows(file, text).size();
    };
    EXPECT_TRUE(fs::exists(fs::path(BRINK_SOURCE_DIR) / "scheduler/kernel" / header));
    EXPECT_EQ(broken("scheduler/policies/timewarp.cpp"), 1U) << header;
    EXPECT_EQ(broken("scheduler/classic/sight.cpp"), 1U) << header;
    EXPECT_EQ(broken("scenes/program/run.cpp"), 1U) << header;
    EXPECT_EQ(broken("scheduler/kernel/kernel.cpp"), 0U) << header;
    EXPECT_EQ(broken("scheduler/simulator/simulator.cpp"), 0U) << header;
  }
}

}  // namespace
}  // namespace brink::room_order_test
