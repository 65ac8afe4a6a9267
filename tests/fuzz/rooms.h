#pragma once
/// Elastic bodies alone in rooms of wires, for thousands of hits: they must stay in them. Rooms are convex,
/// so that "in" is plain: every corner of the body on the inner side of every wall.

#include <cmath>
#include <iomanip>
#include <iostream>
#include <numbers>
#include <sstream>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/simulator/simulator.h"
#include "tests/support/outside/flight.h"
#include "tests/support/outside/gap.h"

namespace brink::rooms {

/// One body in one room, as a scene.
struct Case {
  std::string text;
  std::vector<outside::Vec> corners;  ///< of the room about its place, counter-clockwise; none: round
  outside::Vec place;
  outside::Real size = 1;  ///< of the room: its radius [m]
  double seconds = 1;      ///< a rough time for one hit [s]
};

/// How far rooms are from the origin.
enum class Away {
  any,     ///< at it, or to 1e4 m
  coarse,  ///< about where the rounding of a place is 1/1024 of the contact tolerance, so that doubles and
           ///< extended precision take turns (`kFarOfTolerance`)
};

class Maker {
 public:
  explicit Maker(std::uint64_t seed, Away away = Away::any) : seed_(seed), away_(away), random_(seed) {}

  Case make() {
    Case c;
    size_ = log_uniform(0.2, 20.0);
    const double far = how_far();
    x_ = random_.uniform(-far, far);
    y_ = random_.uniform(-far, far);
    c.place = {x_, y_};
    c.size = size_;
    const double body = size_ * log_uniform(0.05, 0.3), speed = body * log_uniform(0.3, 300.0);
    // hits come by flight across the room, or, of what turns fast, in bursts
    c.seconds = 1.5 * size_ / speed;
    out_ << std::setprecision(17) << "# room " << seed_ << "\n[world]\nduration = 1.0\n";
    walls(c);
    out_ << "[[bodies]]\nname = \"b\"\n"
         << shape(body) << "\nposition = "
         << at(0.3 * size_ * (random_.uniform() - 0.5), 0.3 * size_ * (random_.uniform() - 0.5))
         << "\nangle = " << random_.uniform(0.0, 6.3) << "\nvelocity = [" << speed * std::cos(heading_)
         << ", " << speed * std::sin(heading_)
         << "]\nangular_velocity = " << speed / body * random_.uniform(-2.0, 2.0) << "\n";
    c.text = out_.str();
    return c;
  }

 private:
  double how_far() {
    if (away_ == Away::coarse) return size_ * log_uniform(30.0, 3e5);
    return random_.below(3) == 0 ? 0.0 : log_uniform(1.0, 1e4);
  }

  double log_uniform(double low, double high) { return low * std::pow(high / low, random_.uniform()); }
  std::string at(double x, double y) const {
    std::ostringstream s;
    s << std::setprecision(17) << "[" << x_ + x << ", " << y_ + y << "]";
    return s.str();
  }

  /// Written about the place, or at it, with coordinates that hold it.
  void walls(Case& c) {
    heading_ = random_.uniform(0.0, 6.3);
    const int kind = static_cast<int>(random_.below(5));
    if (kind == 4) {
      out_ << "[[sites]]\narc = { center = [0.0, 0.0], radius = " << size_
           << ", from_deg = 0, to_deg = 360 }\nposition = " << at(0, 0) << "\n";
      return;
    }
    const int n = kind == 0 ? 3 : kind == 1 ? 4 : 3 + static_cast<int>(random_.below(5));
    const double turn = kind == 1 ? std::numbers::pi / 4 : random_.uniform(0.0, 6.3);
    const bool about = random_.below(2) == 0, apart = random_.below(2) == 0;
    for (int k = 0; k < n; ++k) {
      double x = size_ * std::cos(turn + 2 * std::numbers::pi * k / n),
             y = size_ * std::sin(turn + 2 * std::numbers::pi * k / n);
      if (!about) x = (x_ + x) - x_, y = (y_ + y) - y_;  // as it comes out of the sum
      c.corners.push_back({x, y});
    }
    const auto corner = [&](int k) {
      std::ostringstream s;
      const auto& p = c.corners[k % n];
      s << std::setprecision(17) << "[" << static_cast<double>(p.x) + (about ? 0 : x_) << ", "
        << static_cast<double>(p.y) + (about ? 0 : y_) << "]";
      return s.str();
    };
    const std::string where = about ? "\nposition = " + at(0, 0) + "\n" : "\n";
    if (apart) {
      for (int k = 0; k < n; ++k)
        out_ << "[[sites]]\nsegment = [" << corner(k) << ", " << corner(k + 1) << "]" << where;
      return;
    }
    out_ << "[[sites]]\npolyline = [";
    for (int k = 0; k <= n; ++k) out_ << (k ? ", " : "") << corner(k);
    out_ << "]" << where;
  }

  std::string shape(double s) {
    std::ostringstream t;
    t << std::setprecision(17);
    switch (random_.below(4)) {
      case 0:
        t << "box = { width = " << s << ", height = " << s * random_.uniform(0.2, 1.0) << " }";
        break;
      case 1:
        t << "polygon = { vertices = [[" << -0.5 * s << ", " << -0.3 * s << "], [" << 0.5 * s << ", "
          << -0.4 * s << "], [" << s * random_.uniform(-0.5, 0.5) << ", " << 0.5 * s << "]] }";
        break;
      case 2: {
        const int n = 3 + static_cast<int>(random_.below(4));
        t << "polygon = { vertices = [";
        for (int k = 0; k < 2 * n; ++k) {
          const double r = k % 2 ? 0.25 * s : 0.6 * s, a = std::numbers::pi * k / n;
          t << (k ? ", " : "") << "[" << r * std::cos(a) << ", " << r * std::sin(a) << "]";
        }
        t << "] }";
        break;
      }
      default:
        t << "box = { width = " << s << ", height = " << 1e-3 * s << " }";
    }
    return t.str();
  }

  std::uint64_t seed_;
  Away away_;
  Random random_;
  std::ostringstream out_;
  double size_ = 1, x_ = 0, y_ = 0, heading_ = 0;
};

/// How far the body stands out of its room [m]; < 0: it is inside.
inline outside::Real out_of(const Case& c, const outside::Shape& body, const outside::State& s) {
  using namespace outside;
  outside::Real most = -kNever;
  const Turn turn(s.place.angle);
  for (const Piece& piece : body.pieces) {
    const Vec p = turn(piece.a) + s.place.at - c.place;
    if (c.corners.empty()) most = std::max(most, norm(p) - c.size);
    for (std::size_t k = 0; k < c.corners.size(); ++k) {
      const Vec& a = c.corners[k];
      const Vec along = c.corners[(k + 1) % c.corners.size()] - a;
      most = std::max(most, -wedge(along, p - a) / norm(along));
    }
  }
  return most;
}

struct Tally {
  long rooms = 0, escaped = 0, energy_lost = 0, ended = 0;
  long refused = 0;  ///< too small for where they are, and said so
  std::uint64_t hits = 0;
};
inline std::ostream& operator<<(std::ostream& out, const Tally& t) {
  return out << t.rooms << " rooms, " << t.hits << " hits, " << t.escaped << " escaped, " << t.energy_lost
             << " with another energy, " << t.ended << " ended early, " << t.refused << " refused\n";
}

/// Runs a room for about `hits` hits; tells what went wrong.
inline void stay(std::uint64_t seed, std::uint64_t hits, Tally& tally, Away away = Away::any) {
  const Case c = Maker(seed, away).make();
  const Scene scene = parse_scene(c.text, "room_" + std::to_string(seed) + ".toml");
  const outside::Shape body = outside::shape_of(*scene.world.bodies[0].outline);
  Simulator simulator(scene.world, scene.solver);
  RunOptions options;
  options.checkpoint_seconds = -1.0;
  options.record_events = false;
  ++tally.rooms;
  std::uint64_t met = 0;
  RunSummary summary;
  const auto tell = [&](long& count, const std::string& what) {
    ++count;
    std::cout << "room " << seed << ": " << what << " after " << summary.collisions
              << " hits, t = " << std::setprecision(17) << simulator.time() << std::setprecision(6) << "\n"
              << std::flush;
  };
  for (int part = 1; met < hits && part < 100000; ++part) {
    options.until = c.seconds * 20.0 * part;
    summary = simulator.run(options);
    const outside::State now = outside::state_of(simulator.state(0));
    const outside::Real out = out_of(c, body, now);
    const outside::Real rounding = 1e-9L * c.size + 16 * outside::kUlp * outside::norm(now.place.at);
    met = summary.collisions;
    if (!(out <= rounding)) {
      tell(tally.escaped, "it is " + std::to_string(static_cast<double>(out)) + " m out of its room");
      break;
    }
    if (summary.termination != Termination::reached_end) {
      const bool refused = summary.why.find("too far from the origin") != std::string::npos;
      tell(refused ? tally.refused : tally.ended, summary.termination_text());
      break;
    }
  }
  tally.hits += met;
  if (summary.termination == Termination::reached_end &&
      !(std::abs(summary.energy_final / summary.energy_initial - 1.0) <= 1e-9))
    tell(tally.energy_lost, "energy " + std::to_string(summary.energy_initial) + " J -> " +
                                std::to_string(summary.energy_final) + " J");
}

}  // namespace brink::rooms
