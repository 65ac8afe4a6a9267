#pragma once
/// Two outlines of which one carries samples and the other has sites: places and directions as one sees the other. Internal to
/// near_features().

#include <array>

#include "brink/core/shapes/distance.h"
#include "brink/scheduler/islands/near_features.h"
#include "brink/scheduler/resolve/wedge.h"

namespace brink::islands {

/// One outline that carries the samples, and the other, each in its own frame.
/// Features of a half are told with normals from b into a all the same: `on_a` says which way to turn them.
struct Half {
  const Outline& carrier;
  const Outline& other;
  Frame carrier_frame, other_frame;  ///< from b's position
  bool on_a;
};

/// The sample's corner as it lies in the other's frame.
Wedge wedge_of(const Half& half, const Sample& sample);

/// The middle of what carries the samples, in the other's frame: a site's own frame may be anywhere.
Vec2 centre(const Half& half);

/// Of a segment of a solid: to its right.
Vec2 outward(const Site& site);

/// True if the way from the site to q has a direction: it is longer than `least`.
bool has_direction(const Nearest& nearest, const Vec2& q, double least);

/// Out of the site, in its frame; where the two points are one, the site's own normal.
Vec2 direction(const Site& site, const Nearest& nearest, const Vec2& q, double least);

/// True if what is nearest to an end of a solid's straight side is inside the solid: in a hollow corner, a rounding
/// beyond the other side. How far it is from this side is for this side's own normal to say.
bool is_beyond_hollow_end(const Site& site, const Nearest& nearest, double side);

/// The end of a site that is nearer to q.
const Vec2& nearer_end(const Site& site, const Vec2& q);

/// How far q is beyond the ends of a straight site, along it [m].
double beyond_ends(const Site& site, const Vec2& q);

/// True of q, abreast of the site, on the other side of it than that to which `out` points from `at`, about there on the
/// site. A wire's arc has no inside: of that the side is the one of its circle on which q was.
bool is_behind(const Site& site, const Nearest& nearest, const Vec2& q, const Vec2& out, const Vec2& at);

/// The direction in which a site leads away from that end of it.
Vec2 leads_from(const Vec2& end, const Site& site);

/// True if the two, which share that end, go on into each other there.
bool joins_smoothly(const Vec2& end, const Site& one, const Site& other);

/// True if what is nearest is an end of the site from which no other goes on smoothly.
bool ends_at(const Outline& outline, const Site& site, const Nearest& nearest);

/// Both outlines as carrier and as other, in frames that are seen from b's position.
/// Differences of places are taken in extended precision, before they are rounded to doubles.
std::array<Half, 2> halves(const OutlineAt& a, const OutlineAt& b);

}  // namespace brink::islands
