#pragma once
/// How accepted solver steps become polynomial pieces that meet with equal pose and twist (C1).

#include "brink/core/base/geometry.h"
#include "brink/integrators/motion.h"

namespace brink {

/// True if two places (or angles) along an axis differ by what a few roundings of theirs may come to.
bool is_rounding_of(double a, double b);

/// Makes `piece` start exactly at `from` and adds the cubic that makes it end at `to`: pose and twist at both
/// ends are then the solver's accepted states (the end to rounding: of the place, and of the clock, which moves it). A piece of degree 0 becomes the cubic
/// Hermite interpolant. Between the ends the change is of the size of the mismatch there, that is of the
/// solver's local error.
/// @pre piece.origin == piece.begin < piece.end.
void match_ends(PolynomialPiece& piece, const BodyState& from, const BodyState& to);

/// Adds the cubic that changes the piece by the given poses and rates at its begin and end. Any origin.
void add_cubic(PolynomialPiece& piece, const Eigen::Vector3d& pose_begin, const Eigen::Vector3d& rate_begin,
               const Eigen::Vector3d& pose_end, const Eigen::Vector3d& rate_end);

/// Cubic Hermite interpolant of pose and twist at both ends; error of the pose O(h^4).
PolynomialPiece cubic_piece(double begin, const BodyState& from, double end, const BodyState& to);

/// Quintic Hermite interpolant of pose, twist and acceleration at both ends; error of the pose O(h^6).
PolynomialPiece quintic_piece(double begin, const BodyState& from, const Acceleration& at_begin, double end,
                              const BodyState& to, const Acceleration& at_end);

/// Re-expands `piece` about `origin` (repeated synthetic division); it stays the same polynomial.
void move_origin(PolynomialPiece& piece, double origin);

}  // namespace brink
