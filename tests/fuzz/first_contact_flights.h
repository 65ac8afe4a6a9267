#pragma once
/// Random flights of two random outlines: every kind of shape, still and spinning, slow and fast, falling and
/// kicked.

#include <array>
#include <cmath>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>

#include "brink/core/base/random.h"
#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/kernel/site_motion.h"
#include "first_contact_reference.h"

namespace brink::flights {

constexpr double kPi = std::numbers::pi;

inline double log_uniform(Random& r, double low, double high) {
  return low * std::pow(high / low, r.uniform());
}
inline Vec2 direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

// ---- outlines: about as large as `size`

inline Outline star(Random& r, double size, double radius) {
  std::vector<Vec2> p;
  const int n = 3 + static_cast<int>(r.below(5));
  for (int k = 0; k < 2 * n; ++k)
    p.push_back(size * (k % 2 ? r.uniform(0.25, 0.6) : r.uniform(0.7, 1.0)) * direction(kPi * k / n));
  return make_polygon(p, radius).outline;
}

inline Outline saw(Random& r, double size) {
  const int teeth = 2 + static_cast<int>(r.below(5));
  const double step = 2.0 * size / teeth, depth = step * r.uniform(0.3, 2.0);
  std::vector<Vec2> p{{-size, -0.3 * size - depth}, {size, -0.3 * size - depth}};
  for (int k = teeth; k > 0; --k) {
    p.push_back({-size + k * step, 0.0});
    p.push_back({-size + (k - r.uniform(0.6, 1.0)) * step, -depth});
  }
  return make_polygon(p).outline;
}

inline Outline wire(Random& r, double size, bool closed) {
  std::vector<Vec2> p;
  const int n = 3 + static_cast<int>(r.below(6));
  for (int k = 0; k < n; ++k)
    p.push_back(size * r.uniform(0.4, 1.0) * direction((closed ? 2.0 : 1.2) * kPi * k / n));
  return make_chain(p, closed, r.below(3) == 0 ? size * log_uniform(r, 1e-4, 0.1) : 0.0).outline;
}

inline Outline rounded_path(Random& r, double size) {
  static const std::array<const char*, 5> paths{
      "M -1 0 A 1 1 0 0 1 1 0 Z",                                                   // half a disc
      "M -1 0 A 1.2 1.2 0 0 1 1 0 A 2 2 0 0 0 -1 0 Z",                              // a moon
      "M -1 -0.3 L 1 -0.3 L 1 0.3 A 0.5 0.5 0 0 0 0 0.3 A 0.5 0.5 0 0 0 -1 0.3 Z",  // two bites
      "M -1 0 A 1.1 1.1 0 0 1 1 0 A 1.1 1.1 0 0 1 -1 0 Z",                          // a lens
      "M -1 0 A 0.5 0.5 0 0 1 0 0 A 0.5 0.5 0 0 0 1 0",                             // an S of wire
  };
  return make_path(paths[r.below(paths.size())], size, 1e-3).outline;
}

inline constexpr int kShapes = 16;
inline constexpr std::array<const char*, kShapes> kShapeNames{
    "disc", "box", "rounded box", "star", "rounded star", "capsule", "needle",  "chain",
    "ring", "arc", "path",        "saw",  "segment",      "point",   "annulus", "polygon"};

inline Outline random_outline(Random& r, int kind, double size) {
  switch (kind) {
    case 0:
      return make_disc(size * log_uniform(r, 0.1, 1.0)).outline;
    case 1:
      return make_box(size * r.uniform(0.2, 2.0), size * r.uniform(0.2, 2.0)).outline;
    case 2:
      return make_box(size, size * r.uniform(0.2, 1.0), size * log_uniform(r, 1e-4, 0.5)).outline;
    case 3:
      return star(r, size, 0.0);
    case 4:
      return star(r, 0.7 * size, size * log_uniform(r, 1e-4, 0.1));
    case 5:
      return make_capsule(2.0 * size * r.uniform(0.2, 1.0), size * log_uniform(r, 1e-3, 0.5)).outline;
    case 6:
      return make_box(2.0 * size, 1e-4 * size).outline;
    case 7:
      return wire(r, size, false);
    case 8:
      return wire(r, size, true);
    case 9: {
      const double from = r.uniform(0.0, 2.0 * kPi);
      return make_arc(Vec2::Zero(), size * r.uniform(0.3, 1.0), from, from + r.uniform(0.2, 7.0),
                      r.below(2) ? size * log_uniform(r, 1e-4, 0.1) : 0.0)
          .outline;
    }
    case 10:
      return rounded_path(r, size);
    case 11:
      return saw(r, size);
    case 12:
      return make_segment({-size, 0.0}, {size, 0.0}, 0.0).outline;
    case 13:
      return make_point(Vec2::Zero(), 0.0).outline;
    case 14:
      return make_path(
                 "M -1 0 A 1 1 0 0 1 1 0 A 1 1 0 0 1 -1 0 Z M -0.6 0 A 0.6 0.6 0 0 1 0.6 0 "
                 "A 0.6 0.6 0 0 1 -0.6 0 Z",
                 size, 1e-3)
          .outline;
    default: {
      std::vector<Vec2> p;
      const int n = 3 + static_cast<int>(r.below(6));
      for (int k = 0; k < n; ++k) p.push_back(size * direction(2.0 * kPi * (k + r.uniform(-0.3, 0.3)) / n));
      return make_polygon(p).outline;
    }
  }
}

// ---- flights

struct Flight {
  std::shared_ptr<const Outline> a, b;
  Motion motion_a, motion_b;
  double from = 0.0, to = 0.0;
  double relative_speed = 0.0, spin_a = 0.0, spin_b = 0.0;  ///< bounds over [from, to]
  double size = 1.0;
  double relative_acceleration = 0.0;
  std::string story;
  /// Far away, or turned many times: the same flight near by, for the reference. Starts there are such that
  /// going far rounds nothing, so that both are one flight to the last digit.
  bool far = false;
  Motion near_a, near_b;

  reference::Pair pair() const {
    return {a.get(), b.get(), far ? &near_a : &motion_a, far ? &near_b : &motion_b, relative_speed,
            spin_a,  spin_b};
  }
};

/// The same ballistic motion through random cubic pieces, with random kicks of its knots.
inline Motion dense_like(Random& r, const Motion& plain, double from, double to, double kick, double turn,
                         double& speed, double& spin, double& acceleration) {
  auto track = std::make_shared<Track>();
  const int n = 1 + static_cast<int>(r.below(6));
  const double h = (to - from) / n;
  const auto knot = [&](int k) {
    const BodyState s = plain.state(from + k * h);
    const auto u = [&] { return k == 0 ? 0.0 : r.uniform(-1.0, 1.0); };  // starts where it was put: apart
    Eigen::Matrix<double, 3, 2> m;
    m << s.pose.position.x() + kick * u(), s.twist.velocity.x() + kick / h * u(),  //
        s.pose.position.y() + kick * u(), s.twist.velocity.y() + kick / h * u(),   //
        s.pose.angle + turn * u(), s.twist.omega + turn / h * u();
    return m;
  };
  auto left = knot(0);
  speed = spin = acceleration = 0.0;
  for (int k = 0; k < n; ++k) {
    const auto right = knot(k + 1);
    PolynomialPiece piece;
    piece.c.fill(Eigen::Vector3d::Zero());
    piece.begin = piece.origin = from + k * h;
    piece.end = k + 1 == n ? to : from + (k + 1) * h;
    piece.degree = 3;
    const double w = piece.end - piece.begin;
    piece.c[0] = left.col(0);
    piece.c[1] = left.col(1);
    piece.c[2] = (3.0 * (right.col(0) - left.col(0)) / w - 2.0 * left.col(1) - right.col(1)) / w;
    piece.c[3] = (2.0 * (left.col(0) - right.col(0)) / w + left.col(1) + right.col(1)) / (w * w);
    const Eigen::Vector3d rate =
        piece.c[1].cwiseAbs() + 2.0 * w * piece.c[2].cwiseAbs() + 3.0 * w * w * piece.c[3].cwiseAbs();
    const Eigen::Vector3d second = 2.0 * piece.c[2].cwiseAbs() + 6.0 * w * piece.c[3].cwiseAbs();
    speed = std::max(speed, rate.head<2>().norm());
    spin = std::max(spin, rate.z());
    acceleration = std::max(acceleration, second.head<2>().norm() + second.z());
    track->pieces.push_back(piece);
    left = right;
  }
  return Motion::dense(track);
}

inline double largest_spin(const Motion& m, double from, double to) {
  return std::max(std::abs(m.twist(from).omega), std::abs(m.twist(to).omega));
}

/// What is left of an angle after whole turns, to the last digit of a double.
inline double without_turns(double angle) {
  constexpr long double kTurn = 2.0L * std::numbers::pi_v<long double>, kRest = -1.00331152253366640476e-19L;
  const long double turns = std::round(angle / kTurn);
  return static_cast<double>(std::fma(-turns, kTurn, static_cast<long double>(angle)) - turns * kRest);
}

/// The same ballistic flight up to 1e9 sizes away, and up to 1e9 rad turned.
inline void go_far(Flight& f, Random& r) {
  const double place = std::ldexp(1.0, std::ilogb(f.size) + 4 + static_cast<int>(r.below(27)));
  const double grain = place * std::ldexp(1.0, -50);
  const Vec2 by = place * Vec2(r.below(2) ? 1.0 : -1.0, r.below(2) ? 1.0 : 0.0);
  const bool turned = r.below(2) == 0;
  const auto move = [&](Motion& motion, Motion& near) {
    BodyState start = motion.start();
    start.pose.position = grain * (start.pose.position / grain).array().round().matrix();
    BodyState there = start;
    there.pose.position += by;
    if (turned) there.pose.angle += log_uniform(r, 10.0, 1e9);
    start.pose.angle = without_turns(there.pose.angle);
    near = Motion::ballistic(motion.origin(), start, motion.acceleration());
    motion = Motion::ballistic(motion.origin(), there, motion.acceleration());
  };
  move(f.motion_a, f.near_a);
  move(f.motion_b, f.near_b);
  f.far = true;
  std::ostringstream story;
  story << ", " << place / f.size << " sizes away" << (turned ? ", turned" : "");
  f.story += story.str();
}

/// a moves as told by a formula instead: it swings beside its path.
inline void swing(Flight& f, Random& r) {
  const double length = f.to - f.from, rate = r.uniform(0.5, 20.0) / length;
  const double wide = 0.3 * f.size * r.uniform(0.0, 1.0), turn = r.uniform(0.0, 1.0);
  const Vec2 side = direction(r.uniform(0.0, 6.3));
  const BodyState& start = f.motion_a.start();
  const Acceleration& pull = f.motion_a.acceleration();
  // start + s (rate + s / 2 pull) + swing sin(rate (t - from)), s = t - origin
  const auto told = [&](double place, double speed, double bent, double swung) {
    std::ostringstream text;
    text << std::setprecision(17) << "(" << place << ") + (t - (" << f.motion_a.origin() << "))*((" << speed
         << ") + (" << 0.5 * bent << ")*(t - (" << f.motion_a.origin() << "))) + (" << swung << ")*sin(("
         << rate << ")*(t - (" << f.from << ")))";
    return Formula(text.str(), {"t"});
  };
  FixedSite site;
  site.name = "a";
  site.motion =
      FormulaMotion{told(start.pose.position.x(), start.twist.velocity.x(), pull.linear.x(), wide * side.x()),
                    told(start.pose.position.y(), start.twist.velocity.y(), pull.linear.y(), wide * side.y()),
                    told(start.pose.angle, start.twist.omega, pull.angular, turn)};
  SiteMotion motion(site);
  if (motion.extend(f.to).status != Extent::Status::reached) return;
  f.motion_a = motion.motion();
  f.relative_speed += wide * rate;
  f.relative_acceleration += wide * rate * rate;
  f.spin_a += turn * rate;
  f.story += ", told by a formula";
}

/// Two bodies that come at each other, or pass by. A container, or a ring, may hold the other from the start.
inline Flight random_flight(std::uint64_t seed) {
  Random r(seed);
  Flight f;
  std::ostringstream story;
  f.size = log_uniform(r, 0.2, 5.0);
  const bool container = r.below(12) == 0;
  int kind_a = static_cast<int>(r.below(kShapes)), kind_b = static_cast<int>(r.below(kShapes));
  if (r.below(10) == 0) kind_a = 0;
  if (r.below(10) == 0) kind_b = r.below(2) ? 1 : 12;  // more pairs with closed forms
  double room = 0.0;
  Outline a, b;
  if (container) {
    const bool round = r.below(2) == 0;
    a = round ? make_disc_container(2.0 * f.size).outline
              : as_container(make_box(4.0 * f.size, 4.0 * f.size).outline);
    room = 2.0 * f.size;
    b = random_outline(r, kind_b, f.size * r.uniform(0.1, 0.5));
    story << (round ? "disc container" : "box container");
  } else {
    a = random_outline(r, kind_a, f.size);
    b = random_outline(r, kind_b, f.size * log_uniform(r, 0.1, 1.0));
    story << kShapeNames[kind_a];
  }
  story << " / " << kShapeNames[kind_b];
  if (!container && r.below(10) == 0) {
    a = transformed(a, {f.size * direction(r.uniform(0.0, 6.0)), r.uniform(0.0, 6.0)});
    story << ", a off its origin";
  }
  const double reach = a.bounding_radius + b.bounding_radius;

  const double speed = f.size * log_uniform(r, 1e-3, 1e5);
  const double heading =
      r.below(4) == 0 ? 0.5 * kPi * static_cast<double>(r.below(4)) : r.uniform(0.0, 2.0 * kPi);
  const Vec2 ahead = direction(heading);
  double lead = 0.0;
  Vec2 offset;  // of b from a at `from`
  if (container) {
    offset = (room - b.bounding_radius) * r.uniform(0.0, 0.95) * direction(r.uniform(0.0, 6.3));
    lead = 2.0 * room;
  } else {
    lead = reach * r.uniform(1.01, 2.0);
    const double miss = r.below(5) == 0 ? 0.0 : reach * r.uniform(-1.0, 1.0) * r.uniform(0.2, 1.0);
    offset = -lead * ahead + miss * perp(ahead);
    if (offset.norm() < 1.001 * reach) offset *= 1.001 * reach / offset.norm();
  }
  const double length = (lead + reach) / speed;
  const double origin = r.below(2) ? 0.0 : r.uniform(0.0, 10.0);
  f.from = origin + (r.below(2) ? 0.0 : r.uniform(0.0, 0.1) * length);
  f.to = f.from + length;

  const auto pick_spin = [&]() -> double {
    switch (r.below(4)) {
      case 0:
      case 1:
        return 0.0;
      case 2:
        return r.uniform(-2.0, 2.0) / length;
      default:
        return r.uniform(-60.0, 60.0) / length;
    }
  };
  const auto pick_angle = [&] {
    return r.below(3) == 0 ? 0.5 * kPi * static_cast<double>(r.below(4)) : r.uniform(0.0, 6.3);
  };
  const double fall = f.size * r.uniform(0.0, 2.0) / (length * length);
  Acceleration ga, gb;
  const Vec2 down = r.below(2) ? Vec2(0.0, -1.0) : direction(r.uniform(0.0, 6.3));
  switch (r.below(5)) {
    case 0:
      ga.linear = gb.linear = fall * down;
      story << ", same gravity";
      break;
    case 1:
      gb.linear = fall * down;
      story << ", b falls";
      break;
    case 2:
      ga.linear = fall * direction(r.uniform(0.0, 6.3));
      gb.linear = fall * direction(r.uniform(0.0, 6.3));
      if (r.below(2)) ga.angular = r.uniform(-5.0, 5.0) / (length * length);
      story << ", two accelerations";
      break;
    default:
      break;
  }
  const Vec2 drift =
      r.below(2) ? Vec2::Zero() : Vec2(speed * r.uniform(0.0, 1.0) * direction(r.uniform(0.0, 6.3)));
  const Vec2 place =
      r.below(2) ? Vec2::Zero() : Vec2(f.size * r.uniform(0.0, 5.0) * direction(r.uniform(0.0, 6.3)));
  BodyState sa{{place, pick_angle()}, {drift, container ? 0.1 * pick_spin() : pick_spin()}};
  BodyState sb{{place + offset, pick_angle()}, {drift + speed * ahead, pick_spin()}};
  // states at `from`, taken back to the motions' origin
  const auto start_of = [&](const BodyState& s, const Acceleration& g) {
    const double back = origin - f.from;
    return BodyState{{s.pose.position + back * (s.twist.velocity + 0.5 * back * g.linear),
                      s.pose.angle + back * (s.twist.omega + 0.5 * back * g.angular)},
                     {s.twist.velocity + back * g.linear, s.twist.omega + back * g.angular}};
  };
  f.motion_a = Motion::ballistic(origin, start_of(sa, ga), ga);
  f.motion_b = Motion::ballistic(origin, start_of(sb, gb), gb);
  f.relative_speed = (sa.twist.velocity - sb.twist.velocity).norm() + length * (ga.linear - gb.linear).norm();
  f.relative_acceleration = (ga.linear - gb.linear).norm();
  if (r.below(4) == 0) {
    double va, vb, aa, ab;
    const double kick = container ? 0.0 : 0.2 * f.size * r.uniform();
    const double turn = r.uniform(0.0, 2.0);
    f.motion_a = dense_like(r, f.motion_a, f.from, f.to, kick, turn, va, f.spin_a, aa);
    f.motion_b = dense_like(r, f.motion_b, f.from, f.to, 0.5 * kick, turn, vb, f.spin_b, ab);
    f.relative_speed = va + vb;
    f.relative_acceleration = aa + ab;
    story << ", dense";
  } else {
    f.spin_a = largest_spin(f.motion_a, f.from, f.to);
    f.spin_b = largest_spin(f.motion_b, f.from, f.to);
  }
  story << ", speed " << speed / f.size << " sizes/s";
  const bool plain = f.motion_a.is_ballistic();
  f.story = story.str();
  if (plain && r.below(6) == 0)
    go_far(f, r);
  else if (plain && f.to < 20.0 && length > 1e-3 && r.below(8) == 0)
    swing(f, r);
  f.a = std::make_shared<Outline>(std::move(a));
  f.b = std::make_shared<Outline>(std::move(b));
  if (r.below(2)) {
    std::swap(f.a, f.b);
    std::swap(f.motion_a, f.motion_b);
    std::swap(f.near_a, f.near_b);
    std::swap(f.spin_a, f.spin_b);
    f.story += ", swapped";
  }
  return f;
}

/// The same flight with b's whole path moved by `shift`. @pre b's motion is ballistic.
/// Ends of its sites, in its frame.
inline std::vector<Vec2> tips(const Outline& outline) {
  std::vector<Vec2> found;
  for (const Site& site : outline.sites) {
    found.push_back(site.a);
    if (site.kind != SiteKind::point) found.push_back(site.b);
  }
  return found;
}

/// The flight of that seed with b put where one of its tips comes dead on to one of a's, or past it by a part of 1e-11 of
/// the size or less, if nothing is met before; half of them do not turn, and half of these lie along the axes. Nothing
/// where that would begin near each other, or no parabolas.
inline std::optional<Flight> aimed_flight(std::uint64_t seed) {
  Flight f = random_flight(seed);
  if (f.far || f.a->container || f.b->container || !f.motion_a.is_ballistic() || !f.motion_b.is_ballistic())
    return std::nullopt;
  Random r(seed * 7919 + 3);
  const std::vector<Vec2> of_a = tips(*f.a), of_b = tips(*f.b);
  const Vec2 tip_a = of_a[r.below(of_a.size())], tip_b = of_b[r.below(of_b.size())];
  const bool turns = r.below(2) != 0, along_axes = r.below(2) == 0;
  const auto begun_anew = [&](const Motion& m) {
    BodyState start = m.start();
    Acceleration pull = m.acceleration();
    if (!turns) {
      start.twist.omega = pull.angular = 0.0;
      if (along_axes) start.pose.angle = 0.5 * kPi * static_cast<double>(r.below(4));
    }
    return Motion::ballistic(m.origin(), start, pull);
  };
  f.motion_a = begun_anew(f.motion_a);
  f.motion_b = begun_anew(f.motion_b);
  const double t = f.from + r.uniform(0.3, 0.7) * (f.to - f.from);
  BodyState start = f.motion_b.start();
  start.pose.position +=
      Frame(f.motion_a.pose(t)).to_world(tip_a) - Frame(f.motion_b.pose(t)).to_world(tip_b);
  if (r.below(4) == 0)
    start.pose.position +=
        f.size * std::ldexp(1.0, -36 - static_cast<int>(r.below(20))) * direction(r.uniform(0.0, 2.0 * kPi));
  f.motion_b = Motion::ballistic(f.motion_b.origin(), start, f.motion_b.acceleration());
  f.story += ", aimed";
  const double apart = (f.motion_a.pose(f.from).position - f.motion_b.pose(f.from).position).norm();
  if (apart < 1.0001 * (f.a->bounding_radius + f.b->bounding_radius)) return std::nullopt;
  return f;
}

inline Flight shifted(const Flight& f, const Vec2& shift) {
  Flight g = f;
  BodyState start = f.motion_b.start();
  start.pose.position += shift;
  g.motion_b = Motion::ballistic(f.motion_b.origin(), start, f.motion_b.acceleration());
  return g;
}

}  // namespace brink::flights
