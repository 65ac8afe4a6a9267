// The kinds of force of a scene file: each one's keys.
// A schema for each kind, so that a key of another kind is unknown; all fill one struct, ForceTable, of
// which a kind uses its part. `kind` is read before (read_force(), tables.cpp) and once more with the
// rest.
#include "brink/scenes/scene/tables.h"

namespace brink {
namespace {

/// Of stiffnesses, drags and strengths; as kHeaviest in tables.cpp.
constexpr double kStrongest = 1e40;

// Binds a key to a member of one of the force structs inside ForceTable.
template <class F>
class Part {
 public:
  Part(std::string kind, F ForceTable::*member) : schema_(std::move(kind)), member_(member) {
    schema_.required("kind", &ForceTable::kind, choice(force_kinds()), "which force");
  }
  Schema<ForceTable>& operator*() { return schema_; }
  template <class V>
  Part& key(const std::string& name, V F::*value, Codec<V> codec, const std::string& meaning,
            bool needed = false) {
    // A schema of one key, nested at once: keys of the force's own struct come among those of
    // ForceTable, in the order in which they are declared.
    Schema<F> one("");
    needed ? one.required(name, value, codec, meaning) : one.key(name, value, codec, meaning);
    schema_.nested(member_, one);
    return *this;
  }

 private:
  Schema<ForceTable> schema_;
  F ForceTable::*member_;
};

// What takes energy away or holds together must not be negative; what pulls may also push.
Codec<double> strength(std::string unit) { return number({0.0, kStrongest, false, std::move(unit)}); }
Codec<double> signed_strength(std::string unit) {
  return number({-kStrongest, kStrongest, false, std::move(unit)});
}

// at = [x, y], or [[x, y], [x, y]] for two bodies
// How many there must be is told where the bodies are known (build_forces.cpp).
Codec<std::vector<Vec2>> attachment() {
  Codec<std::vector<Vec2>> both = points(1, 2);
  both.type = "[x, y], or one for each body [[x, y], [x, y]], in m";
  both.read = [pair = points(1, 2), one = point()](const toml::node& node, TomlDocument& doc,
                                                   const std::string& key, std::vector<Vec2>& out) {
    const toml::array* array = node.as_array();
    // Two numbers are one place, two arrays are two.
    const bool flat = array != nullptr && !array->empty() && !(*array)[0].is_array();
    return flat ? one.read(node, doc, key, out.emplace_back()) : pair.read(node, doc, key, out);
  };
  return both;
}

/// For kinds that act on each body by itself; without the key, on all.
Schema<ForceTable>& with_bodies(Schema<ForceTable>& schema) {
  return schema.optional("bodies", &ForceTable::bodies, names(), "every body",
                         "names of the bodies it acts on");
}

Schema<ForceTable> spring_schema() {
  Part<SpringForce> part("spring", &ForceTable::spring);
  (*part)
      .optional("bodies", &ForceTable::bodies, names(), "none",
                "the two bodies it joins; or give body and anchor")
      .optional("body", &ForceTable::body, text("name of a body"), "none",
                "the body that it holds to the anchor")
      .optional("anchor", &ForceTable::anchor, point(), "none", "a fixed point of the world")
      .optional("at", &ForceTable::at, attachment(), "[0, 0]",
                "where it is attached, from the body's position, in its axes");
  part.key("stiffness", &SpringForce::stiffness, strength("N/m"), "force per length", true)
      .key("damping", &SpringForce::damping, strength("N s/m"), "along the spring")
      .key("rest_length", &SpringForce::rest_length, number(not_negative("m")), "length without force");
  return *part;
}

Schema<ForceTable> drag_schema() {
  Part<DragForce> part("drag", &ForceTable::drag);
  with_bodies(*part);
  part.key("linear", &DragForce::linear, strength("N s/m"), "force per speed")
      .key("quadratic", &DragForce::quadratic, strength("N s^2/m^2"), "force per speed squared")
      .key("angular", &DragForce::angular, strength("N m s"), "torque per angular speed");
  return *part;
}

Schema<ForceTable> attract_schema() {
  Part<AttractForce> part("attract", &ForceTable::attract);
  with_bodies(*part);
  part.key("center", &AttractForce::center, point(), "where it pulls to")
      .key("strength", &AttractForce::strength, signed_strength("m/s^2 at 1 m"),
           "per mass; negative: it repels", true)
      .key("power", &AttractForce::power, number(between(-10.0, 10.0)),
           "of the distance; -2: gravity, 1: a spring");
  return *part;
}

Schema<ForceTable> thrust_schema() {
  Part<ThrustForce> part("thrust", &ForceTable::thrust);
  // Not `required`: that it is missing is told where the body is looked up (build_forces.cpp).
  (*part).optional("body", &ForceTable::body, text("name of a body"), "needed", "the body it acts on");
  part.key("force", &ThrustForce::force, point("N"), "in the world's axes")
      .key("torque", &ThrustForce::torque, signed_strength("N m"), "counter-clockwise")
      .key("from", &ThrustForce::from, number(not_negative("s")), "acts from this time")
      .key("to", &ThrustForce::to, number(not_negative("s")), "up to this time");
  return *part;
}

Schema<ForceTable> formula_schema() {
  Schema<ForceTable> schema("formula");
  schema.required("kind", &ForceTable::kind, choice(force_kinds()), "which force");
  return with_bodies(schema)
      .optional("fx", &ForceTable::fx, formula_text(), "0",
                "force along x [N] in t, x, y, angle, vx, vy, omega, m")
      .optional("fy", &ForceTable::fy, formula_text(), "0", "force along y [N]")
      .optional("torque", &ForceTable::torque, formula_text(), "0", "torque [N m]");
}

}  // namespace

std::vector<std::string> force_kinds() { return {"spring", "drag", "attract", "thrust", "formula"}; }

/// Built once, at the first call; the pointer stays good.
const Schema<ForceTable>* force_schema(const std::string& kind) {
  static const Schema<ForceTable> schemas[] = {spring_schema(), drag_schema(), attract_schema(),
                                               thrust_schema(), formula_schema()};
  for (const Schema<ForceTable>& schema : schemas)
    if (schema.table() == kind) return &schema;
  return nullptr;
}

}  // namespace brink
