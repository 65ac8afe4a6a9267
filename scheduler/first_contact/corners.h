#pragma once
/// Two corners of solids that are at one point: do they come to overlap as one goes on?

#include <optional>

#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/outline.h"

namespace brink::detail {

/// A corner by the outward unit normals of the two sides that meet there, in the order of travel. That of a point without
/// thickness, which has no sides and faces every direction, has normals of zero.
struct Corner {
  Vec2 before = Vec2::Zero(), after = Vec2::Zero();

  static constexpr double kRounding = 1e-12;  ///< of unit normals
  /// Sine of a turn at which the foot of a place 1e-10 of the size behind a tip is some ten roundings beside that.
  static constexpr double kTurns = 1e-5;

  /// Needles included: their two normals are opposite.
  bool convex() const { return cross(before, after) >= -kRounding; }
  /// True of a convex corner that turns enough for every place in the solid to be nearer to one of its sides than to its tip.
  /// Where two sides go on into each other, or all but do, what is right behind the joint is nearest to that, by rounding.
  bool sharp() const { return cross(before, after) > kTurns || needle(); }
  bool needle() const { return std::abs(cross(before, after)) <= kRounding && before.dot(after) < 0.0; }
  /// True if the direction is an outward normal of the corner: one between its sides', both included.
  bool faces(const Vec2& u) const { return cross(before, u) >= -kRounding && cross(u, after) >= -kRounding; }
};

inline Vec2 right_of(const Vec2& direction) { return -perp(direction); }

/// The corner at an end of a solid's side.
inline Corner corner_at(const Site& site, bool at_a) {
  const Vec2 own = right_of(at_a ? direction_at_start(site) : direction_at_end(site));
  const Vec2 sum = at_a ? site.pseudo_a : site.pseudo_b;
  const Vec2 left = sum - own;
  const bool cusp = std::abs(left.norm() - 1.0) > 1e-6;  // the pseudo-normal is its tangent then
  const Vec2 other = cusp ? Vec2(-own) : left;
  return at_a ? Corner{other, own} : Corner{own, other};
}

/// The corner at a solid's vertex sample. @pre sample.before >= 0.
inline Corner corner_at(const Outline& outline, const Sample& sample) {
  return {right_of(direction_at_end(outline.sites[static_cast<std::size_t>(sample.before)])),
          right_of(direction_at_start(outline.sites[static_cast<std::size_t>(sample.after)]))};
}

/// A wire at a place where it ends: a needle, all directions but those along which the wire lies. Or where two pieces meet: the convex
/// corner with those two sides. Nothing where pieces go on straight or back, or more than two meet.
inline std::optional<Corner> corner_of_wire(const Outline& outline, const Vec2& p) {
  if (outline.solid) return std::nullopt;
  Vec2 inwards[2];
  int count = 0;
  for (const Site& site : outline.sites) {
    if (site.kind == SiteKind::point) continue;
    for (const bool at_a : {true, false}) {
      if ((at_a ? site.a : site.b) != p) continue;
      if (count == 2) return std::nullopt;
      inwards[count++] = at_a ? direction_at_start(site) : Vec2(-direction_at_end(site));
    }
  }
  if (count == 0) return std::nullopt;
  if (count == 1) return Corner{perp(inwards[0]), -perp(inwards[0])};
  const double turn = cross(inwards[0], inwards[1]);
  if (std::abs(turn) <= Corner::kTurns) return std::nullopt;
  // travelled with what is between the two on the left: in along `first`, out along `second`
  const Vec2 &first = turn > 0.0 ? inwards[1] : inwards[0], &second = turn > 0.0 ? inwards[0] : inwards[1];
  return Corner{perp(first), -perp(second)};
}

/// The first of these: nothing where a wire goes on, or does not end.
inline std::optional<Corner> end_of_wire(const Outline& outline, const Vec2& p) {
  const std::optional<Corner> found = corner_of_wire(outline, p);
  return found && found->needle() ? found : std::nullopt;
}

/// The same in the frame of another outline.
inline Corner seen_from(const Corner& own, const Frame& from, const Frame& to) {
  const auto seen = [&](const Vec2& n) { return to.direction_to_local(from.direction_to_world(n)); };
  return {seen(own.before), seen(own.after)};
}

/// The corner at a solid's vertex sample, in the frame of another outline.
inline Corner corner_seen(const Outline& outline, const Sample& sample, const Frame& from, const Frame& to) {
  return seen_from(corner_at(outline, sample), from, to);
}

/// The way from a sample, at q in the frame `to`, into what carries it: of a solid's corner, of anything else to
/// its origin.
inline Vec2 way_inside(const Outline& outline, const Sample& sample, const Frame& from, const Frame& to,
                       const Vec2& q) {
  if (sample.before < 0) return to.to_local(from.origin) - q;
  const Corner corner = corner_seen(outline, sample, from, to);
  return -(corner.before + corner.after);
}

/// True if a line that has t behind it and s before it stays between them: two convex corners, the tip of s `way` from
/// that of t, not behind the line by more than `depth`. `goes_back`: whether s goes over the line of that normal.
template <class GoesBack>
bool is_parted(const Corner& s, const Corner& t, const Vec2& way, double depth, GoesBack&& goes_back) {
  for (const Vec2& u : {t.before, t.after, Vec2(-s.before), Vec2(-s.after)})
    if (!u.isZero(0.0) && t.faces(u) && s.faces(-u) && u.dot(way) >= -depth && !goes_back(u)) return true;
  return false;
}

/// How two tips go on: the way between them [m], its rate [m/s], how much that may change [m/s^2], and how far one may be behind
/// a line [m].
struct Passing {
  Vec2 way, rate;
  double bend = 0.0, depth = 0.0;

  /// Before the line `on` until it has come before `off`: what slides on one side of an edge off the other.
  bool goes_from(const Vec2& on, const Vec2& off) const {
    const double left = -off.dot(way), leaves = off.dot(rate);
    if (!(leaves > 0.0 && left >= 0.0 && on.dot(way) >= -depth)) return false;
    const double later = left / leaves;
    return on.dot(way + later * rate) >= -depth && 0.5 * bend * later * later <= 0.25 * depth;
  }
};

/// True if one line parts them as long as s is on it, and then another.
inline bool is_passed(const Corner& s, const Corner& t, const Passing& how) {
  const Vec2 lines[] = {t.before, t.after, -s.before, -s.after};
  const auto parts = [&](const Vec2& u) { return !u.isZero(0.0) && t.faces(u) && s.faces(-u); };
  for (const Vec2& on : lines)
    for (const Vec2& off : lines)
      if (&on != &off && parts(on) && parts(off) && how.goes_from(on, off)) return true;
  return false;
}

/// The same of a wire's end t, from where it leads away from lines of the corner's own sides: those have it before them.
template <class GoesBack>
bool is_parted_from_wire(const Corner& s, const Corner& t, const Passing& how, GoesBack&& goes_back) {
  constexpr double kLeadsAway = 1e-6;  // sine: what lies along the line may bend to either side
  const Vec2 inwards = right_of(t.before), one = -s.before, other = -s.after;
  const auto leads_away = [&](const Vec2& u) { return u.dot(inwards) <= -kLeadsAway; };
  for (const Vec2& u : {one, other})
    if (leads_away(u) && u.dot(how.way) >= -how.depth && !goes_back(u)) return true;
  return leads_away(one) && leads_away(other) && (how.goes_from(one, other) || how.goes_from(other, one));
}

/// True if two convex corners that touch at their tips come to overlap as s moves along d. Grazing is passing by (a
/// corner that slides over an edge), but of a needle, which has its thickness just behind its tip.
inline bool come_to_overlap(const Corner& s, const Corner& t, const Vec2& d) {
  if (!s.convex() || !t.convex()) return false;
  const double grazing = (s.needle() || t.needle() ? 1e-6 : -1e-6) * d.norm();
  return !is_parted(s, t, Vec2::Zero(), 0.0, [&](const Vec2& u) { return u.dot(d) < grazing; });
}

/// True if n, an outward normal of t, is the only direction out of it that has the one corner before it and the other
/// behind: two that lie flush on one side.
inline bool parts_alone(const Vec2& n, const Corner& s, const Corner& t) {
  if (!s.convex() || !t.convex() || !s.faces(-n)) return false;
  for (const Vec2& u : {t.before, t.after, Vec2(-s.before), Vec2(-s.after)})
    if (t.faces(u) && s.faces(-u) && u.dot(n) < 1.0 - 1e-9) return false;
  return true;
}

}  // namespace brink::detail
