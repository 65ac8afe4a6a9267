#include "brink/scheduler/first_contact/pair_view.h"

#include <numeric>
#include <optional>

#include "brink/core/base/limits.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/first_contact/corners.h"
#include "brink/scheduler/first_contact/site_step.h"

namespace brink::detail {

namespace {

/// True if q, on its way in direction `d`, is at a convex corner of a solid at an end of the site, to
/// `rounding`, and the corner is the nearest to where it comes from, though now its foot lies a rounding
/// inside.
bool comes_to_corner(const Site& site, const Nearest& nearest, const Vec2& q, const Vec2& d,
                     double rounding) {
  if (!site.solid) return false;
  const double to_a = (q - site.a).squaredNorm(), to_b = (q - site.b).squaredNorm();
  if (std::min(to_a, to_b) > rounding * rounding) return false;
  const bool at_a = to_a < to_b;
  const Vec2 &bisector = at_a ? site.pseudo_a : site.pseudo_b, normal = normal_at(site, nearest, q);
  const Vec2 beyond = at_a ? Vec2(-perp(normal)) : perp(normal);  // the site's way on beyond its end
  const double speed = d.norm();
  // The corner is convex if its bisector leans on beyond the end. The site's own normal is an edge of
  // the cone of the corner's normals, so -d lies in the cone if it is no farther from the bisector than
  // that normal.
  return beyond.dot(bisector) > 0.0 && -d.dot(bisector) >= normal.dot(bisector) * speed;
}

/// True if the solid's boundary goes on from that end of the site towards the site's free side: what lies there meets
/// a face, not a tip.
bool is_hollow(const Site& site, bool at_a) {
  const Vec2 inward = at_a ? direction_at_start(site) : Vec2(-direction_at_end(site));
  return inward.dot(at_a ? site.pseudo_a : site.pseudo_b) > kParallel;
}

/// The site's own outward normal there.
Vec2 face_at_end(const Site& site, bool at_a) {
  return right_of(at_a ? direction_at_start(site) : direction_at_end(site));
}

/// The same of the place that is nearest to q.
Vec2 face_of(const Site& site, const Nearest& nearest, const Vec2& q) {
  const bool at_end = nearest.foot != Foot::interior && site.kind != SiteKind::point;
  return at_end ? face_at_end(site, nearest.foot == Foot::start) : normal_at(site, nearest, q);
}

/// True of what is nearest to a solid's convex tip: nothing is in the solid there. What is behind the tip is in, or along, the
/// other side that ends there.
bool is_beyond_tip(const Site& site, const Nearest& nearest) {
  return nearest.foot != Foot::interior && site.solid && corner_at(site, nearest.foot == Foot::start).sharp();
}

/// Cosine of the angle between the faces of a sliver: they look away from each other.
constexpr double kOpposite = -0.9;

/// What is nearer to a wire than this part of its level has started there: what collides keeps five eighths of it.
constexpr double kStartsOnWire = 0.2;

/// A direction out of the site's end at which q is nearest; where they are one, to `rounding`, that of a
/// solid's corner.
Vec2 outward(const Site& site, const Nearest& nearest, double side, const Vec2& q, double rounding) {
  if (nearest.distance > rounding || !site.solid) return side * (q - nearest.point);
  return nearest.foot == Foot::start ? site.pseudo_a : site.pseudo_b;
}

}  // namespace

PairView::PairView(const Mover& a, const Mover& b, const SearchLimits& limits, SearchScratch& scratch)
    : a_(a),
      b_(b),
      of_a_(*a.motion, !is_centred_disc(a.outline())),
      of_b_(*b.motion, !is_centred_disc(b.outline())),
      limits_(limits),
      scratch_(scratch) {
  // A core of one point needs no reverse test: its one sample against the other's sites is the whole
  // distance.
  const bool point_a = a.outline().is_point(), point_b = !point_a && b.outline().is_point();
  halves_[0] = {&a, &b, true, point_b ? 0 : static_cast<int>(a.outline().samples.size())};
  halves_[1] = {&b, &a, false, point_a ? 0 : static_cast<int>(b.outline().samples.size())};
}

/// As a rule the signed distance along the site's normal. Three cases differ. At an end of a solid's side,
/// in a notch or flush beside it, the side counts as a face that goes on beyond the end. Right on a wire
/// without thickness the side is that of the sample's own body. And of two points that meet the direction
/// between them is rounding: they have that of their way.
Feature PairView::vertex_feature(const Placing& p, const Half& half, int i, int j, const Nearest& nearest,
                                 const SamplePath& path) const {
  const Sample& sample = half.sample(i);
  const Site& site = half.site(j);
  Feature f{i, j, 0.0, 0.0, normal_at(site, nearest, path.q), nearest.point};
  const bool at_end = nearest.foot != Foot::interior && site.kind != SiteKind::point;
  double side = side_of(site, nearest, path.q);
  // right beside the tip of a thorn its side is a rounding's
  if (side < 0.0 && at_end && is_beyond_tip(site, nearest) &&
      nearest.distance > 4.0 * p.gap_rounding(half, i, path.q)) {
    side = 1.0;
    f.normal = -f.normal;
  }
  f.gap = side * nearest.distance - site.radius - sample.radius;
  if (at_end && nearest.distance <= limits_.tolerance) {
    const double rounding = p.gap_rounding(half, i, path.q);
    const bool at_a = nearest.foot == Foot::start;
    // In a hollow corner each side is a face: the way from the corner itself is rounding, and between the two
    // normals lies one that says of neither how long it is clear.
    const bool in_notch = site.solid && nearest.distance <= 4.0 * rounding && is_hollow(site, at_a);
    if (in_notch || is_flush_on(p, half, i, site, path.q, rounding)) {
      f.normal = face_for(p, half, i, site, at_a, path.q);
      if (!in_notch) f.gap = f.normal.dot(path.q - nearest.point);
      f.rate = f.normal.dot(path.rate);
      f.point = path.q - f.normal * (f.gap + sample.radius);
      return f;
    }
  }
  const bool thin = !site.solid && site.kind != SiteKind::point && site.radius + sample.radius == 0.0;
  if (thin && nearest.distance <= limits_.touch &&
      nearest.distance <= kStartsOnWire * nominal_level(p, half, i, site, path.q)) {
    // on the wire itself, or by less than a step beyond: it is on the side on which its body is
    const Vec2 inside =
        way_inside(half.samples_of(), sample, p.of(half.s_is_a).frame, p.of(!half.s_is_a).frame, path.q);
    const bool at_a = nearest.foot == Foot::start;
    const Vec2 face = at_end ? face_at_end(site, at_a) : f.normal, off = path.q - nearest.point;
    // at an end only where it is abreast of that, to rounding
    if (!at_end || std::abs(cross(face, off)) <= 4.0 * p.gap_rounding(half, i, path.q)) {
      const bool beyond = face.dot(inside) < 0.0;
      f.normal = beyond ? Vec2(-face) : face;
      f.gap = at_end ? f.normal.dot(off) : beyond ? -nearest.distance : nearest.distance;
    }
  }
  const auto comes_to_end = [&] {
    const double rounding = 4.0 * p.gap_rounding(half, i, path.q);
    if (nearest.foot == Foot::interior && site.kind != SiteKind::point)
      return comes_to_corner(site, nearest, path.q, path.rate, rounding);
    // What goes by the end of a wire at its level has a direction of its own.
    const Vec2 off = path.q - nearest.point;
    const bool beside = thin && std::abs(cross(path.rate, off)) > rounding * path.rate.norm();
    return !beside && outward(site, nearest, side, path.q, rounding).dot(path.rate) < 0.0;
  };
  if (site.radius + sample.radius == 0.0 && path.rate.squaredNorm() > 0.0 && f.gap > -limits_.touch &&
      nearest.distance <= limits_.tolerance && comes_to_end())
    f.normal = -path.rate.normalized();  // two points that meet: the limit of their direction
  f.rate = f.normal.dot(path.rate);
  f.point =
      path.q - f.normal * (f.gap + sample.radius);  // from the sample: a long site's foot has lost digits
  return f;
}

/// Vertex sample i and the site nearest to it; a corner that lies flush beside an end has the side on which
/// it lies, though the corner's other side is as near. No site where the index knows of none, or its gap is
/// more than `tolerance`, by far.
Feature PairView::nearest_feature(const Half& half, int i, double tolerance) const {
  const SamplePath now = path(half, i);
  const FieldAnswer nearest = half.t->index->query(now.q, scratch_.nearest);
  if (nearest.site < 0 || nearest.gap - half.sample(i).radius > tolerance + limits_.tolerance) return {};
  if (std::abs(nearest.gap) <= limits_.tolerance && half.sample(i).before >= 0) {
    const double rounding = gap_rounding(half, i, now.q);
    for (int j = 0; j < static_cast<int>(half.sites_of().sites.size()); ++j)
      if (is_flush_on(half, i, half.site(j), now.q, rounding))
        return vertex_feature(half, i, j, nearest_on(half.site(j), now.q), now);
  }
  return vertex_feature(half, i, nearest.site, nearest_on(half.site(nearest.site), now.q), now);
}

ArcStep PairView::arc_now(const Half& half, int i, int j) const {
  const Site& arc = half.samples_of().sites[static_cast<std::size_t>(half.sample(i).arc_site)];
  // With bounds of nothing: the gap, its rate and its place are used, how long they are safe is not.
  return arc_step(arc, half.site(j), path(half, i), placed(half.s), placed(half.t), limits_.tolerance, {},
                  {0.0, 0.0}, 0.0);
}

FeatureContact PairView::look_again(const Half& half, const Feature& f, double time) const {
  if (half.sample(f.sample).arc_site >= 0) {
    const ArcStep step = arc_now(half, f.sample, f.site);
    return contact_of(half, {f.sample, f.site, step.gap, step.rate, step.normal, step.point}, time);
  }
  const SamplePath now = path(half, f.sample);
  const Nearest nearest = nearest_on(half.site(f.site), now.q);
  return contact_of(half, vertex_feature(half, f.sample, f.site, nearest, now), time);
}

/// From T's frame into the world. `time` is noted, not looked at: the pair may be placed at another.
FeatureContact PairView::contact_of(const Half& half, const Feature& f, double time) const {
  const Placed& site_owner = placed(half.t);
  FeatureContact c;
  c.time = time;
  c.sample_on_a = half.s_is_a;
  c.sample = f.sample;
  c.site = f.site;
  c.point = now_.base + site_owner.frame.to_world(f.point);
  const Vec2 out = site_owner.frame.direction_to_world(f.normal);
  c.normal = half.s_is_a ? out : Vec2(-out);
  c.closing_speed = -f.rate;
  c.gap = f.gap;
  const double nominal = nominal_level(now_, half, f.sample, half.site(f.site), path(half, f.sample).q);
  c.level = level_of(nominal, sink_);
  c.sink = c.level - nominal;
  return c;
}

double PairView::rate_noise(const SamplePath& path) const {
  return a_.velocity_rounding + b_.velocity_rounding + 16.0 * kEpsilon * path.magnitude;
}

void PairView::find_neighbours(const Half& half, int i, std::span<const std::uint32_t> sites,
                               const SamplePath& path, double reach) {
  const double radius = half.sample(i).radius;
  scratch_.neighbours.clear();
  scratch_.looked_from = path.q;
  scratch_.looked_to = reach;
  for (const std::uint32_t k : sites) {
    const Site& site = half.sites_of().sites[k];
    const Nearest nearest = nearest_on(site, path.q);
    if (nearest.distance - site.radius - radius > reach || is_covered_at(site, path.q)) continue;
    const Feature f = vertex_feature(half, i, static_cast<int>(k), nearest, path);
    // a face through which the corner's own edge leads does not count for it
    if (pokes_through(half, i, site, nearest, f)) continue;
    scratch_.neighbours.push_back({f.site, f.normal, nearest.foot != Foot::interior});
  }
  // A corner flush on one side lies beyond the end of the other:
  // the corner's other side says nothing of how far the flush one is
  const double rounding = gap_rounding(half, i, path.q);
  scratch_.flush_on = -1;
  for (const SearchScratch::Neighbour& n : scratch_.neighbours)
    if (is_flush_on(half, i, half.site(n.site), path.q, rounding)) scratch_.flush_on = n.site;
  // in one order, whoever named the candidates: of sites equally near the first is met
  std::sort(scratch_.neighbours.begin(), scratch_.neighbours.end(),
            [](const auto& x, const auto& y) { return x.site < y.site; });
}

bool PairView::is_flush_on(const Placing& p, const Half& half, int i, const Site& site, const Vec2& q,
                           double rounding) const {
  const Sample& sample = half.sample(i);
  const Outline &carrier = half.samples_of(), &other = half.sites_of();
  if (is_at_joint(half, i, site, q, rounding)) return true;
  // a corner of a solid on a side of a solid or on a wire, or a wire's end on a side of a solid
  const bool end = sample.before < 0;
  if (end && (carrier.solid || !site.solid || sample.arc_site >= 0)) return false;
  if (sample.hollow || site.kind == SiteKind::point || site.radius + sample.radius > 0.0) return false;
  const bool at_a = (q - site.a).squaredNorm() < (q - site.b).squaredNorm();
  const Vec2 way = q - (at_a ? site.a : site.b);
  // the cheap question first: most samples are at no corner
  if (!(way.squaredNorm() <= limits_.tolerance * limits_.tolerance)) return false;
  const Frame &s = p.of(half.s_is_a).frame, &t = p.of(!half.s_is_a).frame;
  const Vec2 normal = face_for(p, half, i, site, at_a, q);
  if (std::abs(cross(normal, way)) > 4.0 * rounding) return false;
  // a wire that goes on from there is no corner
  const std::optional<Corner> of_sample = end ? end_of_wire(carrier, sample.p) : corner_at(carrier, sample),
                              of_site = site.solid ? corner_at(site, at_a)
                                                   : end_of_wire(other, at_a ? site.a : site.b);
  return of_sample && of_site && parts_alone(normal, seen_from(*of_sample, s, t), *of_site);
}

bool PairView::is_at_joint(const Half& half, int i, const Site& site, const Vec2& q, double rounding) const {
  const Sample& sample = half.sample(i);
  if (!site.solid || site.kind != SiteKind::segment || site.radius + sample.radius > 0.0 || sample.hollow ||
      sample.arc_site >= 0)
    return false;
  const bool at_a = (q - site.a).squaredNorm() < (q - site.b).squaredNorm();
  if (!(at_a ? site.straight_a : site.straight_b)) return false;
  const Vec2 way = q - (at_a ? site.a : site.b);
  return way.squaredNorm() <= limits_.tolerance * limits_.tolerance &&
         std::abs(cross(face_at_end(site, at_a), way)) <= 4.0 * rounding;
}

Vec2 PairView::face_for(const Placing& p, const Half& half, int i, const Site& site, bool at_a,
                        const Vec2& q) const {
  const Vec2 face = face_at_end(site, at_a);
  if (site.solid) return face;
  const Vec2 inside =
      way_inside(half.samples_of(), half.sample(i), p.of(half.s_is_a).frame, p.of(!half.s_is_a).frame, q);
  return face.dot(inside) < 0.0 ? Vec2(-face) : face;
}

Vec2 PairView::acceleration_now(const Half& half, int i, const SamplePath& path) const {
  const Placed &s = placed(half.s), &t = placed(half.t);
  // Over no time at all the bounds' middle is the acceleration of S's origin against T's. The arm adds alpha
  // x arm - omega^2 arm; then T's turning frame takes off its own terms (pair_kinematics.h).
  const RelativeBounds at_once = RelativeBounds::over(half.samples_of(), *half.s->motion, half.sites_of(),
                                                      *half.t->motion, now_.time, now_.time);
  const auto alpha = [](const Motion& m) { return m.is_ballistic() ? m.acceleration().angular : 0.0; };
  const Vec2 arm = s.frame.direction_to_world(half.sample(i).p);
  const Vec2 pull = at_once.pull + alpha(*half.s->motion) * perp(arm) - s.twist.omega * s.twist.omega * arm;
  return t.frame.direction_to_local(pull) - alpha(*half.t->motion) * perp(path.q) -
         2.0 * t.twist.omega * perp(path.rate) + t.twist.omega * t.twist.omega * path.q;
}

bool PairView::passes_tip(const Half& half, const Feature& f) const {
  const Site& site = half.site(f.site);
  const Sample& sample = half.sample(f.sample);
  if (sample.arc_site >= 0 || site.kind == SiteKind::point || site.radius + sample.radius > 0.0) return false;
  const SamplePath path = this->path(half, f.sample);
  const bool at_a = (path.q - site.a).squaredNorm() < (path.q - site.b).squaredNorm();
  const Vec2 tip = at_a ? site.a : site.b, way = path.q - tip;
  if (!(way.squaredNorm() <= limits_.tolerance * limits_.tolerance)) return false;
  if (is_at_joint(half, f.sample, site, path.q, gap_rounding(half, f.sample, path.q))) return false;
  const Outline &carrier = half.samples_of(), &other = half.sites_of();
  const bool bare = carrier.is_point() && site.solid;
  const std::optional<Corner> own = bare                 ? Corner{}
                                    : sample.before >= 0 ? corner_at(carrier, sample)
                                                         : corner_of_wire(carrier, sample.p),
                              of_site = site.solid ? corner_at(site, at_a) : corner_of_wire(other, tip);
  if (!own || !of_site || !own->convex() || !of_site->convex()) return false;
  const Corner of_sample = seen_from(*own, placed(half.s).frame, placed(half.t).frame);
  // A needle has its thickness just behind its tip: that a line parts the tips says nothing of it. The end of a wire has none.
  const bool ends = own->needle(), site_ends = of_site->needle();
  if ((ends && sample.before >= 0) || (site_ends && site.solid) || (ends && site_ends)) return false;
  const Vec2 pull = acceleration_now(half, f.sample, path);
  const double noise = rate_noise(path);
  // a turning that is no more than a rounding bends the way by so much
  const double turned = noise * path.rate.norm() / smallest_radius(a_.outline(), b_.outline());
  const double none = std::max(kParallel * pull.norm(), turned);
  // who runs along a line goes over it if it is pulled there
  const auto goes_back = [&](const Vec2& u) {
    const double rate = u.dot(path.rate);
    return rate < -noise || (rate <= noise && u.dot(pull) < -none);
  };
  const Passing how{way, path.rate, pull.norm(), passing_depth(half, f.sample, path.q)};
  if (site_ends) return is_parted_from_wire(of_sample, *of_site, how, goes_back);
  const auto site_goes_back = [&](const Vec2& u) { return goes_back(-u); };
  if (ends)
    return is_parted_from_wire(*of_site, of_sample, {-way, -path.rate, how.bend, how.depth}, site_goes_back);
  return is_parted(of_sample, *of_site, way, how.depth, goes_back) || is_passed(of_sample, *of_site, how);
}

bool PairView::pokes_through(const Half& half, int i, const Site& site, const Nearest& nearest,
                             const Feature& f) const {
  const Sample& sample = half.sample(i);
  if (sample.before < 0 || site.kind != SiteKind::segment || !site.solid || nearest.foot != Foot::interior ||
      site.radius + sample.radius > 0.0 || !(f.gap > 0.0))
    return false;
  const Vec2 along = site.b - site.a;
  const double length = along.norm();
  // The corner is `gap` before the face. An edge that comes nearer by more than that on its way to its
  // other end crosses the face's line, when it has gone the part gap / falls of this way.
  const auto crossed_by = [&](const Site& edge, const Vec2& other_end) {
    if (edge.kind != SiteKind::segment) return false;
    const Vec2 way = placed(half.t).frame.direction_to_local(
        placed(half.s).frame.direction_to_world(other_end - sample.p));
    const double falls = -f.normal.dot(way);
    if (!(falls > f.gap && falls > kParallel * way.norm())) return false;
    const double at = along.dot(nearest.point + (f.gap / falls) * way - site.a) / length;
    // An end of the face no deeper behind the edge than the contact tolerance is touched by the edge, which leads
    // past it.
    const double sine = falls / way.norm();
    return std::min(at, length - at) * sine > limits_.tolerance;
  };
  const std::vector<Site>& own = half.samples_of().sites;
  return crossed_by(own[sample.before], own[sample.before].a) ||
         crossed_by(own[sample.after], own[sample.after].b);
}

bool PairView::belongs_to_a_neighbour(const Half& half, int i, int j, const Nearest& nearest,
                                      const Vec2& q) const {
  const Outline& outline = half.sites_of();
  const Site& site = outline.sites[j];
  if (site.kind == SiteKind::point) return false;
  if (scratch_.flush_on >= 0) return scratch_.flush_on != j;
  const double distance = nearest.distance - site.radius;
  const bool at_end = nearest.foot != Foot::interior, behind = side_of(site, nearest, q) < 0.0;
  if (!at_end && !behind) return false;
  const Vec2 normal = normal_at(site, nearest, q);
  // a sliver's near side is nearer than its far side; in a notch the side in front is further than the other
  const double sliver = 4.0 * gap_rounding(half, i, q);
  for (const SearchScratch::Neighbour& other : scratch_.neighbours) {
    if (other.site == j) continue;
    const Site& other_site = outline.sites[other.site];
    const Nearest n = nearest_on(other_site, q);
    const double further = n.distance - other_site.radius - distance;
    if (further > limits_.touch) continue;
    if (at_end && n.foot == Foot::interior) return true;
    if (!behind || further > sliver) continue;
    const bool in_front = side_of(other_site, n, q) > 0.0;
    if (further < -sliver && !in_front) return true;  // it is less deep behind that
    if (other.normal.dot(normal) < 0.0 && (further < 0.0 || in_front)) return true;
  }
  return false;
}

/// In doubles where they are fine enough beside the contact tolerance, else from b's place in extended
/// precision. Which of the two depends on the motions and the time alone, so every search changes over at
/// the same moment.
void PairView::put(Placing& p, double t) const {
  p.time = t;
  p.tick = ulp(t);
  const BodyState sa = a_.motion->state(t), sb = b_.motion->state(t);
  p.place_noise = of_a_.place(t, sa.pose.position) + of_b_.place(t, sb.pose.position);
  p.angle_noise_a = of_a_.angle(t, sa.pose.angle);
  p.angle_noise_b = of_b_.angle(t, sb.pose.angle);
  // As a gap shows it: a rounding of an angle moves a point by that times its arm.
  const double noise = p.place_noise + p.angle_noise_a * a_.outline().bounding_radius +
                       p.angle_noise_b * b_.outline().bounding_radius;
  if (noise > kFarOfTolerance * limits_.tolerance) return put_relative(p, t);
  p.in_double = 0.0;
  p.base.setZero();
  Placed::move_both(p.a, a_.outline(), sa, p.b, b_.outline(), sb);
  p.note_turning();
}

void PairView::Placing::note_turning() {
  // An angle of 0 has an exact sine and cosine, and turning by them rounds nothing. Else four roundings
  // hold those of the sine and cosine, of their products with a coordinate, and of the sum.
  const auto turned = [](const Placed& placed) { return placed.angle == 0.0 ? 0.0 : 4.0 * kRoundoff; };
  turn_noise_a = angle_noise_a + turned(a);
  turn_noise_b = angle_noise_b + turned(b);
}

namespace {

/// What rounding is left of a motion seen in extended precision: as much less as Real is finer than double,
/// where there is more than a double's worth to see.
double finer(const Motion& m) { return m.is_ballistic() ? kRealRoundoff / kRoundoff : 1.0; }

}  // namespace

/// @pre put() has set the time and the roundings of angles in double, which are made finer here.
void PairView::put_relative(Placing& p, double t) const {
  const ExtendedState sa = a_.motion->extended_state(t), sb = b_.motion->extended_state(t);
  p.base = sb.position.cast<double>();
  // the most that a pair seen in doubles may be rounded by, as this one may be a moment later
  p.in_double = kFarOfTolerance * limits_.tolerance;
  p.a.move(a_.outline(), sa.seen_from(p.base));
  p.b.move(b_.outline(), sb.seen_from(p.base));
  p.place_noise = of_a_.place(t, sa.position.cast<double>()) * finer(*a_.motion) +
                  of_b_.place(t, p.base) * finer(*b_.motion);
  p.angle_noise_a *= finer(*a_.motion);
  p.angle_noise_b *= finer(*b_.motion);
  p.note_turning();
}

/// Of tolerances.h, for this placing: thin are a bare point and a wire, or another point, without thickness.
double PairView::nominal_level(const Placing& p, const Half& half, int i, const Site& site,
                               const Vec2& q) const {
  const bool thin = !site.solid && site.radius + half.sample(i).radius == 0.0;
  const double rounding = p.gap_rounding(half, i, q);
  return brink::nominal_level(limits_.touch, limits_.tolerance,
                              thin ? std::max(rounding, p.in_double) : rounding, thin);
}

PairView::Doubt PairView::doubt(const Half& half, const Feature& f) const {
  const SamplePath now = path(half, f.sample);
  const double rounding = gap_rounding(half, f.sample, now.q);
  const double nominal = nominal_level(now_, half, f.sample, half.site(f.site), now.q);
  if (!can_hold(rounding, limits_.tolerance, nominal, sink_ < 0.0)) return Doubt::place;
  return is_too_fast(now) ? Doubt::speed : Doubt::none;
}

bool PairView::beyond_doubt() const {
  constexpr double by_far = 1e-2;
  const Outline &a = a_.outline(), &b = b_.outline();
  if (a.container || b.container) return false;
  // Longer than any arm, and than the distance of any place of contact from either origin.
  const double reach = 2.0 * (a.bounding_radius + b.bounding_radius);
  const double noise =
      now_.place_noise + (now_.angle_noise_a + now_.angle_noise_b + 16.0 * kRoundoff) * reach;
  const double speed = (now_.a.twist.velocity - now_.b.twist.velocity).norm() +
                       (std::abs(now_.a.twist.omega) + std::abs(now_.b.twist.omega)) * reach;
  // 16: the most that can_hold() asks for, of a pressed pair; of a wire, whose level is 8 roundings, it
  // asks for twice that level.
  return 16.0 * noise <= by_far * limits_.tolerance &&
         speed * same_instant(now_.time) <= by_far * kSlowOfSize * smallest_radius(a, b);
}

/// Discs are compared in S's frame, where samples stand still: there one place of T's origin serves for all.
PairView::Reach::Reach(const PairView& view, const Half& half, double reach)
    : half_(half),
      s_(view.placed(half.s).frame),
      t_(view.placed(half.t).frame),
      reach_(half.sites_of().container ? kForever : reach),
      far_(reach_ + half.sites_of().bounding_radius),
      origin_(s_.direction_to_local(t_.origin - s_.origin)) {}

bool PairView::Reach::leaves_out(int i) const {
  if (!(reach_ < kForever)) return false;
  const Outline& outline = half_.sites_of();
  const Sample& sample = half_.sample(i);
  const double far = far_ + sample.radius;
  if ((sample.p - origin_).squaredNorm() > far * far) return true;  // most are far
  if (outline.facets.empty()) return false;
  // The disc is wide beside what is slender. A convex outline is told more closely by the line between
  // it and the sample.
  const Vec2 q = t_.direction_to_local(s_.direction_to_world(sample.p) + (s_.origin - t_.origin));
  return facing_convex(outline, q, Vec2::Zero()).gap - outline.sites[0].radius - sample.radius > reach_;
}

bool PairView::hidden_behind_others(const Half& half, const Feature& f, const SamplePath& path) {
  if (half.sample(f.sample).arc_site >= 0) return false;
  std::vector<std::uint32_t> all(half.sites_of().sites.size());
  std::iota(all.begin(), all.end(), 0U);
  find_neighbours(half, f.sample, all, path, 4.0 * limits_.tolerance);
  return belongs_to_a_neighbour(half, f.sample, f.site, nearest_on(half.site(f.site), path.q), path.q);
}

/// True if no features can have been within the tolerance when the motions began, by their bounding discs.
bool PairView::discs_were_apart() const {
  const Outline &a = a_.outline(), &b = b_.outline();
  if (a.container || b.container) return false;
  const Vec2 at_a = a_.motion->place(start()), at_b = b_.motion->place(start());
  const double rounding = of_a_.place(start(), at_a) + of_b_.place(start(), at_b);
  const double reach = (a.bounding_radius + b.bounding_radius) * (1.0 + 1e-9);
  return (at_a - at_b).norm() > reach + 2.0 * limits_.tolerance + 2.0 * rounding;
}

double PairView::sink_at_start() const {
  if (discs_were_apart()) return 0.0;
  // The copy has the scratch in common: neighbours that were found before are lost.
  PairView then = *this;
  if (then.now_.time != start()) then.place(start());
  std::optional<RelativeBounds> at_once;  // most pairs have nothing near: theirs are not asked for
  // What start_sink() is given of one feature. One that has room to fall, or is deeper than any overlap that a start may
  // have and so is not the start of this pair, gives nothing.
  struct Start {
    double gap = kForever, rate = kForever, noise = 0.0, bend = 0.0, step = 0.0;
    bool at_once = false;  ///< it collides at once
    double sink() const { return start_sink(gap, rate, noise, bend, step); }
  };
  const auto start_of = [&](const Half& half, const Feature& f) -> std::optional<Start> {
    const SamplePath path = then.path(half, f.sample);
    const Site& site = half.site(f.site);
    const double rounding = then.gap_rounding(half, f.sample, path.q);
    Start s;
    s.step = sink_step(limits_.touch, rounding);
    s.gap = f.gap - then.nominal_level(then.now_, half, f.sample, site, path.q);
    if (!(s.gap < s.step) || s.gap < -kOverlapAtStart * limits_.tolerance) return std::nullopt;
    const bool approaching = then.approaching(f, path);
    // Two corners that pass each other do not meet, however fast the gap of one of their sides falls; but they touch, and
    // what comes along after them is pressed on.
    const bool passes = approaching && then.passes_tip(half, f);
    s.at_once = s.gap <= 0.0 && approaching && !passes && !then.hidden_behind_others(half, f, path);
    if (!at_once)
      at_once = RelativeBounds::over(a_.outline(), *a_.motion, b_.outline(), *b_.motion, start(), start());
    const PathBounds bounds = path_bounds(path, half.s_is_a ? *at_once : at_once->swapped(), 0.0);
    const bool of_arc = site.kind == SiteKind::arc;
    // seen from within an arc the gap bends by v^2 / rho besides (site_step.h); outside that is too much,
    // never too little
    const double hollow = of_arc ? bounds.speed * bounds.speed / (path.q - site.center).norm() : 0.0;
    s.rate = passes ? 0.0 : f.rate;
    s.noise = then.rate_noise(path);
    s.bend = bounds.acceleration + hollow;
    return s;
  };
  // One sink for the pair, whichever of its features is met: start_sink() is given the least favourable of
  // each number.
  Start least;
  double of_others = 0.0;
  then.each_feature(limits_.tolerance, [&](const Half& half, const Feature& f) {
    const std::optional<Start> s = start_of(half, f);
    if (!s) return;
    least.at_once = least.at_once || s->at_once;
    least.gap = std::min(least.gap, s->gap);
    least.rate = std::min(least.rate, s->rate);
    least.noise = std::max(least.noise, s->noise);
    least.bend = std::max(least.bend, s->bend);
    least.step = std::max(least.step, s->step);
    // a sample in a groove, or between two tips, touches other sites than the nearest, elsewhere, and may leave those slower
    then.each_other_place(half, f, limits_.tolerance, [&](const Feature& other) {
      const std::optional<Start> o = start_of(half, other);
      if (!o) return;
      least.at_once = least.at_once || o->at_once;
      of_others = std::min(of_others, o->sink());
    });
  });
  // A pair that collides at once has no need to sink until it does.
  if (least.at_once || !(least.gap < kForever)) return 0.0;
  return std::min(least.sink(), of_others);
}

double PairView::side_kept(const Site& site, const SearchScratch::Neighbour& as_found, const Nearest& now,
                           const Vec2& q, double rounding, bool at_once) const {
  const bool segment = site.kind == SiteKind::segment, abreast = now.foot == Foot::interior;
  // Found abreast of the wire, as_found.normal points to the side on which the sample was then. Found at
  // an end of a segment, it was on neither side yet.
  if (abreast && !(as_found.at_end && segment)) return as_found.normal.dot(q - now.point) < 0.0 ? -1.0 : 1.0;
  // it comes round an end, unless its way leads through; of what is not abreast only straight ways are known
  return segment && (abreast || at_once) && way_leads_through(site, q, rounding) ? -1.0 : 1.0;
}

bool PairView::way_leads_through(const Site& site, const Vec2& q, double rounding) const {
  const Vec2 d = site.b - site.a, from = scratch_.looked_from;
  const double before = cross(d, from - site.a), after = cross(d, q - site.a);
  if ((before < 0.0) == (after < 0.0)) return false;
  const double along = d.dot(from + (before / (before - after)) * (q - from) - site.a);
  // where two sites join, it leads through one of them
  const double slack = rounding * d.norm();
  return along >= -slack && along <= d.squaredNorm() + slack;
}

bool PairView::is_left(const Placing& p, const Half& half, int i, const SearchScratch::Neighbour& neighbour,
                       const Nearest& nearest) const {
  const SamplePath path = sample_path(p.of(half.s_is_a), p.of(!half.s_is_a), half.sample(i).p);
  Feature f = vertex_feature(p, half, i, neighbour.site, nearest, path);
  // what has crossed a wire goes on against the normal of the side from which it came
  if (!half.site(neighbour.site).solid && f.normal.dot(neighbour.normal) < 0.0) f.rate = -f.rate;
  return !approaching(f, path);
}

/// To the side on which a corner lies flush, if it does; else to the nearest site but those that it touches and does
/// not approach: they are the nearest for a while yet, and would hide one that is approached (a disc that goes from
/// wall to wall of a corner). Infinite, with no site, if there is none.
PairView::GapAndSite PairView::gap_to_neighbours(const Placing& p, const Half& half, const Feature& f,
                                                 const Vec2& q) const {
  const int i = f.sample;
  const double sample_radius = half.sample(i).radius;
  // within so few ticks of the clock every way is straight
  const bool at_once = std::abs(p.time - now_.time) <= 64.0 * ulp(p.time);
  const double rounding = p.gap_rounding(half, i, q);
  GapAndSite found;
  for (const SearchScratch::Neighbour& neighbour : scratch_.neighbours) {
    // by where the sample is then, wherever it was when its neighbours were looked for
    const Site& site = half.site(neighbour.site);
    if (!is_flush_on(p, half, i, site, q, rounding)) continue;
    const bool at_a = (q - site.a).squaredNorm() < (q - site.b).squaredNorm();
    const double gap = face_for(p, half, i, site, at_a, q).dot(q - (at_a ? site.a : site.b));
    return {gap - level_of(nominal_level(p, half, i, site, q), sink_), neighbour.site};
  }
  double least = kForever;
  // the nearest so far: how far off, where on it, and whether it is in front
  double off_nearest = kForever;
  Vec2 face_nearest = Vec2::Zero();
  bool behind_nearest = false;
  for (const SearchScratch::Neighbour& neighbour : scratch_.neighbours) {
    const Site& site = half.site(neighbour.site);
    const Nearest n = nearest_on(site, q);
    const bool interior = n.foot == Foot::interior && site.kind != SiteKind::point;
    // an interior foot comes before an end that is as near
    const double off = n.distance - site.radius, rank = off - (interior ? limits_.touch : 0.0);
    if (rank >= least && !(off <= off_nearest + 4.0 * rounding)) continue;
    const double radius = site.radius + sample_radius;
    const bool wire = radius == 0.0 && !site.solid && site.kind != SiteKind::point;
    // A wire has no inside, so its distance has no sign of its own: measured from the side that the
    // sample was on, its gap falls through 0 where it crosses, and the bisection has something to find.
    double side = wire ? side_kept(site, neighbour, n, q, rounding, at_once) : side_of(site, n, q);
    if (side < 0.0 && !wire && is_beyond_tip(site, n)) side = 1.0;
    const bool behind = !wire && side < 0.0;
    // as near, to rounding, are the two sides of a sliver thinner than that: of these the one in front counts
    const Vec2 face = face_of(site, n, q);
    const bool sliver = behind != behind_nearest && std::abs(off - off_nearest) <= 4.0 * rounding &&
                        face.dot(face_nearest) < kOpposite;
    if (sliver ? behind : rank >= least) continue;
    const double gap = side * n.distance - radius - level_of(nominal_level(p, half, i, site, q), sink_);
    // asked of the moment itself, not of when the neighbours were found: what is left then may be pressed on later;
    // what the search follows is approached
    if (neighbour.site != f.site && gap <= limits_.touch && is_left(p, half, i, neighbour, n)) continue;
    least = rank;
    off_nearest = off;
    face_nearest = face;
    behind_nearest = behind;
    found = {gap, neighbour.site};
  }
  return found;
}

/// Of the whole circle about c, the sample's centre in T's frame: neither sector is asked. Of two arcs the
/// normal of f says which way they touch: outside against outside, or inside the hollow.
double PairView::arc_gap(const Half& half, const Feature& f, const Vec2& c) const {
  const Site& arc = half.samples_of().sites[half.sample(f.sample).arc_site];
  const Site& site = half.site(f.site);
  const double reach = arc.arc_radius + arc.radius + site.radius;
  if (site.kind == SiteKind::segment) {
    // On the side that f has, not on the nearer one: past the surface the gap has to go on falling.
    const Vec2 d = site.b - site.a;
    const double offset = cross(d, c - site.a) / d.norm();
    return (perp(d).dot(f.normal) > 0.0 ? offset : -offset) - reach;
  }
  const double distance = (c - site.center).norm();
  const bool hollow = f.normal.dot(c - site.center) < 0.0;
  return hollow ? site.arc_radius - distance - reach : distance - site.arc_radius - reach;
}

PairView::GapAndSite PairView::gap_at(const Half& half, const Feature& f, double t) const {
  // A copy of the present one: the sine and cosine of an angle that has not changed are kept
  // (Placed::move()).
  Placing then = now_;
  put(then, t);
  return gap_when(then, half, f);
}

PairView::GapAndSite PairView::gap_when(const Placing& then, const Half& half, const Feature& f) const {
  const Placed &s = half.s_is_a ? then.a : then.b, &u = half.s_is_a ? then.b : then.a;
  const Vec2 q = u.frame.direction_to_local(s.frame.direction_to_world(half.sample(f.sample).p) +
                                            (s.frame.origin - u.frame.origin));
  if (half.sample(f.sample).arc_site < 0) return gap_to_neighbours(then, half, f, q);
  const double nominal = nominal_level(then, half, f.sample, half.site(f.site), q);
  return {arc_gap(half, f, q) - level_of(nominal, sink_), f.site};
}

}  // namespace brink::detail
