#pragma once
/// Random worlds such as people write: scene text of all shapes in all kinds of rooms, near and far, still
/// and whirling, with every material, in every order. A seed is a world.

#include <cmath>
#include <iomanip>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "brink/core/base/random.h"

namespace brink::worlds {

constexpr double kPi = std::numbers::pi;

/// What random worlds may hold.
struct Taste {
  bool far = true;      ///< places to 1e4 m, angles to 1e9 rad
  bool losses = true;   ///< restitution below 1, friction
  bool springs = true;  ///< integrated motions
  bool moving = true;   ///< sites that move as told
  bool periodic = true;
  double hits = 60;  ///< about so many collisions
  /// Every force, smooth integrators, held coordinates, unions, Bezier curves: worlds of their own, as all others stay
  /// what they are.
  bool all = false;
};

class Maker {
 public:
  Maker(std::uint64_t seed, const Taste& taste) : seed_(seed), random_(seed), taste_(taste) {}

  /// The scene's text.
  std::string make() {
    choose();
    head();
    room();
    things();
    if (springs_) tie();
    if (taste_.all) forces();
    return out_.str();
  }

 private:
  // ---- dice

  double uniform(double low, double high) { return random_.uniform(low, high); }
  double log_uniform(double low, double high) { return low * std::pow(high / low, random_.uniform()); }
  bool chance(double p) { return random_.uniform() < p; }
  int below(int n) { return static_cast<int>(random_.below(static_cast<std::uint64_t>(n))); }

  // ---- text

  static std::string text(double x) {
    std::ostringstream s;
    s << std::setprecision(17) << x;
    const std::string t = s.str();
    return t.find_first_of(".e") == std::string::npos ? t + ".0" : t;
  }
  static std::string text(double x, double y) { return "[" + text(x) + ", " + text(y) + "]"; }
  std::string place(double x, double y) const { return text(at_x_ + x, at_y_ + y); }
  static std::string ring(const std::vector<std::pair<double, double>>& points) {
    std::string s = "[";
    for (const auto& [x, y] : points) s += (s.size() > 1 ? ", " : "") + text(x, y);
    return s + "]";
  }

  // ---- the world at large

  enum class Room { disc, box, rounded, wires, thick, round_wire, saw, periodic, count };

  void choose() {
    columns_ = 2 + below(3);
    rows_ = 1 + below(3);
    pitch_ = chance(0.6) ? 1.0 : log_uniform(1e-2, 1e2);
    half_x_ = 0.5 * columns_ * pitch_;
    half_y_ = 0.5 * rows_ * pitch_;
    room_ = static_cast<Room>(below(static_cast<int>(Room::count) - (taste_.periodic ? 0 : 1)));
    if (taste_.far && chance(0.3)) {
      const double off = log_uniform(10.0, 1e4);
      at_x_ = std::round(uniform(-off, off) * 64.0) / 64.0;
      at_y_ = uniform(-off, off);
    }
    speed_ = pitch_ * (chance(0.8) ? 1.0 : log_uniform(1e-2, 1e2));
    spin_ = chance(0.7) ? 1.0 : log_uniform(1.0, 300.0);
    loss_ = taste_.losses && chance(0.6);
    springs_ = taste_.springs && chance(0.15);
    fall_ = chance(0.4) ? uniform(0.1, 2.0) * speed_ * speed_ / pitch_ : 0.0;
  }

  void head() {
    const double cells = columns_ * rows_;
    duration_ = taste_.hits / (0.8 * cells * (1.0 + 0.1 * spin_)) * pitch_ / speed_;
    out_ << "# random world " << seed_ << "\n[world]\nduration = " << text(std::max(duration_, 1e-9))
         << "\nseed = " << seed_ << "\n";
    if (fall_ > 0.0)
      out_ << "gravity = " << (chance(0.8) ? text(0.0, -fall_) : text(0.6 * fall_, 0.8 * fall_)) << "\n";
    if (room_ == Room::periodic) out_ << "periodic = " << text(2.0 * half_x_, 2.0 * half_y_) << "\n";
    // followed from outside by the impulses that are told; contacts that last have worlds of their own
    out_ << "[solver]\npersistent = false\nmax_collisions = 1500\n";
    const char* orders[] = {"closing_speed", "depth", "random", "lcp", "reflections"};
    if (chance(0.3)) out_ << "order = \"" << orders[below(5)] << "\"\n";
    if (springs_) out_ << "integrator = \"erk\"\n";
    if (const char* names[] = {"auto", "erk", "adams", "bdf"}; taste_.all && !springs_)
      out_ << "integrator = \"" << names[below(4)] << "\"\n";
    materials();
  }

  void materials() {
    const double e[] = {0.0, 0.0, 0.5, 0.9, 0.99, uniform(0.0, 1.0)};
    out_ << "[materials.default]\nrestitution = " << text(loss_ ? e[below(6)] : 1.0) << "\n";
    if (!loss_) return;
    if (chance(0.5)) out_ << "friction = " << text(uniform(0.0, 1.0)) << "\n";
    if (chance(0.2)) out_ << "tangential_restitution = " << text(uniform(-0.5, 1.0)) << "\n";
  }

  // ---- the room

  void site(const std::string& shape, double x, double y, const std::string& more = "") {
    out_ << "[[sites]]\n" << shape << "\nposition = " << place(x, y) << "\n" << more;
  }

  void room() {
    const double x = half_x_, y = half_y_, r = std::hypot(x, y);
    const std::string corners = ring({{-x, -y}, {x, -y}, {x, y}, {-x, y}});
    switch (room_) {
      case Room::disc:
        return site("disc = { radius = " + text(r) + " }\ninside_of = true", 0, 0);
      case Room::box:
        return site("polygon = { vertices = " + corners + " }\ninside_of = true", 0, 0);
      case Room::rounded:
        return site(
            "polygon = { vertices = " + ring({{-x - y, -y}, {0, -2 * y}, {x + y, -y}, {x, y}, {-x, y}}) +
                " }\ninside_of = true",
            0, 0);
      case Room::wires:
        return site("polyline = " + ring({{-x, -y}, {x, -y}, {x, y}, {-x, y}, {-x, -y}}), 0, 0);
      case Room::thick:
        return thick_walls(x, y);
      case Room::round_wire:
        return site("arc = { center = [0.0, 0.0], radius = " + text(r) + ", from_deg = 0, to_deg = 360 }", 0,
                    0);
      case Room::saw:
        return saw(x, y);
      default:
        return;
    }
  }

  void thick_walls(double x, double y) {
    const double w = pitch_ * log_uniform(1e-3, 0.2), X = x + w, Y = y + w;
    const std::pair<double, double> c[] = {{-X, -Y}, {X, -Y}, {X, Y}, {-X, Y}};
    for (int k = 0; k < 4; ++k)
      site("segment = " + ring({c[k], c[(k + 1) % 4]}) + "\nradius = " + text(w), 0, 0);
  }

  /// A wire box with a jagged floor.
  void saw(double x, double y) {
    std::vector<std::pair<double, double>> p{{-x, y}, {-x, -y}};
    const int teeth = 2 + below(4);
    for (int k = 0; k < teeth; ++k) {
      p.push_back({-x + (k + 0.5) * 2 * x / teeth, -y - 0.3 * pitch_});
      p.push_back({-x + (k + 1) * 2 * x / teeth, -y});
    }
    p.push_back({x, y});
    p.push_back({-x, y});
    site("polyline = " + ring(p), 0, 0);
  }

  // ---- what is in it: a thing a cell

  void things() {
    for (int k = 0; k < columns_ * rows_; ++k) {
      const double x = (k % columns_ + 0.5) * pitch_ - half_x_, y = (k / columns_ + 0.5) * pitch_ - half_y_;
      if (bodies_ > 0 && chance(0.15))
        obstacle(x, y);
      else if (bodies_ == 0 || chance(0.9))
        body(x, y);
    }
  }

  std::string angle() {
    const double a = chance(0.25) ? 0.5 * kPi * below(4) : uniform(0.0, 2.0 * kPi);
    if (!taste_.far || !chance(0.1)) return text(a);
    return text(a + std::round(log_uniform(1.0, 1.5e8)) * 2.0 * kPi);
  }

  void body(double x, double y) {
    const double size = pitch_ * 0.3 * log_uniform(0.3, 1.0);
    // what is held does not move
    static const char* const locks[] = {"x", "y", "angle", "x\", \"angle", "y\", \"angle"};
    const std::string lock = taste_.all && chance(0.15) ? locks[below(5)] : "";
    const auto moves = [&](const char* coordinate) {
      return lock.find(coordinate) == std::string::npos ? 1.0 : 0.0;
    };
    out_ << "[[bodies]]\nname = \"b" << bodies_++ << "\"\n"
         << (taste_.all && chance(0.15) ? joined(size) : solid_or_wire(size))
         << "\nposition = " << place(x, y) << "\nangle = " << angle() << "\nvelocity = "
         << text(moves("x") * uniform(-speed_, speed_), moves("y") * uniform(-speed_, speed_))
         << "\nangular_velocity = " << text(moves("angle") * uniform(-spin_, spin_) * speed_ / pitch_)
         << "\n";
    if (chance(0.7)) out_ << "mass = " << text(log_uniform(0.3, 5.0)) << "\n";
    if (!lock.empty()) out_ << "lock = [\"" << lock << "\"]\n";
  }

  void obstacle(double x, double y) {
    const double s = 0.25 * pitch_;
    std::string more;
    if (taste_.moving && chance(0.4)) more = motion();
    if (taste_.all && chance(0.25)) return site("bezier = " + bend(s), x, y, more);
    switch (below(6)) {
      case 0:
        return site("point = [0.0, 0.0]", x, y, more);
      case 1:
        return site("segment = " + ring({{-s, 0.0}, {s, 0.3 * s}}), x, y, more);
      case 2:
        return site(
            "segment = " + ring({{-s, 0.0}, {s, 0.3 * s}}) + "\nradius = " + text(s * log_uniform(1e-3, 0.3)),
            x, y, more);
      case 3:
        return site("arc = { center = [0.0, 0.0], radius = " + text(s) + ", from_deg = " +
                        text(uniform(0, 300)) + ", to_deg = " + text(uniform(310, 600)) + " }",
                    x, y, more);
      default:
        return site(solid_or_wire(s), x, y, more);
    }
  }

  std::string motion() {
    const double w = speed_ / pitch_;
    switch (below(3)) {
      case 0:
        return "motion = { angular_velocity = " + text(uniform(-2, 2) * w) + " }\n";
      case 1:
        return "motion = { y = \"" + text(0.1 * pitch_) + "*sin(" + text(uniform(1, 6) * w) + "*t)\" }\n";
      default:
        return "motion = { angle = \"sin(" + text(uniform(1, 3) * w) + "*t)\", x = \"" + text(0.05 * pitch_) +
               "*(1-cos(" + text(uniform(1, 6) * w) + "*t))\" }\n";
    }
  }

  // ---- shapes that a body may have, within about `s` of their centre

  std::string solid_or_wire(double s) {
    switch (below(12)) {
      case 0:
      case 1:
        return "disc = { radius = " + text(s) + " }";
      case 2:
        return "box = { width = " + text(1.4 * s) + ", height = " + text(s * uniform(0.2, 1.4)) + " }";
      case 3:
        return "box = { width = " + text(s) + ", height = " + text(0.7 * s) +
               ", radius = " + text(s * log_uniform(1e-4, 0.2)) + " }";
      case 4:
        return "polygon = { vertices = " + spikes(3 + below(3), 0.9 * s, uniform(0.3, 0.6)) + " }";
      case 5:
        return "polygon = { vertices = " + spikes(3 + below(3), 0.8 * s, 0.5) +
               ", radius = " + text(s * log_uniform(1e-3, 0.1)) + " }";
      case 6:
        return "capsule = { length = " + text(s) + ", radius = " + text(s * log_uniform(1e-2, 0.4)) + " }";
      case 7:
        return "box = { width = " + text(1.8 * s) + ", height = " + text(1.8e-3 * s) + " }";
      case 8:
        return "chain = { vertices = " + loop(3 + below(5), s, 1.2 * kPi) +
               (chance(0.3) ? ", radius = " + text(0.03 * s) : "") + " }";
      case 9:
        return "chain = { closed = true, vertices = " + loop(3 + below(5), s, 2.0 * kPi) +
               (chance(0.3) ? ", radius = " + text(0.03 * s) : "") + " }";
      case 10:
        return "path = { d = \"" + std::string(path()) + "\", scale = " + text(0.8 * s) + " }";
      default:
        return "polygon = { vertices = " + loop(3 + below(4), s, 2.0 * kPi) + " }";
    }
  }

  /// Two boxes across each other: an L, a T, a cross.
  std::string joined(double s) {
    const double w = s * uniform(0.15, 0.5), x = s * uniform(-0.6, 0.6), y = s * uniform(-0.6, 0.6);
    const auto part = [](double x0, double y0, double x1, double y1) {
      return "{ vertices = " + ring({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}) + " }";
    };
    return "polygons = [" + part(-0.7 * s, y - 0.5 * w, 0.7 * s, y + 0.5 * w) + ", " +
           part(x - 0.5 * w, -0.7 * s, x + 0.5 * w, 0.7 * s) + "]";
  }
  /// A bow or an S.
  std::string bend(double s) {
    return "[" + text(-s, 0.0) + ", " + text(-0.3 * s, uniform(-s, s)) + ", " +
           text(0.3 * s, uniform(-s, s)) + ", " + text(s, 0.0) + "]";
  }

  std::string spikes(int n, double s, double inner) const {
    std::vector<std::pair<double, double>> p;
    for (int k = 0; k < 2 * n; ++k) {
      const double r = k % 2 ? inner * s : s;
      p.push_back({r * std::cos(kPi * k / n), r * std::sin(kPi * k / n)});
    }
    return ring(p);
  }
  std::string loop(int n, double s, double turn) {
    std::vector<std::pair<double, double>> p;
    for (int k = 0; k < n; ++k) {
      const double r = s * uniform(0.6, 0.9), a = turn * k / n;
      p.push_back({r * std::cos(a), r * std::sin(a)});
    }
    return ring(p);
  }
  const char* path() {
    static const char* const paths[] = {
        "M -1 0 A 1 1 0 0 1 1 0 Z", "M -1 0 A 1.2 1.2 0 0 1 1 0 A 2 2 0 0 0 -1 0 Z",
        "M -1 -0.3 L 1 -0.3 L 1 0.3 A 0.5 0.5 0 0 0 0 0.3 A 0.5 0.5 0 0 0 -1 0.3 Z",
        "M -1 0 A 1.1 1.1 0 0 1 1 0 A 1.1 1.1 0 0 1 -1 0 Z",
        "M -1 0 A 0.5 0.5 0 0 1 0 0 A 0.5 0.5 0 0 0 1 0"};
    return paths[below(5)];
  }

  void tie() {
    for (int k = 0; k + 1 < bodies_ && k < 2; ++k)
      out_ << "[[forces]]\nkind = \"spring\"\nbodies = [\"b" << k << "\", \"b" << k + 1
           << "\"]\nstiffness = " << text(uniform(0.2, 2.0) * speed_ * speed_ / (pitch_ * pitch_))
           << "\nrest_length = " << text(pitch_) << "\n";
  }

  // ---- forces of every kind, as large as what turns a body round within a cell or two

  void forces() {
    const double pull = uniform(0.1, 1.0) * speed_ * speed_ / pitch_, rate = speed_ / pitch_;
    for (int k = 1 + below(3); k > 0; --k) {
      const std::string one = "\"b" + std::to_string(below(bodies_)) + "\"";
      out_ << "[[forces]]\n";
      // Of a plane that repeats itself only what does not depend on the place.
      switch (below(room_ == Room::periodic ? 3 : 6)) {
        case 0:
          out_ << "kind = \"drag\"\nlinear = " << text(uniform(0.0, 0.3) * rate);
          if (chance(0.5)) out_ << "\nquadratic = " << text(uniform(0.0, 0.3) / pitch_);
          if (chance(0.5)) out_ << "\nangular = " << text(uniform(0.0, 0.03) * rate * pitch_ * pitch_);
          break;
        case 1: {
          const double from = uniform(0.0, 0.5) * duration_;
          out_ << "kind = \"thrust\"\nbody = " << one
               << "\nforce = " << text(uniform(-pull, pull), uniform(-pull, pull))
               << "\ntorque = " << text(uniform(-0.1, 0.1) * pull * pitch_);
          if (chance(0.7))
            out_ << "\nfrom = " << text(from) << "\nto = " << text(from + uniform(0.1, 0.5) * duration_);
          break;
        }
        case 2:
          out_ << "kind = \"formula\"\nfx = \"" << text(pull) << "*m*sin(" << text(uniform(0.5, 6.0) * rate)
               << "*t)\"\ntorque = \"" << text(-0.01 * rate * pitch_ * pitch_) << "*omega\"";
          break;
        case 3:
          out_ << "kind = \"formula\"\nbodies = [" << one << "]\nfx = \"" << text(-pull / pitch_) << "*(x - ("
               << text(at_x_) << "))\"\nfy = \"" << text(0.3 * rate) << "*vx\"";
          break;
        case 4: {
          // Nobody gets to the centre of one that pulls without bounds there.
          const bool outside = chance(0.5);
          const double off = outside ? 3.0 * (half_x_ + half_y_) : 0.0;
          out_ << "kind = \"attract\"\ncenter = " << place(off, 0.3 * off)
               << "\nstrength = " << text(outside ? pull * off * off : pull / pitch_)
               << "\npower = " << (outside ? "-2" : "1");
          break;
        }
        default:
          out_ << "kind = \"spring\"\nbody = " << one << "\nanchor = " << place(0.3 * half_x_, 0.2 * half_y_)
               << "\nat = " << text(0.05 * pitch_, 0.0) << "\nstiffness = " << text(pull / pitch_)
               << "\ndamping = " << text(uniform(0.0, 0.2) * rate)
               << "\nrest_length = " << text(0.2 * pitch_);
      }
      out_ << "\n";
    }
  }

  std::uint64_t seed_;
  Random random_;
  Taste taste_;
  std::ostringstream out_;
  int columns_ = 0, rows_ = 0, bodies_ = 0;
  double pitch_ = 1, half_x_ = 1, half_y_ = 1, at_x_ = 0, at_y_ = 0, speed_ = 1, spin_ = 1, fall_ = 0,
         duration_ = 1;
  Room room_ = Room::box;
  bool loss_ = false, springs_ = false;
};

inline std::string random_world(std::uint64_t seed, const Taste& taste = {}) {
  return Maker(seed, taste).make();
}

}  // namespace brink::worlds
