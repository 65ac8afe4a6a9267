#include "brink/scenes/toml/faults.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <tuple>

#include "brink/core/base/printable.h"

namespace brink {
namespace {

/// One "FILE:LINE:COLUMN: message" a line, as compilers write it, so that editors find the place. All
/// of it printable: names of files, too, come from outside.
std::string joined(const std::filesystem::path& file, const std::vector<SceneFault>& faults) {
  std::string text;
  for (const SceneFault& fault : faults) {
    if (!text.empty()) text += '\n';
    text += printable(fault.file.empty() ? file.string() : fault.file) + ':' + std::to_string(fault.line) +
            ':' + std::to_string(fault.column) + ": " + printable(fault.message);
  }
  return text;
}

// Levenshtein distance, row by row in one array: `diagonal` is the entry of the row above that row[j]
// overwrites, kept for the next column.
// Levenshtein 1966: the least number of insertions, deletions and changes of one byte that lead from a
// to b. Cost: |a| |b|.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
      diagonal = above;
    }
  }
  return row[b.size()];
}

}  // namespace

SceneFaults::SceneFaults(const std::filesystem::path& file, std::vector<SceneFault> faults)
    : BadInput(joined(file, faults)), faults_(std::move(faults)) {}

void FaultList::add(const Where& where, std::string message) {
  if (where.override_index >= 0)
    // In front, as line and column of such a fault are 0.
    message = "--set " + paths_[static_cast<std::size_t>(where.override_index)] + ": " + message;
  // Made printable here as well as in joined(): a program may show faults() by itself. Printable text is
  // not changed by being made so again.
  faults_.push_back({where.line, where.column, printable(message), {}});
}

void FaultList::add_elsewhere(const std::string& file, int line, int column, const std::string& message) {
  faults_.push_back({line, column, printable(message), file});
}

void FaultList::throw_if_any(const std::string& file) {
  if (faults_.empty()) return;
  // Faults of the scene file itself have no file name and come first, those of overrides (line 0) before
  // all. Stable: what is wrong at one place stays in the order in which it was found.
  std::stable_sort(faults_.begin(), faults_.end(), [](const SceneFault& a, const SceneFault& b) {
    return std::tie(a.file, a.line, a.column) < std::tie(b.file, b.line, b.column);
  });
  throw SceneFaults(file, std::move(faults_));
}

std::string nearest_word(std::string_view word, const std::vector<std::string>& known) {
  word = word.substr(0, 100);  // keeps the cost small for absurd input
  std::string best;
  std::size_t least = 0;
  for (const std::string& candidate : known) {
    // `<` and not `<=`: of words that are equally near the first one stays.
    const std::size_t distance = edit_distance(word, std::string_view(candidate).substr(0, 100));
    if (best.empty() || distance < least) {
      best = candidate;
      least = distance;
    }
  }
  return best;
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string in_quotes(std::string_view text) {
  // Not in the middle of a character: bytes 10xxxxxx go on with one of UTF-8.
  std::size_t shown = std::min<std::size_t>(text.size(), 60);
  while (shown > 0 && shown < text.size() && (text[shown] & 0xc0) == 0x80) --shown;  // whole characters
  return '"' + printable(text.substr(0, shown)) + (shown < text.size() ? "...\"" : "\"");
}

std::string number_text(double x) {
  if (std::isnan(x)) return "nan";
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  // At least 24, the longest of the shortest texts ("-2.2250738585072014e-308").
  char buffer[40];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, x).ptr};
}

}  // namespace brink
