// `brink check` at the most bodies that a file may hold.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace brink::check_stress {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(CheckStress, LooksAtAMillionBodies) {
  const fs::path folder = fs::temp_directory_path() / ("brink-check-stress-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "many.toml")
      << "[output]\nframe_interval = 0\n[[sites]]\nname = \"floor\"\nsegment = [[-10, -1], [2000, -1]]\n"
         "[[bodies]]\nname = \"disc\"\ndisc = { radius = 0.5 }\n"
         "grid = { columns = 1000, rows = 999, spacing = [1.25, 1.25] }\n"
         "[[bodies]]\nname = \"low\"\ndisc = { radius = 0.5 }\nposition = [0, -0.6]\n";
  const std::string command = "cd '" + folder.string() +
                              "' && timeout 600 '" BRINK_BINARY_DIR
                              "/bin/brink' check many.toml >out.txt 2>&1";
  const int status = std::system(command.c_str());
  std::ostringstream out;
  out << std::ifstream(folder / "out.txt").rdbuf();
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << out.str();
  EXPECT_THAT(out.str(), HasSubstr("999001 bodies"));
  EXPECT_THAT(out.str(), HasSubstr("'disc[0]' and 'low' by 0.4 m"));
  EXPECT_THAT(out.str(), HasSubstr("'low' and 'floor' by 0.1 m"));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace brink::check_stress
