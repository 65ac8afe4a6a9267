#pragma once
/// Everything that is checked about the first contact of a flight, and the tally of it.

#include <cmath>
#include <iomanip>
#include <iostream>
#include <numbers>

#include "brink/scheduler/first_contact/first_contact.h"
#include "first_contact_flights.h"

namespace brink::flights {

struct Tally {
  long flights = 0, skipped = 0, contacts = 0, slow = 0, clear = 0, grazing = 0, near_misses = 0,
       given_up = 0, undecided = 0;
  long missed = 0, invented = 0, late = 0, below = 0, unnamed = 0, bad_normal = 0, bad_speed = 0;
  long closed_forms = 0, closed_form_differs = 0;
  long far = 0, refused = 0;
  long restarts = 0, not_canonical = 0, restarts_closed = 0, not_canonical_closed = 0;
  long rebounds = 0, partings = 0, far_rebounds = 0, rebound_wrong = 0, pressed = 0, pressed_wrong = 0;
  double worst_time_error = 0.0;      ///< [s]
  double worst_relative_error = 0.0;  ///< of the time since `from`
  std::uint64_t worst_seed = 0;
  long reported = 0;

  long failures() const {
    return undecided + missed + invented + late + below + unnamed + bad_normal + bad_speed +
           closed_form_differs + not_canonical + not_canonical_closed + rebound_wrong + pressed_wrong;
  }
};

inline std::ostream& operator<<(std::ostream& out, const Tally& t) {
  return out << "flights " << t.flights << " (near misses " << t.near_misses << ", skipped " << t.skipped
             << "), contacts " << t.contacts << ", clear " << t.clear << ", grazing " << t.grazing
             << ", reference gave up " << t.given_up << "\nmissed " << t.missed << ", invented " << t.invented
             << ", time wrong " << t.late << ", undecided " << t.undecided << ", gap below zero " << t.below
             << ", no such feature " << t.unnamed << ", normal wrong " << t.bad_normal
             << ", closing speed wrong " << t.bad_speed << "\nfar away " << t.far
             << ", of them refused with a reason " << t.refused << "\nclosed forms " << t.closed_forms
             << ", differ from the search " << t.closed_form_differs << "\nrestarts " << t.restarts
             << ", other bits " << t.not_canonical << "; with closed forms " << t.restarts_closed
             << ", other bits " << t.not_canonical_closed << "\nrebounds " << t.rebounds
             << ", without restitution " << t.partings << ", of both far away " << t.far_rebounds
             << ", wrong " << t.rebound_wrong << "; pressed on " << t.pressed << ", wrong " << t.pressed_wrong
             << "\nworst time error " << t.worst_time_error << " s (seed " << t.worst_seed
             << "), relative to the flight " << t.worst_relative_error << "\n";
}

class Checker {
 public:
  Tally tally;
  bool verbose = true;

  void check(std::uint64_t seed) {
    const Flight f = random_flight(seed);
    check(f, seed);
    if (seed % 256 == 0) check_near_misses(f, seed);
  }

  /// The flight of that seed aimed at a tip, if there is one.
  void check_aimed(std::uint64_t seed) {
    if (const std::optional<Flight> f = aimed_flight(seed)) check(*f, seed);
  }

  /// b's path moved sideways to where it only just touches a, then by ever smaller steps to either side of
  /// that.
  void check_near_misses(const Flight& f, std::uint64_t seed) {
    if (f.far || f.a->container || f.b->container || !f.motion_a.is_ballistic() || !f.motion_b.is_ballistic())
      return;
    const Vec2 v = f.motion_b.twist(f.from).velocity - f.motion_a.twist(f.from).velocity;
    const Vec2 d = f.motion_b.pose(f.from).position - f.motion_a.pose(f.from).position;
    const Vec2 side =
        perp(v.normalized()) * (cross(v, d) < 0.0 ? -1.0 : 1.0);  // moves b away from a at the start
    const auto hits = [&](double x) {
      const Flight g = shifted(f, x * side);
      return reference::first_touch(g.pair(), g.from, g.to, 1e-12 * std::max(1.0, g.size), 20000).time <=
             g.to;
    };
    double hit = 0.0, miss = 2.5 * (f.a->bounding_radius + f.b->bounding_radius);
    if (!hits(hit) || hits(miss)) return;
    while (miss - hit > 1e-10 * f.size) {
      const double middle = 0.5 * (hit + miss);
      if (middle <= hit || middle >= miss) break;
      (hits(middle) ? hit : miss) = middle;
    }
    for (const double off : {1e-3, 1e-5, 1e-7, 1e-8}) {
      check(shifted(f, (hit - off * f.size) * side), seed);
      check(shifted(f, (miss + off * f.size) * side), seed);
      tally.near_misses += 2;
    }
  }

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
    tally.far += f.far;
    if (answer.status == PairAnswer::Status::undecided && f.far) {
      check_refusal(f, pair, answer);
      return;
    }
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
    bool passed = false;   ///< a bare point went through a boundary
    bool grazed = false;   ///< before that (or at all) the outlines came near without crossing
    bool slid = false;     ///< before that one went along the other, in it by roundings alone
    bool given_up = false;
    double least = reference::kNever;
  };

  PairAnswer search(const Sides& s, double from, double to, const SearchLimits& limits) {
    return first_contact(s.a, s.b, from, to, limits, scratch_, work_);
  }

  /// The same, taken up again where its cap stopped it, as a policy does.
  PairAnswer search_on(const Sides& s, double from, double to, const SearchLimits& limits) {
    PairAnswer answer = search(s, from, to, limits);
    for (int k = 0; k < 100 && answer.status == PairAnswer::Status::undecided &&
                    answer.why == PairAnswer::Why::steps && answer.until > from;
         ++k) {
      from = answer.until;
      answer = search(s, from, to, limits);
    }
    return answer;
  }

  /// Bound on the speed of any point of one body against the other.
  static double body_speed(const Flight& f) {
    return f.relative_speed + f.spin_a * f.a->bounding_radius + f.spin_b * f.b->bounding_radius;
  }

  /// Shallower crossings than this part of the size are grazing: the search may call them contacts or not.
  static constexpr double kShallow = 1e-10;

  /// The first crossing that is not shallow, or else the first time that they come within `tiny`; `grazed` if
  /// they came near, or crossed shallowly, before.
  Touch true_touch(const Flight& f, const reference::Pair& pair, double from, double to) {
    // not less than two bodies move in a rounding of the time
    const double tiny = std::max(1e-13 * std::max(1.0, f.size), 4.0 * 2.2e-16 * to * body_speed(f));
    Touch first;
    for (int graze = 0; graze < 100 && from < to; ++graze) {
      const reference::FirstTouch near = reference::first_touch(pair, from, to, tiny);
      Touch touch = first;
      touch.given_up = near.given_up;
      touch.least = std::min(first.least, near.least);
      if (near.given_up) return touch;
      if (!(near.time <= to)) break;
      touch.time = near.time;
      from = find_crossing(f, pair, from, to, tiny, touch);
      if (touch.real) {
        const Overlap overlap = overlap_after(f, pair, touch);
        if (overlap.depth >= kShallow * f.size) {
          touch.slid = overlap.begins - touch.time > 1e-3 * (f.to - f.from);
          if (touch.slid) {
            touch.time = overlap.begins;
            touch.grazed = true;
          }
          return touch;
        }
        from = std::max(from, overlap.until);
      }
      if (graze == 0) first = touch;
      first.real = false;
      first.grazed = true;
    }
    return first;
  }

  /// Looks for a crossing from shortly before touch.time until the outlines are well apart again; returns
  /// when.
  static double find_crossing(const Flight& f, const reference::Pair& pair, double from, double to,
                              double tiny, Touch& touch) {
    const double speed = std::max(body_speed(f), 1e-300);
    const bool bare = pair.has_bare_point();
    const auto crosses = [&](double t0, double t1) {
      return pair.distance(t1) <= 0.0 || (bare && pair.crossings(t0, t1) > 0);
    };
    double low = std::max(from, touch.time - 4.0 * tiny / speed), high = std::max(touch.time, low);
    touch.real = crosses(low, high);
    for (double step = tiny / speed; !touch.real && high < to; step *= 2.0) {
      low = high;
      high = std::min(to, std::max(low + step, std::nextafter(low, reference::kNever)));
      touch.real = crosses(low, high);
      if (pair.distance(high) > 1e-9 * f.size + 10.0 * tiny) break;
    }
    if (touch.real) {
      while (std::nextafter(low, reference::kNever) < high) {
        const double middle = low + 0.5 * (high - low);
        if (middle <= low || middle >= high) break;
        (crosses(low, middle) ? high : low) = middle;
      }
      touch.time = low;
      touch.passed = pair.distance(high) > 0.0;
    }
    const double h = std::min(1e-6 * (f.to - f.from), touch.time - f.from);
    if (h > 0.0) touch.closing = pair.distance(touch.time - h) / h;
    return high;
  }

  /// How deep a crossing gets, and when it is over (or deep enough).
  struct Overlap {
    double depth = 0.0;
    double until = 0.0;
    double begins = 0.0;  ///< when it is no longer shallow
  };
  static Overlap overlap_after(const Flight& f, const reference::Pair& pair, const Touch& touch) {
    return touch.passed ? beyond_after(f, pair, touch.time) : overlap_after(f, pair, touch.time);
  }
  /// Estimated from how long it lasts: gap(t - duration) / 8, for a parabola whose falling side is continued
  /// backward. None where a shift by kShallow parts the two whenever they are looked at: a tip may slide along a
  /// side for long, in it by roundings alone.
  static Overlap overlap_after(const Flight& f, const reference::Pair& pair, double t) {
    double lasts = std::max(1e-12 * (f.to - f.from), 2.0 * (std::nextafter(t, reference::kNever) - t));
    double shallow = t, deep = reference::kNever;
    for (; t + lasts < f.to && pair.distance(t + lasts) <= 0.0; lasts *= 1.5) {
      if (deep <= t + lasts) continue;
      (is_shallow(f, pair, t + lasts) ? shallow : deep) = t + lasts;
    }
    if (!(deep <= f.to)) return {0.0, t + lasts};
    while (deep - shallow > 1e-12 * (f.to - f.from)) {
      const double middle = 0.5 * (shallow + deep);
      if (middle <= shallow || middle >= deep) break;
      (is_shallow(f, pair, middle) ? shallow : deep) = middle;
    }
    const double back = std::min(lasts, 0.5 * (t - f.from));
    return {back > 0.0 ? pair.distance(t - back) / back * lasts / 8.0 : 0.0, t + lasts, deep};
  }
  /// True if a shift of a by kShallow in some direction parts the two outlines.
  static bool is_shallow(const Flight& f, const reference::Pair& pair, double t) {
    constexpr int directions = 64;
    for (int k = 0; k < directions; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / directions;
      if (pair.distance(t, kShallow * f.size * Vec2(std::cos(angle), std::sin(angle))) > 0.0) return true;
    }
    return false;
  }
  /// How far the bare point that crosses right after t gets from the boundary, until it crosses again.
  /// Nowhere, if it cuts off a corner within a rounding of the time.
  static Overlap beyond_after(const Flight& f, const reference::Pair& pair, double t) {
    double last = std::nextafter(t, reference::kNever);
    Overlap beyond{0.0, last};
    if (pair.crossings(t, last) % 2 == 0) return beyond;
    for (double step = last - t; last < f.to && beyond.depth < 10.0 * kShallow * f.size; step *= 1.5) {
      const double next = std::min(f.to, last + step);
      beyond.until = next;
      if (pair.crossings(last, next) > 0) break;
      last = next;
      beyond.depth = std::max(beyond.depth, pair.distance(last));
    }
    // through the very tip of a corner the point comes out on the side that it came from
    const double way = 0.5 * (beyond.until - t);
    const bool solid = f.a->is_point() ? f.b->solid : f.a->solid;
    if (solid && t - way > f.from && pair.bare_point_enclosed(t - way) == pair.bare_point_enclosed(t + way))
      beyond.depth = 0.0;
    // who slid along a side, in it by roundings alone, and leaves it beyond its end has crossed nothing either
    if (solid && beyond.depth > 0.0 && pair.bare_point_enclosed(t - way) &&
        depth_before(f, pair, t) < kShallow * f.size)
      beyond.depth = 0.0;
    return beyond;
  }
  /// How deep the bare point was that leaves a solid at t, since it came to be in it.
  static double depth_before(const Flight& f, const reference::Pair& pair, double t) {
    double depth = 0.0;
    for (double back = 4.0 * (t - std::nextafter(t, 0.0)); t - back > f.from; back *= 1.1) {
      const double d = pair.distance(t - back);
      if (!(d < kShallow * f.size) && !pair.bare_point_enclosed(t - back)) break;
      depth = std::max(depth, d);
    }
    return depth;
  }

  /// A refusal must come before anything is missed: until then the two are apart.
  void check_refusal(const Flight& f, const reference::Pair& pair, const PairAnswer& answer) {
    ++tally.refused;
    const Touch truth = true_touch(f, pair, f.from, f.to);
    if (!truth.given_up && truth.real && answer.until > truth.time + time_tolerance(f, truth))
      fail(f, tally.missed, "refused too late", answer, truth);
  }

  /// What places and angles are rounded by [m].
  static double place_rounding(const Flight& f, double t) {
    const Pose a = f.motion_a.pose(t), b = f.motion_b.pose(t);
    return 2.2e-16 *
           (a.position.norm() + b.position.norm() + f.a->bounding_radius * (1.0 + std::abs(a.angle)) +
            f.b->bounding_radius * (1.0 + std::abs(b.angle)));
  }

  /// What a gap is rounded by where the places of two parabolas are summed up in doubles: four roundings of the way that
  /// each has gone, one of where it is, and angles likewise, at the arm of the outline,
  /// with six more for sines, turning and the distance in the end [m].
  static double way_rounding(const Motion& m, double arm, double t) {
    const double s = t - m.begin();
    const Twist v = m.start().twist;
    const Acceleration a = m.acceleration();
    const Pose at = m.pose(t);
    const double way = s * v.velocity.lpNorm<1>() + 0.5 * s * s * a.linear.lpNorm<1>(),
                 turn = s * std::abs(v.omega) + 0.5 * s * s * std::abs(a.angular);
    return 1.1e-16 * (4.0 * way + at.position.lpNorm<1>() +
                      std::numbers::sqrt2 * arm * (4.0 * turn + std::abs(at.angle) + 6.0));
  }

  /// Rounding of places over speed: how well this contact's time is known at all.
  static double time_tolerance(const Flight& f, const Touch& touch) {
    const double rounding = std::max(place_rounding(f, f.from), place_rounding(f, f.to));
    return 8e-16 * touch.time + 16 * rounding / std::max(touch.closing, 1e-300);
  }

  void compare(const Flight& f, const reference::Pair& pair, const PairAnswer& answer, const Touch& truth) {
    const bool says_contact = answer.status == PairAnswer::Status::contact;
    if (!says_contact && truth.time > f.to) {
      ++tally.clear;
      return;
    }
    if (!says_contact) {
      if (!truth.real || truth.time > f.to - 1e-12 * (f.to - f.from))
        ++tally.grazing;
      else
        fail(f, tally.missed, "missed", answer, truth);
      return;
    }
    const double d = pair.distance(answer.contact.time);
    const double touch_band =
        1e-12 * std::max(1.0, f.size) + 16.0 * place_rounding(f, f.to) + 4.0 * 2.2e-16 * f.to * body_speed(f);
    const double error = std::abs(answer.contact.time - truth.time);
    const double tolerance = time_tolerance(f, truth);
    const bool early = answer.contact.time < truth.time - tolerance;
    if (truth.time > f.to || !truth.real || (truth.grazed && early)) {
      if (d <= touch_band || error <= tolerance || truth.time > f.to - 1e-12 * (f.to - f.from))
        ++tally.grazing;
      else
        fail(f, tally.invented, "invented", answer, truth);
      return;
    }
    ++tally.contacts;
    // what the search calls touching: a wire is met eight roundings of the gap before it, and a place is
    // rounded as often as it is summed up, on dense output twice as often; below 1 mm/s that is longer than
    // 1e-10 s
    const bool dense = !f.motion_a.is_ballistic() || !f.motion_b.is_ballistic();
    double of_gap = (dense ? 4.0 : 2.0) * std::max(place_rounding(f, f.from), place_rounding(f, f.to));
    if (!dense)
      of_gap = std::max(of_gap, way_rounding(f.motion_a, f.a->bounding_radius, answer.contact.time) +
                                    way_rounding(f.motion_b, f.b->bounding_radius, answer.contact.time));
    // where one has slid along the other the truth is when it is no longer shallow
    const double level = std::max(SearchLimits{}.touch, 8.0 * of_gap),
                 touching = truth.slid ? 4.0 * kShallow * f.size / answer.contact.closing_speed
                                       : level / truth.closing;
    const bool slow = touching + tolerance > 1e-10;
    if (slow) ++tally.slow;
    if (!slow && error > tally.worst_time_error) {
      tally.worst_time_error = error;
      tally.worst_seed = seed_;
    }
    tally.worst_relative_error = std::max(tally.worst_relative_error, error / (f.to - f.from));
    if (truth.slid && error <= touching) return check_contact(f, pair, answer, truth);
    if (error > std::max(1e-10, touching + tolerance) ||
        error > touching + std::max(16.0 * tolerance, 1e-11 * (f.to - f.from))) {
      // what passes within the touching distance is met there, before any deeper contact
      // (the closing speed is a mean, and a path that bends may be slower at its end)
      if (early && d <= level)
        ++tally.grazing;
      else
        fail(f, answer.contact.time < truth.time ? tally.invented : tally.late, "time", answer, truth);
    } else {
      check_contact(f, pair, answer, truth);
    }
  }

  void check_contact(const Flight& f, const reference::Pair& pair, const PairAnswer& answer,
                     const Touch& truth) {
    const FeatureContact& c = answer.contact;
    const Outline &carrier = c.sample_on_a ? *f.a : *f.b, &other = c.sample_on_a ? *f.b : *f.a;
    const auto is_one_of = [](int k, const auto& all) { return k >= 0 && k < static_cast<int>(all.size()); };
    if (!is_one_of(c.sample, carrier.samples) || !is_one_of(c.site, other.sites))
      return fail(f, tally.unnamed, "feature", answer, truth);
    const double rounding = 64 * (2.2e-16 * f.size + place_rounding(f, c.time));
    const double d = pair.distance(c.time);
    if (c.gap < -rounding || d < -rounding || answer.until != c.time)
      fail(f, tally.below, "gap", answer, truth);
    check_normal(f, pair, answer, truth, rounding);
    check_speed(f, pair, answer, truth, rounding);
    check_restarts(f, answer, truth);
    if (!f.motion_a.is_ballistic() || !f.motion_b.is_ballistic()) return;
    check_pressed(f, answer, truth);
    check_rebound(f, answer, 1.1 + 0.1 * static_cast<double>(seed_ % 10));  // restitution .1 to 1
    // none; far away turning makes an approach of the rounding of places, which may be told as the contact again
    if (!f.far) check_rebound(f, answer, 1.0);
  }

  /// A small shift of a along the normal is a gap of that size; against it, none.
  void check_normal(const Flight& f, const reference::Pair& pair, const PairAnswer& answer,
                    const Touch& truth, double rounding) {
    const FeatureContact& c = answer.contact;
    const double shift = std::max(1e-8 * f.size, 1e4 * (rounding + std::abs(c.gap)));
    if (shift > 1e-5 * f.size) return;
    double apart = pair.distance(c.time, shift * c.normal);
    if (apart < 0.5 * shift)
      apart = distance_of_contact(f, pair, c, shift * c.normal);  // two contacts at once
    // a wire's end may stand out by less than the shift, and be pushed through: then a smaller one tells
    const double smallest = 8.0 * (rounding + std::abs(c.gap));
    double push = shift;
    while (push > smallest && pair.distance(c.time, -push * c.normal) > 0.5 * push) push *= 0.5;
    const bool unit = std::abs(c.normal.norm() - 1.0) < 1e-14;
    // the shift may bring another feature near, in a notch or with an arc as small as the shift: then less
    // than all of it
    // and the tip of one may be as near to the tip of the other: the shift leads along the first one's side
    const bool tips = at_both_tips(f, c, shift);
    const bool shallow = !truth.passed && push <= smallest && !tips;
    if (!unit || apart < (tips ? smallest : 0.5 * shift) || shallow)
      fail(f, tally.bad_normal, "normal", answer, truth);
  }

  /// True if an end of the site is met by the sample's point, or a place as near to it as `reach`.
  static bool at_both_tips(const Flight& f, const FeatureContact& c, double reach) {
    const Outline& sites = c.sample_on_a ? *f.b : *f.a;
    const BodyState at = (c.sample_on_a ? f.motion_b : f.motion_a).state(c.time);
    const Site& site = sites.sites[static_cast<std::size_t>(c.site)];
    const Frame frame(at.pose);
    return std::min((frame.to_world(site.a) - c.point).norm(), (frame.to_world(site.b) - c.point).norm()) <=
           reach;
  }

  /// Distance of the two features in contact alone, a shifted: the site, and those at whose joint the sample
  /// is.
  static double distance_of_contact(const Flight& f, const reference::Pair& pair, const FeatureContact& c,
                                    const Vec2& shift) {
    const Outline& carrier = c.sample_on_a ? *f.a : *f.b;
    const Sample& sample = carrier.samples[static_cast<std::size_t>(c.sample)];
    const Site& site = (c.sample_on_a ? *f.b : *f.a).sites[static_cast<std::size_t>(c.site)];
    double least = reference::kNever;
    for (std::size_t k = 0; k < carrier.sites.size(); ++k) {
      Site own = carrier.sites[k];
      const bool here = sample.arc_site < 0 ? own.a == sample.p || own.b == sample.p
                                            : sample.arc_site == static_cast<int>(k);
      if (!here) continue;
      // of a side the half that is near: its other end may touch the same site, elsewhere
      if (own.kind == SiteKind::segment) (own.a == sample.p ? own.b : own.a) = 0.5 * (own.a + own.b);
      least = std::min(least, c.sample_on_a ? pair.site_distance(own, site, c.time, shift)
                                            : pair.site_distance(site, own, c.time, shift));
    }
    return least;
  }

  /// The speed along the normal of the two points that touch, and how fast the distance falls just before.
  void check_speed(const Flight& f, const reference::Pair& pair, const PairAnswer& answer, const Touch& truth,
                   double rounding) {
    const FeatureContact& c = answer.contact;
    const BodyState sa = f.motion_a.state(c.time), sb = f.motion_b.state(c.time);
    const Vec2 va = sa.twist.at(c.point - sa.pose.position), vb = sb.twist.at(c.point - sb.pose.position);
    bool wrong = !(c.closing_speed >= 0.0) ||
                 std::abs(-c.normal.dot(va - vb) - c.closing_speed) >
                     (1e-7 + 64.0 * place_rounding(f, c.time) / f.size) * (body_speed(f) + vb.norm());
    const double spin = f.spin_a + f.spin_b;
    const double bend =
        f.relative_acceleration +
        4.0 * spin * (spin * (f.a->bounding_radius + f.b->bounding_radius) + pair.relative_speed) +
        4.0 * body_speed(f) * body_speed(f) / (1e-6 * f.size);
    const double h = 1e-2 * c.closing_speed / bend;
    // two tips come nearer by all of their speed, whichever of the directions between them is told
    if (h < c.time - f.from && h * c.closing_speed > 1e4 * rounding && h > 1e4 * 2.2e-16 * c.time &&
        !at_both_tips(f, c, 1e-9 * f.size)) {
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
      for (const double part : {0.37, 0.9, 0.999999, 0.999999999})
        if (const double from = f.from + part * (t - f.from);
            from < std::min(t, expected) - 1e-12 * (f.to - f.from) - 100 * time_tolerance(f, truth))
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
      same(in_instalments(sides, f, limits), closed ? "instalments, closed form" : "instalments");
    }
  }

  /// A few steps at a time, as a policy that looks no further than it must.
  PairAnswer in_instalments(const Sides& sides, const Flight& f, SearchLimits limits) {
    limits.max_iterations = 3;
    PairAnswer answer;
    double from = f.from;
    for (int k = 0; k < 20000; ++k) {
      answer = search(sides, from, f.to, limits);
      if (answer.status != PairAnswer::Status::undecided || answer.why != PairAnswer::Why::steps) break;
      from = answer.until;
    }
    return answer;
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
    const bool shallow = overlap_after(f, pair, said.contact.time).depth < kShallow * f.size;
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

  /// Starts in contact, going on as before: approaching.
  void check_pressed(const Flight& f, const PairAnswer& answer, const Touch& truth) {
    const FeatureContact& c = answer.contact;
    const double t = c.time;
    const Sides sides(f);
    const PairAnswer pressed = search(sides, t, f.to, SearchLimits());
    if (f.far && pressed.status == PairAnswer::Status::undecided) return;
    ++tally.pressed;
    // two tips are met a part of the touching distance before they are nearest, where that is told at all
    const double moment = 2 * time_tolerance(f, truth) + SearchLimits{}.touch / c.closing_speed;
    if (pressed.status != PairAnswer::Status::contact || pressed.contact.time > t + moment)
      fail(f, tally.pressed_wrong, "approaching from contact", pressed, truth);
  }

  /// The same flight near by, for the reference, of a motion that starts anew where the far one has come to.
  static Motion near_by(const Motion& far, const Motion& near, const Motion& anew) {
    BodyState start = anew.start();
    // both are multiples of the place's grain: nothing is rounded
    start.pose.position -= far.start().pose.position - near.start().pose.position;
    start.pose.angle = without_turns(start.pose.angle);
    return Motion::ballistic(anew.origin(), start, anew.acceleration());
  }

  /// How much further from the site of a contact its sample is at time t than where `back` begins [m]; less than 0: it goes
  /// in. Of an arc by the distance from its centre, of what is straight along its normal.
  static double parted(const Flight& back, const FeatureContact& c, double t) {
    const Motion &a = back.far ? back.near_a : back.motion_a, &b = back.far ? back.near_b : back.motion_b;
    const Sample& sample = (c.sample_on_a ? back.a : back.b)->samples[static_cast<std::size_t>(c.sample)];
    const Site& site = (c.sample_on_a ? back.b : back.a)->sites[static_cast<std::size_t>(c.site)];
    const auto height = [&](double time) {
      const Vec2 p = Frame((c.sample_on_a ? a : b).pose(time)).to_world(sample.p);
      const Frame of_site((c.sample_on_a ? b : a).pose(time));
      if (site.kind == SiteKind::arc) return (of_site.to_local(p) - site.center).norm();
      const Frame before((c.sample_on_a ? b : a).pose(back.from));
      const Vec2 out = c.sample_on_a ? c.normal : Vec2(-c.normal);
      return of_site.to_local(p).dot(before.direction_to_local(out));
    };
    double outward = 1.0;
    if (site.kind == SiteKind::arc) {
      const Frame of_site((c.sample_on_a ? b : a).pose(back.from));
      const Vec2 p = Frame((c.sample_on_a ? a : b).pose(back.from)).to_world(sample.p);
      const Vec2 out = c.sample_on_a ? c.normal : Vec2(-c.normal);
      outward = out.dot(p - of_site.to_world(site.center)) < 0.0 ? -1.0 : 1.0;
    }
    return outward * (height(t) - height(back.from));
  }

  /// Starts in contact, thrown back along the normal by so many times the closing speed. With 1 it parts by
  /// accelerations and turning alone.
  void check_rebound(const Flight& f, const PairAnswer& answer, double thrown) {
    const FeatureContact& c = answer.contact;
    const double t = c.time;
    Flight back = f;
    BodyState sa = f.motion_a.state(t);
    const double kick = thrown * c.closing_speed;
    sa.twist.velocity += kick * c.normal;
    back.motion_a = Motion::ballistic(t, sa, f.motion_a.acceleration());
    back.motion_b = Motion::ballistic(t, f.motion_b.state(t), f.motion_b.acceleration());
    if (f.far) {
      back.near_a = near_by(f.motion_a, f.near_a, back.motion_a);
      back.near_b = near_by(f.motion_b, f.near_b, back.motion_b);
    }
    back.from = t;
    back.relative_speed += kick;
    const reference::Pair pair = back.pair();
    // what places far away are rounded by; near by it is less than what is allowed for anyway
    const double rounding = f.far ? 64.0 * place_rounding(back, f.to) : 0.0;
    const double touching = 1e-12 * std::max(1.0, f.size) + rounding;
    // by then it must have left, or this is no clean rebound
    double gone = std::max(1e-12 * (f.to - f.from), std::nextafter(t, reference::kNever) - t);
    const double well_apart =
        std::max({1e-9 * f.size, 100.0 * 2.2e-16 * f.to * body_speed(back), 4.0 * rounding});
    while (t + gone < f.to && pair.distance(t + gone) < well_apart) gone *= 2.0;
    if (gone > 1e-3 * (f.to - f.from) || t + gone >= f.to) return;
    for (double s = gone; s > 1e-3 * gone; s *= 0.7) {
      const double part = s / gone;
      const double least = thrown > 1.0 ? 0.2 * kick / 3.0 * s : 0.2 * pair.distance(t + gone) * part * part;
      if (pair.distance(t + s) <= least) return;
      // without restitution accelerations may press: then the distance is that behind the surface
      if (thrown == 1.0 && parted(back, c, t + s) <= least) return;
    }
    ++(thrown > 1.0 ? tally.rebounds : tally.partings);
    if (f.far) ++tally.far_rebounds;
    Sides sides_back(back);
    sides_back.a.velocity_rounding = sides_back.b.velocity_rounding = 16 * 2.2e-16 * pair.relative_speed;
    SearchLimits limits;
    const Touch next = true_touch(back, pair, t + gone, f.to);
    for (const bool closed : {false, true}) {
      limits.closed_forms = closed;
      const PairAnswer again = search_on(sides_back, t, f.to, limits);
      const bool says = again.status == PairAnswer::Status::contact;
      const bool clean = next.real && next.closing > 1e-3 * c.closing_speed;
      const double error = says ? std::abs(again.contact.time - next.time) : 0.0;
      bool wrong = false;
      if (again.status == PairAnswer::Status::undecided && f.far) continue;
      if (again.status == PairAnswer::Status::undecided)
        wrong = true;
      else if (next.time > f.to)
        wrong = says && pair.distance(again.contact.time) > touching;
      else if (!says)
        wrong = clean;
      else if (next.grazed && again.contact.time < next.time - time_tolerance(back, next))
        wrong = pair.distance(again.contact.time) > touching;
      else
        wrong = again.contact.time <= t ||
                (clean && error > 1e-10 + 1e-13 / next.closing && error > 16 * time_tolerance(back, next));
      if (says && again.contact.time <= t + gone) {
        // before the reference looks: the same contact once more is wrong, another one (in a notch) is not
        const bool another = again.contact.normal.dot(c.normal) < 0.999;
        wrong = !another || pair.distance(again.contact.time) > touching;
        // nor is it where accelerations press on the site that comes next, at a joint where this one curves away
        if (thrown == 1.0 && again.contact.site != c.site && parted(back, again.contact, t + gone) < 0.0)
          wrong = false;
      }
      if (wrong && !next.given_up)
        fail(back, tally.rebound_wrong,
             thrown > 1.0 ? (closed ? "rebound, closed form" : "rebound")
                          : (closed ? "parting, closed form" : "parting"),
             again, next);
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
