#pragma once
/// Colours of pictures, chosen in OKLCH (Ottosson 2020, "A perceptual color space for image processing") so
/// that equal lightness looks equally light whatever the hue.

#include <cstdint>
#include <vector>

#include "brink/core/world/world.h"

namespace brink::draw {

struct Color {
  double red = 0.0, green = 0.0, blue = 0.0;  ///< sRGB, 0..1

  std::uint32_t argb() const;
};

/// A colour as lightness 0..1, chroma 0..~0.3 and hue [degrees].
struct Oklch {
  double lightness = 0.5, chroma = 0.0, hue = 0.0;

  /// In sRGB; where that has no such colour, with as much of the chroma as fits.
  Color rgb() const;
};

/// For fraction 0..1 (clamped): dark violet over blue and green to light yellow; lightness is linear in the
/// fraction.
Color distance_color(double fraction);

/// Quiet greys and paper tones shared by all pictures.
struct Tones {
  static constexpr Oklch paper{0.965, 0.008, 85.0};
  static constexpr Oklch ink{0.27, 0.02, 260.0};
  static constexpr Oklch site_fill{0.52, 0.022, 260.0};
  static constexpr Oklch site_cell{0.935, 0.006, 260.0};
};

/// One colour an owner: bodies of one name (copies "disc[3]", numbered "ball_3") share a hue and differ in
/// shade; where all bodies have one name, hues alternate instead.
class Palette {
 public:
  explicit Palette(const World& world);

  const Oklch& body(std::size_t k) const { return bodies_[k]; }
  /// The same with wider differences inside a group, for the raw colour layer.
  Oklch strong(std::size_t k) const;
  /// Colour of a fixed site, for the raw colour layer.
  Oklch site(std::size_t k) const;

  /// The same hue, almost white: the body's cell.
  static Oklch cell(const Oklch& body) { return {0.925, 0.32 * body.chroma, body.hue}; }
  /// The same hue, almost black: the body's outline.
  static Oklch line(const Oklch& body) { return {0.36, 0.55 * body.chroma, body.hue}; }

 private:
  std::vector<Oklch> bodies_;
};

}  // namespace brink::draw
