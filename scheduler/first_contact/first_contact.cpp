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
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/first_contact/closed_forms.h"
#include "brink/scheduler/first_contact/common_piece.h"
#include "brink/scheduler/first_contact/corners.h"
#include "brink/scheduler/first_contact/falling_gap.h"
#include "brink/scheduler/first_contact/pair_view.h"
#include "brink/scheduler/first_contact/site_step.h"

namespace brink {

namespace {

using detail::come_to_overlap;
using detail::Corner;
using detail::corner_at;
using detail::corner_seen;
using detail::FallingGap;
using detail::Feature;
using detail::Half;
using detail::PairView;
using detail::parts_alone;

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

/// Puts the neighbours that were found back when it goes: others may be looked for in between.
class KeptNeighbours {
 public:
  explicit KeptNeighbours(SearchScratch& scratch)
      : scratch_(scratch),
        neighbours_(scratch.neighbours),
        looked_from_(scratch.looked_from),
        flush_on_(scratch.flush_on) {}
  KeptNeighbours(const KeptNeighbours&) = delete;
  KeptNeighbours& operator=(const KeptNeighbours&) = delete;
  ~KeptNeighbours() {
    scratch_.neighbours.swap(neighbours_);
    scratch_.looked_from = looked_from_;
    scratch_.flush_on = flush_on_;
  }

 private:
  SearchScratch& scratch_;
  std::vector<SearchScratch::Neighbour> neighbours_;
  Vec2 looked_from_;
  int flush_on_;
};

/// One search. As it goes on: up to the least safe time every contact is found, but for those that
/// look_back() tells; to_ is the end that was asked for or, once a contact is found, just behind the
/// earliest so far; best_ is that contact; and while samples are looked at, the pair is placed at t_.
class PairSearch {
 public:
  /// From `from` on; what lies before `asked_from` is looked at for the sake of the answer's bits alone. `remembers_start`: the
  /// beginning of the two motions can be asked for, and has a part in the answer.
  PairSearch(const Mover& a, const Mover& b, double from, double asked_from, double to, bool remembers_start,
             const SearchLimits& limits, SearchScratch& scratch, WorkCounters& work)
      : view_(a, b, limits, scratch),
        a_(a),
        b_(b),
        from_(from),
        to_(to),
        asked_from_(asked_from),
        window_end_(to),
        remembers_start_(remembers_start),
        earliest_(remembers_start ? view_.start()
                                  : std::max({view_.start(), a.motion->remembered_from(asked_from),
                                              b.motion->remembered_from(asked_from)})),
        limits_(limits),
        scratch_(scratch),
        work_(work) {
    begin_anew();
  }

  /// Clear, the earliest contact, or undecided from where the search stopped.
  PairAnswer run() {
    advance();
    // what stopped before the contact that it had found may have passed an earlier one
    if (capped_ && !(best_.sample >= 0 && reached_ >= best_.time))
      return {PairAnswer::Status::undecided, reached_, {}};
    if (best_.sample >= 0) return told(best_);
    return {PairAnswer::Status::clear, to_, {}};
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
      if (t >= to_) {
        look_back(to_);
        if (!goes_back_from(to_) && !leave_part()) return;
        continue;
      }
      reached_ = std::max(t, asked_from_);
      // Steps before the time that was asked from are not counted. A search that began earlier for the sake
      // of its bits would with a cap of a few steps never come as far as that time, and so never on.
      // with a contact in hand little is left to look at; in a part one that is found later may be earlier
      if (t >= asked_from_ && ++iterations > most_iterations(t) && !in_part_ &&
          (best_.sample < 0 || iterations > kMostAfterContact)) {
        look_back(t);
        capped_ = !goes_back_from(t);
        if (capped_) return;
        continue;
      }
      ++work_.search_iterations;
      t_ = t;
      next_ = next_after(t);
      view_.place(t);
      short_end_ = std::min(to_, t + short_window_);
      // at first both windows are one
      short_bounds_ = t == from_ && short_end_ == to_ ? long_bounds_ : BothWays(bounds_over(t, short_end_));
      // Who is due soon is looked at now: the outlines are placed once for all of these.
      // What is looked at early loses no more of its step than this quarter of the short window.
      const double due = t + 0.25 * std::min(short_window_, to_ - t);
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
        scratch_.safe_until.push_back(half.sample(i).hollow ? kForever : from_);
    }
    safe_until_[0] = scratch_.safe_until.data();
    safe_until_[1] = safe_until_[0] + view_.half(true).count;
  }

  /// Bounds over all that is left. A contact that is found brings to_ nearer; they hold for that, too.
  void begin_window() {
    long_bounds_ = BothWays(bounds_over(from_, to_));
    short_window_ = to_ - from_;
    reached_ = std::max(from_, asked_from_);
  }

  /// The errors of dense output alone decide when and whether those meet who go side by side: each of its wiggles may be a
  /// crossing, and which of them a search comes upon depends on its steps. So a part of that piece is searched from its
  /// beginning to its end, whatever was asked for: all searches take the same steps there.
  void enter_part(double t) {
    const auto [begin, end] = detail::part_of_piece(*a_.motion, *b_.motion, t);
    comes_and_goes_ = false;
    in_part_ = true;
    if (best_.time >= begin) best_ = {};
    from_ = begin;
    to_ = part_end_ = end;
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
    if (!in_part_) return false;
    if (best_.time > window_end_) best_ = {};
    if (best_.sample >= 0) return false;
    in_part_ = false;
    from_ = to_;
    to_ = window_end_;
    if (from_ >= to_) return false;
    begin_anew();
    begin_window();
    return true;
  }

  /// Nothing before it counts ...
  double soonest() const { return in_part_ ? from_ : asked_from_; }
  /// ... and nothing after it.
  double window_end() const { return in_part_ ? part_end_ : window_end_; }
  /// No probe may lie beyond it.
  double motions_end() const { return in_part_ ? part_end_ : std::min(a_.motion->end(), b_.motion->end()); }

  /// Notes it if a feature that is close comes nearer so slowly that errors may do it. True if so: the step is of no use.
  bool comes_and_goes(double rate) {
    if (in_part_ || comes_and_goes_ || !(a_.motion->track() || b_.motion->track())) return comes_and_goes_;
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
      if (i == best_.sample && on_a == best_.sample_on_a) continue;
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

  /// How a moves against b, and b against a.
  struct BothWays {
    RelativeBounds of_a, of_b;

    BothWays() = default;
    explicit BothWays(const RelativeBounds& a_against_b) : of_a(a_against_b), of_b(a_against_b.swapped()) {}
    const RelativeBounds& of(const Half& half) const { return half.s_is_a ? of_a : of_b; }
  };

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
    const double long_window = to_ - t_, short_window = short_end_ - t_;
    const RelativeBounds &relative = long_bounds_.of(half), &near = short_bounds_.of(half);
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
        if (!hidden && polish(half, f, path, over_all)) continue;
        // behind what does not count it may go a part of its way there: what counts has a step of its own
        const double free_way = hidden && f.gap < 0.0 ? 0.25 * nearest.distance : 0.0;
        const double above = f.gap - view_.level(half, i, site, path.q);
        const auto step_by = [&](const RelativeBounds& relative, const PathBounds& bounds, double over) {
          const double step = close_step(half, site, nearest, f, above, path, band, relative, bounds, over);
          return free_way > 0.0 ? std::max(step, free_way / bounds.speed) : step;
        };
        safe = std::min(safe, step_by(long_bounds_.of(half), over_all, window));
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
        if (polish(half, f, path, bounds)) continue;
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

  /// The feature pair is within tolerance: if it approaches, finds the last double at which it is still
  /// apart. True if a contact was found; false if it recedes, or passes by.
  bool polish(const Half& half, const Feature& f, const SamplePath& path, const PathBounds& bounds) {
    if (!view_.approaching(f, path)) {
      if (f.gap < -limits_.tolerance && t_ == from_ && f.rate > 0.0) ++work_.let_go;
      return false;
    }
    // Within a tick of the clock it is somewhere else: no probe can say whether it meets, and told() says so.
    if (view_.is_too_fast(path)) return remember(half, f, t_);
    // of a sample past its contact, so far that sides may have changed, nothing more is to be learnt
    const bool past = best_.sample == f.sample && best_.sample_on_a == half.s_is_a && t_ > best_.time;
    if (past) return true;
    // signed; a vertex's to all sites nearby together, so that the root is the outline's, not that of one
    // site
    const auto gap = [&](double t) { return view_.gap_at(half, f, t).gap; };
    const Site& site = half.site(f.site);
    const double speed = -f.rate;
    const double now = f.gap - view_.level(half, f.sample, site, path.q);
    // touching from the start, and approaching
    if (t_ <= view_.start() && now <= 0.0) return remember(half, f, t_);
    if (meets_tip(half, f, path, bounds)) return true;
    const double rounding = view_.gap_rounding(half, f.sample, path.q);
    const FallingGap falling(t_, now, speed, bounds.acceleration, rounding);
    // A canonical time needs an interval that holds this crossing alone, with a gap beyond rounding at both ends. It was
    // clear until the search began.
    const auto clear =
        falling.clear_end(gap, in_part_ ? from_ : std::max(earliest_, from_ - 1024.0 * falling.moment()));
    if (!clear && gap(t_) <= 0.0) {
      const std::optional<double> since = in_each_other_since(half, f);
      return since && remember(half, f, *since);
    }
    const double low = clear.value_or(t_);
    // no probe may lie beyond a motion
    const double last = motions_end();
    FallingGap::Beyond beyond = falling.beyond_end(gap, low, last);
    // What may have risen by more than the touching distance in between has its crossing on the way down to its first dip, or
    // none there: what it comes to after that, half a turn later, say, is another one.
    const bool may_rise = falling.may_rise_first(beyond.end, limits_.touch);
    const double dip = may_rise ? deepest_after(half, f, falling, last) : 0.0;
    if (dip > 0.0 && dip < beyond.end) beyond = {dip, dip > low && gap(dip) < -rounding};
    double high = beyond.end;
    // If no probe found where the gap is surely gone, the bottom of the dip decides.
    // A dip of less than a rounding is none, whoever looked where; what falls on is looked at again from nearer. But
    // behind a sharp tip there may be no more room than that: what comes upon it meets it.
    const bool sharp = site.radius + half.sample(f.sample).radius == 0.0;
    const bool tip = !beyond.surely && sharp && nearest_on(site, path.q).foot != Foot::interior;
    if (!beyond.surely) {
      const double deepest = dip > 0.0 ? dip : deepest_after(half, f, falling, last);
      if (!tip)
        high = deepest > low && gap(deepest) < -rounding ? deepest : low;
      else if (deepest > low)
        high = gap(deepest) <= 0.0 ? deepest : low;
    }
    if (high <= low) return false;  // passes by
    double clear_gap = 0.0;         // where it was last clear
    const auto probed = [&](double time) {
      const double there = gap(time);
      clear_gap = there > 0.0 ? there : clear_gap;
      return there;
    };
    const double t = last_clear_time(probed, low, high);
    if (t == low) clear_gap = gap(low);
    // along the site's face, before the tip, it was such a dip
    if (tip && foot_at(half, f, t) == Foot::interior) return false;
    // at the end of its neighbourhood a sample changes sides without having come near
    if (clear_gap > view_.touching_band(half, f.sample, path)) return false;
    return remember(half, f, t, 2.0 * falling.moment()) || meets_beyond_tip(half, f, gap, t);
  }

  /// Where on f's site its sample is nearest to that at time t.
  Foot foot_at(const Half& half, const Feature& f, double t) const {
    PairView there = view_;
    there.place(t);
    return nearest_on(half.site(f.site), there.path(half, f.sample).q).foot;
  }

  /// Since when they meet that have been in each other since the motions began, and approach now; none: they do not yet. Who
  /// parted then (off a wire, when an island let go of them below any level) meets when they have turned and fallen a little;
  /// whom another site hid, when it no longer does; else t_.
  std::optional<double> in_each_other_since(const Half& half, const Feature& f) {
    if (half.sample(f.sample).arc_site >= 0) return t_;
    const KeptNeighbours kept(scratch_);
    PairView there = view_;
    const Site& site = half.site(f.site);
    SamplePath path;
    const auto feature_at = [&](double t) {
      there.place(t);
      path = there.path(half, f.sample);
      return there.vertex_feature(half, f.sample, f.site, nearest_on(site, path.q), path);
    };
    const auto hidden = [&](double t) {
      const Feature then = feature_at(t);
      const bool counts = then.gap <= there.level(half, f.sample, site, path.q) &&
                          !there.hidden_behind_others(half, then, path);
      return counts ? -1.0 : 1.0;
    };
    const double begin = remembers_start_ ? view_.start() : from_;
    if (!(begin < t_)) return t_;
    const auto parts = [&](double t) {
      const Feature then = feature_at(t);
      return !there.approaching(then, path);
    };
    if (!parts(begin)) {
      const bool uncovered = hidden(begin) > 0.0 && !(hidden(t_) > 0.0);
      return uncovered ? std::max(soonest(), last_clear_time(hidden, begin, t_)) : t_;
    }
    const double turn = std::clamp(change_between(begin, t_, parts), begin, t_);
    // from their rate, as the way is too short to be told from two gaps
    const auto higher = [&](double t) {
      return -0.5 * feature_at(t).rate * (t - turn) < 0.25 * sink_step(limits_.touch, 0.0);
    };
    if (higher(t_)) return std::nullopt;
    const double fallen = std::clamp(change_between(turn, t_, higher), turn, t_);
    return hidden(fallen) > 0.0 ? t_ : std::max(soonest(), fallen);
  }

  /// When what is so at `low`, and not at `high`, changes, on a grid of 1024 ticks of the clock: wider than what the rounding of a
  /// rate makes of it. Halved to a quarter of the grid, then rounded to it, which may lead beyond either: searches that begin
  /// elsewhere all but always come to the same double.
  template <class IsSo>
  static double change_between(double low, double high, IsSo&& is_so) {
    const double grid = 1024.0 * ulp(high);
    while (high - low > 0.25 * grid) {
      const double middle = low + 0.5 * (high - low);
      (is_so(middle) ? low : high) = middle;
    }
    return std::round(high / grid) * grid;
  }

  /// True if f's two features meet by t_ although they passed each other's tips at `passed`, where the gap was last clear:
  /// what goes along the line that parts the tips may turn towards it. They meet at half of what may pass, so that the
  /// next tip that comes along passes, too.
  template <class Gap>
  bool meets_beyond_tip(const Half& half, const Feature& f, Gap&& gap, double passed) {
    if (a_.held && b_.held) return false;  // an island, which keeps their gap
    const double depth = 0.5 * view_.passing_depth(half, f.sample, view_.path(half, f.sample).q);
    const auto above = [&](double t) { return gap(t) + depth; };
    if (!(t_ > passed && above(t_) <= 0.0)) return false;
    return remember(half, f, last_clear_time(above, passed, t_));
  }

  /// Where the gap, which falls now, is smallest, if it rises again within eight times what is left until it has met for
  /// sure, and not after `last`; 0 if it does not. What turns may rise and fall again before that: it is asked from the
  /// soonest on at which it can rise, so that the first dip is found. The grid of change_between() is much narrower than
  /// the dip.
  double deepest_after(const Half& half, const Feature& f, const FallingGap& gap, double last) const {
    // a copy is placed elsewhere: this search goes on at t_
    PairView there = view_;
    const auto rises = [&](double t) {
      there.place(t);
      return there.look_again(half, f, t).closing_speed <= 0.0;
    };
    const double until = t_ + 8.0 * (gap.later() - t_);
    double falling = t_, rising = gap.soonest_rise();
    while (!rises(std::min(rising, last))) {
      if (rising >= until || rising >= last) return 0.0;
      falling = rising;
      rising = t_ + 2.0 * (rising - t_);
    }
    rising = std::min(rising, last);
    return std::clamp(change_between(falling, rising, [&](double t) { return !rises(t); }), t_, last);
  }

  /// Two sharp corners of solids that come upon each other, to rounding: what lies beyond is for roundings to
  /// say, and the tip of one may run along the outside of the other though their edges cross, which no tip
  /// tells of. So they meet, a part of the touching distance before. True if they do.
  bool meets_tip(const Half& half, const Feature& f, const SamplePath& path, const PathBounds& bounds) {
    const Site& site = half.site(f.site);
    const Sample& sample = half.sample(f.sample);
    const bool sharp = sample.before >= 0 && site.solid && site.radius + sample.radius == 0.0;
    if (!sharp) return false;
    const bool at_a = (path.q - site.a).squaredNorm() < (path.q - site.b).squaredNorm();
    const Vec2 tip = at_a ? site.a : site.b, way = path.q - tip;
    const double noise = view_.gap_rounding(half, f.sample, path.q);
    if (view_.is_at_joint(half, f.sample, site, path.q, noise)) return false;
    if (meets_arc_before(site, tip, way, 8.0 * noise)) return false;
    // the gap approaches, so the rate is not 0
    const double slow = path.rate.norm(), off = way.norm() / slow;
    // A first look: along the straight way they pass each other at this distance. If that is more than
    // rounding and bending explain, they do not meet.
    if (std::abs(cross(path.rate, way)) / slow > 8.0 * noise + bounds.acceleration * off * off) return false;
    if (const int corner = half.s_is_a ? -1 : corner_of_a(tip); corner >= 0)
      return meets_tip_from_a(half, f, corner);
    return comes_upon_tip(half, f, path, at_a);
  }

  /// True if the straight way to the tip, from `way` off it, leads through the convex arc that ends there, by more than
  /// `depth`.
  static bool meets_arc_before(const Site& site, const Vec2& tip, const Vec2& way, double depth) {
    if (site.kind != SiteKind::arc || site.sweep < 0.0) return false;
    // half the chord that the line cuts from the circle
    const double half_chord = -way.dot(tip - site.center) / way.norm();
    return half_chord > 0.0 && half_chord * half_chord > 2.0 * site.arc_radius * depth;
  }

  /// What is so many roundings off a tip is upon it.
  static constexpr double kUponTip = 4.0;

  /// True of a sample that goes straight for the tip, `way` from it, where another sink step would lead upon it: it has come there.
  bool is_upon_tip(const Half& half, const Feature& f, const SamplePath& way, bool at_a,
                   const PairView& there) const {
    const Vec2& tip = at_a ? half.site(f.site).a : half.site(f.site).b;
    const double rounding = there.gap_rounding(half, f.sample, way.q + tip), upon = kUponTip * rounding;
    const double speed = way.rate.norm(), room = way.q.norm() - sink_step(limits_.touch, rounding);
    return room < upon && speed > there.rate_noise(way) && way.q.dot(way.rate) < upon * speed &&
           std::abs(cross(way.rate, way.q)) <= upon * speed &&
           corners_cross(half, f, at_a, way.rate, there) && !lies_flush(half, f, at_a, there);
  }

  /// The same of a sample that goes straight for the tip.
  bool comes_upon_tip(const Half& half, const Feature& f, const SamplePath& path, bool at_a) {
    const Site& site = half.site(f.site);
    const Vec2 tip = at_a ? site.a : site.b;
    PairView there = view_;
    const auto to_tip = [&](double t) {
      there.place(t);
      SamplePath then = there.path(half, f.sample);
      then.q -= tip;
      return then;
    };
    const double begin = earliest_;
    if (remembers_start_) {
      const SamplePath first = to_tip(begin);
      if (is_upon_tip(half, f, first, at_a, there)) return asked_from_ <= begin && remember(half, f, begin);
    }
    // They are nearest to each other where way . rate = 0: found by Newton's steps, from here and twice
    // from there.
    double nearest = t_ - (path.q - tip).dot(path.rate) / path.rate.squaredNorm();
    SamplePath then;
    for (int i = 0; i < 2; ++i) {
      if (!(nearest >= begin && nearest <= window_end())) return false;
      then = to_tip(nearest);
      nearest -= then.q.dot(then.rate) / then.rate.squaredNorm();
    }
    // what is nearest before its motions begin, or long before, has gone by, or turns: it does not go straight for the tip
    if (!(nearest >= begin && nearest <= window_end())) return false;
    then = to_tip(nearest);
    if (!corners_cross(half, f, at_a, then.rate, there)) return false;
    if (lies_flush(half, f, at_a, there)) return false;  // it meets a face, not a tip
    const double rounding = there.gap_rounding(half, f.sample, then.q + tip);
    // beside each other: along the way they may be as far apart as one goes within a tick of the clock
    const double speed = then.rate.norm(), beside = std::abs(cross(then.rate, then.q)) / speed;
    if (!(beside <= 4.0 * rounding)) return false;
    // The gap at which a sharp sample meets a wire (nominal_level()); where they have been nearer from the start, as after
    // they met, a sink step less than then.
    double before = std::max(0.5 * limits_.touch, 8.0 * rounding);
    const double step = sink_step(limits_.touch, rounding);
    if (remembers_start_) before = std::min(before, std::max(to_tip(begin).q.norm() - step, -limits_.touch));
    const auto clear = [&](double t) {
      const SamplePath there_then = to_tip(t);
      return -there_then.q.dot(there_then.rate) / there_then.rate.norm() - before;
    };
    // where they are nearest is known to the rounding of their places: the moment lies in what is surely wider
    const double ticks = 4.0 * (ulp(nearest) + rounding / speed);
    const double high = std::min(nearest + ticks, motions_end());
    double low = std::max(nearest - std::max(2.0 * before / speed, ticks), begin);
    // they may have parted first, and not far
    for (double back = nearest - low; !(clear(low) > 0.0) && back > ticks; back *= 0.5) low = nearest - back;
    // what never was clear of the tip does not come upon it, but upon a side
    if (!(low < high && clear(low) > 0.0)) return false;
    if (clear(high) > 0.0) return false;  // the motion ends before
    return remember(half, f, last_clear_time(clear, low, high), 2.0 * rounding / speed);
  }

  /// The sample of a's corner that is there, in a's frame; -1 if none is.
  int corner_of_a(const Vec2& tip) const {
    const std::vector<Sample>& samples = view_.half(true).samples_of().samples;
    const auto found = std::find_if(samples.begin(), samples.end(),
                                    [&](const Sample& s) { return s.before >= 0 && s.p == tip; });
    return found == samples.end() ? -1 : static_cast<int>(found - samples.begin());
  }

  /// The same, asked of a's corner i, which is the tip that f's sample of b comes upon: two tips have one moment in which
  /// they meet, whichever of the two outlines was looked from.
  bool meets_tip_from_a(const Half& of_b, const Feature& f, int i) {
    const Half& of_a = view_.half(true);
    const Sample& other = of_b.sample(f.sample);
    const SamplePath path = view_.path(of_a, i);
    const KeptNeighbours kept(scratch_);  // those of b's sample are asked for again
    const std::uint32_t sides[] = {static_cast<std::uint32_t>(other.before),
                                   static_cast<std::uint32_t>(other.after)};
    view_.find_neighbours(of_a, i, sides, path, 4.0 * view_.touching_band(of_a, i, path));
    return meets_tip(of_a, Feature{i, other.after}, path, path_bounds(path, long_bounds_.of(of_a), to_ - t_));
  }

  /// The sample's corner in T's frame.
  Corner corner_of(const Half& half, int i, const PairView& there) const {
    return corner_seen(half.samples_of(), half.sample(i), there.placed(half.s).frame,
                       there.placed(half.t).frame);
  }

  /// True if one side of the site's corner, and no other line, parts it from the sample's.
  bool lies_flush(const Half& half, const Feature& f, bool at_a, const PairView& there) const {
    const Corner of_sample = corner_of(half, f.sample, there), of_site = corner_at(half.site(f.site), at_a);
    return parts_alone(of_site.before, of_sample, of_site) || parts_alone(of_site.after, of_sample, of_site);
  }

  /// True if the sample's corner, at the site's end, comes to overlap with that as it moves along d (T's
  /// frame).
  bool corners_cross(const Half& half, const Feature& f, bool at_a, const Vec2& d,
                     const PairView& there) const {
    return come_to_overlap(corner_of(half, f.sample, there), corner_at(half.site(f.site), at_a), d);
  }

  /// Keeps the contact if it is the earliest so far (ties: lowest half, sample, site). False if there is none: two
  /// corners pass each other. The search goes on for `noise` longer: another feature may seem to touch later only
  /// by the rounding of its steps.
  bool remember(const Half& half, const Feature& f, double t, double noise = 0.0) {
    if (t > window_end()) return true;
    if (in_part_ && t < asked_from_) return false;  // who asks has looked there
    const std::optional<FeatureContact> contact = contact_then(half, f, t);
    if (!contact) return false;
    // Crossed over, as the lesser comes first: a's samples before b's, then the lower sample, then the lower
    // site.
    const bool earlier = best_.sample < 0 || t < best_.time ||
                         (t == best_.time && std::tie(half.s_is_a, best_.sample, best_.site) >
                                                 std::tie(best_.sample_on_a, contact->sample, contact->site));
    if (!earlier) return true;
    best_ = *contact;
    to_ = std::min(to_, std::nextafter(t + noise, kForever));
    return true;
  }

  /// The contact's geometry is that of its own time, and its site the nearest then, unless it leaves that; or that of
  /// the next double, where a corner has come to lie flush on a face. None of corners that pass each other, nor of what goes
  /// round the free end of a wire.
  std::optional<FeatureContact> contact_then(const Half& half, const Feature& f, double t) const {
    PairView there = view_;
    there.place(t);
    // a tip that comes from far has no neighbours yet: its site is the one that was asked for
    const auto nearest_there = [&] {
      const int site = view_.gap_where(there, half, f).site;
      return site >= 0 ? site : f.site;
    };
    Feature met = f;
    met.site = nearest_there();
    if (there.passes_tip(half, met)) return std::nullopt;
    FeatureContact contact = there.look_again(half, met, t);
    if (!(contact.closing_speed > 0.0) && met.site != f.site) contact = there.look_again(half, f, t);
    const double after = next_after(t);
    if (contact.closing_speed > 0.0 || after > std::min(a_.motion->end(), b_.motion->end())) return contact;
    there.place(after);
    met.site = nearest_there();
    const FeatureContact next = there.look_again(half, met, t);
    if (next.closing_speed > 0.0) return next;
    // round the free end of a wire it has come as near as touching, and is away from there
    const double noise = there.rate_noise(there.path(half, f.sample));
    const bool goes_by =
        !half.site(met.site).solid && std::max(contact.closing_speed, next.closing_speed) < -noise;
    return goes_by ? std::nullopt : std::optional(contact);
  }

  PairView view_;
  const Mover &a_, &b_;
  double from_, to_;
  double asked_from_, window_end_;  ///< from_ and to_ as they were given
  bool remembers_start_;
  double
      earliest_;  ///< when both motions can be asked for: where they begin, or so far back as neither is given up
  const SearchLimits& limits_;
  SearchScratch& scratch_;
  WorkCounters& work_;
  double* safe_until_[2];  ///< one a sample of each half
  BothWays long_bounds_, short_bounds_;
  double short_window_ = 0.0, short_end_ = 0.0;
  double t_ = 0.0, next_ = 0.0, reached_ = 0.0;
  double free_radius_[2] = {-1.0, -1.0};  ///< free_radius() of each half; below 0: not known yet
  double least_ = kForever;               ///< of the samples looked at from t_, how long all are safe
  FeatureContact best_;
  bool sink_known_ = false;
  bool sinks_ = false;  ///< the step of the sample that is looked at may lead below a level
  bool capped_ = false;
  bool comes_and_goes_ = false;  ///< something that is close at t_ does
  bool in_part_ = false;         ///< from_ and to_ are those of a part of a piece
  double part_end_ = 0.0;
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
