#pragma once
/// What scenes came to, as a table that is kept beside them. An answer that moves is a change that must be wanted, and
/// said with its reason.

#include <filesystem>
#include <map>
#include <string>

#include "brink/scheduler/run/summary.h"

namespace brink {

/// What the run of a scene came to, each as the table writes it.
struct Answer {
  std::string ended;       ///< RunSummary::termination_text
  std::string end_time;    ///< [s], reads back to the same bits
  std::string collisions;  ///< how many
  std::string energy;      ///< at the end [J], 15 digits
  std::string hash;        ///< of the last state, 16 hexadecimal digits
  std::string reason;      ///< why it last changed; not of the run

  /// The same in all but the reason.
  bool same_as(const Answer& other) const;
};

struct AnswerTable {
  std::string probe;                      ///< solver_probe() where it was made
  std::map<std::string, Answer> answers;  ///< by scene: the name of its file without .toml
};

Answer answer_of(const RunSummary& summary);

/// Whether motions were those of SUNDIALS: a closed form looks at forces once a step, a solver more often. Only such
/// answers depend on the machine.
bool is_by_solver(const RunSummary& summary);

/// The table in `file`; an empty one where there is no such file.
/// @throws SceneFaults with every fault of it, located; IoError.
AnswerTable read_answers(const std::filesystem::path& file);

/// Writes the table: beside the file, then over it at once, so that it is whole whatever happens.
/// @throws IoError; the earlier table is as it was.
void write_answers(const std::filesystem::path& file, const AnswerTable& table);

}  // namespace brink
