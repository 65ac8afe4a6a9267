#pragma once
/// Two centred discs in free flight that meet without friction: the response in closed form.

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

struct DiscRebound {
  struct Start {  ///< of the parabola after
    BodyState state, low;
  };
  double impulse = 0.0;  ///< along the normal, which points into a [N s]
  Real delay = 0;        ///< from the clock to the moment of contact [s]
  Start a, b;
  double gap = 0.0;        ///< at that moment [m]
  double magnitude = 0.0;  ///< the largest speed that took part [m/s]
};

/// What the general response (extended_contact.h, impulse.h) comes to for such a pair, to roundings of
/// extended precision: nothing turns, the normal is the line of centres. The collision is resolved at its
/// moment, at most `latest` [s] from `time`, when the gap is `level` [m]; b is met `shift` [m] from where it
/// is, and stays there. Nothing if they do not approach. Cost: two square roots and five divisions, no sine
/// or cosine.
std::optional<DiscRebound> rebound(const DiscSide& a, const DiscSide& b, const Vec2& shift, double time,
                                   double latest, double level, double restitution);

}  // namespace brink
