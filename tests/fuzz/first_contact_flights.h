#pragma once
/// Random flights of two random outlines, and everything that is checked about the first contact of each.

#include <array>
#include <cmath>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>

#include "brink/core/base/random.h"
#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/first_contact.h"
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

  reference::Pair pair() const {
    return {a.get(), b.get(), &motion_a, &motion_b, relative_speed, spin_a, spin_b};
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
  f.a = std::make_shared<Outline>(std::move(a));
  f.b = std::make_shared<Outline>(std::move(b));
  if (r.below(2)) {
    std::swap(f.a, f.b);
    std::swap(f.motion_a, f.motion_b);
    std::swap(f.spin_a, f.spin_b);
    story << ", swapped";
  }
  f.story = story.str();
  return f;
}

// ---- checks

struct Tally {
  long flights = 0, skipped = 0, contacts = 0, slow = 0, clear = 0, grazing = 0, given_up = 0, undecided = 0;
  long missed = 0, invented = 0, late = 0, below = 0, bad_normal = 0, bad_speed = 0;
  long closed_forms = 0, closed_form_differs = 0;
  long restarts = 0, not_canonical = 0, restarts_closed = 0, not_canonical_closed = 0;
  long rebounds = 0, rebound_wrong = 0, pressed = 0, pressed_wrong = 0;
  double worst_time_error = 0.0;      ///< [s]
  double worst_relative_error = 0.0;  ///< of the time since `from`
  std::uint64_t worst_seed = 0;
  long reported = 0;

  long failures() const {
    return undecided + missed + invented + late + below + bad_normal + bad_speed + closed_form_differs +
           rebound_wrong + pressed_wrong;
  }
};

inline std::ostream& operator<<(std::ostream& out, const Tally& t) {
  return out << "flights " << t.flights << " (skipped " << t.skipped << "), contacts " << t.contacts
             << ", clear " << t.clear << ", grazing " << t.grazing << ", reference gave up " << t.given_up
             << "\nmissed " << t.missed << ", invented " << t.invented << ", time wrong " << t.late
             << ", undecided " << t.undecided << ", gap below zero " << t.below << ", normal wrong "
             << t.bad_normal << ", closing speed wrong " << t.bad_speed << "\nclosed forms " << t.closed_forms
             << ", differ from the search " << t.closed_form_differs << "\nrestarts " << t.restarts
             << ", other bits " << t.not_canonical << "; with closed forms " << t.restarts_closed
             << ", other bits " << t.not_canonical_closed << "\nrebounds " << t.rebounds << ", wrong "
             << t.rebound_wrong << "; pressed on " << t.pressed << ", wrong " << t.pressed_wrong
             << "\nworst time error " << t.worst_time_error << " s (seed " << t.worst_seed
             << "), relative to the flight " << t.worst_relative_error << "\n";
}

class Checker {
 public:
  Tally tally;
  bool verbose = true;

  void check(std::uint64_t seed) { check(random_flight(seed), seed); }

  void check(const Flight& f, std::uint64_t seed) {
    seed_ = seed;
    ++tally.flights;
    const reference::Pair pair = f.pair();
    if (!(pair.distance(f.from) > 1e-6 * f.size)) {
      ++tally.skipped;
      return;
    }
    const Sides sides(f);
    SearchLimits limits;
    limits.closed_forms = false;
    const PairAnswer answer = search(sides, f.from, f.to, limits);
    if (answer.status == PairAnswer::Status::undecided) {
      fail(f, tally.undecided, "undecided", answer, {});
      return;
    }
    const Touch truth = true_touch(f, pair, f.from, f.to);
    if (truth.given_up) {
      ++tally.given_up;
      return;
    }
    compare(f, pair, answer, truth);
    compare_closed_form(f, pair, sides, answer, limits);
  }

 private:
  struct Sides {
    std::unique_ptr<SiteIndex> index_a, index_b;
    Mover a, b;
    explicit Sides(const Flight& f)
        : index_a(make_brute_force_index(f.a)),
          index_b(make_brute_force_index(f.b)),
          a{index_a.get(), &f.motion_a, 0.0},
          b{index_b.get(), &f.motion_b, 0.0} {}
  };

  struct Touch {
    double time = reference::kNever;
    double closing = 0.0;  ///< mean closing speed shortly before [m/s]
    bool real = false;     ///< the outlines come to cross, not only near
    bool given_up = false;
    double least = reference::kNever;
  };

  PairAnswer search(const Sides& s, double from, double to, const SearchLimits& limits) {
    return first_contact(s.a, s.b, from, to, limits, scratch_, work_);
  }

  /// Bound on the speed of any point of one body against the other.
  static double body_speed(const Flight& f) {
    return f.relative_speed + f.spin_a * f.a->bounding_radius + f.spin_b * f.b->bounding_radius;
  }

  /// The reference's answer, polished: first time of crossing, after the first time within `tiny`.
  Touch true_touch(const Flight& f, const reference::Pair& pair, double from, double to) {
    Touch touch;
    // not less than two bodies move in a rounding of the time
    const double tiny = std::max(1e-13 * std::max(1.0, f.size), 4.0 * 2.2e-16 * to * body_speed(f));
    const reference::FirstTouch near = reference::first_touch(pair, from, to, tiny);
    touch.given_up = near.given_up;
    touch.least = near.least;
    if (!(near.time <= to)) return touch;
    const double speed = std::max(body_speed(f), 1e-300);
    touch.time = near.time;
    double low = near.time, high = near.time;
    bool crossed = pair.distance(high) <= 0.0;
    for (double step = tiny / speed; !crossed && high < to; step *= 2.0) {
      low = high;
      high = std::min(to, std::max(near.time + step, std::nextafter(high, reference::kNever)));
      const double d = pair.distance(high);
      crossed = d <= 0.0;
      if (d > 1e-9 * f.size + 10.0 * tiny) break;
    }
    touch.real = crossed;
    if (!crossed) pass_through(pair, from, to, touch);
    if (crossed) {
      while (std::nextafter(low, reference::kNever) < high) {
        const double middle = low + 0.5 * (high - low);
        if (middle <= low || middle >= high) break;
        (pair.distance(middle) <= 0.0 ? high : low) = middle;
      }
      touch.time = low;
    }
    const double h = std::min(1e-6 * (f.to - f.from), touch.time - from);
    if (h > 0.0) touch.closing = pair.distance(touch.time - h) / h;
    return touch;
  }

  /// A point has no extent to cross a thin wire with: it goes through where its distance falls to nothing and
  /// rises again as fast.
  static void pass_through(const reference::Pair& pair, double from, double to, Touch& touch) {
    const double h = std::min({1e-7 * (to - from), touch.time - from, to - touch.time});
    if (!(h > 0.0)) return;
    const double before = pair.distance(touch.time - h), after = pair.distance(touch.time + h);
    const double now = pair.distance(touch.time);
    if (now > 1e-3 * before || after < 0.9 * before || after > 1.1 * before) return;
    touch.real = true;
    touch.time += h * now / before;
  }

  /// Estimate of how deep the crossing that begins at t gets, from how long it lasts: gap(t - duration) / 8,
  /// for a parabola whose falling side is continued backward.
  static double depth_after(const Flight& f, const reference::Pair& pair, double t) {
    const double length = f.to - f.from;
    double lasts = 1e-12 * length;
    while (t + lasts < f.to && pair.distance(t + lasts) <= 0.0) lasts *= 1.5;
    const double back = std::min(lasts, t - f.from);
    return back > 0.0 ? pair.distance(t - back) / 8.0 : 0.0;
  }

  /// Rounding of places over speed: how well this contact's time is known at all.
  static double time_tolerance(const Flight& f, const Touch& touch) {
    const double extent =
        f.motion_a.pose(f.from).position.norm() + f.motion_b.pose(f.from).position.norm() +
        f.a->bounding_radius + f.b->bounding_radius +
        std::max(f.motion_a.pose(f.to).position.norm(), f.motion_b.pose(f.to).position.norm());
    return 8e-16 * touch.time + 16 * 2.2e-16 * extent / std::max(touch.closing, 1e-300);
  }

  void compare(const Flight& f, const reference::Pair& pair, const PairAnswer& answer, const Touch& truth) {
    const bool says_contact = answer.status == PairAnswer::Status::contact;
    if (!says_contact && truth.time > f.to) {
      ++tally.clear;
      return;
    }
    if (!says_contact) {
      const bool shallow = !truth.real || depth_after(f, pair, truth.time) < 1e-10 * f.size ||
                           truth.time > f.to - 1e-12 * (f.to - f.from);
      if (shallow)
        ++tally.grazing;
      else
        fail(f, tally.missed, "missed", answer, truth);
      return;
    }
    const double d = pair.distance(answer.contact.time);
    const double touch_band = 1e-12 * std::max(1.0, f.size) + 4.0 * 2.2e-16 * f.to * body_speed(f);
    if (truth.time > f.to || !truth.real) {
      if (d <= touch_band || truth.time > f.to - 1e-12 * (f.to - f.from))
        ++tally.grazing;
      else
        fail(f, tally.invented, "invented", answer, truth);
      return;
    }
    const double error = std::abs(answer.contact.time - truth.time);
    const double tolerance = time_tolerance(f, truth);
    if (tolerance > 1e-10 || depth_after(f, pair, truth.time) < 1e-10 * f.size) {
      const bool near = d <= touch_band || error <= tolerance;
      if (near)
        ++tally.grazing;
      else
        fail(f, answer.contact.time < truth.time ? tally.invented : tally.missed, "grazing, but apart",
             answer, truth);
      return;
    }
    ++tally.contacts;
    // what the search calls touching: a wire is met half of it before, and below 1 mm/s that is longer than
    // 1e-10 s
    const double touching = 1e-13 / truth.closing;
    const bool slow = touching > 1e-10;
    if (slow) ++tally.slow;
    if (!slow && error > tally.worst_time_error) {
      tally.worst_time_error = error;
      tally.worst_seed = seed_;
    }
    tally.worst_relative_error = std::max(tally.worst_relative_error, error / (f.to - f.from));
    if (error > std::max(1e-10, touching) ||
        error > touching + std::max(16.0 * tolerance, 1e-11 * (f.to - f.from)))
      fail(f, answer.contact.time < truth.time ? tally.invented : tally.late, "time", answer, truth);
    else
      check_contact(f, pair, answer, truth);
  }

  void check_contact(const Flight& f, const reference::Pair& pair, const PairAnswer& answer,
                     const Touch& truth) {
    const FeatureContact& c = answer.contact;
    const double rounding = 64 * 2.2e-16 *
                            (f.size + f.motion_a.pose(c.time).position.norm() +
                             f.motion_b.pose(c.time).position.norm() + f.a->bounding_radius);
    const double d = pair.distance(c.time);
    if (c.gap < -rounding || d < -rounding || answer.until != c.time)
      fail(f, tally.below, "gap", answer, truth);
    check_normal(f, pair, answer, truth, rounding);
    check_speed(f, pair, answer, truth, rounding);
    check_restarts(f, answer, truth);
    if (f.motion_a.is_ballistic() && f.motion_b.is_ballistic()) check_rebound(f, answer, truth);
  }

  /// A small shift of a along the normal is a gap of that size; against it, none.
  void check_normal(const Flight& f, const reference::Pair& pair, const PairAnswer& answer,
                    const Touch& truth, double rounding) {
    const FeatureContact& c = answer.contact;
    const double shift = std::max(1e-8 * f.size, 1e4 * (rounding + std::abs(c.gap)));
    if (shift > 1e-5 * f.size) return;
    const double apart = pair.distance(c.time, shift * c.normal);
    const double pushed = pair.distance(c.time, -shift * c.normal);
    const bool unit = std::abs(c.normal.norm() - 1.0) < 1e-14;
    // the shift may bring another feature near, in a notch or with an arc as small as the shift: then less
    // than all of it
    if (!unit || apart < 0.5 * shift || pushed > 0.5 * shift)
      fail(f, tally.bad_normal, "normal", answer, truth);
  }

  /// The speed along the normal of the two points that touch, and how fast the distance falls just before.
  void check_speed(const Flight& f, const reference::Pair& pair, const PairAnswer& answer, const Touch& truth,
                   double rounding) {
    const FeatureContact& c = answer.contact;
    const BodyState sa = f.motion_a.state(c.time), sb = f.motion_b.state(c.time);
    const Vec2 va = sa.twist.at(c.point - sa.pose.position), vb = sb.twist.at(c.point - sb.pose.position);
    bool wrong = !(c.closing_speed >= 0.0) ||
                 std::abs(-c.normal.dot(va - vb) - c.closing_speed) > 1e-7 * (body_speed(f) + vb.norm());
    const double spin = f.spin_a + f.spin_b;
    const double bend =
        f.relative_acceleration +
        4.0 * spin * (spin * (f.a->bounding_radius + f.b->bounding_radius) + pair.relative_speed) +
        4.0 * body_speed(f) * body_speed(f) / (1e-6 * f.size);
    const double h = 1e-2 * c.closing_speed / bend;
    if (h < c.time - f.from && h * c.closing_speed > 1e4 * rounding && h > 1e4 * 2.2e-16 * c.time) {
      // into a notch the distance to its flanks falls slower than that to its bottom: the closing speed is a
      // bound
      const double measured = (pair.distance(c.time - h) - pair.distance(c.time)) / h;
      wrong = wrong || measured > 1.05 * c.closing_speed;
    }
    if (wrong) fail(f, tally.bad_speed, "closing speed", answer, truth);
  }

  /// The same contact from other starts, and with the window cut in pieces.
  void check_restarts(const Flight& f, const PairAnswer& answer, const Touch& truth) {
    const Sides sides(f);
    SearchLimits limits;
    const double t = answer.contact.time;
    for (const bool closed : {false, true}) {
      limits.closed_forms = closed;
      const PairAnswer whole = closed ? search(sides, f.from, f.to, limits) : answer;
      const double expected = whole.contact.time;
      long& count = closed ? tally.restarts_closed : tally.restarts;
      long& other = closed ? tally.not_canonical_closed : tally.not_canonical;
      const auto same = [&](const PairAnswer& again, const char* what) {
        ++count;
        const bool contact = again.status == PairAnswer::Status::contact;
        if (contact && again.contact.time == expected) return;
        fail(f, other, what, again, truth);
        if (!contact || std::abs(again.contact.time - expected) > 2 * time_tolerance(f, truth))
          fail(f, tally.late, "restart", again, truth);
      };
      for (const double part : {0.37, 0.9, 0.999999})
        if (const double from = f.from + part * (t - f.from);
            from < std::min(t, expected) - 1e-12 * (f.to - f.from))
          same(search(sides, from, f.to, limits), closed ? "later start, closed form" : "later start");
      Random r(seed_ + 77);
      double from = f.from;
      PairAnswer piece;
      for (int k = 0; k < 6 && from < f.to; ++k) {
        const double end = k == 5 ? f.to : std::min(f.to, from + r.uniform(0.05, 0.4) * (f.to - f.from));
        piece = search(sides, from, end, limits);
        if (piece.status == PairAnswer::Status::contact) break;
        from = end;
      }
      same(piece, closed ? "window in pieces, closed form" : "window in pieces");
    }
  }

  void compare_closed_form(const Flight& f, const reference::Pair& pair, const Sides& sides,
                           const PairAnswer& plain, SearchLimits limits) {
    limits.closed_forms = true;
    const std::uint64_t before = work_.closed_forms;
    const PairAnswer quick = search(sides, f.from, f.to, limits);
    if (work_.closed_forms == before) return;
    ++tally.closed_forms;
    const Touch none;
    const bool both = quick.status == plain.status;
    const PairAnswer& said = quick.status == PairAnswer::Status::contact ? quick : plain;
    if (both && quick.status != PairAnswer::Status::contact) return;
    const double d = pair.distance(said.contact.time);
    const bool shallow = depth_after(f, pair, said.contact.time) < 1e-10 * f.size;
    if (!both) {
      if (!shallow && said.contact.time < f.to - 1e-12 * (f.to - f.from))
        fail(f, tally.closed_form_differs, "closed form: another status", quick, none);
      return;
    }
    Touch touch;
    touch.time = quick.contact.time;
    touch.closing = std::max(quick.contact.closing_speed, 1e-300);
    const double apart = std::abs(quick.contact.time - plain.contact.time);
    const bool close =
        apart <= 4.0 * time_tolerance(f, touch) || (shallow && d < 1e-12 * std::max(1.0, f.size));
    if (!close)
      fail(f, tally.closed_form_differs, "closed form: another time", quick, none);
    else if (!shallow && (quick.contact.normal - plain.contact.normal).norm() > 1e-5)
      fail(f, tally.closed_form_differs, "closed form: another normal", quick, none);
  }

  /// Starts in contact: thrown back along the normal (separating), and going on as before (approaching).
  void check_rebound(const Flight& f, const PairAnswer& answer, const Touch& truth) {
    const FeatureContact& c = answer.contact;
    const double t = c.time;
    const Sides sides(f);
    const PairAnswer pressed = search(sides, t, f.to, SearchLimits());
    ++tally.pressed;
    if (pressed.status != PairAnswer::Status::contact ||
        pressed.contact.time > t + 2 * time_tolerance(f, truth))
      fail(f, tally.pressed_wrong, "approaching from contact", pressed, truth);

    Flight back = f;
    BodyState sa = f.motion_a.state(t);
    const double kick = 1.5 * c.closing_speed;
    sa.twist.velocity += kick * c.normal;
    back.motion_a = Motion::ballistic(t, sa, f.motion_a.acceleration());
    back.motion_b = Motion::ballistic(t, f.motion_b.state(t), f.motion_b.acceleration());
    back.from = t;
    back.relative_speed += kick;
    const reference::Pair pair = back.pair();
    double gone = 1e-9 * (f.to - f.from);  // by then it must have left, or this is no clean rebound
    while (t + gone < f.to && pair.distance(t + gone) < 1e-7 * f.size) gone *= 2.0;
    if (gone > 1e-3 * (f.to - f.from) || t + gone >= f.to) return;
    for (double s = gone; s > 1e-3 * gone; s *= 0.7)
      if (pair.distance(t + s) <= 0.2 * kick / 3.0 * s) return;
    ++tally.rebounds;
    Sides sides_back(back);
    sides_back.a.velocity_rounding = sides_back.b.velocity_rounding = 16 * 2.2e-16 * pair.relative_speed;
    SearchLimits limits;
    const Touch next = true_touch(back, pair, t + gone, f.to);
    for (const bool closed : {false, true}) {
      limits.closed_forms = closed;
      const PairAnswer again = search(sides_back, t, f.to, limits);
      const bool says = again.status == PairAnswer::Status::contact;
      const bool clean = next.real && next.closing > 1e-3 * c.closing_speed;
      const double error = says ? std::abs(again.contact.time - next.time) : 0.0;
      bool wrong = false;
      if (again.status == PairAnswer::Status::undecided)
        wrong = true;
      else if (next.time > f.to)
        wrong = says && pair.distance(again.contact.time) > 1e-12 * std::max(1.0, f.size);
      else if (!says)
        wrong = clean && depth_after(back, pair, next.time) > 1e-10 * f.size;
      else
        wrong = again.contact.time <= t ||
                (clean && error > 1e-10 + 1e-13 / next.closing && error > 16 * time_tolerance(back, next));
      if (says && again.contact.time <= t + 1e-3 * gone) wrong = true;
      if (wrong && !next.given_up)
        fail(back, tally.rebound_wrong, closed ? "rebound, closed form" : "rebound", again, next);
    }
  }

  void fail(const Flight& f, long& count, const char* what, const PairAnswer& answer, const Touch& truth) {
    ++count;
    if (!verbose || ++tally.reported > 40) return;
    const FeatureContact& c = answer.contact;
    std::cout << std::setprecision(17) << "seed " << seed_ << ": " << what << " (" << f.story << ") window "
              << f.from << " .. " << f.to << "\n  answer " << static_cast<int>(answer.status) << " time "
              << c.time << " gap " << c.gap << " closing " << c.closing_speed << " sample "
              << (c.sample_on_a ? "a" : "b") << c.sample << " site " << c.site << " normal "
              << c.normal.transpose() << "\n  reference " << truth.time << " closing " << truth.closing
              << " least " << truth.least << " distance at answer "
              << (c.sample >= 0 ? f.pair().distance(c.time) : 0.0) << std::setprecision(6) << "\n";
  }

  std::uint64_t seed_ = 0;
  SearchScratch scratch_;
  WorkCounters work_;
};

}  // namespace brink::flights
