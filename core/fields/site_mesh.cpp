#include "brink/core/fields/site_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "brink/core/fields/pixel_site.h"

namespace brink::detail {

namespace {

constexpr double kPi = std::numbers::pi;
/// Widest half facet [rad]: cones of a few pixels keep a shape.
constexpr double kWidest = kPi / 8;
/// Beyond the band, so that every pixel centre within it is covered [pixel].
constexpr double kRim = 1.5;
/// By so much a sector of a cone reaches over the tents beside it, at its rim [pixel]: rasterisers round
/// corners to 1/256 of a pixel, and where edges only met, pixels between them would be left out.
constexpr double kOverlap = 1.0 / 32;
/// Bound on the rounding of interpolated values, as a share of all lengths that take part: corners are
/// rounded once, and the rasteriser's plane through three of them errs by a few roundings of its values over
/// the window. Measured on a million pixels: a fifth of this at most.
constexpr double kMeshRounding = 256.0 / (1 << 24);

/// Half the angle for which radius (1 - cos) is the error.
/// Where the radius is below the error any angle would do, and the widest is taken.
double half_angle(double radius, double error) {
  return std::min(kWidest, std::acos(std::max(0.0, 1.0 - error / radius)));
}

/// Appends the triangles of one site after the other. Values are interpolated: of a tent exactly, of a cone's
/// facet within the error.
class MeshMaker {
 public:
  MeshMaker(const PixelGrid& grid, double band, double error, SiteBatch& batch)
      : grid_(grid), band_(band / grid.pixel), error_(error), corners_(corners_of(grid)), batch_(batch) {}

  /// `last_point`: its end gets a cone, too; inside a chain or loop that is the next site's start.
  void add(const Site& site, const Frame& frame, std::uint32_t id, bool last_point) {
    const PixelSite s = pixel_site(site, frame, grid_);
    id_ = id;
    kind_ = static_cast<std::uint32_t>(s.kind) + (s.solid ? 4U : 0U);
    shift_ = batch_.offset - s.radius;
    reach_ = band_ + s.radius + kRim;
    if (s.kind == SiteKind::arc) {
      add_arc(s);
    } else if (s.kind == SiteKind::segment) {
      add_tent(s.a, s.b);
    }
    // Each vertex has one cone, that of the site which starts there: the same depths twice would only cost.
    cone(s.a, s.pseudo_a, error_);
    if (last_point && s.kind != SiteKind::point) cone(s.b, s.pseudo_b, error_);
    const double lengths = grid_.half_diagonal() + s.a.norm() + s.b.norm() + s.radius + batch_.offset;
    batch_.largest_error = std::max(batch_.largest_error, kMeshRounding * lengths);
  }

 private:
  /// `distance` [pixel] is that from the core, before the shift by thickness and offset.
  void corner(const Vec2& place, double distance, double side) {
    batch_.triangles.push_back({{static_cast<float>(place.x()), static_cast<float>(place.y())},
                                static_cast<float>(shift_ + distance),
                                static_cast<float>(side),
                                id_,
                                kind_});
  }

  /// Nothing in the window is farther [pixel]: a distance is convex, and greatest at a corner.
  double farthest_corner(const Vec2& from) const {
    double most = 0.0;
    for (const Vec2& c : corners_) most = std::max(most, (c - from).norm());
    return most;
  }

  /// The angles in which the window is seen from p; all round from within, or from close by.
  std::pair<double, double> view_from(const Vec2& p) const {
    // the window's corners lie on a circle of half its diagonal; seen from outside it they span less
    // than half a turn
    if (p.norm() < grid_.half_diagonal() + 2.0) return {0.0, 2.0 * kPi};
    const double middle = std::atan2(-p.y(), -p.x());
    double half = 0.0;
    for (const Vec2& c : corners_)
      half = std::max(half, std::acos(std::clamp((c - p).normalized().dot(-p.normalized()), -1.0, 1.0)));
    // a little wider, for the rounding of the angles
    return {middle - half - 1e-3, middle + half + 1e-3};
  }

  /// Facets towards the window only; `pseudo` tells the side of each place in them.
  void cone(const Vec2& p, const Vec2& pseudo, double error) {
    const auto [from, to] = view_from(p);
    sector(p, pseudo, from, to, error);
  }

  /// How far from p anything has to be drawn [pixel]: to the band's end, or to the window's farthest corner.
  double rim_about(const Vec2& p) const { return std::min(reach_, farthest_corner(p) + kRim); }

  /// Facets from angle `from` to `to` [rad] about p. `error` [pixel]: by how much they may fall short of the
  /// distance.
  void sector(const Vec2& p, const Vec2& pseudo, double from, double to, double error) {
    const double rim = rim_about(p);
    // too far for the band: nothing of the cone lies in the window
    if (p.norm() - rim > grid_.half_diagonal()) return;
    const int facets = std::max(1, static_cast<int>(std::ceil((to - from) / (2.0 * half_angle(rim, error)))));
    // the rim's corners lie beyond `rim`, the middle of a facet's edge at it, and there the depth is right
    const double length = rim / std::cos(0.5 * (to - from) / facets);
    const auto arm = [&](int k) {
      const double angle = from + (to - from) * k / facets;
      return Vec2(length * Vec2(std::cos(angle), std::sin(angle)));
    };
    for (int k = 0; k < facets; ++k) {
      // `side` is (place - p) . pseudo-normal, linear, so that interpolation keeps its sign
      corner(p, 0.0, 0.0);
      for (const int end : {k, k + 1}) corner(p + arm(end), rim, arm(end).dot(pseudo));
    }
  }

  /// Both sides of a segment; the solid is on its left.
  void add_tent(const Vec2& a, const Vec2& b) {
    const Vec2 left = perp((b - a).normalized());
    const double rim = std::min(reach_, std::max(farthest_corner(a), farthest_corner(b)) + kRim);
    // two triangles a side; on the left, where the solid is, `side` is negative
    for (const double side : {-1.0, 1.0}) {
      const Vec2 out = -side * rim * left;
      const double s = side * rim;
      corner(a, 0.0, 0.0), corner(b, 0.0, 0.0), corner(b + out, rim, s);
      corner(a, 0.0, 0.0), corner(b + out, rim, s), corner(a + out, rim, s);
    }
  }

  /// Chords, each a tent, and after each a sector on the convex side, where the next one's tent leaves a wedge.
  /// On the other side tents overlap, and the depth test takes the nearer. Chords and sectors have half the error each.
  void add_arc(const PixelSite& s) {
    const double half = half_angle(s.arc_radius, 0.5 * error_);
    const int chords = std::max(1, static_cast<int>(std::ceil(std::abs(s.sweep) / (2.0 * half))));
    const double turn = s.sweep > 0.0 ? 1.0 : -1.0, step = s.sweep / chords;
    const Vec2 from = s.a - s.center;
    const double start = std::atan2(from.y(), from.x());
    const auto at = [&](int k) {
      const double angle = start + k * step;
      // the ends as given: there the next site's tent begins, and its cone
      return k == 0        ? s.a
             : k == chords ? s.b
                           : Vec2(s.center + s.arc_radius * Vec2(std::cos(angle), std::sin(angle)));
    };
    // Each tent ends at its chord's normal, half a step off the arc's own. At the start there is a cone, from add(); the end
    // may have none: where the window sees no more of the arc, no other site begins.
    const double half_step = 0.5 * std::abs(step);
    for (int k = 0; k < chords; ++k) {
      add_tent(at(k), at(k + 1));
      const double middle = start + (k + 1) * step, over = kOverlap / rim_about(at(k + 1));
      const double before = half_step + over, after = k + 1 < chords ? before : over;
      sector(at(k + 1), turn * (at(k + 1) - s.center).normalized(), middle - (turn > 0.0 ? before : after),
             middle + (turn > 0.0 ? after : before), 0.5 * error_);
    }
  }

  const PixelGrid& grid_;
  double band_, error_;
  std::array<Vec2, 4> corners_;
  SiteBatch& batch_;
  std::uint32_t id_ = 0, kind_ = 0;
  double shift_ = 0.0, reach_ = 0.0;
};

}  // namespace

SiteBatch make_mesh_batch(const PixelGrid& grid, std::span<const PlacedOutline> scene, std::uint32_t excluded,
                          double band, double error) {
  SiteBatch batch = empty_batch(grid, scene);
  batch.is_mesh = true;
  batch.tessellation = error;
  MeshMaker maker(grid, band, error, batch);
  std::uint32_t id = 0;
  for (const PlacedOutline& item : scene) {
    const Frame frame(item.pose);
    for (const Loop& loop : item.outline->loops)
      // Loops cover all sites in order, so that ids count as in make_batch().
      for (int k = loop.first; k < loop.first + loop.count; ++k, ++id)
        if (item.drawn && item.owner != excluded)
          maker.add(item.outline->sites[k], frame, id, !loop.closed && k + 1 == loop.first + loop.count);
  }
  // the depth buffer tells values apart by this much only
  batch.largest_error += 0x1.0p-22 / batch.depth_scale;
  return batch;
}

}  // namespace brink::detail
