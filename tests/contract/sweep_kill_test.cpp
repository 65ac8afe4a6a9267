// A sweep that is killed, and processes that share one: each run is made, and made once.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

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

  /// A run's seed and the hash of its last state.
  using Row = std::pair<std::string, std::string>;

  /// Every row of the CSV, by seed; two of one seed are two.
  std::vector<Row> rows_of_table(const std::string& out) const {
    std::ifstream in(dir_ / out / "sweep.csv");
    std::vector<Row> all;
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
      all.emplace_back(seed, hash);
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  /// Every row of the store, likewise.
  std::vector<Row> rows_of_store(const std::string& out) const {
    const SQLite::Database store((dir_ / out / "sweep.db").string());
    SQLite::Statement each(store, "SELECT settings, state, state_hash FROM run");
    std::vector<Row> all;
    while (each.executeStep()) {
      EXPECT_EQ(each.getColumn(1).getString(), "done");
      const auto settings = nlohmann::json::parse(each.getColumn(0).getString());
      all.emplace_back(settings.at("seed").get<std::string>(), each.getColumn(2).getString());
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  /// Table and store have a row for each seed, and the same ones.
  void expect_each_once(const std::string& out) const {
    const std::vector<Row> rows = rows_of_table(out);
    std::set<std::string> seeds;
    for (const Row& row : rows) seeds.insert(row.first);
    EXPECT_EQ(rows.size(), static_cast<std::size_t>(kRuns));
    EXPECT_EQ(seeds.size(), static_cast<std::size_t>(kRuns));
    EXPECT_EQ(rows_of_store(out), rows);
  }

  /// How many workers there were, runs that are done, and whether the last worker has one under way.
  struct Progress {
    int workers = 0, done = 0;
    bool under_way = false;
  };
  Progress progress(const std::string& out) const try {
    const SQLite::Database store((dir_ / out / "sweep.db").string());
    SQLite::Statement all(
        store,
        "SELECT (SELECT max(id) FROM worker), (SELECT count(*) FROM run WHERE state = 'done'),"
        " (SELECT count(*) FROM run WHERE state = 'running' AND worker ="
        " (SELECT max(id) FROM worker))");
    if (!all.executeStep()) return {};
    return {all.getColumn(0).getInt(), all.getColumn(1).getInt(), all.getColumn(2).getInt() > 0};
  } catch (const SQLite::Exception&) {
    return {};  // it is not there yet, or being written
  }

  fs::path dir_;
};

// Each process is killed while it makes a run, two more being done each time.
TEST_F(SweepKillTest, KilledAgainAndAgainItEndsWithTheSameRows) {
  ASSERT_EQ(wait(start("whole")), 0);
  expect_each_once("whole");
  for (int k = 0; k < 5; ++k) {
    const pid_t child = start("killed");
    const auto at_work = [&] {
      const Progress p = progress("killed");
      return p.workers == k + 1 && p.done >= 2 * k && p.under_way;
    };
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(5);
    while (!at_work() && std::chrono::steady_clock::now() < until)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(child, SIGKILL);
    EXPECT_EQ(wait(child), -1) << "it had ended by itself";
    const Progress left = progress("killed");
    EXPECT_GE(left.done, 2 * k);
    EXPECT_LT(left.done, kRuns);
  }
  ASSERT_EQ(wait(start("killed")), 0);
  expect_each_once("killed");
  EXPECT_EQ(rows_of_table("killed"), rows_of_table("whole"));
}

TEST_F(SweepKillTest, ThreeProcessesAtOnceShareTheRuns) {
  std::vector<pid_t> children;
  for (int k = 0; k < 3; ++k) children.push_back(start("shared"));
  for (const pid_t child : children) EXPECT_NE(wait(child), 3);  // 1: others still had runs under way
  ASSERT_EQ(wait(start("shared")), 0);
  expect_each_once("shared");
}

}  // namespace
}  // namespace brink::sweep_kill_test
