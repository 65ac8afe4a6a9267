#pragma once
/// Small worlds of the classic benchmark, and how they are run.

#include <vector>

#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink::bench {

/// A body of mass 1 kg, sampled along its boundary.
Body sampled_body(const Shape& shape, const Pose& pose, const Twist& twist, double spacing);

/// Appends a fixed outline at a pose.
void add_fixed(World& world, const Shape& shape, const Pose& pose = Pose());

/// Backing up to the first contact, found by `detector`.
SolverOptions backing_up(const char* detector, double step = 0.01);

/// Times of collisions up to `until`, in order [s].
std::vector<double> hits_of(const World& world, const SolverOptions& options, double until);

}  // namespace brink::bench
