#include "brink/core/fields/site_batch.h"

#include <algorithm>
#include <cmath>

#include "brink/core/fields/pixel_site.h"

namespace brink::detail {

namespace {

/// Makes the instances of one window. For each site in turn: it is cut to the window in double precision; its
/// rounding is bounded; its quad is placed, wider by that bound; all is written in single precision.
class BatchMaker {
 public:
  BatchMaker(const PixelGrid& grid, const BatchRules& rules)
      : grid_(grid), rules_(rules), center_(grid.center()), half_(0.5 * Vec2(grid.width, grid.height)) {}

  void add(const Site& site, const Frame& frame, std::uint32_t id, SiteBatch& batch) const {
    PixelSite s = pixel_site(site, frame, grid_);
    bound_error(s, batch.offset, frame.origin);
    SiteInstance instance;
    if (!place_quad(s, instance)) return;
    fill(s, id, batch.offset, instance);
    batch.instances.push_back(instance);
    batch.largest_error = std::max(batch.largest_error, s.error);
    // error >= kRounding S, and a value within the window is no larger than S
    batch.largest_value = std::max(batch.largest_value, s.error / kRounding);
  }

 private:
  /// The rounding allowance, and the chord in place of a very flat arc.
  void bound_error(PixelSite& s, double offset, const Vec2& origin) const {
    // S of site_batch.h, and the offset, which the shader adds too
    const double ends = grid_.half_diagonal() + s.a.norm() + s.b.norm() + s.radius + offset;
    // Places are rounded in metres before anything is measured in pixels from the window's centre: far
    // from the origin that may be more than all the rest.
    const double placing = 0x1.0p-48 * (origin.norm() + center_.norm()) / grid_.pixel;
    if (s.kind == SiteKind::arc) {
      const double sagitta = s.arc_radius * (1.0 - std::cos(0.5 * s.sweep));
      // A flat arc's centre and radius are large numbers whose roundings would count; its
      // chord is off by the sagitta.
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
    // Distances and the quad's corners are rounded (2 error), and the rasteriser rounds corners once
    // more (1.5): every pixel centre within band and margin is to be covered.
    const double grow = rules_.band / grid_.pixel + s.radius + rules_.margin + 2.0 * s.error + 1.5;
    const Vec2 chord = s.b - s.a, middle = 0.5 * (s.a + s.b);
    const double length = chord.norm();
    const Vec2 axis = length > 0.0 ? Vec2(chord / length) : Vec2(1.0, 0.0);
    double below = grow, above = grow;
    if (s.kind == SiteKind::arc) {
      // The chord is the quad's axis. An arc that turns to the left bulges to the right of its chord.
      (s.sweep > 0 ? below : above) += s.arc_radius * (1.0 - std::cos(0.5 * s.sweep));
    }
    // an arc of at most a half turn does not reach beyond its chord's ends along the chord
    const double along = 0.5 * length + grow;
    const double reach = std::hypot(along, std::max(below, above));
    // Much larger than the window, or infinite: cut to the window, as single precision would place it badly.
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
    // by its box: an oriented quad beside a corner may be kept, and draws nothing
    if (!quad.overlaps(window)) return false;
    instance.frame = {f(middle.x()), f(middle.y()), f(axis.x()), f(axis.y())};
    instance.extent = {-f(along), f(along), -f(below), f(above)};
    return true;
  }

  /// What the shader needs of the site. @pre its error and kind are final.
  void fill(const PixelSite& s, std::uint32_t id, double offset, SiteInstance& instance) const {
    instance.ends = {f(s.a.x()), f(s.a.y()), f(s.b.x()), f(s.b.y())};
    if (s.kind == SiteKind::arc) {
      instance.arc = {f(s.center.x()), f(s.center.y()), f(s.arc_radius), s.sweep > 0 ? 1.0F : -1.0F};
    } else if (s.kind == SiteKind::segment) {
      // a point keeps 0 there, which makes its foot's parameter 0
      instance.arc[0] = f(1.0 / (s.b - s.a).squaredNorm());
    }
    instance.pseudo = {f(s.pseudo_a.x()), f(s.pseudo_a.y()), f(s.pseudo_b.x()), f(s.pseudo_b.y())};
    const double plain = offset - s.radius;
    // upper and lower bound; both the plain value where no bounds are wanted
    instance.shift = {f(plain + (rules_.bounds ? s.error : 0.0)), f(plain - (rules_.bounds ? s.error : 0.0))};
    instance.id = id;
    instance.kind = static_cast<std::uint32_t>(s.kind) + (s.solid ? 4U : 0U);
  }

  // the one place where an instance's numbers are rounded to single precision
  static float f(double x) { return static_cast<float>(x); }

  PixelGrid grid_;
  BatchRules rules_;
  Vec2 center_, half_;
};

/// A distance [pixel] that nothing drawn in the window exceeds.
/// By the triangle inequality: from a pixel to the window's centre, to the outline's origin, to its farthest site.
double farthest(const PixelGrid& grid, std::span<const PlacedOutline> scene) {
  double most = 0.0;
  for (const PlacedOutline& item : scene) {
    const double away = (item.pose.position - grid.center()).norm() + item.outline->bounding_radius;
    most = std::max(most, away / grid.pixel);
  }
  return most + grid.half_diagonal();
}

}  // namespace

SiteBatch empty_batch(const PixelGrid& grid, std::span<const PlacedOutline> scene) {
  SiteBatch batch;
  for (const PlacedOutline& item : scene)
    for (const Site& site : item.outline->sites) {
      batch.offset = std::max(batch.offset, site.radius / grid.pixel);
      batch.has_arcs = batch.has_arcs || site.kind == SiteKind::arc;
    }
  // At least the largest radius, so that no drawn value is negative.
  batch.offset = std::ceil(batch.offset * 1.001);
  // A power of two below 1 / (4 times anything drawn): depths keep the bits of values, and stay well
  // below 1, where the depth buffer was cleared to.
  batch.depth_scale = std::exp2(-std::ceil(std::log2(4.0 * (farthest(grid, scene) + batch.offset) + 16.0)));
  return batch;
}

SiteBatch make_batch(const PixelGrid& grid, std::span<const PlacedOutline> scene, std::uint32_t excluded,
                     const BatchRules& rules) {
  // before the first site: its instance is shifted by the offset
  SiteBatch batch = empty_batch(grid, scene);
  std::size_t count = 0;
  for (const PlacedOutline& item : scene) count += item.outline->sites.size();
  batch.instances.reserve(count);
  const BatchMaker maker(grid, rules);
  std::uint32_t id = 0;
  for (const PlacedOutline& item : scene) {
    const Frame frame(item.pose);
    for (const Site& site : item.outline->sites) {
      // ids count on over what is left out: a site has the same id whoever is excluded
      if (item.drawn && item.owner != excluded) maker.add(site, frame, id, batch);
      ++id;
    }
  }
  return batch;
}

}  // namespace brink::detail
