#pragma once
/// The classic text data file of one sampled body.
///
///     8                      // number of samples
///     10  0 5  1 0  30 20    // mass  x y  vx vy  rotation in degrees  omega in rad/s
///     -0.5 -0.5              // one "x y" a line, in the body's frame
///     ...
///
/// Comments run from // to the end of the line; blank lines do not count.

#include <string>
#include <string_view>
#include <vector>

#include "brink/core/shapes/shapes.h"

namespace brink {

struct SampledBody {
  double mass = 1.0;              ///< [kg], > 0
  Vec2 position = Vec2::Zero();   ///< of its frame's origin [m]
  Vec2 velocity = Vec2::Zero();   ///< [m/s]
  double rotation_degrees = 0.0;  ///< counter-clockwise
  double omega = 0.0;             ///< [rad/s]
  std::vector<Vec2> samples;      ///< [m], distinct
};

/// A fault of such a file and its place, counting from 1.
struct SampleFileFault {
  int line = 0, column = 0;
  std::string message;  ///< what is wrong, what was given, what is allowed
};

/// Reads the text; if it has faults, they are appended in file order and what is returned means nothing.
SampledBody read_sample_file(std::string_view text, std::vector<SampleFileFault>& faults);

/// The shape that the samples stand for. In this order:
/// - one sample alone: a point; all on one line, up to the roundings of their coordinates: a wire from end to
///   end;
/// - the polygon through them in file order, if that is simple;
/// - else their convex hull (a file that lists the samples row by row, or inner ones too).
Shape shape_of_samples(const std::vector<Vec2>& samples);

}  // namespace brink
