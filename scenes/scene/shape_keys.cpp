// The shapes of a scene file: each one's own table, and how it is built.
#include <cmath>
#include <numbers>

#include "brink/scenes/scene/tables.h"

namespace brink {
namespace {

// As kShortest in tables.cpp [m].
constexpr double kShortestLength = 1e-12;

// A struct a shape, all lengths in metres in the shape's own frame. What is Given may also be said
// beside the shape.
struct DiscTable {
  double radius = 0.0;
};
struct BoxTable {
  double width = 0.0, height = 0.0;
  Given<double> radius;
};
struct VerticesTable {
  std::vector<Vec2> vertices;
  bool closed = false;
  Given<double> radius;
};
struct CapsuleTable {
  double length = 0.0, radius = 0.0;
};
struct PathTable {
  std::string d;
  double scale = 1.0;
};
struct SamplesTable {
  std::string file;
};
struct ArcTable {
  Vec2 center = Vec2::Zero();
  double radius = 0.0;
  Given<double> from, to, from_deg, to_deg;
};

Codec<double> length() { return number(positive("m", kShortestLength)); }
Codec<double> thickness() { return number(not_negative("m")); }

const Schema<DiscTable>& disc_schema() {
  static const Schema<DiscTable> schema =
      Schema<DiscTable>("disc").required("radius", &DiscTable::radius, length(), "radius");
  return schema;
}
const Schema<BoxTable>& box_schema() {
  static const Schema<BoxTable> schema =
      Schema<BoxTable>("box")
          .required("width", &BoxTable::width, length(), "along x")
          .required("height", &BoxTable::height, length(), "along y")
          .optional("radius", &BoxTable::radius, thickness(), "0", "rounds outward");
  return schema;
}
const Schema<VerticesTable>& polygon_schema() {
  static const Schema<VerticesTable> schema =
      Schema<VerticesTable>("polygon")
          .required("vertices", &VerticesTable::vertices, points(3), "a simple polygon, either way round")
          .optional("radius", &VerticesTable::radius, thickness(), "0", "rounds outward");
  return schema;
}
// A part of `polygons`, which takes no radius: the union has sharp corners.
const Schema<VerticesTable>& part_schema() {
  static const Schema<VerticesTable> schema =
      Schema<VerticesTable>("polygons")
          .required("vertices", &VerticesTable::vertices, points(3), "one part of the union");
  return schema;
}
const Schema<CapsuleTable>& capsule_schema() {
  static const Schema<CapsuleTable> schema =
      Schema<CapsuleTable>("capsule")
          .required("length", &CapsuleTable::length, length(), "of the core, along x, centred")
          .required("radius", &CapsuleTable::radius, length(), "thickness");
  return schema;
}
const Schema<VerticesTable>& chain_schema() {
  static const Schema<VerticesTable> schema =
      Schema<VerticesTable>("chain")
          .required("vertices", &VerticesTable::vertices, points(2), "a wire through these")
          .key("closed", &VerticesTable::closed, flag(), "a ring, hollow")
          .optional("radius", &VerticesTable::radius, thickness(), "0", "thickness");
  return schema;
}
const Schema<PathTable>& path_schema() {
  static const Schema<PathTable> schema =
      Schema<PathTable>("path")
          .required("d", &PathTable::d, text("string of SVG path data"), "SVG path data, turned upward")
          .key("scale", &PathTable::scale, number({1e-9, 1e9, false, "m per unit"}), "size of an SVG unit");
  return schema;
}
const Schema<SamplesTable>& samples_schema() {
  static const Schema<SamplesTable> schema = Schema<SamplesTable>("samples").required(
      "file", &SamplesTable::file, text("file name"), "the classic text data file, beside the scene file");
  return schema;
}
// Each angle in degrees or in radians, not in both: see build_arc().
const Schema<ArcTable>& arc_schema() {
  static const Schema<ArcTable> schema =
      Schema<ArcTable>("arc")
          .key("center", &ArcTable::center, point(), "of the circle")
          .required("radius", &ArcTable::radius, length(), "of the circle")
          .optional("from_deg", &ArcTable::from_deg, number(between(-1e6, 1e6, "degrees")), "0",
                    "where it starts")
          .optional("to_deg", &ArcTable::to_deg, number(between(-1e6, 1e6, "degrees")), "360",
                    "where it ends, counter-clockwise from the start")
          .optional("from", &ArcTable::from, number(between(-1e5, 1e5, "rad")), "0", "from_deg in radians")
          .optional("to", &ArcTable::to, number(between(-1e5, 1e5, "rad")), "2 pi", "to_deg in radians");
  return schema;
}

/// A thickness in the shape's own table goes before the one beside it.
/// That both are given is no fault.
double own_or(const Given<double>& own, const ShapeContext& context) {
  return own.given ? own.value : context.radius;
}

// One shape key: reads `V` with `codec` and adds a ShapeSpec made of `spec` and `build(value, context)`.
// The value is read now and built later, as the thickness beside it may stand in a later line of the
// file.
template <class V, class Build>
void add_shape(Schema<ThingTable>& schema, ShapeSpec spec, const Codec<V>& codec, const std::string& meaning,
               Build build) {
  schema.custom(
      spec.kind, codec.type, "", meaning, [=](const toml::node& node, TomlDocument& doc, ThingTable& out) {
        ShapeSpec made = spec;
        made.where = doc.where(node);
        V value = blank<V>();
        if (codec.read(node, doc, spec.kind, value)) {
          made.parameters = codec.write(value);
          made.build = [value, build](const ShapeContext& context) { return build(value, context); };
        }
        out.shapes.push_back(std::move(made));  // without build: known to be asked for, but faulty
      });
}

// Which keys beside the shape have a meaning: a thickness, a curve tolerance, or that it is for sites alone.
// ShapeBuilder::fits() tells those that have none.
ShapeSpec shape_kind(std::string kind) {
  ShapeSpec spec;
  spec.kind = std::move(kind);
  return spec;
}
ShapeSpec thick(std::string kind) {
  ShapeSpec spec = shape_kind(std::move(kind));
  spec.takes_radius = true;
  return spec;
}
ShapeSpec curved(ShapeSpec spec) {
  spec.takes_curve_tolerance = true;
  return spec;
}
ShapeSpec site_only(std::string kind) {
  ShapeSpec spec = thick(std::move(kind));
  spec.for_bodies = false;
  return spec;
}

// polygons = [{vertices}, ...]
Codec<std::vector<VerticesTable>> parts_codec() {
  return {
      "[{vertices}, ...]",
      [](const toml::node& node, TomlDocument& doc, const std::string& key, std::vector<VerticesTable>& out) {
        const toml::array* array = node.as_array();
        if (array == nullptr || array->empty()) {
          doc.faults().add(doc.where(node), fault_text(key, "wrong type", given(node),
                                                       "an array of one or more {vertices = [[x, y], ...]}"));
          return false;
        }
        // The array is faulty if any of its parts is, but every part is read.
        const std::size_t faults = doc.faults().size();
        for (const toml::node& element : *array) part_schema().read_node(element, doc, out.emplace_back());
        return doc.faults().size() == faults;
      },
      [](const std::vector<VerticesTable>& parts) {
        Json json = Json::array();
        for (const VerticesTable& part : parts) json.push_back(part_schema().json(part));
        return json;
      }};
}

/// @throws BadInput where a part is no simple polygon.
Shape build_polygons(const std::vector<VerticesTable>& parts) {
  std::vector<std::vector<Vec2>> polygons;
  for (const VerticesTable& part : parts) polygons.push_back(part.vertices);
  return make_polygons(polygons);
}

Shape build_arc(const ArcTable& arc, const ShapeContext& context) {
  constexpr double degree = std::numbers::pi / 180.0;
  // Left to the building, as it concerns two keys: the fault stands at the shape.
  if ((arc.from.given && arc.from_deg.given) || (arc.to.given && arc.to_deg.given))
    throw BadInput("arc: angles are given twice; given radians and degrees, allowed: one of them");
  // What is not given is 0, and for the end the whole turn.
  const double from = arc.from.given ? arc.from.value : arc.from_deg.value * degree;
  const double to = arc.to.given ? arc.to.value : (arc.to_deg.given ? arc.to_deg.value : 360.0) * degree;
  return make_arc(arc.center, arc.radius, from, to, context.radius);
}

/// An open wire through the points; a site alone may have it under this name.
Shape build_polyline(const std::vector<Vec2>& vertices, const ShapeContext& context) {
  return make_chain(vertices, false, context.radius);
}

/// Shapes that bodies and sites have. Each says with which builder of core/shapes/shapes.h it is made;
/// what the builder refuses is a fault at the key.
void add_body_shapes(Schema<ThingTable>& schema) {
  add_shape(schema, shape_kind("disc"), disc_schema().codec(), "a disc",
            [](const DiscTable& t, const ShapeContext& c) {
              return c.inside_of ? make_disc_container(t.radius) : make_disc(t.radius);
            });
  add_shape(schema, thick("box"), box_schema().codec(), "a rectangle, centred",
            [](const BoxTable& t, const ShapeContext& c) {
              return make_box(t.width, t.height, own_or(t.radius, c));
            });
  add_shape(schema, thick("polygon"), polygon_schema().codec(), "a simple polygon, need not be convex",
            [](const VerticesTable& t, const ShapeContext& c) {
              return make_polygon(t.vertices, own_or(t.radius, c));
            });
  add_shape(
      schema, shape_kind("polygons"), parts_codec(), "the union of simple polygons, one rigid body",
      [](const std::vector<VerticesTable>& parts, const ShapeContext&) { return build_polygons(parts); });
  add_shape(schema, shape_kind("capsule"), capsule_schema().codec(), "a thick segment",
            [](const CapsuleTable& t, const ShapeContext& c) {
              return c.inside_of ? make_capsule_container(t.length, t.radius)
                                 : make_capsule(t.length, t.radius);
            });
  add_shape(schema, thick("chain"), chain_schema().codec(), "a wire",
            [](const VerticesTable& t, const ShapeContext& c) {
              return make_chain(t.vertices, t.closed, own_or(t.radius, c));
            });
  add_shape(
      schema, curved(shape_kind("path")), path_schema().codec(), "an outline from SVG path data",
      [](const PathTable& t, const ShapeContext& c) { return make_path(t.d, t.scale, c.curve_tolerance); });
  // Not by add_shape(): how it is built is in another file, which is read once the scene's folder is known.
  schema.custom("samples", samples_schema().codec().type, "", "the classic text data file",
                [](const toml::node& node, TomlDocument& doc, ThingTable& out) {
                  ShapeSpec made = shape_kind("samples");
                  made.where = doc.where(node);
                  SamplesTable table;
                  if (samples_schema().codec().read(node, doc, "samples", table)) made.data_file = table.file;
                  out.shapes.push_back(std::move(made));  // its build comes with the file: take_sample_files
                });
}

/// Shapes that sites alone have: places in the site's frame, felt from both sides, thick by the
/// `radius` beside them.
void add_site_shapes(Schema<ThingTable>& schema) {
  add_shape(schema, site_only("point"), point(), "a point, or with a radius a disc",
            [](const Vec2& p, const ShapeContext& c) { return make_point(p, c.radius); });
  add_shape(
      schema, site_only("segment"), points(2, 2), "a straight wall, felt from both sides",
      [](const std::vector<Vec2>& p, const ShapeContext& c) { return make_segment(p[0], p[1], c.radius); });
  add_shape(schema, site_only("polyline"), points(2), "connected straight walls", build_polyline);
  add_shape(schema, site_only("arc"), arc_schema().codec(), "a circular arc, felt from both sides",
            build_arc);
  add_shape(schema, curved(site_only("bezier")), points(4, 4), "a cubic Bezier curve",
            [](const std::vector<Vec2>& p, const ShapeContext& c) {
              return make_bezier({p[0], p[1], p[2], p[3]}, c.curve_tolerance, c.radius);
            });
}

}  // namespace

/// All shapes are keys of the entry itself, so that two of them can be told as two
/// (ShapeBuilder::build).
void add_shape_keys(Schema<ThingTable>& schema, bool site) {
  add_body_shapes(schema);
  if (site) add_site_shapes(schema);
}

// Shapes whose value is no table (point, segment, polyline, bezier) have no keys of their own to list.
void list_shape_keys(std::vector<OptionInfo>& out) {
  disc_schema().list(out);
  box_schema().list(out);
  polygon_schema().list(out);
  part_schema().list(out);
  capsule_schema().list(out);
  chain_schema().list(out);
  path_schema().list(out);
  samples_schema().list(out);
  arc_schema().list(out);
}

}  // namespace brink
