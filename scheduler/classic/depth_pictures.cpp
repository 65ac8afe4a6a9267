#include "brink/scheduler/classic/depth_pictures.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

constexpr int kResolution = 64;  // pixels across a body where the options do not say
constexpr int kRim = 2;          // pixels around it: room for differences of neighbours

}  // namespace

DepthPictures::DepthPictures(const FieldOptions& options, std::vector<double> radii, double length,
                             WorkCounters* work)
    : each_body_(options.passes == "each"), radii_(std::move(radii)), renderer_(options, work) {
  const int across = options.resolution > 0 ? options.resolution : kResolution;
  for (const double r : radii_) pixels_.push_back((r > 0.0 ? 2.0 * r : length) / across);
  common_pixel_ = pixels_.empty() ? length : *std::min_element(pixels_.begin(), pixels_.end());
}

double DepthPictures::pixel(int body) const { return each_body_ ? pixels_[body] : common_pixel_; }

/// A square about the body's bounding circle, with its rim [m, world].
Box DepthPictures::window_of(int body) const {
  Box box;
  box.add(scene_[body].pose.position);
  return box.grown(radii_[body] + kRim * pixel(body));
}

void DepthPictures::begin(std::vector<PlacedOutline> scene, double band) {
  scene_ = std::move(scene);
  band_ = band;
  body_ = -1;
  if (!each_body_) draw_layers();
}

/// One grid over the windows of all bodies, of square pixels: of the finest body's, or as coarse as it takes
/// to fit kMostPixels a side.
void DepthPictures::draw_layers() {
  Box all;
  for (std::size_t k = 0; k < radii_.size(); ++k) all.add(window_of(static_cast<int>(k)));
  if (all.empty()) return;
  const double finest = *std::min_element(pixels_.begin(), pixels_.end());
  common_pixel_ = std::max(finest, all.extent().maxCoeff() / kMostPixels);
  const auto pixels = [&](double length) {
    return std::clamp(static_cast<int>(std::ceil(length / common_pixel_)), 1, kMostPixels);
  };
  const int width = pixels(all.extent().x()), height = pixels(all.extent().y());
  Box window = all;
  // a whole number of pixels, so that none is stretched
  window.high = all.low + common_pixel_ * Vec2(width, height);
  layers_ = renderer_.render_two_layers(window, width, height, scene_, band_);
}

void DepthPictures::open(int body, const std::vector<int>& near) {
  body_ = body;
  if (!each_body_) return;
  // left out by a flag: the others keep their numbers, and so their bits
  if (!near.empty()) {
    for (PlacedOutline& item : scene_) item.drawn = false;
    for (const int owner : near) scene_[owner].drawn = true;
  }
  const Box window = window_of(body);
  // A whole number, rim included: the body's diameter is one of its pixels.
  const int across = static_cast<int>(std::lround(window.extent().x() / pixel(body)));
  renderer_.draw(window, across, across, scene_, static_cast<std::uint32_t>(body), band_);
}

/// Two layers alone; a point beyond the window reads the pixel at its edge.
PixelValue DepthPictures::value_at(const Vec2& p) const {
  const FieldImage& first = layers_[0];
  const Vec2 at = (p - first.window.low) / first.pixel;
  const int i = static_cast<int>(std::clamp(at.x(), 0.0, first.width - 1.0));
  const int j = static_cast<int>(std::clamp(at.y(), 0.0, first.height - 1.0));
  const std::size_t place = static_cast<std::size_t>(j) * first.width + i;
  // The second layer is the nearest of another owner than the first's.
  const FieldImage& seen = layers_[first.owner[place] == static_cast<std::uint32_t>(body_) ? 1 : 0];
  return {seen.owner[place], seen.site[place], seen.distance[place], seen.inside[place] != 0};
}

Vec2 DepthPictures::pixel_center(const Vec2& p) const {
  // the corner from which the pixels of this picture are counted
  const Vec2 low = each_body_ ? window_of(body_).low : layers_[0].window.low;
  const Vec2 at = ((p - low) / pixel(body_)).array().floor() + 0.5;
  return low + pixel(body_) * at;
}

std::vector<PixelValue> DepthPictures::read(std::span<const Vec2> points) {
  if (each_body_) return renderer_.read(points);
  std::vector<PixelValue> values;
  for (const Vec2& p : points) values.push_back(value_at(p));
  return values;
}

}  // namespace brink
