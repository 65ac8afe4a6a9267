#pragma once
/// Internal to core/fields: a site as one window sees it.

#include "brink/core/fields/site_batch.h"

namespace brink::detail {

/// A site in pixels from the window's centre, double precision.
struct PixelSite {
  SiteKind kind;
  bool solid;
  Vec2 a, b, center;
  Vec2 pseudo_a, pseudo_b;
  double arc_radius, sweep, radius;
  double error = 0.0;
};

/// The four corners of a window [pixel, from its centre].
std::array<Vec2, 4> corners_of(const PixelGrid& grid);

/// The site cut to what can be nearest to the window: of a segment or arc the part that the window sees; a
/// segment beyond whose end the whole window lies becomes that end.
PixelSite pixel_site(const Site& site, const Frame& frame, const PixelGrid& grid);

}  // namespace brink::detail
