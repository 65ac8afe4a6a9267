#include "brink/scheduler/pair_view.h"

namespace brink::detail {

namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

bool sharp_vertex(const Site& site, const Sample& sample, const Nearest& nearest) {
  return (nearest.foot != Foot::interior || site.kind == SiteKind::point) &&
         site.radius + sample.radius == 0.0;
}

}  // namespace

PairView::PairView(const Mover& a, const Mover& b, const SearchLimits& limits, SearchScratch& scratch)
    : a_(a), b_(b), limits_(limits), scratch_(scratch) {
  // A core of one point needs no reverse test: its one sample against the other's sites is the whole
  // distance.
  const bool point_a = a.outline().is_point(), point_b = !point_a && b.outline().is_point();
  halves_[0] = {&a, &b, true, point_b ? 0 : static_cast<int>(a.outline().samples.size())};
  halves_[1] = {&b, &a, false, point_a ? 0 : static_cast<int>(b.outline().samples.size())};
}

Feature PairView::vertex_feature(const Half& half, int i, int j, const Nearest& nearest,
                                 const SamplePath& path) const {
  const Sample& sample = half.sample(i);
  const Site& site = half.site(j);
  Feature f{i, j, 0.0, 0.0, normal_at(site, nearest, path.q), nearest.point};
  const double side = side_of(site, nearest, path.q);
  f.gap = side * nearest.distance - site.radius - sample.radius;
  if (sharp_vertex(site, sample, nearest) && path.rate.squaredNorm() > 0.0 && f.gap > -limits_.touch &&
      nearest.distance <= limits_.tolerance && (path.q - nearest.point).dot(path.rate) < 0.0)
    f.normal = -path.rate.normalized();  // two points that meet: the limit of their direction
  f.rate = f.normal.dot(path.rate);
  f.point =
      path.q - f.normal * (f.gap + sample.radius);  // from the sample: a long site's foot has lost digits
  return f;
}

Feature PairView::nearest_feature(const Half& half, int i) const {
  const SamplePath now = path(half, i);
  const FieldAnswer nearest = half.t->index->query(now.q, scratch_.index);
  if (nearest.site < 0) return {};
  return vertex_feature(half, i, nearest.site, nearest_on(half.site(nearest.site), now.q), now);
}

ArcStep PairView::arc_now(const Half& half, int i, int j) const {
  const Site& arc = half.samples_of().sites[static_cast<std::size_t>(half.sample(i).arc_site)];
  return arc_step(arc, half.site(j), path(half, i), placed(half.s), placed(half.t), 0.0, limits_.tolerance,
                  {}, {0.0, 0.0});
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

FeatureContact PairView::contact_of(const Half& half, const Feature& f, double time) const {
  const Placed& site_owner = placed(half.t);
  FeatureContact c;
  c.time = time;
  c.sample_on_a = half.s_is_a;
  c.sample = f.sample;
  c.site = f.site;
  c.point = site_owner.frame.to_world(f.point);
  const Vec2 out = site_owner.frame.direction_to_world(f.normal);
  c.normal = half.s_is_a ? out : Vec2(-out);
  c.closing_speed = -f.rate;
  c.gap = f.gap;
  return c;
}

bool PairView::approaching(const Feature& f, const SamplePath& path) const {
  return f.rate < -(a_.velocity_rounding + b_.velocity_rounding + 16.0 * kEpsilon * path.magnitude);
}

void PairView::find_neighbours(const Half& half, int i, std::span<const std::uint32_t> sites,
                               const SamplePath& path, double reach) {
  const double radius = half.sample(i).radius;
  scratch_.neighbours.clear();
  for (const std::uint32_t k : sites) {
    const Site& site = half.sites_of().sites[k];
    const Nearest nearest = nearest_on(site, path.q);
    if (nearest.distance - site.radius - radius > reach) continue;
    const Feature f = vertex_feature(half, i, static_cast<int>(k), nearest, path);
    const bool leaving = f.gap <= limits_.touch && !approaching(f, path);
    scratch_.neighbours.push_back({f.site, f.normal, leaving});
  }
}

bool PairView::belongs_to_a_neighbour(const Half& half, int j, const Nearest& nearest, const Vec2& q) const {
  const Outline& outline = half.sites_of();
  const Site& site = outline.sites[j];
  if (site.kind == SiteKind::point) return false;
  const double distance = nearest.distance - site.radius;
  const bool at_end = nearest.foot != Foot::interior, behind = side_of(site, nearest, q) < 0.0;
  if (!at_end && !behind) return false;
  const Vec2 normal = normal_at(site, nearest, q);
  for (const SearchScratch::Neighbour& other : scratch_.neighbours) {
    if (other.site == j) continue;
    const Site& other_site = outline.sites[other.site];
    const Nearest n = nearest_on(other_site, q);
    const double further = n.distance - other_site.radius - distance;
    if (further > limits_.touch) continue;
    if (at_end && n.foot == Foot::interior) return true;
    if (behind && other.normal.dot(normal) < 0.0 && (further < 0.0 || side_of(other_site, n, q) > 0.0))
      return true;
  }
  return false;
}

double PairView::level_at(const Site& site, double sample_radius, const Nearest& nearest) const {
  const bool sharp = site.radius + sample_radius == 0.0 && (!site.solid || nearest.foot != Foot::interior);
  return sharp ? 0.5 * limits_.touch : 0.0;
}

Vec2 PairView::place_at(const Half& half, int i, double t) const {
  Placed s = placed(half.s), u = placed(half.t);
  s.move(half.s->outline(), half.s->motion->state(t));
  u.move(half.t->outline(), half.t->motion->state(t));
  return u.frame.direction_to_local(s.frame.direction_to_world(half.sample(i).p) +
                                    (s.frame.origin - u.frame.origin));
}

PairView::GapAndSite PairView::gap_to_neighbours(const Half& half, int i, const Vec2& q) const {
  const double sample_radius = half.sample(i).radius;
  GapAndSite found;
  double least = kForever;
  for (const SearchScratch::Neighbour& neighbour : scratch_.neighbours) {
    if (neighbour.leaving) continue;
    const Site& site = half.site(neighbour.site);
    const Nearest n = nearest_on(site, q);
    const bool interior = n.foot == Foot::interior && site.kind != SiteKind::point;
    // an interior foot comes before an end that is as near
    const double rank = n.distance - site.radius - (interior ? limits_.touch : 0.0);
    if (!(rank < least)) continue;
    least = rank;
    const double radius = site.radius + sample_radius;
    const bool thin = radius == 0.0 && !site.solid && interior;  // then stay on the side it came from
    const double side = !thin ? side_of(site, n, q) : neighbour.normal.dot(q - n.point) < 0.0 ? -1.0 : 1.0;
    found = {side * n.distance - radius - level_at(site, sample_radius, n), neighbour.site};
  }
  return found;
}

double PairView::arc_gap(const Half& half, const Feature& f, const Vec2& c) const {
  const Site& arc = half.samples_of().sites[half.sample(f.sample).arc_site];
  const Site& site = half.site(f.site);
  const double reach = arc.arc_radius + arc.radius + site.radius;
  if (site.kind == SiteKind::segment) {
    const Vec2 d = site.b - site.a;
    const double offset = cross(d, c - site.a) / d.norm();
    return (perp(d).dot(f.normal) > 0.0 ? offset : -offset) - reach;
  }
  const double distance = (c - site.center).norm();
  const bool hollow = f.normal.dot(c - site.center) < 0.0;
  return hollow ? site.arc_radius - distance - reach : distance - site.arc_radius - reach;
}

PairView::GapAndSite PairView::gap_at(const Half& half, const Feature& f, double t) const {
  const Vec2 q = place_at(half, f.sample, t);
  if (half.sample(f.sample).arc_site < 0) return gap_to_neighbours(half, f.sample, q);
  return {arc_gap(half, f, q), f.site};
}

double PairView::place_rounding(const Mover& m) const {
  double reach = placed(&m).frame.origin.lpNorm<1>();
  if (m.motion->is_ballistic()) reach += m.motion->start().pose.position.lpNorm<1>();
  return 32.0 * kEpsilon * (reach + m.outline().bounding_radius * (1.0 + 0.125 * std::abs(placed(&m).angle)));
}

double PairView::gap_rounding() const { return place_rounding(a_) + place_rounding(b_); }

}  // namespace brink::detail
