/// A picture is painted from below upward, and what comes later covers what was there:
///
///     the diagram, as pixels              layers color and depth are little else
///     sites, trails, springs, bodies      the layer's own things (draw_layer())
///     the box of the period               of a plane that repeats itself
///     velocities, contacts, names, axes   marks.cpp
///     the caption's strip                 caption.cpp; the view ends above it
///
/// Whatever a part must know of the picture is on the Sheet. Bodies stand on it moved home, into the period
/// that begins at the origin; their images are found from there.
#include "brink/scenes/draw/draw.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "brink/core/base/log.h"
#include "brink/core/shapes/distance.h"
#include "brink/scenes/draw/diagram.h"
#include "brink/scenes/draw/sheet.h"

namespace brink {
namespace {

using draw::Canvas;
using draw::Color;
using draw::Ink;
using draw::Oklch;
using draw::Palette;
using draw::Sheet;
using draw::Tones;
using draw::View;
using Kind = DrawLayer::Kind;

// Two by two field pixels make one of the picture: borders are smooth, and four times as many are drawn.
constexpr int kFineness = 2;         // field pixels a picture pixel, each way, under bodies
constexpr double kPassWindow = 2.4;  // half side of the pass layer's view, in bounding radii
constexpr double kMarkFrom = 7.0;    // bodies of a smaller radius [pixels] carry no mark

/// The index of the first body of that name. @throws BadInput with at most eight names, so that the message
/// stays short in a world of thousands.
int body_named(const World& world, const std::string& name) {
  for (std::size_t k = 0; k < world.bodies.size(); ++k)
    if (world.bodies[k].name == name) return static_cast<int>(k);
  std::string allowed;
  for (std::size_t k = 0; k < std::min<std::size_t>(world.bodies.size(), 8); ++k)
    allowed += (k == 0 ? "" : ", ") + world.bodies[k].name;
  if (world.bodies.size() > 8) allowed += fmt::format(" ... ({} bodies)", world.bodies.size());
  throw BadInput(fmt::format("layer \"pass:{}\": no body of that name; there are: {}", name, allowed));
}

/// What the drawing takes for granted, looked at before any of it. Twists are not: they make arrows alone.
/// @throws BadInput as draw_scene() says, but for an unknown body, which body_named() tells.
void check(const World& world, std::span<const BodyState> bodies, std::span<const Pose> sites,
           const DrawOptions& options) {
  std::string error;
  if (!options.is_valid(&error)) throw BadInput(error);
  if (bodies.size() != world.bodies.size())
    throw BadInput(fmt::format("bodies: {} states given for {} bodies", bodies.size(), world.bodies.size()));
  if (sites.size() != world.sites.size())
    throw BadInput(
        fmt::format("fixed sites: {} poses given for {} of them", sites.size(), world.sites.size()));
  const auto finite = [](const Pose& p) { return p.position.allFinite() && std::isfinite(p.angle); };
  for (std::size_t k = 0; k < bodies.size(); ++k)
    if (!finite(bodies[k].pose))
      throw BadInput(fmt::format("body \"{}\": its pose is not finite", world.bodies[k].name));
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (!finite(sites[k]))
      throw BadInput(fmt::format("fixed site \"{}\": its pose is not finite", world.sites[k].name));
  for (const DrawnForce& f : options.forces)
    if (f.body < 0 || f.body >= static_cast<int>(bodies.size()))
      throw BadInput(fmt::format("forces: on body {}; there are {} bodies", f.body, bodies.size()));
}

/// The window above the strip: what is asked for, else the surroundings of a pass's body, else what
/// automatic_view() finds. It is never narrower than that; square pixels may make it wider or higher.
View view_of(const Sheet& sheet) {
  const DrawOptions& o = sheet.options;
  Box box = o.view ? *o.view : automatic_view(sheet.world, sheet.bodies, sheet.sites);
  double margin = o.margin;
  // A pass is seen about its body, without a margin.
  if (sheet.excluded >= 0 && !o.view) {
    const double reach = kPassWindow * sheet.world.bodies[sheet.excluded].outline->bounding_radius;
    box = Box{};
    box.add(sheet.bodies[sheet.excluded].pose.position);
    box = box.grown(reach);
    margin = 0.0;
  }
  return draw::fitted(box, margin, o.size.width, o.size.height - sheet.strip);
}

/// Distance between lines of equal distance: about eight to the farthest point, not much
/// closer than 9 pixels.
double contour_step(double largest, const View& view) {
  // round_length() gives from 2/5 of what it is asked to all of it: 0.8 to 2 times what is wanted.
  const double wanted = std::max(largest / 8.0, 9.0 / view.scale);
  return draw::round_length(2.0 * wanted);
}

/// As PassRenderer counts owners: a body is the owner of its own index (placed_outlines()).
std::uint32_t excluded_owner(const Sheet& sheet) {
  return sheet.excluded < 0 ? FieldImage::kNone : static_cast<std::uint32_t>(sheet.excluded);
}

/// The cells of layers scene and pass, or the pixels of a raw layer, as large as the view. Of layer depth
/// it leaves the full scale on the sheet, for the legend. @throws IoError without a GL context.
Picture background(Sheet& sheet) {
  const std::size_t count = sheet.world.bodies.size();
  const bool raw = sheet.options.layer.kind == Kind::color || sheet.options.layer.kind == Kind::depth;
  std::vector<PlacedOutline> placed = draw::placed_outlines(sheet.world, sheet.bodies, sheet.sites);
  for (std::size_t k = 0, own = placed.size(); k < own; ++k) {  // their images belong to the same owners
    // The first of them is the outline where it stands, which is among `placed` already.
    const std::vector<Vec2> seen = draw::seen_at(sheet, *placed[k].outline, placed[k].pose);
    for (std::size_t i = 1; i < seen.size(); ++i) {
      placed.push_back(placed[k]);
      placed.back().pose.position += seen[i];
    }
  }
  // Raw layers are of one field pixel a picture pixel: a mean of two owners' colours would be nobody's.
  if (!raw)
    return draw::cells_picture(placed, sheet.view, kFineness, excluded_owner(sheet), sheet.options.field,
                               sheet.palette, count,
                               [&](double largest) { return contour_step(largest, sheet.view); });
  const FieldImage field = draw::render_field(placed, sheet.view, excluded_owner(sheet), sheet.options.field);
  if (sheet.options.layer.kind == Kind::color) return draw::ids_picture(field, sheet.palette, count);
  sheet.full_scale = draw::largest_distance(field);
  return draw::distance_picture(field, sheet.full_scale);
}

/// The diagram if there is one to be drawn and a context to draw it.
std::optional<Picture> diagram(Sheet& sheet) {
  // Force chains are read by the widths of lines: cells beneath would be in their way.
  const Kind kind = sheet.options.layer.kind;
  if (kind == Kind::forces) return std::nullopt;
  // Without any site there is nobody to be nearest, and no cell.
  if (kind == Kind::scene &&
      (!sheet.options.diagram || sheet.world.bodies.size() + sheet.world.sites.size() == 0))
    return std::nullopt;
  if (kind == Kind::pass && !sheet.options.diagram) return std::nullopt;
  try {
    return background(sheet);
  } catch (const IoError& error) {
    // Only layer `scene` can do without: the others are the diagram.
    if (kind != Kind::scene) throw;
    log().warn("drawn without the Voronoi diagram: {}", error.what());
    return std::nullopt;
  }
}

/// Opaque, with a darker edge of the same hue.
Ink body_ink(const Oklch& color) {
  const Color line = Palette::line(color).rgb();
  return {color.rgb(), line, 1.4, 1.0, false};
}

/// Beneath lines that are to be seen.
Ink pale_ink(Oklch color) {
  // Halfway to white with a third of the chroma: bodies can still be told apart.
  color.lightness = 0.5 * (color.lightness + 1.0);
  color.chroma *= 0.3;
  Oklch line = color;
  line.lightness = 0.72;
  return {color.rgb(), line.rgb(), 1.0, 1.0, false};
}

/// A line from the centre of mass along the body's own x axis to just inside its edge: how it has turned.
void draw_mark(Canvas& canvas, const Outline& outline, const Pose& pose, const Color& color, double scale) {
  // A wire has no inside that a mark could be drawn in.
  if (outline.bounding_radius * scale < kMarkFrom || !(outline.solid || outline.is_point())) return;
  const Vec2 center = pose.position;
  // The centre must lie two pixels inside: that of a horseshoe is outside of it.
  if (gap_by_brute_force(outline, Vec2::Zero()) > -2.0 / scale) return;
  // In steps along the axis, as outlines may be hollow: the mark ends before the first edge.
  // Each step asks every site of the outline: 64 of them place the end to a sixty-fourth of the radius.
  const double steps = 64.0;
  double reach = 0.0;
  for (int k = 1; k <= steps; ++k) {
    const double x = outline.bounding_radius * k / steps;
    // Half a pixel more than is asked of the centre, so that its end stays clear of the edge's own line.
    if (gap_by_brute_force(outline, Vec2(x, 0.0)) > -2.5 / scale) break;
    reach = x;
  }
  canvas.line(center, Frame(pose).to_world(Vec2(reach, 0.0)), color, 1.2);
  canvas.dot(center, 1.7, color);
}

/// The pose of an image.
Pose shifted(Pose pose, const Vec2& by) {
  pose.position += by;
  return pose;
}

/// The outline, and its images that are seen.
void draw_images(Canvas& canvas, const Sheet& sheet, const Outline& outline, const Pose& pose,
                 const Ink& ink) {
  for (const Vec2& by : draw::seen_at(sheet, outline, pose)) canvas.outline(outline, shifted(pose, by), ink);
}

/// Fixed sites where they stand at the picture's time, solid ones filled, wires by their thickness.
void draw_sites(Canvas& canvas, const Sheet& sheet) {
  const Color line = Tones::ink.rgb();
  Ink solid{Tones::site_fill.rgb(), line, 1.6, 1.0, false};
  // What is outside a container has the paper's tone: nobody can be there.
  Ink outside{Tones::paper.rgb(), line, 2.4, 1.0, false};
  Ink wire{Tones::site_fill.rgb(), line, 2.2, 1.0, false};
  // Containers first: they fill everything outside of them, and would cover the other sites.
  for (const bool container : {true, false})
    for (std::size_t k = 0; k < sheet.world.sites.size(); ++k) {
      const Outline& outline = *sheet.world.sites[k].outline;
      if (outline.container != container) continue;
      draw_images(canvas, sheet, outline, sheet.sites[k], container ? outside : outline.solid ? solid : wire);
    }
}

/// Springs as zigzags; forces of other kinds have no place to be drawn at.
void draw_springs(Canvas& canvas, const Sheet& sheet) {
  const Color color = Oklch{0.45, 0.02, 260.0}.rgb();
  for (const Force& force : sheet.world.forces) {
    const auto* spring = std::get_if<SpringForce>(&force);
    if (spring == nullptr) continue;
    const Vec2 a = Frame(sheet.bodies[spring->body_a].pose).to_world(spring->at_a);
    // The anchor in the world, or a place in the frame of body_b.
    Vec2 b = spring->at_b;
    if (spring->body_b >= 0)
      // Taken back to where the state given had it, before the body was moved home.
      b = Frame(sheet.bodies[spring->body_b].pose).to_world(b) - sheet.moves[spring->body_b];
    // It pulls between the places that are given, however many periods these are apart: its other end is moved as
    // its first one is.
    b += sheet.moves[spring->body_a];
    Box box;
    box.add(a);
    box.add(b);
    for (const Vec2& by : draw::images_of(sheet, box)) canvas.spring(a + by, b + by, color, 1.1);
  }
}

/// All bodies and their images that are seen; a pass's own is left to draw_excluded().
void draw_bodies(Canvas& canvas, const Sheet& sheet) {
  for (std::size_t k = 0; k < sheet.world.bodies.size(); ++k) {
    if (static_cast<int>(k) == sheet.excluded) continue;
    const Outline& outline = *sheet.world.bodies[k].outline;
    const bool pale = sheet.options.layer.kind == Kind::forces;
    const Ink ink = pale ? pale_ink(sheet.palette.body(k)) : body_ink(sheet.palette.body(k));
    for (const Vec2& by : draw::seen_at(sheet, outline, sheet.bodies[k].pose)) {
      const Pose pose = shifted(sheet.bodies[k].pose, by);
      canvas.outline(outline, pose, ink);
      if (!pale) draw_mark(canvas, outline, pose, ink.line, sheet.view.scale);
    }
  }
}

/// The body left out of a pass: its edge dashed, its samples as dots.
void draw_excluded(Canvas& canvas, const Sheet& sheet) {
  const Outline& outline = *sheet.world.bodies[sheet.excluded].outline;
  const Pose& pose = sheet.bodies[sheet.excluded].pose;
  Oklch color = sheet.palette.body(sheet.excluded);
  color.lightness *= 0.8;
  canvas.outline(outline, pose, {color.rgb(), color.rgb(), 1.8, 0.0, true});
  // What exact contacts are searched from; the sample of an arc is its centre.
  for (const Sample& sample : outline.samples) canvas.dot(Frame(pose).to_world(sample.p), 2.6, color.rgb());
}

/// Thin light edges over the depth layer, so that wires and touching solids can be told apart.
void draw_edges(Canvas& canvas, const Sheet& sheet) {
  const Color line = Oklch{0.80, 0.01, 300.0}.rgb();
  const Ink ink{line, line, 0.9, 0.0, false};
  for (std::size_t k = 0; k < sheet.world.sites.size(); ++k)
    draw_images(canvas, sheet, *sheet.world.sites[k].outline, sheet.sites[k], ink);
  for (std::size_t k = 0; k < sheet.world.bodies.size(); ++k)
    draw_images(canvas, sheet, *sheet.world.bodies[k].outline, sheet.bodies[k].pose, ink);
}

/// Fixed wires over the colour layer, where they show as the middle of their cells alone.
void draw_wires(Canvas& canvas, const Sheet& sheet) {
  const Color line = Tones::ink.rgb();
  for (std::size_t k = 0; k < sheet.world.sites.size(); ++k)
    if (!sheet.world.sites[k].outline->solid)
      draw_images(canvas, sheet, *sheet.world.sites[k].outline, sheet.sites[k],
                  {line, line, 1.6, 0.0, false});
}

/// Particles of the classic detector, where a sampling is asked for: dark on the boundary, pale inside.
void draw_particles(Canvas& canvas, const Sheet& sheet) {
  const Color dark = Tones::ink.rgb(), pale = Oklch{0.99, 0.0, 0.0}.rgb();
  for (std::size_t k = 0; k < sheet.world.bodies.size(); ++k) {
    const Body& body = sheet.world.bodies[k];
    // Every body has a sampling. The default kind is not one that was asked for.
    if (body.sampling.kind == Sampling::Kind::vertices || static_cast<int>(k) == sheet.excluded) continue;
    const Frame frame(sheet.bodies[k].pose);
    const std::vector<Vec2> images = draw::seen_at(sheet, *body.outline, sheet.bodies[k].pose);
    for (const Particle& particle : make_particles(*body.outline, body.sampling))
      for (const Vec2& by : images) {
        // Two discs make a rim that is seen on dark and on light ground.
        const bool inside = particle.area > 0.0;
        canvas.dot(frame.to_world(particle.p) + by, 3.8, inside ? dark : pale);
        canvas.dot(frame.to_world(particle.p) + by, 2.6, inside ? pale : dark);
      }
  }
}

/// What is between the diagram and the marks. Raw layers get lines alone: a fill would hide their pixels.
void draw_layer(Canvas& canvas, const Sheet& sheet) {
  switch (sheet.options.layer.kind) {
    case Kind::color:
      draw_wires(canvas, sheet);
      return draw_particles(canvas, sheet);
    case Kind::depth:
      draw_edges(canvas, sheet);
      return draw_particles(canvas, sheet);
    case Kind::forces:
      draw_sites(canvas, sheet);
      draw_bodies(canvas, sheet);
      return draw_forces(canvas, sheet);
    case Kind::scene:
    case Kind::pass:
      draw_sites(canvas, sheet);
      draw::draw_trails(canvas, sheet);
      draw_springs(canvas, sheet);
      draw_bodies(canvas, sheet);
      draw_particles(canvas, sheet);
      if (sheet.excluded >= 0) draw_excluded(canvas, sheet);
  }
}

/// Draws the picture on what `make` makes of its view.
/// Everything of draw_scene() and draw_file() but what becomes of the canvas. `make` is called once, when
/// what is asked for has been checked: a canvas of a file opens that file.
template <class Make>
void draw_with(const World& world, std::span<const BodyState> bodies, std::span<const Pose> sites,
               const DrawOptions& options, Make&& make) {
  check(world, bodies, sites, options);
  // Where a body has gone around the period ten times it is drawn in the one that is looked at. The sheet
  // has spans over both vectors, which outlive it.
  std::vector<BodyState> home(bodies.begin(), bodies.end());
  std::vector<Vec2> moves;
  for (BodyState& state : home) {
    moves.push_back(draw::way_home(world.periods, state.pose.position));
    state.pose.position += moves.back();
  }
  Sheet sheet{world, home, moves, sites, options, Palette(world), -1, 0, View{}, 0.0};
  // In this order: the view is of the excluded body, and of the height that the strip leaves.
  if (options.layer.kind == Kind::pass) sheet.excluded = body_named(world, options.layer.body);
  sheet.strip = draw::strip_height(options);
  sheet.view = view_of(sheet);
  // The sheet must know its view before there is a canvas to draw on; the rest is drawn from below upward.
  Canvas& canvas = make(sheet.view);
  if (const std::optional<Picture> beneath = diagram(sheet)) canvas.paste(*beneath);
  draw_layer(canvas, sheet);
  draw::draw_period(canvas, sheet);
  draw::draw_marks(canvas, sheet);
  draw::draw_caption(canvas, sheet);
}

/// By the extension as it is written: ".PNG" is another one. @throws BadInput naming those that there are.
draw::Paper paper_of(const std::filesystem::path& file) {
  const std::string kind = file.extension().string();
  if (kind == ".png") return {draw::Paper::Kind::pixels, file};
  if (kind == ".svg") return {draw::Paper::Kind::svg, file};
  if (kind == ".pdf") return {draw::Paper::Kind::pdf, file};
  throw BadInput(fmt::format("-o: {} given; allowed: FILE.png, FILE.svg, FILE.pdf", file.string()));
}

}  // namespace

Picture draw_scene(const World& world, std::span<const BodyState> bodies, std::span<const Pose> sites,
                   const DrawOptions& options) {
  // Made by the call that knows the view; what it holds when that is over is the picture.
  std::optional<Canvas> canvas;
  draw_with(world, bodies, sites, options, [&](const View& view) -> Canvas& {
    return canvas.emplace(view, options.size.width, options.size.height, Tones::paper.rgb());
  });
  return canvas->finish();
}

void require_picture_name(const std::filesystem::path& file) { paper_of(file); }

void draw_file(const std::filesystem::path& file, const World& world, std::span<const BodyState> bodies,
               std::span<const Pose> sites, const DrawOptions& options) {
  const draw::Paper paper = paper_of(file);
  if (paper.kind == draw::Paper::Kind::pixels) return draw_png(file, world, bodies, sites, options);
  std::optional<Canvas> canvas;
  draw_with(world, bodies, sites, options, [&](const View& view) -> Canvas& {
    return canvas.emplace(view, options.size.width, options.size.height, Tones::paper.rgb(), paper);
  });
  canvas->finish_file();
}

void draw_png(const std::filesystem::path& file, const World& world, std::span<const BodyState> bodies,
              std::span<const Pose> sites, const DrawOptions& options) {
  write_png(file, draw_scene(world, bodies, sites, options));
}

}  // namespace brink
