// A run of the real program, killed with signal 9 at random moments and gone on with each time, must end as a
// run that was never disturbed: same state hash, same events, same frames.
#include <SQLiteCpp/SQLiteCpp.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>

#include "brink/core/base/random.h"
#include "brink/scenes/run_file/run_file.h"

namespace brink::kill_resume_test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kKills = 20;

const char* const kProgram = BRINK_BINARY_DIR "/bin/brink";

// Discs and boxes in a closed box under gravity: collisions all the time, of both kinds. How long it lasts is
// set below.
const char* const kCollisions = R"(
title = "to be killed"
[world]
duration = 1.0
gravity = [0.0, -1.0]
seed = 3
[output]
frame_interval = 0.05
[[sites]]
name = "walls"
polygon = { vertices = [[0, 0], [4, 0], [4, 4], [0, 4]] }
inside_of = true
[[bodies]]
name = "disc"
disc = { radius = 0.15 }
scatter = { count = 12, region = [[0.3, 0.3], [3.7, 3.7]], speed = 2.0 }
[[bodies]]
name = "box"
box = { width = 0.3, height = 0.2 }
scatter = { count = 6, region = [[0.3, 0.3], [3.7, 3.7]], speed = 2.0, random_angle = true }
)";

// Blocks and discs in a tray that is shaken for ever: they slide, stick, roll and bounce.
const char* const kLasting = R"toml(
title = "to be killed while contacts last"
[world]
duration = 1.0
gravity = [0.0, -9.81]
[output]
frame_interval = 0.05
[materials.m]
restitution = 0.3
friction = 0.6
[[sites]]
name = "tray"
polyline = [[-1.5, 1.5], [-1.5, 0], [1.5, 0], [1.5, 1.5]]
motion = { x = "0.2*(1 - cos(4*t))" }
material = "m"
[[bodies]]
name = "block"
box = { width = 0.5, height = 0.3 }
position = [-0.8, 1.0]
stack = 3
touching = "tray"
material = "m"
density = 10.0
[[bodies]]
name = "disc"
disc = { radius = 0.15 }
position = [0.5, 0.4]
grid = { columns = 2, rows = 2, spacing = [0.4, 0.4] }
material = "m"
density = 10.0
)toml";

const std::string kByModes = std::string(kLasting) + "[solver]\nmodes_contacts = 16\n";

struct KilledScene {
  const char* name;
  const char* text;
  friend void PrintTo(const KilledScene& scene, std::ostream* out) { *out << scene.name; }
};

/// Starts the program on `scene` with its output thrown away.
pid_t start(const fs::path& scene, const fs::path& out, double until, bool resume) {
  const std::string time = std::to_string(until);
  std::vector<const char*> arguments = {kProgram,    "run",     scene.c_str(), "--out",
                                        out.c_str(), "--until", time.c_str(),  "--quiet"};
  if (resume) arguments.push_back("--resume");
  arguments.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::execv(kProgram, const_cast<char* const*>(arguments.data()));
    ::_exit(127);
  }
  return child;
}

/// Waits for the end and returns the exit status, or -signal.
int ending(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

bool has_checkpoint(const fs::path& file) {
  try {
    SQLite::Database db(file.string(), SQLite::OPEN_READONLY, 10'000);
    return db.tableExists("checkpoint") && db.execAndGet("SELECT count(*) FROM checkpoint").getInt() > 0;
  } catch (const SQLite::Exception&) {
    return false;  // not made yet
  }
}

/// While `waits` is true of a running program; on a busy machine that can take long.
template <class Waits>
void wait_while(pid_t child, Waits&& waits) {
  siginfo_t ended{};
  while (waits() && ended.si_pid == 0) {
    ::usleep(2'000);
    ::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT);
  }
}
void wait_for_checkpoint(pid_t child, const fs::path& file) {
  wait_while(child, [&] { return !has_checkpoint(file); });
}

double run_for_seconds(const fs::path& scene, const fs::path& out, double until) {
  const auto begin = Clock::now();
  EXPECT_EQ(ending(start(scene, out, until, false)), 0);
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// All rows of a query, each value as its exact bits would print (SQLite's %!.17g for reals).
std::vector<std::string> rows(const fs::path& file, const std::string& query) {
  SQLite::Database db(file.string(), SQLite::OPEN_READONLY, 10'000);
  SQLite::Statement get(db, query);
  std::vector<std::string> all;
  while (get.executeStep()) all.push_back(get.getColumn(0).getString());
  return all;
}

std::string exact(std::initializer_list<const char*> columns) {
  std::string format, values;
  for (const char* c : columns) {
    format += "%!.17g ";
    values += std::string(", ifnull(") + c + ", -1)";
  }
  return "printf('" + format + "'" + values + ")";
}

std::vector<std::string> events(const fs::path& file) {
  return rows(file, "SELECT kind || ' ' || " +
                        exact({"seq", "t", "body", "other", "site", "px", "py", "nx", "ny", "closing_speed",
                               "impulse_n", "impulse_t", "gap", "outline_site", "sample", "sample_on_body",
                               "t_low"}) +
                        " FROM event ORDER BY seq");
}
std::vector<std::string> frames(const fs::path& file) {
  return rows(file, "SELECT " + exact({"t", "body", "x", "y", "angle", "vx", "vy", "omega"}) +
                        " FROM frame ORDER BY rowid");
}

std::vector<std::string> contacts(const fs::path& file) {
  return rows(file, "SELECT mode || ' ' || " +
                        exact({"t_begin", "t_end", "body", "other", "site", "outline_site", "sample",
                               "force_n", "force_t", "sample_on_body", "px", "py", "nx", "ny"}) +
                        " FROM contact ORDER BY rowid");
}

std::vector<std::string> knots(const fs::path& file) {
  return rows(file, "SELECT " +
                        exact({"t", "body", "x", "y", "angle", "vx_before", "vy_before", "omega_before", "vx",
                               "vy", "omega", "events"}) +
                        " FROM knot ORDER BY rowid");
}

/// Where the second differs from the first, in words; empty: nowhere.
std::string difference(const std::vector<std::string>& whole, const std::vector<std::string>& other) {
  const auto [a, b] = std::mismatch(whole.begin(), whole.end(), other.begin(), other.end());
  if (a == whole.end() && b == other.end()) return "";
  return "row " + std::to_string(a - whole.begin()) + " of " + std::to_string(whole.size()) + " and " +
         std::to_string(other.size()) + ": " + (a == whole.end() ? "none" : *a) + " and " +
         (b == other.end() ? "none" : *b);
}

class KillResume : public ::testing::TestWithParam<KilledScene> {
 protected:
  KillResume() {
    std::string name = (fs::temp_directory_path() / "brink-kill-XXXXXX").string();
    dir_ = ::mkdtemp(name.data());
    std::ofstream(scene()) << GetParam().text;
  }
  ~KillResume() override { fs::remove_all(dir_); }
  fs::path scene() const { return dir_ / "scene.toml"; }
  fs::path out(const char* name) const { return dir_ / name; }

  /// How far the scene must run to take some seconds on this machine: long enough that checkpoints, one a
  /// second, fall between the kills.
  double time_for(double seconds) {
    for (double until = 5.0;; until *= 4) {
      const double took = run_for_seconds(scene(), out("probe"), until);
      if (took > 0.5 || until > 1e5) return until * seconds / took;
    }
  }

  /// Ctrl-C once the run has begun, after less than half of what the whole one took, or sooner where it was through by
  /// then: others may have used the machine before. Its exit status.
  int interrupted(const char* name, double until, double whole) {
    for (double share = 0.4;; share *= 0.5) {
      const pid_t child = start(scene(), out(name), until, false);
      wait_while(child, [&] { return !fs::exists(out(name) / "run.db"); });
      ::usleep(static_cast<useconds_t>(1e6 * share * whole));
      ::kill(child, SIGINT);
      const int status = ending(child);
      if (status != 0 || share < 0.01) return status;
      fs::remove_all(out(name));
    }
  }

  fs::path dir_;
};

TEST_P(KillResume, TwentyKillsAndOneEndGiveTheUndisturbedRun) {
  const std::uint64_t seed = std::random_device{}();
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Random random(seed);
  const double until = time_for(4.0);
  const double whole = run_for_seconds(scene(), out("whole"), until);
  int killed = 0, between = 0;
  for (int k = 0; k < kKills; ++k) {
    const pid_t child = start(scene(), out("killed"), until, k > 0);
    // the first one late, after a checkpoint or two; the others anywhere, also while the file is being opened
    const double wait = k == 0 ? random.uniform(0.4, 0.6) : random.uniform(0.0, 0.3);
    ::usleep(static_cast<useconds_t>(1e6 * wait * whole));
    const fs::path file = out("killed") / "run.db";
    if (k == 0) wait_for_checkpoint(child, file);
    ::kill(child, SIGKILL);
    if (ending(child) == -SIGKILL) ++killed;
    if (!fs::exists(file)) continue;  // killed before it was made
    {
      SQLite::Database db(file.string(), SQLite::OPEN_READWRITE, 10'000);
      ASSERT_EQ(db.execAndGet("PRAGMA integrity_check").getString(), "ok") << "after kill " << k;
    }
    between += has_checkpoint(file);
  }
  EXPECT_GT(killed, 0);
  EXPECT_GT(between, 0) << "no kill came after a checkpoint: nothing was gone on with";
  ASSERT_EQ(ending(start(scene(), out("killed"), until, true)), 0);
  const fs::path a = out("whole") / "run.db", b = out("killed") / "run.db";
  std::printf("%d of %d kills met a running program, %d after a checkpoint; %zu events in %.2f s\n", killed,
              kKills, between, events(a).size(), whole);
  EXPECT_EQ(RunFile(a).meta("state_hash"), RunFile(b).meta("state_hash"));
  EXPECT_EQ(RunFile(b).meta("termination"), "reached_end");
  EXPECT_GT(events(a).size() + contacts(a).size(), 100u);
  EXPECT_EQ(difference(events(a), events(b)), "");
  EXPECT_EQ(difference(frames(a), frames(b)), "");
  EXPECT_EQ(difference(contacts(a), contacts(b)), "");
  EXPECT_EQ(difference(knots(a), knots(b)), "");
}

// Killed after its last checkpoint, before it could say that it has ended: by then nothing is left to be done but that,
// and the frame at an end that is on no frame clock is there, once.
TEST_P(KillResume, KilledAfterItsLastCheckpointKeepsItsLastFrame) {
  for (const double until : {1.234, 1.25}) {
    const std::string name = "whole" + std::to_string(until), killed = "killed" + std::to_string(until);
    run_for_seconds(scene(), out(name.c_str()), until);
    fs::copy(out(name.c_str()), out(killed.c_str()), fs::copy_options::recursive);
    const fs::path a = out(name.c_str()) / "run.db", b = out(killed.c_str()) / "run.db";
    SQLite::Database(b.string(), SQLite::OPEN_READWRITE)
        .exec("UPDATE meta SET value = 'running' WHERE key = 'termination'");
    ASSERT_EQ(ending(start(scene(), out(killed.c_str()), until, true)), 0);
    EXPECT_EQ(RunFile(b).meta("termination"), "reached_end");
    EXPECT_EQ(RunFile(a).meta("state_hash"), RunFile(b).meta("state_hash"));
    EXPECT_EQ(difference(frames(a), frames(b)), "") << until;
    EXPECT_EQ(difference(events(a), events(b)), "") << until;
  }
}

// Ctrl-C: exit status 1, termination "stopped", a whole file; gone on with, it is the undisturbed run, frames
// and all.
TEST_P(KillResume, InterruptedRunStopsInOrderAndGoesOn) {
  const double until = time_for(3.0);
  const double whole = run_for_seconds(scene(), out("whole"), until);
  EXPECT_EQ(interrupted("stopped", until, whole), 1);
  const fs::path a = out("whole") / "run.db", b = out("stopped") / "run.db";
  EXPECT_EQ(RunFile(b).meta("termination"), "stopped");
  EXPECT_LT(std::stod(*RunFile(b).meta("end_time")), until);
  EXPECT_FALSE(fs::exists(b.string() + "-wal"));
  EXPECT_EQ(ending(start(scene(), out("stopped"), until, true)), 0);
  EXPECT_EQ(RunFile(a).meta("state_hash"), RunFile(b).meta("state_hash"));
  EXPECT_EQ(difference(events(a), events(b)), "");
  EXPECT_EQ(difference(frames(a), frames(b)), "");
  EXPECT_EQ(difference(contacts(a), contacts(b)), "");
  EXPECT_EQ(difference(knots(a), knots(b)), "");
}

// Ctrl-C, gone on with, killed before the next checkpoint, gone on with again: no frame is there twice. The
// stopped run's last frame was off its frame clock.
TEST_P(KillResume, StoppedThenKilledRunHasTheUndisturbedFrames) {
  const double until = time_for(3.0);
  const double whole = run_for_seconds(scene(), out("whole"), until);
  const pid_t stopped = start(scene(), out("both"), until, false);
  ::usleep(static_cast<useconds_t>(1e6 * 0.3 * whole));
  ::kill(stopped, SIGINT);
  ending(stopped);
  const pid_t killed = start(scene(), out("both"), until, true);
  ::usleep(static_cast<useconds_t>(1e6 * 0.3 * std::min(whole, 2.0)));  // checkpoints are a second apart
  ::kill(killed, SIGKILL);
  ending(killed);
  EXPECT_EQ(ending(start(scene(), out("both"), until, true)), 0);
  const fs::path a = out("whole") / "run.db", b = out("both") / "run.db";
  EXPECT_EQ(RunFile(a).meta("state_hash"), RunFile(b).meta("state_hash"));
  EXPECT_EQ(difference(events(a), events(b)), "");
  EXPECT_EQ(difference(frames(a), frames(b)), "");
  EXPECT_EQ(difference(contacts(a), contacts(b)), "");
  EXPECT_EQ(difference(knots(a), knots(b)), "");
}

INSTANTIATE_TEST_SUITE_P(Scenes, KillResume,
                         ::testing::Values(KilledScene{"collisions", kCollisions},
                                           KilledScene{"contacts_that_last", kLasting},
                                           KilledScene{"modes", kByModes.c_str()}),
                         [](const auto& scene) { return std::string(scene.param.name); });

}  // namespace
}  // namespace brink::kill_resume_test
