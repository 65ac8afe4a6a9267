#include "brink/scheduler/first_contact/first_contact.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "brink/core/base/limits.h"
#include "brink/scheduler/first_contact/apart.h"
#include "brink/scheduler/first_contact/closed_forms.h"
#include "brink/scheduler/first_contact/common_piece.h"
#include "brink/scheduler/first_contact/feature_crossing.h"
#include "brink/scheduler/first_contact/pair_view.h"
#include "brink/scheduler/first_contact/site_step.h"

namespace brink {

namespace {

using detail::BothWays;
using detail::Feature;
using detail::FeatureCrossing;
using detail::Half;
using detail::PairView;
using detail::SearchWindow;

/// Iterations that a search may take if it has found a contact, whatever its cap.
constexpr int kMostAfterContact = 1000;

/// Where two outlines turn by each other so many times as fast as their origins move, it is worth a look at what they
/// cannot meet however they turn.
constexpr double kMuchFaster = 16.0;
/// Who comes nearer by no more than so many touching distances in a piece of dense output may come and go with its errors.
constexpr double kComesAndGoes = 1024.0;

/// True if no point of the pair has moved against the other by more than the touching distance since the motions
/// began. Then all is looked at from there: features that are so near are told apart by how they began.
/// @pre the beginning is remembered at t.
bool has_hardly_moved(const Mover& a, const Mover& b, double start, double t, const SearchLimits& limits) {
  const Twist &of_a = a.motion->start().twist, &of_b = b.motion->start().twist;
  const double reach_a = a.outline().bounding_radius, reach_b = b.outline().bounding_radius;
  const double at_first = (of_a.velocity - of_b.velocity).norm() + std::abs(of_a.omega) * reach_a +
                          std::abs(of_b.omega) * reach_b;
  const auto is_little = [&](double speed) { return (t - start) * speed <= limits.touch; };
  if (!(t > start && is_little(at_first))) return false;  // a first look
  // the first look took the speeds of the beginning; what counts is the fastest on the way
  const RelativeBounds since = RelativeBounds::over(a.outline(), *a.motion, b.outline(), *b.motion, start, t);
  return is_little(since.speed + since.spin_s * reach_a + since.spin_t * reach_b);
}

/// One search. As it goes on: up to the least safe time every contact is found, but for those that
/// look_back() tells; and while samples are looked at, the pair is placed at t_.
class PairSearch {
 public:
  /// From `from` on; what lies before `asked_from` is looked at for the sake of the answer's bits alone. `remembers_start`: the
  /// beginning of the two motions can be asked for, and has a part in the answer.
  PairSearch(const Mover& a, const Mover& b, double from, double asked_from, double to, bool remembers_start,
             const SearchLimits& limits, SearchScratch& scratch, WorkCounters& work)
      : view_(a, b, limits, scratch),
        a_(a),
        b_(b),
        window_{.from = from, .to = to, .asked_from = asked_from, .asked_to = to, .bounds = {}},
        crossing_(a, b, remembers_start, view_, window_, limits, scratch, work),
        remembers_start_(remembers_start),
        limits_(limits),
        scratch_(scratch),
        work_(work) {
    begin_anew();
  }

  /// Clear, the earliest contact, or undecided from where the search stopped.
  PairAnswer run() {
    advance();
    // what stopped before the contact that it had found may have passed an earlier one
    const FeatureContact& earliest = crossing_.earliest();
    if (capped_ && !(crossing_.has_found() && reached_ >= earliest.time))
      return {PairAnswer::Status::undecided, reached_, {}};
    if (crossing_.has_found()) return told(earliest);
    return {PairAnswer::Status::clear, window_.to, {}};
  }

 private:
  /// The contact, or why it cannot be told.
  PairAnswer told(const FeatureContact& c) {
    if (view_.beyond_doubt()) return {PairAnswer::Status::contact, c.time, c};
    view_.place(c.time);
    Feature f;
    f.sample = c.sample;
    f.site = c.site;
    const PairView::Doubt doubt = view_.doubt(view_.half(c.sample_on_a), f);
    if (doubt == PairView::Doubt::none) return {PairAnswer::Status::contact, c.time, c};
    return {PairAnswer::Status::undecided,
            c.time,
            {},
            doubt == PairView::Doubt::place ? PairAnswer::Why::place : PairAnswer::Why::speed};
  }

  /// Until when sample i of a half is sure not to touch.
  double& safe_until(const Half& half, int i) { return safe_until_[half.s_is_a ? 0 : 1][i]; }

  /// From one least safe time to the next, until that is the end. Sets capped_ where it stops before.
  void advance() {
    begin_window();
    for (int iterations = 0;;) {
      const double t = least_safe_time();
      if (t >= window_.to) {
        look_back(window_.to);
        if (!goes_back_from(window_.to) && !leave_part()) return;
        continue;
      }
      reached_ = std::max(t, window_.asked_from);
      // Steps before the time that was asked from are not counted. A search that began earlier for the sake
      // of its bits would with a cap of a few steps never come as far as that time, and so never on.
      // with a contact in hand little is left to look at; in a part one that is found later may be earlier
      if (t >= window_.asked_from && ++iterations > most_iterations(t) && !window_.in_part &&
          (!crossing_.has_found() || iterations > kMostAfterContact)) {
        look_back(t);
        capped_ = !goes_back_from(t);
        if (capped_) return;
        continue;
      }
      ++work_.search_iterations;
      t_ = t;
      next_ = next_after(t);
      view_.place(t);
      short_end_ = std::min(window_.to, t + short_window_);
      // at first both windows are one
      short_bounds_ = t == window_.from && short_end_ == window_.to ? window_.bounds
                                                                    : BothWays(bounds_over(t, short_end_));
      // Who is due soon is looked at now: the outlines are placed once for all of these.
      // What is looked at early loses no more of its step than this quarter of the short window.
      const double due = t + 0.25 * std::min(short_window_, window_.to - t);
      least_ = kForever;
      // the nearest ones first: beside their steps most others are seen to be far at a glance
      const Half &of_a = view_.half(true), &of_b = view_.half(false);
      const int first_a = nearest_due(of_a, due), first_b = nearest_due(of_b, due);
      if (first_a >= 0) advance_sample(of_a, first_a);
      if (first_b >= 0) advance_sample(of_b, first_b);
      advance_due(of_a, due, first_a);
      advance_due(of_b, due, first_b);
      if (comes_and_goes_) {
        enter_part(t);
        continue;
      }
      // A step by the short bounds is no longer than their window: fourfold lets steps grow where there
      // is room, and bounds stay tight where there is none.
      short_window_ = std::max(4.0 * (least_ - t), 64.0 * ulp(t));
    }
  }

  /// No sample has been looked at.
  void begin_anew() {
    scratch_.sinking.clear();
    scratch_.safe_until.clear();
    for (const bool on_a : {true, false}) {
      const Half& half = view_.half(on_a);
      // The vertex of a notch is never due: what comes from outside meets one of its sides before.
      for (int i = 0; i < half.count; ++i)
        scratch_.safe_until.push_back(half.sample(i).hollow ? kForever : window_.from);
    }
    safe_until_[0] = scratch_.safe_until.data();
    safe_until_[1] = safe_until_[0] + view_.half(true).count;
  }

  /// Bounds over all that is left. A contact that is found brings window_.to nearer; they hold for that, too.
  void begin_window() {
    window_.bounds = BothWays(bounds_over(window_.from, window_.to));
    short_window_ = window_.to - window_.from;
    reached_ = std::max(window_.from, window_.asked_from);
  }

  /// The errors of dense output alone decide when and whether those meet who go side by side: each of its wiggles may be a
  /// crossing, and which of them a search comes upon depends on its steps. So a part of that piece is searched from its
  /// beginning to its end, whatever was asked for: all searches take the same steps there.
  void enter_part(double t) {
    const auto [begin, end] = detail::part_of_piece(*a_.motion, *b_.motion, t);
    comes_and_goes_ = false;
    window_.in_part = true;
    if (crossing_.earliest().time >= begin) crossing_.forget();
    window_.from = begin;
    window_.to = window_.part_end = end;
    begin_anew();
    begin_window();
  }

  /// If one that comes and goes was seen as a search is to end at t: enters the part in the middle of which that is, and is true.
  bool goes_back_from(double t) {
    const bool back = comes_and_goes_ && detail::part_of_piece(*a_.motion, *b_.motion, t).begin < t;
    comes_and_goes_ = false;
    if (back) enter_part(t);
    return back;
  }

  /// From its end on as before. False if there is nothing left to search.
  bool leave_part() {
    if (!window_.in_part) return false;
    if (crossing_.earliest().time > window_.asked_to) crossing_.forget();
    if (crossing_.has_found()) return false;
    window_.in_part = false;
    window_.from = window_.to;
    window_.to = window_.asked_to;
    if (window_.from >= window_.to) return false;
    begin_anew();
    begin_window();
    return true;
  }

  /// Notes it if a feature that is close comes nearer so slowly that errors may do it. True if so: the step is of no use.
  bool comes_and_goes(double rate) {
    if (window_.in_part || comes_and_goes_ || !(a_.motion->track() || b_.motion->track()))
      return comes_and_goes_;
    const auto [begin, end] = detail::common_piece(*a_.motion, *b_.motion, t_);
    comes_and_goes_ = std::abs(rate) * (end - begin) <= kComesAndGoes * limits_.touch;
    return comes_and_goes_;
  }

  /// How many steps have led to time t at most.
  int most_iterations(double t) const {
    const bool needed = t < limits_.needed_until;
    return needed ? std::max(limits_.min_iterations, limits_.max_iterations) : limits_.max_iterations;
  }

  /// Steps of samples on a surface lead a little beyond where they meet: what was met by t on the way is found now, so
  /// that it does not depend on where the search ends.
  void look_back(double t) {
    if (scratch_.sinking.empty()) return;
    t_ = t;
    view_.place(t);
    // Windows of no length: the steps are not used, only what is met while they are looked for.
    const BothWays now(bounds_over(t, t));
    for (const auto& [on_a, i] : scratch_.sinking) {
      // the contact's own sample has been followed to its contact already
      if (i == crossing_.earliest().sample && on_a == crossing_.earliest().sample_on_a) continue;
      const Half& half = view_.half(on_a);
      const SamplePath path = view_.path(half, i);
      const double band = view_.touching_band(half, i, path);
      const PathBounds bounds = path_bounds(path, now.of(half), 0.0);
      if (half.sample(i).arc_site >= 0)
        arc_sample_step(half, i, path, band, now.of(half), bounds, 0.0);
      else
        vertex_steps(half, i, path, band, bounds, bounds, 0.0, 0.0);
    }
  }

  /// Features have come close: from now on levels count.
  void look_closely() {
    // Before neighbours are looked for: it uses the same memory of the scratch.
    if (!sink_known_ && remembers_start_) view_.set_sink(view_.sink_at_start());
    sink_known_ = true;
  }

  /// Of the samples due, the one nearest to the other outline's origin; -1 if none is.
  int nearest_due(const Half& half, double due) {
    const Vec2 origin = view_.placed(half.s).frame.to_local(view_.placed(half.t).frame.origin);
    int nearest = -1;
    double least = kForever;
    for (int i = 0; i < half.count; ++i) {
      if (safe_until(half, i) > due) continue;
      const double distance2 = (half.sample(i).p - origin).squaredNorm();
      if (nearest >= 0 && distance2 >= least) continue;
      least = distance2;
      nearest = i;
    }
    return nearest;
  }

  /// All samples of a half that are due, but for the one that was taken first.
  void advance_due(const Half& half, double due, int done) {
    for (int i = 0; i < half.count; ++i)
      if (i != done && safe_until(half, i) <= due) advance_sample(half, i);
  }

  /// Looks at one sample at t_ and sets until when it is safe. It is on the list of look_back() as long as
  /// the last step may lead below its level.
  void advance_sample(const Half& half, int i) {
    sinks_ = false;
    // never less than the next double, or the search would stand still
    safe_until(half, i) = std::max(t_ + step(half, i), next_);
    least_ = std::min(least_, safe_until(half, i));
    std::vector<std::pair<bool, int>>& sinking = scratch_.sinking;
    if (!sinks_ && sinking.empty()) return;
    std::erase(sinking, std::pair(half.s_is_a, i));
    if (sinks_) sinking.emplace_back(half.s_is_a, i);
  }

  /// How fast, and how bent, a can move against b during [from, to].
  RelativeBounds bounds_over(double from, double to) const {
    return RelativeBounds::over(a_.outline(), *a_.motion, b_.outline(), *b_.motion, from, to);
  }

  /// Over the samples of both halves, which lie side by side in the scratch [s]. Four at a time: else each minimum waits for
  /// the one before.
  double least_safe_time() const {
    const std::vector<double>& until = scratch_.safe_until;
    double least[] = {kForever, kForever, kForever, kForever};
    std::size_t i = 0;
    for (; i + 4 <= until.size(); i += 4)
      for (std::size_t k = 0; k < 4; ++k) least[k] = std::min(least[k], until[i + k]);
    for (; i < until.size(); ++i) least[0] = std::min(least[0], until[i]);
    return std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
  }

  /// Safe time step of one sample from t_ [s]; records a contact if it finds one (and is then safe up to it).
  double step(const Half& half, int i) {
    const Sample& sample = half.sample(i);
    const SamplePath path = view_.path(half, i);
    const double long_window = window_.to - t_, short_window = short_end_ - t_;
    const RelativeBounds &relative = window_.bounds.of(half), &near = short_bounds_.of(half);
    const PathBounds over_all = path_bounds(path, relative, long_window);
    const double band = view_.touching_band(half, i, path);
    const Facing line = line_between(half, i, path, band);
    double apart = line.gap > 0.0 ? safe_step(line.gap, line.rate, over_all.acceleration)
                                  : clear_of_disc(half, i, path, band, over_all);
    if (over_all.speed > kMuchFaster * relative.speed)
      apart = std::max(apart, clear_however_turned(half, i, path, band, relative.speed));
    // Clear to the end; or so long that the pair will be placed again, for nearer samples, long before:
    // a coarse bound is enough.
    if (apart >= long_window || apart > 2.0 * (least_ - t_)) return apart * (1.0 - 4.0 * kEpsilon);
    const PathBounds over_short = path_bounds(path, near, short_window);
    // Three kinds of sample from here on: one that a line parts from a convex outline, which stands for all
    // of its sites; a vertex, whose candidate sites are looked at; an arc, which is held against every site.
    double safe = apart, again = 0.0;
    if (line.gap > 0.0) {
      if (safe < short_window) again = safe_step(line.gap, line.rate, over_short.acceleration);
    } else if (sample.arc_site < 0) {
      std::tie(safe, again) =
          vertex_steps(half, i, path, band, over_all, over_short, long_window, short_window);
    } else {
      safe = arc_sample_step(half, i, path, band, relative, over_all, long_window);
      if (safe < short_window) again = arc_sample_step(half, i, path, band, near, over_short, short_window);
    }
    safe = std::max(safe, apart);
    // The short bounds say nothing of what lies beyond their window.
    if (safe < short_window) safe = std::max(safe, std::min(again, short_window));
    return safe * (1.0 - 4.0 * kEpsilon);
  }

  /// How long a sample is sure to stay out of the disc that holds the other outline; 0 if it is in it. As
  /// other steps, this one does not lead onto the surface.
  double clear_of_disc(const Half& half, int i, const SamplePath& path, double band,
                       const PathBounds& bounds) const {
    const Outline& outline = half.sites_of();
    const double f = path.distance - outline.bounding_radius - half.sample(i).radius - band;
    if (outline.container || outline.is_point() || !(f > 0.0)) return 0.0;
    return safe_step(f, path.q.dot(path.rate) / path.distance, bounds.inertial_acceleration);
  }

  /// How long a sample is sure not to meet the other outline however fast the two turn: it stays between two circles about
  /// its owner's origin (a vertex on one), and the other between two about its own. 0 if that says nothing.
  double clear_however_turned(const Half& half, int i, const SamplePath& path, double band, double speed) {
    const Outline& outline = half.sites_of();
    const Sample& sample = half.sample(i);
    const double circle = sample.arc_site >= 0 ? half.samples_of().sites[sample.arc_site].arc_radius : 0.0;
    const double thickness = sample.radius - circle;
    const double inner = std::abs(path.arm - circle), outer = path.arm + circle;
    const double apart = (view_.placed(half.s).frame.origin - view_.placed(half.t).frame.origin).norm();
    const double within = free_radius(half) - apart - outer;  // it is in what the other leaves free
    const double around = std::max(apart - outer, inner - apart) - outline.bounding_radius;
    const double gap = (outline.container ? within : std::max(within, around)) - thickness - band;
    return gap > 0.0 ? gap / speed : 0.0;
  }

  /// Of the disc about the other outline's origin into which nothing of it leads [m].
  double free_radius(const Half& half) {
    double& radius = free_radius_[half.s_is_a ? 0 : 1];
    if (radius >= 0.0) return radius;
    radius = kForever;
    for (const Site& site : half.sites_of().sites)
      radius = std::min(radius, nearest_on(site, Vec2::Zero()).distance - site.radius);
    return radius = std::max(radius * (1.0 - 4.0 * kEpsilon), 0.0);
  }

  /// The line between a vertex sample and a convex outline, as far out as a step may lead; gap 0 where there
  /// is none, or the sample is so near that its features must be told apart.
  Facing line_between(const Half& half, int i, const SamplePath& path, double band) {
    const Outline& outline = half.sites_of();
    const Sample& sample = half.sample(i);
    if (outline.facets.empty() || sample.arc_site >= 0) return {};
    ++work_.distance_queries;
    ++work_.candidate_evaluations;
    Facing line = facing_convex(outline, path.q, path.rate);
    line.gap -= outline.sites[0].radius + sample.radius;
    line.gap = line.gap > 2.0 * band ? line.gap - 0.5 * band : 0.0;
    return line;
  }

  /// Safe steps by the bounds over the whole window and by those over the short one; every site is looked at
  /// once.
  std::pair<double, double> vertex_steps(const Half& half, int i, const SamplePath& path, double band,
                                         const PathBounds& over_all, const PathBounds& over_short,
                                         double window, double short_window) {
    const Sample& sample = half.sample(i);
    const Outline& sites = half.sites_of();
    ++work_.distance_queries;
    // nothing farther can be met before the end, wherever the sample goes
    const double reach = over_all.speed * window + sample.radius + 2.0 * band;
    Candidates near = half.t->index->candidates(path.q, reach, scratch_.index);
    // what is not named is too near to be left out: two things are met, and one of them alone is named
    if (near.others_at_least - sample.radius <= 2.0 * band) near = all_of(sites);
    work_.candidate_evaluations += near.sites.size();
    // Sites that are not named are at least so far away; as any step, one towards them ends half a band
    // before.
    const double others = std::max(0.0, near.others_at_least - sample.radius - 0.5 * band);
    double safe = over_all.speed > 0.0 ? others / over_all.speed : kForever;
    double again = over_short.speed > 0.0 ? others / over_short.speed : kForever;
    bool neighbours_known = false;
    for (const std::uint32_t j : near.sites) {
      const Site& site = sites.sites[j];
      if (view_.is_covered_at(site, path.q)) continue;
      const Nearest nearest = nearest_on(site, path.q);
      const double radius = site.radius + sample.radius;
      const double gap = nearest.distance - radius;
      if (gap > band && is_deep_behind(site, nearest, path.q, gap) && is_inside(near.sites, sites, path.q))
        band = 2.0 * gap;
      if (gap <= band) {
        look_closely();
        if (!neighbours_known) view_.find_neighbours(half, i, near.sites, path, 4.0 * band);
        neighbours_known = true;
        const Feature f = view_.vertex_feature(half, i, static_cast<int>(j), nearest, path);
        if (comes_and_goes(f.rate)) return {0.0, 0.0};
        const bool hidden = view_.belongs_to_a_neighbour(half, i, static_cast<int>(j), nearest, path.q);
        // A contact asks for no step: the search ends there, or at an earlier one.
        if (!hidden && crossing_.meets(half, f, path, over_all)) continue;
        // behind what does not count it may go a part of its way there: what counts has a step of its own
        const double free_way = hidden && f.gap < 0.0 ? 0.25 * nearest.distance : 0.0;
        const double above = f.gap - view_.level(half, i, site, path.q);
        const auto step_by = [&](const RelativeBounds& relative, const PathBounds& bounds, double over) {
          const double step = close_step(half, site, nearest, f, above, path, band, relative, bounds, over);
          return free_way > 0.0 ? std::max(step, free_way / bounds.speed) : step;
        };
        safe = std::min(safe, step_by(window_.bounds.of(half), over_all, window));
        again = std::min(again, step_by(short_bounds_.of(half), over_short, short_window));
        continue;
      }
      const double beyond = gap - 0.5 * band;  // too far to matter at any speed?
      if (beyond > band && beyond >= safe * over_all.speed &&
          beyond >= std::min(again, short_window) * over_short.speed)
        continue;
      // From outside a step leads to the middle of the band.
      const double slack = -0.5 * band;
      const double rate = distance_rate(site, nearest, path.q, path.rate);
      safe = std::min(safe, site_step(site, nearest, path.q, path.rate, rate, radius, slack, over_all).safe);
      again =
          std::min(again, site_step(site, nearest, path.q, path.rate, rate, radius, slack, over_short).safe);
    }
    return {safe, again};
  }

  /// True of a vertex behind a site of a solid, deeper than any contact leads, but no deeper than a start may have it: it is looked
  /// at as what touches, if it is in the solid.
  bool is_deep_behind(const Site& site, const Nearest& nearest, const Vec2& q, double gap) const {
    return site.solid && gap <= kOverlapAtStart * limits_.tolerance && side_of(site, nearest, q) < 0.0;
  }

  /// By the nearest of the sites that are named: what is before that is outside, whatever farther side it is behind.
  static bool is_inside(std::span<const std::uint32_t> named, const Outline& outline, const Vec2& q) {
    double least = kForever;
    bool before = false;
    for (const std::uint32_t k : named) {
      const Nearest nearest = nearest_on(outline.sites[k], q);
      if (nearest.distance > least) continue;
      before = (before && nearest.distance == least) || side_of(outline.sites[k], nearest, q) > 0.0;
      least = nearest.distance;
    }
    return !before;
  }

  /// Every site by name, in the memory of the index: what it named before is gone.
  Candidates all_of(const Outline& outline) {
    std::vector<std::uint32_t>& all = scratch_.index.sites;
    all.resize(outline.sites.size());
    std::iota(all.begin(), all.end(), 0U);
    return {all, kForever};
  }

  /// The step of a vertex that is within the band of a site and does not meet it, `above` its level: by the
  /// signed distance to the site's line or circle where the foot is inside the site, which holds behind its
  /// surface as in front of it; else by the site's distance.
  double close_step(const Half& half, const Site& site, const Nearest& nearest, const Feature& f,
                    double above, const SamplePath& path, double band, const RelativeBounds& relative,
                    const PathBounds& bounds, double window) {
    // A quarter of the least sink step, by which a step may lead below its level: look_back() sees to what
    // was met on the way.
    const double allowed = 0.25 * sink_step(limits_.touch, 0.0);
    if (site.kind == SiteKind::segment || site.kind == SiteKind::point) {
      // A convex distance never lies below its support line at the present foot. So of the path's
      // acceleration only the part along the present normal bends the gap towards zero, though the
      // normal may turn.
      Vec2 normal = f.normal;
      double rate = f.rate;
      const bool to_an_end = site.solid && site.kind == SiteKind::segment && nearest.foot != Foot::interior;
      if (to_an_end && normal.dot(path.q - nearest.point) < 0.0) {
        // Right in a hollow corner of a solid, behind the other side that ends there, the way to the end is not the way out:
        // what comes out may fall on this side, and would cross its line first.
        normal = detail::right_of(direction_at_start(site));
        above += normal.dot(path.q - nearest.point) + nearest.distance;
        rate = normal.dot(path.rate);
      }
      const Vec2 out = view_.placed(half.t).frame.direction_to_world(normal);
      const double bend = acceleration_against(out, relative, bounds, window);
      sinks_ = sinks_ || may_sink(above, rate, bend, band, allowed);
      return band_step(above, rate, bend, band, allowed);
    }
    sinks_ = sinks_ || above <= 2.0 * allowed;
    const Vec2 out = path.q - site.center;
    const bool hollow = f.normal.dot(out) < 0.0;  // f's normal points to the centre
    // the circle on which the sample meets: less than the arc's by the radii
    const double bend = hollow ? bounds.speed * bounds.speed / out.norm() * 1.01 : 0.0;
    if (nearest.foot == Foot::interior)
      return band_step(above, f.rate, bounds.acceleration + bend, band, allowed);
    const HullDistance hull = distance_to_arc_hull(site, nearest, path.q);
    // Beyond the ends of the arc three bounds hold: its hull is convex; nothing comes nearer faster than its
    // speed; and before the arc itself counts the sample has to come to an end or abreast.
    // nearest.distance - above: where the sample meets the core, by both thicknesses and the level.
    const double outside = hull.distance - (nearest.distance - above);
    // what reaches over the chord to an end is in the hull already, however that moves
    const bool by_end = hull.distance == nearest.distance;
    const double by_hull =
        hull.distance > 0.0 && (outside > 0.0 || by_end)
            ? band_step(outside, hull.gradient.dot(path.rate), bounds.acceleration, band, allowed)
            : 0.0;
    const double by_speed = bounds.speed > 0.0 ? 0.5 * std::max(above, allowed) / bounds.speed : kForever;
    const double by_ends =
        step_beyond_ends(site, path.q, path.rate, bounds.acceleration, [&](double distance, double rate) {
          const double off = distance - (nearest.distance - above);
          return off > 2.0 * band ? safe_step(off - 0.5 * band, rate, bounds.acceleration)
                                  : band_step(off, rate, bounds.acceleration, band, allowed);
        });
    // Each of the three is certain by itself.
    return std::max({by_hull, by_speed, by_ends});
  }

  /// The safe step of an arc's sample by one set of bounds [s]: the least over all sites, each of which is
  /// looked at, as an index names the sites near a point, not near a circle. Follows to their contact those
  /// within the band that approach.
  double arc_sample_step(const Half& half, int i, const SamplePath& path, double band,
                         const RelativeBounds& relative, const PathBounds& bounds, double window) {
    const Sample& sample = half.sample(i);
    const Site& arc = half.samples_of().sites[sample.arc_site];
    const Outline& sites = half.sites_of();
    double safe = kForever;
    for (std::size_t j = 0; j < sites.sites.size(); ++j) {
      ++work_.candidate_evaluations;
      const ArcStep step = arc_step(arc, sites.sites[j], path, view_.placed(half.s), view_.placed(half.t),
                                    band, relative, bounds, window);
      if (step.active && step.gap <= band) {
        if (comes_and_goes(step.rate)) return 0.0;
        look_closely();
        const Feature f{i, static_cast<int>(j), step.gap, step.rate, step.normal, step.point};
        if (crossing_.meets(half, f, path, bounds)) continue;
        const double above = step.gap - view_.level(half, i, sites.sites[j], path.q),
                     allowed = 0.25 * sink_step(limits_.touch, 0.0);
        sinks_ = sinks_ || may_sink(above, step.rate, step.curvature, band, allowed);
        safe = std::min(safe, band_step(above, step.rate, step.curvature, band, allowed));
        continue;
      }
      safe = std::min(safe, step.safe);
    }
    return safe;
  }

  PairView view_;
  const Mover &a_, &b_;
  SearchWindow window_;
  FeatureCrossing crossing_;
  bool remembers_start_;
  const SearchLimits& limits_;
  SearchScratch& scratch_;
  WorkCounters& work_;
  double* safe_until_[2];  ///< one a sample of each half
  BothWays short_bounds_;
  double short_window_ = 0.0, short_end_ = 0.0;
  double t_ = 0.0, next_ = 0.0, reached_ = 0.0;
  double free_radius_[2] = {-1.0, -1.0};  ///< free_radius() of each half; below 0: not known yet
  double least_ = kForever;               ///< of the samples looked at from t_, how long all are safe
  bool sink_known_ = false;
  bool sinks_ = false;  ///< the step of the sample that is looked at may lead below a level
  bool capped_ = false;
  bool comes_and_goes_ = false;  ///< something that is close at t_ does
};

/// first_contact() of two of which `start` is remembered all through [from, to], or has no part in the answer.
PairAnswer first_contact_within(const Mover& a, const Mover& b, double from, double to,
                                std::optional<double> start, const SearchLimits& limits,
                                SearchScratch& scratch, WorkCounters& work) {
  const double first = start && has_hardly_moved(a, b, *start, from, limits) ? *start : from;
  const detail::Apart apart = detail::apart_until(a, b, first, to, limits);
  if (apart.until >= to) return {PairAnswer::Status::clear, to, {}};
  if (apart.stopped && apart.until > std::max(from, limits.needed_until))
    return {PairAnswer::Status::undecided, apart.until, {}};
  return PairSearch(a, b, apart.until, from, to, start.has_value(), limits, scratch, work).run();
}

}  // namespace

/// What was pressed at the beginning has met since: of hundreds of an integrator's steps ago nothing is told any more. From when on
/// depends on the two motions alone, not on how much of them has been given up.
PairAnswer first_contact(const Mover& a, const Mover& b, double from, double to, const SearchLimits& limits,
                         SearchScratch& scratch, WorkCounters& work) {
  ++work.pair_searches;
  if (limits.closed_forms) {
    PairAnswer answer;
    if (first_contact_in_closed_form(a, b, from, to, limits, scratch, answer)) {
      ++work.closed_forms;
      // seen through the same eyes as the general search's; two discs' is already
      const bool discs = a.outline().is_point() && b.outline().is_point();
      if (answer.status == PairAnswer::Status::contact && !discs) {
        const double t = answer.contact.time;
        answer.contact = contact_at(a, b, t, answer.contact, limits, scratch);
      }
      return answer;
    }
  }
  const double start = std::max(a.motion->begin(), b.motion->begin());
  const double remembered = std::min(a.motion->remembered_until(start), b.motion->remembered_until(start));
  if (from >= remembered) return first_contact_within(a, b, from, to, {}, limits, scratch, work);
  const PairAnswer answer =
      first_contact_within(a, b, from, std::min(to, remembered), start, limits, scratch, work);
  if (to <= remembered || answer.status != PairAnswer::Status::clear) return answer;
  return first_contact_within(a, b, remembered, to, {}, limits, scratch, work);
}

std::vector<FeatureContact> touching_features(const Mover& a, const Mover& b, double t, double tolerance,
                                              const SearchLimits& limits, SearchScratch& scratch) {
  std::vector<FeatureContact> found;
  PairView view(a, b, limits, scratch);
  view.place(t);
  // Gaps are asked for, levels are counted after: where gaps can be held, a level is half a tolerance at
  // most (can_hold()).
  view.each_feature(tolerance + limits.tolerance, [&](const Half& half, const Feature& f) {
    const FeatureContact c = view.contact_of(half, f, t);
    if (c.gap - c.level <= tolerance) found.push_back(c);
  });
  std::stable_sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.gap < y.gap; });
  return found;
}

FeatureContact contact_at(const Mover& a, const Mover& b, double t, const FeatureContact& like,
                          const SearchLimits& limits, SearchScratch& scratch) {
  PairView view(a, b, limits, scratch);
  view.set_sink(like.sink);
  view.place(t);
  Feature same;
  same.sample = like.sample;
  same.site = like.site;
  FeatureContact c = view.look_again(view.half(like.sample_on_a), same, like.time);
  if (!(c.normal.dot(like.normal) > 1.0 - 1e-6)) c.normal = like.normal;
  return c;
}

double pair_gap(const Mover& a, const Mover& b, double t, const SearchLimits& limits, SearchScratch& scratch,
                double at_most) {
  PairView view(a, b, limits, scratch);
  view.place(t);
  // signed: of each vertex the nearest site, of arcs all that are active
  double least = at_most;
  view.each_feature(at_most, [&](const Half&, const Feature& f) { least = std::min(least, f.gap); });
  return least;
}

double sink_at_start(const Mover& a, const Mover& b, const SearchLimits& limits, SearchScratch& scratch) {
  return PairView(a, b, limits, scratch).sink_at_start();
}

}  // namespace brink
