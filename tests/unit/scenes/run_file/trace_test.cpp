// The scheduler's timeline: valid JSON, a lane a body, and as many entries as the work counters say.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "brink/scenes/run_file/run_scene.h"
#include "brink/scenes/run_file/trace_file.h"

namespace brink::trace_test {
namespace {

namespace fs = std::filesystem;

// Five discs between walls, one of them fast; names that JSON must escape.
const char* const kRow = R"(
title = 'a "row"'
[world]
duration = 2.0
[[sites]]
name = "wall \\ left"
segment = [[-2, -1], [-2, 1]]
[[sites]]
segment = [[12, -1], [12, 1]]
[[bodies]]
name = 'the "fast" one'
disc = { radius = 0.5 }
velocity = [9, 0]
position = [-1, 0]
[[bodies]]
name = "row"
disc = { radius = 0.5 }
position = [2, 0]
grid = { columns = 4, rows = 1, spacing = [1.5, 0] }
)";

class TraceTest : public ::testing::TestWithParam<const char*> {
 protected:
  TraceTest() {
    std::string name = (fs::temp_directory_path() / "brink-trace-XXXXXX").string();
    dir_ = ::mkdtemp(name.data());
  }
  ~TraceTest() override { fs::remove_all(dir_); }

  RunReport run(const fs::path& trace) const {
    RunRequest request;
    request.dir = dir_ / "run";
    request.trace = trace;
    return run_scene(parse_scene(kRow, "row.toml", {std::string("solver.policy=") + GetParam()}), request);
  }

  fs::path dir_;
};

TEST_P(TraceTest, EntriesAreThoseOfTheWorkCountersOnALaneABody) {
  const RunReport report = run(dir_ / "trace.json");
  const WorkCounters& work = report.summary.work;
  ASSERT_GT(work.collisions, 5u);
  std::ifstream in(dir_ / "trace.json");
  const nlohmann::json trace = nlohmann::json::parse(in);
  std::map<std::string, std::uint64_t> count;
  std::map<int, std::string> lanes;
  double thrown_away = 0.0;
  for (const auto& entry : trace) {
    const std::string name = entry["name"];
    if (entry["ph"] == "M") {
      if (name == "thread_name") lanes[entry["tid"]] = entry["args"]["name"];
      continue;
    }
    ++count[name];
    EXPECT_GE(entry["ts"], 0.0);
    if (entry["ph"] == "C") continue;
    EXPECT_TRUE(lanes.contains(entry["tid"])) << entry;
    const double from = entry["args"]["from"], to = entry["args"]["to"];
    if (name == "advance") {
      EXPECT_GE(to, from);
    }
    if (name == "back up" || name == "roll back") {
      EXPECT_LT(to, from);
      thrown_away += from - to;
    }
  }
  EXPECT_EQ(lanes.size(), 5u);
  EXPECT_EQ(lanes[0], "the \"fast\" one");
  EXPECT_EQ(count["advance"], work.advances);
  EXPECT_EQ(count["back up"], work.backups);
  EXPECT_EQ(count["roll back"], work.rollbacks);
  EXPECT_EQ(count["pass"], work.passes);
  EXPECT_EQ(count["search"], work.pair_searches);
  // a collision is on the lane of each body that took part
  EXPECT_EQ(count["collision"], 2 * work.collisions_body_body + work.collisions_body_site);
  EXPECT_NEAR(thrown_away, work.body_seconds_thrown_away, 1e-9 * (1.0 + thrown_away));
}

TEST_P(TraceTest, TracingChangesNoBits) {
  const RunReport with = run(dir_ / "trace.json");
  const RunReport without = run({});
  EXPECT_EQ(with.summary.state_hash, without.summary.state_hash);
  EXPECT_EQ(with.summary.work.queue_operations, without.summary.work.queue_operations);
}

TEST_P(TraceTest, FileThatCannotBeWrittenIsAnIoError) {
  EXPECT_THROW(run(dir_ / "absent" / "trace.json"), IoError);
}

INSTANTIATE_TEST_SUITE_P(Policies, TraceTest,
                         ::testing::Values("body_clocks", "global_backup", "fixed_step"));

}  // namespace
}  // namespace brink::trace_test
