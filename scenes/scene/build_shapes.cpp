#include "brink/core/base/error.h"
#include "brink/scenes/scene/build.h"

namespace brink {
namespace {

/// The shapes that an entry may have, for a message.
std::vector<std::string> shape_words(bool body) {
  static const std::vector<std::string> solid{"disc",    "box",   "polygon", "polygons",
                                              "capsule", "chain", "path",    "samples"};
  std::vector<std::string> out = solid;
  if (!body)
    for (const char* word : {"point", "segment", "polyline", "arc", "bezier"}) out.emplace_back(word);
  return out;
}

}  // namespace

/// One outline for all entries that ask for the same shape: the solver then has one field for all of
/// them.
std::optional<BuiltShape> ShapeBuilder::build(const ThingTable& thing, const std::string& name, bool body) {
  // Shapes are keys of the entry itself, so a table may have several, or none. The fault of several
  // stands at the second one.
  if (thing.shapes.size() != 1) {
    std::vector<std::string> asked;
    for (const ShapeSpec& spec : thing.shapes) asked.push_back(spec.kind);
    faults_.add(asked.empty() ? thing.place : thing.shapes[1].where,
                in_quotes(name) + " needs exactly one shape; given " +
                    (asked.empty() ? "none" : listed(asked)) + ", allowed: one of " +
                    listed(shape_words(body)));
    return std::nullopt;
  }
  const ShapeSpec& spec = thing.shapes[0];
  // A shape without `build` was faulty already (add_shape).
  if (!spec.build || !fits(thing, spec, body)) return std::nullopt;
  // The entry's own tolerance goes before that of [field].
  ShapeContext context{thing.curve_tolerance.given ? thing.curve_tolerance.value : curve_tolerance_,
                       thing.radius.value, thing.inside_of.value};
  // A body's outline always is: what `centered = false` moves is where it stands, not its frame.
  const bool about_centre = body || thing.centered.value;
  // Everything that make() depends on; equal keys share one outline, and with it one field.
  const Json key = {spec.kind,      spec.parameters,
                    context.radius, spec.takes_curve_tolerance ? context.curve_tolerance : 0.0,
                    about_centre,   thing.inside_of.value};
  // JSON throws on what is no UTF-8, which an override may bring in: such bytes become
  // replacement characters.
  const std::string text = key.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (const auto found = built_.find(text); found != built_.end()) return found->second;
  std::optional<BuiltShape> made = make(thing, spec, context, about_centre);
  if (!made) return std::nullopt;
  // Told of the first thing of each distinct shape.
  if (made->outline->curve_deviation > 0.0)
    notes_.push_back(name + ": " + spec.kind + " is drawn by " + std::to_string(made->outline->sites.size()) +
                     " sites within " + number_text(made->outline->curve_deviation) + " m of its curves");
  return built_.emplace(text, *made).first->second;
}

/// True if all keys beside the shape mean something to it; all that do not are told.
bool ShapeBuilder::fits(const ThingTable& thing, const ShapeSpec& spec, bool body) {
  const std::size_t before = faults_.size();
  if (thing.radius.given && !spec.takes_radius)
    faults_.add(thing.radius.where,
                "radius: has no meaning beside " + spec.kind + "; given " + number_text(thing.radius.value) +
                    ", allowed beside: box, polygon, chain, point, segment, polyline, arc, bezier");
  if (thing.curve_tolerance.given && !spec.takes_curve_tolerance)
    faults_.add(thing.curve_tolerance.where, "curve_tolerance: has no meaning beside " + spec.kind +
                                                 "; given " + number_text(thing.curve_tolerance.value) +
                                                 ", allowed beside: path, bezier");
  if (!body && thing.centered.given && thing.centered.value && !spec.for_bodies)
    faults_.add(thing.centered.where, "centered: has no meaning beside " + spec.kind +
                                          "; given true, allowed: false, or true beside a body's shape");
  // By the word: whether a path is closed is known when it is built, and as_container() refuses it
  // then.
  const bool closed = spec.kind == "disc" || spec.kind == "box" || spec.kind == "polygon" ||
                      spec.kind == "polygons" || spec.kind == "path" || spec.kind == "capsule";
  if (thing.inside_of.value && !closed)
    faults_.add(thing.inside_of.where, "inside_of: " + spec.kind +
                                           " has no inside; given true, allowed beside: disc, box, polygon, "
                                           "polygons, capsule, path");
  return faults_.size() == before;
}

/// Builds the shape, in this order: about its centre if asked for, then inside out if asked for.
std::optional<BuiltShape> ShapeBuilder::make(const ThingTable& thing, const ShapeSpec& spec,
                                             const ShapeContext& context, bool about_centre) {
  try {
    // Measured before it is turned inside out: a container has the measure of its free inside.
    Shape shape = spec.build(context);
    BuiltShape built;
    if (about_centre) {
      built.shift = shape.measure.centroid;
      shape = centered(std::move(shape));
    }
    // Discs and capsules are made as containers at once (make_disc_container), of arcs in place of points and thickness.
    if (thing.inside_of.value && !shape.outline.container)
      shape.outline = as_container(std::move(shape.outline));
    built.measure = shape.measure;
    built.outline = std::make_shared<const Outline>(std::move(shape.outline));
    return built;
  } catch (const BadInput& error) {
    // What a shape refuses (sides that cross, no area) stands at its key.
    faults_.add(spec.where, error.what());
  }
  return std::nullopt;
}

}  // namespace brink
