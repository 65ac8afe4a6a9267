#include "brink/scheduler/first_contact/feature_crossing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "brink/core/base/limits.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/first_contact/corners.h"
#include "brink/scheduler/first_contact/falling_gap.h"

namespace brink::detail {

namespace {

/// What is so many roundings off a tip is upon it.
constexpr double kUponTip = 4.0;

/// Puts the neighbours that were found back when it goes: others may be looked for in between.
class KeptNeighbours {
 public:
  explicit KeptNeighbours(SearchScratch& scratch)
      : scratch_(scratch),
        neighbours_(scratch.neighbours),
        looked_from_(scratch.looked_from),
        looked_to_(scratch.looked_to),
        flush_on_(scratch.flush_on) {}
  KeptNeighbours(const KeptNeighbours&) = delete;
  KeptNeighbours& operator=(const KeptNeighbours&) = delete;
  ~KeptNeighbours() {
    scratch_.neighbours.swap(neighbours_);
    scratch_.looked_from = looked_from_;
    scratch_.looked_to = looked_to_;
    scratch_.flush_on = flush_on_;
  }

 private:
  SearchScratch& scratch_;
  std::vector<SearchScratch::Neighbour> neighbours_;
  Vec2 looked_from_;
  double looked_to_;
  int flush_on_;
};

/// When what is so at `low`, and not at `high`, changes, on a grid of 1024 ticks of the clock: wider than what the rounding of a
/// rate makes of it. Halved to a quarter of the grid, then rounded to it, which may lead beyond either: searches that begin
/// elsewhere all but always come to the same double.
template <class IsSo>
double change_between(double low, double high, IsSo&& is_so) {
  const double grid = 1024.0 * ulp(high);
  while (high - low > 0.25 * grid) {
    const double middle = low + 0.5 * (high - low);
    (is_so(middle) ? low : high) = middle;
  }
  return std::round(high / grid) * grid;
}

/// True if the straight way to the tip, from `way` off it, leads through the convex arc that ends there, by more than
/// `depth`.
bool meets_arc_before(const Site& site, const Vec2& tip, const Vec2& way, double depth) {
  if (site.kind != SiteKind::arc || site.sweep < 0.0) return false;
  // half the chord that the line cuts from the circle
  const double half_chord = -way.dot(tip - site.center) / way.norm();
  return half_chord > 0.0 && half_chord * half_chord > 2.0 * site.arc_radius * depth;
}

/// The sample's corner in T's frame.
Corner corner_of(const Half& half, int i, const PairView& there) {
  return corner_seen(half.samples_of(), half.sample(i), there.placed(half.s).frame,
                     there.placed(half.t).frame);
}

/// True if one side of the site's corner, and no other line, parts it from the sample's.
bool lies_flush(const Half& half, const Feature& f, bool at_a, const PairView& there) {
  const Corner of_sample = corner_of(half, f.sample, there), of_site = corner_at(half.site(f.site), at_a);
  return parts_alone(of_site.before, of_sample, of_site) || parts_alone(of_site.after, of_sample, of_site);
}

/// True if the sample's corner, at the site's end, comes to overlap with that as it moves along d (T's
/// frame).
bool corners_cross(const Half& half, const Feature& f, bool at_a, const Vec2& d, const PairView& there) {
  return come_to_overlap(corner_of(half, f.sample, there), corner_at(half.site(f.site), at_a), d);
}

}  // namespace

/// Keeps the contact if it is the earliest so far (ties: lowest half, sample, site). False if there is none: two
/// corners pass each other. The search goes on for `noise` longer: another feature may seem to touch later only
/// by the rounding of its steps.
bool FeatureCrossing::remember(const Half& half, const Feature& f, double t, double noise) {
  return keep(half, t, noise, [&] { return contact_then(half, f, t); });
}

/// The same of a contact that is told by `contact_then()`, if it counts.
template <class ContactThen>
bool FeatureCrossing::keep(const Half& half, double t, double noise, ContactThen&& contact_then) {
  if (t > window_.end()) return true;
  if (window_.in_part && t < window_.asked_from) return false;  // who asks has looked there
  const std::optional<FeatureContact> contact = contact_then();
  if (!contact) return false;
  // Crossed over, as the lesser comes first: a's samples before b's, then the lower sample, then the lower
  // site.
  const bool earlier =
      earliest_.sample < 0 || t < earliest_.time ||
      (t == earliest_.time && std::tie(half.s_is_a, earliest_.sample, earliest_.site) >
                                  std::tie(earliest_.sample_on_a, contact->sample, contact->site));
  if (!earlier) return true;
  earliest_ = *contact;
  window_.to = std::min(window_.to, std::nextafter(t + noise, kForever));
  return true;
}

bool FeatureCrossing::meets(const Half& half, const Feature& f, const SamplePath& path,
                            const PathBounds& bounds) {
  if (!view_.approaching(f, path)) {
    if (f.gap < -limits_.tolerance && time() == window_.from && f.rate > 0.0) ++work_.let_go;
    return false;
  }
  // Within a tick of the clock it is somewhere else: no probe can say whether it meets, and told() says so.
  if (view_.is_too_fast(path)) return remember(half, f, time());
  // of a sample past its contact, so far that sides may have changed, nothing more is to be learnt
  const bool past =
      earliest_.sample == f.sample && earliest_.sample_on_a == half.s_is_a && time() > earliest_.time;
  if (past) return true;
  // signed; a vertex's to all sites nearby together, so that the root is the outline's, not that of one
  // site
  const auto gap = [&](double t) { return gap_at(half, f, t); };
  const Site& site = half.site(f.site);
  const double speed = -f.rate;
  const double now = f.gap - view_.level(half, f.sample, site, path.q);
  // touching from the start, and approaching
  if (time() <= view_.start() && now <= 0.0) return remember(half, f, time());
  const double rounding = view_.gap_rounding(half, f.sample, path.q);
  const std::optional<TipsMeet> tips = at_tip(half, f, path, bounds);
  if (tips && !meets_before(half, f, tips->time, bounds.acceleration, rounding) &&
      keep(*tips->half, tips->time, tips->noise, [&] { return tips->contact; }))
    return true;
  const FallingGap falling(time(), now, speed, bounds.acceleration, rounding);
  // A canonical time needs an interval that holds this crossing alone, with a gap beyond rounding at both ends. It was
  // clear until the search began.
  const auto clear = falling.clear_end(
      gap, window_.in_part ? window_.from : std::max(told_from_, window_.from - 1024.0 * falling.moment()));
  if (!clear && gap(time()) <= 0.0) {
    const std::optional<double> since = in_each_other_since(half, f);
    return since && remember(half, f, *since);
  }
  const double low = clear.value_or(time());
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
  if (leaves_neighbours(half, f, t)) return false;
  return remember(half, f, t, 2.0 * falling.moment()) || meets_beyond_tip(half, f, t);
}

/// No probe may lie beyond it.
double FeatureCrossing::motions_end() const {
  return window_.in_part ? window_.part_end : std::min(a_.motion->end(), b_.motion->end());
}

/// Where on f's site its sample is nearest to that at time t.
Foot FeatureCrossing::foot_at(const Half& half, const Feature& f, double t) const {
  PairView there = view_;
  there.place(t);
  return nearest_on(half.site(f.site), there.path(half, f.sample).q).foot;
}

/// True if f's sample will be at an end of its site at time t, farther off than neighbours were looked for: it may meet others
/// there, and is looked at again from nearer.
bool FeatureCrossing::leaves_neighbours(const Half& half, const Feature& f, double t) const {
  if (half.sample(f.sample).arc_site >= 0 || t <= time()) return false;
  PairView there = view_;
  there.place(t);
  const Vec2 q = there.path(half, f.sample).q;
  return nearest_on(half.site(f.site), q).foot != Foot::interior &&
         (q - scratch_.looked_from).norm() > scratch_.looked_to;
}

/// Since when they meet that have been in each other since the motions began, and approach now; none: they do not yet. Who
/// parted then (off a wire, when an island let go of them below any level) meets when they have turned and fallen a little;
/// whom another site hid, when it no longer does; else time().
std::optional<double> FeatureCrossing::in_each_other_since(const Half& half, const Feature& f) const {
  if (half.sample(f.sample).arc_site >= 0) return time();
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
  const double begin = remembers_start_ ? view_.start() : window_.from;
  if (!(begin < time())) return time();
  const auto parts = [&](double t) {
    const Feature then = feature_at(t);
    return !there.approaching(then, path);
  };
  if (!parts(begin)) {
    const bool uncovered = hidden(begin) > 0.0 && !(hidden(time()) > 0.0);
    return uncovered ? std::max(window_.soonest(), last_clear_time(hidden, begin, time())) : time();
  }
  const double turn = std::clamp(change_between(begin, time(), parts), begin, time());
  // from their rate, as the way is too short to be told from two gaps
  const auto higher = [&](double t) {
    return -0.5 * feature_at(t).rate * (t - turn) < 0.25 * sink_step(limits_.touch, 0.0);
  };
  if (higher(time())) return std::nullopt;
  const double fallen = std::clamp(change_between(turn, time(), higher), turn, time());
  return hidden(fallen) > 0.0 ? time() : std::max(window_.soonest(), fallen);
}

/// True if f's two features meet by time() although they passed each other's tips at `passed`, where the gap was last clear:
/// what goes along the line that parts the tips may turn towards it. They meet at half of what may pass, so that the
/// next tip that comes along passes, too.
bool FeatureCrossing::meets_beyond_tip(const Half& half, const Feature& f, double passed) {
  if (a_.held && b_.held) return false;  // an island, which keeps their gap
  const double depth = 0.5 * view_.passing_depth(half, f.sample, view_.path(half, f.sample).q);
  const auto above = [&](double t) { return gap_at(half, f, t) + depth; };
  if (!(time() > passed && above(time()) <= 0.0)) return false;
  return remember(half, f, last_clear_time(above, passed, time()));
}

/// Where the gap, which falls now, is smallest, if it rises again within eight times what is left until it has met for
/// sure, and not after `last`; 0 if it does not. What turns may rise and fall again before that: it is asked from the
/// soonest on at which it can rise, so that the first dip is found. The grid of change_between() is much narrower than
/// the dip.
double FeatureCrossing::deepest_after(const Half& half, const Feature& f, const FallingGap& gap,
                                      double last) const {
  // a copy is placed elsewhere: this search goes on at time()
  PairView there = view_;
  const auto rises = [&](double t) {
    there.place(t);
    return there.look_again(half, f, t).closing_speed <= 0.0;
  };
  const double until = time() + 8.0 * (gap.later() - time());
  double falling = time(), rising = gap.soonest_rise();
  while (!rises(std::min(rising, last))) {
    if (rising >= until || rising >= last) return 0.0;
    falling = rising;
    rising = time() + 2.0 * (rising - time());
  }
  rising = std::min(rising, last);
  return std::clamp(change_between(falling, rising, [&](double t) { return !rises(t); }), time(), last);
}

/// True if the gap is gone before t, when the sample comes upon a tip: a way that bends, and comes there straight, may lead
/// through a side. Halved towards t until what `bend` can make of the rest is rounding. [m/s^2, m]
bool FeatureCrossing::meets_before(const Half& half, const Feature& f, double t, double bend,
                                   double rounding) const {
  for (double rest = 0.5 * (t - time()); bend * rest * rest > 8.0 * rounding; rest *= 0.5)
    if (gap_at(half, f, t - rest) < -rounding) return true;
  return false;
}

/// Two sharp corners of solids that come upon each other, to rounding: what lies beyond is for roundings to
/// say, and the tip of one may run along the outside of the other though their edges cross, which no tip
/// tells of. So they meet, a part of the touching distance before. None if they do not.
std::optional<FeatureCrossing::TipsMeet> FeatureCrossing::at_tip(const Half& half, const Feature& f,
                                                                 const SamplePath& path,
                                                                 const PathBounds& bounds) {
  const Site& site = half.site(f.site);
  const Sample& sample = half.sample(f.sample);
  const bool sharp = sample.before >= 0 && site.solid && site.radius + sample.radius == 0.0;
  if (!sharp) return std::nullopt;
  const bool at_a = (path.q - site.a).squaredNorm() < (path.q - site.b).squaredNorm();
  const Vec2 tip = at_a ? site.a : site.b, way = path.q - tip;
  const double noise = view_.gap_rounding(half, f.sample, path.q);
  if (view_.is_at_joint(half, f.sample, site, path.q, noise)) return std::nullopt;
  // where two arcs go on into each other there is no tip either
  const bool tips = corner_at(site, at_a).sharp() && corner_at(half.samples_of(), sample).sharp();
  if (!tips) return std::nullopt;
  if (meets_arc_before(site, tip, way, 8.0 * noise)) return std::nullopt;
  // the gap approaches, so the rate is not 0
  const double slow = path.rate.norm(), off = way.norm() / slow;
  // A first look: along the straight way they pass each other at this distance. If that is more than
  // rounding and bending explain, they do not meet.
  if (std::abs(cross(path.rate, way)) / slow > 8.0 * noise + bounds.acceleration * off * off)
    return std::nullopt;
  if (const int corner = half.s_is_a ? -1 : corner_of_a(tip); corner >= 0)
    return at_tip_of_a(half, f, corner);
  return straight_upon_tip(half, f, path, at_a);
}

/// True of a sample that goes straight for the tip, `way` from it, where another sink step would lead upon it: it has come there.
bool FeatureCrossing::is_upon_tip(const Half& half, const Feature& f, const SamplePath& way, bool at_a,
                                  const PairView& there) const {
  const Vec2& tip = at_a ? half.site(f.site).a : half.site(f.site).b;
  const double rounding = there.gap_rounding(half, f.sample, way.q + tip), upon = kUponTip * rounding;
  const double speed = way.rate.norm(), room = way.q.norm() - sink_step(limits_.touch, rounding);
  return room < upon && speed > there.rate_noise(way) && way.q.dot(way.rate) < upon * speed &&
         std::abs(cross(way.rate, way.q)) <= upon * speed && corners_cross(half, f, at_a, way.rate, there) &&
         !lies_flush(half, f, at_a, there);
}

/// The same of a sample that goes straight for the tip.
std::optional<FeatureCrossing::TipsMeet> FeatureCrossing::straight_upon_tip(const Half& half,
                                                                            const Feature& f,
                                                                            const SamplePath& path,
                                                                            bool at_a) {
  const Site& site = half.site(f.site);
  const Vec2 tip = at_a ? site.a : site.b;
  PairView there = view_;
  const auto to_tip = [&](double t) {
    there.place(t);
    SamplePath then = there.path(half, f.sample);
    then.q -= tip;
    return then;
  };
  const double begin = told_from_;
  if (remembers_start_) {
    const SamplePath first = to_tip(begin);
    if (is_upon_tip(half, f, first, at_a, there)) {
      if (window_.asked_from > begin) return std::nullopt;
      return TipsMeet{&half, begin, 0.0, contact_then(half, f, begin)};
    }
  }
  // They are nearest to each other where way . rate = 0: found by Newton's steps, from here and twice
  // from there.
  double nearest = time() - (path.q - tip).dot(path.rate) / path.rate.squaredNorm();
  SamplePath then;
  for (int i = 0; i < 2; ++i) {
    if (!(nearest >= begin && nearest <= window_.end())) return std::nullopt;
    then = to_tip(nearest);
    nearest -= then.q.dot(then.rate) / then.rate.squaredNorm();
  }
  // what is nearest before its motions begin, or long before, has gone by, or turns: it does not go straight for the tip
  if (!(nearest >= begin && nearest <= window_.end())) return std::nullopt;
  then = to_tip(nearest);
  if (!corners_cross(half, f, at_a, then.rate, there)) return std::nullopt;
  if (lies_flush(half, f, at_a, there)) return std::nullopt;  // it meets a face, not a tip
  const double rounding = there.gap_rounding(half, f.sample, then.q + tip);
  // beside each other: along the way they may be as far apart as one goes within a tick of the clock
  const double speed = then.rate.norm(), beside = std::abs(cross(then.rate, then.q)) / speed;
  if (!(beside <= 4.0 * rounding)) return std::nullopt;
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
  if (!(low < high && clear(low) > 0.0)) return std::nullopt;
  if (clear(high) > 0.0) return std::nullopt;  // the motion ends before
  const double t = last_clear_time(clear, low, high);
  return TipsMeet{&half, t, 2.0 * rounding / speed, contact_then(half, f, t)};
}

/// The sample of a's corner that is there, in a's frame; -1 if none is.
int FeatureCrossing::corner_of_a(const Vec2& tip) const {
  const std::vector<Sample>& samples = view_.half(true).samples_of().samples;
  const auto found = std::find_if(samples.begin(), samples.end(),
                                  [&](const Sample& s) { return s.before >= 0 && s.p == tip; });
  return found == samples.end() ? -1 : static_cast<int>(found - samples.begin());
}

/// The same, asked of a's corner i, which is the tip that f's sample of b comes upon: two tips have one moment in which
/// they meet, whichever of the two outlines was looked from.
std::optional<FeatureCrossing::TipsMeet> FeatureCrossing::at_tip_of_a(const Half& of_b, const Feature& f,
                                                                      int i) {
  const Half& of_a = view_.half(true);
  const Sample& other = of_b.sample(f.sample);
  const SamplePath path = view_.path(of_a, i);
  const KeptNeighbours kept(scratch_);  // those of b's sample are asked for again
  const std::uint32_t sides[] = {static_cast<std::uint32_t>(other.before),
                                 static_cast<std::uint32_t>(other.after)};
  view_.find_neighbours(of_a, i, sides, path, 4.0 * view_.touching_band(of_a, i, path));
  return at_tip(of_a, Feature{i, other.after}, path,
                path_bounds(path, window_.bounds.of(of_a), window_.to - time()));
}

/// The contact's geometry is that of its own time, and its site the nearest then, unless it leaves that; or that of
/// the next double, where a corner has come to lie flush on a face. None of corners that pass each other, nor of what goes
/// round the free end of a wire.
std::optional<FeatureContact> FeatureCrossing::contact_then(const Half& half, const Feature& f,
                                                            double t) const {
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

}  // namespace brink::detail
