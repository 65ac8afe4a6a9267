// brink regress: what it says of every scene, its exit status, and that the table is whole or as it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace brink::regress_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

const char* const kProgram = BRINK_BINARY_DIR "/bin/brink";

struct Outcome {
  int status = -1;
  std::string out, error;
};

/// A ball over a floor, which it meets after 0.5 s.
std::string ball(const std::string& more = "", const std::string& duration = "0.75") {
  return "[world]\nduration = " + duration +
         "\ngravity = [0, -8]\n[[sites]]\nname = \"floor\"\nsegment = [[-1, 0], [1, 0]]\n"
         "[[bodies]]\nname = \"ball\"\ndisc = { radius = 0.5 }\nposition = [0, 1.5]\n" +
         more;
}

class Regress : public ::testing::Test {
 protected:
  Regress() {
    std::string name = (fs::temp_directory_path() / "brink-regress-XXXXXX").string();
    dir_ = ::mkdtemp(name.data());
    fs::create_directory(dir_ / "scenes");
    write("scenes/ball.toml", ball());
    write("scenes/late.toml", ball("", "0.25"));
  }
  ~Regress() override { fs::remove_all(dir_); }

  void write(const fs::path& name, const std::string& text) { std::ofstream(dir_ / name) << text; }
  std::string text_of(const fs::path& name) {
    std::ifstream in(dir_ / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string table() { return text_of("scenes/answers.csv"); }

  Outcome regress(const std::string& arguments) {
    const std::string command =
        "cd '" + dir_.string() + "' && '" + kProgram + "' regress " + arguments + " >out.txt 2>error.txt";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of("out.txt"), text_of("error.txt")};
  }

  fs::path dir_;
};

TEST_F(Regress, WhatIsStoredIsMetAgain) {
  const Outcome first = regress("scenes");
  EXPECT_EQ(first.status, 1);
  EXPECT_THAT(first.out,
              HasSubstr("new      ball: no stored answer; met reached_end at t = 0.75 s, 1 collisions"));
  EXPECT_THAT(first.out, HasSubstr("0 same, 0 differ, 2 new, 0 gone, 0 not comparable on this machine\n"));
  EXPECT_FALSE(fs::exists(dir_ / "scenes/answers.csv"));

  const Outcome stored = regress("scenes --update");
  EXPECT_EQ(stored.status, 0) << stored.error;
  EXPECT_THAT(table(), HasSubstr("\nball,reached_end,0.75,1,12,"));
  EXPECT_THAT(table(), HasSubstr(",first stored\n"));

  const Outcome again = regress("scenes");
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(
      again.out,
      "same     ball\nsame     late\n2 same, 0 differ, 0 new, 0 gone, 0 not comparable on this machine\n");
  EXPECT_EQ(again.error, "");
  EXPECT_EQ(regress("scenes/ --set solver.policy=global_backup").status, 0);
  EXPECT_EQ(regress("scenes --quiet").out, "");
}

TEST_F(Regress, WhatDiffersIsNewOrGoneIsToldAndUpdateKeepsReasons) {
  ASSERT_EQ(regress("scenes --update --reason 'first, of all'").status, 0);
  write("scenes/ball.toml", ball("velocity = [0, -1]\n"));
  fs::rename(dir_ / "scenes/late.toml", dir_ / "scenes/later.toml");
  const std::string before = table();
  const Outcome other = regress("scenes");
  EXPECT_EQ(other.status, 1);
  EXPECT_THAT(other.out, HasSubstr("differs  ball: stored reached_end at t = 0.75 s, 1 collisions, 12 J, "));
  EXPECT_THAT(other.out, HasSubstr("; met reached_end at t = 0.75 s, 1 collisions, 12.5 J, "));
  EXPECT_THAT(other.out, HasSubstr("new      later: no stored answer"));
  EXPECT_THAT(other.out, HasSubstr("gone     late: stored reached_end at t = 0.25 s"));
  EXPECT_THAT(other.out, HasSubstr("0 same, 1 differ, 1 new, 1 gone"));
  EXPECT_EQ(table(), before);

  const Outcome quiet = regress("scenes --quiet");
  EXPECT_EQ(quiet.status, 1);
  EXPECT_EQ(quiet.out, "");
  EXPECT_THAT(quiet.error, HasSubstr("0 same, 1 differ, 1 new, 1 gone"));

  write("scenes/late.toml", ball("", "0.25"));
  EXPECT_EQ(regress("scenes --update --reason 'a push, \"downwards\"'").status, 0);
  EXPECT_THAT(table(), HasSubstr(",\"a push, \"\"downwards\"\"\"\nlate,"));
  EXPECT_THAT(table(), HasSubstr(",\"first, of all\"\nlater,")) << "late has not changed";
  EXPECT_EQ(regress("scenes").status, 0);
  write("scenes/ball.toml", ball());
  EXPECT_EQ(regress("scenes --update").status, 0);
  EXPECT_THAT(table(), HasSubstr(",no reason given\nlate,"));
}

TEST_F(Regress, AnEndingThatComesEarlyIsAnAnswerToo) {
  write("scenes/zeno.toml",
        ball("[solver]\npersistent = false\n[materials.default]\nrestitution = 0.5\n", "3"));
  ASSERT_EQ(regress("scenes --update").status, 0);
  EXPECT_THAT(table(), HasSubstr("\nzeno,\"failed: Zeno at t = 1.5"));
  EXPECT_EQ(regress("scenes").status, 0);
}

TEST_F(Regress, JsonIsOneLine) {
  ASSERT_EQ(regress("scenes/. --update --json").status, 0);
  const Outcome same = regress("scenes --json");
  EXPECT_EQ(same.status, 0);
  const auto told = nlohmann::json::parse(same.out);
  EXPECT_EQ(told["same"], 2);
  EXPECT_EQ(told["updated"], false);
  EXPECT_EQ(told["scenes"][0]["scene"], "ball");
  EXPECT_EQ(told["scenes"][0]["result"], "same");
  EXPECT_EQ(told["scenes"][0]["met"], told["scenes"][0]["stored"]);
  const Outcome other = regress("scenes --json --set world.duration=0.5625");
  EXPECT_EQ(other.status, 1);
  EXPECT_EQ(nlohmann::json::parse(other.out)["differ"], 2);
}

TEST_F(Regress, BadInputIsToldAllAtOnceWithItsPlaces) {
  ASSERT_EQ(regress("scenes --update").status, 0);
  const std::string good = table();
  write("scenes/bad.toml", ball("colour = 1\n"));
  write("scenes/worse.toml", ball("mass = 0\n"));
  write("scenes/answers.csv", good +
                                  "x,reached_end,1\ny,reached_end,now,-1,3,ff,why\n"
                                  "z,reached_end,nan,1,inf,0123456789abcdef,why\n");
  for (const char* arguments : {"scenes", "scenes --update", "scenes --quiet", "scenes --json"}) {
    const Outcome bad = regress(arguments);
    EXPECT_EQ(bad.status, 2) << arguments;
    EXPECT_EQ(bad.out, "") << arguments;
    for (const char* place : {"scenes/bad.toml:11:1: unknown key \"colour\"", "scenes/worse.toml:11:8: ",
                              "scenes/answers.csv:5:1: a row of 3 cells, allowed: 7",
                              "scenes/answers.csv:6:15: end time: given \"now\", allowed: a number",
                              "scenes/answers.csv:6:19: collisions: given \"-1\"",
                              "scenes/answers.csv:6:24: hash: given \"ff\", allowed: 16 hexadecimal digits",
                              "scenes/answers.csv:7:15: end time: given \"nan\", allowed: a number",
                              "scenes/answers.csv:7:21: energy: given \"inf\", allowed: a number"})
      EXPECT_THAT(bad.error, HasSubstr(place)) << arguments;
  }
  fs::remove(dir_ / "scenes/bad.toml");
  fs::remove(dir_ / "scenes/worse.toml");
  write("scenes/answers.csv", "ball,reached_end\n");
  EXPECT_THAT(regress("scenes").error,
              HasSubstr("scenes/answers.csv:1:1: first line: given \"ball,reached_end\""));
  write("scenes/answers.csv", good);
  EXPECT_EQ(regress("scenes").status, 0);

  fs::create_directory(dir_ / "empty");
  EXPECT_EQ(regress("empty").status, 2);
  EXPECT_EQ(regress("scenes --reason x").status, 2);
  EXPECT_EQ(regress("scenes --update --reason 'x\ny'").status, 2);
  EXPECT_EQ(regress("scenes --update --set world.duration=1").status, 2);
  EXPECT_EQ(regress("scenes --set world.durations=1").status, 2);
  EXPECT_EQ(regress("").status, 2);
  EXPECT_EQ(table(), good);
}

TEST_F(Regress, ASceneThatCannotStartIsBadInput) {
  write("scenes/sunk.toml", ball() + "[[bodies]]\ndisc = { radius = 0.5 }\nposition = [0.5, 1.5]\n");
  const Outcome sunk = regress("scenes");
  EXPECT_EQ(sunk.status, 2);
  EXPECT_THAT(sunk.error, HasSubstr("scenes/sunk.toml:"));
}

TEST_F(Regress, WhatCannotBeReadOrWrittenIsStatusThree) {
  EXPECT_EQ(regress("nowhere").status, 3);
  EXPECT_EQ(regress("scenes/ball.toml").status, 3);
  ASSERT_EQ(regress("scenes --update").status, 0);
  const std::string good = table();
  write("scenes/ball.toml", ball("velocity = [0, -1]\n"));
  // no file may grow, as on a full disk
  const std::string full = "cd '" + dir_.string() + "' && trap '' XFSZ && ulimit -f 0 && '" + kProgram +
                           "' regress scenes --update >/dev/null 2>&1";
  EXPECT_EQ(WEXITSTATUS(std::system(full.c_str())), 3);
  EXPECT_EQ(table(), good);
  const auto files = std::distance(fs::directory_iterator(dir_ / "scenes"), fs::directory_iterator());
  EXPECT_EQ(files, 3) << "nothing is left beside the table";
  fs::remove(dir_ / "scenes/answers.csv");
  fs::create_directory(dir_ / "scenes/answers.csv");
  EXPECT_EQ(regress("scenes").status, 3);
}

TEST_F(Regress, ASignalStopsItAndNothingIsWritten) {
  ASSERT_EQ(regress("scenes --update").status, 0);
  const std::string good = table();
  write("scenes/gas.toml",
        "[world]\nduration = 1e6\n[[bodies]]\nname = \"k\"\ndisc.radius = 0.1\nvelocity = [1e-3, 0]\n"
        "grid = {columns = 60, rows = 60, spacing = [1, 1]}\n[solver]\npolicy = \"global_backup\"\n"
        "broad_phase = false\n[output]\nframe_interval = 0\n");
  const std::string folder = (dir_ / "scenes").string();
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl(kProgram, kProgram, "regress", "--update", "--quiet", folder.c_str(), nullptr);
    ::_exit(127);
  }
  ::usleep(1'500'000);
  const auto asked = std::chrono::steady_clock::now();
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  // Of the second that is promised: tests run beside each other.
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - asked).count(), 5.0);
  EXPECT_EQ(table(), good);
  EXPECT_FALSE(fs::exists(dir_ / "scenes/answers.csv.new"));
}

}  // namespace
}  // namespace brink::regress_test
