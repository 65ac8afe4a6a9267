#pragma once
/// A whole run looked at from outside: a recorder that flies every body itself, from impulse to impulse, and
/// looks all the way whether any two things are in each other.
///
///   frame   every body is where its own flight says, energy is kept where it should be
///   event   the two touch, the impulse obeys the laws, then both fly on with it
///   between each pair steps by its distance over a bound on its speed; near contact by a part of its width,
///           so that nothing passes through anything unseen
///
/// Only for worlds of free flight (gravity and moving sites, no forces); of others frames alone are looked
/// at.

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "brink/scheduler/simulator/simulator.h"
#include "tests/support/outside/gap.h"
#include "tests/support/outside/law.h"

namespace brink::outside {

/// What Watch holds a run to.
struct WatchOptions {
  double until = 1;                  ///< to be reached at most [s]: for the speeds of sites
  double contact_tolerance = 1e-10;  ///< of the world's length
  double start_overlap = 0;          ///< that the world starts with, and may keep [m]
  bool laws = true;                  ///< one contact at a time, by impulses: each obeys the laws
  Real stride = 0.125L;              ///< part of the lesser width that a pair in contact moves unseen
};

class Watch : public Recorder {
 public:
  Watch(const World& world, const WatchOptions& options) : world_(world), options_(options) {
    free_ = world.forces.empty();
    for (const Body& b : world.bodies) {
      bodies_.push_back({shape_of(*b.outline), {0, state_of(b.initial), pull_on(b)}, inertia_of(b)});
      length_ = std::max(length_, 2 * bodies_.back().shape.reach);
    }
    for (const FixedSite& s : world.sites) add_site(s);
    const int n = static_cast<int>(bodies_.size()), m = static_cast<int>(sites_.size());
    for (int i = 0; i < n; ++i)
      for (int j = i + 1; j < n + m; ++j) pairs_.push_back({i, j});
    conserves_ = keeps_energy();
  }

  std::vector<std::string> faults;
  long looks = 0;  ///< exact gaps taken
  long events = 0;
  Real deepest = 0;  ///< overlap met [m]

  void frame(double t, std::span<const BodyState> states) override {
    for (std::size_t k = 0; k < bodies_.size(); ++k) meet_frame(k, t, state_of(states[k]));
    if (conserves_ && free_) look_at_energy(t, states);
    now_ = std::max(now_, Real(t));
    for (Pair& p : pairs_) free_ ? follow(p, t) : look(p, t);
  }

  void event(const Event& e) override {
    ++events;
    if (e.kind == EventKind::group) grouped_ = e.contact.time;
    if (e.kind != EventKind::collision || !free_) return;
    const Real t = Real(e.contact.time) + e.contact.time_low;
    if (e.contact.time < last_time_) fault(t, "events go back in time", e.contact.body, -1);
    last_time_ = e.contact.time;
    const int other = e.contact.other_body >= 0 ? e.contact.other_body
                                                : static_cast<int>(bodies_.size()) + e.contact.other_site;
    for (Pair& p : pairs_)
      if (p.a == e.contact.body || p.b == e.contact.body || p.a == other || (p.b == other && is_body(other)))
        follow(p, t);
    collide(e, other, t);
  }

  void checkpoint(double, const std::vector<std::byte>&) override {}

  bool sound() const { return faults.empty(); }
  /// All faults, one a line.
  std::string report() const {
    std::string text;
    for (const std::string& f : faults) text += f + "\n";
    return text;
  }

 protected:
  struct Flyer {
    Shape shape;
    Flight flight;
    Inertia inertia;
    /// How fast its own flight may have gone astray since the last frame, as recorded points and impulses are
    /// rounded [m/s].
    Real astray = 0;
    Real frame = 0;  ///< when that was [s]
  };
  struct Told {
    Shape shape;
    SitePath path;
    Real fastest = 0, spin = 0;  ///< bounds, of those that move by formulas
  };
  /// Two owners: bodies first, then sites.
  struct Pair {
    int a = 0, b = 0;
    Real clear_to = 0;   ///< looked at so far [s]
    bool lost = false;   ///< a fault was told: no more is asked of it
    bool apart = false;  ///< they are let pass through each other
  };

  bool is_body(int owner) const { return owner < static_cast<int>(bodies_.size()); }
  const Shape& shape(int k) const { return is_body(k) ? bodies_[k].shape : site(k).shape; }
  const Told& site(int k) const { return sites_[k - bodies_.size()]; }
  State state(int k, Real t) const { return is_body(k) ? bodies_[k].flight.at(t) : site(k).path.at(t); }
  std::string name(int k) const {
    return is_body(k) ? world_.bodies[k].name : world_.sites[k - bodies_.size()].name;
  }

  Vec pull_on(const Body& b) const {
    return {b.lock_x ? 0 : Real(world_.gravity.x()), b.lock_y ? 0 : Real(world_.gravity.y())};
  }

  void add_site(const FixedSite& s) {
    sites_.push_back({shape_of(*s.outline), SitePath(s)});
    Told& told = sites_.back();
    if (!told.path.told_by_formula()) return;
    constexpr int kTimes = 4096;
    for (int k = 0; k <= kTimes; ++k) {
      const State now = told.path.at(options_.until * k / kTimes);
      told.fastest = std::max(told.fastest, norm(now.velocity) * 1.2L);
      told.spin = std::max(told.spin, std::abs(now.omega) * 1.2L);
    }
  }

  bool keeps_energy() const {
    for (const FixedSite& s : world_.sites)
      if (!SitePath(s).stands()) return false;
    for (std::size_t a = 0; a < world_.materials.size(); ++a)
      for (std::size_t b = 0; b < world_.materials.size(); ++b) {
        const Surface s = surface_of(world_, static_cast<int>(a), static_cast<int>(b));
        if (s.restitution != 1 || s.friction != 0) return false;
      }
    return true;
  }

  // ---- bodies

  void meet_frame(std::size_t k, double t, const State& told) {
    Flyer& body = bodies_[k];
    const State own = body.flight.at(t);
    if (!std::isfinite(told.place.at.x + told.place.at.y + told.place.angle) ||
        !std::isfinite(told.velocity.x + told.velocity.y + told.omega))
      return fault(t, "a state that is not finite", static_cast<int>(k), -1);
    if (!free_ || t == 0.0) {
      body.flight = {t, told, body.flight.pull};
      return;
    }
    const Real off =
        norm(own.place.at - told.place.at) + std::abs(own.place.angle - told.place.angle) * body.shape.reach;
    // what overlapped at the start is pushed apart as it collides
    if (off > 1e-8L * length_ + 2 * options_.start_overlap + rounding(static_cast<int>(k), t) * 64)
      fault(t, "is " + text(off) + " m from where free flight and the recorded impulses take it",
            static_cast<int>(k), -1);
    body.astray =
        8 * kUlp * (norm(own.velocity) + std::abs(own.omega) * body.shape.reach + norm(body.flight.pull) * t);
    body.frame = t;
    const Place& place = off > rounding(static_cast<int>(k), t) ? told.place : own.place;
    body.flight = {t, {place, told.velocity, told.omega}, body.flight.pull};
  }

  /// Kinetic and of gravity; and the sum of its parts' sizes [J].
  struct Energy {
    Real sum = 0, scale = 0;
  };
  Energy energy_of(std::size_t k, const State& s) const {
    const Body& b = world_.bodies[k];
    const Vec& g = bodies_[k].flight.pull;
    const Real kinetic = (b.mass * dot(s.velocity, s.velocity) + b.inertia * s.omega * s.omega) / 2;
    return {kinetic - b.mass * dot(g, s.place.at),
            kinetic + b.mass * (std::abs(g.x * s.place.at.x) + std::abs(g.y * s.place.at.y))};
  }

  void look_at_energy(double t, std::span<const BodyState> states) {
    Real energy = 0, scale = 0;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const Energy e = energy_of(k, state_of(states[k]));
      energy += e.sum;
      scale += e.scale;
    }
    if (t == 0.0) first_energy_ = energy;
    if (std::abs(energy - first_energy_) > 1e-8L * scale && !energy_told_) {
      energy_told_ = true;
      fault(t, "energy " + text(first_energy_) + " J -> " + text(energy) + " J in a world that keeps it", -1,
            -1);
    }
  }

  // ---- events

  void collide(const Event& e, int other, Real t) {
    const int k = e.contact.body;
    State body = state(k, t), partner = state(other, t);
    const Vec normal{e.contact.normal.x(), e.contact.normal.y()};
    const Vec point{e.contact.point.x(), e.contact.point.y()};
    const Vec shift = nearest_image(point - partner.place.at);
    const Vec arm = point - body.place.at, other_arm = point - partner.place.at - shift;
    const Real touching = tolerance(k, other, t);
    look_at_touch(k, other, body, partner, t, touching);
    Impact impact;
    impact.normal = normal;
    impact.before = velocity_at(body, arm) - velocity_at(partner, other_arm);
    impact.push = e.impulse_n;
    impact.rub = e.impulse_t;
    const Real speed = norm(body.velocity) + norm(partner.velocity) + std::abs(body.omega) * norm(arm) +
                       std::abs(partner.omega) * norm(other_arm);
    const Real blur =
        8 * (kUlp + of_place(k, t) / norm(arm) + (is_body(other) ? of_place(other, t) / norm(other_arm) : 0));
    impact.noise = (1e-9L + blur) * speed + (std::abs(body.omega) + std::abs(partner.omega)) * touching +
                   4 * (astray(k) + astray(other));
    if (!is_body(other) && site(other).path.told_by_formula())
      impact.noise += 1e-6L * speed;  // by differences
    const Vec impulse = normal * impact.push + left_of(normal) * impact.rub;
    body = pushed(body, bodies_[k].inertia, arm, impulse);
    if (is_body(other)) partner = pushed(partner, bodies_[other].inertia, other_arm, -impulse);
    impact.after = velocity_at(body, arm) - velocity_at(partner, other_arm);
    bodies_[k].flight = {t, body, bodies_[k].flight.pull};
    if (is_body(other)) bodies_[other].flight = {t, partner, bodies_[other].flight.pull};
    // the point is told in doubles, and a body that starts inside another is moved out of it, which no event tells: an
    // impulse there turns the bodies by a little more or less
    const Real off = 4 * kUlp * (norm(point) + norm(arm)) + options_.start_overlap,
               given = norm(impulse) * off;
    impact.noise += given * turned_by(k, arm);
    bodies_[k].astray += blur * speed + given * turned_by(k, arm);
    if (is_body(other)) {
      impact.noise += given * turned_by(other, other_arm);
      bodies_[other].astray += blur * speed + given * turned_by(other, other_arm);
    }
    look_at_law(e, impact, k, other, t);
  }

  /// The speed of the point at `arm` that an impulse of moment 1 gives [m/s].
  Real turned_by(int k, const Vec& arm) const { return norm(arm) * bodies_[k].inertia.angle; }

  void look_at_touch(int a, int b, const State& sa, const State& sb, Real t, Real touching) {
    const Real g = exact_gap(a, b, sa, sb);
    if (g > touching) fault(t, "collide " + text(g) + " m apart", a, b);
  }

  void look_at_law(const Event& e, Impact impact, int a, int b, Real t) {
    if (std::abs(dot(impact.normal, impact.normal) - 1) > 1e-12L) fault(t, "a normal not of length 1", a, b);
    // a group that does not end is taken together, and without restitution: the energy tells of it
    if (!options_.laws || t - grouped_ <= 1e-12L * t) return;
    const int other = is_body(b) ? world_.bodies[b].material : world_.sites[b - bodies_.size()].material;
    impact.surface = surface_of(world_, world_.bodies[a].material, other);
    const std::string wrong = wrong_with(impact);
    if (!wrong.empty() && told_.insert({a, b}).second) fault(t, wrong, a, b);
    if (std::abs(-dot(impact.normal, impact.before) - e.contact.closing_speed) > 100 * impact.noise &&
        told_.insert({a, b}).second)
      fault(t, "another closing speed than recorded", a, b);
  }

  Vec nearest_image(const Vec& from) const {
    const auto whole = [](Real x, Real period) { return period > 0 ? std::round(x / period) * period : 0; };
    return {whole(from.x, world_.periods.size.x()), whole(from.y, world_.periods.size.y())};
  }

  // ---- pairs

  /// What the place of an owner at time t is rounded by [m].
  Real of_place(int k, Real t) const {
    const State s = state(k, t);
    return 4 * kUlp *
           (norm(s.place.at) + shape(k).reach * (1 + std::abs(s.place.angle)) +
            t * (norm(s.velocity) + std::abs(s.omega) * shape(k).reach));
  }
  Real astray(int k) const { return is_body(k) ? bodies_[k].astray : 0; }
  /// That, and how far its own flight may be off by now [m].
  Real rounding(int k, Real t) const {
    return of_place(k, t) + (is_body(k) ? astray(k) * std::max<Real>(0, t - bodies_[k].frame) : 0);
  }
  Real tolerance(int a, int b, Real t) const {
    return options_.start_overlap + 2 * options_.contact_tolerance * length_ + rounding(a, t) +
           rounding(b, t);
  }

  /// Calls visit(offset of a from an image of b) for every image that may be near, at least the nearest.
  template <class Visit>
  void each_image(int a, int b, const Vec& offset, Visit&& visit) const {
    const Real reach = shape(a).reach + shape(b).reach;
    const auto range = [&](Real x, Real period) {
      if (!(period > 0)) return std::pair<int, int>{0, 0};
      return std::pair<int, int>{static_cast<int>(std::floor((x - reach) / period)),
                                 static_cast<int>(std::ceil((x + reach) / period))};
    };
    const Real px = world_.periods.size.x(), py = world_.periods.size.y();
    const auto [x0, x1] = range(offset.x, px);
    const auto [y0, y1] = range(offset.y, py);
    for (int i = x0; i <= x1; ++i)
      for (int j = y0; j <= y1; ++j) visit(offset - Vec{i * px, j * py});
  }

  Real exact_gap(int a, int b, const State& sa, const State& sb) {
    Real least = kNever;
    each_image(a, b, sa.place.at - sb.place.at, [&](const Vec& offset) {
      const bool apart = !shape(a).container && !shape(b).container &&
                         norm(offset) > shape(a).reach + shape(b).reach + length_;
      if (apart) return void(least = std::min(least, norm(offset) - shape(a).reach - shape(b).reach));
      ++looks;
      least = std::min(least, outside::gap(shape(a), sa.place.angle, offset, shape(b), sb.place.angle));
    });
    return least;
  }
  Real lower_bound(int a, int b, const State& sa, const State& sb) const {
    Real least = kNever;
    each_image(a, b, sa.place.at - sb.place.at, [&](const Vec& offset) {
      if (is_body(b))
        least = std::min(least, norm(offset) - shape(a).reach - shape(b).reach);
      else
        least = std::min(least, boundaries_apart(shape(b), sb.place.angle, -offset, shape(a).reach));
    });
    return least;
  }

  /// How far the two may move unseen where they are in contact: a part of the thinner one's width.
  Real stride(const Pair& p) const {
    const auto thinnest = [](const Shape& s) {
      Real w = s.container ? s.width : std::max(s.width, s.length / 1000);
      for (const Piece& piece : s.pieces)
        if (piece.thickness > 0) w = std::min(w, 2 * piece.thickness);
      return w > 0 ? w : kNever;
    };
    const Shape &a = shape(p.a), &b = shape(p.b);
    const bool wire_b = !b.solid && b.pieces[0].thickness == 0;
    const bool wire_a = !a.solid && a.pieces[0].thickness == 0;
    const Real wa = wire_a ? std::max(a.width, a.length / 1000) : thinnest(a);
    const Real wb = wire_b ? kNever : thinnest(b);
    return options_.stride * std::min(wa, wb);
  }

  struct Rates {
    Real speed = 0, pull = 0;
  };
  Rates rates(int a, int b, const State& sa, const State& sb) const {
    Vec pull = bodies_[a].flight.pull;
    Rates r;
    Real spin_b = std::abs(sb.omega);
    if (is_body(b)) {
      pull = pull - bodies_[b].flight.pull;
      r.speed = norm(sa.velocity - sb.velocity);
    } else if (site(b).path.told_by_formula()) {
      r.speed = norm(sa.velocity) + site(b).fastest;
      spin_b = site(b).spin;
    } else {
      r.speed = norm(sa.velocity - sb.velocity);
    }
    // a site that turns moves its far ends: as fast as the body is from its origin
    const Real arm_b = is_body(b) ? shape(b).reach : norm(sa.place.at - sb.place.at) + shape(a).reach;
    r.speed += std::abs(sa.omega) * shape(a).reach + spin_b * arm_b;
    r.pull = norm(pull) + 2 * spin_b * r.speed * (is_body(b) ? 0 : 1);
    return r;
  }

  /// Looks at a pair from where it was looked at last up to `until`.
  void follow(Pair& p, Real until) {
    if (p.apart) return;
    const Real least_step = stride(p);
    long steps = 0;
    while (!p.lost && p.clear_to < until) {
      const State sa = state(p.a, p.clear_to), sb = state(p.b, p.clear_to);
      Real apart = lower_bound(p.a, p.b, sa, sb);
      if (!(apart > least_step)) {
        apart = exact_gap(p.a, p.b, sa, sb);
        if (!judge(p, apart, p.clear_to)) return;
      }
      const Real d = std::max(apart, least_step);
      const Rates r = rates(p.a, p.b, sa, sb);
      const Real h = 2 * d / (r.speed + std::sqrt(r.speed * r.speed + 2 * r.pull * d));
      p.clear_to += std::min(h, until - p.clear_to);
      if (!std::isfinite(h)) p.clear_to = until;
      if (until - p.clear_to < 1e-18L * until) p.clear_to = until;
      if (++steps > 2000000) {
        p.lost = true;
        fault(p.clear_to, "the watch gives up on this pair", p.a, p.b);
      }
    }
    look(p, until);
  }

  void look(Pair& p, Real t) {
    if (p.lost || p.apart) return;
    const State sa = state(p.a, t), sb = state(p.b, t);
    if (t > 0 && lower_bound(p.a, p.b, sa, sb) > tolerance(p.a, p.b, t)) return;
    judge(p, exact_gap(p.a, p.b, sa, sb), t);
  }

  bool judge(Pair& p, Real g, Real t) {
    deepest = std::max(deepest, -g);
    if (g >= -tolerance(p.a, p.b, t)) return true;
    p.lost = true;
    fault(t, "are " + text(-g) + " m in each other", p.a, p.b);
    return false;
  }

  static std::string text(Real x) {
    std::ostringstream out;
    out.precision(12);
    out << x;
    return out.str();
  }
  void fault(Real t, const std::string& what, int a, int b) {
    if (faults.size() > 20) return;
    std::ostringstream out;
    out.precision(17);
    out << "t = " << static_cast<double>(t) << ": ";
    if (a >= 0) out << "'" << name(a) << "' ";
    if (b >= 0) out << "and '" << name(b) << "' ";
    faults.push_back(out.str() + what);
  }

  World world_;
  WatchOptions options_;
  std::vector<Flyer> bodies_;
  std::vector<Told> sites_;
  std::vector<Pair> pairs_;
  std::set<std::pair<int, int>> told_;  ///< pairs of whose collisions a fault was told
  bool free_ = true, conserves_ = false, energy_told_ = false;
  Real length_ = 0, first_energy_ = 0, now_ = 0;
  double last_time_ = 0, grouped_ = -1e300;
};

}  // namespace brink::outside
