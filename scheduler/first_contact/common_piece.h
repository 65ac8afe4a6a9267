#pragma once
/// Stretches of time in which neither of two motions goes over to another formula.

#include <algorithm>
#include <cmath>

#include "brink/integrators/motion.h"

namespace brink::detail {

struct Stretch {
  double begin, end;  ///< [s]
};

/// The longest that holds t; the later one, where two meet. @pre both motions cover t
inline Stretch common_piece(const Motion& a, const Motion& b, double t) {
  const auto [begin_a, end_a] = a.piece_at(t);
  const auto [begin_b, end_b] = b.piece_at(t);
  return {std::max(begin_a, begin_b), std::min(end_a, end_b)};
}

/// That of sixteen equal parts of the common piece which holds t: the same for every time in it.
inline Stretch part_of_piece(const Motion& a, const Motion& b, double t) {
  constexpr double kParts = 16.0;
  const Stretch piece = common_piece(a, b, t);
  const double length = (piece.end - piece.begin) / kParts;
  const auto begin_of = [&](double part) {
    return part < kParts ? std::min(piece.begin + part * length, piece.end) : piece.end;
  };
  double part = std::clamp(std::floor((t - piece.begin) / length), 0.0, kParts - 1.0);
  while (begin_of(part) > t) --part;
  while (part < kParts - 1.0 && begin_of(part + 1.0) <= t) ++part;
  return {begin_of(part), begin_of(part + 1.0)};
}

}  // namespace brink::detail
