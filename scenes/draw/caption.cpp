// The strip below a picture: title, time and the largest force from the left, ruler or legend from the
// right.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "brink/scenes/draw/sheet.h"

namespace brink::draw {
namespace {

/// Words longer than this share of the width leave no room for the ruler or legend.
constexpr double kRoomForWords = 0.6;

/// Three digits in the unit that keeps them between 1 and 1000, but for less than a millimetre.
std::string length_text(double metres) {
  if (metres >= 1000.0) return fmt::format("{:.3g} km", metres / 1000.0);
  if (metres >= 1.0) return fmt::format("{:.3g} m", metres);
  if (metres >= 0.01) return fmt::format("{:.3g} cm", metres * 100.0);
  return fmt::format("{:.3g} mm", metres * 1000.0);
}

/// Left of x: a bar `length` metres long with its size. Returns where it begins.
/// Parts at the right are set from right to left: each returns where the next one ends.
double draw_ruler(Canvas& canvas, const Sheet& sheet, double x, double y, double size) {
  // At most 22 % of the width, at least 9 %: round_length() takes off no more than three fifths.
  const double length = draw::round_length(0.22 * sheet.options.size.width / sheet.view.scale);
  const double pixels = length * sheet.view.scale;
  const Color ink = Tones::ink.rgb();
  x -= canvas.text(x, y, length_text(length), size, ink, Canvas::Align::right) + 0.6 * size;
  canvas.rectangle(x - pixels, y - 0.38 * size, pixels, 2.0, ink);
  // Upright ends: the length is measured between them.
  for (const double end : {x - pixels, x - 1.5})
    canvas.rectangle(end, y - 0.65 * size, 1.5, 0.65 * size, ink);
  return x - pixels;
}

/// Left of x: the colours of the depth layer from 0 to its largest distance. Returns where it begins.
double draw_legend(Canvas& canvas, const Sheet& sheet, double x, double y, double size) {
  const Color ink = Tones::ink.rgb();
  x -= canvas.text(x, y, length_text(sheet.full_scale), size, ink, Canvas::Align::right) + 0.6 * size;
  const int width = std::max(40, sheet.options.size.width / 5);
  // A column of 1.5 pixels a step of 1: no gaps between them where edges are smoothed.
  for (int k = 0; k < width; ++k)
    canvas.rectangle(x - width + k, y - 0.85 * size, 1.5, size, draw::distance_color(k / (width - 1.0)));
  x -= width + 0.6 * size;
  return x - canvas.text(x, y, "0", size, ink, Canvas::Align::right);
}

}  // namespace

int strip_height(const DrawOptions& options) {
  // Pictures smaller than this have no room for words.
  if (!options.caption || options.size.height < 120 || options.size.width < 160) return 0;
  // A twentieth of the height, as high as text needs at least, and no banner on a large picture.
  return std::clamp(options.size.height / 20, 26, 60);
}

void draw_caption(Canvas& canvas, const Sheet& sheet) {
  if (sheet.strip == 0) return;
  const DrawOptions& o = sheet.options;
  // Letters, margins and baseline are parts of the strip's height, so captions look alike at every size.
  const double size = 0.42 * sheet.strip, top = o.size.height - sheet.strip;
  const double y = top + 0.5 * sheet.strip + 0.36 * size, edge = 0.5 * sheet.strip;
  const Color ink = Tones::ink.rgb();
  canvas.rectangle(0, top, o.size.width, sheet.strip, Tones::paper.rgb());
  canvas.rectangle(0, top, o.size.width, 1.0, Oklch{0.80, 0.01, 85.0}.rgb());
  const bool depth = o.layer.kind == DrawLayer::Kind::depth;
  std::string title = o.title.empty() ? sheet.world.title : o.title;
  if (o.layer.kind == DrawLayer::Kind::pass)
    title += (title.empty() ? "" : ", ") + fmt::format("pass of {}", o.layer.body);
  double x = edge + canvas.text(edge, y, title, size, ink, Canvas::Align::left, true);
  if (o.time)
    // Without a title the time begins at the edge itself.
    x += size + canvas.text(x + (title.empty() ? 0.0 : size), y, fmt::format("t = {:.6g} s", *o.time), size,
                            Oklch{0.45, 0.02, 260.0}.rgb(), Canvas::Align::left);
  if (o.layer.kind == DrawLayer::Kind::forces) {
    const double most = largest_force(sheet);
    const std::string words = most > 0.0 ? fmt::format("widest line: {:.3g} N", most) : "no contact lasts";
    x += size + canvas.text(x + size, y, words, size, Oklch{0.45, 0.17, 25.0}.rgb(), Canvas::Align::left);
  }
  // Words go first; the ruler only where it does not run into them.
  if (x > kRoomForWords * o.size.width) return;
  depth ? draw_legend(canvas, sheet, o.size.width - edge, y, size)
        : draw_ruler(canvas, sheet, o.size.width - edge, y, size);
}

}  // namespace brink::draw
