#pragma once
/// A centred disc in free flight that meets another, or a straight wall, without friction: the response in
/// closed form.

#include <optional>

#include "brink/core/base/extended.h"
#include "brink/integrators/motion.h"

namespace brink {

/// One of the two.
struct DiscSide {
  const Motion* motion = nullptr;  ///< a parabola
  double radius = 0.0;             ///< [m]
  double inverse_mass = 0.0;       ///< [1/kg], > 0
};

/// The straight side of a wall that stands still, on which a disc's centre is.
struct WallSide {
  RealVec begin, end;   ///< of its middle line [m]
  double radius = 0.0;  ///< half its thickness [m]
  Vec2 normal;          ///< towards the disc, to roundings of a double
};

struct DiscRebound {
  struct Start {  ///< of the parabola after
    BodyState state, low;
  };
  double impulse = 0.0;    ///< along the normal, which points into a [N s]
  Real delay = 0;          ///< from the clock to the moment of contact [s]
  Start a, b;              ///< b: not of a wall
  double gap = 0.0;        ///< at that moment [m]
  double magnitude = 0.0;  ///< the largest speed that took part [m/s]
};

/// What the general response (extended_contact.h, impulse.h) comes to for such a pair, to roundings of
/// extended precision: nothing turns, the normal is the line of centres. The collision is resolved at its
/// moment, at most `latest` [s] from `time`, when the gap is `level` [m]; b is met `shift` [m] from where it
/// is, and stays there. Nothing if they do not approach. Cost: some twenty products and one division of two doubles,
/// no sine or cosine.
std::optional<DiscRebound> rebound(const DiscSide& a, const DiscSide& b, const Vec2& shift, double time,
                                   double latest, double level, double restitution);

/// The same, written where there is room already; false: nothing, and what is there counts no more.
bool rebound(const DiscSide& a, const DiscSide& b, const Vec2& shift, double time, double latest,
             double level, double restitution, DiscRebound& result);

/// The same of disc and wall. Nothing where the disc's centre is not abreast of the wall either, or the wall's
/// normal is not the one that is given: an end is met. Cost: one square root and two divisions of two doubles.
std::optional<DiscRebound> rebound(const DiscSide& disc, const WallSide& wall, double time, double latest,
                                   double level, double restitution);
bool rebound(const DiscSide& disc, const WallSide& wall, double time, double latest, double level,
             double restitution, DiscRebound& result);

}  // namespace brink
