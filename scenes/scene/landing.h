#pragma once
/// From where something is written to where it touches something else. Internal to the scene reader.

#include <functional>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "brink/core/base/periodic.h"
#include "brink/scenes/scene/scatter.h"

namespace brink {

/// The gap at which two are put that touch [m]: 0 where neither is turned, a few roundings of their sizes where
/// one is; and `thin` where one is a wire without thickness and the other has corners: on the wire itself nobody
/// could tell on which side they are (first_contact/tolerances.h).
double gap_of_touching(const Obstacle& a, const Obstacle& b, double thin);

/// What a copy touches, and which way it is pushed where roundings have left their gap too small.
struct Touched {
  Obstacle other;
  Vec2 away = Vec2::UnitY();  ///< unit
};

/// Gaps of one outline and its own copies, which stand at its angle: each depends on where the two are to each other
/// alone, and rows have few such offsets, so each is computed once.
class CopyGaps {
 public:
  explicit CopyGaps(const Outline& outline) : outline_(outline) {}

  struct Gap {
    double gap = 0.0;            ///< [m]; < 0: minus the depth
    Vec2 normal = Vec2::Zero();  ///< unit, out of the other
  };
  /// outline_gap() of the outline at `pose` and at `other`. @pre one angle, the same at all calls.
  const Gap& between(const Pose& pose, const Pose& other);

 private:
  const Outline& outline_;
  std::map<std::pair<double, double>, Gap> known_;  ///< by other.position - pose.position
};

/// Moves a pose of `outline` by as little as makes each of these gaps at least gap_of_touching(). @pre they are, but
/// for that and for roundings; all that is touched are copies of the outline at the same angle.
void push_apart(const Outline& outline, Pose& pose, const std::vector<Touched>& touched, double thin,
                CopyGaps& gaps);

/// Where equal copies stand for a position of all together: the first `most` of them, or all if there are fewer.
using Copies = std::function<std::vector<Pose>(const Vec2& position, std::size_t most)>;
inline constexpr std::size_t kAllCopies = std::numeric_limits<std::size_t>::max();

/// What is let down: equal copies that move as one.
struct LandingAsk {
  const Outline* outline = nullptr;
  Vec2 position = Vec2::Zero();     ///< as written
  Copies copies;                    ///< where they stand for a position
  Vec2 direction = -Vec2::UnitY();  ///< unit
  std::vector<Obstacle> grounds;    ///< on what
  Periods periods = {};             ///< of the world: images are grounds too
  double thin = 0.0;                ///< of gap_of_touching() [m]
};

struct Landing {
  enum class Status { lands, never, overlaps };
  Status status = Status::never;
  Vec2 position = Vec2::Zero();  ///< at which the first of them touches
};

/// Moves the copies along the direction until the first touches: its gap is gap_of_touching() to a rounding of
/// the places, and not below. Cost: cast_outline() of every copy and every ground whose discs meet on the way.
Landing land(const LandingAsk& ask);

}  // namespace brink
