#pragma once
/// Internal to core/fields: sites as the renderer draws them, in pixels of one window and single precision.
///
/// Rounding. All lengths here are in pixels, measured from the window's centre, so nothing is larger than the
/// window by much: segments are cut to the part that can be nearest to the window. Let u = 2^-24 and S =
/// (half the window's diagonal) + |a| + |b| + |radius| (arcs: + |centre| + circle radius). The shader's chain
/// for a segment is: two rounded end points (2 u S), q - a (u S), dot and product for the foot's parameter (7
/// u S along the segment), the foot (4 u S), a difference (2 u S), length (4 u S, four units in the last
/// place allowed for the square root), the shift (2 u S): 22 u S. For an arc: the radial form costs 12 u S;
/// deciding the sector wrongly by a displacement of 10 u S costs at most twice that, since both forms agree
/// on the sector's edges and are 1-Lipschitz. `kRounding` = 64 u covers both with room. An arc so flat that
/// its circle is large beside the window is drawn as its chord where its sagitta is the smaller error.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "brink/core/fields/pass_window.h"

namespace brink::detail {

/// A window of square pixels. Pixel (i, j) has its centre at low + (i + 1/2, j + 1/2) * pixel.
struct PixelGrid {
  Vec2 low = Vec2::Zero();  ///< [m]
  double pixel = 1.0;       ///< [m]
  int width = 0, height = 0;

  /// How far rounding can put a point's pixel beside the true one [pixel]: its coordinates may be large
  /// beside a pixel.
  double snap() const {
    const double farthest = low.cwiseAbs().maxCoeff() + pixel * std::max(width, height);
    return 1e-9 + 0x1.0p-50 * farthest / pixel;
  }
  Vec2 center() const { return low + 0.5 * pixel * Vec2(width, height); }
  double half_diagonal() const { return 0.5 * std::hypot(width, height); }  ///< [pixel]
  Box box() const {
    Box b;
    b.add(low);
    b.add(low + pixel * Vec2(width, height));
    return b;
  }
};

/// Error bound of one distance, as a share of S (see above).
inline constexpr double kRounding = 64.0 / (1 << 24);
/// Half the diagonal of a pixel, rounded up, in pixels.
inline constexpr double kHalfDiagonal = 0.70710679;

/// One instance of the instanced draw: the layout of the vertex attributes.
struct SiteInstance {
  std::array<float, 4> frame{};   ///< origin and unit axis of the quad
  std::array<float, 4> extent{};  ///< the quad along the axis (low, high) and across it (low, high)
  std::array<float, 4> ends{};    ///< a, b
  std::array<float, 4> arc{};     ///< arcs: centre, circle radius, turn (+-1); segments: 1 / length^2
  std::array<float, 4> pseudo{};  ///< pseudo-normals at a and b
  std::array<float, 2> shift{};   ///< added to the core distance: for an upper and for a lower bound
  std::uint32_t id = 0;           ///< place in the batch's numbering
  std::uint32_t kind = 0;         ///< 0 point, 1 segment, 2 arc; + 4 if solid
};
static_assert(sizeof(SiteInstance) == 96);

/// One corner of a triangle of cones and tents: the layout of the vertex attributes.
struct MeshVertex {
  std::array<float, 2> place{};    ///< [pixel, from the window's centre]
  float value = 0.0F;              ///< drawn value there
  float side = 0.0F;               ///< < 0 on the solid side
  std::uint32_t id = 0, kind = 0;  ///< as in SiteInstance
};
static_assert(sizeof(MeshVertex) == 24);

/// What to draw, all sites at once: as instances, or as triangles.
struct SiteBatch {
  std::vector<SiteInstance> instances;  ///< sites that can show in the window, ascending id
  std::vector<MeshVertex> triangles;    ///< the same as cones and tents (site_mesh.h), three a triangle
  bool is_mesh = false;                 ///< triangles are drawn, no instances
  double tessellation = 0.0;            ///< how far a triangle is off the site's distance at most [pixel]
  bool has_arcs = false;                ///< the scene has arcs (drawn or not)
  double offset = 0.0;                  ///< drawn value = distance [pixel] - radius + offset >= 0
  double depth_scale = 1.0;             ///< power of two; drawn value * depth_scale is in [0, 1)
  double largest_value = 0.0;           ///< no drawn value is larger [pixel]
  double largest_error = 0.0;           ///< largest rounding allowance of an instance [pixel]
};

/// How instances are to be made.
struct BatchRules {
  double band = std::numeric_limits<double>::infinity();  ///< [m]; quads cover every pixel nearer than this
  double margin = 0.0;                                    ///< and this much more [pixel]
  bool bounds =
      false;  ///< shift distances by the error bound (upper and lower bounds instead of the plain value)
};

/// A batch with nothing to draw. Offset and depth scale come from the whole scene, excluded owner and all, so
/// that a site is drawn with the same bits whoever is left out.
SiteBatch empty_batch(const PixelGrid& grid, std::span<const PlacedOutline> scene);

/// Sites of `scene` numbered from 0 in order; the owner `excluded`, and whatever is not to be drawn,
/// keeps its numbers.
SiteBatch make_batch(const PixelGrid& grid, std::span<const PlacedOutline> scene, std::uint32_t excluded,
                     const BatchRules& rules);

}  // namespace brink::detail
