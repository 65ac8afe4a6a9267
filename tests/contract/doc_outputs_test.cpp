// What README.md and the pages say that the program prints, and how much it counts, is what it prints and counts. Wall
// times are left out. But for one none of these scenes needs a solver, so they have the same bits everywhere.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "brink/integrators/solver_probe.h"
#include "brink/scenes/regress/answers.h"

namespace brink::doc_outputs_test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = BRINK_SOURCE_DIR;
const fs::path kProgram = fs::path(BRINK_BINARY_DIR) / "bin" / "brink";

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Fenced blocks without a language.
std::vector<std::string> printed_blocks(const std::string& page) {
  std::vector<std::string> blocks;
  std::istringstream lines(page);
  bool inside = false, plain = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("```", 0) == 0) {
      plain = !inside && line == "```";
      inside = !inside;
      if (plain) blocks.emplace_back();
    } else if (inside && plain) {
      blocks.back() += line + '\n';
    }
  }
  return blocks;
}

/// What a command prints, on both streams.
std::string output_of(const std::string& command, const fs::path& folder) {
  FILE* pipe = popen(("cd '" + folder.string() + "' && " + command + " 2>&1").c_str(), "r");
  std::string text;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  pclose(pipe);
  return text;
}

std::string without_wall_time(const std::string& text) {
  return std::regex_replace(text, std::regex("wall time +[^\n]*"), "wall time");
}

/// Text as a pattern: any white space for white space, anything for "...".
std::regex pattern_of(const std::string& shown) {
  std::string pattern;
  std::istringstream words(shown);
  for (std::string word; words >> word;) {
    if (!pattern.empty()) pattern += "\\s+";
    pattern +=
        word == "..." ? "[^]*?" : std::regex_replace(word, std::regex(R"([.^$|()\[\]{}*+?\\])"), R"(\$&)");
  }
  return std::regex("\\s*" + pattern + "\\s*");
}

/// Rows of the tables of a page, cell by cell, that begin with a `|`; without marks of code and blanks at the rim.
std::vector<std::vector<std::string>> table_rows(const std::string& page) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| ", 0) != 0) continue;
    rows.emplace_back();
    std::istringstream cells(line.substr(1));
    for (std::string cell; std::getline(cells, cell, '|');) {
      std::erase(cell, '`');
      rows.back().push_back(std::regex_replace(cell, std::regex("^ +| +$"), ""));
    }
  }
  return rows;
}

/// Of a number as pages write it, "1 271 000".
double number_of(std::string cell) {
  std::erase(cell, ' ');
  return std::stod(cell);
}

/// What every gallery scene came to.
AnswerTable stored_answers() { return read_answers(kRoot / "scenes/gallery/answers.csv"); }

class DocOutputs : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("brink-doc-outputs-" + std::to_string(::getpid()));
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  void expect_shown(const std::string& shown, const std::string& printed) const {
    EXPECT_TRUE(std::regex_match(without_wall_time(printed), pattern_of(without_wall_time(shown))))
        << "shown:\n"
        << shown << "printed:\n"
        << printed;
  }
  /// Runs the `$ ./brink ...` of a block and compares what follows it.
  bool check_command(const std::string& block) const {
    static const std::string lead = "$ ./brink ";
    if (block.rfind(lead, 0) != 0) return false;
    const std::size_t end = block.find('\n');
    const std::string command = "'" + kProgram.string() + "' " + block.substr(lead.size(), end - lead.size());
    expect_shown(block.substr(end + 1), output_of(command, folder));
    return true;
  }

  fs::path folder;
};

TEST_F(DocOutputs, ReadmesFirstRun) {
  const std::string page = text_of(kRoot / "README.md");
  std::smatch command;
  ASSERT_TRUE(std::regex_search(page, command, std::regex(R"(\n\./brink run (\S+\.toml))")));
  const std::string run = "'" + kProgram.string() + "' run '" + (kRoot / command[1].str()).string() + "'";
  for (const std::string& block : printed_blocks(page))
    if (block.find("state hash") != std::string::npos) return expect_shown(block, output_of(run, folder));
  FAIL() << "README.md shows no summary";
}

TEST_F(DocOutputs, TheWalkOfHello) {
  const std::string page = text_of(kRoot / "docs/hello.md");
  const std::size_t begin = page.find("```toml\n") + 8, end = page.find("```", begin);
  const std::string scene = page.substr(begin, end - begin);
  std::ofstream(folder / "ball.toml") << scene;
  int commands = 0;
  for (const std::string& block : printed_blocks(page)) commands += check_command(block);
  EXPECT_GE(commands, 3);

  // The table that the page asks of the run file, without the program that asks there.
  for (const std::string& block : printed_blocks(page)) {
    const std::size_t quote = block.find('"');
    if (block.rfind("$ sqlite3", 0) != 0 || quote == std::string::npos) continue;
    const std::size_t rows = block.find("\n0 ");
    ASSERT_NE(rows, std::string::npos) << block;
    const SQLite::Database run((folder / "runs/ball-1/run.db").string());
    SQLite::Statement query(run, block.substr(quote + 1, block.find('"', quote + 1) - quote - 1));
    std::string table;
    for (; query.executeStep(); table += '\n')
      for (int c = 0; c < query.getColumnCount(); ++c) table += query.getColumn(c).getString() + ' ';
    expect_shown(block.substr(rows), table);
    ++commands;
  }
  EXPECT_GE(commands, 4) << "the table is one";

  std::string misspelt = scene;
  misspelt.replace(misspelt.find("mass ="), 4, "mas");
  std::ofstream(folder / "ball.toml") << misspelt;
  const std::string fault = output_of("'" + kProgram.string() + "' check ball.toml", folder);
  const std::size_t shown = page.find("ball.toml:14:1:");
  ASSERT_NE(shown, std::string::npos);
  EXPECT_NE(fault.find(page.substr(shown, page.find('\n', shown) - shown)), std::string::npos) << fault;
}

TEST_F(DocOutputs, TheFaultsOfTheSceneFile) {
  const std::string page = text_of(kRoot / "docs/scene-format.md");
  const std::size_t begin = page.find("```toml\n") + 8, end = page.find("```", begin);
  std::string scene = page.substr(begin, end - begin);
  scene = std::regex_replace(scene, std::regex("duration = [^\n]*"), "duration = nan");
  scene = std::regex_replace(scene, std::regex("restitution ="), "restituton =");
  std::ofstream(folder / "ball.toml") << scene;
  const std::vector<std::string> shown = printed_blocks(page);
  ASSERT_FALSE(shown.empty());
  EXPECT_EQ(std::count(shown.front().begin(), shown.front().end(), '\n'), 2);
  EXPECT_EQ(output_of("'" + kProgram.string() + "' check ball.toml", folder), shown.front());
}

// docs/scheduling.md: "(4517)" behind a scene and a policy.
TEST_F(DocOutputs, CollisionsOnThePageOnScheduling) {
  const std::string page = text_of(kRoot / "docs/scheduling.md");
  const std::map<std::string, Answer> stored = stored_answers().answers;
  const std::regex named(R"(\| `?([a-z_]+)`?(?:, `[a-z_]+`)? \((\d+)\) \|)");
  int seen = 0;
  for (std::sregex_iterator i(page.begin(), page.end(), named), end; i != end; ++i, ++seen) {
    const std::string scene = (*i)[1];
    ASSERT_TRUE(stored.contains(scene)) << scene;
    EXPECT_EQ((*i)[2], stored.at(scene).collisions) << scene;
  }
  EXPECT_EQ(seen, 9);
}

// The table of what policies waste: every count within a hundredth of what a run counts.
TEST_F(DocOutputs, WhatPoliciesWaste) {
  const std::vector<std::string> counters{
      "advances",      "backups",    "rollbacks", "body_seconds_thrown_away", "certificates_issued",
      "pair_searches", "states_kept"};
  std::string scene;
  int seen = 0;
  for (const std::vector<std::string>& row : table_rows(text_of(kRoot / "docs/scheduling.md"))) {
    if (row.size() != 2 + counters.size() || row[1] == "policy" || row[1].find('-') == 0) continue;
    if (!row[0].empty()) scene = row[0].substr(0, row[0].find(' '));
    // its steps are SUNDIALS', and the same where answers were stored alone
    if (scene == "spring_net" && solver_probe() != stored_answers().probe) continue;
    const std::string printed = output_of(
        "'" + kProgram.string() + "' run '" + (kRoot / "scenes/gallery" / (scene + ".toml")).string() +
            "' --set 'solver.policy=\"" + row[1] + "\"' --set output.frame_interval=0 --json",
        folder);
    const auto work = nlohmann::json::parse(printed).at("work");
    for (std::size_t k = 0; k < counters.size(); ++k) {
      const double counted = work.at(counters[k]).get<double>();
      EXPECT_NEAR(number_of(row[2 + k]), counted, 0.01 * counted)
          << scene << ", " << row[1] << ", " << counters[k];
    }
    ++seen;
  }
  EXPECT_GE(seen, 8);
}

}  // namespace
}  // namespace brink::doc_outputs_test
