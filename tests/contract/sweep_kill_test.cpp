// A sweep that is killed, and processes that share one: each run is made, and made once.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>

namespace brink::sweep_kill_test {
namespace {

namespace fs = std::filesystem;

constexpr int kRuns = 16;

class SweepKillTest : public ::testing::Test {
 protected:
  SweepKillTest() {
    std::string name = (fs::temp_directory_path() / "brink-sweep-kill-XXXXXX").string();
    dir_ = ::mkdtemp(name.data());
    std::ofstream(dir_ / "e.toml") << "scenes = \"" BRINK_SOURCE_DIR
                                      "/scenes/gallery/gas_of_two_sizes.toml\"\nseeds = "
                                   << kRuns << "\nuntil = 2.0\n[set]\noutput.frame_interval = 0.0\n";
  }
  ~SweepKillTest() override { fs::remove_all(dir_); }

  pid_t start(const std::string& out) const {
    const pid_t child = ::fork();
    if (child == 0) {
      const std::string experiment = (dir_ / "e.toml").string(), folder = (dir_ / out).string();
      ::execl(BRINK_BINARY_DIR "/bin/brink", "brink", "sweep", experiment.c_str(), "--out", folder.c_str(),
              "--jobs", "1", "--quiet", static_cast<char*>(nullptr));
      ::_exit(127);
    }
    return child;
  }
  static int wait(pid_t child) {
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  /// seed -> state hash, of the CSV.
  std::map<std::string, std::string> hashes(const std::string& out) const {
    std::ifstream in(dir_ / out / "sweep.csv");
    std::map<std::string, std::string> all;
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
      std::istringstream cells(line);
      std::string scene, seed, termination, hash;
      std::getline(cells, scene, ',');
      std::getline(cells, seed, ',');
      std::getline(cells, termination, ',');
      std::getline(cells, hash, ',');
      EXPECT_EQ(termination, "reached_end");
      all[seed] = hash;
    }
    return all;
  }

  fs::path dir_;
};

TEST_F(SweepKillTest, KilledAgainAndAgainItEndsWithTheSameRows) {
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(wait(start("whole")), 0);
  // however fast the machine is: five kills in less than what the whole takes
  const auto pause = (std::chrono::steady_clock::now() - begin) / 8;
  const auto whole = hashes("whole");
  ASSERT_EQ(whole.size(), static_cast<std::size_t>(kRuns));
  int at_work = 0;
  for (int k = 0; k < 5; ++k) {
    const pid_t child = start("killed");
    std::this_thread::sleep_for(pause);
    ::kill(child, SIGKILL);
    at_work += wait(child) == -1;  // it had not ended by itself
  }
  EXPECT_GE(at_work, 2);
  ASSERT_EQ(wait(start("killed")), 0);
  EXPECT_EQ(hashes("killed"), whole);
}

TEST_F(SweepKillTest, ThreeProcessesAtOnceShareTheRuns) {
  std::vector<pid_t> children;
  for (int k = 0; k < 3; ++k) children.push_back(start("shared"));
  for (const pid_t child : children) EXPECT_NE(wait(child), 3);  // 1: others still had runs under way
  ASSERT_EQ(wait(start("shared")), 0);
  EXPECT_EQ(hashes("shared").size(), static_cast<std::size_t>(kRuns));
}

}  // namespace
}  // namespace brink::sweep_kill_test
