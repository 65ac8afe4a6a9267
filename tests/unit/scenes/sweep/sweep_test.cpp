// Sweeps: what an experiment file means, and that every run is made once, with the bits of `brink run`.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "brink/core/base/error.h"
#include "brink/scenes/run_file/run_scene.h"
#include "brink/scenes/sweep/plot.h"
#include "brink/scenes/sweep/sweep.h"

namespace brink::sweep_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Six discs in a box; where they are depends on the seed.
const char* const kGas = R"(
[world]
duration = 0.5
[[sites]]
name = "box"
polygon = { vertices = [[0, 0], [2, 0], [2, 2], [0, 2]] }
inside_of = true
[[bodies]]
name = "disc"
disc = { radius = 0.2 }
scatter = { count = 6, region = [[0.2, 0.2], [1.8, 1.8]], speed = 3.0 }
)";

class SweepTest : public ::testing::Test {
 protected:
  SweepTest() {
    std::string name = (fs::temp_directory_path() / "brink-sweep-XXXXXX").string();
    dir_ = ::mkdtemp(name.data());
    write("gas.toml", kGas);
  }
  ~SweepTest() override { fs::remove_all(dir_); }

  fs::path write(const char* name, const std::string& text) const {
    std::ofstream(dir_ / name) << text;
    return dir_ / name;
  }
  Experiment experiment(const std::string& text) const { return load_experiment(write("e.toml", text)); }
  std::string faults(const std::string& text) const {
    try {
      experiment(text);
    } catch (const SceneFaults& e) {
      return e.what();
    }
    return "";
  }

  fs::path dir_;
};

TEST_F(SweepTest, EveryCombinationIsARunAndTheSeedVariesFastest) {
  const Experiment e = experiment(R"(
scenes = "gas.toml"
policies = ["global_backup", "fixed_step"]
seeds = 2
[axes]
solver.step = [0.01, 1]
"bodies.0.scatter.speed" = [1.5]
[set]
output.frame_interval = 0.0
)");
  ASSERT_EQ(e.runs.size(), 2u * 2u * 2u);
  std::vector<std::string> names;
  for (const SweepAxis& axis : e.axes) names.push_back(axis.name);
  EXPECT_THAT(names, ElementsAre("scene", "policy", "solver.step", "bodies.0.scatter.speed", "seed"));
  EXPECT_THAT(e.runs[1].values, ElementsAre("gas", "global_backup", "0.01", "1.5", "2"));
  EXPECT_THAT(e.runs[7].overrides,
              ElementsAre("output.frame_interval=0.0", "solver.policy=\"fixed_step\"", "solver.step=1",
                          "bodies.0.scatter.speed=1.5", "world.seed=2"));
  EXPECT_EQ(e.plot.x, "solver.step");  // the first axis of numbers with more than one value
  EXPECT_EQ(e.plot.series, "policy");
  std::set<std::string> keys;
  for (const SweepRun& run : e.runs) keys.insert(run.key);
  EXPECT_EQ(keys.size(), e.runs.size());
}

TEST_F(SweepTest, FaultsHaveTheirPlaceInTheExperimentFile) {
  const std::string file = (dir_ / "e.toml").string();
  const auto expect = [&](const std::string& text, const std::string& place, const std::string& what) {
    const std::string all = faults(text);
    EXPECT_THAT(all, HasSubstr(file + place)) << text;
    EXPECT_THAT(all, HasSubstr(what)) << text;
  };
  expect("scenes = \"gas.toml\"\npolicies = [\"global_backup\", \"fastest\"]\n", ":2:30: ", "fastest");
  expect("scenes = \"gas.toml\"\n[axes]\nsolver.stepp = [1.0]\n", ":3:17: ", "nearest known key is \"step\"");
  expect("scenes = \"gas.toml\"\n[axes]\nsolver.step = [1.0, -1.0]\n", ":3:21: ", "out of range");
  expect("scenes = \"gas.toml\"\n[axes]\nsolver.step = 1.0\n", ":3:15: ", "an array of one value or more");
  expect("scenes = \"gas.toml\"\norders = [\"index\", \"index\"]\n", ":2:20: ", "twice the same value");
  expect("scenes = \"gas.toml\"\n[set]\nsolver.step = \"x\"\n", ":3:15: ", "wrong type");
  expect("scenes = \"gas.toml\"\nseeds = 0\n", ":2:9: ", "out of range");
  expect("scenes = \"absent.toml\"\n", ":1:10: ", "absent.toml");
  expect("seeds = 3\n", ":1:1: ", "scenes: missing");
  expect("scenes = \"gas.toml\"\npolicys = [\"fixed_step\"]\n",
         ":2:1: ", "nearest known key is \"policies\"");
  expect("scenes = \"gas.toml\"\n[plot]\ny = [\"speed\"]\n", ":3:5: ", "not a column");
  expect("scenes = \"gas.toml\"\n[plot]\nx = \"solver.step\"\n", ":3:5: ", "not an axis");
  expect("scenes = \"gas.toml\"\nseeds = 2\n[set]\nworld.seed = 1\n", ":4:14: ", "on an axis too");
  expect(
      "scenes = \"gas.toml\"\nseeds = 1001\n[axes]\nworld.gravity.0 = " +
          [] {
            std::string many = "[0.0";
            for (int k = 1; k < 1000; ++k) many += ", " + std::to_string(k) + ".0";
            return many + "]\n";
          }(),
      ":1:1: ", "too many runs");
}

TEST_F(SweepTest, FaultsOfABaseSceneHaveTheirPlaceThere) {
  write("bad.toml", "[world]\nduration = -1\n");
  EXPECT_THAT(faults("scenes = [\"gas.toml\", \"bad.toml\"]\n"),
              HasSubstr((dir_ / "bad.toml").string() + ":2:12: "));
}

// The store's row is the same run as `brink run` with the same overrides: same hash, same collisions.
TEST_F(SweepTest, RowIsTheRunThatItsOverridesSay) {
  const Experiment e = experiment("scenes = \"gas.toml\"\nseeds = [5]\nuntil = 0.25\n");
  const SweepResult row = make_sweep_run(e, e.runs[0]);
  RunRequest request;
  request.dir = dir_ / "run";
  request.until = 0.25;
  const RunReport report = run_scene(load_scene(e.runs[0].scene, e.runs[0].overrides), request);
  const auto json = nlohmann::json::parse(report.json);
  EXPECT_EQ(row.state_hash, json["state_hash"]);
  EXPECT_EQ(row.termination, "reached_end");
  EXPECT_GT(report.summary.collisions, 0u);
  EXPECT_EQ(row.numbers.at("collisions"), static_cast<double>(report.summary.collisions));
  for (const std::string& name : sweep_columns()) EXPECT_TRUE(row.numbers.contains(name)) << name;
}

TEST_F(SweepTest, ThreadsChangeNoBits) {
  const Experiment e = experiment("scenes = \"gas.toml\"\nseeds = 8\n");
  const auto hashes = [&](const char* folder, int jobs) {
    SweepStore store(dir_ / folder, e);
    SweepRequest request;
    request.jobs = jobs;
    run_sweep(e, store, request);
    std::vector<std::string> all;
    for (const auto& result : store.results(e)) all.push_back(result ? result->state_hash : "not done");
    return all;
  };
  const auto one = hashes("one", 1);
  EXPECT_EQ(one, hashes("four", 4));
  EXPECT_EQ(std::set(one.begin(), one.end()).size(), 8u);  // eight seeds, eight gases
}

// Two stores on one folder, as two processes have: their locks are their own, and no run is made twice.
TEST_F(SweepTest, TwoThatShareAFolderMakeEachRunOnce) {
  const Experiment e = experiment("scenes = \"gas.toml\"\nseeds = 24\n");
  std::atomic<int> made = 0;
  const auto one = [&] {
    SweepStore store(dir_ / "out", e);
    SweepRequest request;
    request.jobs = 2;
    request.done = [&](const SweepRun&, const SweepResult&) { ++made; };
    run_sweep(e, store, request);
  };
  std::thread first(one), second(one);
  first.join();
  second.join();
  EXPECT_EQ(made, 24);
  SweepStore store(dir_ / "out", e);
  for (const auto& result : store.results(e)) EXPECT_TRUE(result);
}

TEST_F(SweepTest, RunOfAProcessThatIsGoneIsMadeByTheNext) {
  const Experiment e = experiment("scenes = \"gas.toml\"\nseeds = 2\n");
  auto living = std::make_unique<SweepStore>(dir_ / "out", e);
  ASSERT_TRUE(living->take(e.runs[0]));
  SweepStore next(dir_ / "out", e);
  EXPECT_EQ(next.reclaim(), 0);  // its owner lives
  EXPECT_FALSE(next.take(e.runs[0]));
  living.reset();  // the lock goes as it does when a process ends
  EXPECT_EQ(next.reclaim(), 1);
  EXPECT_TRUE(next.take(e.runs[0]));
}

TEST_F(SweepTest, ASecondSweepMakesOnlyWhatIsNew) {
  const auto sweep = [&](const std::string& text) {
    const Experiment e = experiment(text);
    SweepStore store(dir_ / "out", e);
    SweepRequest request;
    int made = 0;
    request.done = [&](const SweepRun&, const SweepResult&) { ++made; };
    run_sweep(e, store, request);
    return made;
  };
  EXPECT_EQ(sweep("scenes = \"gas.toml\"\nseeds = 3\n"), 3);
  EXPECT_EQ(sweep("scenes = \"gas.toml\"\nseeds = 3\n"), 0);
  EXPECT_EQ(sweep("scenes = \"gas.toml\"\nseeds = 5\n"), 2);
  write("gas.toml", std::string(kGas) + "density = 2.0\n");  // another scene under the same name
  EXPECT_EQ(sweep("scenes = \"gas.toml\"\nseeds = 5\n"), 5);
}

TEST_F(SweepTest, StoppedSweepGivesItsRunBack) {
  const Experiment e = experiment("scenes = \"gas.toml\"\nseeds = 3\n");
  SweepStore store(dir_ / "out", e);
  SweepRequest request;
  request.jobs = 1;
  int made = 0;
  request.done = [&](const SweepRun&, const SweepResult&) { ++made; };
  request.stop = [&] { return made == 1; };
  run_sweep(e, store, request);
  EXPECT_EQ(made, 1);
  int left = 0;
  for (const SweepRun& run : e.runs) left += store.take(run);
  EXPECT_EQ(left, 2);
}

// Two discs on one place cannot start: the row says so, and the others are made.
TEST_F(SweepTest, RunThatCannotStartIsARowThatSaysWhy) {
  write("two.toml",
        "[world]\nduration = 1\n[[bodies]]\ndisc = {radius = 1}\n[[bodies]]\ndisc = {radius = 1}\n"
        "position = [3, 0]\n");
  const Experiment e = experiment("scenes = \"two.toml\"\n[axes]\nbodies.1.position = [[3, 0], [1, 0]]\n");
  SweepStore store(dir_ / "out", e);
  run_sweep(e, store, {});
  const SweepResults results = store.results(e);
  EXPECT_EQ(results[0]->termination, "reached_end");
  EXPECT_THAT(results[1]->termination, HasSubstr("overlap by 1 m"));
  EXPECT_EQ(results[1]->state_hash, "");
  write_sweep_csv(dir_ / "t.csv", e, results);
  std::ifstream in(dir_ / "t.csv");
  std::string heading, first, second;
  std::getline(in, heading);
  std::getline(in, first);
  std::getline(in, second);
  EXPECT_THAT(heading, ::testing::StartsWith("scene,bodies.1.position,termination,state_hash,end_time,"));
  EXPECT_THAT(first, ::testing::StartsWith("two,\"[3, 0]\",reached_end," + results[0]->state_hash + ",1,0,"));
  EXPECT_THAT(second, ::testing::StartsWith("two,\"[1, 0]\",\"failed: "));
}

// What stands in the file is not taken for granted.
TEST_F(SweepTest, NumbersThatCannotBeAreFaultsOfTheFile) {
  write("one.toml", "[world]\nduration = 1\n[[bodies]]\ndisc = {radius = 1}\nvelocity = [-1, 0]\n");
  const Experiment e = experiment("scenes = \"one.toml\"\nseeds = 2\n");
  {
    SweepStore store(dir_ / "out", e);
    run_sweep(e, store, {});
    EXPECT_LT(store.results(e)[0]->numbers.at("momentum_x"), 0.0);
  }
  for (const char* wrong : {"collisions = 9e999", "collisions = -5.5", "collisions = 0.5", "end_time = -1",
                            "energy_final = -9e999", "state_hash = 'zzz'"}) {
    const std::string file = (dir_ / "out" / "sweep.db").string();
    fs::copy_file(file, dir_ / "kept.db", fs::copy_options::overwrite_existing);
    SQLite::Database(file, SQLite::OPEN_READWRITE).exec(std::string("UPDATE run SET ") + wrong);
    EXPECT_THROW(SweepStore(dir_ / "out", e).results(e), IoError) << wrong;
    fs::copy_file(dir_ / "kept.db", file, fs::copy_options::overwrite_existing);
  }
  EXPECT_EQ(SweepStore(dir_ / "out", e).results(e)[1]->termination, "reached_end");
}

// A name that a spreadsheet would run is none in the table; a number below 0 is one still.
TEST_F(SweepTest, TableHoldsNoFormulas) {
  write("=1+2.toml", "[world]\nduration = 0.1\n[[bodies]]\ndisc = {radius = 1}\n");
  const Experiment e = experiment("scenes = \"=1+2.toml\"\n[axes]\nbodies.0.angle = [-0.5]\n");
  SweepStore store(dir_ / "out", e);
  run_sweep(e, store, {});
  write_sweep_csv(dir_ / "t.csv", e, store.results(e));
  std::ifstream in(dir_ / "t.csv");
  std::string line;
  std::getline(in, line);
  std::getline(in, line);
  EXPECT_THAT(line, ::testing::StartsWith("'=1+2,-0.5,reached_end,"));
}

// Results made up: median and range over seeds 1, 2, 3 of the values 10, 30, 20.
TEST_F(SweepTest, PlotShowsMedianAndRangeOverSeeds) {
  const Experiment e = experiment(
      "scenes = \"gas.toml\"\nseeds = 3\n[axes]\nsolver.step = [0.1, 0.2]\n[plot]\ny = [\"backups\"]\n");
  SweepResults results(e.runs.size());
  const double values[] = {10.0, 30.0, 20.0};
  for (std::size_t k = 0; k < 3; ++k) {
    results[k] = sweep_result(RunSummary{});
    results[k]->numbers["backups"] = values[k];
  }
  const auto lines = sweep_lines(e, results, "backups");
  ASSERT_EQ(lines.size(), 1u);
  ASSERT_EQ(lines[0].size(), 1u);  // nothing is known yet of the second step
  EXPECT_EQ(lines[0][0].low, 10.0);
  EXPECT_EQ(lines[0][0].middle, 20.0);
  EXPECT_EQ(lines[0][0].high, 30.0);
  const Picture picture = chart_picture(sweep_chart(e, results));
  EXPECT_GT(picture.width, 0);
}

TEST_F(SweepTest, PanelsNameTheUnit) {
  const Experiment e = experiment(
      "scenes = \"gas.toml\"\n[axes]\nsolver.step = [0.1, 0.2]\n[plot]\n"
      "y = [\"wall_seconds\", \"energy_drift\", \"backups\", \"angular_momentum\", \"seconds_search\"]\n");
  std::vector<std::string> titles;
  for (const ChartPanel& p : sweep_chart(e, SweepResults(e.runs.size())).panels) titles.push_back(p.title);
  EXPECT_THAT(titles, ::testing::ElementsAre("wall_seconds [s]", "|energy_drift|", "backups",
                                             "angular_momentum [kg m^2/s]", "seconds_search [s]"));
}

TEST_F(SweepTest, TableNamesPoliciesThatDisagree) {
  const Experiment e = experiment(
      "scenes = \"gas.toml\"\npolicies = [\"global_backup\", \"timewarp\", \"fixed_step\"]\nseeds = 2\n");
  SweepResults results;
  for (const SweepRun& run : e.runs) {
    results.push_back(sweep_result(RunSummary{}));
    results.back()->state_hash.assign(1, run.values[1] == "fixed_step" ? 'f' : 'a');
  }
  EXPECT_EQ(policy_agreement(e, results), "same bits from all exact policies: 2 of 2");
  results[3]->state_hash = "b";  // timewarp, seed 2
  EXPECT_EQ(policy_agreement(e, results),
            "same bits from all exact policies: 1 of 2\n  not the same: gas, 2");
}

TEST(SweepDocs, PageNamesEveryKeyAndTheExamplesLoad) {
  std::ifstream in(BRINK_SOURCE_DIR "/docs/sweep.md");
  std::stringstream page;
  page << in.rdbuf();
  for (const OptionInfo& option : experiment_options())
    EXPECT_THAT(page.str(), HasSubstr("`" + option.key + "`")) << option.table;
  int examples = 0;
  for (const auto& entry : fs::directory_iterator(BRINK_SOURCE_DIR "/scenes/experiments")) {
    EXPECT_NO_THROW(load_experiment(entry.path())) << entry.path();
    ++examples;
  }
  EXPECT_GE(examples, 2);
}

TEST_F(SweepTest, SeedsThatAreNoneAreFoundBeforeAnythingRuns) {
  EXPECT_THAT(faults("scenes = \"gas.toml\"\nseeds = [\"x\", 2]\n"),
              HasSubstr(":2:10: seed = \"x\": seed: wrong type"));
  EXPECT_THAT(faults("scenes = \"gas.toml\"\nseeds = [3, -2]\n"),
              HasSubstr(":2:13: seed = -2: seed: out of"));
  EXPECT_THAT(faults("scenes = \"gas.toml\"\n[axes]\nworld.seed = [1, true]\n"),
              HasSubstr(":3:18: world.seed = true: seed: wrong type"));
  EXPECT_EQ(faults("scenes = \"gas.toml\"\nseeds = [5, 7]\n"), "");
}

TEST_F(SweepTest, FaultsOfEveryBaseSceneAreTold) {
  write("bad.toml", "[world]\nduration = -1\n");
  write("worse.toml", "[world]\nduration = -2\n");
  const std::string all = faults("scenes = [\"absent.toml\", \"bad.toml\", \"worse.toml\"]\n");
  EXPECT_THAT(all, HasSubstr("e.toml:1:11: scenes: "));
  EXPECT_THAT(all, HasSubstr((dir_ / "bad.toml").string() + ":2:12: "));
  EXPECT_THAT(all, HasSubstr((dir_ / "worse.toml").string() + ":2:12: "));
}

TEST_F(SweepTest, RunsWithoutBitsAreNotCountedAsTheSame) {
  const Experiment e =
      experiment("scenes = \"gas.toml\"\npolicies = [\"global_backup\", \"timewarp\"]\nseeds = 2\n");
  SweepResults results;
  for (std::size_t k = 0; k < e.runs.size(); ++k) results.push_back(sweep_failure("too bad"));
  EXPECT_EQ(policy_agreement(e, results), "");
  const auto ran = [&](std::size_t k) {
    results[k] = sweep_result(RunSummary{});
    results[k]->state_hash = "a";
  };
  ran(0);  // global_backup, seed 1: alone
  results[2].reset();
  EXPECT_EQ(policy_agreement(e, results), "");
  ran(1), ran(3);  // both of seed 2
  EXPECT_EQ(policy_agreement(e, results), "same bits from all exact policies: 1 of 1");
}

}  // namespace
}  // namespace brink::sweep_test
