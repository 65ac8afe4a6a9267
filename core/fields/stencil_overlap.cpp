#include "brink/core/fields/stencil_overlap.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

/// Box of the outline where it stands [m]: exact, by moving every site.
Box world_bounds(const PlacedOutline& item) { return transformed(*item.outline, item.pose).bounds; }

/// Where both can be solid; of a container, which is solid all round, that is the other's box.
Box common_window(const PlacedOutline& a, const PlacedOutline& b) {
  if (a.outline->container) return world_bounds(b);
  Box box = world_bounds(a);
  if (b.outline->container) return box;
  const Box other = world_bounds(b);
  box.low = box.low.cwiseMax(other.low);
  box.high = box.high.cwiseMin(other.high);
  return box;
}

}  // namespace

StencilOverlap stencil_overlap(PassRenderer& renderer, const PlacedOutline& a, const PlacedOutline& b,
                               int resolution) {
  StencilOverlap found;
  const Box window = common_window(a, b);
  if (window.empty() || !(window.extent().minCoeff() > 0.0)) return found;
  // [m]: the side that render() gives its pixels, up to rounding
  const double wanted = window.extent().maxCoeff() / resolution;
  // the longer side is `resolution` pixels, and by rounding would be one more
  const auto across = [&](double length) {
    return std::clamp(static_cast<int>(std::ceil(length / wanted)), 1, resolution);
  };
  const int width = across(window.extent().x()), height = across(window.extent().y());
  std::vector<std::uint8_t> stencil(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  std::size_t near_edge = 0;
  double pixel = 0.0;
  for (const PlacedOutline* item : {&a, &b}) {
    // each alone: in one picture the nearest site would hide on which side of the other a pixel lies
    const FieldImage image = renderer.render(window, width, height, {item, 1}, FieldImage::kNone,
                                             std::numeric_limits<double>::infinity());
    pixel = image.pixel;  // the same of both: it goes by the window
    for (std::size_t k = 0; k < stencil.size(); ++k) {
      stencil[k] += image.inside[k];
      // A pixel's centre stands for all of it unless a boundary passes within half its diagonal.
      near_edge += std::abs(image.distance[k]) <= std::sqrt(0.5) * image.pixel + image.rounding;
    }
  }
  // A pixel through which both boundaries pass is in near_edge twice: the bound is the larger for it.
  found.pixels = static_cast<std::size_t>(std::count(stencil.begin(), stencil.end(), 2));
  found.area = static_cast<double>(found.pixels) * pixel * pixel;
  found.error = static_cast<double>(near_edge) * pixel * pixel;
  return found;
}

}  // namespace brink
