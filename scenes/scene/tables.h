#pragma once
/// The tables of a scene file as plain structs, and the schema of each: the only home of keys, types and
/// meanings. Internal to the scene reader.

#include <map>
#include <set>

#include "brink/core/shapes/shapes.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scenes/toml/schema.h"

namespace brink {

struct WorldTable {
  double duration = Scene{}.duration;
  Vec2 gravity = World{}.gravity;
  Vec2 periodic = World{}.periods.size;
  std::uint64_t seed = SolverOptions{}.seed;
  std::string restitution_rule = "max";
  std::string friction_rule = "geometric_mean";
};

struct FieldTable {
  FieldOptions options;
  double curve_tolerance = 1e-4;  ///< [m]
};

/// What a shape needs from beside its own table.
struct ShapeContext {
  double curve_tolerance = 0.0;  ///< [m]
  double radius = 0.0;           ///< thickness given beside the shape [m]
  bool inside_of = false;        ///< a container is asked for
};

/// One shape as asked for, not yet built.
struct ShapeSpec {
  std::string kind;  ///< the file's word
  Where where;
  Json parameters;            ///< as given: equal parameters make equal shapes
  bool takes_radius = false;  ///< a thickness beside the shape has a meaning
  bool takes_curve_tolerance = false;
  bool for_bodies = true;                ///< false: sites only
  std::optional<std::string> data_file;  ///< samples: as named in the scene
  std::vector<Vec2> samples;             ///< samples: what the file holds, in the shape's frame
  std::function<Shape(const ShapeContext&)> build;
};

struct GridTable {
  std::int64_t columns = 1, rows = 1;
  Vec2 spacing = Vec2::Zero();
};
struct ScatterTable {
  std::int64_t count = 1;
  std::vector<Vec2> region;  ///< two corners
  double speed = 0.0, angular_speed = 0.0;
  bool random_angle = false;
};
struct PileTable {
  std::int64_t count = 1;
  double width = 0.0;  ///< [m]
  bool random_angle = false;
};
struct SamplingTable {
  std::string kind = "vertices";
  double spacing = Sampling{}.spacing;
  std::int64_t count = Sampling{}.count;
};
struct MotionTable {
  Given<Vec2> velocity;
  Given<double> angular_velocity;
  Given<std::string> x, y, angle;
};

/// A `[[bodies]]` or `[[sites]]` entry.
struct ThingTable {
  Where place;
  Given<std::string> name, material;
  std::vector<ShapeSpec> shapes;
  Given<double> mass, density, inertia;
  Given<Vec2> position, velocity;
  Given<double> angle, angle_deg, angular_velocity;
  Given<bool> centered, inside_of;
  Given<double> radius, curve_tolerance;
  Given<std::vector<std::string>> lock;
  Given<SamplingTable> sampling;
  Given<GridTable> grid;
  Given<ScatterTable> scatter;
  Given<std::int64_t> stack, pyramid;       ///< copies; copies in the lowest row
  Given<std::array<std::int64_t, 2>> wall;  ///< copies in the longer rows, rows
  Given<PileTable> pile;
  Given<std::vector<std::string>> touching;  ///< bodies: what it is put on
  Given<Vec2> touching_direction;            ///< any length; else along gravity
  Given<MotionTable> motion;
};

/// A `[[forces]]` entry of any kind.
struct ForceTable {
  Where place;
  std::string kind;
  Given<std::string> body;
  Given<std::vector<std::string>> bodies;
  Given<Vec2> anchor;
  Given<std::vector<Vec2>> at;
  SpringForce spring;
  DragForce drag;
  AttractForce attract;
  ThrustForce thrust;
  Given<std::string> fx, fy, torque;
};

struct MaterialTable {
  Material material;
  Where where;
};

/// The whole file.
struct FileTable {
  std::string title;
  WorldTable world;
  SolverOptions solver;
  FieldTable field;
  OutputOptions output;
  std::vector<MaterialTable> materials;
  std::vector<ThingTable> sites, bodies;
  std::vector<ForceTable> forces;
  std::map<std::string, Where>
      places;                    ///< of [world], [solver] ... and of their keys: "solver", "solver.order"
  std::set<std::string> faulty;  ///< those of these tables that have a fault

  /// The place of a key; of its table where the key is not given, of the file's beginning where neither is.
  Where place_of(const std::string& table, const std::string& key = "") const;
};

const Schema<FileTable>& file_schema();
const Schema<WorldTable>& world_schema();
const Schema<SolverOptions>& solver_schema();
const Schema<FieldTable>& field_schema();
const Schema<OutputOptions>& output_schema();
const Schema<Material>& material_schema();
const Schema<ThingTable>& site_schema();
const Schema<ThingTable>& body_schema();
/// The schema of one kind of force, or null. Kinds: spring, drag, attract, thrust, formula.
const Schema<ForceTable>* force_schema(const std::string& kind);
std::vector<std::string> force_kinds();

/// Adds the shape keys to a schema of bodies or sites.
void add_shape_keys(Schema<ThingTable>& schema, bool site);
/// The keys inside the shapes' own tables.
void list_shape_keys(std::vector<OptionInfo>& out);

/// What a duration may be [s], in the file and on the command line.
Range duration_range();

/// Why `duration` seconds of `bodies` bodies make more rows of frames than output.max_frame_rows allows, as a
/// fault says it; empty if they do not.
std::string too_many_frames(const OutputOptions& output, double duration, std::size_t bodies);

/// "max", "min" ... as the rule it names.
Combine combine_rule(const std::string& name);

}  // namespace brink
