#include "brink/core/query/cast_outline.h"

#include <algorithm>
#include <cmath>

#include "brink/core/base/error.h"
#include "brink/core/query/outline_gap.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"

namespace brink {

namespace {

/// A point that moves along a unit direction, in the frame of the sites that it may meet.
struct Mover {
  Vec2 from, direction;
};

/// When the mover comes within `reach` of a place, and when it leaves it; nothing if it misses it.
struct Passage {
  double enters = 0.0, leaves = -1.0;  ///< leaves < enters: never within
};

/// The roots of t^2 - 2 along t + |d|^2 - reach^2, for a unit direction.
Passage passage(const Vec2& center, double reach, const Mover& mover) {
  const Vec2 d = mover.from - center;
  const double along = -d.dot(mover.direction), beside = cross(d, mover.direction);
  const double square = (reach - beside) * (reach + beside);
  if (square < 0.0) return {};
  const double half = std::sqrt(square), product = (d.norm() - reach) * (d.norm() + reach);
  // the product of the two is known without cancellation
  const double greater = along >= 0.0 ? along + half : along - half;
  const double other = greater == 0.0 ? 0.0 : product / greater;
  return along >= 0.0 ? Passage{other, greater} : Passage{greater, other};
}

/// Where the samples of one outline, moving, may first come within their radius of the other's sites.
class TouchCandidates {
 public:
  explicit TouchCandidates(double slack) : slack_(slack) {}

  void look(const Outline& samples_of, const Frame& samples_at, const Outline& sites_of,
            const Frame& sites_at, const Vec2& direction) {
    for (const Sample& sample : samples_of.samples) {
      const Mover mover{sites_at.to_local(samples_at.to_world(sample.p)),
                        sites_at.direction_to_local(direction)};
      for (const Site& site : sites_of.sites) {
        const double reach = site.radius + sample.radius;
        // roots are those of whole lines and circles: they count where the
        // site itself is, and for an arc's sample where its sector looks
        const auto keep = [&](double distance) {
          if (distance < -slack_ || !touches(site, mover, distance, reach)) return;
          if (sample.arc_site >= 0 && !sees(samples_of, samples_at, sample, sites_at, site, mover, distance))
            return;
          distances_.push_back(std::max(0.0, distance));
        };
        look_at(site, reach, mover, keep);
      }
    }
  }

  const std::vector<double>& in_order() {
    std::sort(distances_.begin(), distances_.end());
    return distances_;
  }

 private:
  /// Every distance at which the mover may come within reach of the site
  /// from outside. Of a disc only the way in: leaving it is no contact.
  template <class Keep>
  static void look_at(const Site& site, double reach, const Mover& mover, Keep&& keep) {
    const auto enter = [&](const Vec2& center, double radius) {
      if (const Passage p = passage(center, radius, mover); p.leaves >= p.enters) keep(p.enters);
    };
    enter(site.a, reach);
    if (site.kind == SiteKind::point) return;
    enter(site.b, reach);
    if (site.kind == SiteKind::segment) {
      // of the two lines at `reach` from the segment the one that faces the mover
      Vec2 normal = perp((site.b - site.a).normalized());
      if (normal.dot(mover.direction) > 0.0) normal = -normal;
      const double approach = -normal.dot(mover.direction);
      if (approach > 0.0) keep((normal.dot(mover.from - site.a) - reach) / approach);
      return;
    }
    // from the hollow side a mover comes within reach where it leaves the circle
    // that is `reach` smaller; there is none where it does not fit in
    enter(site.center, site.arc_radius + reach);
    if (const Passage p = passage(site.center, site.arc_radius - reach, mover);
        site.arc_radius >= reach && p.leaves >= p.enters)
      keep(p.leaves);
  }

  /// At the distance the site itself, not its line or circle beyond the ends, is `reach` away.
  bool touches(const Site& site, const Mover& mover, double distance, double reach) const {
    const Nearest nearest = nearest_on(site, mover.from + distance * mover.direction);
    return std::abs(nearest.distance - reach) <= slack_;
  }

  /// An arc is there in its sector alone.
  bool sees(const Outline& samples_of, const Frame& samples_at, const Sample& sample, const Frame& sites_at,
            const Site& site, const Mover& mover, double distance) const {
    const Vec2 q = mover.from + distance * mover.direction;
    const Vec2 toward = sites_at.direction_to_world(nearest_on(site, q).point - q);
    const Site& arc = samples_of.sites[static_cast<std::size_t>(sample.arc_site)];
    return toward.norm() <= slack_ || in_sector(arc, samples_at.direction_to_local(toward));
  }

  double slack_;
  std::vector<double> distances_;
};

/// Where a vertex goes from one side of a site of no thickness to the other.
struct Crossover {
  double distance = 0.0;  ///< of the way [m]
  Vec2 place = Vec2::Zero();
};

/// Sine of the angle at which a way meets a surface [rad]: below it what it does is grazing.
constexpr double kGrazing = 1e-5;

/// visit(distance) where the mover crosses the core itself, neither end of it.
template <class Visit>
void crossed_by(const Site& site, const Mover& mover, Visit&& visit) {
  if (site.kind == SiteKind::point) return;
  if (site.kind == SiteKind::segment) {
    const Vec2 along = site.b - site.a, from = site.a - mover.from;
    const double approach = cross(along, mover.direction);
    if (std::abs(approach) <= kGrazing * along.norm()) return;
    const double distance = cross(along, from) / approach;
    const double at = along.dot(distance * mover.direction - from);
    if (at > 0.0 && at < along.squaredNorm()) visit(distance);
    return;
  }
  const Passage p = passage(site.center, site.arc_radius, mover);
  if (p.leaves < p.enters) return;
  for (const double distance : {p.enters, p.leaves}) {
    const Vec2 out = mover.from + distance * mover.direction - site.center;
    if (std::abs(out.dot(mover.direction)) > kGrazing * site.arc_radius && in_sector(site, out))
      visit(distance);
  }
}

/// All crossovers of `a`, moved aside first and then along `direction`, and wires of `b`: of the vertices of each over the
/// other's sites. In a's frame, in no order. Places are where the vertex of `a`, or the vertex of `b`, is on its own outline.
std::vector<Crossover> crossovers(const Outline& a, const Outline& b, const Frame& b_from_a,
                                  const Vec2& direction, double aside) {
  std::vector<Crossover> found;
  const Vec2 shift = aside * perp(direction);
  for (const Sample& sample : a.samples) {
    if (sample.arc_site >= 0) continue;
    const Mover mover{b_from_a.to_local(sample.p + shift), b_from_a.direction_to_local(direction)};
    for (const Site& site : b.sites)
      crossed_by(site, mover, [&](double distance) { found.push_back({distance, sample.p}); });
  }
  for (const Sample& sample : b.samples) {
    if (sample.arc_site >= 0) continue;
    const Vec2 from = b_from_a.to_world(sample.p) - shift;
    for (const Site& site : a.sites)
      crossed_by(site, {from, -direction}, [&](double distance) {
        found.push_back({distance, from - distance * direction});
      });
  }
  return found;
}

/// Radius of the largest circle [m]; 0 without arcs.
double largest_arc(const Outline& outline) {
  double radius = 0.0;
  for (const Site& site : outline.sites) radius = std::max(radius, site.arc_radius);
  return radius;
}

/// Wires have no inside, and no end that reaches through what is exactly as wide as they are.
bool is_thin(const Outline& outline) { return !outline.solid && outline.sites[0].radius == 0.0; }

/// How the two are told to touch: a little further on they are in each other. `noise` is what roundings
/// make of a gap, `further` how far beyond a candidate is looked, and a gap below -deep is an overlap.
struct Trial {
  const Outline& a;
  const Outline& b;
  Pose b_from_a;
  Vec2 direction;                                 // in a's frame
  double noise = 0.0, further = 0.0, deep = 0.0;  // [m]

  Trial(const Outline& a_, const Outline& b_, const Pose& b_from_a_, const Vec2& direction_)
      : a(a_), b(b_), b_from_a(b_from_a_), direction(direction_) {
    const double largest = a.bounding_radius + b.bounding_radius;
    double least = std::min(a.bounding_radius, b.bounding_radius);
    // a bare point has no size: the other's counts, and of two points a metre
    if (!(least > 0.0)) least = largest > 0.0 ? largest : 1.0;
    noise = 8e-16 * (largest + b_from_a.position.norm());
    // flush edges share an inside from 1e-7 of the size on; where
    // flat arcs cross is told to the root of its rounding
    const double flat = 5e-8 * std::sqrt(least * std::max(largest_arc(a), largest_arc(b)));
    // a straight face met at an angle x is further * sin x deep a little further on: where rounding does
    // not decide, 1e-5 rad and more are told from grazing
    further = std::max({1e-5 * least, 1e3 * noise, flat});
    deep = std::max(1e-10 * least, noise);
  }

  double gap_after(double distance, double beside = 0.0) const {
    return outline_gap(a, {distance * direction + beside * perp(direction), 0.0}, b, b_from_a).gap;
  }
  /// Of the places from at[k] on, as far as enters_at(at[k]) looks, the last that is not in the other: those
  /// before it are grazed.
  double last_clear(const std::vector<double>& at, std::size_t k) const {
    double found = at[k];
    for (std::size_t j = k + 1; j < at.size() && at[j] <= at[k] + further; ++j)
      if (at[j] - found > 4.0 * noise && gap_after(at[j]) >= -noise) found = at[j];
    return found;
  }
  bool enters_at(double distance) const {
    const double on = distance + further, beside = 0.5 * further;
    if (gap_after(on) < -deep) return true;
    if (!is_thin(a) && !is_thin(b)) return false;
    // a wire that lies flush on a face of its own width has its ends on the sides of
    // it: no sample is inside and nothing crosses; moved aside by half as far as it
    // went in, one end is inside. To both sides: what grazes enters on one alone
    return (gap_after(on, beside) < -deep && gap_after(on, -beside) < -deep) || changes_sides_at(distance);
  }
  /// Wires of one form that lie one in the other are clear of each other before and after, on two sides. Moved aside by a
  /// little, either way, a vertex of one goes over a line of the other about there.
  bool changes_sides_at(double distance) const {
    if (!is_thin(a) || !is_thin(b)) return false;
    const double little = 0.01 * further;
    const auto close = [&](const std::vector<Crossover>& all) {
      std::vector<Crossover> out;
      for (const Crossover& c : all)
        if (std::abs(c.distance - distance) <= further) out.push_back(c);
      return out;
    };
    const Frame at(b_from_a);
    const std::vector<Crossover> left = close(crossovers(a, b, at, direction, little)),
                                 right = close(crossovers(a, b, at, direction, -little));
    return std::any_of(left.begin(), left.end(), [&](const Crossover& l) {
      return std::any_of(right.begin(), right.end(),
                         [&](const Crossover& r) { return (l.place - r.place).norm() <= further; });
    });
  }
};

void check_direction(const Vec2& direction) {
  if (!direction.allFinite() || std::abs(direction.norm() - 1.0) > 1e-9)
    throw BadInput("cast_outline: direction is no unit vector; given length " +
                   std::to_string(direction.norm()) + ", allowed: 1");
}

/// check_direction() lets its length be off by 1e-9, which over the way would be more than touches() allows.
/// What is unit to rounding keeps its bits.
Vec2 unit(const Vec2& direction) {
  return std::abs(direction.norm() - 1.0) <= 1e-15 ? direction : direction.normalized();
}

}  // namespace

OutlineHit cast_outline(const Outline& a, const Pose& pose_a, const Vec2& direction, const Outline& b,
                        const Pose& pose_b) {
  check_direction(direction);
  const Frame frame(pose_a);
  // seen from a: far away, nothing of what is between them is lost
  const Pose b_from_a{frame.to_local(pose_b.position), pose_b.angle - pose_a.angle};
  const Vec2 along = frame.direction_to_local(unit(direction));
  const Trial trial(a, b, b_from_a, along);
  // what touches may have a gap of a rounding below 0: only what is deeper overlaps
  if (trial.gap_after(0.0) < -trial.deep) return {OutlineHit::Status::overlaps, 0.0};
  TouchCandidates candidates(trial.deep);
  candidates.look(a, Frame(), b, Frame(b_from_a), along);
  candidates.look(b, Frame(b_from_a), a, Frame(), -along);
  const std::vector<double>& at = candidates.in_order();
  // the first that leads into b is the contact, those before it graze;
  // outline_gap(), the slow part, is asked in order and no farther than that
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (k > 0 && at[k] - at[k - 1] < trial.noise) continue;  // looked at
    // of flat arcs the end of a sector is told to the root of a rounding: the next arc's circle may be there before it
    if (trial.gap_after(at[k]) > trial.deep) continue;
    if (trial.enters_at(at[k])) return {OutlineHit::Status::touches, trial.last_clear(at, k)};
  }
  return {};
}

}  // namespace brink
