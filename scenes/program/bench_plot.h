#pragma once
/// Error against run time, one panel a problem, both axes logarithmic.

#include <filesystem>

#include "brink/scenes/program/bench_run.h"

namespace brink::bench {

/// Errors below this are drawn on it: a run that gives every digit has no logarithm [the error's unit].
inline constexpr double kLeastError = 1e-17;

/// Rows of one problem follow each other. Marks are filled, or rings where contacts were missed; the points
/// of a series are joined. @pre rows is not empty. @throws IoError.
void write_plot(const std::filesystem::path& file, const std::vector<Problem>& problems,
                const std::vector<Row>& rows);

}  // namespace brink::bench
