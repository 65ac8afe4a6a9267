#pragma once
/// Error against run time, one panel a problem, both axes logarithmic.

#include <filesystem>

#include "brink/scenes/bench/run.h"
#include "brink/scenes/draw/chart.h"

namespace brink::bench {

/// Errors below this are drawn on it: a run that gives every digit has no logarithm [the error's unit].
inline constexpr double kLeastError = 1e-17;

/// How a series is shown; one that has no look is joined, in a colour of its own.
struct Look {
  std::string series;
  draw::Oklch color;
  bool joined = true;
};

/// Rows of one problem follow each other. Marks are filled, rings where contacts were missed, crosses on the
/// upper rim where the error is infinite. @pre rows is not empty. @throws IoError.
void write_plot(const std::filesystem::path& file, const std::string& title,
                const std::vector<Problem>& problems, const std::vector<Row>& rows,
                const std::vector<Look>& looks = {});

}  // namespace brink::bench
