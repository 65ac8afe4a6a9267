#include "brink/core/world/recentred.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

/// True if the frame of a site turns with time or stands at an angle.
bool turned(const FixedSite& site) {
  // In a turned frame the shift would be turned too, and would no longer be exact.
  if (site.pose.angle != 0.0) return true;
  if (const auto* constant = std::get_if<ConstantMotion>(&site.motion)) return constant->twist.omega != 0.0;
  const auto* told = std::get_if<FormulaMotion>(&site.motion);
  return told && told->angle;
}

/// The multiple of a power of two, about the size of the box, that is nearest to its middle.
Vec2 round_place_in(const Box& box) {
  const Vec2 middle = 0.5 * (box.low + box.high);
  const double size = (box.high - box.low).maxCoeff();
  // A box nearer than two of its sizes gains a bit or two at most.
  if (!(size > 0.0) || middle.lpNorm<Eigen::Infinity>() <= 2.0 * size) return Vec2::Zero();
  // From one to two sizes: the place is less than a size from the middle, and no coordinate in the new frame
  // is beyond one and a half. A multiple of a power of two has few bits, so that a shift by it seldom rounds.
  int doublings = 0;
  const bool is_power = std::frexp(size, &doublings) == 0.5;
  const double unit = std::ldexp(1.0, is_power ? doublings - 1 : doublings);
  return {unit * std::round(middle.x() / unit), unit * std::round(middle.y() / unit)};
}

/// True if p + by is not rounded: the error term of Knuth's two-sum is 0.
bool exactly_moved(const Vec2& p, const Vec2& by) { return (p + by) - by == p && (p + by) - p == by; }

bool exactly_moved(const Outline& outline, const Vec2& by) {
  return std::all_of(outline.sites.begin(), outline.sites.end(), [&](Site s) {
    if (!exactly_moved(s.a, by) || !exactly_moved(s.b, by)) return false;
    if (s.kind != SiteKind::arc) return true;
    if (!exactly_moved(s.center, by)) return false;
    // ends that were rounded far away may be no ends of that circle nearer by
    for (Vec2* p : {&s.a, &s.b, &s.center}) *p += by;
    return is_arc_fit(s);
  });
}

}  // namespace

FixedSite recentred(const FixedSite& site) {
  if (turned(site)) return site;
  const Vec2 to = round_place_in(site.outline->bounds), back = -to;
  // All or nothing: were one coordinate rounded, the site would not be the one that was given.
  if (to.isZero(0.0) || !exactly_moved(*site.outline, back) || !exactly_moved(site.pose.position, to))
    return site;
  // A motion that does not turn goes on as it was: it shifts the new frame as it shifted the old one.
  FixedSite moved = site;
  moved.outline = std::make_shared<const Outline>(transformed(*site.outline, {back, 0.0}));
  moved.pose.position += to;
  return moved;
}

}  // namespace brink
