/// Paths are built in pixels: places go through View::to_picture() one by one, and Cairo's own
/// transformation stays the identity. So widths of lines, dashes and text are in pixels at any scale, and
/// lengths in metres (radii, thickness) are multiplied by View::scale where they are used.
///
/// An error of Cairo sticks to the object that has it, whose later calls do nothing. So nothing is asked
/// for in between; finish_file() looks once, at the end.
#include "brink/scenes/draw/canvas.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "brink/core/base/printable.h"

namespace brink::draw {
namespace {

void set_color(cairo_t* cairo, const Color& c, double opacity = 1.0) {
  cairo_set_source_rgba(cairo, c.red, c.green, c.blue, opacity);
}

/// True of a loop that is one point: a disc, where it has a thickness. Its path has no length, and is made
/// of a circle instead.
bool only_point(const Outline& outline, const Loop& loop) {
  return loop.count == 1 && outline.sites[loop.first].kind == SiteKind::point;
}

/// Radius of a loop's sites [m]: the first one's; outlines are built with one radius a loop.
double thickness(const Outline& outline, const Loop& loop) { return outline.sites[loop.first].radius; }

}  // namespace

/// Cairo's two objects and the paths of outlines. A path is appended to; who begins one says so
/// (cairo_new_path()), since a point that was left over would be joined to it by a line.
struct Canvas::Impl {
  View view;
  Paper paper;
  cairo_surface_t* surface = nullptr;
  cairo_t* cairo = nullptr;

  void move_to(const Vec2& p) const {
    const Vec2 q = view.to_picture(p);
    cairo_move_to(cairo, q.x(), q.y());
  }
  void line_to(const Vec2& p) const {
    const Vec2 q = view.to_picture(p);
    cairo_line_to(cairo, q.x(), q.y());
  }

  /// Appends a site to the current path, which ends at its start.
  void trace(const Site& site, const Frame& frame) const {
    if (site.kind != SiteKind::arc) return line_to(frame.to_world(site.b));
    const Vec2 center = view.to_picture(frame.to_world(site.center));
    const Vec2 from = frame.direction_to_world(site.a - site.center);
    // Angles change their sign on the picture, so counter-clockwise in the world is
    // cairo_arc_negative there.
    const double start = std::atan2(-from.y(), from.x());  // the picture's y runs downward
    const auto arc = site.sweep > 0 ? cairo_arc_negative : cairo_arc;
    arc(cairo, center.x(), center.y(), site.arc_radius * view.scale, start, start - site.sweep);
  }

  /// Appends a loop: of a point the circle of its thickness, else the core line without it.
  void trace(const Outline& outline, const Loop& loop, const Frame& frame) const {
    if (only_point(outline, loop)) {
      const Vec2 at = view.to_picture(frame.to_world(outline.sites[loop.first].a));
      // A new sub-path, or Cairo would draw a line to the circle's start.
      cairo_new_sub_path(cairo);
      cairo_arc(cairo, at.x(), at.y(), thickness(outline, loop) * view.scale, 0.0, 2.0 * std::numbers::pi);
      return;
    }
    move_to(frame.to_world(outline.sites[loop.first].a));
    for (int k = 0; k < loop.count; ++k) trace(outline.sites[loop.first + k], frame);
    // Closed by Cairo, or the start would have two caps and no joint.
    if (loop.closed) cairo_close_path(cairo);
  }

  /// Everything of the picture, with a border so that its own edge is not seen.
  void trace_page() const { cairo_rectangle(cairo, -50.0, -50.0, view.width + 100.0, view.height + 100.0); }

  // Even-odd with the page around it: of a container what lies outside its loops is filled;
  // holes of solids stay.
  void fill(const Outline& outline, const Frame& frame, const Color& color, double opacity) const {
    cairo_new_path(cairo);
    if (outline.container) trace_page();
    for (const Loop& loop : outline.loops)
      if (loop.closed || only_point(outline, loop)) trace(outline, loop, frame);
    cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_EVEN_ODD);
    set_color(cairo, color, opacity);
    cairo_fill(cairo);
  }

  /// Every loop's core as a line as wide as its thickness on both sides [pixels], and `extra` more (or
  /// less, < 0). Cairo takes a width below 0 for 0, and draws nothing.
  void stroke(const Outline& outline, const Frame& frame, const Color& color, double extra) const {
    set_color(cairo, color);
    for (const Loop& loop : outline.loops) {
      const bool point = only_point(outline, loop);
      // One loop at a time, as widths differ with the loops' thickness. A point has its
      // thickness in its circle.
      cairo_new_path(cairo);
      trace(outline, loop, frame);
      cairo_set_line_width(cairo, point ? extra : 2.0 * thickness(outline, loop) * view.scale + extra);
      cairo_stroke(cairo);
    }
  }

  /// All that belongs to the outline: its inside, if it has one, and the band of its thickness.
  void shape(const Outline& outline, const Frame& frame, const Color& color, double opacity,
             double extra) const {
    if (outline.solid || outline.is_point()) fill(outline, frame, color, opacity);
    stroke(outline, frame, color, extra);
  }
};

namespace {

/// Of pixels RGB24: 32 bits each without transparency, of which Picture has the lower 24. Sizes of SVG and
/// PDF are in points, one for each pixel.
cairo_surface_t* surface_on(const Paper& paper, int width, int height) {
  const std::string file = paper.file.string();
  if (paper.kind == Paper::Kind::svg) return cairo_svg_surface_create(file.c_str(), width, height);
  if (paper.kind == Paper::Kind::pdf) return cairo_pdf_surface_create(file.c_str(), width, height);
  return cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
}

}  // namespace

Canvas::Canvas(const View& view, int width, int height, const Color& background, const Paper& paper)
    : impl_(std::make_unique<Impl>()) {
  impl_->view = view;
  impl_->paper = paper;
  impl_->surface = surface_on(paper, width, height);
  impl_->cairo = cairo_create(impl_->surface);
  cairo_set_line_join(impl_->cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(impl_->cairo, CAIRO_LINE_CAP_ROUND);
  // [pixels], how far a curve may be off its lines; half of Cairo's own.
  cairo_set_tolerance(impl_->cairo, 0.05);
  rectangle(0, 0, width, height, background);
}

Canvas::~Canvas() {
  cairo_destroy(impl_->cairo);
  cairo_surface_destroy(impl_->surface);
}

// Nothing is clipped: the image is as large as the view, which is never larger than the picture.
void Canvas::paste(const Picture& image) {
  // Pixels are copied, so that cells have the bits that they were made with.
  if (impl_->paper.kind != Paper::Kind::pixels) return paste_as_image(image);
  // Flushed before and marked dirty after: Cairo may hold drawing back, or keep what it has read of the
  // pixels. Rows are copied one by one, since a surface's stride is its own choice.
  cairo_surface_flush(impl_->surface);
  unsigned char* data = cairo_image_surface_get_data(impl_->surface);
  const int stride = cairo_image_surface_get_stride(impl_->surface);
  for (int row = 0; row < image.height; ++row)
    std::memcpy(data + static_cast<std::size_t>(row) * stride,
                image.pixels.data() + static_cast<std::size_t>(row) * image.width, 4U * image.width);
  cairo_surface_mark_dirty(impl_->surface);
}

// Files of curves have no pixels to be copied into: there the image is painted as a whole.
void Canvas::paste_as_image(const Picture& image) {
  cairo_surface_t* pixels = cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height);
  unsigned char* data = cairo_image_surface_get_data(pixels);
  const int stride = cairo_image_surface_get_stride(pixels);
  for (int row = 0; row < image.height; ++row)
    std::memcpy(data + static_cast<std::size_t>(row) * stride,
                image.pixels.data() + static_cast<std::size_t>(row) * image.width, 4U * image.width);
  cairo_surface_mark_dirty(pixels);
  cairo_set_source_surface(impl_->cairo, pixels, 0.0, 0.0);
  cairo_paint(impl_->cairo);
  cairo_surface_destroy(pixels);
}

void Canvas::finish_file() {
  // Its one page. Only when the surface is finished has all been written, and the status says whether it
  // was.
  cairo_show_page(impl_->cairo);
  cairo_surface_finish(impl_->surface);
  for (const cairo_status_t status : {cairo_status(impl_->cairo), cairo_surface_status(impl_->surface)})
    if (status != CAIRO_STATUS_SUCCESS)
      throw IoError(fmt::format("{}: could not be written: {}", impl_->paper.file.string(),
                                cairo_status_to_string(status)));
}

void Canvas::outline(const Outline& outline, const Pose& pose, const Ink& ink) {
  const Frame frame(pose);
  cairo_t* cairo = impl_->cairo;
  // Clip, dashes and operator hold for this outline alone. What reaches below the view would come to lie on
  // the caption's strip.
  cairo_save(cairo);
  cairo_rectangle(cairo, 0, 0, impl_->view.width, impl_->view.height);
  cairo_clip(cairo);
  double radius = 0.0;
  for (const Site& site : outline.sites) radius = std::max(radius, site.radius);
  // A thickness below half a line cannot be seen beside the line itself.
  const bool thin = outline.is_point() || radius * impl_->view.scale < 0.5 * ink.line_width;
  if (ink.dashed) {
    const double dash[] = {5.0, 4.0};
    cairo_set_dash(cairo, dash, 2, 0.0);
  }
  if (thin) {
    if (ink.opacity > 0.0 && (outline.solid || outline.is_point()))
      impl_->fill(outline, frame, ink.fill, ink.opacity);
    impl_->stroke(outline, frame, ink.line, ink.line_width);
  } else {
    // The edge of a thick outline: the whole a line wider, then the inside over it. In a group, as with
    // opacity 0 the inside is cleared again, which must not clear what lies below.
    cairo_push_group(cairo);
    impl_->shape(outline, frame, ink.line, 1.0, ink.line_width);
    if (ink.opacity > 0.0) {
      impl_->shape(outline, frame, ink.fill, 1.0, -ink.line_width);
    } else {
      // Cleared without dashes: between two strokes of the edge the inside must go, too.
      cairo_set_operator(cairo, CAIRO_OPERATOR_CLEAR);
      cairo_set_dash(cairo, nullptr, 0, 0.0);
      impl_->shape(outline, frame, ink.fill, 1.0, -ink.line_width);
    }
    cairo_pop_group_to_source(cairo);
    cairo_paint(cairo);
  }
  cairo_restore(cairo);
}

void Canvas::line(const Vec2& from, const Vec2& to, const Color& color, double width) {
  set_color(impl_->cairo, color);
  cairo_set_line_width(impl_->cairo, width);
  impl_->move_to(from);
  impl_->line_to(to);
  cairo_stroke(impl_->cairo);
}

void Canvas::path(std::span<const Vec2> points, const Color& color, double width,
                  std::span<const double> dash) {
  if (points.empty()) return;
  cairo_save(impl_->cairo);
  set_color(impl_->cairo, color);
  cairo_set_line_width(impl_->cairo, width);
  if (!dash.empty()) {
    // Butt caps: round ones would fill the gaps of short dashes.
    cairo_set_line_cap(impl_->cairo, CAIRO_LINE_CAP_BUTT);
    cairo_set_dash(impl_->cairo, dash.data(), static_cast<int>(dash.size()), 0.0);
  }
  cairo_new_path(impl_->cairo);
  impl_->move_to(points.front());
  for (const Vec2& p : points.subspan(1)) impl_->line_to(p);
  cairo_stroke(impl_->cairo);
  cairo_restore(impl_->cairo);
}

void Canvas::area(std::span<const Vec2> points, const Color& color) {
  if (points.empty()) return;
  set_color(impl_->cairo, color);
  cairo_new_path(impl_->cairo);
  impl_->move_to(points.front());
  for (const Vec2& p : points.subspan(1)) impl_->line_to(p);
  cairo_close_path(impl_->cairo);
  cairo_fill(impl_->cairo);
}

void Canvas::dot(const Vec2& at, double pixels, const Color& color) {
  const Vec2 p = impl_->view.to_picture(at);
  set_color(impl_->cairo, color);
  cairo_new_path(impl_->cairo);
  cairo_arc(impl_->cairo, p.x(), p.y(), pixels, 0.0, 2.0 * std::numbers::pi);
  cairo_fill(impl_->cairo);
}

void Canvas::arrow(const Vec2& from, const Vec2& to, const Color& color, double width) {
  const Vec2 tip = impl_->view.to_picture(to), way = tip - impl_->view.to_picture(from);
  // Shorter arrows would be nothing but a head.
  if (way.norm() < 2.0 * width) return;
  line(from, to, color, width);
  // From the tip back along the shaft, never over more than half of it; the barbs stand off by atan(0.45),
  // 24 degrees, on either side.
  const Vec2 back = -way.normalized() * std::min(4.5 * width, 0.5 * way.norm());
  for (const double side : {0.45, -0.45}) {
    const Vec2 barb = tip + back + side * perp(back);
    cairo_move_to(impl_->cairo, tip.x(), tip.y());
    cairo_line_to(impl_->cairo, barb.x(), barb.y());
  }
  cairo_stroke(impl_->cairo);
}

void Canvas::spring(const Vec2& from, const Vec2& to, const Color& color, double width) {
  const Vec2 a = impl_->view.to_picture(from), b = impl_->view.to_picture(to);
  const double length = (b - a).norm();
  if (length < 4.0) return line(from, to, color, width);
  // A turn each 6 pixels, 5 to 60 of them; the ends stay straight over 15 % each.
  const int turns = std::clamp(static_cast<int>(length / 6.0), 5, 60);
  // Teeth of 3.5 pixels, less on short springs, which would be wider than long.
  const Vec2 side = perp(b - a) / length * std::min(0.12 * length, 3.5);
  cairo_new_path(impl_->cairo);
  cairo_move_to(impl_->cairo, a.x(), a.y());
  for (int k = 0; k < turns; ++k) {
    const Vec2 p = a + (b - a) * (0.15 + 0.7 * (k + 0.5) / turns) + (k % 2 == 0 ? side : Vec2(-side));
    cairo_line_to(impl_->cairo, p.x(), p.y());
  }
  cairo_line_to(impl_->cairo, b.x(), b.y());
  set_color(impl_->cairo, color);
  cairo_set_line_width(impl_->cairo, width);
  cairo_stroke(impl_->cairo);
}

void Canvas::rectangle(double x, double y, double width, double height, const Color& color) {
  set_color(impl_->cairo, color);
  cairo_rectangle(impl_->cairo, x, y, width, height);
  cairo_fill(impl_->cairo);
}

double Canvas::text_width(const std::string& words, double size, bool bold) const {
  cairo_t* cairo = impl_->cairo;
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
  cairo_text_extents_t extents;
  // Names come from files: nothing of them may be taken for a line break or a direction.
  cairo_text_extents(cairo, printable(words).c_str(), &extents);
  // By the advance, which counts spaces at the end: texts can be set side by side.
  return extents.x_advance;
}

double Canvas::text(double x, double y, const std::string& words, double size, const Color& color,
                    Align align, bool bold) {
  cairo_t* cairo = impl_->cairo;
  const double width = text_width(words, size, bold);  // which sets the font, too
  set_color(cairo, color);
  const double share = align == Align::left ? 0.0 : align == Align::middle ? 0.5 : 1.0;
  cairo_move_to(cairo, x - share * width, y);
  cairo_show_text(cairo, printable(words).c_str());
  // Showing text leaves a point on the path.
  cairo_new_path(cairo);
  return width;
}

Picture Canvas::finish() {
  cairo_surface_flush(impl_->surface);
  Picture picture;
  picture.width = cairo_image_surface_get_width(impl_->surface);
  picture.height = cairo_image_surface_get_height(impl_->surface);
  const unsigned char* data = cairo_image_surface_get_data(impl_->surface);
  const int stride = cairo_image_surface_get_stride(impl_->surface);
  picture.pixels.resize(static_cast<std::size_t>(picture.width) * picture.height);
  for (int row = 0; row < picture.height; ++row)
    std::memcpy(&picture.pixels[static_cast<std::size_t>(row) * picture.width],
                data + static_cast<std::size_t>(row) * stride, 4U * picture.width);
  // RGB24 leaves the upper byte undefined; pictures are opaque.
  for (std::uint32_t& pixel : picture.pixels) pixel |= 0xff000000U;
  return picture;
}

}  // namespace brink::draw
