#include "brink/core/world/world_hash.h"

#include <string_view>
#include <utility>

#include "brink/core/base/hash.h"

namespace brink {
namespace {

/// Whatever decides a motion has to be here: two worlds that differ in what is missing would pass as one.
/// Adds the parts of a world to one state hash, in a fixed order.
class WorldHasher {
 public:
  /// From left to right: the order of the arguments is part of the hash.
  template <class... T>
  void add(const T&... parts) {
    (one(parts), ...);
  }
  const StateHash& hash() const { return hash_; }

 private:
  void one(double x) { hash_.add(x); }
  void one(const Vec2& v) { hash_.add(v); }
  void one(const BodyState& s) { hash_.add(s); }
  void one(int n) { hash_.add(static_cast<std::uint64_t>(n)); }
  void one(bool b) { hash_.add(std::uint64_t{b}); }
  void one(std::string_view text) {
    // the length first, so that "ab", "c" and "a", "bc" differ
    hash_.add(static_cast<std::uint64_t>(text.size()));
    for (const char c : text) hash_.add(static_cast<std::uint64_t>(c));
  }
  /// With its length, as texts have theirs.
  void one(const std::vector<int>& ids) {
    one(static_cast<int>(ids.size()));
    for (const int id : ids) one(id);
  }
  void one(const Pose& p) { add(p.position, p.angle); }
  /// By its text. None is the empty text, which no formula has.
  void one(const std::optional<Formula>& f) { one(f ? std::string_view(f->text()) : std::string_view()); }

  /// Names decide nothing, and are left out of every hash here.
  void one(const Material& m) {
    add(m.restitution, m.friction, m.tangential_restitution, m.rolling_resistance, m.slip, m.spin);
  }
  void one(const Site& s) {
    // Pseudo-normals, samples, hull, facets and bounds follow from these (finish_outline).
    add(static_cast<int>(s.kind), s.solid, s.radius, s.a, s.b, s.center, s.arc_radius, s.sweep);
  }
  void one(const Outline& o) {
    add(o.solid, o.container, static_cast<int>(o.sites.size()));
    for (const Site& s : o.sites) one(s);
  }
  /// Copies share an outline: it is walked once.
  void one(const std::shared_ptr<const Outline>& outline) {
    if (outline.get() != last_) {
      // A hash of its own, added as one word: whether an outline is shared or repeated does not show.
      StateHash sites;
      std::swap(sites, hash_);
      one(*outline);
      std::swap(sites, hash_);
      last_hash_ = sites.value();
      last_ = outline.get();
    }
    hash_.add(last_hash_);
  }
  /// The sampling too: it decides what the classic detector sees.
  void one(const Body& b) {
    add(b.outline, b.mass, b.inertia, b.lock_x, b.lock_y, b.lock_angle, b.material, b.initial);
    add(static_cast<int>(b.sampling.kind), b.sampling.spacing, b.sampling.count);
    add_seed(b.sampling.seed);
    for (const Vec2& p : b.sampling.points) one(p);
  }
  /// As a double, as run files have it, as far as doubles tell all integers apart.
  void add_seed(std::uint64_t seed) {
    constexpr std::uint64_t held = std::uint64_t{1} << 53;
    if (seed <= held) return hash_.add(static_cast<double>(seed));
    hash_.add(seed);
  }
  void one(const std::monostate&) {}
  void one(const ConstantMotion& m) { add(m.twist.velocity, m.twist.omega); }
  void one(const FormulaMotion& m) { add(m.x, m.y, m.angle); }
  void one(const FixedSite& s) {
    // the kind of motion as well: one that stands still has no numbers of its own
    add(s.outline, s.pose, s.material, static_cast<int>(s.motion.index()));
    std::visit([this](const auto& motion) { one(motion); }, s.motion);
  }
  void one(const SpringForce& f) {
    add(f.body_a, f.body_b, f.at_a, f.at_b, f.stiffness, f.damping, f.rest_length);
  }
  void one(const DragForce& f) { add(f.bodies, f.linear, f.quadratic, f.angular); }
  void one(const AttractForce& f) { add(f.bodies, f.center, f.strength, f.power); }
  void one(const ThrustForce& f) { add(f.body, f.force, f.torque, f.from, f.to); }
  void one(const FormulaForce& f) { add(f.bodies, f.fx, f.fy, f.torque); }
  /// The kind first: two kinds with the same numbers must not look alike.
  void one(const Force& f) {
    one(static_cast<int>(f.index()));
    std::visit([this](const auto& force) { one(force); }, f);
  }

  StateHash hash_;
  const Outline* last_ = nullptr;
  std::uint64_t last_hash_ = 0;
};

}  // namespace

namespace {

/// A plane that does not repeat adds no periods.
StateHash hash_of(const World& world) {
  WorldHasher h;
  if (world.periods.any()) h.add(world.periods.size);
  h.add(world.gravity, static_cast<int>(world.restitution_rule), static_cast<int>(world.friction_rule));
  // Counts before the lists: a body more and a site less must not look alike.
  h.add(static_cast<int>(world.materials.size()), static_cast<int>(world.bodies.size()));
  h.add(static_cast<int>(world.sites.size()), static_cast<int>(world.forces.size()));
  for (const Material& m : world.materials) h.add(m);
  for (const Body& b : world.bodies) h.add(b);
  for (const FixedSite& s : world.sites) h.add(s);
  for (const Force& f : world.forces) h.add(f);
  return h.hash();
}

}  // namespace

std::uint64_t world_hash(const World& world) { return hash_of(world).value(); }
std::string world_hash_text(const World& world) { return hash_of(world).text(); }

}  // namespace brink
