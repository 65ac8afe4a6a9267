#pragma once
/// Everything of two outlines that is near: what contacts that last are made of.

#include <vector>

#include "brink/core/base/extended.h"
#include "brink/core/shapes/outline.h"

namespace brink {

/// How surely it is known on which side of a wire a contact is. Hardly: where edges lie along the wire, by less than roundings of
/// a long way may make, or by the middle of their outline, which need not be right. Not at all: the normal is one of two.
enum class SideTold : unsigned char { surely, hardly, not_at_all };

/// A sample of one outline and a site of the other. Unlike what a search for first contact lists, every site
/// that faces a sample counts, not the nearest alone: a body in a groove touches both sides.
struct NearFeature {
  int sample = -1;             ///< into the carrying outline's samples
  int site = -1;               ///< into the other outline's sites
  bool sample_on_a = true;     ///< sample on a and site on b, or the reverse
  Vec2 point = Vec2::Zero();   ///< on the site's surface, from b's position, in world axes [m]
  Vec2 normal = Vec2::Zero();  ///< world, unit, from b into a
  double gap = 0.0;            ///< [m]
  bool thin = false;           ///< a sharp sample and a wire without thickness
  SideTold side_told = SideTold::surely;
  bool at_end = false;  ///< of a site that goes on from there: the sample may pass by
  /// Of an arc's sample whose sector the site lies beside, by what a body may turn in a step, or by what the way between the
  /// centres of two arcs in each other may turn within the reach: the gap is that of the arc's end, and of the arc once it has rolled
  /// there.
  bool beside_arc = false;
  /// Beyond an end from which another side goes on straight: it meets that one, and this one only as it comes to be abreast of it
  /// within a step. Normal, point and gap are those of the line.
  bool goes_on = false;
  /// Over a smooth joint or a low corner on a hump, behind whose end the sample is: of the circle or line of which the site is a part.
  /// It `goes_on`, too.
  bool over_hump = false;
  /// Over a smooth joint in a hollow: of the tangent at the site's end.
  bool over_joint = false;
  /// Upon a convex corner: of the side there that was chosen, with that side's own normal, and a gap from its line.
  bool upon_corner = false;
  /// A corner upon a corner of which no other side parts the two: along this side's end there is no way by, even
  /// where both are flush to the last bit.
  bool no_way_by = false;
  double one_corner = 0.0;  ///< corners no farther apart than this lie on each other [m]
};

/// Features of a and b with a gap up to `reach` [m], in the order of samples of a, then of b, and of sites.
/// Everything is taken from b's position: far from the origin nothing is lost. Each gap, seen as a function
/// of where the sample's point is in the site's frame, is convex wherever the site is a point, a segment, or
/// an arc seen from outside: its tangent never lies above it. `tolerance`: to what contacts keep their gaps [m]; what has sunk
/// by that beside a sharp corner may be beyond it, so corners as near lie on each other. Cost: samples times sites.
std::vector<NearFeature> near_features(const Outline& a, const ExtendedState& state_a, const Outline& b,
                                       const ExtendedState& state_b, double reach, double tolerance = 0.0);

/// True of two sites that share an end and go on into each other there.
bool go_on_smoothly(const Site& one, const Site& other);

/// An outline where it is, with the sine and cosine of its angle, which all its features ask for.
struct OutlineAt {
  OutlineAt(const Outline& outline, const ExtendedState& state);

  const Outline* outline;
  RealVec position;
  SineCosine<double> of_angle;
};

/// The gap of one such feature with the outlines elsewhere [m].
double gap_of(const NearFeature& feature, const OutlineAt& a, const OutlineAt& b);
double gap_of(const NearFeature& feature, const Outline& a, const ExtendedState& state_a, const Outline& b,
              const ExtendedState& state_b);

}  // namespace brink
