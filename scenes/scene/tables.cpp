/// The keys of every table but those of shapes (shape_keys.cpp) and forces (force_keys.cpp), each
/// table's in the order in which `brink list options` and docs/scene-format.md have them. A new key is
/// a member of the struct, a line in its schema here, and a row on the page; reading, faults and lists
/// follow from the schema.
#include "brink/scenes/scene/tables.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace brink {
namespace {

constexpr double kHeaviest = 1e40;  // masses, stiffnesses: products with squares of lengths stay finite
constexpr double kLightest = 1e-40;
constexpr double kShortest = 1e-12;  // [m], [s]

/// The names in a list of choices that the scheduler or the integrators keep: so the file's words are
/// theirs.
template <class Info>
std::vector<std::string> names_of(std::span<const Info> infos) {
  std::vector<std::string> out;
  for (const Info& info : infos) out.emplace_back(info.name);
  return out;
}

const std::vector<std::string> kCombineRules{"max", "min", "mean", "geometric_mean", "product"};

/// An integer, 0 or more unless told otherwise.
Codec<std::int64_t> whole(std::int64_t low = 0,
                          std::int64_t high = std::numeric_limits<std::int64_t>::max()) {
  return integer(low, high);
}

/// Masses, densities and inertias. Bounded from below as well, since motions are made with their
/// inverses.
Range heavy(std::string unit) { return {kLightest, kHeaviest, false, std::move(unit)}; }

/// An entry that is no table is left out; one with faulty keys stays, so that what names it is
/// not faulty, too.
void read_materials(const toml::node& node, TomlDocument& doc, FileTable& out) {
  const toml::table* table = node.as_table();
  if (table == nullptr)
    return doc.faults().add(doc.where(node), fault_text("materials", "wrong type", given(node),
                                                        "one table a material, [materials.NAME]"));
  for (const auto& [name, value] : *table) {
    MaterialTable entry;
    entry.where = doc.where(name, value);
    if (!material_schema().read_node(value, doc, entry.material)) continue;
    entry.material.name = std::string(name.str());
    out.materials.push_back(std::move(entry));
  }
}

// Calls read(table) for every table of an array of tables.
// What is no table is a fault and is passed over: the others are still read.
template <class Read>
void for_each_table(const std::string& key, const toml::node& node, TomlDocument& doc, Read&& read) {
  const std::string allowed = "an array of tables, [[" + key + "]]";
  const toml::array* array = node.as_array();
  if (array == nullptr)
    return doc.faults().add(doc.where(node), fault_text(key, "wrong type", given(node), allowed));
  for (const toml::node& element : *array) {
    if (const toml::table* table = element.as_table())
      read(*table);
    else
      doc.faults().add(doc.where(element), fault_text(key, "wrong type", given(element), allowed));
  }
}

/// Reader of `[[bodies]]` or `[[sites]]`. An entry with faults stays in the list, so that those behind
/// it keep the names that they have by their place.
auto things_reader(const std::string& key, const Schema<ThingTable>& schema,
                   std::vector<ThingTable> FileTable::*member) {
  return [&schema, key, member](const toml::node& node, TomlDocument& doc, FileTable& out) {
    for_each_table(key, node, doc, [&](const toml::table& table) {
      ThingTable thing;
      thing.place = doc.where(table);
      schema.read(table, thing.place, doc, thing);
      (out.*member).push_back(std::move(thing));
    });
  };
}

/// A force's kind says which keys it may have: it is read before the others.
void read_force(const toml::table& table, TomlDocument& doc, std::vector<ForceTable>& out) {
  ForceTable force;
  force.place = doc.where(table);
  const toml::node* kind = table.get("kind");
  const Codec<std::string> kinds = choice(force_kinds());
  if (kind == nullptr)
    return doc.faults().add(force.place, "forces: kind is missing; given nothing, allowed: " + kinds.type);
  if (!kinds.read(*kind, doc, "kind", force.kind)) return;
  force_schema(force.kind)->read(table, force.place, doc, force);
  out.push_back(std::move(force));
}

/// Reader of a table that there is once. Its places are kept for faults that are found later. The schema is one of those
/// with a static life: the reader keeps a reference.
template <class T>
auto table_reader(const Schema<T>& schema, T FileTable::*member) {
  return [&schema, member](const toml::node& node, TomlDocument& doc, FileTable& out) {
    const std::size_t before = doc.faults().size();
    schema.read_node(node, doc, out.*member);
    if (doc.faults().size() > before) out.faulty.insert(schema.table());
    out.places[schema.table()] = doc.where(node);
    if (const toml::table* table = node.as_table())
      for (const auto& [key, value] : *table)
        out.places[schema.table() + '.' + std::string(key.str())] = doc.where(value);
  };
}

// Each schema is built when it is first asked for: those that hold codecs of others find them whole.
const Schema<GridTable>& grid_schema() {
  static const Schema<GridTable> schema =
      Schema<GridTable>("grid")
          .required("columns", &GridTable::columns, whole(1, 100000), "copies along x")
          .key("rows", &GridTable::rows, whole(1, 100000), "copies along y")
          .required("spacing", &GridTable::spacing, point(), "from copy to copy [dx, dy]");
  return schema;
}

const Schema<ScatterTable>& scatter_schema() {
  static const Schema<ScatterTable> schema =
      Schema<ScatterTable>("scatter")
          .required("count", &ScatterTable::count, whole(1, 1'000'000), "number of copies")
          .required("region", &ScatterTable::region, points(2, 2),
                    "two opposite corners of the box that holds the position of every copy")
          .key("speed", &ScatterTable::speed, number(not_negative("m/s")),
               "speed of each copy in a random direction, added to velocity")
          .key("angular_speed", &ScatterTable::angular_speed, number(not_negative("rad/s")),
               "angular speed of each copy, either way round at random, added to angular_velocity")
          .key("random_angle", &ScatterTable::random_angle, flag(), "turn each copy by a random angle");
  return schema;
}

const Schema<PileTable>& pile_schema() {
  static const Schema<PileTable> schema =
      Schema<PileTable>("pile")
          .required("count", &PileTable::count, whole(1, 1'000'000), "number of copies")
          .required("width", &PileTable::width, number(positive("m", kShortest)),
                    "of the column that holds the position of every copy, about position")
          .key("random_angle", &PileTable::random_angle, flag(), "turn each copy by a random angle");
  return schema;
}

const Schema<SamplingTable>& sampling_schema() {
  static const Schema<SamplingTable> schema =
      Schema<SamplingTable>("sampling")
          .key("kind", &SamplingTable::kind, choice({"vertices", "boundary", "volume", "random", "raster"}),
               "where the classic detector puts its samples; the exact detectors do not use it")
          .key("spacing", &SamplingTable::spacing, number(not_negative("m")),
               "distance between samples; raster: side of a pixel")
          .key(
              "count", &SamplingTable::count, whole(0, kMostParticles),
              "in place of spacing: samples along the boundary; volume, raster: cells along the longer side");
  return schema;
}

const Schema<MotionTable>& motion_schema() {
  static const Schema<MotionTable> schema =
      Schema<MotionTable>("motion")
          .optional("velocity", &MotionTable::velocity, point("m/s"), "[0, 0]", "constant velocity")
          .optional("angular_velocity", &MotionTable::angular_velocity, number(any("rad/s")), "0",
                    "constant angular velocity")
          .optional("x", &MotionTable::x, formula_text(), "0", "shift along x [m] as a formula in t [s]")
          .optional("y", &MotionTable::y, formula_text(), "0", "shift along y [m] as a formula in t [s]")
          .optional("angle", &MotionTable::angle, formula_text(), "0", "turn [rad] as a formula in t [s]");
  return schema;
}

// What bodies and sites share.
Schema<ThingTable> thing_schema(const std::string& table, bool site) {
  Schema<ThingTable> schema(table);
  schema.optional("name", &ThingTable::name, text("name"), site ? "siteK" : "bodyK",
                  "how results and forces call it; unique; K counts from 0");
  add_shape_keys(schema, site);
  schema
      .optional("position", &ThingTable::position, point(), "[0, 0]",
                site ? "of the shape's frame in the world" : "of the centre of mass in the world")
      .optional("angle", &ThingTable::angle, number(any("rad")), "0", "counter-clockwise")
      .optional("angle_deg", &ThingTable::angle_deg, number(any("degrees")), "0", "the same in degrees")
      .optional("material", &ThingTable::material, text("name of a material"), "\"default\"",
                "a name of [materials]")
      .optional("centered", &ThingTable::centered, flag(), site ? "false" : "true",
                "true: position is of the centre of mass; false: of the origin of the shape's frame")
      .optional("radius", &ThingTable::radius, number(not_negative("m")), "0",
                site ? "thickness all round: of box, polygon, chain, point, segment, polyline, arc and bezier"
                     : "thickness all round: of box, polygon and chain")
      .optional("curve_tolerance", &ThingTable::curve_tolerance, number(positive("m", 1e-9)),
                "[field] curve_tolerance", "largest distance between a curve and the arcs that stand for it")
      .optional("grid", &ThingTable::grid, grid_schema().codec(), "none", "copies in rows, named NAME[k]")
      .optional("scatter", &ThingTable::scatter, scatter_schema().codec(), "none",
                "copies at random without overlaps, named NAME[k]")
      .optional("stack", &ThingTable::stack, whole(1, 1'000'000), "none",
                "so many copies on one another, named NAME[k]")
      .optional("pyramid", &ThingTable::pyramid, whole(1, 1'000), "none",
                "copies in touching rows, so many in the lowest, one less in each above")
      .optional("wall", &ThingTable::wall, two_integers(1, 100'000, "[columns, rows]"), "none",
                "copies in touching rows, each shifted by half a copy, every second one shorter by one")
      .optional("pile", &ThingTable::pile, pile_schema().codec(), "none",
                "copies at random without overlaps above position, to fall");
  return schema;
}

}  // namespace

// @pre a word of kCombineRules, which is all that the schema lets through.
Combine combine_rule(const std::string& name) {
  const auto found = std::find(kCombineRules.begin(), kCombineRules.end(), name);
  return static_cast<Combine>(found - kCombineRules.begin());  // kCombineRules is in the order of Combine
}

Where FileTable::place_of(const std::string& table, const std::string& key) const {
  for (const std::string& path : {table + '.' + key, table})
    if (const auto found = places.find(path); found != places.end()) return found->second;
  return {1, 1};
}

Range duration_range() { return {kShortest, kLongestRun, false, "s"}; }

/// Frames at 0, at every interval, and at the end. A world without bodies has frames, too.
std::string too_many_frames(const OutputOptions& output, double duration, std::size_t bodies) {
  if (output.frame_interval <= 0.0) return {};
  // In doubles: a duration of 1e12 s at intervals of 1e-300 s is too many, and not an overflow.
  const double frames = std::floor(duration / output.frame_interval) + 2.0;  // and the first and the last
  const double rows = frames * static_cast<double>(std::max<std::size_t>(bodies, 1));
  if (rows <= static_cast<double>(output.max_frame_rows)) return {};
  return "too many rows of frames; given " + number_text(rows) + " (" + number_text(duration) +
         " s, frame_interval " + number_text(output.frame_interval) + " s, " + std::to_string(bodies) +
         " bodies), allowed: " + std::to_string(output.max_frame_rows) +
         "; a longer output.frame_interval makes fewer (0: none), output.max_frame_rows allows more";
}

// Defaults are those of the library's own structs (tables.h), so a program that makes a World by hand
// and a file that says nothing mean the same.
const Schema<WorldTable>& world_schema() {
  static const Schema<WorldTable> schema =
      Schema<WorldTable>("world")
          .key("duration", &WorldTable::duration, number(duration_range()), "simulated time")
          .key("gravity", &WorldTable::gravity, point("m/s^2"), "uniform acceleration")
          .key("periodic", &WorldTable::periodic, point(not_negative("m")),
               "the plane repeats after so much to the right and up; 0: never")
          .count("seed", &WorldTable::seed, whole(), "of everything that is drawn at random")
          .key("restitution_rule", &WorldTable::restitution_rule, choice(kCombineRules),
               "how the restitutions of two materials make one")
          .key("friction_rule", &WorldTable::friction_rule, choice(kCombineRules),
               "how the frictions of two materials make one");
  return schema;
}

const Schema<SolverOptions>& solver_schema() {
  using S = SolverOptions;
  static const Schema<S> schema =
      Schema<S>("solver")
          // An open choice: a program may register policies of its own before it reads a file.
          .key("policy", &S::policy, open_choice([] { return names_of<Choice>(policies()); }),
               "who is tested next, advanced and backed up")
          .key("order", &S::order, choice(names_of(orders())),
               "which of several simultaneous contacts is resolved first, or that they are taken together")
          .key("integrator", &S::integrator, choice(names_of(integrators())),
               "how bodies move between contacts")
          .key("tolerance", &S::tolerance, number({1e-14, 0.1, false, ""}), "relative, adaptive integrators")
          .key("absolute_tolerance", &S::absolute_tolerance, number({1e-18, 1.0, false, ""}),
               "in SI units, adaptive integrators")
          .key("step", &S::step, number({1e-9, 1e6, false, "s"}),
               "step of fixed-step integrators, of policy fixed_step and of detector depth")
          .key("response", &S::response, choice(names_of(responses())), "what a collision does")
          .key("detector", &S::detector, choice(names_of(detectors())), "how contacts are found")
          .key("contact_tolerance", &S::contact_tolerance, number({1e-14, 1e-2, false, ""}),
               "gap that counts as contact, of the scene's length")
          .key("persistent", &S::persistent, flag(), "contacts may last; false: a Zeno point ends the run")
          .count("modes_contacts", &S::modes_contacts, whole(),
                 "few bodies with at most so many contacts that last move to `tolerance`, others to first "
                 "order; "
                 "where forces change with place, velocity or time 16 at least")
          .key("island_tolerance", &S::island_tolerance, number(between(0.0, 1e6, "m")),
               "what a step of first order may be off in place; 0: steps as long as a fall by the smallest "
               "allows")
          .key("rest_speed", &S::rest_speed, number(between(0.0, 1e6, "m/s")),
               "what lasting contacts hold is taken to be at rest below this speed; 0: only what is at rest")
          .count("kept_states", &S::kept_states, whole(),
                 "policy timewarp: former states of bodies that are kept to go back to, at most")
          .count("max_collisions", &S::max_collisions, whole(), "stop after this many; 0: no limit")
          .key("closed_forms", &S::closed_forms, flag(), "use closed forms where a pair has them")
          .key("broad_phase", &S::broad_phase, flag(), "test only pairs whose moving bounds meet")
          .key("share_fields", &S::share_fields, flag(), "one field a distinct shape, not one a body")
          .key("fields_for_small_shapes", &S::fields_for_small_shapes, flag(),
               "a field, not brute force, for shapes of few sites, too")
          // Keys of before: a file that has one is told the new name, and of the last that its
          // meaning has changed.
          .former("skip_closed_forms", "closed_forms")
          .former("skip_broad_phase", "broad_phase")
          .former("skip_shared_fields", "share_fields")
          .former("skip_fields", "fields_for_small_shapes", ", with the opposite meaning");
  return schema;
}

// Two structs make one table: what the solver takes, and the tolerance of curves, which the shapes
// take.
const Schema<FieldTable>& field_schema() {
  using F = FieldOptions;
  static const Schema<F> options =
      Schema<F>("field")
          .count("resolution", &F::resolution, whole(0, 1024),
                 "pixels along the longer side of a body field; 0: chosen by shape")
          .key("band", &F::band, number(not_negative("m")),
               "width of the band drawn around a shape; 0: chosen by shape")
          .key("primitives", &F::primitives, choice({"exact", "mesh"}),
               "what is drawn for a site of a pass window: its distance, or cones and tents")
          .key("mesh_error", &F::mesh_error, number({1e-4, 10.0, false, "pixels"}),
               "mesh: how far a cone or tent may be off the distance")
          .key("readback", &F::readback, choice({"full", "window", "pixel"}), "what is read of a pass window")
          .key("passes", &F::passes, choice({"each", "two_layers"}),
               "detector depth: a picture for each body, or two for all")
          .key("truncated", &F::truncated, flag(),
               "detector depth: draw sites only as far as a contact can be; false: everywhere")
          .key("context", &F::context, choice({"auto", "osmesa", "egl"}), "who renders")
          .count("brute_force_below", &F::brute_force_below, whole(0, 1'000'000),
                 "shapes of fewer sites need no field")
          .count("list_cap", &F::list_cap, whole(1, 254), "longest candidate list of a pixel");
  static const Schema<FieldTable> schema =
      Schema<FieldTable>("field")
          .nested(&FieldTable::options, options)
          .key("curve_tolerance", &FieldTable::curve_tolerance, number(positive("m", 1e-9)),
               "largest distance between a curve and the arcs that stand for it");
  return schema;
}

const Schema<OutputOptions>& output_schema() {
  static const Schema<OutputOptions> schema =
      Schema<OutputOptions>("output")
          .key("frame_interval", &OutputOptions::frame_interval, number({0.0, 1e12, false, "s"}),
               "time between frames; 0: events only")
          .key("max_frame_rows", &OutputOptions::max_frame_rows, whole(1),
               "frames times bodies that a run may record; some 70 bytes each")
          .key("max_knots", &OutputOptions::max_knots, whole(0),
               "states within islands that a run records, some 90 bytes each; of more the first ones")
          .key("events", &OutputOptions::events, flag(), "record events");
  return schema;
}

const Schema<Material>& material_schema() {
  static const Schema<Material> schema =
      Schema<Material>("materials")
          .key("restitution", &Material::restitution, number(between(0.0, 1.0)),
               "Newton's, of the normal speed")
          .key("friction", &Material::friction, number(between(0.0, 1e6)), "Coulomb's")
          .key("tangential_restitution", &Material::tangential_restitution, number(between(-1.0, 1.0)),
               "with friction; 0: plain Coulomb, 1: the elastic rough superball")
          .key("rolling_resistance", &Material::rolling_resistance, number(between(0.0, 1e6, "m")),
               "contacts that last: the largest torque against rolling, for a normal force of 1 N; of two "
               "materials the larger")
          .key("slip", &Material::slip, number(between(0.0, 10.0)),
               "reflection only: scales the tangential rebound")
          .key("spin", &Material::spin, number(between(0.0, 10.0)),
               "reflection only: scales the angular rebound");
  return schema;
}

// No mass and no velocities: a key of them beside a site is unknown, and told so.
const Schema<ThingTable>& site_schema() {
  static const Schema<ThingTable> schema =
      thing_schema("sites", true)
          .optional("inside_of", &ThingTable::inside_of, flag(), "false",
                    "true: a container, free inside and solid outside")
          .optional("motion", &ThingTable::motion, motion_schema().codec(), "none",
                    "moves as told, from its pose at t = 0");
  return schema;
}

const Schema<ThingTable>& body_schema() {
  static const Schema<ThingTable> schema =
      thing_schema("bodies", false)
          .optional("mass", &ThingTable::mass, number(heavy("kg")), "1", "mass; give mass or density")
          .optional("density", &ThingTable::density, number(heavy("kg/m^2")), "from mass",
                    "mass per area; of a wire without thickness: per length [kg/m]")
          .optional("inertia", &ThingTable::inertia, number(heavy("kg m^2")), "from the shape",
                    "about the centre of mass")
          .optional("velocity", &ThingTable::velocity, point("m/s"), "[0, 0]", "of the centre of mass")
          .optional("angular_velocity", &ThingTable::angular_velocity, number(any("rad/s")), "0",
                    "counter-clockwise")
          // Of bodies alone: a site stands where it is told, and others may be put on it.
          .optional("touching", &ThingTable::touching, names(), "none",
                    "bodies or sites that it is put on, moved along gravity to first contact")
          .optional("touching_direction", &ThingTable::touching_direction, point(""), "along gravity",
                    "the way down of touching, stack, pyramid, wall and pile")
          .optional("lock", &ThingTable::lock, names({"x", "y", "angle"}), "[]", "coordinates that are held")
          .optional("sampling", &ThingTable::sampling, sampling_schema().codec(), "vertices",
                    "samples of the classic detector");
  return schema;
}

// No table has to be there; what a table is read by stands in table_reader(), things_reader() and
// read_force().
const Schema<FileTable>& file_schema() {
  static const Schema<FileTable> schema =
      Schema<FileTable>("the file")
          .key("title", &FileTable::title, text(), "what people call the scene")
          .custom("world", "table", "", "what holds everywhere",
                  table_reader(world_schema(), &FileTable::world))
          .custom("solver", "table", "", "how it is run", table_reader(solver_schema(), &FileTable::solver))
          .custom("field", "table", "", "how fields are drawn",
                  table_reader(field_schema(), &FileTable::field))
          .custom("output", "table", "", "what is recorded",
                  table_reader(output_schema(), &FileTable::output))
          .custom("materials", "tables by name", "", "what surfaces are like", read_materials)
          .custom("sites", "array of tables", "", "what is fixed, or moves as told",
                  things_reader("sites", site_schema(), &FileTable::sites))
          .custom("bodies", "array of tables", "", "what moves freely",
                  things_reader("bodies", body_schema(), &FileTable::bodies))
          .custom("forces", "array of tables", "", "what acts beside gravity",
                  [](const toml::node& node, TomlDocument& doc, FileTable& out) {
                    for_each_table("forces", node, doc,
                                   [&](const toml::table& table) { read_force(table, doc, out.forces); });
                  });
  return schema;
}

// The tables of the file, then those within bodies and sites, then the kinds of force.
std::vector<OptionInfo> scene_options() {
  std::vector<OptionInfo> out;
  file_schema().list(out);
  world_schema().list(out);
  solver_schema().list(out);
  field_schema().list(out);
  output_schema().list(out);
  material_schema().list(out);
  site_schema().list(out);
  body_schema().list(out);
  list_shape_keys(out);
  grid_schema().list(out);
  scatter_schema().list(out);
  pile_schema().list(out);
  motion_schema().list(out);
  sampling_schema().list(out);
  for (const std::string& kind : force_kinds()) force_schema(kind)->list(out);
  return out;
}

}  // namespace brink
