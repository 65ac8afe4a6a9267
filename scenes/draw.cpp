#include "brink/scenes/draw.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <variant>

#include "brink/core/base/log.h"
#include "brink/core/shapes/distance.h"
#include "brink/scenes/draw_canvas.h"
#include "brink/scenes/draw_diagram.h"

namespace brink {
namespace {

using draw::Canvas;
using draw::Color;
using draw::Ink;
using draw::Oklch;
using draw::Palette;
using draw::Tones;
using draw::View;
using Kind = DrawLayer::Kind;

constexpr int kFineness = 2;  // field pixels a picture pixel, each way, under bodies
constexpr int kSmallest = 16, kLargest = 8192;
constexpr double kPassWindow = 2.4;  // half side of the pass layer's view, in bounding radii
constexpr double kMarkFrom = 7.0;    // bodies of a smaller radius [pixels] carry no mark

/// One picture in the making.
struct Sheet {
  const World& world;
  std::span<const BodyState> bodies;
  std::span<const Pose> sites;
  const DrawOptions& options;
  Palette palette;
  int excluded = -1;  ///< body of a pass
  int strip = 0;      ///< height of the caption [pixels]
  View view;
  double full_scale = 0.0;  ///< depth: distance at the light end of the legend [m]
};

int body_named(const World& world, const std::string& name) {
  for (std::size_t k = 0; k < world.bodies.size(); ++k)
    if (world.bodies[k].name == name) return static_cast<int>(k);
  std::string allowed;
  for (std::size_t k = 0; k < std::min<std::size_t>(world.bodies.size(), 8); ++k)
    allowed += (k == 0 ? "" : ", ") + world.bodies[k].name;
  if (world.bodies.size() > 8) allowed += fmt::format(" ... ({} bodies)", world.bodies.size());
  throw BadInput(fmt::format("layer \"pass:{}\": no body of that name; there are: {}", name, allowed));
}

void check(const World& world, std::span<const BodyState> bodies, std::span<const Pose> sites,
           const DrawOptions& options) {
  std::string error;
  if (!options.is_valid(&error)) throw BadInput(error);
  if (bodies.size() != world.bodies.size())
    throw BadInput(fmt::format("bodies: {} states given for {} bodies", bodies.size(), world.bodies.size()));
  if (sites.size() != world.sites.size())
    throw BadInput(fmt::format("sites: {} poses given for {} sites", sites.size(), world.sites.size()));
  const auto finite = [](const Pose& p) { return p.position.allFinite() && std::isfinite(p.angle); };
  for (std::size_t k = 0; k < bodies.size(); ++k)
    if (!finite(bodies[k].pose))
      throw BadInput(fmt::format("body \"{}\": its pose is not finite", world.bodies[k].name));
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (!finite(sites[k]))
      throw BadInput(fmt::format("site \"{}\": its pose is not finite", world.sites[k].name));
}

int strip_height(const DrawOptions& options) {
  if (!options.caption || options.size.height < 120 || options.size.width < 160) return 0;
  return std::clamp(options.size.height / 20, 26, 60);
}

View view_of(const Sheet& sheet) {
  const DrawOptions& o = sheet.options;
  Box box = o.view ? *o.view : automatic_view(sheet.world, sheet.bodies, sheet.sites);
  double margin = o.margin;
  if (sheet.excluded >= 0 && !o.view) {
    const double reach = kPassWindow * sheet.world.bodies[sheet.excluded].outline->bounding_radius;
    box = Box{};
    box.add(sheet.bodies[sheet.excluded].pose.position);
    box = box.grown(reach);
    margin = 0.0;
  }
  return draw::fitted(box, margin, o.size.width, o.size.height - sheet.strip);
}

/// Distance between lines of equal distance: about eight to the farthest point, not closer than 9 pixels.
double contour_step(double largest, const View& view) {
  const double wanted = std::max(largest / 8.0, 9.0 / view.scale);
  return draw::round_length(2.0 * wanted);
}

std::uint32_t excluded_owner(const Sheet& sheet) {
  return sheet.excluded < 0 ? FieldImage::kNone : static_cast<std::uint32_t>(sheet.excluded);
}

Picture background(Sheet& sheet) {
  const std::size_t count = sheet.world.bodies.size();
  const bool raw = sheet.options.layer.kind == Kind::color || sheet.options.layer.kind == Kind::depth;
  const std::vector<PlacedOutline> placed = draw::placed_outlines(sheet.world, sheet.bodies, sheet.sites);
  const FieldImage field =
      draw::render_field(placed, sheet.view, raw ? 1 : kFineness, excluded_owner(sheet), sheet.options.field);
  const double largest = draw::largest_distance(field);
  if (sheet.options.layer.kind == Kind::color) return draw::ids_picture(field, sheet.palette, count);
  if (sheet.options.layer.kind == Kind::depth) {
    sheet.full_scale = largest;
    return draw::distance_picture(field, largest);
  }
  return draw::cells_picture(field, kFineness, sheet.palette, count, contour_step(largest, sheet.view));
}

/// The diagram if there is one to be drawn and a context to draw it.
std::optional<Picture> diagram(Sheet& sheet) {
  const Kind kind = sheet.options.layer.kind;
  if (kind == Kind::scene &&
      (!sheet.options.diagram || sheet.world.bodies.size() + sheet.world.sites.size() == 0))
    return std::nullopt;
  if (kind == Kind::pass && !sheet.options.diagram) return std::nullopt;
  try {
    return background(sheet);
  } catch (const IoError& error) {
    if (kind != Kind::scene) throw;
    log().warn("drawn without the Voronoi diagram: {}", error.what());
    return std::nullopt;
  }
}

Ink body_ink(const Oklch& color) {
  const Color line = Palette::line(color).rgb();
  return {color.rgb(), line, 1.4, 1.0, false};
}

/// A line from the centre of mass along the body's own x axis to just inside its edge: how it has turned.
void draw_mark(Canvas& canvas, const Outline& outline, const Pose& pose, const Color& color, double scale) {
  if (outline.bounding_radius * scale < kMarkFrom || !(outline.solid || outline.is_point())) return;
  const Vec2 center = pose.position;
  if (gap_by_brute_force(outline, Vec2::Zero()) > -2.0 / scale) return;
  const double steps = 64.0;
  double reach = 0.0;
  for (int k = 1; k <= steps; ++k) {
    const double x = outline.bounding_radius * k / steps;
    if (gap_by_brute_force(outline, Vec2(x, 0.0)) > -2.5 / scale) break;
    reach = x;
  }
  canvas.line(center, Frame(pose).to_world(Vec2(reach, 0.0)), color, 1.2);
  canvas.dot(center, 1.7, color);
}

void draw_sites(Canvas& canvas, const Sheet& sheet) {
  const Color line = Tones::ink.rgb();
  Ink solid{Tones::site_fill.rgb(), line, 1.6, 1.0, false};
  Ink outside{Tones::paper.rgb(), line, 2.4, 1.0, false};
  Ink wire{Tones::site_fill.rgb(), line, 2.2, 1.0, false};
  for (const bool container : {true, false})
    for (std::size_t k = 0; k < sheet.world.sites.size(); ++k) {
      const Outline& outline = *sheet.world.sites[k].outline;
      if (outline.container != container) continue;
      canvas.outline(outline, sheet.sites[k], container ? outside : outline.solid ? solid : wire);
    }
}

void draw_springs(Canvas& canvas, const Sheet& sheet) {
  const Color color = Oklch{0.45, 0.02, 260.0}.rgb();
  for (const Force& force : sheet.world.forces) {
    const auto* spring = std::get_if<SpringForce>(&force);
    if (spring == nullptr) continue;
    const Vec2 a = Frame(sheet.bodies[spring->body_a].pose).to_world(spring->at_a);
    const Vec2 b =
        spring->body_b < 0 ? spring->at_b : Frame(sheet.bodies[spring->body_b].pose).to_world(spring->at_b);
    canvas.spring(a, b, color, 1.1);
  }
}

void draw_bodies(Canvas& canvas, const Sheet& sheet) {
  for (std::size_t k = 0; k < sheet.world.bodies.size(); ++k) {
    if (static_cast<int>(k) == sheet.excluded) continue;
    const Outline& outline = *sheet.world.bodies[k].outline;
    const Ink ink = body_ink(sheet.palette.body(k));
    canvas.outline(outline, sheet.bodies[k].pose, ink);
    draw_mark(canvas, outline, sheet.bodies[k].pose, ink.line, sheet.view.scale);
  }
}

void draw_arrows(Canvas& canvas, const Sheet& sheet) {
  if (!(sheet.options.arrow_seconds > 0.0)) return;
  for (const BodyState& state : sheet.bodies)
    canvas.arrow(state.pose.position,
                 state.pose.position + sheet.options.arrow_seconds * state.twist.velocity, Tones::ink.rgb(),
                 1.5);
}

/// The body left out of a pass: its edge dashed, its samples as dots.
void draw_excluded(Canvas& canvas, const Sheet& sheet) {
  const Outline& outline = *sheet.world.bodies[sheet.excluded].outline;
  const Pose& pose = sheet.bodies[sheet.excluded].pose;
  Oklch color = sheet.palette.body(sheet.excluded);
  color.lightness *= 0.8;
  canvas.outline(outline, pose, {color.rgb(), color.rgb(), 1.8, 0.0, true});
  for (const Sample& sample : outline.samples) canvas.dot(Frame(pose).to_world(sample.p), 2.6, color.rgb());
}

/// Thin light edges over the depth layer, so that wires and touching solids can be told apart.
void draw_edges(Canvas& canvas, const Sheet& sheet) {
  const Color line = Oklch{0.80, 0.01, 300.0}.rgb();
  const Ink ink{line, line, 0.9, 0.0, false};
  for (std::size_t k = 0; k < sheet.world.sites.size(); ++k)
    canvas.outline(*sheet.world.sites[k].outline, sheet.sites[k], ink);
  for (std::size_t k = 0; k < sheet.world.bodies.size(); ++k)
    canvas.outline(*sheet.world.bodies[k].outline, sheet.bodies[k].pose, ink);
}

std::string length_text(double metres) {
  if (metres >= 1000.0) return fmt::format("{:.3g} km", metres / 1000.0);
  if (metres >= 1.0) return fmt::format("{:.3g} m", metres);
  if (metres >= 0.01) return fmt::format("{:.3g} cm", metres * 100.0);
  return fmt::format("{:.3g} mm", metres * 1000.0);
}

/// Left of x: a bar `length` metres long with its size. Returns where it begins.
double draw_ruler(Canvas& canvas, const Sheet& sheet, double x, double y, double size) {
  const double length = draw::round_length(0.22 * sheet.options.size.width / sheet.view.scale);
  const double pixels = length * sheet.view.scale;
  const Color ink = Tones::ink.rgb();
  x -= canvas.text(x, y, length_text(length), size, ink, Canvas::Align::right) + 0.6 * size;
  canvas.rectangle(x - pixels, y - 0.38 * size, pixels, 2.0, ink);
  for (const double end : {x - pixels, x - 1.5})
    canvas.rectangle(end, y - 0.65 * size, 1.5, 0.65 * size, ink);
  return x - pixels;
}

/// Left of x: the colours of the depth layer from 0 to its largest distance. Returns where it begins.
double draw_legend(Canvas& canvas, const Sheet& sheet, double x, double y, double size) {
  const Color ink = Tones::ink.rgb();
  x -= canvas.text(x, y, length_text(sheet.full_scale), size, ink, Canvas::Align::right) + 0.6 * size;
  const int width = std::max(40, sheet.options.size.width / 5);
  for (int k = 0; k < width; ++k)
    canvas.rectangle(x - width + k, y - 0.85 * size, 1.5, size, draw::distance_color(k / (width - 1.0)));
  x -= width + 0.6 * size;
  return x - canvas.text(x, y, "0", size, ink, Canvas::Align::right);
}

void draw_caption(Canvas& canvas, const Sheet& sheet) {
  if (sheet.strip == 0) return;
  const DrawOptions& o = sheet.options;
  const double size = 0.42 * sheet.strip, top = o.size.height - sheet.strip;
  const double y = top + 0.5 * sheet.strip + 0.36 * size, edge = 0.5 * sheet.strip;
  const Color ink = Tones::ink.rgb();
  canvas.rectangle(0, top, o.size.width, sheet.strip, Tones::paper.rgb());
  canvas.rectangle(0, top, o.size.width, 1.0, Oklch{0.80, 0.01, 85.0}.rgb());
  const bool depth = o.layer.kind == Kind::depth;
  const double right = o.size.width - edge;
  depth ? draw_legend(canvas, sheet, right, y, size) : draw_ruler(canvas, sheet, right, y, size);
  std::string title = o.title.empty() ? sheet.world.title : o.title;
  if (o.layer.kind == Kind::pass)
    title += (title.empty() ? "" : ", ") + fmt::format("pass of {}", o.layer.body);
  const double x = edge + canvas.text(edge, y, title, size, ink, Canvas::Align::left, true);
  if (!o.time) return;
  canvas.text(x + (title.empty() ? 0.0 : size), y, fmt::format("t = {:.6g} s", *o.time), size,
              Oklch{0.45, 0.02, 260.0}.rgb(), Canvas::Align::left);
}

void draw_layer(Canvas& canvas, const Sheet& sheet) {
  switch (sheet.options.layer.kind) {
    case Kind::color:
      return;
    case Kind::depth:
      return draw_edges(canvas, sheet);
    case Kind::scene:
    case Kind::pass:
      draw_sites(canvas, sheet);
      draw_springs(canvas, sheet);
      draw_bodies(canvas, sheet);
      draw_arrows(canvas, sheet);
      if (sheet.excluded >= 0) draw_excluded(canvas, sheet);
  }
}

}  // namespace

DrawLayer parse_layer(std::string_view text) {
  if (text == "scene") return {Kind::scene, {}};
  if (text == "color") return {Kind::color, {}};
  if (text == "depth") return {Kind::depth, {}};
  if (text.starts_with("pass:") && text.size() > 5) return {Kind::pass, std::string(text.substr(5))};
  throw BadInput(fmt::format("layer: \"{}\" is not known; allowed: scene, color, depth, pass:BODY", text));
}

PictureSize parse_size(std::string_view text) {
  PictureSize size;
  const char* end = text.data() + text.size();
  const auto [cross_at, first] = std::from_chars(text.data(), end, size.width);
  const bool crossed = first == std::errc() && cross_at != end && *cross_at == 'x';
  const auto [stop, second] = crossed ? std::from_chars(cross_at + 1, end, size.height)
                                      : std::from_chars_result{end, std::errc::invalid_argument};
  DrawOptions options;
  options.size = size;
  std::string error;
  if (second != std::errc() || stop != end || !options.is_valid(&error))
    throw BadInput(
        fmt::format("size: \"{}\" is not a size; allowed: WIDTHxHEIGHT in pixels, each {} .. {}, as 1200x900",
                    text, kSmallest, kLargest));
  return size;
}

bool DrawOptions::is_valid(std::string* error) const {
  const auto fault = [&](std::string what) {
    if (error != nullptr) *error = std::move(what);
    return false;
  };
  for (const int side : {size.width, size.height})
    if (side < kSmallest || side > kLargest)
      return fault(fmt::format("size: {}x{} pixels; allowed: each {} .. {}", size.width, size.height,
                               kSmallest, kLargest));
  if (!(margin >= 0.0 && margin <= 1.0)) return fault(fmt::format("margin: {}; allowed: 0 .. 1", margin));
  if (!(arrow_seconds >= 0.0) || std::isinf(arrow_seconds))
    return fault(fmt::format("arrow_seconds: {}; allowed: finite, >= 0", arrow_seconds));
  if (view && (view->empty() || !view->low.allFinite() || !view->high.allFinite()))
    return fault("view: must be finite and hold something");
  if (layer.kind == DrawLayer::Kind::pass && layer.body.empty())
    return fault("layer: pass needs a body's name");
  return field.is_valid(error);
}

Picture draw_scene(const World& world, std::span<const BodyState> bodies, std::span<const Pose> sites,
                   const DrawOptions& options) {
  check(world, bodies, sites, options);
  Sheet sheet{world, bodies, sites, options, Palette(world), -1, 0, View{}, 0.0};
  if (options.layer.kind == Kind::pass) sheet.excluded = body_named(world, options.layer.body);
  sheet.strip = strip_height(options);
  sheet.view = view_of(sheet);
  Canvas canvas(sheet.view, options.size.width, options.size.height, Tones::paper.rgb());
  if (const std::optional<Picture> beneath = diagram(sheet)) canvas.paste(*beneath);
  draw_layer(canvas, sheet);
  draw_caption(canvas, sheet);
  return canvas.finish();
}

void draw_png(const std::filesystem::path& file, const World& world, std::span<const BodyState> bodies,
              std::span<const Pose> sites, const DrawOptions& options) {
  write_png(file, draw_scene(world, bodies, sites, options));
}

}  // namespace brink
