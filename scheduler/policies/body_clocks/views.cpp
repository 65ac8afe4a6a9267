#include "brink/scheduler/policies/body_clocks/views.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "brink/core/base/limits.h"
#include "brink/scheduler/broad_phase/broad_phase.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"

namespace brink {

namespace {

/// Outlines of more sites have one box for all: each box costs a look of its own.
constexpr std::size_t kMostBoxes = 16;

/// Cells that a gap is wide from.
constexpr double kWide = 1e3;

/// Boxes of an outline's sites; empty where they would not narrow anything down.
std::vector<Box> boxes_of(const Outline& outline) {
  // a container is met from within its bounds: only its sites' own boxes narrow anything down
  if (outline.sites.size() > kMostBoxes)
    return outline.container ? std::vector<Box>{} : std::vector<Box>{outline.bounds};
  std::vector<Box> boxes;
  for (const Site& site : outline.sites) {
    Box box;
    box.add(site.a);
    box.add(site.b);
    // An arc of a quarter turn at most reaches beyond the box of its ends by less than its radius.
    if (site.kind == SiteKind::arc) box = box.grown(site.arc_radius);
    boxes.push_back(box.grown(site.radius));
  }
  return boxes;
}

/// A time in which a motion goes no farther than `room`, from bounds of its speed; end - now where it stays
/// till the end. What is fast later on must not shorten it much: then less of it is looked at.
double time_within(double room, const Motion& motion, double now, double end) {
  // ends: a span that cannot be told from none is the last
  for (double span = end - now;; span *= 0.5) {
    const double fastest = motion.bounds(now, now + span).speed();
    // Halved until the room is at least half of what the bound allows for: room / fastest lies within
    // the span then, for which alone the bound holds.
    if (room >= fastest * span) return span;
    if (room >= 0.5 * fastest * span || !(now + 0.5 * span > now)) return room / fastest;
  }
}

/// Of the bounding discs of a and b, displaced by `shift` [m]; 0: they may overlap.
double gap_between(const Motion& a, double radius, const Motion& b, const Vec2& shift, const Outline& other,
                   double now) {
  if (other.container) return 0.0;
  const Vec2 at_a = a.pose(now).position, at_b = b.pose(now).position;
  const double rounding = kFlightRounding * (at_a.lpNorm<1>() + at_b.lpNorm<1>());
  return std::max(0.0, (at_a - at_b - shift).norm() -
                           (radius + other.bounding_radius) * (1.0 + kFlightMargin) - rounding);
}

/// A lower bound of the time in which a and b can close that gap before `end` [s].
double gap_over_speed(double gap, const Motion& a, const Motion& b, double now, double end) {
  if (gap <= 0.0) return 0.0;
  const auto closing_in = [&](double span) {
    const MotionBounds x = a.bounds(now, now + span), y = b.bounds(now, now + span);
    return (x.velocity - y.velocity).norm() + x.velocity_radius + y.velocity_radius;
  };
  // what is fast later on must not shorten it much: then less of it is looked at
  // Over a span the discs cannot close the gap sooner than by the largest speed of that span; a bound holds
  // in its own span alone. So of nested spans, each answer cut to its span, the longest counts.
  const double whole = gap / closing_in(end - now);
  if (whole >= 0.5 * (end - now)) return whole;
  double longest = whole;
  for (double span = 0.5 * (end - now); span > longest && now + span > now; span *= 0.5)
    longest = std::max(longest, std::min(span, gap / closing_in(span)));
  return longest;
}

}  // namespace

Views::Views(Kernel& kernel)
    : kernel_(&kernel),
      gravity_(kernel.world().gravity),
      periods_(kernel.world().periods),
      flights_(kernel.body_count()),
      clocks_(kernel.body_count()),
      paces_(kernel.body_count()),
      looked_(static_cast<std::size_t>(kernel.body_count())) {
  std::vector<Vec2> places;
  for (int k = 0; k < body_count(); ++k) {
    flights_[k].radius = kernel.outline_of(k).bounding_radius;
    take_up(k);
    places.push_back(kernel.state(k, kernel.time()).pose.position);
  }
  std::vector<SiteLists::Placed> still;
  for (int s = 0; s < static_cast<int>(kernel.world().sites.size()); ++s) {
    site_boxes_.emplace_back();
    if (kernel.site_moves(s)) {
      moving_.push_back(s);
      continue;
    }
    const Outline& outline = kernel.outline_of(body_count() + s);
    still.push_back({s, transformed(outline, kernel.site_motion(s).pose(0.0))});
    site_boxes_.back() = boxes_of(still.back().outline);
  }
  // rendered passes tell themselves who is near: one cell holds all then
  const bool by_place = kernel.options().broad_phase && !kernel.by_passes();
  near_.emplace(flights_, clocks_, places, std::move(still), periods_, by_place);
}

void Views::take_up(int k) {
  Flight& f = flights_[k];
  const Motion& motion = kernel_->body(k).motion;
  f.version = f.version + 1U;
  f.free = kernel_->is_free(k) && motion.acceleration().linear == gravity_ && !kernel_->by_passes();
  f.disc = f.free && is_centred_disc(kernel_->outline_of(k));
  f.plain = f.free && kernel_->is_plain_disc(k);
  // stride() goes by how long motions last from start to start
  if (!kernel_->is_free(k)) note_start(k, motion.begin());
  // In meeting() every comparison with it is false, and max(now, NaN) is now: who is not free may be met
  // at once, without a branch that asks.
  f.x = std::numeric_limits<double>::quiet_NaN();
  if (f.free) start_anew(k, motion);
}

/// Its flight is that parabola from now on.
void Views::start_anew(int k, const Motion& motion) {
  Flight& f = flights_[k];
  const BodyState& s = motion.start();
  f.x = s.pose.position.x();
  f.y = s.pose.position.y();
  f.vx = s.twist.velocity.x();
  f.vy = s.twist.velocity.y();
  f.start = motion.origin();
}

/// True if body k is to have that owner in view: nobody else looks after the pair.
bool Views::sees(int k, int other, const Image& image) const {
  if (other < body_count() && has_looked(other)) return false;
  return kernel_->may_meet(k, other) && (!kernel_->is_held(k) || kernel_->is_searched(k, other, image));
}

void Views::see_bounded(int k, int j, const Image& image, double now) {
  const MeetingTimes m = bounded_meeting(k, j, image, now);
  if (m.begin < clocks_[k].horizon) clocks_[k].see({m.begin, m.begin, j, image, flights_[j].version, 0}, now);
}

/// Bodies near body k, which is not in free flight.
void Views::see_bodies(int k, double now) {
  near_->near(k, [&](int j, const Image& image) {
    if (sees(k, j, image)) see_bounded(k, j, image, now);
  });
}

/// Compares body k in free flight with all near it at once, by vector instructions, where that can be done
/// (Neighbourhood::around()); with `former`, its former cell, with those alone that were not near it there.
void Views::compare(int k, const Course& here, double now, Sight& sight, const Cell* former) {
  static_assert(FlightBatch::kMost > CellGrid::kMostAround);
  const int count = near_->around(k, sight.near.bodies(), former);
  sight.is_whole = count >= 0;
  if (sight.is_whole) sight.met = sight.near.meet(count, flights_.data(), here, now, clocks_[k].horizon);
}

/// Bodies near body k in free flight, as compare() was asked for them.
void Views::see_bodies(int k, const Course& here, double now, const Sight& sight, const Cell* former) {
  if (!sight.is_whole) return see_one_by_one(k, here, now, former);
  BodyClock& clock = clocks_[k];
  for (unsigned met = sight.met; met != 0; met &= met - 1) {
    const int i = std::countr_zero(met), j = sight.near.body(i);
    // of who flies freely no island keeps a gap
    if (j == k || has_looked(j) || !kernel_->may_meet(k, j)) continue;
    if (flights_[j].free)
      clock.see(sight.near.begin(i), j, flights_[j].version, now);
    else if (sight.near.begin(i) < clock.horizon)  // it may have come nearer
      see_bounded(k, j, {}, now);
  }
}

void Views::see_one_by_one(int k, const Course& here, double now, const Cell* former) {
  const auto compare_with = [&](int j, const Image& image) {
    const double begin = meeting(here, flights_[j], periods_.shift(image), now).begin;
    if (!(begin < clocks_[k].horizon) || !sees(k, j, image)) return;
    if (flights_[j].free)
      clocks_[k].see({begin, begin, j, image, flights_[j].version, 0}, now);
    else
      see_bounded(k, j, image, now);
  };
  near_->near(k, compare_with, former);
}

void Views::look_around(int k, double now) {
  const auto timed = kernel_->looking();
  look(k, now);
}

/// The first two of a round, which are all of most, are told by their numbers; of more it is noted body by body.
void Views::note_look(int k) {
  if (lookers_ < 2) {
    first_lookers_[lookers_++] = k;
    return;
  }
  for (const int first : first_lookers_) looked_[first] = round_;
  looked_[k] = round_;
  lookers_ = 3;
}

/// An empty view, without a horizon. Who is not in free flight gets one before anybody is put into view: see() compares with
/// it.
void Views::begin_view(int k, double now) {
  kernel_->note_pass(k, now);
  clocks_[k].forget_all();
}

void Views::look(int k, double now) {
  note_look(k);
  begin_view(k, now);
  if (flights_[k].free) {
    const Course course = place(k, now);
    compare(k, course, now, sights_[0]);
    see_bodies(k, course, now, sights_[0]);
  } else {
    if (!begin_window(k, now)) return;
    if (kernel_->by_passes()) return see_by_pass(k, now);
    see_bodies(k, now);
  }
  see_sites(k, now);
}

/// Puts body k in free flight into the cell where it is, which it leaves when its clock says; returns how it goes on.
Course Views::place(int k, double now) {
  const Course course(flights_[k], gravity_, now);
  Box cell = near_->box_of(k);
  if (!cell.contains(course.place)) {
    near_->put_into_cell(k, course.place);
    cell = near_->box_of(k);
  }
  clocks_[k].exit = now + stay_in(cell, course);
  return course;
}

void Views::see_sites(int k, double now) {
  near_->sites_near(k, [&](int s, const Image& image) { see_site(k, s, image, now); });
  for (const int s : moving_) see_moving_site(k, s, now);
}

/// Each is as free as it was. The first sees the second, if it may meet it, and not the reverse. Both are compared with all
/// near them before either sees anybody: what one of the two waits for the other is done in.
void Views::look_around_after(int a, int b, double now) {
  const auto timed = kernel_->looking();
  start_anew(a);
  start_anew(b);
  begin_round();
  begin_view(a, now);
  begin_view(b, now);
  const Course course_a = place(a, now), course_b = place(b, now);
  compare(a, course_a, now, sights_[0]);
  compare(b, course_b, now, sights_[1]);
  note_look(a);
  see_bodies(a, course_a, now, sights_[0]);
  see_sites(a, now);
  note_look(b);
  see_bodies(b, course_b, now, sights_[1]);
  see_sites(b, now);
}

void Views::look_around_after(int k, double now) {
  const auto timed = kernel_->looking();
  start_anew(k);
  begin_round();
  look(k, now);
}

/// On its newest motion, as free as it was; candidates that others have of it are stale.
void Views::start_anew(int k) {
  flights_[k].version = flights_[k].version + 1U;
  start_anew(k, kernel_->body(k).motion);
}

void Views::look_ahead(int k, double now) {
  const auto timed = kernel_->looking();
  BodyClock& clock = clocks_[k];
  const Course course(flights_[k], gravity_, now);
  const Cell former = flights_[k].cell;
  // What was near the former cell is in view already, or has body k in its own.
  const bool moved = near_->put_into_cell(k, course.place);
  clock.exit = now + stay_in(near_->box_of(k), course);
  // Nobody has looked around in this round: all that comes near is to be in k's view.
  begin_round();
  if (moved) {
    compare(k, course, now, sights_[0], &former);
    see_bodies(k, course, now, sights_[0], &former);
  }
  near_->sites_near(k, [&](int s, const Image& image) { see_site(k, s, image, now); });
}

/// Still sites are in view until body k leaves its cell.
void Views::see_site(int k, int s, const Image& image, double now) {
  if (!sees(k, body_count() + s, image)) return;
  const double soonest = plain_at_wall(k, s, image) ? kernel_->soonest_at_wall(k, s) : now;
  if (soonest == kForever) return;  // as of half of them
  BodyClock& clock = clocks_[k];
  const double end = std::min(clock.exit, clock.horizon);
  double wait = flights_[k].free && !site_boxes_[s].empty() ? kForever : 0.0;
  if (wait > 0.0) {
    Course course(flights_[k], gravity_, now);
    course.displace(-periods_.shift(image));
    // the centre must be within its disc's radius of a site's box
    const double reach = course.radius + kernel_->contact_tolerance();
    for (const Box& box : site_boxes_[s]) wait = std::min(wait, time_to(box.grown(reach), course));
    if (wait == kForever) return;                                 // what it leaves behind, or goes by
    wait = std::max(0.0, wait - kFlightRounding * (now + wait));  // never later than it is
  }
  const double begin = std::max(soonest, now + wait);
  if (begin <= end) clock.see({begin, begin, body_count() + s, image, 0, 0}, now);
}

/// Sites that move are in no cell: each is bounded by its speed, wherever body k is.
void Views::see_moving_site(int k, int s, double now) {
  if (!kernel_->may_meet(k, body_count() + s)) return;
  const auto see = [&](const Image& image) {
    if (!sees(k, body_count() + s, image)) return;
    const MeetingTimes m = bounded_meeting(k, body_count() + s, image, now);
    if (m.begin < clocks_[k].horizon) clocks_[k].see({m.begin, m.begin, body_count() + s, image, 0, 0}, now);
  };
  see({});
  if (!periods_.any() || kernel_->halt()) return;
  // the view has an end now, to which both can be followed
  const double end = std::max(now, std::min(clocks_[k].horizon, until_));
  const Box here = swept_box(kernel_->outline_of(k), kernel_->body(k).motion, now, end);
  const Box there = swept_box(kernel_->outline_of(body_count() + s), kernel_->site_motion(s), now, end);
  periods_.overlaps(here, there, [&](const Image& image) {
    if (image != Image{} && kernel_->poll()) see(image);
  });
}

double Views::earliest_search(double now) const {
  double earliest = now;
  for (int k = 0; k < body_count(); ++k)
    for (std::size_t i = 0; i < clocks_[k].candidates.size(); ++i)
      earliest = std::min(earliest, clocks_[k].candidates[i].clear);
  return earliest;
}

/// What the rendered window of body k names until the view's end, each to be searched at once.
void Views::see_by_pass(int k, double now) {
  const double end = end_view(k, kernel_->follow_motions(std::min(clocks_[k].horizon, until_)));
  if (kernel_->halt()) return;
  for (const PairKey& pair : kernel_->near_pairs_of(k, now, end)) {
    const int second = pair.with_site() ? body_count() + pair.other_site : pair.other_body;
    const int other = second == k ? pair.body : second;
    clocks_[k].see({now, now, other, {}, version_of(other), 0}, now);
  }
}

/// When the bounding discs of body k and another owner can meet at the soonest, from bounds of speed; ends
/// k's view about where the two could have crossed a cell.
MeetingTimes Views::bounded_meeting(int k, int owner, const Image& image, double now) {
  const bool is_body = owner < body_count();
  const auto speed_of = [&](int s) { return kernel_->site_motion(s).twist(now).velocity.norm(); };
  if (is_body ? !kernel_->extend_motion(owner, now) : !kernel_->extend_sites(now)) return {};
  const Vec2 shift = periods_.shift(image);
  const Outline& outline = kernel_->outline_of(owner);
  const double gap =
      gap_between(kernel_->body(k).motion, flights_[k].radius,
                  is_body ? kernel_->body(owner).motion : kernel_->site_motion(owner - body_count()), shift,
                  outline, now);
  limit_view(k, now, speed(k, now) + (is_body ? speed(owner, now) : speed_of(owner - body_count())),
             is_body ? stride(owner, now) : kForever, gap);
  const double end = follow(k, owner, std::max(now, std::min(clocks_[k].horizon, until_)));
  // anew: to follow a motion makes it longer
  const Motion& other = is_body ? kernel_->body(owner).motion : kernel_->site_motion(owner - body_count());
  const double wait = gap_over_speed(gap, kernel_->body(k).motion, other, now, end);
  return now + wait <= end ? MeetingTimes{now + wait, end} : MeetingTimes{};
}

/// Of its centre [m/s].
double Views::speed(int k, double now) const { return kernel_->body(k).motion.twist(now).velocity.norm(); }

/// `typical` is a mean in which the last time from start to start counts half, the one before a quarter, and
/// so on.
void Views::note_start(int k, double start) {
  Pace& pace = paces_[k];
  if (start <= pace.start) return;
  const double time = start - pace.start;
  pace.typical = std::isinf(pace.typical) ? time : 0.5 * (pace.typical + time);
  pace.start = start;
}

/// How far ahead to look at a body from now [s]: what an integrator has done is thrown away when a collision
/// starts its component afresh, so no farther than it has come since, or a part of what it typically comes.
double Views::stride(int k, double now) const {
  if (kernel_->is_free(k) || kernel_->is_held(k)) return kForever;
  const Pace& pace = paces_[k];
  return std::max(now - pace.start, 0.25 * pace.typical);
}

/// Ends body k's view about when something that closes in at that speed could have crossed a cell, or the gap to it
/// where that is wide, or after the stride, if that is not next to nothing, beside a cell's time or what the motion has
/// behind it.
void Views::limit_view(int k, double now, double closing, double stride, double gap) {
  const double cell = near_->cell_size(k),
               near = std::isfinite(cell) ? cell : 4.0 * kernel_->world().length();
  // what flies away fast is looked at less and less often
  const double length = gap > kWide * near ? gap : near;
  // 100 s at most, however slow the two are.
  const double window = length / (closing + 1e-2 * length);
  const double age = kernel_->is_free(k) ? 0.0 : now - paces_[k].start;
  // after `now` at least: what is faster than the clock can tell is for the search to refuse
  const double end = std::max(now + std::max({std::min(window, stride), 1e-3 * window, 1e-3 * age}),
                              std::nextafter(now, kForever));
  // a view that holds to the end of the run ends just after it
  clocks_[k].horizon = std::min(clocks_[k].horizon, end >= until_ ? std::nextafter(until_, kForever) : end);
  // a view that holds to the end of an island's step ends just after it: the step comes first
  const double step_end = kernel_->is_held(k) ? kernel_->step_end(k) : kForever;
  if (step_end >= now) clocks_[k].horizon = std::min(clocks_[k].horizon, std::nextafter(step_end, kForever));
}

/// Until when the motions of body k and of another owner (sites: of all that move) can be followed, <= end.
double Views::follow(int k, int owner, double end) {
  end = std::min(end, kernel_->follow_motion(k, end));
  return end_view(k, owner < body_count() ? kernel_->follow_motion(owner, end) : kernel_->follow_sites(end));
}

/// Ends k's view where what it must follow has been followed to: to go on there, or, where a motion cannot
/// go on, just after it, for what still happens there.
double Views::end_view(int k, double followed) {
  const bool last = followed >= until_ || followed == kernel_->reach();
  clocks_[k].horizon = std::min(clocks_[k].horizon, last ? std::nextafter(followed, kForever) : followed);
  return followed;
}

/// The view of a body that is not in free flight: it ends before the body can leave its cell. False on a
/// halt.
bool Views::begin_window(int k, double now) {
  BodyClock& clock = clocks_[k];
  if (!kernel_->extend_motion(k, now)) return false;
  const Vec2 place = kernel_->body(k).motion.pose(now).position;
  near_->put_into_cell(k, place);
  clock.exit = kForever;
  limit_view(k, now, speed(k, now), stride(k, now), 0.0);
  const double end = follow(k, body_count(), std::max(now, std::min(clock.horizon, until_)));
  const Box box = near_->box_of(k);
  const double room = std::min((place - box.low).minCoeff(), (box.high - place).minCoeff());
  const double stay = time_within(room, kernel_->body(k).motion, now, end);
  if (!(stay < end - now)) return true;
  clock.horizon = now + stay;
  if (clock.horizon > now) return true;
  kernel_->stop(
      Termination::failed,
      fmt::format("'{}' is too fast for the clock at t = {:.17g}: in no time that it can tell does it stay "
                  "near its place",
                  kernel_->world().bodies[k].name, now));
  return false;
}

}  // namespace brink
