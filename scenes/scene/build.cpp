/// The scene reader's last stage, from tables to a Scene:
///
///     settings, materials          what holds everywhere
///     plan sites, plan bodies      shape, mass, motion and pose of each entry, before copying
///     count bodies                 their names and ids
///     place                        copies, those that touch, those at random (Placer)
///     sites, bodies, forces        into the world
///     check                        what no single table can tell
#include "brink/scenes/scene/build.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "brink/core/world/forces.h"
#include "brink/integrators/closed_form.h"
#include "brink/scenes/files/text_file.h"
#include "brink/scheduler/first_contact/tolerances.h"

namespace brink {
namespace {

/// What entries without a name are called, with their index.
constexpr const char *kUnnamedBody = "body", *kUnnamedSite = "site";

/// Builds a scene part by part. It goes on after a fault, so that all of them are told at once; what
/// needs a part that has failed is left out.
class SceneBuilder {
 public:
  SceneBuilder(const FileTable& file, FaultList& faults)
      : file_(file), faults_(faults), shapes_(file.field.curve_tolerance, faults) {}

  /// Called once: it gives its scene away.
  Scene build() {
    settings();
    materials();
    std::vector<PlannedThing> sites = plan(file_.sites, false), bodies = plan(file_.bodies, true);
    count(bodies);
    // @pre of place_rules and Placer: no faults, so every thing has its outline. Else nothing is placed, but what is put on
    // others can be told to name nobody.
    if (faults_.empty())
      Placer(file_.world.seed, place_rules(sites, bodies), faults_).place(sites, bodies);
    else
      put_on_others(sites, bodies, {scene_.world.gravity, scene_.world.periods, 0.0}, faults_);
    const bool placed = faults_.empty();
    if (placed) {
      add_sites(sites);
      add_bodies(bodies);
    } else {  // the names that forces use can be checked all the same
      scene_.world.bodies.resize(static_cast<std::size_t>(names_.count()));
      origins_.assign(scene_.world.bodies.size(), Vec2::Zero());
    }
    build_forces(file_.forces, names_, origins_, placed, scene_.world, faults_);
    for (std::string& note : shapes_.take_notes()) scene_.notes.push_back(std::move(note));
    check_integrator();
    check_frames();
    // World::check() needs the whole world; after a fault it would tell its consequences.
    if (faults_.empty()) last_check();
    return std::move(scene_);
  }

 private:
  /// What needs no other part: title, gravity, periods, rules, options.
  void settings() {
    World& world = scene_.world;
    world.title = file_.title;
    world.gravity = file_.world.gravity;
    world.periods.size = file_.world.periodic;
    world.restitution_rule = combine_rule(file_.world.restitution_rule);
    world.friction_rule = combine_rule(file_.world.friction_rule);
    scene_.duration = file_.world.duration;
    scene_.output = file_.output;
    scene_.solver = file_.solver;
    // One seed for places and for the solver: the file has a single key.
    scene_.solver.seed = file_.world.seed;
    scene_.solver.field = file_.field.options;
    std::string error;
    // After a fault in the keys some options are defaults; what they would be together is not known.
    if (is_sound("solver") && is_sound("field") && !scene_.solver.is_valid(&error))
      faults_.add(place_of_option(error), error);
    if (world.periods.any() && scene_.solver.detector != "field")
      faults_.add(file_.place_of("solver", "detector"),
                  fault_text("detector", "does not see across the borders of a periodic world",
                             scene_.solver.detector, "\"field\", or no world.periodic"));
    options_json();
  }

  PlaceRules place_rules(const std::vector<PlannedThing>& sites,
                         const std::vector<PlannedThing>& bodies) const {
    // The scene's world has nobody yet, and the rows of a stack must know the gap.
    // World::length() looks at outlines alone.
    World to_come;
    for (const PlannedThing& thing : sites) to_come.sites.emplace_back().outline = thing.shape.outline;
    for (const PlannedThing& thing : bodies) to_come.bodies.emplace_back().outline = thing.shape.outline;
    // Sharp corners and wires without thickness meet at half the touching distance (nominal_level(),
    // tolerances.h) and count as touching up to the whole: three quarters are clear of both.
    const double thin = 0.75 * kTouchOfTolerance * scene_.solver.contact_tolerance * to_come.length();
    return {scene_.world.gravity, scene_.world.periods, thin};
  }

  /// Of the option that a message of SolverOptions::is_valid() begins with.
  Where place_of_option(const std::string& message) const {
    const std::string key = message.substr(0, message.find(' '));
    return file_.place_of(file_.places.contains("field." + key) ? "field" : "solver", key);
  }

  /// Of the tables that there are once.
  bool is_sound(const std::string& table) const { return !file_.faulty.contains(table); }

  /// An integrator that has no steps moves bodies only by forces of which it knows the motion.
  void check_integrator() {
    if (scene_.solver.integrator != "ballistic") return;
    const std::vector<Component> components = make_components(scene_.world);
    if (std::all_of(components.begin(), components.end(),
                    [](const Component& c) { return has_closed_form(*c.dynamics); }))
      return;
    std::vector<std::string> kinds;
    for (const ForceTable& force : file_.forces) {
      const bool closed = force.kind == "thrust" || (force.kind == "drag" && force.drag.quadratic == 0.0);
      const std::string kind = force.kind == "drag" ? "quadratic drag" : force.kind;
      if (!closed && std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(kind);
    }
    faults_.add(file_.place_of("solver", "integrator"),
                fault_text("integrator", "ballistic has no closed form for these forces", listed(kinds),
                           "gravity, thrusts and linear drag, or another integrator, as \"auto\""));
  }

  void check_frames() {
    // After a fault in one of these they are not what is meant.
    if (!is_sound("world") || !is_sound("output")) return;
    const std::size_t bodies = scene_.world.bodies.size();
    if (const std::string why = too_many_frames(scene_.output, scene_.duration, bodies); !why.empty())
      faults_.add(file_.place_of("output"), "output: " + why);
  }

  /// Every option as it is used, for the run file: resuming compares these texts. Overrides are in it
  /// by their values, defaults as well.
  void options_json() {
    Json json;
    json["world"] = world_schema().json(file_.world);
    json["solver"] = solver_schema().json(scene_.solver);
    json["field"] = field_schema().json(file_.field);
    json["output"] = output_schema().json(scene_.output);
    scene_.options_json = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  }

  /// Index 0 is the material of whatever names none; [materials.default] takes its place.
  void materials() {
    for (const MaterialTable& entry : file_.materials) {
      if (entry.material.name == scene_.world.materials[0].name)
        scene_.world.materials[0] = entry.material;
      else
        scene_.world.materials.push_back(entry.material);
    }
  }

  /// Index into World::materials; a fault and 0 where nobody is called so. @pre materials() has been
  /// called.
  int material(const Given<std::string>& name) {
    if (!name.given) return 0;
    std::vector<std::string> words;
    for (std::size_t k = 0; k < scene_.world.materials.size(); ++k) {
      if (scene_.world.materials[k].name == name.value) return static_cast<int>(k);
      words.push_back(scene_.world.materials[k].name);
    }
    faults_.add(name.where, "no material is called " + in_quotes(name.value) + "; the nearest name is \"" +
                                nearest_word(name.value, words) + "\"");
    return 0;
  }

  /// The `index`-th body or site that has no name is called by its place in the file.
  static std::string name_of(const ThingTable& table, bool body, std::size_t index) {
    return table.name.given ? table.name.value : (body ? kUnnamedBody : kUnnamedSite) + std::to_string(index);
  }

  /// One entry of the file after the other, with all faults that can be told of an entry by itself.
  /// Copies are still to come.
  std::vector<PlannedThing> plan(const std::vector<ThingTable>& tables, bool body) {
    std::vector<PlannedThing> out;
    std::set<std::string> taken;
    for (const ThingTable& table : tables) {
      PlannedThing thing;
      thing.table = &table;
      // Even for sites and odd for bodies: no two entries of a scene draw from the same random stream.
      thing.ordinal = 2 * out.size() + (body ? 1 : 0);
      thing.name = name_of(table, body, out.size());
      // Within bodies, or within sites: a body and a site may share a name, which `touching` then
      // refuses.
      if (!taken.insert(thing.name).second)
        faults_.add(table.name.given ? table.name.where : table.place,
                    "name: is used twice; given " + in_quotes(thing.name) + ", allowed: a name of its own");
      if (thing.name.empty())
        faults_.add(table.name.where, "name: is empty; given \"\", allowed: one character or more");
      thing.material = material(table.material);
      check_keys(table, faults_);
      if (table.scatter.given && table.position.given)
        scene_.notes.push_back("position of " + in_quotes(thing.name) +
                               " is not used: scatter places the copies");
      // A thing whose shape failed stays in the list without an outline: its name, copies and material
      // are still checked.
      if (const auto shape = shapes_.build(table, thing.name, body)) {
        thing.shape = *shape;
        if (body) thing.body = body_of(thing);
      }
      if (!body) thing.motion = build_motion(table.motion, thing.name, file_.world.duration, faults_);
      thing.pose = pose(table, thing.shape);
      out.push_back(std::move(thing));
    }
    return out;
  }

  /// Where the outline's frame stands: position and angle as written, in the world. Of a site or body
  /// that keeps its origin the outline, which is about the centre of mass, is shifted by the turned
  /// offset.
  static Pose pose(const ThingTable& table, const BuiltShape& shape) {
    Pose pose;
    pose.position = table.position.value;
    pose.angle =
        table.angle_deg.given ? table.angle_deg.value * (std::numbers::pi / 180.0) : table.angle.value;
    // Only a body's or a centred site's outline is about the centroid; else the shift is 0 and this
    // changes nothing.
    const bool keep_origin = table.centered.given && !table.centered.value;
    if (keep_origin) pose.position = Frame(pose).to_world(shape.shift);
    return pose;
  }

  // Gives every body its place among the names.
  // Counted before anything is placed, so that the names in forces are checked even where placing fails.
  void count(const std::vector<PlannedThing>& things) {
    std::int64_t total = 0;
    for (const PlannedThing& thing : things) {
      const CopyCount copies = copies_of(*thing.table);
      if ((total += copies.count) > kMostCopies)
        return faults_.add(copies.where, "too many copies; given " + std::to_string(total) +
                                             " bodies so far, allowed: " + std::to_string(kMostCopies));
      names_.add(thing.name, static_cast<int>(copies.count), copies.copied);
    }
  }

  /// NAME[k] of copies, also where only one is asked for; NAME of an entry without copies.
  static std::string copy_name(const PlannedThing& thing, std::size_t k) {
    return copies_of(*thing.table).copied ? thing.name + '[' + std::to_string(k) + ']' : thing.name;
  }

  void add_sites(const std::vector<PlannedThing>& things) {
    for (const PlannedThing& thing : things)
      for (std::size_t k = 0; k < thing.copies.size(); ++k) {
        FixedSite site;
        site.name = copy_name(thing, k);
        site.kind = thing.table->shapes[0].kind;
        site.outline = thing.shape.outline;
        site.pose = thing.copies[k].pose;
        site.material = thing.material;
        site.motion = thing.motion;
        scene_.world.sites.push_back(std::move(site));
      }
  }

  // The order of bodies here is that of count(): ids of BodyNames are indices into World::bodies.
  void add_bodies(const std::vector<PlannedThing>& things) {
    for (const PlannedThing& thing : things) {
      for (std::size_t k = 0; k < thing.copies.size(); ++k) {
        Body body = thing.body;
        body.name = copy_name(thing, k);
        body.initial = thing.copies[k];
        hold(body);
        scene_.world.bodies.push_back(std::move(body));
        scene_.body_places.push_back({thing.table->place.line, thing.table->place.column});
        // build_forces() adds this to places given in the file's frame: there the outline's origin is
        // at `shift`.
        const bool keep_origin = thing.table->centered.given && !thing.table->centered.value;
        origins_.push_back(keep_origin ? Vec2(-thing.shape.shift) : Vec2(Vec2::Zero()));
      }
    }
  }

  /// Mass and inertia by what is given: density times area (of a wire without thickness, length), else
  /// the mass, else 1 kg; the inertia that is given, else that of a shape of even density.
  Body body_of(const PlannedThing& thing) {
    const ThingTable& table = *thing.table;
    const Measure& measure = thing.shape.measure;
    Body body;
    body.outline = thing.shape.outline;
    body.material = thing.material;
    body.mass = table.density.given ? table.density.value * measure.size
                : table.mass.given  ? table.mass.value
                                    : 1.0;
    // second_moment and size are at unit density, so mass / size is the density, per area or per length.
    body.inertia =
        table.inertia.given ? table.inertia.value : body.mass / measure.size * measure.second_moment;
    for (const std::string& word : table.lock.value) {
      (word == "x" ? body.lock_x : word == "y" ? body.lock_y : body.lock_angle) = true;
    }
    body.sampling = sampling(thing);
    check_sampling(body, table);
    check_inertia(body, table, thing.name);
    check_locks(body, table);
    return body;
  }

  /// Limits: the densest that a file may give is 1e40 kg/m^2, lengths are up to 1e15 m; so a mass comes
  /// to about 1e70 kg, and an inertia to 1e100 kg m^2. Up to there products of two are finite. NaN fails
  /// both comparisons.
  void check_inertia(const Body& body, const ThingTable& table, const std::string& name) {
    const auto sound = [](double x) { return std::isfinite(x) && x >= 1e-100 && x <= 1e100; };
    if (sound(body.mass) && sound(body.inertia)) return;
    faults_.add(table.place, in_quotes(name) + ": mass or inertia is out of range; given by its shape " +
                                 number_text(body.mass) + " kg and " + number_text(body.inertia) +
                                 " kg m^2, allowed: 1e-100 to 1e100; give mass and inertia");
  }

  /// A held coordinate has an infinite mass: a velocity along it would have an infinite energy.
  void check_locks(const Body& body, const ThingTable& table) {
    const bool moves =
        (body.lock_x && table.velocity.value.x() != 0.0) || (body.lock_y && table.velocity.value.y() != 0.0);
    if (moves)
      faults_.add(table.velocity.where, "velocity: a held coordinate does not move; given [" +
                                            number_text(table.velocity.value.x()) + ", " +
                                            number_text(table.velocity.value.y()) +
                                            "], allowed: 0 where lock holds");
    if (body.lock_angle && table.angular_velocity.value != 0.0)
      faults_.add(table.angular_velocity.where, "angular_velocity: a held angle does not turn; given " +
                                                    number_text(table.angular_velocity.value) +
                                                    ", allowed: 0");
  }

  // Speeds drawn by a scatter stop where a lock holds.
  static void hold(Body& body) {
    Twist& twist = body.initial.twist;
    if (body.lock_x) twist.velocity.x() = 0.0;
    if (body.lock_y) twist.velocity.y() = 0.0;
    if (body.lock_angle) twist.omega = 0.0;
  }

  /// Samples of the classic detector: as asked for; those of a text data file; else vertices.
  Sampling sampling(const PlannedThing& thing) const {
    // In the order of Sampling::Kind; `file` is not asked for by name.
    static const std::vector<std::string> kinds{"vertices", "boundary", "volume", "random", "raster"};
    const SamplingTable& table = thing.table->sampling.value;
    Sampling sampling;
    sampling.kind =
        static_cast<Sampling::Kind>(std::find(kinds.begin(), kinds.end(), table.kind) - kinds.begin());
    sampling.spacing = table.spacing;
    sampling.count = static_cast<int>(table.count);
    sampling.seed = file_.world.seed + 0x9e3779b97f4a7c15ULL * thing.ordinal;  // a stream of its own
    if (thing.table->sampling.given) return sampling;
    // Samples of a text data file are themselves the particles; the outline's frame is about the centroid.
    sampling.points = thing.table->shapes[0].samples;
    if (!sampling.points.empty()) sampling.kind = Sampling::Kind::file;
    for (Vec2& p : sampling.points) p -= thing.shape.shift;
    return sampling;
  }

  // Makes the particles once for nothing but their faults (no spacing, too many of them).
  void check_sampling(const Body& body, const ThingTable& table) {
    if (!table.sampling.given) return;
    try {
      // Once an entry, as its copies share what is asked.
      make_particles(*body.outline, body.sampling);
    } catch (const BadInput& error) {
      faults_.add(table.sampling.where, error.what());
    }
  }

  // Whatever the tables did not catch: placed at the entry that the message names.
  void last_check() {
    try {
      scene_.world.check();
    } catch (const BadInput& error) {
      const std::string message = error.what();
      faults_.add(place_named_in(message), message);
    }
  }

  /// The first entry that the message names as `body "NAME"` or `fixed site "NAME"`; else the first of whose copies, which
  /// are called NAME[k], it names one.
  Where place_named_in(const std::string& message) const {
    for (const char* after : {"\"", "["})
      for (const auto* things : {&file_.bodies, &file_.sites})
        for (std::size_t k = 0; k < things->size(); ++k) {
          const bool body = things == &file_.bodies;
          const ThingTable& table = (*things)[k];
          const std::string named = (body ? "body \"" : "fixed site \"") + name_of(table, body, k) + after;
          if (message.find(named) != std::string::npos) return table.place;
        }
    return {1, 1};
  }

  const FileTable& file_;
  FaultList& faults_;
  ShapeBuilder shapes_;
  Scene scene_;
  BodyNames names_;
  std::vector<Vec2> origins_;
};

}  // namespace

/// From here to load_scene(): text, tree, tables, data files, scene. Each stage adds its faults to one
/// list, which is thrown at the end.
Scene build_scene(const FileTable& file, FaultList& faults) { return SceneBuilder(file, faults).build(); }

Scene parse_scene(std::string_view text, const std::string& name, const std::vector<std::string>& overrides) {
  TomlDocument document(text, overrides, {{"bodies", kUnnamedBody}, {"sites", kUnnamedSite}});
  // After a syntax error there are no tables; every other fault leaves the rest of the file readable.
  if (!document.readable()) document.faults().throw_if_any(name);
  FileTable file;
  file_schema().read(document.root(), {1, 1}, document, file);
  std::vector<std::filesystem::path> files{name};
  take_sample_files(file, std::filesystem::path(name).parent_path(), files, document.faults());
  Scene scene = build_scene(file, document.faults());
  document.faults().throw_if_any(name);
  // For the run file, which keeps text and overrides (scene_of_run()).
  scene.path = name;
  scene.files = std::move(files);
  scene.text = text;
  scene.overrides = overrides;
  return scene;
}

Scene load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return parse_scene(text_of_file(file), file.string(), overrides);
}

}  // namespace brink
