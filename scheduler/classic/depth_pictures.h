#pragma once
/// What the particles of each body see: pass windows drawn at one moment, and read at points.

#include <memory>
#include <span>
#include <vector>

#include "brink/core/fields/pass_window.h"

namespace brink {

/// Pictures of one moment for every body, as FieldOptions say: drawn body by body (`passes = "each"`: the
/// window around the body, the body left out), or once for all (`"two_layers"`: nearest, and nearest of
/// another owner; body k reads the first where the owner is not k, else the second).
class DepthPictures {
 public:
  /// `radii`: of each body's bounding circle [m]; they and `options` fix the pixels, once for a run. A body
  /// without size gets pixels as for one of `length` [m].
  DepthPictures(const FieldOptions& options, std::vector<double> radii, double length, WorkCounters* work);

  /// Side of the pixels that body k reads [m]. Two layers: those of the body with the finest, but coarser if
  /// all bodies together do not fit on kMostPixels; set by begin().
  double pixel(int body) const;

  /// A new moment. `scene` holds every owner, bodies first: entry k is owner k. `band` [m]: sites farther
  /// than this need not be seen.
  void begin(std::vector<PlacedOutline> scene, double band);
  /// Body k's picture. `near`: owners that need be drawn, ascending; empty: all.
  void open(int body, const std::vector<int>& near);
  /// The picture of the body opened last, at points of the world.
  std::vector<PixelValue> read(std::span<const Vec2> points);

  /// The centre of the pixel that speaks for a point of the picture opened last [m, world].
  Vec2 pixel_center(const Vec2& p) const;

  static constexpr int kMostPixels = 2048;  ///< a side, where two layers hold all bodies

 private:
  void draw_layers();
  Box window_of(int body) const;
  PixelValue value_at(const Vec2& p) const;

  bool each_body_;  ///< has a window of its own, else two layers for all
  std::vector<double> radii_, pixels_;
  double common_pixel_;
  PassRenderer renderer_;
  std::vector<PlacedOutline> scene_;
  double band_ = 0.0;
  int body_ = -1;
  std::array<FieldImage, 2> layers_;
};

}  // namespace brink
