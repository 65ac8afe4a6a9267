// The answers of the gallery, stored: collisions, energy at the end, hash of the last state. An answer that moves
// is a change that must be wanted, and said with its reason in the table and in CHANGELOG.md.
//
// BRINK_STORE_ANSWERS=1 writes the table anew, reasons left as they are; BRINK_STORE_ANSWERS=FILE writes
// answers there, and by whose motions, in place of reasons (tests/same_bits.sh compares such tables of several builds).
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/simulator/simulator.h"
#include "tests/support/platform.h"

namespace brink::answers_test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = BRINK_SOURCE_DIR;
const fs::path kTable = kRoot / "tests/regression/answers.csv";

struct Answer {
  std::string collisions, energy, hash, reason;
};

/// Answers by scene.
std::map<std::string, Answer> stored() {
  std::map<std::string, Answer> answers;
  std::ifstream in(kTable);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    std::string scene;
    Answer a;
    std::getline(fields, scene, ',');
    std::getline(fields, a.collisions, ',');
    std::getline(fields, a.energy, ',');
    std::getline(fields, a.hash, ',');
    std::getline(fields, a.reason);
    answers[scene] = a;
  }
  return answers;
}

std::string printed(const char* format, auto value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

RunSummary run(const fs::path& file) {
  const Scene scene = load_scene(file);
  Simulator simulator(scene.world, scene.solver);
  RunOptions options;
  options.until = scene.duration;
  options.checkpoint_seconds = -1.0;
  return simulator.run(options);
}

Answer answer_of(const RunSummary& s) {
  return {std::to_string(s.collisions),
          printed("%.15g", s.energy_final),
          printed("%016llx", static_cast<unsigned long long>(s.state_hash)),
          {}};
}

/// Whether the scene's motions are those of SUNDIALS. A closed form looks at forces once a step, a solver more often.
bool is_by_solver(const RunSummary& s) { return s.work.right_hand_sides > s.work.solver_steps; }

std::vector<std::string> scenes() {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(kRoot / "scenes/gallery"))
    if (entry.path().extension() == ".toml") names.insert(entry.path().stem().string());
  return {names.begin(), names.end()};
}

class Answers : public ::testing::TestWithParam<std::string> {};

TEST_P(Answers, AreThoseOfTheTable) {
  const RunSummary s = run(kRoot / "scenes/gallery" / (GetParam() + ".toml"));
  EXPECT_EQ(s.termination_text(), "reached_end");
  const auto table = stored();
  ASSERT_TRUE(table.count(GetParam())) << "not in " << kTable;
  if (is_by_solver(s) && testing::platform_probe() != testing::stored_probe())
    GTEST_SKIP() << "this machine's solver takes other steps";
  const Answer expected = table.at(GetParam()), met = answer_of(s);
  EXPECT_EQ(met.collisions, expected.collisions);
  EXPECT_EQ(met.energy, expected.energy);
  EXPECT_EQ(met.hash, expected.hash);
}

INSTANTIATE_TEST_SUITE_P(Gallery, Answers, ::testing::ValuesIn(scenes()),
                         [](const auto& scene) { return scene.param; });

TEST(AnswersTable, HasTheScenesOfTheGalleryAndNoOthers) {
  auto table = stored();
  if (const char* asked = std::getenv("BRINK_STORE_ANSWERS")) {
    const bool anew = std::string(asked) == "1";
    std::ofstream out(anew ? kTable : fs::path(asked));
    out << "# made where the probe of tests/support/platform.h is " << testing::platform_probe() << "\n"
        << "# scene,collisions,energy at the end [J],hash of the last state,why it last changed\n";
    for (const std::string& scene : scenes()) {
      const RunSummary s = run(kRoot / "scenes/gallery" / (scene + ".toml"));
      const Answer a = answer_of(s);
      const std::string reason = !anew                         ? (is_by_solver(s) ? "solver" : "Brink")
                                 : table[scene].reason.empty() ? "first stored"
                                                               : table[scene].reason;
      out << scene << ',' << a.collisions << ',' << a.energy << ',' << a.hash << ',' << reason << '\n';
    }
    out.close();
    ASSERT_TRUE(out) << asked;
    if (!anew) return;
    table = stored();
  }
  std::vector<std::string> names;
  for (const auto& [scene, answer] : table) {
    names.push_back(scene);
    EXPECT_FALSE(answer.reason.empty()) << scene;
  }
  EXPECT_EQ(names, scenes());
}

}  // namespace
}  // namespace brink::answers_test
