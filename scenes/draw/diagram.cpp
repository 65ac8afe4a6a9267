/// A picture of cells is made in two renderings:
///
///     coarse, 64 to 127 pixels along     how far from a site a place of the view is at most: the band
///     fine, in strips of field rows      each field pixel gets a colour, fineness^2 of them make one pixel
///
/// Without a band every site would be drawn over the whole window. With too narrow a band pixels would stay
/// without owner. The band of the coarse look is wide enough by the Lipschitz bound in look().
#include "brink/scenes/draw/diagram.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

namespace brink::draw {
namespace {

constexpr Color kEdge{1.0, 1.0, 1.0};
constexpr Oklch kNothing{0.90, 0.0, 0.0};   // no site anywhere
constexpr Oklch kSolid{0.13, 0.02, 300.0};  // inside solids on the depth layer
constexpr int kStripRows = 256;             // of the field, at a time
constexpr double kTie = 1e-2;               // of a pixel: distances less different are the same
constexpr double kEdgeStrength = 0.85;      // white of the lines where owners meet
constexpr double kContourStrength = 0.055;  // darkness of the lines of equal distance

/// Of a at t = 0, of b at t = 1, in sRGB values.
Color mixed(const Color& a, const Color& b, double t) {
  return {a.red + t * (b.red - a.red), a.green + t * (b.green - a.green), a.blue + t * (b.blue - a.blue)};
}

/// Distances have no sign for solids, which `inside` tells; within a thickness they are below 0.
bool solid_at(const FieldImage& field, std::size_t i) {
  return field.inside[i] != 0 || field.distance[i] < 0.0F;
}

/// Pixels are 0 until they are painted, which is not opaque: all must be.
Picture blank(int width, int height) {
  return {width, height, std::vector<std::uint32_t>(static_cast<std::size_t>(width) * height)};
}

/// Calls color_of(index into the field) for every picture pixel of a field without fineness.
template <class ColorOf>
Picture painted(const FieldImage& field, ColorOf&& color_of) {
  Picture picture = blank(field.width, field.height);
  // Fields have row 0 at the bottom, pictures at the top.
  for (int row = 0; row < field.height; ++row)
    for (int column = 0; column < field.width; ++column)
      picture.pixels[static_cast<std::size_t>(row) * field.width + column] =
          color_of(static_cast<std::size_t>(field.height - 1 - row) * field.width + column).argb();
  return picture;
}

/// The quiet colour of every owner, taken once.
std::vector<Color> cell_colors(std::span<const PlacedOutline> placed, const Palette& palette,
                               std::size_t body_count) {
  std::size_t owners = 0;
  for (const PlacedOutline& p : placed) owners = std::max<std::size_t>(owners, p.owner + 1);
  std::vector<Color> colors;
  for (std::size_t k = 0; k < owners; ++k)
    colors.push_back(k < body_count ? Palette::cell(palette.body(k)).rgb() : Tones::site_cell.rgb());
  return colors;
}

/// True if the pixel to the right or above belongs to another owner.
/// Of these two alone, so that a border is one pixel wide, not two.
bool at_edge(const FieldImage& field, int x, int y, std::size_t i) {
  return (x + 1 < field.width && field.owner[i] != field.owner[i + 1]) ||
         (y + 1 < field.height && field.owner[i] != field.owner[i + field.width]);
}

/// How much of a line of equal distance, as wide as a picture pixel, covers this field pixel: 0..1.
double contour_cover(const FieldImage& field, std::size_t i, int fineness, double step) {
  const double d = field.distance[i];
  // Half a step about the sites has no line: it would be the sites' own edge.
  if (!(step > 0.0) || !(d > 0.5 * step) || std::isinf(d)) return 0.0;
  const double away = std::abs(d - step * std::round(d / step)) / field.pixel;
  // 1 in the middle of the line, falling to 0 over one field pixel: its edge is smooth.
  return std::clamp(0.5 * fineness + 0.5 - away, 0.0, 1.0);
}

/// What a coarse rendering tells.
struct CoarseLook {
  double band;     ///< no pixel is farther than this from a site [m]
  double largest;  ///< distance outside solids [m]
};

/// Renders the view once with large pixels. @throws as PassRenderer::render().
CoarseLook look(PassRenderer& renderer, std::span<const PlacedOutline> placed, const View& view,
                std::uint32_t excluded, const FieldOptions& options) {
  // At least 64 pixels along the longer side; a smaller picture as it is.
  const int coarse = std::max(1, std::max(view.width, view.height) / 64);
  const int width = (view.width + coarse - 1) / coarse, height = (view.height + coarse - 1) / coarse;
  const double pixel = coarse / view.scale;
  // The coarse window may be larger than the view by less than a coarse pixel: it is whole pixels.
  const Box window{view.window.low, view.window.low + pixel * Vec2(width, height)};
  const double given = options.band > 0.0 ? options.band : std::numeric_limits<double>::infinity();
  const FieldImage seen = renderer.render(window, width, height, placed, excluded, given);
  // Distances within a thickness are below 0. Where nothing is in reach they are infinite, and the band
  // stays as given.
  float farthest = 0.0F;
  for (const float d : seen.distance) farthest = std::max(farthest, std::abs(d));
  // Distances are 1-Lipschitz, and no place of the view is farther from a coarse pixel's centre than its
  // half diagonal, 0.71 pixels: 1.01 are enough, rounding included.
  return {std::min(given, farthest + 1.01 * pixel), largest_distance(seen)};
}

/// The cells of a strip of a picture: its rows from `first` to before `last`, the field's with one row more
/// above where there is one.
class CellPainter {
 public:
  CellPainter(std::vector<Color> cells, int fineness, double step)
      : cells_(std::move(cells)), fineness_(fineness), step_(step) {}

  /// Sets the strip's rows of the picture, each pixel from the mean of its field pixels.
  void paint(const FieldImage& field, int first, int last, Picture& picture) const {
    // Row `last - 1` of the picture is the lowest of the strip, where its field begins.
    for (int row = first; row < last; ++row)
      for (int column = 0; column < picture.width; ++column)
        picture.pixels[static_cast<std::size_t>(row) * picture.width + column] =
            mean(field, column * fineness_, (last - 1 - row) * fineness_).argb();
  }

 private:
  /// Of the field's pixels that make one of the picture's.
  Color mean(const FieldImage& field, int x, int y) const {
    Color sum;
    for (int j = 0; j < fineness_; ++j)
      for (int i = 0; i < fineness_; ++i) {
        const Color c = color_at(field, x + i, y + j);
        sum = {sum.red + c.red, sum.green + c.green, sum.blue + c.blue};
      }
    const double n = fineness_ * fineness_;
    return {sum.red / n, sum.green / n, sum.blue / n};
  }
  /// The colour of one field pixel: its owner's cell, darker on a line of equal distance, white at a
  /// border.
  Color color_at(const FieldImage& field, int x, int y) const {
    const std::size_t i = static_cast<std::size_t>(y) * field.width + x;
    if (field.owner[i] == FieldImage::kNone) return nothing_;
    const Color cell = mixed(cells_[field.owner[i]], ink_,
                             kContourStrength * 2.0 * contour_cover(field, i, fineness_, step_));
    return at_edge(field, x, y, i) ? mixed(cell, kEdge, kEdgeStrength) : cell;
  }

  std::vector<Color> cells_;
  int fineness_;
  double step_;
  Color ink_ = Tones::ink.rgb(), nothing_ = kNothing.rgb();
};

/// Fixed sites thicker by next to nothing. Behind a floor what stands on it is as near as the floor, and roundings
/// would say whose cell that is: it is the floor's.
class ThickerSites {
 public:
  ThickerSites(std::span<const PlacedOutline> placed, std::size_t body_count, double by)
      : placed_(placed.begin(), placed.end()) {
    for (PlacedOutline& p : placed_) {
      if (p.owner < body_count) continue;
      Outline& thicker = outlines_.emplace_back(*p.outline);
      for (Site& site : thicker.sites) site.radius += by;
      p.outline = &thicker;
    }
  }
  std::span<const PlacedOutline> placed() const { return placed_; }

 private:
  std::deque<Outline> outlines_;
  std::vector<PlacedOutline> placed_;
};

}  // namespace

std::vector<PlacedOutline> placed_outlines(const World& world, std::span<const BodyState> bodies,
                                           std::span<const Pose> sites) {
  std::vector<PlacedOutline> placed;
  for (std::size_t k = 0; k < world.bodies.size(); ++k)
    placed.push_back({world.bodies[k].outline.get(), bodies[k].pose, static_cast<std::uint32_t>(k)});
  for (std::size_t k = 0; k < world.sites.size(); ++k)
    placed.push_back(
        {world.sites[k].outline.get(), sites[k], static_cast<std::uint32_t>(world.bodies.size() + k)});
  return placed;
}

// One renderer for both looks: a second one would open a second GL context.
FieldImage render_field(std::span<const PlacedOutline> placed, const View& view, std::uint32_t excluded,
                        const FieldOptions& options) {
  PassRenderer renderer(options);
  const double band = look(renderer, placed, view, excluded, options).band;
  return renderer.render(view.window, view.width, view.height, placed, excluded, band);
}

double largest_distance(const FieldImage& field) {
  float largest = 0.0F;
  for (std::size_t i = 0; i < field.distance.size(); ++i)
    if (!solid_at(field, i) && !std::isinf(field.distance[i])) largest = std::max(largest, field.distance[i]);
  return largest;
}

Picture cells_picture(std::span<const PlacedOutline> all, const View& view, int wanted,
                      std::uint32_t excluded, const FieldOptions& options, const Palette& palette,
                      std::size_t body_count, const std::function<double(double)>& contour_step) {
  const int fineness = std::clamp(kMostPassPixels / view.width, 1, wanted);  // a strip is one window
  const ThickerSites thicker(all, body_count, kTie / view.scale);
  const std::span<const PlacedOutline> placed = thicker.placed();
  PassRenderer renderer(options);
  // The distance between lines is one for the picture, so it is chosen before the first strip.
  const CoarseLook seen = look(renderer, placed, view, excluded, options);
  const CellPainter painter(cell_colors(placed, palette, body_count), fineness, contour_step(seen.largest));
  Picture picture = blank(view.width, view.height);
  const double pixel = 1.0 / (view.scale * fineness);
  // A strip is so many whole picture rows as kStripRows field rows hold, but for the one above.
  const int strip = std::max(1, (kStripRows - 1) / fineness);
  for (int first = 0; first < view.height; first += strip) {
    const int last = std::min(first + strip, view.height);
    // The row above lets at_edge() see borders that lie between two strips.
    const int below = (view.height - last) * fineness, rows = (last - first) * fineness + (first > 0);
    const Vec2 low = view.window.low + Vec2(0.0, below * pixel);
    const int columns = view.width * fineness;
    painter.paint(
        renderer.render({low, low + pixel * Vec2(columns, rows)}, columns, rows, placed, excluded, seen.band),
        first, last, picture);
  }
  return picture;
}

Picture ids_picture(const FieldImage& field, const Palette& palette, std::size_t body_count) {
  return painted(field, [&](std::size_t i) {
    if (field.owner[i] == FieldImage::kNone) return kNothing.rgb();
    const std::size_t owner = field.owner[i];
    Oklch color = owner < body_count ? palette.strong(owner) : palette.site(owner - body_count);
    // Sites of one owner differ in lightness, in the order of the golden ratio: neighbours in
    // number are far apart.
    const double turns = 0.6180339887498949 * field.site[i];
    color.lightness += 0.16 * (turns - std::floor(turns)) - 0.08;
    // On both sides of a solid's edge the same site is nearest: darkness alone tells them apart.
    if (solid_at(field, i)) color.lightness *= 0.62;
    return color.rgb();
  });
}

// A table of 1024 colours for 256 levels a channel: distance_color() looks for its chroma by bisection,
// which is too much for every pixel.
Picture distance_picture(const FieldImage& field, double full_scale) {
  const Color solid = kSolid.rgb();
  std::vector<Color> map;
  for (int k = 0; k < 1024; ++k) map.push_back(distance_color(k / 1023.0));
  return painted(field, [&](std::size_t i) {
    if (solid_at(field, i)) return solid;
    // Where nothing is in reach distance is infinite: the light end.
    const double fraction = full_scale > 0.0 ? field.distance[i] / full_scale : 0.0;
    return map[static_cast<std::size_t>(std::lround(1023.0 * std::clamp(fraction, 0.0, 1.0)))];
  });
}

}  // namespace brink::draw
