#pragma once
/// Bodies that fall, with every restitution below 1, on floors of every kind: nothing may go through, however
/// often it bounces. An honest end (Zeno) is fine.

#include "random_worlds_checks.h"

namespace brink::drops {

/// One body over one floor, as a scene: the floor's top is at height 0 over [-10, 10] or more.
class Maker {
 public:
  explicit Maker(std::uint64_t seed) : seed_(seed), random_(seed) {}

  std::string make() {
    const double far = random_.below(3) == 0 ? 0.0 : log_uniform(1.0, 1e4);
    x_ = random_.uniform(-far, far);
    y_ = random_.uniform(-far, far);
    const double size = log_uniform(0.02, 1.0), height = size * log_uniform(0.7, 20.0);
    const double e = random_.below(5) == 0   ? 0.0
                     : random_.below(3) == 0 ? 0.1 * static_cast<double>(random_.below(10))
                                             : 0.99 * random_.uniform();
    out_ << std::setprecision(17) << "# drop " << seed_
         << "\n[world]\nduration = 6.0\ngravity = [0.0, -9.81]\n"
         << "[solver]\npersistent = false\nmax_collisions = 20000\n[materials.default]\nrestitution = " << e
         << "\n";
    if (random_.below(3) == 0) out_ << "friction = " << random_.uniform(0.0, 1.0) << "\n";
    floor();
    const double turn = random_.below(3) == 0 ? 0.5 * std::numbers::pi * static_cast<double>(random_.below(4))
                                              : random_.uniform(0.0, 6.3);
    out_ << "[[bodies]]\nname = \"b\"\n"
         << shape(size) << "\nposition = " << at(size * random_.uniform(-0.2, 0.2), size + height)
         << "\nangle = " << turn << "\n";
    if (random_.below(2))
      out_ << "velocity = [" << random_.uniform(-0.3, 0.3) << ", " << random_.uniform(-3.0, 0.0) << "]\n";
    if (random_.below(2))
      out_ << "angular_velocity = " << random_.uniform(-1.0, 1.0) * log_uniform(1.0, 100.0) << "\n";
    return out_.str();
  }

 private:
  double log_uniform(double low, double high) { return low * std::pow(high / low, random_.uniform()); }
  std::string at(double x, double y) const {
    std::ostringstream s;
    s << std::setprecision(17) << "[" << x_ + x << ", " << y_ + y << "]";
    return s.str();
  }

  void floor() {
    const std::string where = "\nposition = " + at(0, 0) + "\n";
    const double w = log_uniform(1e-3, 0.5);
    out_ << "[[sites]]\nname = \"floor\"\n";
    switch (random_.below(8)) {
      case 0:
        out_ << "segment = [[-30, 0], [30, 0]]" << where;
        break;
      case 1:
        out_ << "segment = [[-30, " << -w << "], [30, " << -w << "]]\nradius = " << w << where;
        break;
      case 2:
        out_ << "polygon = { vertices = [[-30, -1], [30, -1], [30, 0], [-30, 0]] }" << where;
        break;
      case 3: {  // a bowl of wire, or of something thick
        const double thick = random_.below(2) ? 0.5 * w : 0.0;
        out_ << "arc = { center = [0, " << 30.0 - thick << "], radius = 30, from_deg = 180, to_deg = 360 }";
        if (thick > 0.0) out_ << "\nradius = " << thick;
        out_ << where;
        break;
      }
      case 4:  // a hill
        out_ << "arc = { center = [0, -30], radius = 30, from_deg = 0, to_deg = 180 }" << where;
        break;
      case 5:
        out_ << "disc = { radius = 30 }\ninside_of = true\nposition = " << at(0, 30) << "\n";
        break;
      case 6:
        out_ << "polygon = { vertices = [[-30, 0], [30, 0], [30, 60], [-30, 60]] }\ninside_of = true"
             << where;
        break;
      default:  // a valley of wire
        out_ << "polyline = [[-30, 20], [0, 0], [30, 15]]" << where;
    }
  }

  std::string shape(double s) {
    std::ostringstream t;
    t << std::setprecision(17);
    switch (random_.below(7)) {
      case 0:
      case 1:
        t << "disc = { radius = " << 0.5 * s << " }";
        break;
      case 2:
        t << "box = { width = " << s << ", height = " << s * random_.uniform(0.2, 1.0) << " }";
        break;
      case 3:
        t << "box = { width = " << s << ", height = " << 1e-3 * s << " }";
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

  std::uint64_t seed_;
  Random random_;
  std::ostringstream out_;
  double x_ = 0, y_ = 0;
};

struct Tally {
  long drops = 0, wrong = 0;
  std::uint64_t hits = 0;
  std::map<std::string, long> endings;
};
inline std::ostream& operator<<(std::ostream& out, const Tally& t) {
  out << t.drops << " drops, " << t.hits << " hits, " << t.wrong << " wrong\n";
  for (const auto& [what, count] : t.endings) out << "  " << count << " x " << what << "\n";
  return out;
}

/// Lets one fall; false if it got into the floor, or through it.
inline bool fall(std::uint64_t seed, Tally& tally) {
  const std::string text = Maker(seed).make(), name = "drop_" + std::to_string(seed) + ".toml";
  const Scene scene = parse_scene(text, name);
  outside::WatchOptions options;
  options.until = scene.duration;
  outside::Watch watch(scene.world, options);
  ++tally.drops;
  worlds::Told told;
  try {
    told = worlds::run(scene, &watch);
  } catch (const BadInput& e) {
    testing::keep(name, text);
    std::cout << "drop " << seed << " is refused: " << e.what() << "\n";
    ++tally.wrong;
    return false;
  }
  tally.hits += told.summary.collisions;
  ++tally.endings[worlds::kind_of(told.summary.termination_text())];
  const bool caught = worlds::ended_by_watch(told.summary.termination_text());
  if (watch.sound() && !told.too_long && !caught) return true;
  ++tally.wrong;
  std::cout << "drop " << seed << (told.too_long ? ": broken off, too long" : "") << " ("
            << told.summary.collisions << " hits, " << told.summary.termination_text() << ")\n"
            << watch.report() << std::flush;
  testing::keep(name, text);
  return false;
}

}  // namespace brink::drops
