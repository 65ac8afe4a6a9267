#include "brink/core/fields/site_tiles.h"

#include <algorithm>
#include <cmath>

#include "brink/core/shapes/distance.h"

namespace brink::detail {

namespace {

/// The drawn site in pixels, in double precision: within the batch's rounding of what the shader sees.
/// It is made from the instance: an arc that is drawn as its chord counts as that chord here.
Site drawn_site(const SiteInstance& instance) {
  Site site;
  // the bit above says "solid"
  const std::uint32_t kind = instance.kind & 3U;
  site.kind = kind == 0 ? SiteKind::point : kind == 1 ? SiteKind::segment : SiteKind::arc;
  site.a = Vec2(instance.ends[0], instance.ends[1]);
  site.b = Vec2(instance.ends[2], instance.ends[3]);
  if (site.kind == SiteKind::arc) {
    site.center = Vec2(instance.arc[0], instance.arc[1]);
    site.arc_radius = instance.arc[2];
    site.sweep = instance.arc[3];  // only its sign is asked for
  }
  return site;
}

/// The smallest value, and the smallest one of another owner than that value's.
struct TwoNearest {
  double first = std::numeric_limits<double>::infinity(), second = first;
  std::uint32_t owner = FieldImage::kNone;

  void offer(double value, std::uint32_t by) {
    if (value < first) {
      // the same owner nearer still: the nearest of the others stays what it was
      if (by != owner) second = first;
      first = value;
      owner = by;
    } else if (by != owner && value < second) {
      second = value;
    }
  }
};

}  // namespace

void cut_into_tiles(SiteBatch& batch, const PixelGrid& grid, const std::vector<std::uint32_t>& owners,
                    double band, int layers) {
  // For each tile: all distances at its centre, the limit that they give, a copy of each instance within it. The
  // copies differ from the instance in their quad alone, which becomes the tile.
  std::vector<Site> sites;
  for (const SiteInstance& instance : batch.instances) sites.push_back(drawn_site(instance));
  std::vector<double> values(sites.size());
  std::vector<SiteInstance> kept;
  const Vec2 half = 0.5 * Vec2(grid.width, grid.height);
  for (int y = 0; y < grid.height; y += kTile) {
    for (int x = 0; x < grid.width; x += kTile) {
      const Vec2 size(std::min(kTile, grid.width - x), std::min(kTile, grid.height - y));
      const Vec2 center = Vec2(x, y) + 0.5 * size - half;
      TwoNearest nearest;
      for (std::size_t i = 0; i < sites.size(); ++i) {
        // shift less offset is minus the radius: a batch for images has plain values
        values[i] = nearest_on(sites[i], center).distance + batch.instances[i].shift[0] - batch.offset;
        nearest.offer(values[i], owners[batch.instances[i].id]);
      }
      // 2 R is the tile's diagonal. Two distances are compared, each off by the error of what is drawn
      // and of this one.
      const double slack = size.norm() + 4.0 * batch.largest_error + 0.01;
      // of the tile's pixels none is farther from its centre than R, so that beyond band
      // + R nothing is drawn
      const double limit =
          std::min((layers == 2 ? nearest.second : nearest.first) + slack, band + 0.5 * slack + 0.01);
      for (std::size_t i = 0; i < sites.size(); ++i) {
        if (values[i] > limit) continue;
        SiteInstance instance = batch.instances[i];
        const auto w = static_cast<float>(0.5 * size.x()), h = static_cast<float>(0.5 * size.y());
        instance.frame = {static_cast<float>(center.x()), static_cast<float>(center.y()), 1.0F, 0.0F};
        // Tiles meet edge to edge, and edges run between pixel centres: every pixel is in one tile.
        // Within a tile sites stay in ascending order, which is what decides ties.
        instance.extent = {-w, w, -h, h};
        kept.push_back(instance);
      }
    }
  }
  batch.instances = std::move(kept);
}

}  // namespace brink::detail
