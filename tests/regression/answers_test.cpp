// The answers of the gallery, stored in scenes/gallery/answers.csv (brink regress): how each scene ends, its collisions,
// energy at the end, hash of the last state. An answer that moves is a change that must be wanted, and said with its
// reason in the table and in CHANGELOG.md.
//
// BRINK_STORE_ANSWERS=FILE writes answers there, and by whose motions, in place of reasons (tests/same_bits.sh compares
// such tables of several builds).
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>

#include "brink/integrators/solver_probe.h"
#include "brink/scenes/files/csv_rows.h"
#include "brink/scenes/regress/regress.h"

namespace brink::answers_test {
namespace {

namespace fs = std::filesystem;

const fs::path kGallery = fs::path(BRINK_SOURCE_DIR) / "scenes/gallery";

std::string line_of(const Answer& a) {
  return a.ended + ", " + a.end_time + " s, " + a.collisions + ", " + a.energy + " J, " + a.hash;
}

RunSummary run(const std::string& scene) { return run_for_answer(load_scene(kGallery / (scene + ".toml"))); }

std::vector<std::string> scenes() {
  std::vector<std::string> names;
  for (const fs::path& file : scenes_of(kGallery)) names.push_back(file.stem().string());
  return names;
}

class Answers : public ::testing::TestWithParam<std::string> {};

TEST_P(Answers, AreThoseOfTheTable) {
  const RunSummary s = run(GetParam());
  EXPECT_EQ(s.termination_text(), "reached_end");
  const Comparison c = compare(GetParam(), s, read_answers(answers_file(kGallery)));
  if (c.verdict == Verdict::not_comparable) GTEST_SKIP() << "this machine's solver takes other steps";
  ASSERT_TRUE(c.stored) << "not in the table";
  EXPECT_EQ(c.verdict, Verdict::same);
  EXPECT_EQ(line_of(*c.met), line_of(*c.stored));
}

INSTANTIATE_TEST_SUITE_P(Gallery, Answers, ::testing::ValuesIn(scenes()),
                         [](const auto& scene) { return scene.param; });

TEST(AnswersTable, HasTheScenesOfTheGalleryAndNoOthers) {
  if (const char* asked = std::getenv("BRINK_STORE_ANSWERS")) {
    AnswerTable met{solver_probe(), {}};
    for (const std::string& scene : scenes()) {
      const RunSummary s = run(scene);
      met.answers[scene] = answer_of(s);
      met.answers[scene].reason = is_by_solver(s) ? "solver" : "Brink";
    }
    return write_answers(asked, met);
  }
  std::vector<std::string> names;
  for (const auto& [scene, answer] : read_answers(answers_file(kGallery)).answers) {
    names.push_back(scene);
    EXPECT_FALSE(answer.reason.empty()) << scene;
  }
  EXPECT_EQ(names, scenes());
}

// A quote that is closed only in a later row would take the rows between for a reason.
TEST(AnswersTable, AQuoteThatIsNotClosedIsAFault) {
  const fs::path file = fs::temp_directory_path() / fmt::format("brink-answers-{}.csv", ::getpid());
  const std::string head = "# made where the solver's probe is 046d485b97df28f8\n# columns\n",
                    row = ",1,3,9.83,ef0f11ec48bd7c76,";
  const auto fault_of = [&](const std::string& rows) -> std::string {
    std::ofstream(file) << head << rows;
    try {
      read_answers(file);
    } catch (const SceneFaults& faults) {
      const SceneFault& f = faults.faults().front();
      return fmt::format("{}:{} {}", f.line, f.column, f.message);
    }
    return "";
  };
  EXPECT_EQ(fault_of("a,reached_end" + row + "\"first, stored\"\nb,stopped" + row + "x\n"), "");
  EXPECT_EQ(fault_of("a,reached_end" + row + "\"first\nb,reached_end" + row + "\"second\"\n").substr(0, 4),
            "3:41");
  EXPECT_EQ(fault_of("a,foo" + row + "x\n").substr(0, 4), "3:3 ");
  fs::remove(file);
}

// An answer by a solver is not held against a machine whose solver is another one; any other is.
TEST(AnswersTable, OfAnotherMachineAreNotComparableWhereASolverMovesTheBodies) {
  RunSummary s;
  s.termination = Termination::reached_end;
  AnswerTable stored{solver_probe(), {{"a", answer_of(s)}}};
  EXPECT_EQ(compare("a", s, stored).verdict, Verdict::same);
  EXPECT_EQ(compare("b", s, stored).verdict, Verdict::unstored);
  s.collisions = 1;
  EXPECT_EQ(compare("a", s, stored).verdict, Verdict::differs);
  s.work.right_hand_sides = 12;
  s.work.solver_steps = 3;
  EXPECT_EQ(compare("a", s, stored).verdict, Verdict::differs);
  stored.probe = "0123456789abcdef";
  EXPECT_EQ(compare("a", s, stored).verdict, Verdict::not_comparable);
  s.work.right_hand_sides = 3;
  EXPECT_EQ(compare("a", s, stored).verdict, Verdict::differs);
  s.collisions = 0;
  s.work.right_hand_sides = 12;
  EXPECT_EQ(compare("a", s, stored).verdict, Verdict::same) << "where it is the same, it is";
}

// RFC 4180, and lines that are left out.
TEST(AnswersTable, CellsAreReadWithTheirPlaces) {
  const std::vector<CsvRow> rows = csv_rows("# head\r\na,\"b, \"\"c\"\"\nd\",\r\n\n,x\n\"open");
  ASSERT_EQ(rows.size(), 3U);
  ASSERT_EQ(rows[0].size(), 3U);
  EXPECT_EQ(rows[0][1].text, "b, \"c\"\nd");
  EXPECT_EQ(rows[0][2].text, "");
  EXPECT_EQ(rows[0][1].line * 100 + rows[0][1].column, 203);
  ASSERT_EQ(rows[1].size(), 2U);
  EXPECT_EQ(rows[1][1].line * 100 + rows[1][1].column, 502);
  EXPECT_TRUE(rows[0][1].closed);
  EXPECT_FALSE(rows[2][0].closed);
}

}  // namespace
}  // namespace brink::answers_test
