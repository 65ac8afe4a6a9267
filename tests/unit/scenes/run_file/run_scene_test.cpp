// From a scene to a run file: what a run that waited, or was gone on with, leaves behind.
#include "brink/scenes/run_file/run_scene.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <vector>

#include "brink/scenes/run_file/run_file.h"

namespace brink::run_scene_test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

class RunSceneTest : public ::testing::Test {
 protected:
  RunSceneTest() {
    std::string name = (fs::temp_directory_path() / "brink-run-scene-XXXXXX").string();
    dir_ = ::mkdtemp(name.data());
  }
  ~RunSceneTest() override { fs::remove_all(dir_); }

  RunReport run(const Scene& scene, const char* folder, double until, bool resume) const {
    RunRequest request;
    request.dir = dir_ / folder;
    request.until = until;
    request.resume = resume;
    return run_scene(scene, request);
  }

  fs::path dir_;
};

const char* const kBall = R"(
[world]
duration = 0.75
gravity = [0, -8]
[[sites]]
segment = [[-1, 0], [1, 0]]
[[bodies]]
disc = { radius = 0.5 }
position = [0, 1.5]
)";

// The page of a run may make it wait at an event: that is no part of the simulation.
TEST_F(RunSceneTest, WaitingIsNotCountedAsWallSeconds) {
  const Scene scene = parse_scene(kBall, "ball.toml");
  RunRequest request;
  request.dir = dir_ / "out";
  bool waited = false;
  double pause = 0.0;
  Clock::time_point since;
  request.happened = [&](const Event&) { since = Clock::now(); };
  request.waits = [&] {
    if (waited || since == Clock::time_point()) return false;
    pause = seconds_since(since);
    waited = pause > 0.4;
    return !waited;
  };
  const auto begin = Clock::now();
  const RunReport report = run_scene(scene, request);
  const double all = seconds_since(begin);
  ASSERT_TRUE(waited);
  // Between the event and the first question nothing but the question is.
  EXPECT_LE(report.summary.wall_seconds, all - pause + 0.05);
  EXPECT_GT(report.summary.wall_seconds, 0.0);
  const auto point = RunFile(report.file).checkpoint();
  ASSERT_TRUE(point);
  EXPECT_LE(point->wall_seconds, all - pause + 0.05);
  EXPECT_GT(point->wall_seconds, 0.0);
}

// A swing of one site and no body: its rows are those of a run that nobody disturbed.
// A run that goes on follows its sites to where it was: that is done before, and is no part of the simulation.
TEST_F(RunSceneTest, CatchingUpIsNotCountedAsWallSeconds) {
  const Scene scene = parse_scene(
      "[world]\nduration = 40\n[output]\nframe_interval = 0.5\n[[bodies]]\ndisc.radius = 0.5\n"
      "[[sites]]\nsegment = [[-3, -10], [3, -10]]\nmotion = {y = \"0.1*sin(2e3*t)\"}\n",
      "trembles.toml");
  const RunReport before = run(scene, "out", 36.0, false);
  const RunReport after = run(scene, "out", 36.001, true);
  ASSERT_EQ(after.resumed_from, 36.0);
  EXPECT_GE(after.summary.wall_seconds, before.summary.wall_seconds * 0.99);
  EXPECT_LT(after.summary.wall_seconds, before.summary.wall_seconds * 1.2);
}

// A run that has met the limit has met it, however often it is gone on with.
TEST_F(RunSceneTest, GoingOnFromTheLimitOfCollisionsMakesNoneMore) {
  for (const char* policy : {"body_clocks", "global_backup", "island_backup", "timewarp"}) {
    const Scene scene =
        parse_scene(std::string(kBall) + "velocity = [0, -1]\n[solver]\nmax_collisions = 2\npolicy = \"" +
                        policy + "\"\n",
                    "ball.toml");
    const RunReport first = run(scene, policy, 20.0, false);
    EXPECT_EQ(first.summary.termination, Termination::stopped) << policy;
    ASSERT_EQ(first.summary.collisions, 2U) << policy;
    for (const double until : {20.0, 20.0, 30.0}) {
      const RunReport again = run(scene, policy, until, true);
      EXPECT_EQ(again.summary.collisions, 2U) << policy;
      EXPECT_EQ(again.summary.termination, Termination::stopped) << policy;
      EXPECT_EQ(again.summary.why, first.summary.why) << policy;
      EXPECT_EQ(again.summary.state_hash, first.summary.state_hash) << policy;
    }
    EXPECT_EQ(RunFile(dir_ / policy / "run.db").events().size(), 2U) << policy;
  }
}

TEST_F(RunSceneTest, SitesOfAWorldWithoutBodiesKeepTheirPosesWhenItGoesOn) {
  const Scene scene = parse_scene(
      "[world]\nduration = 1\n[output]\nframe_interval = 0.25\n[[sites]]\nsegment = [[-1, 0], [1, 0]]\n"
      "motion = { y = \"sin(t)\" }\n",
      "swing.toml");
  run(scene, "whole", 1.0, false);
  run(scene, "parts", 0.6, false);
  run(scene, "parts", 1.0, true);
  const auto rows = [&](const char* folder) {
    std::vector<std::pair<double, double>> out;
    SQLite::Database db((dir_ / folder / "run.db").string());
    for (SQLite::Statement select(db, "SELECT t, y FROM site_frame ORDER BY rowid"); select.executeStep();)
      out.emplace_back(select.getColumn(0).getDouble(), select.getColumn(1).getDouble());
    return out;
  };
  EXPECT_EQ(rows("whole").size(), 5u);
  EXPECT_EQ(rows("parts"), rows("whole"));
}

// A site that could not be moved on has no row at a frame: what is dropped goes by time, not by how many rows there are.
TEST_F(RunSceneTest, SitesKeepTheirPosesThoughTheyAreNotAsManyAsTheFrames) {
  const char* const more =
      "[output]\nframe_interval = 0.125\n[[sites]]\nsegment = [[5, 0], [6, 0]]\nmotion = { y = \"sin(t)\" "
      "}\n";
  std::string text = kBall;
  text += more;
  const Scene scene = parse_scene(text, "ball.toml");
  const fs::path file = run(scene, "parts", 0.375, false).file;
  SQLite::Database(file.string(), SQLite::OPEN_READWRITE)
      .exec("INSERT INTO site_frame SELECT 0.0, site, x, y, angle, vx, vy, omega FROM site_frame LIMIT 1");
  const auto count = [&] {
    SQLite::Database db(file.string());
    return db.execAndGet("SELECT count(*) FROM site_frame WHERE t <= 0.375").getInt();
  };
  const int before = count();
  run(scene, "parts", 0.75, true);
  EXPECT_EQ(count(), before);
}

// It fails there again at once, and its file has its last state still.
TEST_F(RunSceneTest, OneThatFailedHasTheFrameOfItsEndWhenItGoesOn) {
  std::string text = kBall;
  text += "[[forces]]\nkind = \"formula\"\nbodies = [\"body0\"]\nfx = \"sqrt(0.3 - t)\"\n";
  const Scene scene = parse_scene(text, "ball.toml");
  std::vector<double> times;
  for (const bool resume : {false, true, true}) {
    const RunReport report = run(scene, "out", 0.75, resume);
    EXPECT_EQ(report.summary.termination, Termination::failed);
    SQLite::Database db(report.file.string());
    times.push_back(db.execAndGet("SELECT max(t) FROM frame").getDouble());
    EXPECT_EQ(times.back(), report.summary.end_time) << resume;
  }
  EXPECT_NEAR(times.front(), 0.3, 1e-3);
}

}  // namespace
}  // namespace brink::run_scene_test
