#pragma once
/// On which side of a wire a sample lies, as told by where its edges lead. Internal to near_features().

#include <cmath>
#include <limits>

#include "brink/core/shapes/curve_site.h"
#include "brink/scheduler/islands/corner_sides.h"

namespace brink::islands {

/// How far a curve leads to either side of a line.
struct Sides {
  double least = std::numeric_limits<double>::infinity(), most = -least;

  void see(double height) {
    least = std::min(least, height);
    most = std::max(most, height);
  }
  /// To one side alone, and by more than `told`.
  bool tells(double told) const { return !(most > told && -least > told) && std::max(most, -least) > told; }
};

/// Sees the height of places along `walked` from an end of it, as far as they are abreast of `beside`. Both map from a
/// site's frame: to where it lies beside `beside`, and to its height.
template <class ToBeside, class Height>
void walk(const Site& walked, bool from_start, const Site& beside, ToBeside&& to_beside, Height&& height,
          Sides& sides) {
  constexpr int kHalvings = 20;
  double part = std::ldexp(1.0, -kHalvings);
  for (int k = 0; k <= kHalvings; ++k, part *= 2.0) {
    const Vec2 p = point_along(walked, from_start ? part : 1.0 - part);
    if (nearest_on(beside, to_beside(p)).foot != Foot::interior) return;
    sides.see(height(p));
  }
}

/// On which side of a wire's site a carrier lies.
struct SideOfWire {
  bool before = true;  ///< on that to which a normal points
  SideTold told = SideTold::surely;
};

/// Whether the carrier lies on the side of a wire's site to which `out` points, as told from its vertex at q, `height` on
/// that side of a place of the site: by whichever of the vertex and its edges, as far as they are abreast of the site, is
/// farthest from there, as no edge crosses a wire. A rod that comes to lie flat leads from its upper end down to the wire;
/// round the end of the site an edge may lead anywhere. Where its edges lie along the wire, the wire tells, by where it leads
/// from the site's ends; where nothing does the little that edges lead away; and where they do not, or lead to both sides, the
/// carrier's centre.
SideOfWire side_of_wire(const Half& half, const Sample& sample, const Site& site, const Vec2& q,
                        const Vec2& out, double height);

/// Where a sample lies that is upon an end of a wire's site, or upon its corner with others.
struct OnWire {
  OnCorner where = OnCorner::nowhere;
  Vec2 normal = Vec2::Zero();  ///< of this side, towards the sample's owner
};

/// Of a vertex upon an end of site j of a wire: on that of its sides that parts the two there, if one does. On another site's
/// if one of those does, and none of this: round a corner the vertex meets it no more than a free end. What only a side of
/// the vertex parts lies on that, and has the contact. In a hollow corner
/// none parts the two, and each site counts as elsewhere; but the hollow itself meets no side of the corner that is in it.
OnWire on_wire(const Half& half, const Sample& sample, std::size_t j, const Vec2& q, double tie);

/// The feature of a vertex upon an end of a wire's site is that of the side on which it lies.
void turn_to_side(const Half& half, const Vec2& q, const Vec2& normal, NearFeature& f);

/// True of q that is nearest to an end which two pieces of a wire share, beyond both, and that a sample on the side to
/// which `out` points can come to only through the two: it was in their hollow corner.
bool is_through_joint(const Outline& outline, const Site& site, const Nearest& nearest, const Vec2& q,
                      const Vec2& out);

}  // namespace brink::islands
