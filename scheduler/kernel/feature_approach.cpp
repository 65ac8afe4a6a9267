#include "brink/scheduler/kernel/feature_approach.h"

#include <algorithm>
#include <cmath>

#include "brink/core/base/limits.h"
#include "brink/scheduler/first_contact/tolerances.h"
#include "brink/scheduler/islands/tolerances.h"

namespace brink {

namespace {

/// A corner so far off another, in units of how far off it lies on it, is beside it.
constexpr double kBesideCorner = 4.0;
/// Looks along a contact's tangents until it arrives, or passes by.
constexpr int kTangents = 32, kHalvingsOfWay = 60;
/// By how much a step may miss the gap to a wire without thickness, in touching distances: from half of one, at which a sharp
/// sample meets it, a few such misses do not lead through it.
constexpr double kThinMiss = 0.125;

/// The time after `open`, where the gap is still open, at which it closes: to the contact tolerance before that, and no more than
/// `most` behind it; `open` where it jumps.
template <class Gap>
double root_between(Gap&& gap_at, double open, double gap, double past, double most, double tolerance) {
  const double from = open;
  for (int k = 0; k < kHalvingsOfWay && gap > tolerance; ++k) {
    const double middle = 0.5 * (open + past), there = gap_at(middle);
    if (there < -most) {
      past = middle;
    } else {
      open = middle;
      gap = there;
    }
  }
  return gap > tolerance ? from : open;
}

}  // namespace

/// A wire without thickness is met before it is touched.
double FeatureApproach::kept(const NearFeature& f) const {
  return f.thin ? thin_level_at_most(search_->limits().touch, search_->limits().tolerance) : 0.0;
}

/// True of a sharp corner upon a sharp one: what is round goes over an end in one piece.
bool FeatureApproach::is_sharp(const HeldContact& c) const {
  const Outline *carrier = &search_->outline_of(c.pair.body),
                *other = &search_->outline_of(search_->other_owner(c.pair));
  if (!c.feature.sample_on_a) std::swap(carrier, other);
  return carrier->samples[c.feature.sample].radius + other->sites[c.feature.site].radius == 0.0;
}

/// Within a contact tolerance of what its features keep: at a wire without thickness a touch, else 0.
bool FeatureApproach::touches(const HeldContact& c) const {
  return c.feature.gap - kept(c.feature) <= search_->limits().tolerance;
}

/// True if the site ends at a corner that touches one of the sample's edges: the sample is far from that corner, and through it as
/// soon as it sinks into the edge by a rounding, which its own contact sees to.
bool FeatureApproach::is_kept_by_corner(const HeldContact& c,
                                        const std::vector<HeldContact>& contacts) const {
  if (!c.feature.at_end || touches(c)) return false;
  const Outline &a = search_->outline_of(c.pair.body), &b = search_->outline_of(search_->other_owner(c.pair));
  const auto ends = [](const Sample& corner, int site) {
    return corner.before == site || corner.after == site;
  };
  const Sample& sample = (c.feature.sample_on_a ? a : b).samples[c.feature.sample];
  return std::any_of(contacts.begin(), contacts.end(), [&](const HeldContact& o) {
    return o.pair == c.pair && o.feature.sample_on_a != c.feature.sample_on_a &&
           ends(sample, o.feature.site) &&
           ends((o.feature.sample_on_a ? a : b).samples[o.feature.sample], c.feature.site) && touches(o);
  });
}

/// Of the contact's body, and of its other owner.
std::pair<Vec3, Vec3> FeatureApproach::velocities_of(const HeldContact& c,
                                                     const std::vector<Vec3>& velocity) const {
  return {members_->velocity_of(members_->place_of(c.pair.body), velocity),
          c.pair.with_site() ? as_vector(members_->other_state(c.pair).twist.rounded())
                             : members_->velocity_of(members_->place_of(c.pair.other_body), velocity)};
}

/// No gap of the two closes faster if the members go on as they do now [m/s]: both centres, and both arms as far from them
/// as a member reaches.
double FeatureApproach::fastest_approach(const HeldContact& c, const std::vector<Vec3>& velocity) const {
  const auto [of_body, of_other] = velocities_of(c, velocity);
  const double radius = members_->bounding_radius(members_->place_of(c.pair.body));
  return (of_body - of_other).head<2>().norm() + std::abs(of_body[2]) * radius +
         std::abs(of_other[2]) * (c.feature.point.norm() + radius);
}

/// By how much its gap may be missed [m]: through a wire without thickness nothing comes.
double FeatureApproach::most_missed(const NearFeature& f) const {
  return f.thin ? kThinMiss * search_->limits().touch : search_->limits().tolerance;
}

/// When the two features meet if the members go on as they do now. By tangents and secants, which lead to before the root of a
/// convex gap; of one that is not, as of a corner that turns towards a side, they lead past it, and halving leads back.
FeatureArrival FeatureApproach::arrival(const HeldContact& c, const std::vector<Vec3>& velocity,
                                        double h) const {
  const double tolerance = search_->limits().tolerance, fastest = fastest_approach(c, velocity);
  const double most = most_missed(c.feature);
  const auto gap_at = [&](double t) { return members_->gap(c, t, velocity) - kept(c.feature); };
  double closing = members_->closing_speed(c), gap = c.feature.gap - kept(c.feature), t = 0.0;
  for (int k = 0; k < kTangents; ++k) {
    if (gap > fastest * (h - t)) return {};
    // where the line through the gap reaches 0; where it opens, or the step ends before, it may bend down on the way
    double way = gap / closing;
    const bool within = closing > 0.0 && t + way <= h;
    if (!within) way = h - t;
    if (!(way > 0.0)) return {};
    const double next = gap_at(t + way);
    if (next < -most) {
      if (const double root = root_between(gap_at, t, gap, t + way, most, tolerance); root > t) {
        closing = std::min((gap - next) / way, fastest);
        t = root;
        break;
      }
    }
    if (!within) return {};
    // the secant's slope: no derivative of the gap is at hand there. What comes past an end is behind a site at once: the
    // gap jumps, and no slope is as steep.
    closing = std::min((gap - next) / way, fastest);
    t += way;
    gap = next;
    if (gap <= tolerance) break;
  }
  return passes_by(c, velocity, t, closing) ? FeatureArrival{} : FeatureArrival{t, closing};
}

/// True if what comes to the end of a site does not meet it, but goes by: some tolerances further on it is clear
/// of it.
bool FeatureApproach::passes_by(const HeldContact& c, const std::vector<Vec3>& velocity, double then,
                                double closing) const {
  const double tolerance = search_->limits().tolerance;
  if (!c.feature.at_end || !(closing > 0.0)) return false;
  const double further = members_->gap(c, then + 4.0 * tolerance / closing, velocity) - kept(c.feature);
  // some roundings in it where it runs along the next side from there on
  return further > 0.0 || (further > -kMissCounts * tolerance && !c.feature.no_way_by);
}

/// Which of their sides meet is another thing once it is beside it.
double FeatureApproach::corner_parts_in(const HeldContact& c, const std::vector<Vec3>& velocity) const {
  const NearFeature& f = c.feature;
  if (!f.at_end || !is_sharp(c) || !(std::abs(f.gap) <= f.one_corner)) return kForever;
  const auto [of_body, of_other] = velocities_of(c, velocity);
  const Vec2 arm = members_->arm(c).cast<double>();
  const Vec2 apart =
      of_body.head<2>() + cross(of_body[2], arm) - of_other.head<2>() - cross(of_other[2], f.point);
  return kBesideCorner * f.one_corner / apart.norm();
}

}  // namespace brink
