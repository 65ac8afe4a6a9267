#pragma once
/// A sweep as a picture: one panel a column, one line a value of the series axis.

#include "brink/scenes/draw/chart.h"
#include "brink/scenes/sweep/table.h"

namespace brink {

/// What is drawn at one place of one line.
struct SweepPoint {
  std::size_t x = 0;                     ///< index into the x axis's values
  double low = 0, middle = 0, high = 0;  ///< over the runs that share x and series
};

/// The lines of one panel, one a value of the series axis (one in all without a series), each in the x axis's
/// order. Runs that are not done, and numbers that there are not, are left out.
std::vector<std::vector<SweepPoint>> sweep_lines(const Experiment& experiment, const SweepResults& results,
                                                 const std::string& column);

/// Along x and y: logarithmic where all values are > 0 and span more than a factor of 20; x by name where its
/// values are not numbers. Of energy_drift the magnitude is drawn.
Chart sweep_chart(const Experiment& experiment, const SweepResults& results);

}  // namespace brink
