// SIGTERM to the real program in the middle of what takes long: it ends in order, soon, and the run file is
// whole. Within a second on a machine that has a core for it; how soon is printed.
#include <SQLiteCpp/SQLiteCpp.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "brink/scenes/run_file/run_file.h"

namespace brink::signals_test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

const char* const kProgram = BRINK_BINARY_DIR "/bin/brink";
constexpr double kPatience = 60.0;  ///< until it has begun [s]
/// Of the second that is promised: tests run beside each other, and a machine of two cores may have ten of them for each.
constexpr double kSoon = 5.0;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// The program with these words.
pid_t start(std::vector<std::string> words) {
  std::vector<char*> pointers{const_cast<char*>(kProgram)};
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    ::execv(kProgram, pointers.data());
    ::_exit(127);
  }
  return child;
}

bool is_running(pid_t child) {
  siginfo_t ended{};
  ::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT);
  return ended.si_pid == 0;
}

/// Waits until `ready` or the program's end, but not for ever.
template <class Ready>
void wait_until(pid_t child, Ready&& ready) {
  for (const auto begin = Clock::now(); seconds_since(begin) < kPatience && is_running(child) && !ready();)
    ::usleep(10'000);
}

/// Exit status, or -signal; ends the program by force if it does not end.
int ending(pid_t child) {
  wait_until(child, [] { return false; });
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

bool has_frame(const fs::path& file) {
  try {
    SQLite::Database db(file.string(), SQLite::OPEN_READONLY, 1'000);
    return db.tableExists("meta") && db.tableExists("frame");
  } catch (const SQLite::Exception&) {
    return false;  // not made yet
  }
}

std::string grid(const char* shape, int columns, int rows, double spacing, const char* more = "") {
  return fmt::format(
      "[[bodies]]\nname = \"k\"\n{}\ngrid = {{columns = {}, rows = {}, spacing = [{}, {}]}}\n{}\n", shape,
      columns, rows, spacing, spacing, more);
}

struct Slow {
  const char* name;
  std::string scene;
};

std::ostream& operator<<(std::ostream& out, const Slow& slow) { return out << slow.name; }

const Slow kSlow[] = {
    {"boxes_that_touch", "[world]\nduration = 100\n" + grid("box = {width = 1, height = 1}", 30, 30, 1.0) +
                             "[[bodies]]\ndisc.radius = 0.1\nposition = [-3, 3.3]\nvelocity = [10, 1]\n"},
    {"group_of_2500", "[world]\nduration = 100\n[solver]\norder = \"lcp\"\n" +
                          grid("disc.radius = 0.5", 50, 50, 1.0) +
                          "[[bodies]]\ndisc.radius = 0.1\nposition = [-3, 0.3]\nvelocity = [10, 1]\n"},
    {"reflections_of_2500", "[world]\nduration = 100\n[solver]\norder = \"reflections\"\n" +
                                grid("box = {width = 1, height = 1}", 50, 50, 1.0) +
                                "[[bodies]]\ndisc.radius = 0.1\nposition = [-3, 0.3]\nvelocity = [10, 1]\n"},
    {"every_pair_with_every_other",
     "[world]\nduration = 1e6\n[solver]\npolicy = \"global_backup\"\n"
     "broad_phase = false\n[output]\nframe_interval = 0\n" +
         grid("disc.radius = 0.1", 60, 60, 1.0, "velocity = [1e-3, 0]")},
    {"many_bodies_many_frames",
     "[world]\nduration = 100\n[output]\nframe_interval = 1e-4\nmax_frame_rows = 1000000000000\n" +
         grid("box = {width = 0.5, height = 0.5}", 150, 150, 1.0)},
    {"wall_that_lasts",  // its first step alone takes seconds
     "[world]\nduration = 10\ngravity = [0, -9.81]\n[materials.default]\nfriction = 0.5\n"
     "[[sites]]\nname = \"floor\"\nsegment = [[-300, 0], [300, 0]]\n"
     "[[bodies]]\nname = \"brick\"\nbox = {width = 1, height = 0.5}\nposition = [0, 5]\n"
     "wall = [150, 120]\ntouching = \"floor\"\n"},
    {"site_that_trembles",  // a million cells of its motion for each frame
     "[world]\nduration = 10\n[output]\nframe_interval = 0.5\n"
     "[[bodies]]\ndisc.radius = 0.5\nvelocity = [1, 0]\n"
     "[[sites]]\nsegment = [[-3, -10], [3, -10]]\nmotion = {y = \"0.1*sin(1e6*t)\"}\n"},
    {"slot_without_play",
     "[world]\nduration = 1\n[[bodies]]\ndisc.radius = 0.5\nvelocity = [1, 0]\n"
     "[[sites]]\nsegment = [[-0.50000000002, -1], [-0.50000000002, 1]]\n"
     "[[sites]]\nsegment = [[0.50000000002, -1], [0.50000000002, 1]]\n"},
};

/// A folder of its own.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "brink-signals-XXXXXX").string();
    dir_ = ::mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(dir_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

 protected:
  fs::path dir_;
};

class Signals : public ::testing::TestWithParam<Slow>, protected Folder {
 protected:
  Signals() { std::ofstream(dir_ / "scene.toml") << GetParam().scene; }
};

TEST_P(Signals, EndTheRunInOrder) {
  const fs::path file = dir_ / "out" / "run.db";
  const pid_t child = start({"run", dir_ / "scene.toml", "--out", dir_ / "out", "--quiet"});
  wait_until(child, [&] { return has_frame(file); });
  ::usleep(500'000);
  ASSERT_TRUE(is_running(child)) << "ended by itself, with " << ending(child);
  const auto asked = Clock::now();
  ::kill(child, SIGTERM);
  EXPECT_EQ(ending(child), 1);
  const double took = seconds_since(asked);
  std::printf("%s: ended after %.2f s\n", GetParam().name, took);
  EXPECT_LT(took, kSoon);
  EXPECT_EQ(RunFile(file).meta("termination"), "stopped");
  EXPECT_FALSE(fs::exists(file.string() + "-wal"));
}

class FilmSignals : public ::testing::Test, protected Folder {};

// Asked at once, and in the midst: a shorter film would be taken for the whole one.
TEST_F(FilmSignals, EndAFilmAndLeaveNothingOfIt) {
  std::ofstream(dir_ / "scene.toml")
      << "[world]\nduration = 1\n[[bodies]]\ndisc.radius = 0.5\nvelocity = [1, 0]\n";
  ASSERT_EQ(ending(start({"run", dir_ / "scene.toml", "--out", dir_ / "out", "--quiet"})), 0);
  for (const int milliseconds : {300, 1500}) {
    const pid_t child = start({"film", dir_ / "out", "-o", dir_ / "film.mp4", "--speed", "1e-3"});
    ::usleep(1000 * milliseconds);
    ASSERT_TRUE(is_running(child)) << "ended by itself, with " << ending(child);
    const auto asked = Clock::now();
    ::kill(child, SIGINT);
    EXPECT_EQ(ending(child), 1) << milliseconds;
    EXPECT_LT(seconds_since(asked), kSoon) << milliseconds;
    EXPECT_FALSE(fs::exists(dir_ / "film.mp4")) << milliseconds;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Signals, ::testing::ValuesIn(kSlow),
                         [](const auto& scene) { return std::string(scene.param.name); });

}  // namespace
}  // namespace brink::signals_test
