#pragma once
/// Bodies that start where people put them: right at a wall or at each other, a hair off it or a hair inside, at rest,
/// sliding along it slowly or fast, leaving it or pressed to it.

#include <numbers>

#include "random_worlds_checks.h"
#include "tests/support/outside/frame_watch.h"

namespace brink::starts {

/// One or two bodies and a wall, as a scene. The wall's surface leads through the middle of the scene.
class Maker {
 public:
  explicit Maker(std::uint64_t seed) : seed_(seed), random_(seed) {}

  std::string make() {
    const double far = random_.below(3) == 0 ? 0.0 : log_uniform(1.0, 1e4);
    x_ = random_.uniform(-far, far);
    y_ = random_.uniform(-far, far);
    turn_ = random_.below(3) == 0 ? 0.5 * std::numbers::pi * static_cast<double>(random_.below(4))
                                  : random_.uniform(0.0, 6.3);
    const double size = log_uniform(0.02, 1.0);
    const double e = random_.below(4) == 0 ? 0.0 : random_.below(4) == 0 ? 1.0 : random_.uniform();
    // mostly towards the wall, now and then along it, or none
    const double way = random_.below(3) == 0 ? random_.uniform(0.0, 6.3) : turn_ - 0.5 * std::numbers::pi;
    const double pull = random_.below(5) == 0 ? 0.0 : 9.81;
    out_ << std::setprecision(17) << "# start " << seed_
         << "\n[world]\nduration = 0.5\ngravity = " << pair(pull * std::cos(way), pull * std::sin(way))
         << "\n[solver]\nmax_collisions = 20000\n[materials.default]\nrestitution = " << e << "\n";
    if (random_.below(3) == 0) out_ << "friction = " << random_.uniform(0.0, 1.0) << "\n";
    out_ << "[[sites]]\nname = \"wall\"\nposition = " << pair(x_, y_) << "\nangle = " << turn_ << "\n"
         << wall(size) << "\n";
    body("b", size, {x_, y_}, turned(0, 1));
    if (random_.below(3) == 0)
      body("c", size, last_, turned(random_.uniform(-1.0, 1.0), random_.uniform(0.3, 1.0)));
    return out_.str();
  }

 private:
  double log_uniform(double low, double high) { return low * std::pow(high / low, random_.uniform()); }
  double sign() { return random_.below(2) ? 1.0 : -1.0; }
  static std::string pair(double x, double y) {
    std::ostringstream s;
    s << std::setprecision(17) << "[" << x << ", " << y << "]";
    return s.str();
  }
  /// Along the wall and out of it, in the world.
  Vec2 turned(double along, double out) const {
    return {along * std::cos(turn_) - out * std::sin(turn_), along * std::sin(turn_) + out * std::cos(turn_)};
  }

  std::string wall(double s) {
    std::ostringstream t;
    t << std::setprecision(17);
    const double w = log_uniform(1e-3, 0.5);
    switch (random_.below(6)) {
      case 0:
      case 1:
        t << "segment = [[-30, 0], [30, 0]]";
        break;
      case 2:
        t << "segment = [[-30, 0], [30, 0]]\nradius = " << w;
        break;
      case 3:
        t << "polygon = { vertices = [[-30, -1], [30, -1], [30, 0], [-30, 0]] }";
        break;
      case 4:  // no wider than what stands on it
        t << "segment = [[" << -s << ", 0], [" << s << ", 0]]\nradius = " << w * s;
        break;
      default:
        t << "disc = { radius = " << log_uniform(1.0, 30.0) << " }";
    }
    return t.str();
  }

  std::string shape(double s) {
    std::ostringstream t;
    t << std::setprecision(17);
    switch (random_.below(7)) {
      case 0:
      case 1:
      case 2:
        t << "disc = { radius = " << 0.5 * s << " }";
        break;
      case 3:
        t << "box = { width = " << s << ", height = " << s * random_.uniform(0.2, 1.0) << " }";
        break;
      case 4:
        t << "capsule = { length = " << s << ", radius = " << s * log_uniform(1e-3, 0.3) << " }";
        break;
      case 5:
        t << "polygon = { vertices = [[" << -0.5 * s << ", " << -0.3 * s << "], [" << 0.5 * s << ", "
          << -0.4 * s << "], [0.0, " << 0.5 * s << "]], radius = " << 0.02 * s << " }";
        break;
      default:
        t << "chain = { vertices = [[" << -0.5 * s << ", 0], [0, " << 0.3 * s << "], [" << 0.5 * s
          << ", 0]] }";
    }
    return t.str();
  }

  /// A body that comes from afar against `way` until its gap to the one that is there is the one that is wanted.
  void body(const std::string& name, double size, const Vec2& base, const Vec2& way) {
    const double angle = random_.below(3) == 0
                             ? turn_ + 0.5 * std::numbers::pi * static_cast<double>(random_.below(4))
                             : random_.uniform(0.0, 6.3);
    const double wanted = random_.below(3) == 0 ? 0.0 : sign() * size * log_uniform(1e-14, 3e-8);
    const std::string what = shape(size);
    const double v = random_.below(3) == 0 ? 0.0 : sign() * log_uniform(1e-9, 30.0);
    const double out = random_.below(3) == 0 ? 0.0 : sign() * log_uniform(1e-12, 3.0);
    const Vec2 velocity = turned(v, out);
    const auto text_at = [&](double h) {
      std::ostringstream t;
      t << std::setprecision(17) << "[[bodies]]\nname = \"" << name << "\"\n"
        << what << "\nposition = " << pair(base.x() + h * way.x(), base.y() + h * way.y())
        << "\nangle = " << angle << "\nvelocity = " << pair(velocity.x(), velocity.y()) << "\n";
      if (spins_) t << "angular_velocity = " << spin_ << "\n";
      return t.str();
    };
    spins_ = random_.below(2) == 0;
    spin_ = sign() * log_uniform(1e-9, 100.0);
    const World world = parse_scene(out_.str() + text_at(0.0), "start").world;
    const Body& own = world.bodies.back();
    const outside::Shape shape_of_own = outside::shape_of(*own.outline);
    const auto [placed, there] = last_of(world);
    double low = 0.0, high = 2.0 * (shape_of_own.reach + placed.reach);
    for (int i = 0; i < 80; ++i) {
      const double h = 0.5 * (low + high);
      outside::Place here = outside::state_of(own.initial).place;
      here.at = here.at + outside::Vec{h * way.x(), h * way.y()};
      (outside::gap(shape_of_own, here, placed, there) > wanted ? high : low) = h;
    }
    last_ = base + high * way;
    out_ << text_at(high);
  }

  /// What the last body of the world is put at: the body before it, or the wall.
  static std::pair<outside::Shape, outside::Place> last_of(const World& world) {
    if (world.bodies.size() > 1) {
      const Body& b = world.bodies[world.bodies.size() - 2];
      return {outside::shape_of(*b.outline), outside::state_of(b.initial).place};
    }
    const FixedSite& s = world.sites.front();
    return {outside::shape_of(*s.outline), outside::Place{outside::vec(s.pose.position), s.pose.angle}};
  }

  std::uint64_t seed_;
  Random random_;
  std::ostringstream out_;
  double x_ = 0, y_ = 0, turn_ = 0, spin_ = 0;
  bool spins_ = false;
  Vec2 last_ = Vec2::Zero();
};

/// The deepest overlap of a scene as it starts, from outside [m].
inline double overlap_at_start(const Scene& scene) {
  outside::WatchOptions all;
  all.start_overlap = 1.0;
  outside::Watch watch(scene.world, all);
  std::vector<BodyState> states;
  for (const Body& b : scene.world.bodies) states.push_back(b.initial);
  watch.frame(0.0, states);
  return static_cast<double>(watch.deepest);
}

/// Every policy, skip, detector and resume without contacts that last; with them two policies.
inline worlds::Verdict examine(const std::string& text, const std::string& name) {
  const Scene scene = parse_scene(text, name);
  worlds::Examiner examiner;
  examiner.start_overlap = overlap_at_start(scene);
  worlds::Verdict verdict = examiner.examine(text, name);
  outside::FrameWatch watch(scene.world, scene.duration, 1e-9, examiner.start_overlap);
  const worlds::Told lasting = worlds::run(scene, &watch);
  const Termination end = lasting.summary.termination;
  if (end != Termination::reached_end && end != Termination::stopped)
    verdict.faults.push_back("contacts that last: " + lasting.summary.termination_text());
  else if (!watch.sound())
    verdict.faults.push_back("contacts that last, from outside: " + watch.report());
  for (const char* set : {"solver.policy=global_backup", "solver.closed_forms=false"}) {
    const std::string differs = difference(lasting, worlds::run(parse_scene(text, name, {set})));
    if (!differs.empty())
      verdict.faults.push_back(std::string("contacts that last, ") + set + ": " + differs);
  }
  verdict.runs += 3;
  return verdict;
}

/// A disc that touches two places at once: in the groove of a solid, a wire or a container, or under the two ends of a bent
/// wire. It starts sunk by 1e-16 to 1e-12 of its size, all but at rest, and is pulled into the groove or any way.
inline std::string between_two_places(std::uint64_t seed) {
  Random random(seed);
  const auto log_uniform = [&](double low, double high) {
    return low * std::pow(high / low, random.uniform());
  };
  const double size = log_uniform(0.02, 1.0), steep = random.uniform(0.2, 1.3), w = size * std::cos(steep),
               h = size * std::sin(steep);
  const double radius = 0.3 * size, sunk = size * log_uniform(1e-16, 1e-12);
  const bool legs = random.below(4) == 0;
  const double e = random.below(2) ? 1.0 : random.uniform();
  const double pulls = random.below(3) == 0 ? random.uniform(0.0, 6.3) : -0.5 * std::numbers::pi;
  std::ostringstream t;
  t << std::setprecision(17) << "# between two places " << seed << "\n[world]\nduration = 0.2\ngravity = ["
    << 9.81 * std::cos(pulls) << ", " << 9.81 * std::sin(pulls)
    << "]\n[solver]\nmax_collisions = 3000\n[materials.default]\nrestitution = " << e << "\n[[sites]]\n";
  const auto v = [&] { return (random.below(2) ? 1.0 : -1.0) * log_uniform(1e-12, 1e-3); };
  if (legs) {  // its ends w to either side, h / 2 below its centre of mass, on the upper half of a disc
    const double large = w / std::sin(steep) * random.uniform(1.05, 3.0);  // clear of the legs
    t << "disc = { radius = " << large << " }\n[[bodies]]\nchain = { vertices = [[" << -w << ", 0], [0, " << h
      << "], [" << w << ", 0]] }\nposition = [0, " << std::sqrt(large * large - w * w) + 0.5 * h - sunk
      << "]\n";
  } else {
    switch (random.below(3)) {
      case 0:
        t << "chain = { vertices = [[" << -w << ", " << h << "], [0, 0], [" << w << ", " << h << "]] }\n";
        break;
      case 1:
        t << "polygon = { vertices = [[" << -w << ", " << -h << "], [" << w << ", " << -h << "], [" << w
          << ", " << h << "], [0, 0], [" << -w << ", " << h << "]] }\n";
        break;
      default:
        t << "polygon = { vertices = [[0, 0], [" << w << ", " << h << "], [" << w << ", " << 4.0 * size
          << "], [" << -w << ", " << 4.0 * size << "], [" << -w << ", " << h << "]] }\ninside_of = true\n";
    }
    // the sides rise at the angle `steep`, so the disc touches both from a height of radius / cos(steep) on
    t << "[[bodies]]\ndisc = { radius = " << radius << " }\nposition = [0, "
      << radius / std::cos(steep) - sunk << "]\n";
  }
  t << "velocity = [" << v() << ", " << v() << "]\nangular_velocity = " << v() << "\n";
  return t.str();
}

/// So many seeds; what is wrong is told, and counted.
template <class Make>
void examine_all(std::uint64_t first, std::uint64_t number, worlds::Tally& tally, Make&& make) {
  for (std::uint64_t seed = first; seed < first + number; ++seed) {
    const std::string text = make(seed);
    worlds::count(seed, text, tally, [&](const std::string& name) { return examine(text, name); });
  }
  std::cout << "seeds " << first << " .. " << first + number - 1 << ": " << tally;
}
inline void examine_all(std::uint64_t first, std::uint64_t number, worlds::Tally& tally) {
  examine_all(first, number, tally, [](std::uint64_t seed) { return Maker(seed).make(); });
}

}  // namespace brink::starts
