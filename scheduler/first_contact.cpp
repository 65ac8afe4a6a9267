#include "brink/scheduler/first_contact.h"

#include <algorithm>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "brink/scheduler/arc_contact.h"
#include "brink/scheduler/canonical_time.h"
#include "brink/scheduler/closed_forms.h"
#include "brink/scheduler/site_step.h"

namespace brink {

namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// What the search knows about one feature pair at one moment.
struct Feature {
  int sample = -1;
  int site = -1;
  double gap = 0.0;
  double rate = 0.0;
  Vec2 normal = Vec2::Zero();  ///< T's frame, out of the site
  Vec2 point = Vec2::Zero();   ///< T's frame, on the site
};

/// Samples of S against sites of T: one half of the two-sided test.
struct Half {
  const Mover* s;
  const Mover* t;
  bool s_is_a;
  double* safe_until;  ///< one a sample of S

  const Outline& samples_of() const { return s->outline(); }
  const Outline& sites_of() const { return t->outline(); }
  int count() const { return static_cast<int>(samples_of().samples.size()); }
};

class PairSearch {
 public:
  PairSearch(const Mover& a, const Mover& b, double from, double to, const SearchLimits& limits,
             SearchScratch& scratch, WorkCounters& work)
      : a_(a), b_(b), from_(from), to_(to), window_end_(to), limits_(limits), scratch_(scratch), work_(work) {
    const std::size_t na = a.outline().samples.size(), nb = b.outline().samples.size();
    scratch.safe_until.assign(na + nb, from);
    halves_[0] = {&a, &b, true, scratch.safe_until.data()};
    halves_[1] = {&b, &a, false, scratch.safe_until.data() + na};
    // A core of one point needs no reverse test: its one sample against the other's sites is the whole
    // distance.
    if (a.outline().is_point())
      drop(1, nb);
    else if (b.outline().is_point())
      drop(0, na);
  }

  PairAnswer run() {
    if (!apart_by_bounding_discs()) advance();
    if (best_.sample >= 0) return {PairAnswer::Status::contact, best_.time, best_};
    if (capped_) return {PairAnswer::Status::undecided, reached_, {}};
    return {PairAnswer::Status::clear, to_, {}};
  }

  /// Every feature with a gap up to `tolerance` at time t.
  void collect(double t, double tolerance, std::vector<FeatureContact>& found) {
    place(t);
    for (const Half& half : halves_)
      for (int i = 0; i < half.count(); ++i) {
        if (half.safe_until[i] == kForever) continue;
        features_of(half, i, tolerance, [&](const Feature& f) { found.push_back(contact_of(half, f, t)); });
      }
  }

  /// The features of `like`, with both outlines placed in the given states.
  FeatureContact in_states(const BodyState& state_a, const BodyState& state_b, const FeatureContact& like) {
    placed_a_ = Placed(a_.outline(), state_a);
    placed_b_ = Placed(b_.outline(), state_b);
    FeatureContact c = contact_again(halves_[like.sample_on_a ? 0 : 1], {like.sample, like.site}, like.time);
    if (!(c.normal.dot(like.normal) > 1.0 - 1e-6)) c.normal = like.normal;
    return c;
  }

  double gap(double t) {
    place(t);
    double least = kForever;
    for (const Half& half : halves_)
      for (int i = 0; i < half.count(); ++i)
        if (half.safe_until[i] != kForever)
          features_of(half, i, kForever, [&](const Feature& f) { least = std::min(least, f.gap); });
    return least;
  }

 private:
  void drop(int half, std::size_t count) { std::fill_n(halves_[half].safe_until, count, kForever); }

  /// Steps the discs that hold the two outlines; true if they stay apart to the end. Else moves from_ on, but
  /// not onto the discs' contact: it may be the pair's, and wants polishing from before.
  bool apart_by_bounding_discs() {
    const Outline &oa = a_.outline(), &ob = b_.outline();
    if (oa.container || ob.container) return false;
    const double reach = oa.bounding_radius + ob.bounding_radius;
    const double near = 1e-3 * reach + limits_.tolerance;  // as near as makes no difference
    const bool straight = a_.motion->is_ballistic() && b_.motion->is_ballistic() &&
                          a_.motion->acceleration().linear == b_.motion->acceleration().linear;
    double t = from_;
    for (int i = 0; i < 64 && t < to_; ++i) {
      const BodyState sa = a_.motion->state(t), sb = b_.motion->state(t);
      const Vec2 d = sa.pose.position - sb.pose.position, v = sa.twist.velocity - sb.twist.velocity;
      const double distance = d.norm(), f = distance - reach;
      if (f <= near) break;
      if (straight) {  // no curvature: there at once
        const double held = reach + 0.5 * near;
        t += falling_root({(distance - held) * (distance + held), 2.0 * d.dot(v), 2.0 * v.squaredNorm()});
        break;
      }
      const RelativeBounds bounds = bounds_over(t, to_);
      const double df = d.dot(v) / distance;
      t += safe_step(f - 0.5 * near, df, bounds.acceleration) * (1.0 - 4.0 * kEpsilon);
    }
    if (t >= to_) return true;
    from_ = t;
    for (Half& half : halves_)
      for (int i = 0; i < half.count(); ++i)
        if (half.safe_until[i] != kForever) half.safe_until[i] = t;
    return false;
  }

  void advance() {
    long_bounds_ = bounds_over(from_, to_);
    short_window_ = to_ - from_;
    reached_ = from_;
    for (int iteration = 0;; ++iteration) {
      const double t = least_safe_time();
      if (t >= to_) return;
      reached_ = t;
      if (iteration >= limits_.max_iterations) {
        capped_ = true;
        return;
      }
      ++work_.search_iterations;
      place(t);
      short_end_ = std::min(to_, t + short_window_);
      short_bounds_ = bounds_over(t, short_end_);
      const double due = t + 0.25 * std::min(short_window_, to_ - t);
      least_ = kForever;
      // the nearest ones first: beside their steps most others are seen to be far at a glance
      const int first[2] = {nearest_due(halves_[0], due), nearest_due(halves_[1], due)};
      for (int h = 0; h < 2; ++h)
        if (first[h] >= 0) advance_sample(halves_[h], first[h]);
      for (int h = 0; h < 2; ++h)
        for (int i = 0; i < halves_[h].count(); ++i)
          if (i != first[h] && halves_[h].safe_until[i] <= due) advance_sample(halves_[h], i);
      short_window_ = std::max(4.0 * (least_ - t), 64.0 * ulp(t));
    }
  }

  /// Of the samples due, the one nearest to the other outline's origin; -1 if none is.
  int nearest_due(const Half& half, double due) const {
    const Vec2 origin = placed(half.s).frame.to_local(placed(half.t).frame.origin);
    int nearest = -1;
    double least = kForever;
    for (int i = 0; i < half.count(); ++i) {
      if (half.safe_until[i] > due) continue;
      const double distance2 = (half.samples_of().samples[i].p - origin).squaredNorm();
      if (nearest >= 0 && distance2 >= least) continue;
      least = distance2;
      nearest = i;
    }
    return nearest;
  }

  void advance_sample(const Half& half, int i) {
    // never less than the next double, or the search would stand still
    half.safe_until[i] = std::max(t_ + step(half, i), std::nextafter(t_, kForever));
    least_ = std::min(least_, half.safe_until[i]);
  }

  RelativeBounds bounds_over(double from, double to) const {
    return RelativeBounds::over(a_.outline(), *a_.motion, b_.outline(), *b_.motion, from, to);
  }

  double least_safe_time() const {
    double t = kForever;
    for (const Half& half : halves_)
      for (int i = 0; i < half.count(); ++i) t = std::min(t, half.safe_until[i]);
    return t;
  }

  void place(double t) {
    t_ = t;
    placed_a_.move(a_.outline(), a_.motion->state(t));
    placed_b_.move(b_.outline(), b_.motion->state(t));
  }
  const Placed& placed(const Mover* m) const { return m == &a_ ? placed_a_ : placed_b_; }

  /// Safe time step of one sample from t_ [s]; records a contact if it finds one (and is then safe up to it).
  double step(const Half& half, int i) {
    const Sample& sample = half.samples_of().samples[i];
    const SamplePath path = sample_path(placed(half.s), placed(half.t), sample.p);
    const double long_window = to_ - t_, short_window = short_end_ - t_;
    const RelativeBounds relative = half.s_is_a ? long_bounds_ : long_bounds_.swapped();
    const RelativeBounds near = half.s_is_a ? short_bounds_ : short_bounds_.swapped();
    const PathBounds over_all = path_bounds(path, relative, long_window);
    const double apart = clear_of_disc(half, sample, path, over_all);
    if (apart >= long_window || apart > 2.0 * (least_ - t_)) return apart * (1.0 - 4.0 * kEpsilon);
    const PathBounds over_short = path_bounds(path, near, short_window);
    double safe = 0.0, again = 0.0;
    if (sample.arc_site < 0) {
      std::tie(safe, again) = vertex_steps(half, i, path, over_all, over_short, long_window, short_window);
    } else {
      safe = arc_sample_step(half, i, path, relative, over_all);
      if (safe < short_window) again = arc_sample_step(half, i, path, near, over_short);
    }
    if (safe < short_window) safe = std::max(safe, std::min(again, short_window));
    return safe * (1.0 - 4.0 * kEpsilon);
  }

  /// How long a sample is sure to stay out of the disc that holds the other outline; 0 if it is in it.
  static double clear_of_disc(const Half& half, const Sample& sample, const SamplePath& path,
                              const PathBounds& bounds) {
    const Outline& outline = half.sites_of();
    const double f = path.distance - outline.bounding_radius - sample.radius;
    if (outline.container || outline.is_point() || !(f > 0.0)) return 0.0;
    return safe_step(f, path.q.dot(path.rate) / path.distance, bounds.acceleration);
  }

  /// Safe steps by the bounds over the whole window and by those over the short one; every site is looked at
  /// once.
  std::pair<double, double> vertex_steps(const Half& half, int i, const SamplePath& path,
                                         const PathBounds& over_all, const PathBounds& over_short,
                                         double window, double short_window) {
    const Sample& sample = half.samples_of().samples[i];
    const Outline& sites = half.sites_of();
    ++work_.distance_queries;
    const double band = touching_band(over_all);
    const double reach = over_all.speed * window + sample.radius + 2.0 * band;
    const Candidates near = half.t->index->candidates(path.q, reach, scratch_.index);
    work_.candidate_evaluations += near.sites.size();
    const double others = std::max(0.0, near.others_at_least - sample.radius - 0.5 * band);
    double safe = over_all.speed > 0.0 ? others / over_all.speed : kForever;
    double again = over_short.speed > 0.0 ? others / over_short.speed : kForever;
    bool neighbours_known = false;
    for (const std::uint32_t j : near.sites) {
      const Site& site = sites.sites[j];
      const Nearest nearest = nearest_on(site, path.q);
      const double radius = site.radius + sample.radius;
      const double gap = nearest.distance - radius;
      if (gap <= band) {
        if (!neighbours_known) find_neighbours(half, i, near.sites, path, 4.0 * band);
        neighbours_known = true;
        if (meets(half, i, static_cast<int>(j), nearest, path, over_all)) continue;
      }
      const double beyond = gap - 0.5 * band;  // too far to matter at any speed?
      if (beyond > band && beyond >= safe * over_all.speed &&
          beyond >= std::min(again, short_window) * over_short.speed)
        continue;
      const double slack = slack_at(gap, band, !site.solid && radius == 0.0);
      const double rate = distance_rate(site, nearest, path.q, path.rate);
      safe = std::min(safe, site_step(site, nearest, path.q, path.rate, rate, radius, slack, over_all).safe);
      again =
          std::min(again, site_step(site, nearest, path.q, path.rate, rate, radius, slack, over_short).safe);
    }
    return {safe, again};
  }

  /// Gaps up to this are touching [m]: the tolerance, or what the point moves in a few roundings of the time.
  double touching_band(const PathBounds& bounds) const {
    return std::max(limits_.tolerance, 8.0 * bounds.speed * ulp(t_));
  }

  /// Added to a gap before stepping. A step leads into the band, never onto the surface: beyond a thin wire
  /// by a rounding error the point would seem to recede. In contact the gap may sink by `touch`, but not
  /// through a wire.
  double slack_at(double gap, double band, bool thin) const {
    const bool may_sink = gap <= (thin ? 0.1 : 1.0) * limits_.touch;
    return may_sink ? limits_.touch : -0.5 * std::min(gap, band);
  }

  double arc_sample_step(const Half& half, int i, const SamplePath& path, const RelativeBounds& relative,
                         const PathBounds& bounds) {
    const Sample& sample = half.samples_of().samples[i];
    const Site& arc = half.samples_of().sites[sample.arc_site];
    const Outline& sites = half.sites_of();
    const double band = touching_band(bounds);
    double safe = kForever;
    for (std::size_t j = 0; j < sites.sites.size(); ++j) {
      ++work_.candidate_evaluations;
      ArcStep step =
          arc_step(arc, sites.sites[j], path, placed(half.s), placed(half.t), 0.0, band, relative, bounds);
      if (step.active && step.gap <= band) {
        if (polish(half, {i, static_cast<int>(j), step.gap, step.rate, step.normal, step.point}, path,
                   bounds))
          continue;
        step = arc_step(arc, sites.sites[j], path, placed(half.s), placed(half.t),
                        step.gap <= limits_.touch ? limits_.touch : 0.0, band, relative, bounds);
      }
      safe = std::min(safe, step.safe);
    }
    return safe;
  }

  /// Keeps those of `sites` that lie within `reach` of vertex sample i, and how it stands to them now.
  void find_neighbours(const Half& half, int i, std::span<const std::uint32_t> sites, const SamplePath& path,
                       double reach) {
    const double radius = half.samples_of().samples[i].radius;
    scratch_.neighbours.clear();
    for (const std::uint32_t k : sites) {
      const Site& site = half.sites_of().sites[k];
      const Nearest nearest = nearest_on(site, path.q);
      if (nearest.distance - site.radius - radius > reach) continue;
      const Feature f = vertex_feature(half, i, static_cast<int>(k), nearest, path);
      const bool leaving = f.gap <= limits_.touch && !approaching(f, path);
      scratch_.neighbours.push_back({f.site, f.normal, leaving});
    }
  }

  /// A vertex sample within tolerance of a site: true if it meets this very site and the contact is
  /// remembered.
  bool meets(const Half& half, int i, int j, const Nearest& nearest, const SamplePath& path,
             const PathBounds& bounds) {
    if (belongs_to_a_neighbour(half, j, nearest, path.q)) return false;
    return polish(half, vertex_feature(half, i, j, nearest, path), path, bounds);
  }

  Feature vertex_feature(const Half& half, int i, int j, const Nearest& nearest,
                         const SamplePath& path) const {
    const Sample& sample = half.samples_of().samples[i];
    const Site& site = half.sites_of().sites[j];
    Feature f{i, j, 0.0, 0.0, normal_at(site, nearest, path.q), nearest.point};
    const double side = side_of(site, nearest, path.q);
    f.gap = side * nearest.distance - site.radius - sample.radius;
    if (sharp_vertex(site, sample, nearest) && path.rate.squaredNorm() > 0.0 && f.gap > -limits_.touch &&
        nearest.distance <= limits_.tolerance && (path.q - nearest.point).dot(path.rate) < 0.0)
      f.normal = -path.rate.normalized();  // two points that meet: the limit of their direction
    f.rate = f.normal.dot(path.rate);
    f.point =
        path.q - f.normal * (f.gap + sample.radius);  // from the sample: a long site's foot has lost digits
    return f;
  }

  static bool sharp_vertex(const Site& site, const Sample& sample, const Nearest& nearest) {
    return (nearest.foot != Foot::interior || site.kind == SiteKind::point) &&
           site.radius + sample.radius == 0.0;
  }

  /// True if site j is near q, but what q would touch is another site. At a joint: one that is as near with
  /// its interior. Behind a solid: j is the far side of a sliver, whose near side q has in front of it, or is
  /// deeper in.
  bool belongs_to_a_neighbour(const Half& half, int j, const Nearest& nearest, const Vec2& q) const {
    const Outline& outline = half.sites_of();
    const Site& site = outline.sites[j];
    if (site.kind == SiteKind::point) return false;
    const double distance = nearest.distance - site.radius;
    const bool at_end = nearest.foot != Foot::interior, behind = side_of(site, nearest, q) < 0.0;
    if (!at_end && !behind) return false;
    const Vec2 normal = normal_at(site, nearest, q);
    for (const SearchScratch::Neighbour& other : scratch_.neighbours) {
      if (other.site == j) continue;
      const Site& other_site = outline.sites[other.site];
      const Nearest n = nearest_on(other_site, q);
      const double further = n.distance - other_site.radius - distance;
      if (further > limits_.touch) continue;
      if (at_end && n.foot == Foot::interior) return true;
      if (behind && other.normal.dot(normal) < 0.0 && (further < 0.0 || side_of(other_site, n, q) > 0.0))
        return true;
    }
    return false;
  }

  bool approaching(const Feature& f, const SamplePath& path) const {
    return f.rate < -(a_.velocity_rounding + b_.velocity_rounding + 16.0 * kEpsilon * path.magnitude);
  }

  /// Where sample i of this half is at time t, in the other outline's frame.
  Vec2 place_of(const Half& half, int i, double t) const {
    Placed s = placed(half.s), u = placed(half.t);
    s.move(half.s->outline(), half.s->motion->state(t));
    u.move(half.t->outline(), half.t->motion->state(t));
    return u.frame.direction_to_local(s.frame.direction_to_world(half.samples_of().samples[i].p) +
                                      (s.frame.origin - u.frame.origin));
  }

  /// What is taken off a gap: two sharp points never overlap, and a thin wire has no inside to tell that it
  /// was met, so there the gap counts from half the touching distance.
  double level_at(const Site& site, double sample_radius, const Nearest& nearest) const {
    const bool sharp = site.radius + sample_radius == 0.0 && (!site.solid || nearest.foot != Foot::interior);
    return sharp ? 0.5 * limits_.touch : 0.0;
  }

  /// A vertex sample's signed gap to the neighbours together, and which of them it is nearest to: it does not
  /// matter from which of them, or when, one began to look. Those that it touches and leaves are left out.
  struct OutlineGap {
    double gap = kForever;
    int site = -1;
  };
  OutlineGap gap_to_neighbours(const Half& half, int i, const Vec2& q) const {
    const double sample_radius = half.samples_of().samples[i].radius;
    OutlineGap found;
    double least = kForever;
    for (const SearchScratch::Neighbour& neighbour : scratch_.neighbours) {
      if (neighbour.leaving) continue;
      const Site& site = half.sites_of().sites[neighbour.site];
      const Nearest n = nearest_on(site, q);
      const bool interior = n.foot == Foot::interior && site.kind != SiteKind::point;
      // an interior foot comes before an end that is as near
      const double rank = n.distance - site.radius - (interior ? limits_.touch : 0.0);
      if (!(rank < least)) continue;
      least = rank;
      const double radius = site.radius + sample_radius;
      const bool thin = radius == 0.0 && !site.solid && interior;  // then stay on the side it came from
      const double side = !thin ? side_of(site, n, q) : neighbour.normal.dot(q - n.point) < 0.0 ? -1.0 : 1.0;
      found = {side * n.distance - radius - level_at(site, sample_radius, n), neighbour.site};
    }
    return found;
  }

  double arc_gap(const Half& half, const Feature& f, const Vec2& c) const {
    const Site& arc = half.samples_of().sites[half.samples_of().samples[f.sample].arc_site];
    const Site& site = half.sites_of().sites[f.site];
    const double reach = arc.arc_radius + arc.radius + site.radius;
    if (site.kind == SiteKind::segment) {
      const Vec2 d = site.b - site.a;
      const double offset = cross(d, c - site.a) / d.norm();
      return (perp(d).dot(f.normal) > 0.0 ? offset : -offset) - reach;
    }
    const double distance = (c - site.center).norm();
    const bool hollow = f.normal.dot(c - site.center) < 0.0;
    return hollow ? site.arc_radius - distance - reach : distance - site.arc_radius - reach;
  }

  /// Bound on the rounding of the places of a mover's points [m].
  static double place_rounding(const Mover& m, const Placed& placed) {
    double reach = placed.frame.origin.lpNorm<1>();
    if (m.motion->is_ballistic()) reach += m.motion->start().pose.position.lpNorm<1>();
    return 32.0 * kEpsilon * (reach + m.outline().bounding_radius * (1.0 + 0.125 * std::abs(placed.angle)));
  }

  /// The feature pair is within tolerance: if it approaches, finds the last double at which it is still
  /// apart. True if a contact was found; false if it recedes, or passes by.
  bool polish(const Half& half, const Feature& f, const SamplePath& path, const PathBounds& bounds) {
    if (!approaching(f, path)) {
      if (f.gap < -limits_.tolerance && t_ == from_ && f.rate > 0.0) ++work_.let_go;
      return false;
    }
    if (t_ <= from_ && f.gap <= 0.0) return remember(half, f, t_);
    const Sample& sample = half.samples_of().samples[f.sample];
    const Site& site = half.sites_of().sites[f.site];
    const bool vertex = sample.arc_site < 0;
    const auto gap = [&](double t) {
      const Vec2 q = place_of(half, f.sample, t);
      return vertex ? gap_to_neighbours(half, f.sample, q).gap : arc_gap(half, f, q);
    };
    const double speed = -f.rate;
    const double now = f.gap - (vertex ? level_at(site, sample.radius, nearest_on(site, path.q)) : 0.0);
    const double guess = t_ + now / speed;
    const double rounding =
        (place_rounding(a_, placed_a_) + place_rounding(b_, placed_b_)) / speed + 4.0 * ulp(t_);
    const double bend = std::min(1.0, bounds.acceleration * f.gap / (speed * speed)) * f.gap / speed;
    const double noise = rounding + bend;
    const double last = std::min(a_.motion->end(), b_.motion->end());
    // the narrowest bracket whose ends are beyond rounding, and beyond what the path bends on the way
    double low = guess - (0.125 * rounding + bend), high = guess + (0.125 * rounding + bend);
    if (!(low > from_ && high <= last && gap(low) > 0.0 && gap(high) <= 0.0)) {
      low = std::max(guess - 8.0 * noise, from_);
      for (double back = 8.0 * noise; gap(low) <= 0.0; back *= 4.0) {
        if (low <= from_) return remember(half, f, t_);  // in each other from the start, and now going deeper
        low = std::max(low - back, from_);
      }
      // beyond the surface; or, where two points meet, when they are nearest; or where a bent path meets it
      // later
      const double nearest = t_ + f.gap / speed, later = t_ + 4.0 * std::max(0.0, now) / speed + 64.0 * noise;
      for (const double beyond : {guess + 8.0 * noise, nearest, later}) {
        high = std::min(beyond, last);
        if (high > low && gap(high) <= 0.0) break;
      }
      if (high <= low || gap(high) > 0.0)  // passes by, or touches within rounding
        return f.gap <= limits_.touch && remember(half, f, t_);
    }
    const double t = last_clear_time(gap, low, high);
    Feature met = f;
    if (vertex) met.site = gap_to_neighbours(half, f.sample, place_of(half, f.sample, t)).site;
    return remember(half, met, t, 8.0 * noise);
  }

  /// Keeps the contact if it is the earliest so far (ties: lowest half, sample, site). Always true. The
  /// search goes on for `noise` longer: another feature may seem to touch later only by the rounding of its
  /// steps.
  bool remember(const Half& half, const Feature& f, double t, double noise = 0.0) {
    if (t > window_end_) return true;
    const bool earlier = best_.sample < 0 || t < best_.time ||
                         (t == best_.time && std::tie(half.s_is_a, best_.sample, best_.site) >
                                                 std::tie(best_.sample_on_a, f.sample, f.site));
    if (!earlier) return true;
    if (t == t_) {
      best_ = contact_of(half, f, t);
    } else {  // the contact's geometry is that of its own time
      PairSearch there(a_, b_, *this, t);
      best_ = there.contact_again(half, f, t);
    }
    to_ = std::min(to_, std::nextafter(t + noise, kForever));
    return true;
  }

  /// A view of the same pair at another time, for evaluating one feature there; shares scratch, searches
  /// nothing.
  PairSearch(const Mover& a, const Mover& b, const PairSearch& like, double t)
      : a_(a),
        b_(b),
        from_(t),
        to_(t),
        window_end_(t),
        limits_(like.limits_),
        scratch_(like.scratch_),
        work_(like.work_) {
    halves_[0] = like.halves_[0];
    halves_[1] = like.halves_[1];
    place(t);
  }

  FeatureContact contact_again(const Half& half, const Feature& f, double t) {
    const Sample& sample = half.samples_of().samples[f.sample];
    const SamplePath path = sample_path(placed(half.s), placed(half.t), sample.p);
    const Site& site = half.sites_of().sites[f.site];
    if (sample.arc_site < 0)
      return contact_of(half, vertex_feature(half, f.sample, f.site, nearest_on(site, path.q), path), t);
    const ArcStep step = arc_step(half.samples_of().sites[sample.arc_site], site, path, placed(half.s),
                                  placed(half.t), 0.0, limits_.tolerance, {}, {0.0, 0.0});
    return contact_of(half, {f.sample, f.site, step.gap, step.rate, step.normal, step.point}, t);
  }

  FeatureContact contact_of(const Half& half, const Feature& f, double t) const {
    const Placed& site_owner = placed(half.t);
    FeatureContact c;
    c.time = t;
    c.sample_on_a = half.s_is_a;
    c.sample = f.sample;
    c.site = f.site;
    c.point = site_owner.frame.to_world(f.point);
    const Vec2 out = site_owner.frame.direction_to_world(f.normal);
    c.normal = half.s_is_a ? out : Vec2(-out);
    c.closing_speed = -f.rate;
    c.gap = f.gap;
    return c;
  }

  /// Calls visit for sample i's nearest feature, and every further one within `tolerance`.
  template <class Visit>
  void features_of(const Half& half, int i, double tolerance, Visit&& visit) {
    const Sample& sample = half.samples_of().samples[i];
    const SamplePath path = sample_path(placed(half.s), placed(half.t), sample.p);
    const Outline& sites = half.sites_of();
    if (sample.arc_site >= 0) {
      const Site& arc = half.samples_of().sites[sample.arc_site];
      for (std::size_t j = 0; j < sites.sites.size(); ++j) {
        const ArcStep step = arc_step(arc, sites.sites[j], path, placed(half.s), placed(half.t), 0.0,
                                      limits_.tolerance, {}, {0.0, 0.0});
        if (step.active && step.gap <= tolerance)
          visit({i, static_cast<int>(j), step.gap, step.rate, step.normal, step.point});
      }
      return;
    }
    const FieldAnswer nearest = half.t->index->query(path.q, scratch_.index);
    if (nearest.site >= 0 && nearest.gap - sample.radius <= tolerance) {
      const Site& site = sites.sites[nearest.site];
      visit(vertex_feature(half, i, nearest.site, nearest_on(site, path.q), path));
    }
  }

  const Mover &a_, &b_;
  double from_, to_;
  double window_end_;  ///< to_ as it was given
  const SearchLimits& limits_;
  SearchScratch& scratch_;
  WorkCounters& work_;
  Half halves_[2];
  RelativeBounds long_bounds_, short_bounds_;
  double short_window_ = 0.0, short_end_ = 0.0;
  double t_ = 0.0, reached_ = 0.0;
  double least_ = kForever;  ///< of the samples looked at from t_, how long all are safe
  Placed placed_a_, placed_b_;
  FeatureContact best_;
  bool capped_ = false;
};

}  // namespace

PairAnswer first_contact(const Mover& a, const Mover& b, double from, double to, const SearchLimits& limits,
                         SearchScratch& scratch, WorkCounters& work) {
  ++work.pair_searches;
  if (limits.closed_forms) {
    PairAnswer answer;
    if (first_contact_in_closed_form(a, b, from, to, limits, answer)) {
      ++work.closed_forms;
      // seen through the same eyes as the general search's; two discs' is already
      const bool discs = a.outline().is_point() && b.outline().is_point();
      if (answer.status == PairAnswer::Status::contact && !discs) {
        const double t = answer.contact.time;
        answer.contact = contact_in(a, b, a.motion->state(t), b.motion->state(t), answer.contact, scratch);
      }
      return answer;
    }
  }
  return PairSearch(a, b, from, to, limits, scratch, work).run();
}

std::vector<FeatureContact> touching_features(const Mover& a, const Mover& b, double t, double tolerance,
                                              SearchScratch& scratch) {
  std::vector<FeatureContact> found;
  WorkCounters uncounted;
  const SearchLimits limits;
  PairSearch(a, b, t, t, limits, scratch, uncounted).collect(t, tolerance, found);
  std::stable_sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.gap < y.gap; });
  return found;
}

FeatureContact contact_in(const Mover& a, const Mover& b, const BodyState& state_a, const BodyState& state_b,
                          const FeatureContact& like, SearchScratch& scratch) {
  WorkCounters uncounted;
  const SearchLimits limits;
  return PairSearch(a, b, like.time, like.time, limits, scratch, uncounted).in_states(state_a, state_b, like);
}

double pair_gap(const Mover& a, const Mover& b, double t, SearchScratch& scratch) {
  WorkCounters uncounted;
  const SearchLimits limits;
  return PairSearch(a, b, t, t, limits, scratch, uncounted).gap(t);
}

}  // namespace brink
