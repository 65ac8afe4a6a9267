#include "brink/core/fields/site_batch.h"

#include <algorithm>
#include <cmath>

#include "brink/core/shapes/distance.h"

namespace brink::detail {

namespace {

/// A site in pixels of the window, double precision, cut to what the window can see.
struct PixelSite {
  SiteKind kind;
  bool solid;
  Vec2 a, b, center;
  Vec2 pseudo_a, pseudo_b;
  double arc_radius, sweep, radius;
  double error = 0.0;
};

class BatchMaker {
 public:
  BatchMaker(const PixelGrid& grid, const BatchRules& rules)
      : grid_(grid), rules_(rules), center_(grid.center()), half_(0.5 * Vec2(grid.width, grid.height)) {}

  void add(const Site& site, const Frame& frame, std::uint32_t id, SiteBatch& batch) const {
    PixelSite s = to_pixels(site, frame);
    if (s.kind == SiteKind::segment) cut_segment(s);
    if (s.kind == SiteKind::arc) cut_arc(s);
    bound_error(s, batch.offset, frame.origin);
    SiteInstance instance;
    if (!place_quad(s, instance)) return;
    fill(s, id, batch.offset, instance);
    batch.instances.push_back(instance);
    batch.largest_error = std::max(batch.largest_error, s.error);
    batch.largest_value = std::max(batch.largest_value, s.error / kRounding);
  }

 private:
  PixelSite to_pixels(const Site& site, const Frame& frame) const {
    const auto point = [&](const Vec2& p) { return Vec2((frame.to_world(p) - center_) / grid_.pixel); };
    PixelSite s;
    s.kind = site.kind;
    s.solid = site.solid;
    s.a = point(site.a);
    s.b = site.kind == SiteKind::point ? s.a : point(site.b);
    s.center = site.kind == SiteKind::arc ? point(site.center) : s.a;
    s.pseudo_a = frame.direction_to_world(site.pseudo_a);
    s.pseudo_b = frame.direction_to_world(site.pseudo_b);
    s.arc_radius = site.kind == SiteKind::arc ? site.arc_radius / grid_.pixel : 0.0;
    s.sweep = site.sweep;
    s.radius = site.radius / grid_.pixel;
    return s;
  }

  std::array<Vec2, 4> corners() const {
    return {Vec2(-half_.x(), -half_.y()), Vec2(half_.x(), -half_.y()), Vec2(-half_.x(), half_.y()), half_};
  }

  /// Keeps the part of a segment on which feet of points of the window lie (the foot's parameter is linear in
  /// the point, so its extremes are at corners); a segment beyond whose end the whole window lies becomes
  /// that end.
  void cut_segment(PixelSite& s) const {
    const Vec2 d = s.b - s.a;
    const double length2 = d.squaredNorm();
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec2& corner : corners()) {
      const double t = (corner - s.a).dot(d) / length2;
      low = std::min(low, t);
      high = std::max(high, t);
    }
    if (!(high > 0.0)) return make_point(s, s.a, s.pseudo_a);
    if (!(low < 1.0)) return make_point(s, s.b, s.pseudo_b);
    const Vec2 a = s.a, outward = -perp(d).normalized();
    if (low > 0.0) {
      s.a = a + low * d;
      s.pseudo_a = outward;
    }
    if (high < 1.0) {
      s.b = a + high * d;
      s.pseudo_b = outward;
    }
    if ((s.b - s.a).squaredNorm() < 1e-12) make_point(s, s.a, s.pseudo_a);
  }

  static void make_point(PixelSite& s, const Vec2& p, const Vec2& pseudo) {
    s.kind = SiteKind::point;
    s.a = s.b = s.center = p;
    s.pseudo_a = s.pseudo_b = pseudo;
  }

  /// Keeps the part of an arc that the window sees from the arc's centre, where that is less than a quarter
  /// turn (then the nearer end of what is kept is the nearer end of the arc wherever both are seen).
  void cut_arc(PixelSite& s) const {
    const double turn = s.sweep > 0 ? 1.0 : -1.0;
    const Vec2 from = s.a - s.center;
    const Vec2 view = -s.center;  // towards the window's centre
    double low = 0.0, high = 0.0;
    for (const Vec2& corner : corners()) {
      const Vec2 w = corner - s.center;
      const double angle = turn * std::atan2(cross(view, w), view.dot(w));
      low = std::min(low, angle);
      high = std::max(high, angle);
    }
    if (!(high - low < 1.5) || !(view.norm() > grid_.half_diagonal())) return;
    const double start = turn * std::atan2(cross(view, from), view.dot(from)),
                 end = start + std::abs(s.sweep);
    const double first = std::max(start, low), last = std::min(end, high);
    if (!(last - first > 1e-9)) return;
    const auto at = [&](double angle) {
      const Vec2 unit = view.normalized();
      return Vec2(s.center + s.arc_radius * (std::cos(angle) * unit + std::sin(angle) * turn * perp(unit)));
    };
    if (first > start) {
      s.a = at(first);
      s.pseudo_a = turn * (s.a - s.center).normalized();
    }
    if (last < end) {
      s.b = at(last);
      s.pseudo_b = turn * (s.b - s.center).normalized();
    }
    s.sweep = turn * (last - first);
  }

  /// The rounding allowance, and the chord in place of a very flat arc.
  void bound_error(PixelSite& s, double offset, const Vec2& origin) const {
    const double ends = grid_.half_diagonal() + s.a.norm() + s.b.norm() + s.radius + offset;
    const double placing = 0x1.0p-48 * (origin.norm() + center_.norm()) / grid_.pixel;
    if (s.kind == SiteKind::arc) {
      const double sagitta = s.arc_radius * (1.0 - std::cos(0.5 * s.sweep));
      const double chord = kRounding * ends + sagitta * 1.001;
      s.error = kRounding * (ends + s.center.norm() + s.arc_radius);
      if (chord < s.error) {
        s.kind = SiteKind::segment;
        s.error = chord;
      }
    } else {
      s.error = kRounding * ends;
    }
    s.error += placing;
  }

  /// The tight oriented quad of the site's band. Returns false if it lies beside the window.
  bool place_quad(const PixelSite& s, SiteInstance& instance) const {
    const double grow = rules_.band / grid_.pixel + s.radius + rules_.margin + 2.0 * s.error + 1.5;
    const Vec2 chord = s.b - s.a, middle = 0.5 * (s.a + s.b);
    const double length = chord.norm();
    const Vec2 axis = length > 0.0 ? Vec2(chord / length) : Vec2(1.0, 0.0);
    double below = grow, above = grow;
    if (s.kind == SiteKind::arc) {
      (s.sweep > 0 ? below : above) += s.arc_radius * (1.0 - std::cos(0.5 * s.sweep));
    }
    const double along = 0.5 * length + grow;
    const double reach = std::hypot(along, std::max(below, above));
    if (!(reach < 4.0 * grid_.half_diagonal())) {
      instance.frame = {0.0F, 0.0F, 1.0F, 0.0F};
      instance.extent = {-f(half_.x() + 1), f(half_.x() + 1), -f(half_.y() + 1), f(half_.y() + 1)};
      return true;
    }
    Box quad;
    for (const double x : {-along, along}) {
      for (const double y : {-below, above}) quad.add(middle + x * axis + y * perp(axis));
    }
    Box window;
    window.add(Vec2(-half_));
    window.add(half_);
    if (!quad.overlaps(window)) return false;
    instance.frame = {f(middle.x()), f(middle.y()), f(axis.x()), f(axis.y())};
    instance.extent = {-f(along), f(along), -f(below), f(above)};
    return true;
  }

  void fill(const PixelSite& s, std::uint32_t id, double offset, SiteInstance& instance) const {
    instance.ends = {f(s.a.x()), f(s.a.y()), f(s.b.x()), f(s.b.y())};
    if (s.kind == SiteKind::arc) {
      instance.arc = {f(s.center.x()), f(s.center.y()), f(s.arc_radius), s.sweep > 0 ? 1.0F : -1.0F};
    } else if (s.kind == SiteKind::segment) {
      instance.arc[0] = f(1.0 / (s.b - s.a).squaredNorm());
    }
    instance.pseudo = {f(s.pseudo_a.x()), f(s.pseudo_a.y()), f(s.pseudo_b.x()), f(s.pseudo_b.y())};
    const double plain = offset - s.radius;
    instance.shift = {f(plain + (rules_.bounds ? s.error : 0.0)), f(plain - (rules_.bounds ? s.error : 0.0))};
    instance.id = id;
    instance.kind = static_cast<std::uint32_t>(s.kind) + (s.solid ? 4U : 0U);
  }

  static float f(double x) { return static_cast<float>(x); }

  PixelGrid grid_;
  BatchRules rules_;
  Vec2 center_, half_;
};

/// A distance [pixel] that nothing drawn in the window exceeds.
double farthest(const PixelGrid& grid, std::span<const PlacedOutline> scene) {
  double most = 0.0;
  for (const PlacedOutline& item : scene) {
    const double away = (item.pose.position - grid.center()).norm() + item.outline->bounding_radius;
    most = std::max(most, away / grid.pixel);
  }
  return most + grid.half_diagonal();
}

}  // namespace

SiteBatch make_batch(const PixelGrid& grid, std::span<const PlacedOutline> scene, std::uint32_t excluded,
                     const BatchRules& rules) {
  SiteBatch batch;
  // Offset and depth scale come from the whole scene, excluded owner and all, so that a site is drawn with
  // the same bits whoever is left out.
  std::size_t count = 0;
  for (const PlacedOutline& item : scene) {
    count += item.outline->sites.size();
    for (const Site& site : item.outline->sites) {
      batch.offset = std::max(batch.offset, site.radius / grid.pixel);
      batch.has_arcs = batch.has_arcs || site.kind == SiteKind::arc;
    }
  }
  batch.offset = std::ceil(batch.offset * 1.001);
  batch.depth_scale = std::exp2(-std::ceil(std::log2(4.0 * (farthest(grid, scene) + batch.offset) + 16.0)));
  batch.instances.reserve(count);
  const BatchMaker maker(grid, rules);
  std::uint32_t id = 0;
  for (const PlacedOutline& item : scene) {
    const Frame frame(item.pose);
    for (const Site& site : item.outline->sites) {
      if (item.drawn && item.owner != excluded) maker.add(site, frame, id, batch);
      ++id;
    }
  }
  return batch;
}

}  // namespace brink::detail
