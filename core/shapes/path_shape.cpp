/// make_path: subpaths to loops of segments and arcs, in the frame with y upward.
///
///     read the data; for each subpath
///       close what is open by a rounding only
///       make its sites: lines, exact circular arcs, other curves by fit_arcs()
///     if all subpaths are closed, orient them by the even-odd rule and refuse those that cross or touch
///     put the loops together and measure

#include <algorithm>
#include <numbers>

#include "brink/core/base/elementary.h"
#include "brink/core/base/error.h"
#include "brink/core/shapes/biarc.h"
#include "brink/core/shapes/crossing.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/loops.h"
#include "brink/core/shapes/svg_path.h"
#include "brink/core/shapes/text.h"

namespace brink {

namespace {

/// From SVG's frame to ours: scaled, y upward.
struct Upward {
  double scale = 1.0;
  Vec2 operator()(const Vec2& p) const { return {scale * p.x(), -scale * p.y()}; }
};

/// An SVG arc by its centre, in our frame (SVG 2, appendix B.2.4; the flip of y turns angles round).
struct CenterArc {
  Vec2 center = Vec2::Zero();
  Vec2 u = Vec2::Zero(), v = Vec2::Zero();  ///< half axes; v = u turned by +90 degrees and rescaled
  double start = 0.0, sweep = 0.0;          ///< [rad], in the parameter of c + u cos t + v sin t
};

/// @pre both half axes are > 0 and the ends differ: the parser makes lines of other arcs, or nothing.
CenterArc center_of(const PathPiece& piece, const Upward& up) {
  const Vec2 a = up(piece.from), b = up(piece.to);
  // [rad]; whole turns are taken off while it is in degrees, where they are exact
  const double rotation = std::fmod(piece.rotation, 360.0) * std::numbers::pi / 180;
  // an ellipse is its own mirror image in its axes, so y_axis may point either way
  const Vec2 x_axis = unit_at(-rotation), y_axis = perp(x_axis);
  double rx = up.scale * piece.rx, ry = up.scale * piece.ry;
  const Vec2 half = 0.5 * (a - b);
  // in units of the half axes the ellipse is the unit circle
  Vec2 h(half.dot(x_axis) / rx, half.dot(y_axis) / ry);
  const double reach = h.norm();
  // half axes too short for the chord are scaled up until they just reach (SVG 2, appendix B.2.5)
  if (reach > 1.0) {
    rx *= reach;
    ry *= reach;
    h /= reach;
  }
  // from the chord's middle to the centre, in units of half the chord: Pythagoras in the unit circle
  // half the chord is `reach` long there, and the centre is sqrt(1 - reach^2) from its middle
  const double offset = reach >= 1.0 ? 0.0 : std::sqrt((1 - reach) * (1 + reach)) / reach;
  // travelling clockwise on screen is clockwise here too; the short way round keeps the centre on its right
  const bool counter_clockwise = !piece.sweep;
  const bool center_on_left = counter_clockwise != piece.large;
  const Vec2 c = (center_on_left ? offset : -offset) * perp(-h);
  CenterArc arc;
  arc.u = rx * x_axis;
  arc.v = ry * y_axis;
  arc.center = 0.5 * (a + b) + c.x() * arc.u + c.y() * arc.v;
  const Vec2 from = h - c, to = -h - c;
  // from the centre to the start and to the end, still in units of the half axes
  arc.start = angle_of(from.y(), from.x());
  double sweep = angle_of(cross(from, to), from.dot(to));
  // atan2() tells the way round of at most half a turn: it may be the other one that is meant
  if (counter_clockwise && sweep < 0.0) sweep += 2 * std::numbers::pi;
  if (!counter_clockwise && sweep > 0.0) sweep -= 2 * std::numbers::pi;
  arc.sweep = sweep;
  return arc;
}

/// Makes sites, in our frame, of pieces as they were read, and keeps how far fitted curves are off.
class PathBuilder {
 public:
  PathBuilder(double scale, double tolerance) : up_{scale}, tolerance_(tolerance) {}

  std::vector<Site> sites_of(const Subpath& subpath) {
    std::vector<Site> sites;
    for (const PathPiece& piece : subpath.pieces) add(piece, sites);
    return sites;
  }
  double deviation() const { return deviation_; }

 private:
  void add(const PathPiece& piece, std::vector<Site>& sites) {
    const Vec2 a = up_(piece.from), b = up_(piece.to);
    switch (piece.kind) {
      case PathPieceKind::line:
        sites.push_back(segment_site(a, b, 0.0));
        return;
      case PathPieceKind::cubic:
        return fit(CubicBezier({a, up_(piece.control_1), up_(piece.control_2), b}), a, b, sites);
      case PathPieceKind::arc:
        break;
    }
    const CenterArc arc = center_of(piece, up_);
    // circles stay exact, also those that center_of() has scaled up
    // The parser's ends are taken, not those computed from the centre: pieces join bit for bit.
    if (piece.rx == piece.ry)
      add_arc(sites, a, b, arc.center, arc.u.norm(), arc.sweep, 0.0);
    else
      fit(EllipticalArc(arc.center, arc.u, arc.v, arc.start, arc.start + arc.sweep), a, b, sites);
  }

  void fit(const SmoothCurve& curve, const Vec2& a, const Vec2& b, std::vector<Site>& sites) {
    // the worst of all curves is what the outline states
    deviation_ = std::max(deviation_, fit_arcs(curve, a, b, tolerance_, 0.0, sites));
  }

  Upward up_;
  double tolerance_;
  double deviation_ = 0.0;
};

/// What roundings make of the places of some hundred relative commands, each rounded to the size of the
/// coordinates [as written].
double rounding_of(const Subpath& subpath) {
  Box box;
  for (const PathPiece& piece : subpath.pieces) box.add(piece.to);
  const Vec2 start = subpath.pieces.front().from;
  box.add(start);
  return 1e-13 * (box.extent().norm() + start.norm());
}

/// Relative commands come back to the start only up to rounding: the last end is put onto the first start
/// then.
void close_rounding_gap(Subpath& subpath) {
  std::vector<PathPiece>& pieces = subpath.pieces;
  const Vec2 start = pieces.front().from;
  const double rounding = rounding_of(subpath);
  const auto is_there = [&](const Vec2& p) { return (p - start).norm() <= rounding; };
  // a line from there to there is what Z drew over the rounding: the piece before it ends at the start
  std::size_t kept = pieces.size();
  const auto is_line = [](const PathPiece& piece) { return piece.kind == PathPieceKind::line; };
  const auto is_gap = [&](const PathPiece& p) { return is_line(p) && is_there(p.from) && is_there(p.to); };
  while (kept > 0 && is_gap(pieces[kept - 1])) --kept;
  // two lines enclose nothing
  if (kept == 0 || (kept < 3 && std::all_of(pieces.begin(), pieces.begin() + kept, is_line))) return;
  // what is left is closed only if its own last end is at the start
  PathPiece& last = pieces[kept - 1];
  if (!is_there(last.to)) return;
  // the chord of an arc places its circle: of one that is all but whole it must stay
  if (last.kind == PathPieceKind::arc && is_there(last.from)) return;
  last.to = start;
  pieces.resize(kept);
  subpath.closed = true;
}

/// @pre the loop runs counter-clockwise.
/// Cost: all sites of the loop.
bool loop_contains(const std::vector<Site>& loop, const Vec2& p) {
  Outline outline;
  add_loop(outline, loop, true);
  outline.solid = true;
  finish_outline(outline);
  return gap_by_brute_force(outline, p) < 0.0;
}

/// Even-odd: a loop inside an odd number of others is a hole.
/// Loops are first all turned counter-clockwise, for the test. Cost: pairs of loops times sites.
void orient_even_odd(std::vector<std::vector<Site>>& loops) {
  for (std::vector<Site>& loop : loops)
    if (enclosed_area(loop) < 0.0) loop = reversed(loop);
  std::vector<bool> hole(loops.size(), false);
  for (std::size_t k = 0; k < loops.size(); ++k)
    for (std::size_t j = 0; j < loops.size(); ++j)
      // one place tells of the whole loop: require_simple() refuses loops that cross or touch afterwards
      if (j != k && loop_contains(loops[j], loops[k].front().a)) hole[k] = !hole[k];
  for (std::size_t k = 0; k < loops.size(); ++k)
    // not before all are told, as loop_contains() wants them counter-clockwise
    if (hole[k]) loops[k] = reversed(loops[k]);
}

/// @throws BadInput if some are closed and some open: an outline has an inside, or is of wire.
void require_one_kind(const std::vector<Subpath>& subpaths) {
  const auto other = std::find_if(subpaths.begin(), subpaths.end(),
                                  [&](const Subpath& s) { return s.closed != subpaths.front().closed; });
  if (other == subpaths.end()) return;
  const char *first = subpaths.front().closed ? "closed" : "open", *then = other->closed ? "closed" : "open";
  throw BadInput("path: subpath 1 is " + std::string(first) + ", subpath " +
                 std::to_string(other - subpaths.begin() + 1) + " is " + then +
                 "; allowed: all closed (a solid), or all open (wires)");
}

}  // namespace

Shape make_path(std::string_view d, double scale, double curve_tolerance) {
  require_positive("scale", scale);
  require_positive("curve_tolerance", curve_tolerance);
  std::vector<Subpath> subpaths = parse_svg_path(d);
  if (subpaths.empty()) throw BadInput("path: draws nothing; at least one line, curve or arc is needed");
  PathBuilder builder(scale, curve_tolerance);
  std::vector<std::vector<Site>> loops;
  for (Subpath& subpath : subpaths) {
    close_rounding_gap(subpath);
    loops.push_back(builder.sites_of(subpath));
    // fit_arcs() leaves out what is shorter than the tolerance and comes back to its start
    if (loops.back().empty())
      throw BadInput("path: subpath " + std::to_string(loops.size()) +
                     " (from 1) is shorter than curve_tolerance, " + text(curve_tolerance) +
                     " m, and comes back to its start; allowed: subpaths that are longer");
  }
  require_one_kind(subpaths);
  Outline outline;
  outline.solid = subpaths.front().closed;
  // wires keep the direction in which they were drawn
  if (outline.solid) orient_even_odd(loops);
  // a loop a subpath, in the order of the data: faults and site numbers go by it
  for (std::size_t k = 0; k < loops.size(); ++k) add_loop(outline, loops[k], subpaths[k].closed);
  outline.curve_deviation = builder.deviation();
  finish_outline(outline);
  // needs the bounds that finish_outline() fills; wires may cross themselves
  if (outline.solid) require_simple(outline, "path");
  return finish_shape(std::move(outline));
}

}  // namespace brink
