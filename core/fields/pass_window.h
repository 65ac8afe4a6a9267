#pragma once
/// The pass window of the classic method: the window around one body, everything else drawn at its present
/// pose, the body itself left out.

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "brink/core/base/work.h"
#include "brink/core/fields/field_options.h"
#include "brink/core/shapes/outline.h"

namespace brink {

/// One thing to be drawn: an outline at a pose, and the number of its owner.
struct PlacedOutline {
  const Outline* outline = nullptr;
  Pose pose;
  std::uint32_t owner = 0;
  bool drawn = true;  ///< false: left out, but the rest is drawn with the same bits as with it
};

/// A rendered window: row-major pixels, row 0 at the bottom, pixel centres at low + (i + 1/2) * pixel.
struct FieldImage {
  static constexpr std::uint32_t kNone = 0xffffffffU;
  Box window;          ///< in the world [m]
  double pixel = 0.0;  ///< side of a (square) pixel [m]
  int width = 0, height = 0;
  std::vector<std::uint32_t> owner;  ///< owner of the nearest site, kNone where none lies within the band
  std::vector<std::uint32_t> site;   ///< its site, counted inside its outline; kNone likewise
  std::vector<float> distance;       ///< distance to it [m], radius subtracted, unsigned; infinite where none
  std::vector<std::uint8_t> inside;  ///< 1 where the nearest site says "inside its solid" (altered interior),
                                     ///< or where the pixel's centre is within its thickness
  float rounding = 0.0F;             ///< bound on |distance - true distance| from single precision [m]
  float tessellation = 0.0F;         ///< the same from primitives that are cones and tents; else 0 [m]
};

/// What lies near one body at one moment.
struct NearOwners {
  std::vector<std::uint32_t> owners;  ///< ascending: every owner with a point within `margin` of the window
  double others_at_least = 0.0;       ///< every owner not named is at least this far from the window [m]
};

/// One pixel of a pass window.
struct PixelValue {
  std::uint32_t owner = FieldImage::kNone;
  std::uint32_t site = FieldImage::kNone;
  float distance = std::numeric_limits<float>::infinity();  ///< [m], as in FieldImage
  bool inside = false;
};

/// Pixels along a side of a pass window, at most: a power of two, the largest for which FieldRenderer has a target.
inline constexpr int kMostPassPixels = 8192;

/// Renders pass windows. Owns a GL context; belongs to the thread that made it.
///
/// Pixels are square: the window is grown about its centre to width x height pixels of side
/// max(window width / width, window height / height), and FieldImage::window says what was drawn.
/// Ties are won by the outline named first, then by the lower site. Sites are drawn with the same bits
/// whoever is excluded.
///
/// All calls throw BadInput on an empty or infinite window, a size outside 1 .. kMostPassPixels, a band or margin
/// that is negative or NaN, a scene entry without an outline, or a point to be read that is NaN.
class PassRenderer {
 public:
  /// @throws BadInput if the options are not valid; IoError if no GL context opens.
  explicit PassRenderer(const FieldOptions& options, WorkCounters* work = nullptr);
  ~PassRenderer();

  /// Nearest site and distance at every pixel of `window`, over everything but the owner `excluded` (kNone:
  /// all). Sites farther than `band` from a pixel are not drawn there (infinite: the whole window).
  FieldImage render(const Box& window, int width, int height, std::span<const PlacedOutline> scene,
                    std::uint32_t excluded, double band);

  /// Draws the same, to be read by read(). The outlines and `scene` are not kept.
  void draw(const Box& window, int width, int height, std::span<const PlacedOutline> scene,
            std::uint32_t excluded, double band);
  /// The pixels that hold `points` (as render_at) of what draw() has drawn last. @pre nothing else has been
  /// drawn since.
  std::vector<PixelValue> read(std::span<const Vec2> points);

  /// The same window, read only at the pixels that hold `points` [m, world] (a point outside: its nearest
  /// pixel). FieldOptions::readback says how: "pixel" reads them one by one, "window" the window, "full" the
  /// whole target. (The calls that return images read the window whole in mode "pixel".)
  std::vector<PixelValue> render_at(const Box& window, int width, int height,
                                    std::span<const PlacedOutline> scene, std::uint32_t excluded, double band,
                                    std::span<const Vec2> points);

  /// Both layers at once: nearest site, and nearest site of a different owner (two draws). Body k reads the
  /// first where the owner is not k, else the second.
  std::array<FieldImage, 2> render_two_layers(const Box& window, int width, int height,
                                              std::span<const PlacedOutline> scene, double band);

  /// Every owner (but `excluded`) that comes within `margin` of `window`, its inside included: complete, from
  /// the rendered candidates with a rounding allowance; an owner slightly beyond the margin may be named too.
  /// The exact detectors need nothing else from a pass.
  NearOwners near_owners(const Box& window, double margin, std::span<const PlacedOutline> scene,
                         std::uint32_t excluded);

  /// The context in use, for people.
  std::string description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace brink
