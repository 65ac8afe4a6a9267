// The program as its users meet it: exit status, messages, the last line of --json.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/run_moment.h"
#include "brink/scheduler/policies/policy.h"

namespace brink::program_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

struct Outcome {
  int status = -1;
  std::string out, error;
};

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const auto end = text.rfind('\n');
  return end == std::string::npos ? text : text.substr(end + 1);
}

// A ball let go 1 m above a floor under g = 8 m/s^2 meets it after sqrt(2 * 1 / 8) = 0.5 s.
const char* const kBall = R"(
title = "ball"
[world]
duration = 0.75
gravity = [0, -8]
[output]
frame_interval = 0.25
[[sites]]
name = "floor"
segment = [[-1, 0], [1, 0]]
[[bodies]]
name = "ball"
disc = { radius = 0.5 }
position = [0, 1.5]
)";

/// Time of the processor that children who have ended have taken [s].
double children_seconds() {
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest() {
    std::string name = (fs::temp_directory_path() / "brink-program-XXXXXX").string();
    dir_ = ::mkdtemp(name.data());
    write("ball.toml", kBall);
  }
  ~ProgramTest() override { fs::remove_all(dir_); }

  void write(const char* name, const std::string& text) { std::ofstream(dir_ / name) << text; }

  /// Runs the program in the test's own folder.
  Outcome brink(const std::string& arguments) {
    const std::string command = "cd '" + dir_.string() + "' && '" BRINK_BINARY_DIR "/bin/brink' " +
                                arguments + " >out.txt 2>error.txt";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(dir_ / "out.txt"),
            text_of(dir_ / "error.txt")};
  }

  /// Names of all commands, by the program's own help.
  std::vector<std::string> commands() {
    std::vector<std::string> names;
    std::istringstream lines(brink("--help").out);
    bool listed = false;
    for (std::string line; std::getline(lines, line) && !(listed && line.empty());) {
      if (listed) names.push_back(line.substr(2, line.find(' ', 2) - 2));
      listed = listed || line == "Subcommands:";
    }
    return names;
  }

  fs::path dir_;
};

TEST_F(ProgramTest, RunWritesTheDefaultFolderAndTheContractsSummary) {
  const Outcome run = brink("run ball.toml --json");
  ASSERT_EQ(run.status, 0) << run.error;
  const auto summary = nlohmann::json::parse(last_line(run.out));
  for (const char* key : {"termination", "end_time", "collisions", "wall_seconds", "load_seconds",
                          "energy_initial", "energy_final", "momentum_x", "momentum_y", "angular_momentum",
                          "max_overlap", "state_hash", "work"}) {
    EXPECT_TRUE(summary.contains(key)) << key;
  }
  EXPECT_EQ(summary["termination"], "reached_end");
  EXPECT_EQ(summary["end_time"], 0.75);
  EXPECT_EQ(summary["collisions"], 1);
  EXPECT_NEAR(summary["energy_initial"].get<double>(), 1.0 * 8 * 1.5, 1e-12);  // m g h, mass 1 by default
  const RunFile file(dir_ / "runs/ball-1/run.db");
  ASSERT_EQ(file.events().size(), 1u);
  EXPECT_NEAR(file.events()[0].contact.time, 0.5, 1e-9);
  EXPECT_EQ(file.meta("state_hash"), summary["state_hash"]);
  EXPECT_EQ(file.meta("summary"), last_line(run.out));
  EXPECT_EQ(brink("run ball.toml --quiet").status, 0);
  EXPECT_TRUE(fs::exists(dir_ / "runs/ball-2/run.db"));
}

TEST_F(ProgramTest, QuietRunPrintsNothing) {
  const Outcome run = brink("run ball.toml --quiet");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.out + run.error, "");
}

TEST_F(ProgramTest, ANameThatEndsLikeACopysIsDrawn) {
  write("odd.toml", "[world]\nduration = 0.1\n[[bodies]]\nname = \"odd]\"\ndisc = { radius = 0.5 }\n");
  const Outcome drawn = brink("draw odd.toml -o odd.png --plain");
  EXPECT_EQ(drawn.status, 0) << drawn.error;
}

TEST_F(ProgramTest, ProfileTellsEveryStage) {
  const Outcome run = brink("run ball.toml --profile");
  for (const char* stage : {"looking around", "first contacts", "integrators", "collisions",
                            "lasting contacts", "recording", "policy, the rest"})
    EXPECT_THAT(run.out, HasSubstr(stage));
  const auto summary = nlohmann::json::parse(last_line(brink("run ball.toml --json").out));
  for (const char* stage : {"look", "search", "response", "record"})
    EXPECT_GT(summary["work"][std::string("seconds_") + stage], 0.0) << stage;
}

TEST_F(ProgramTest, OutputThatIsNoTerminalHasNoColours) {
  const Outcome run = brink("run ball.toml");
  EXPECT_THAT(run.out, HasSubstr("reached the end at t = 0.75 s"));
  EXPECT_THAT(run.out + run.error, Not(HasSubstr("\033")));
}

// Frames at 0 and every 0.25 s up to the end, one row a body.
TEST_F(ProgramTest, UntilAndSetChangeTheRun) {
  ASSERT_EQ(brink("run ball.toml --out a --until 1.5 --set output.frame_interval=0.5").status, 0);
  const RunFile run(dir_ / "a/run.db");
  EXPECT_EQ(run.time_range(), std::pair(0.0, 1.5));
  EXPECT_EQ(run.frame_at(1.2).t, 1.0);
}

TEST_F(ProgramTest, FaultsAreOneLineEachWithTheirPlaceAndStatusTwo) {
  write("bad.toml", "[world]\nduration = -1\ngravty = [0, 0]\n");
  for (const char* command : {"run bad.toml", "check bad.toml", "draw bad.toml -o x.png"}) {
    const Outcome run = brink(command);
    EXPECT_EQ(run.status, 2) << command;
    EXPECT_THAT(run.error, HasSubstr("bad.toml:2:")) << command;
    EXPECT_THAT(run.error, HasSubstr("bad.toml:3:")) << command;
  }
  EXPECT_FALSE(fs::exists(dir_ / "runs"));
}

TEST_F(ProgramTest, BadUsageIsStatusTwo) {
  for (const char* command : {"", "fly", "run", "run ball.toml --no-such", "run ball.toml --until x",
                              "run ball.toml --until -1", "run ball.toml --until nan", "list nothing",
                              "run ball.toml --set solver.policy=fastest", "draw ball.toml"}) {
    EXPECT_EQ(brink(command).status, 2) << command;
  }
}

// As of a variable of the shell that is not set.
TEST_F(ProgramTest, EmptyValuesAreStatusTwo) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet").status, 0);
  for (const auto& [command, name] : {std::pair("run ball.toml --until ''", "--until: "),
                                      {"run ball.toml --out ''", "--out: "},
                                      {"run ball.toml --out= --json", "--out: "},
                                      {"run ball.toml --trace ''", "--trace: "},
                                      {"run ball.toml --set ''", "--set: "},
                                      {"run ''", "SCENE: "},
                                      {"check ''", "SCENE: "},
                                      {"draw ball.toml -o x.png --at ''", "--at: "},
                                      {"draw ball.toml -o ''", "--output: "},
                                      {"draw ball.toml -o x.png --view ''", "--view: "},
                                      {"view a -o ''", "--output: "},
                                      {"film a -o f.png --from ''", "--from: "},
                                      {"film a -o f.png --fps ''", "--fps: "},
                                      {"export a --csv ''", "--csv: "},
                                      {"export a --csv t --vtk ''", "--vtk: "},
                                      {"list ''", "TOPIC: "},
                                      {"bench ''", "NAME: "},
                                      {"sweep x.toml --out ''", "--out: "},
                                      {"sweep x.toml --jobs ''", "--jobs: "},
                                      {"regress . --update --reason ''", "--reason: "},
                                      {"regress ''", "DIR: "}}) {
    const Outcome run = brink(command);
    EXPECT_EQ(run.status, 2) << command;
    EXPECT_THAT(run.error, HasSubstr(name)) << command;
    EXPECT_EQ(run.out, "") << command;
  }
  EXPECT_FALSE(fs::exists(dir_ / "runs"));
  EXPECT_FALSE(fs::exists(dir_ / "t"));
}

// The limits of world.duration hold on the command line too, before anything is written.
TEST_F(ProgramTest, WhatIsMisspeltIsToldWithTheNearestWord) {
  for (const auto& [command, nearest] : {std::pair("rn ball.toml", "\"run\""),
                                         {"run ball.toml --untill 2", "--until"},
                                         {"view --opne ball.toml", "--open"},
                                         {"drwa ball.toml", "\"draw\""}}) {
    const Outcome run = brink(command);
    EXPECT_EQ(run.status, 2) << command;
    EXPECT_THAT(run.error, HasSubstr(std::string("the nearest is ") + nearest)) << command;
  }
}

TEST_F(ProgramTest, VersionNamesCommitCompilerAndLibraries) {
  const Outcome run = brink("--version");
  EXPECT_EQ(run.status, 0);
  for (const char* word : {"brink 0.", "commit", "GNU", "Eigen 3.", "SUNDIALS ", "SQLite 3.", "cairo 1.",
                           "HDF5", "VTK", "GL  ", "OpenGL"})
    EXPECT_THAT(run.out, ::testing::AnyOf(HasSubstr(word), HasSubstr("Clang"))) << word;
}

TEST_F(ProgramTest, PicturesAreOfTheKindThatTheirNameSays) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet").status, 0);
  ASSERT_EQ(
      brink("draw a --at 0.6 -o p.png --trails --velocities --contacts --names --axes --size 320x240").status,
      0);
  ASSERT_EQ(brink("draw a --at 0.6 -o p.svg --plain --names --size 320x240").status, 0);
  ASSERT_EQ(brink("draw ball.toml -o p.pdf --plain --view -1,-0.5,1,2 --size 320x240").status, 0);
  EXPECT_EQ(text_of(dir_ / "p.png").substr(1, 3), "PNG");
  EXPECT_THAT(text_of(dir_ / "p.svg"), ::testing::AllOf(HasSubstr("<svg"), HasSubstr("width=\"320")));
  EXPECT_EQ(text_of(dir_ / "p.pdf").substr(0, 4), "%PDF");
  for (const char* bad :
       {"draw a -o p.jpg", "draw a -o p", "draw a -o q.png --view 0,0,1", "draw a -o q.png --view 1,0,0,1",
        "draw ball.toml -o q.png --trails", "draw a -o q.png --view 0,0,1e-20,1e-20"}) {
    EXPECT_EQ(brink(bad).status, 2) << bad;
  }
  // So close that a circle would be drawn for minutes.
  const Outcome close = brink("draw ball.toml -o q.png --view 0,0,1,1e-20");
  EXPECT_EQ(close.status, 2);
  EXPECT_THAT(close.error,
              HasSubstr("--view: 0,0,1,1e-20 given, with a side of 1e-20 m; allowed: 2e-09 m or more"));
  EXPECT_EQ(brink("draw ball.toml -o near.png --size 64x48 --view 0,1,1e-8,1.00000001").status, 0);
  EXPECT_FALSE(fs::exists(dir_ / "q.png"));
}

// Two pictures of a run are seen by one camera.
TEST_F(ProgramTest, PicturesOfARunShowTheWholeRun) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet").status, 0);
  const RunFile run(dir_ / "a/run.db");
  const Box all = extent_of(run, run.world());
  EXPECT_LE(all.low.y(), 0.0);
  EXPECT_GE(all.high.y(), 2.0);
}

TEST_F(ProgramTest, AFilmIsWrittenOrItsPictures) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet").status, 0);
  ASSERT_EQ(brink("film a -o f.png --fps 4 --size 160x120").status, 0);
  for (const char* picture : {"f-00001.png", "f-00002.png", "f-00003.png", "f-00004.png"})
    EXPECT_TRUE(fs::exists(dir_ / picture)) << picture;
  EXPECT_FALSE(fs::exists(dir_ / "f-00005.png"));
  const Outcome film = brink("film a -o f.mp4 --fps 8 --size 161x121 --speed 0.5");
  ASSERT_EQ(film.status, 0) << film.error;
  const bool made = fs::exists(dir_ / "f.mp4");
  EXPECT_TRUE(made || film.error.find("apt-get install ffmpeg") != std::string::npos);
  if (made) {
    EXPECT_EQ(text_of(dir_ / "f.mp4").substr(4, 4), "ftyp");
  }
  for (const char* bad :
       {"film a -o f.avi", "film a -o f.mp4 --fps 0", "film a -o f.mp4 --from 2", "film ball.toml -o f.mp4",
        "film a -o f.mp4 --from 0.5 --to 0.25", "film a -o f.mp4 --from 0.5 --to 0.5",
        "film a -o f.mp4 --to 0", "film a -o a/run.db"}) {
    EXPECT_EQ(brink(bad).status, 2) << bad;
  }
  const Outcome nowhere = brink("film a -o nowhere/f.mp4 --size 1280x720");
  EXPECT_EQ(nowhere.status, 3) << "ffmpeg, or the pictures in its place, cannot be written";
  EXPECT_THAT(nowhere.error, HasSubstr("nowhere/f"));
}

// A picture of a film, or a table, may have the name of a link to what is kept.
TEST_F(ProgramTest, NothingIsWrittenThroughLinks) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet").status, 0);
  const std::string run = text_of(dir_ / "a/run.db"), scene = text_of(dir_ / "ball.toml");
  fs::create_directory(dir_ / "b");
  fs::create_symlink("../a/run.db", dir_ / "b/bench.csv");
  fs::create_symlink("a/run.db", dir_ / "f-00002.png");
  fs::create_symlink("ball.toml", dir_ / "answers.csv.new");
  EXPECT_EQ(brink("bench dropped_disc --out b").status, 2);
  EXPECT_EQ(brink("film a -o f.png --fps 4 --size 160x120").status, 2);
  EXPECT_EQ(brink("regress . --update").status, 0);
  EXPECT_EQ(text_of(dir_ / "a/run.db"), run);
  EXPECT_EQ(text_of(dir_ / "ball.toml"), scene);
  EXPECT_TRUE(fs::is_symlink(dir_ / "answers.csv.new"));
  EXPECT_EQ(brink("regress .").status, 0);
}

TEST_F(ProgramTest, AFilmThatIsNotWholeIsStatusThree) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet").status, 0);
  fs::create_symlink("/dev/full", dir_ / "f.gif");
  const Outcome film = brink("film a -o f.gif --fps 4 --size 160x120");
  if (film.error.find("apt-get install ffmpeg") == std::string::npos) {
    EXPECT_EQ(film.status, 3) << film.error;
  }
}

// What pictures cannot know they say: a collision that was not recorded, motions by an integrator between two frames alone.
TEST_F(ProgramTest, WhatIsNotKnownBetweenFramesIsSaid) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet --set output.events=false").status, 0);
  const char* const said = "collisions were recorded: between frames bodies are led straight through";
  const Outcome drawn = brink("draw a --at 0.4 -o p.png");
  EXPECT_EQ(drawn.status, 0);
  EXPECT_THAT(drawn.error, HasSubstr(said));
  ASSERT_EQ(brink("view a -o p.html").status, 0);
  EXPECT_THAT(text_of(dir_ / "p.html"), HasSubstr(said));
  write("spring.toml",
        "[world]\nduration = 2\n[[bodies]]\ndisc = { radius = 0.1 }\nname = \"a\"\nposition = [1, 0]\n"
        "[[bodies]]\ndisc = { radius = 0.1 }\nname = \"b\"\n[[forces]]\nkind = \"spring\"\n"
        "bodies = [\"a\", \"b\"]\nstiffness = 40\nrest_length = 0.7\n");
  ASSERT_EQ(brink("run spring.toml --out s --quiet --set output.frame_interval=0").status, 0);
  EXPECT_THAT(brink("draw s --at 1 -o p.png").error, HasSubstr("between two frames alone"));
  ASSERT_EQ(brink("run spring.toml --out s --quiet --set output.frame_interval=0.1").status, 0);
  EXPECT_EQ(brink("draw s --at 1 -o p.png").error, "");
}

// Samples stand in a file of their own, of which a run file has no more than the world that they made.
TEST_F(ProgramTest, ARunOfSamplesThatHaveChangedIsNotRunAgain) {
  write("a.smp", "4\n1 0 0 0 0 0 0\n0 0\n1 0\n1 1\n0 1\n");
  write("s.toml", "[world]\nduration = 0.1\n[[bodies]]\nsamples = { file = \"a.smp\" }\n");
  ASSERT_EQ(brink("run s.toml --out a --quiet").status, 0);
  EXPECT_EQ(brink("run a/run.db --out b --quiet").status, 0);
  write("a.smp", "4\n1 0 0 5 0 0 0\n0 0\n1 0\n1 1\n0 1\n");
  const Outcome again = brink("run a/run.db --out c --quiet");
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.error, HasSubstr("a.smp"));
}

TEST_F(ProgramTest, TablesAreExportedWithUnitsInTheirHeads) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet").status, 0);
  ASSERT_EQ(brink("export a --csv tables").status, 0);
  EXPECT_THAT(text_of(dir_ / "tables/bodies.csv"), HasSubstr("body,name,mass_kg,inertia_kg_m2\n0,ball,1,"));
  EXPECT_THAT(text_of(dir_ / "tables/frames.csv"), HasSubstr("\n0.25,0,0,1.25,0,0,-2,0\n"));
  EXPECT_THAT(text_of(dir_ / "tables/events.csv"),
              ::testing::ContainsRegex("0,0.[45][0-9]*,collision,0,,0,"));
  EXPECT_EQ(brink("export ball.toml --csv tables").status, 2);
  EXPECT_EQ(brink("export a").status, 2);
  const Outcome hdf5 = brink("export a --hdf5 tables");
  EXPECT_TRUE(hdf5.status == 0 || hdf5.error.find("libhdf5-dev") != std::string::npos) << hdf5.error;
  if (hdf5.status == 0) {
    const std::string file = text_of(dir_ / "tables/run.h5");
    EXPECT_EQ(file.substr(1, 3), "HDF");
    // The attribute of each array is in the file by its name: 3 of bodies, 7 of frames, 13 of events, 12 of
    // contacts, 12 of knots.
    const std::string name("unit\0", 5);
    int units = 0;
    for (std::size_t at = file.find(name); at != std::string::npos; at = file.find(name, at + 1)) ++units;
    EXPECT_EQ(units, 3 + 7 + 13 + 12 + 12);
  }
  const Outcome vtk = brink("export a --vtk shown");
  EXPECT_TRUE(vtk.status == 0 || vtk.error.find("libvtk9-dev") != std::string::npos) << vtk.error;
  EXPECT_EQ(fs::exists(dir_ / "shown"), vtk.status == 0) << "nothing is made in vain";
  if (vtk.status != 0) {
    EXPECT_EQ(brink("export a --csv both --vtk both").status, 2);
    EXPECT_FALSE(fs::exists(dir_ / "both"));
  } else {
    EXPECT_THAT(text_of(dir_ / "shown/run.pvd"), HasSubstr("timestep=\"0.25\" file=\"frame_000001.vtp\""));
    EXPECT_THAT(text_of(dir_ / "shown/frame_000001.vtp"), HasSubstr("Name=\"thickness\""));
    EXPECT_THAT(text_of(dir_ / "shown/events.vtp"), HasSubstr("NumberOfPoints=\"1\""));
  }
  for (const char* missing :
       {"export nothing.db --csv none", "export nothing --csv none", "film nothing -o f.png",
        "film nothing.db -o f.png", "view nothing", "draw nothing -o f.png", "run nothing"})
    EXPECT_EQ(brink(missing).status, 3) << missing;
  EXPECT_FALSE(fs::exists(dir_ / "none"));
}

TEST_F(ProgramTest, ViewsOfARunFileAnswerWithUnits) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet").status, 0);
  SQLite::Database db((dir_ / "a/run.db").string());
  const double energy =
      db.execAndGet("SELECT kinetic_J + of_gravity_J FROM energy_over_time WHERE t_s = 0.25").getDouble();
  EXPECT_NEAR(energy, 12.0, 1e-12);
  EXPECT_EQ(db.execAndGet("SELECT with_what FROM contacts_of WHERE body = 'ball'").getString(), "floor");
  EXPECT_EQ(db.execAndGet("SELECT count(*) FROM body_path").getInt(), 4);
  EXPECT_EQ(db.execAndGet("SELECT events_in_a_tenth_of_a_second FROM timeline").getInt(), 1);
}

TEST_F(ProgramTest, APageShowsATraceInItsLanes) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet --trace trace.json").status, 0);
  ASSERT_EQ(brink("view a --trace trace.json -o page.html").status, 0);
  EXPECT_THAT(text_of(dir_ / "page.html"), HasSubstr("\"trace_kinds\":[\"advance\",\"back up\""));
  ASSERT_EQ(brink("view a -o plain.html").status, 0);
  EXPECT_THAT(text_of(dir_ / "plain.html"), ::testing::Not(HasSubstr("\"trace_kinds\"")));
  EXPECT_EQ(brink("view ball.toml --trace trace.json").status, 2);
  EXPECT_EQ(brink("view a --trace nothing.json -o page.html").status, 3);
  EXPECT_EQ(brink("view a --trace ball.toml -o page.html").status, 3) << "no trace";
  std::ofstream(dir_ / "far.json") << R"([{"name":"pass","tid":7,"args":{"from":0,"to":1}}])";
  const Outcome far = brink("view a --trace far.json -o page.html");
  EXPECT_EQ(far.status, 3);
  EXPECT_THAT(far.error, HasSubstr("far.json: a pass of body 7"));
}

// The page of a run that ends early is written, and the status says how the run ended.
TEST_F(ProgramTest, AViewOfASceneThatEndsEarlyIsStatusOne) {
  const Outcome view = brink("view ball.toml -o page.html --set solver.max_collisions=1");
  EXPECT_EQ(view.status, 1) << view.error;
  EXPECT_THAT(view.error, HasSubstr("max_collisions"));
  EXPECT_TRUE(fs::exists(dir_ / "page.html"));
  EXPECT_EQ(brink("view ball.toml -o page2.html").status, 0);
}

// The scene file may be gone.
TEST_F(ProgramTest, ARunIsRunAgainFromItsRunFile) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet --set world.duration=1.25 --set bodies.0.mass=3").status, 0);
  fs::remove(dir_ / "ball.toml");
  ASSERT_EQ(brink("run a/run.db --out b --quiet").status, 0);
  const RunFile first(dir_ / "a/run.db"), again(dir_ / "b/run.db");
  EXPECT_EQ(first.meta("state_hash"), again.meta("state_hash"));
  EXPECT_EQ(again.end_time(), 1.25);
  EXPECT_EQ(again.bodies()[0].mass, 3.0);
  ASSERT_EQ(brink("run a --out c --quiet --set world.duration=0.5").status, 0);
  EXPECT_EQ(RunFile(dir_ / "c/run.db").end_time(), 0.5);
}

TEST_F(ProgramTest, UntilHasTheLimitsOfDuration) {
  for (const char* until : {"1e13", "1e-13", "inf"}) {
    const Outcome run = brink(std::string("run ball.toml --out a --until ") + until);
    EXPECT_EQ(run.status, 2) << until;
    EXPECT_THAT(run.error, HasSubstr("ball.toml:0:0: --until: out of range; given ")) << until;
  }
  EXPECT_FALSE(fs::exists(dir_ / "a"));
}

// One body for 1e9 s at 0.25 s: 4e9 rows of frames.
TEST_F(ProgramTest, MoreFramesThanAllowedAreRefusedWithTheOptionThatAllowsThem) {
  const Outcome run = brink("run ball.toml --out a --until 1e9");
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.error, HasSubstr("output.max_frame_rows"));
  const Outcome check = brink("check ball.toml --set world.duration=1e9");
  EXPECT_EQ(check.status, 2);
  EXPECT_THAT(check.error, HasSubstr("output.max_frame_rows"));
  const char* const wide = "check ball.toml --set world.duration=1e9 --set output.max_frame_rows=5000000000";
  EXPECT_EQ(brink(wide).status, 0);
  EXPECT_THAT(brink("list options").out, HasSubstr("output.max_frame_rows"));
}

// A run may be made longer than its limit of frames allowed at first.
TEST_F(ProgramTest, LimitOfFramesMayBeRaisedOnResuming) {
  ASSERT_EQ(brink("run ball.toml --out a --set output.max_frame_rows=5").status, 0);
  EXPECT_EQ(brink("run ball.toml --out a --resume --until 1.5 --set output.max_frame_rows=5").status, 2);
  EXPECT_EQ(brink("run ball.toml --out a --resume --until 1.5 --set output.max_frame_rows=8").status, 0);
}

TEST_F(ProgramTest, WhatIsReadIsNotWrittenOver) {
  ASSERT_EQ(brink("run ball.toml --out a").status, 0);
  fs::create_hard_link(dir_ / "ball.toml", dir_ / "link.toml");
  const std::string scene = text_of(dir_ / "ball.toml"), run = text_of(dir_ / "a/run.db");
  for (const char* command :
       {"run ball.toml --out b --trace ball.toml", "run ball.toml --out b --trace ./a/../link.toml",
        "run ball.toml --out b --trace b/run.db", "run ball.toml --out b --trace a/run.db",
        "draw ball.toml -o ball.toml", "draw a -o a/run.db", "draw ball.toml -o a/run.db"})
    EXPECT_EQ(brink(command).status, 2) << command;
  EXPECT_EQ(text_of(dir_ / "ball.toml"), scene);
  EXPECT_EQ(text_of(dir_ / "a/run.db"), run);
}

// Samples in files whose names are those of what is written, of a scene that is read, of a run that was made of it.
TEST_F(ProgramTest, WhatAScenesFilesHoldIsNotWrittenOver) {
  const char* const files[] = {"smp.png", "smp.html", "smp.mp4",  "bodies.csv",
                               "run.h5",  "run.pvd",  "sweep.csv"};
  std::string scene = "[world]\nduration = 0.1\n[output]\nframe_interval = 0.05\n";
  double x = 0.0;
  for (const char* file : files) {
    write(file, "4\n1 0 0 0 0 0 0\n0 0\n1 0\n1 1\n0 1\n");
    scene += std::string("[[bodies]]\nsamples = { file = \"") + file + "\" }\nposition = [" +
             std::to_string(x += 3.0) + ", 0]\n";
  }
  write("smp.toml", scene);
  write("exp.toml", "scenes = [\"smp.toml\"]\n[axes]\nworld.duration = [0.1, 0.2]\n");
  ASSERT_EQ(brink("run smp.toml --out a --quiet --trace trace.json").status, 0);
  const std::string samples = text_of(dir_ / "smp.png"), trace = text_of(dir_ / "trace.json");
  for (const char* command :
       {"run smp.toml --out b --trace smp.png", "draw smp.toml -o smp.png", "view smp.toml -o smp.html",
        "view smp.toml -o smp.toml", "run a/run.db --out b --trace smp.png", "run a --out b --trace smp.toml",
        "draw a -o smp.png", "view a -o smp.toml", "view a -o smp.html", "view a/run.db -o a/../smp.toml",
        "view a --trace trace.json -o trace.json", "film a -o smp.mp4", "export a --csv .",
        "export a --hdf5 .", "export a --vtk .", "sweep exp.toml --out ."}) {
    const Outcome run = brink(command);
    EXPECT_EQ(run.status, 2) << command;
    EXPECT_THAT(run.error, HasSubstr("read or kept by this command")) << command << ": " << run.error;
  }
  EXPECT_EQ(text_of(dir_ / "smp.toml"), scene);
  EXPECT_EQ(text_of(dir_ / "trace.json"), trace);
  for (const char* file : files) EXPECT_EQ(text_of(dir_ / file), samples) << file;
  EXPECT_FALSE(fs::exists(dir_ / "b"));
  EXPECT_FALSE(fs::exists(dir_ / "runs"));
  // Seen from elsewhere, too, where the scene's name is no path to it; what is gone is nobody's.
  EXPECT_EQ(
      brink("--version >/dev/null && cd a && '" BRINK_BINARY_DIR "/bin/brink' view run.db -o ../smp.toml")
          .status,
      2);
  EXPECT_EQ(text_of(dir_ / "smp.toml"), scene);
  fs::remove(dir_ / "smp.html");
  EXPECT_EQ(brink("view a -o smp.html").status, 0);
}

// Names and titles are data: nothing in them reaches the terminal as a control, and a fault stays one line.
TEST_F(ProgramTest, TextFromFilesIsPrintedEscaped) {
  std::string named = kBall;
  named.replace(named.find("\"ball\""), 6, R"("\u001b[2J\u202e\nx")");
  named.replace(named.find("\"ball\"", named.find("[[bodies]]")), 6, R"("b\n\u001b[31m")");
  write("named.toml", named);
  const Outcome run = brink("run named.toml --out a");
  EXPECT_EQ(run.status, 0) << run.error;
  EXPECT_THAT(run.out, HasSubstr("\\x1b[2J\\u202e\\nx"));
  const Outcome low = brink("check named.toml --set 'bodies.0.position=[0, 0.4]'");
  EXPECT_THAT(low.out, HasSubstr("'b\\n\\x1b[31m'"));
  const Outcome stuck = brink("run named.toml --out b --set 'bodies.0.position=[0, 0.4]'");
  EXPECT_EQ(stuck.status, 2);
  EXPECT_EQ(std::count(stuck.error.begin(), stuck.error.end(), '\n'), 1);
  EXPECT_THAT(run.out + low.out + stuck.out + stuck.error, Not(HasSubstr("\033")));
}

TEST_F(ProgramTest, DamagedRunFilesAreStatusThreeWithTheirTable) {
  ASSERT_EQ(brink("run ball.toml --out a").status, 0);
  SQLite::Database((dir_ / "a/run.db").string(), SQLite::OPEN_READWRITE)
      .exec("UPDATE body SET shape = '[1'; UPDATE meta SET value = 'x' WHERE key = 'end_time'");
  const Outcome drawn = brink("draw a -o x.png");
  EXPECT_EQ(drawn.status, 3);
  EXPECT_THAT(drawn.error, HasSubstr("table body"));
  const Outcome resumed = brink("run ball.toml --out a --resume");
  EXPECT_EQ(resumed.status, 3);
  EXPECT_THAT(resumed.error, HasSubstr("table meta"));
}

TEST_F(ProgramTest, FullDiskBehindStandardOutputIsStatusThree) {
  const std::string command =
      "cd '" + dir_.string() + "' && '" BRINK_BINARY_DIR "/bin/brink' list options >/dev/full 2>/dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 3);
}

// A run of 4 MB, with room for half of it, and then for all.
class FullDisk : public ProgramTest {
 protected:
  FullDisk() { EXPECT_EQ(brink("run ball.toml --out whole --quiet" + many_).status, 0); }

  /// What a script of bash prints in the test's folder, where `run` is the command without --out.
  std::string printed(const std::string& script) {
    write("script.sh", "run() { '" BRINK_BINARY_DIR "/bin/brink' run ball.toml --quiet" + many_ +
                           " \"$@\" 2>error.txt; }\n" + script);
    const std::string command = "cd '" + dir_.string() + "' && " + shell_ + " script.sh >printed.txt 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return text_of(dir_ / "printed.txt");
  }
  /// That the run in `out` is the one that nothing disturbed.
  void expect_whole(const char* out) {
    const RunFile run(dir_ / out / "run.db"), whole(dir_ / "whole/run.db");
    EXPECT_EQ(run.meta("termination"), "reached_end");
    EXPECT_EQ(run.meta("state_hash"), whole.meta("state_hash"));
    EXPECT_EQ(run.frame_count(), whole.frame_count());
    EXPECT_EQ(run.event_count(), whole.event_count());
    EXPECT_NO_THROW(run.require_sound());
  }

  const std::string many_ = " --until 40 --set output.frame_interval=5e-4";
  std::string shell_ = "bash";
};

// A file system in memory, in a mount space of the script's own: it is gone with the script.
TEST_F(FullDisk, IsStatusThreeWithItsCauseAndTheRunGoesOnWhenThereIsRoom) {
  shell_ = "unshare -m bash";
  if (::geteuid() != 0 || std::system("unshare -m sh -c 'mount -t tmpfs none /mnt' 2>/dev/null") != 0)
    GTEST_SKIP() << "no file system can be mounted here: needs root in a space of its own";
  const std::string told = printed(
      "mkdir small && mount -t tmpfs -o size=2m none small && run --out small; echo $?; cat error.txt\n"
      "run --out small --resume; echo $?; cat error.txt\n"
      "mount -o remount,size=64m small && run --out small --resume; echo $?; cat error.txt\n"
      "cp -r small kept\n");
  const std::string full = "3\nbrink: small/run.db: cannot be read or written as a run file: disk full\n";
  EXPECT_EQ(told, full + full + "0\n");
  expect_whole("kept");
}

// A limit on the size of files stops the same writes, as an error of the device.
TEST_F(FullDisk, AWriteThatFailsIsStatusThreeAndTheRunGoesOnAfterwards) {
  const std::string told = printed(
      "(trap '' XFSZ; ulimit -f 1024; run --out small; echo $?; cat error.txt)\n"
      "run --out small --resume; echo $?; cat error.txt\n");
  EXPECT_EQ(told, "3\nbrink: small/run.db: cannot be read or written as a run file: disk I/O error\n0\n");
  expect_whole("small");
}

// Half a picture, page or table is of no use to anybody; whole ones stay.
TEST_F(FullDisk, NoHalfOfAFileIsLeft) {
  const std::string told = printed(
      "b='" BRINK_BINARY_DIR
      "/bin/brink'\n"
      "(trap '' XFSZ; ulimit -f 4; $b draw whole -o a.png; echo $?; $b view whole -o a.html; echo $?\n"
      "$b export whole --csv tables; echo $?) 2>&1\n"
      "ls a.png a.html tables 2>/dev/null || true\n");
  const std::string cause = "could not be written: File too large\n3\n";
  EXPECT_EQ(told, "brink: a.png: " + cause + "brink: a.html: " + cause +
                      "brink: tables/frames.csv: " + cause + "tables:\nbodies.csv\nsites.csv\n");
}

TEST_F(ProgramTest, WhatCannotBeReadOrWrittenIsStatusThree) {
  EXPECT_EQ(brink("run absent.toml").status, 3);
  EXPECT_EQ(brink("run ball.toml --out ball.toml/x").status, 3);
  write("plain.db", std::string(4096, 'x'));
  EXPECT_EQ(brink("draw plain.db -o x.png").status, 3);
}

// A disc in a hole of its own size.
TEST_F(ProgramTest, AGroupThatIsTakenIsNamedInTheSummaryAndInTheJson) {
  write("hole.toml", R"([world]
duration = 1
[[sites]]
name = "hole"
box = { width = 2, height = 2 }
inside_of = true
[[bodies]]
name = "disc"
disc = { radius = 1 }
velocity = [1, 0.3]
)");
  const Outcome run = brink("run hole.toml --out a --json");
  EXPECT_EQ(run.status, 1) << run.error;
  const auto summary = nlohmann::json::parse(last_line(run.out));
  EXPECT_GE(summary["groups_taken"], 1);
  const std::string first = summary["first_taken"];
  EXPECT_THAT(first, ::testing::StartsWith("'disc' on 'hole' at t = 0"));
  EXPECT_THAT(brink("run hole.toml --out b").out, HasSubstr("the first " + first));
  EXPECT_EQ(nlohmann::json::parse(last_line(brink("run ball.toml --json").out))["first_taken"], "");
}

TEST_F(ProgramTest, RunThatEndsEarlyIsStatusOneAndSaysWhy) {
  const Outcome run = brink("run ball.toml --out a --set solver.max_collisions=1");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.out, HasSubstr("stopped at t ="));
  EXPECT_EQ(RunFile(dir_ / "a/run.db").meta("termination"), "stopped");
}

TEST_F(ProgramTest, AFormulaThatStopsBeingANumberIsNamedWithItsTime) {
  for (const char* integrator : {"auto", "rk4", "adams", "bdf"}) {
    write("root.toml",
          "[world]\nduration = 3\n[[bodies]]\nname = \"sled\"\ndisc = { radius = 0.5 }\n"
          "[[forces]]\nkind = \"formula\"\nfx = \"sqrt(1.25-t)\"\n");
    const Outcome run = brink(std::string("run root.toml --json --out ") + integrator +
                              " --set solver.integrator=" + integrator);
    EXPECT_EQ(run.status, 1) << integrator;
    const auto summary = nlohmann::json::parse(last_line(run.out));
    EXPECT_NEAR(summary["end_time"].get<double>(), 1.25, 2e-3) << integrator;
    EXPECT_THAT(run.error, HasSubstr("the formula fx = \"sqrt(1.25-t)\" is not finite at t = 1.25"))
        << integrator;
    EXPECT_THAT(run.error, ::testing::AllOf(HasSubstr("for 'sled'"), Not(HasSubstr("position"))))
        << integrator;
  }
}

TEST_F(ProgramTest, AnOverlapAtTheStartIsToldWithItsPlace) {
  write("sunk.toml", std::string(kBall) + "[[bodies]]\ndisc = { radius = 0.5 }\nposition = [0.5, 1.5]\n");
  for (const char* command :
       {"run sunk.toml", "draw sunk.toml --at 0.1 -o x.png", "view sunk.toml -o x.html"}) {
    const Outcome run = brink(command);
    EXPECT_EQ(run.status, 2) << command;
    EXPECT_THAT(run.error, HasSubstr("sunk.toml:11:1: ")) << command;
  }
}

TEST_F(ProgramTest, ResumingAFinishedRunSaysSoAndChangesNothing) {
  ASSERT_EQ(brink("run ball.toml --out a").status, 0);
  const std::string before = text_of(dir_ / "a/run.db");
  const Outcome again = brink("run ball.toml --out a --resume");
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.out, HasSubstr("nothing to do"));
  EXPECT_EQ(text_of(dir_ / "a/run.db"), before);
}

// A run to 0.6 s gone on with to 1.5 s is the run to 1.5 s: no frame is left at 0.6 s, which is off the frame
// clock.
TEST_F(ProgramTest, RunCanBeMadeLonger) {
  ASSERT_EQ(brink("run ball.toml --out a --until 0.6").status, 0);
  ASSERT_EQ(brink("run ball.toml --out a --until 1.5 --resume").status, 0);
  ASSERT_EQ(brink("run ball.toml --out b --until 1.5").status, 0);
  const RunFile a(dir_ / "a/run.db"), b(dir_ / "b/run.db");
  EXPECT_EQ(a.meta("state_hash"), b.meta("state_hash"));
  EXPECT_EQ(a.events().size(), b.events().size());
  EXPECT_EQ(a.frame_at(0.6).t, 0.5);
}

TEST_F(ProgramTest, ResumingWithAnotherOptionIsStatusTwoAndNamesIt) {
  ASSERT_EQ(brink("run ball.toml --out a --until 0.6").status, 0);
  const Outcome run = brink("run ball.toml --out a --resume --set solver.tolerance=1e-6");
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.error, HasSubstr("tolerance was"));
}

TEST_F(ProgramTest, CheckPrintsContentsPlanAndOverlaps) {
  const Outcome check = brink("check ball.toml");
  EXPECT_EQ(check.status, 0);
  EXPECT_THAT(check.out, HasSubstr("1 body, 1 fixed site, 0 forces"));
  EXPECT_THAT(check.out, HasSubstr("1 of 1 bodies ballistic in closed form"));
  EXPECT_THAT(check.out, HasSubstr("pairs: 1 of 1 have a first contact in closed form"));
  EXPECT_THAT(brink("check ball.toml --set solver.closed_forms=false").out,
              HasSubstr("closed form (not left out: solver.closed_forms = false)"));
  EXPECT_THAT(check.out, HasSubstr("Overlaps at the start\n  none"));
  // 0.1 m lower than touching: the ball reaches 0.1 m into the floor
  const Outcome low = brink("check ball.toml --set 'bodies.0.position=[0, 0.4]'");
  EXPECT_EQ(low.status, 0);
  EXPECT_THAT(low.out, HasSubstr("'ball' and 'floor' by 0.1 m"));
}

// Two unit boxes shifted by (0.75, 0.5) m share 0.25 x 0.5 m.
TEST_F(ProgramTest, CheckCountsTheAreaOfOverlaps) {
  write("two.toml",
        "[[bodies]]\nname = \"a\"\nbox = { width = 1, height = 1 }\n"
        "[[bodies]]\nname = \"b\"\nbox = { width = 1, height = 1 }\nposition = [0.75, 0.5]\n");
  const Outcome check = brink("check two.toml");
  EXPECT_EQ(check.status, 0) << check.error;
  EXPECT_THAT(check.out, HasSubstr("'a' and 'b' by 0.25 m, 0.125 +- 0.00"));
  EXPECT_THAT(check.out, HasSubstr("pixels counted"));
}

// All pairs would be 5e9, and take an hour.
TEST_F(ProgramTest, CheckLooksAtAHundredThousandBodies) {
  write("many.toml",
        "[[sites]]\nname = \"floor\"\nsegment = [[-10, -1], [1000, -1]]\n"
        "[[bodies]]\nname = \"disc\"\ndisc = { radius = 0.5 }\n"
        "grid = { columns = 400, rows = 250, spacing = [1.25, 1.25] }\n"
        "[[bodies]]\nname = \"low\"\ndisc = { radius = 0.5 }\nposition = [0, -0.6]\n");
  const double before = children_seconds();
  const Outcome check = brink("check many.toml");
  EXPECT_LT(children_seconds() - before, 30.0);
  EXPECT_EQ(check.status, 0) << check.error;
  EXPECT_THAT(check.out, HasSubstr("100001 bodies"));
  EXPECT_THAT(check.out, HasSubstr("'disc[0]' and 'low' by 0.4 m"));
  EXPECT_THAT(check.out, HasSubstr("'low' and 'floor' by 0.1 m"));
  EXPECT_EQ(check.out.find("warning"), check.out.find("warning: 'disc[0]'")) << check.out;
}

TEST_F(ProgramTest, FaultsOfASampleFileNameItsOwnLineAndColumn) {
  write("square.rb", "2\n1 0 0 0 0 0 0   // the state\n0 0\n  1 x\n");
  write("square.toml", "[[bodies]]\nsamples = { file = \"square.rb\" }\n");
  const Outcome check = brink("check square.toml");
  EXPECT_EQ(check.status, 2);
  EXPECT_THAT(check.error, HasSubstr("square.rb:4:5: "));
  EXPECT_THAT(check.error, HasSubstr("given \"x\""));
}

// As bash asks for it: the last word is being written.
TEST_F(ProgramTest, CompletionKnowsCommandsOptionsTopicsAndFiles) {
  const auto completed = [&](const std::string& line) {
    const std::string script = "cd '" + dir_.string() +
                               "'; PATH='" BRINK_BINARY_DIR
                               "/bin':\"$PATH\"; "
                               "source '" BRINK_SOURCE_DIR
                               "/scenes/program/install/brink.bash'; "
                               "COMP_WORDS=(" +
                               line +
                               "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _brink; "
                               "echo \"${COMPREPLY[*]}\"";
    std::ofstream(dir_ / "complete.sh") << script;
    const std::string out = (dir_ / "completed.txt").string();
    EXPECT_EQ(std::system(("bash '" + (dir_ / "complete.sh").string() + "' > '" + out + "'").c_str()), 0);
    return text_of(out);
  };
  EXPECT_EQ(completed("brink swe"), "sweep\n");
  EXPECT_EQ(completed("brink list po"), "policies\n");
  EXPECT_EQ(completed("brink list ba"), "\n");
  EXPECT_EQ(completed("brink run --prof"), "--profile\n");
  EXPECT_EQ(completed("brink run bal"), "ball.toml\n");
}

TEST_F(ProgramTest, ListShowsEveryTopicWithItsDefault) {
  const Outcome all = brink("list");
  ASSERT_EQ(all.status, 0);
  for (const char* topic :
       {"policies", "integrators", "responses", "detectors", "orders", "forces", "scenes", "options"}) {
    const Outcome one = brink(std::string("list ") + topic);
    EXPECT_EQ(one.status, 0) << topic;
    EXPECT_THAT(one.out, HasSubstr("  ")) << topic;  // at least one line, name and text
    EXPECT_THAT(all.out, HasSubstr(one.out)) << topic;
  }
  EXPECT_THAT(brink("list policies").out, HasSubstr("(default)"));
  EXPECT_THAT(brink("list forces").out, HasSubstr("spring"));
}

TEST_F(ProgramTest, HelpOfEveryCommandHasExamples) {
  std::vector<std::string> all = commands();
  EXPECT_GE(all.size(), 9U);
  all.emplace_back("");
  for (const std::string& command : all) {
    const Outcome help = brink(command + " --help");
    EXPECT_EQ(help.status, 0) << command;
    EXPECT_THAT(help.out, HasSubstr("Examples:")) << command;
  }
}

// Exact policies agree to the bit, and reach the known answer to rounding; a fixed step does not.
TEST_F(ProgramTest, BenchMeasuresAProblemWithAKnownAnswer) {
  const Outcome bench = brink("bench dropped_disc --repeats 1 --out b");
  ASSERT_EQ(bench.status, 0) << bench.error;
  EXPECT_EQ(text_of(dir_ / "b" / "bench.png").substr(1, 3), "PNG");
  std::istringstream table(text_of(dir_ / "b" / "bench.csv"));
  std::string line, hash_of_exact;
  std::getline(table, line);
  EXPECT_EQ(line.rfind("problem,series,setting,approximate,error,", 0), 0U);
  int exact = 0, approximate = 0;
  while (std::getline(table, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    const double error = std::stod(cells.at(4));
    if (cells.at(3) == "1") {
      ++approximate;
      EXPECT_GT(error, 1e-9) << line;
    } else if (cells.at(2) == "closed form") {
      EXPECT_LT(error, 1e-13) << line;
      if (exact++ == 0) hash_of_exact = cells.at(12);
      EXPECT_EQ(cells.at(12), hash_of_exact) << line;
    }
  }
  EXPECT_EQ(exact, static_cast<int>(exact_policies().size()));
  EXPECT_GE(approximate, 3);
  EXPECT_EQ(brink("bench nonesuch").status, 2);
}

std::vector<std::vector<std::string>> cells_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream table(csv);
  for (std::string line; std::getline(table, line);) {
    std::istringstream row(line);
    std::vector<std::string>& cells = rows.emplace_back();
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
  }
  return rows;
}

// By modes every digit that is asked for, in steps two or three; heaps come to rest with nobody in anybody else.
TEST_F(ProgramTest, BenchRestMeasuresContactsThatLast) {
  const Outcome bench = brink("bench rest --out r");
  ASSERT_EQ(bench.status, 0) << bench.error;
  EXPECT_EQ(text_of(dir_ / "r" / "rest.png").substr(1, 3), "PNG");
  std::map<std::string, std::set<std::string>> hashes;  // of a problem, by series
  int modes = 0, steps = 0, settled = 0;
  for (const auto& row : cells_of(text_of(dir_ / "r" / "rest.csv"))) {
    if (row.at(1) != "modes" && row.at(1) != "steps") continue;
    const bool by_modes = row.at(1) == "modes";
    ++(by_modes ? modes : steps);
    EXPECT_LT(std::stod(row.at(4)), by_modes ? 1e-9 : 0.05) << row.at(0);
    hashes[row.at(0) + row.at(1)].insert(row.at(12));
  }
  for (const auto& row : cells_of(text_of(dir_ / "r" / "settling.csv"))) {
    if (row.at(1) != "Brink") continue;
    ++settled;
    EXPECT_LT(std::stod(row.at(2)), 8.0) << row.at(0);
    EXPECT_LT(std::stod(row.at(4)), 1e-9) << row.at(0);
  }
  EXPECT_EQ(modes, 12);
  EXPECT_EQ(steps, 3);
  for (const char* problem : {"rolling_bowl", "rolling_down", "stopping_block"})
    for (const std::string& hash : hashes[std::string(problem) + "steps"])
      EXPECT_EQ(hashes[std::string(problem) + "modes"].count(hash), 0U) << problem;
  EXPECT_EQ(settled, 3);
}

TEST_F(ProgramTest, AKeyOfBeforeIsAFaultThatNamesTheNewOne) {
  const Outcome check = brink("check ball.toml --set solver.skip_broad_phase=false");
  EXPECT_EQ(check.status, 2);
  EXPECT_THAT(check.error, HasSubstr("key \"skip_broad_phase\" in solver is called \"broad_phase\" now"));
  EXPECT_THAT(brink("check ball.toml --set solver.skip_fields=true").error,
              HasSubstr("\"fields_for_small_shapes\" now, with the opposite meaning"));
}

TEST_F(ProgramTest, PicturesOfASceneAndOfItsRunAreWritten) {
  ASSERT_EQ(brink("run ball.toml --out a").status, 0);
  for (const char* command :
       {"draw ball.toml --at 0.25 --size 64x48 -o x.png", "draw a --at 0.3 --size 64x48 -o x.png",
        "draw a/run.db --size 64x48 -o x.png"}) {
    fs::remove(dir_ / "x.png");
    const Outcome drawn = brink(command);
    EXPECT_EQ(drawn.status, 0) << command << "\n" << drawn.error;
    EXPECT_EQ(text_of(dir_ / "x.png").substr(1, 3), "PNG") << command;
  }
  EXPECT_EQ(brink("draw a --at 7 -o x.png").status, 2);
}

TEST_F(ProgramTest, TheLastRunIsGoneOnWithThoughTheFirstHasBeenDeleted) {
  for (int k = 0; k < 3; ++k) ASSERT_EQ(brink("run ball.toml --quiet").status, 0);
  fs::remove_all(dir_ / "runs/ball-1");
  // Others beside: without a run file, without a number, of another scene.
  for (const char* other : {"ball-7", "ball-x", "balls-9"}) fs::create_directories(dir_ / "runs" / other);
  const Outcome resumed = brink("run ball.toml --resume");
  EXPECT_THAT(resumed.out, HasSubstr("runs/ball-3/run.db: has already reached t = 0.75 s"));
  EXPECT_FALSE(fs::exists(dir_ / "runs/ball-1"));
}

TEST_F(ProgramTest, APictureOfARunTakesNoOverrides) {
  ASSERT_EQ(brink("run ball.toml --out a --quiet").status, 0);
  const Outcome drawn = brink("draw a -o x.png --set world.gravity.1=3");
  EXPECT_EQ(drawn.status, 2);
  EXPECT_THAT(drawn.error, HasSubstr("--set: is for scenes; a run has been made"));
  EXPECT_FALSE(fs::exists(dir_ / "x.png"));
}

TEST_F(ProgramTest, AreaOfAnOverlapIsThatWhereTheSiteStarts) {
  const auto overlaps = [&](const std::string& site) {
    write("over.toml", "[world]\nduration = 1\n[[sites]]\nname = \"s\"\nbox = { width = 1, height = 1 }\n" +
                           site +
                           "\n[[bodies]]\nname = \"b\"\nbox = { width = 1, height = 1 }\n"
                           "position = [4.5, 0.3]\n");
    const std::string out = brink("check over.toml").out;
    return out.substr(out.find("Overlaps at the start"));
  };
  const std::string moved = overlaps("motion = { x = \"4 + 0*t\" }");
  EXPECT_THAT(moved, HasSubstr("'b' and 's'"));
  EXPECT_EQ(moved, overlaps("position = [4, 0]"));
}

TEST_F(ProgramTest, ExportedNamesAreNoFormulas) {
  const auto row_of = [&](const std::string& name) {
    write("odd.toml",
          "[world]\nduration = 0.1\n[[bodies]]\nname = \"" + name + "\"\ndisc = { radius = 0.5 }\n");
    EXPECT_EQ(brink("run odd.toml --quiet --out odd").status, 0);
    EXPECT_EQ(brink("export odd --csv tables").status, 0);
    return text_of(dir_ / "tables/bodies.csv");
  };
  EXPECT_THAT(row_of("=1+2"), HasSubstr("\n0,'=1+2,1,"));
  EXPECT_THAT(row_of("-a,b"), HasSubstr("\n0,\"'-a,b\",1,"));
  EXPECT_THAT(row_of("a=1"), HasSubstr("\n0,a=1,1,"));
}

}  // namespace
}  // namespace brink::program_test
