/// The table is a CSV text. Its first line tells the probe, its second one the columns:
///
///     # made where the solver's probe is 046d485b97df28f8
///     # scene,how it ended,end time [s],collisions,energy at the end [J],hash of the last state,why it last changed
///     break_shot,reached_end,3,106,6.8860285,ef0f11ec48bd7c76,first stored
#include "brink/scenes/regress/answers.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <sstream>
#include <string_view>
#include <tuple>

#include "brink/core/base/error.h"
#include "brink/core/base/printable.h"
#include "brink/scenes/files/csv_cell.h"
#include "brink/scenes/files/csv_rows.h"
#include "brink/scenes/files/text_file.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scenes/toml/faults.h"

namespace brink {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kProbeLine = "# made where the solver's probe is ";
constexpr std::string_view kColumns =
    "scene,how it ended,end time [s],collisions,energy at the end [J],hash of the last state,why it last "
    "changed";
constexpr std::size_t kCells = 7;

/// All of the text, as a number that is not infinite and no NaN.
template <class Number>
bool reads_as(const std::string& text) {
  Number number;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && stop == text.data() + text.size() &&
         std::isfinite(static_cast<double>(number));
}

bool is_hash(std::string_view text) {
  return text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// Adds the fault of a cell that is not `good`.
void require(FaultList& faults, const CsvCell& cell, bool good, const char* what, const char* allowed) {
  if (!good)
    faults.add({cell.line, cell.column},
               fmt::format("{}: given {}, allowed: {}", what, in_quotes(cell.text), allowed));
}

/// One row into the table, or its faults into the list.
void read_row(const CsvRow& row, AnswerTable& table, FaultList& faults) {
  for (const CsvCell& cell : row)
    // no cell that is written here has a line break: in one that has the rows after it are lost
    if (!cell.closed || cell.text.find('\n') != std::string::npos)
      return faults.add({cell.line, cell.column},
                        "a quote that is not closed; allowed: \" at the end of the cell");
  if (row.size() != kCells)
    return faults.add({row[0].line, row[0].column},
                      fmt::format("a row of {} cells, allowed: {} ({})", row.size(), kCells, kColumns));
  require(faults, row[0], !row[0].text.empty(), "scene", "the name of a scene");
  require(faults, row[0], !table.answers.contains(row[0].text), "scene", "each scene once");
  const std::string& ended = row[1].text;
  require(faults, row[1],
          ended == "reached_end" || ended.starts_with("stopped") || ended.starts_with("failed: "),
          "how it ended", "reached_end, stopped, failed: why");
  require(faults, row[2], reads_as<double>(row[2].text), "end time", "a number [s]");
  require(faults, row[3], reads_as<std::uint64_t>(row[3].text), "collisions", "a whole number, 0 or more");
  require(faults, row[4], reads_as<double>(row[4].text), "energy", "a number [J]");
  require(faults, row[5], is_hash(row[5].text), "hash", "16 hexadecimal digits");
  table.answers.emplace(row[0].text,
                        Answer{row[1].text, row[2].text, row[3].text, row[4].text, row[5].text, row[6].text});
}

/// A name that begins as a comment does would be read as one.
std::string scene_cell(const std::string& scene) {
  return scene.starts_with('#') ? "\"" + csv_cell(scene) + '"' : csv_cell(scene);
}

}  // namespace

bool Answer::same_as(const Answer& other) const {
  const auto all = [](const Answer& a) {
    return std::tie(a.ended, a.end_time, a.collisions, a.energy, a.hash);
  };
  return all(*this) == all(other);
}

Answer answer_of(const RunSummary& s) {
  return {printable(s.termination_text()),      number_text(s.end_time),
          std::to_string(s.collisions),         fmt::format("{:.15g}", s.energy_final),
          fmt::format("{:016x}", s.state_hash), {}};
}

bool is_by_solver(const RunSummary& s) { return s.work.right_hand_sides > s.work.solver_steps; }

AnswerTable read_answers(const fs::path& file) {
  AnswerTable table;
  if (!fs::exists(file)) return table;
  // a pipe would be waited for
  if (!fs::is_regular_file(file)) throw IoError(file.string() + ": is no file");
  const std::string text = text_of_file(file);
  FaultList faults;
  if (const std::string first = text.substr(0, text.find_first_of("\r\n"));
      first.starts_with(kProbeLine) && is_hash(first.substr(kProbeLine.size())))
    table.probe = first.substr(kProbeLine.size());
  else
    faults.add({1, 1}, fmt::format("first line: given {}, allowed: \"{}\" and 16 hexadecimal digits",
                                   in_quotes(first), kProbeLine));
  for (const CsvRow& row : csv_rows(text)) read_row(row, table, faults);
  faults.throw_if_any(file.string());
  return table;
}

void write_answers(const fs::path& file, const AnswerTable& table) {
  std::ostringstream out;
  out << kProbeLine << table.probe << "\n# " << kColumns << '\n';
  for (const auto& [scene, a] : table.answers)
    out << scene_cell(scene) << ',' << csv_cell(a.ended) << ',' << a.end_time << ',' << a.collisions << ','
        << a.energy << ',' << a.hash << ',' << csv_cell(printable(a.reason)) << '\n';
  write_whole(file, out.str());
}

}  // namespace brink
