#pragma once
/// The results of a sweep as people read them: a table by setting, and CSV.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "brink/scenes/sweep/experiment.h"
#include "brink/scenes/sweep/results.h"

namespace brink {

using SweepResults = std::vector<std::optional<SweepResult>>;

/// Runs that differ in their seed alone.
struct SweepGroup {
  std::vector<std::string> values;  ///< one an axis, without the seed's
  std::vector<std::size_t> runs;    ///< those that are done
  std::size_t waiting = 0;          ///< those that are not
};
std::vector<SweepGroup> sweep_groups(const Experiment& experiment, const SweepResults& results);

/// Median; for an even count the lower of the two in the middle. NaN of nothing.
double median(std::vector<double> values);

/// A time as people read it: "1.2 µs", "3 ms", "4.5 s".
std::string duration_text(double seconds);

/// One line a group: its values, how many runs ended how, medians over its seeds, the state hash.
std::string sweep_table(const Experiment& experiment, const SweepResults& results);

/// Where policies are varied: of the settings of which two exact policies or more have a state hash, in how many these
/// are one, and which are the others. Empty where there are none.
std::string policy_agreement(const Experiment& experiment, const SweepResults& results);

/// One line a run: axes, termination, state hash, and every column in full precision.
/// @throws IoError.
void write_sweep_csv(const std::filesystem::path& file, const Experiment& experiment,
                     const SweepResults& results);

}  // namespace brink
