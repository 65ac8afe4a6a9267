#include "brink/scheduler/kernel/certificate_watch.h"

#include <fmt/core.h>

#include <algorithm>
#include <tuple>

#include "brink/core/shapes/distance.h"
#include "brink/scheduler/kernel/states_apart.h"
#include "brink/scheduler/kernel/tolerances.h"
#include "brink/scheduler/resolve/extended_contact.h"

namespace brink {

namespace {

/// More pairs of sites than this are not looked at for a crossing at every frame.
constexpr std::size_t kMostCrossings = 4096;
/// Nor than this at every step or collision.
constexpr std::size_t kMostAtOnce = 1024;
/// What is deeper in each other by less than this part of the contact tolerance at a frame is not looked at again.
constexpr double kLittleOfTolerance = 1e-2;
/// The search for overlaps at the start ends after so many: all bodies may be in one place.
constexpr std::size_t kOverlapsCounted = 1000;

/// True for a sharp sample at a wire without thickness: met at a level before it, as it has no inside
/// whose sign would tell the side (first_contact/tolerances.h).
bool thin(const Outline& samples, const Outline& sites, const FeatureContact& f) {
  return !sites.sites[f.site].solid && sites.sites[f.site].radius + samples.samples[f.sample].radius == 0.0;
}

/// Of states_apart(), and of the gap of two that are there [m].
double rounding(const ExtendedState& s, double radius) {
  return kSameInTwoDoubles * (std::abs(s.position.x().high()) + std::abs(s.position.y().high()) +
                              radius * (1.0 + std::abs(s.angle.high())));
}

}  // namespace

/// Four looks. After each collision: its two features, as the collision left them (resolved). Where an island begins a step, and
/// at a body's next collision after one of a wire: whether the boundaries of those who had met cross. At each frame: every
/// pair that may have come to overlap since the last, its gap and whether boundaries cross (frame). Between two looks at a
/// body: the flight of its centre, by walls (flight). From begin() on what any of them sees ends the run (report).
CertificateWatch::CertificateWatch(const World& world, const Trajectories& trajectories,
                                   ContactSearch& search, const NearPairs& near, RunControl& run)
    : world_(&world),
      trajectories_(&trajectories),
      search_(&search),
      near_(&near),
      run_(&run),
      pairs_(world, trajectories, search, near, run),
      walls_(world.periods) {}

void CertificateWatch::begin() {
  on_ = true;
  pairs_.clear();  // overlaps that were measured are to be judged
  if (!walls_made_) make_walls();
}

/// Wires without thickness, as they stand in the world, and which bodies' centres are in their material.
/// Cost: that of the outlines, once.
void CertificateWatch::make_walls() {
  walls_made_ = true;
  const int n = trajectories_->body_count();
  for (int s = 0; s < trajectories_->site_count(); ++s) {
    const SiteMotion& motion = trajectories_->site(s);
    if (motion.moves()) continue;
    // still: where it is at the beginning it is always
    const Outline placed = transformed(search_->outline_of(n + s), motion.motion().pose(0.0));
    for (const Site& site : placed.sites)
      if (!site.solid && site.radius == 0.0 && site.kind != SiteKind::point) walls_.add(site, s);
  }
  for (const Body& b : world_->bodies) {
    const Outline& o = *b.outline;
    // A ring may hang on a wire, which goes through its hollow with the centre on either side: of a body
    // whose centre is not in it no flight is judged.
    const bool solid = o.is_point() ? o.sites[0].radius > 0.0 : o.solid;
    material_centre_.push_back(solid && !o.container && gap_by_brute_force(o, Vec2::Zero()) < 0.0);
  }
  clear_.resize(world_->bodies.size());
}

std::vector<Contact> CertificateWatch::overlaps(std::size_t most) {
  std::vector<Contact> found;
  const double now = run_->time();
  near_->each_at(now, [&](const PairKey& pair) {
    const auto contacts = search_->touching(pair, 0.0, now);
    if (!contacts.empty() && contacts.front().gap < 0.0)
      found.push_back(world_contact(pair, contacts.front()));
    // bars that cross, with no vertex of one in the other
    else if (const auto crossing = search_->crossing(pair, now, 0.0))
      found.push_back(*crossing);
    return found.size() < most;
  });
  // of equal depth by owners: messages do not depend on the order in which boxes met
  const auto order = [](const Contact& c) { return std::tuple(c.gap, c.body, c.other_body, c.other_site); };
  std::sort(found.begin(), found.end(),
            [&](const Contact& x, const Contact& y) { return order(x) < order(y); });
  return found;
}

std::string CertificateWatch::start_fault() {
  const double allowed = kStartOverlap * world_->length();
  const std::vector<Contact> found = overlaps(kOverlapsCounted);
  const bool can_start = found.empty() || found.front().gap >= -allowed;
  // what the run starts with it may keep (allowed()); what somebody has put in somebody since it may not
  if (run_->time() == 0.0) start_overlap_ = !found.empty() && can_start ? -found.front().gap : 0.0;
  if (can_start) return {};
  const Contact& c = found.front();
  const std::string& other =
      c.other_body >= 0 ? world_->bodies[c.other_body].name : world_->sites[c.other_site].name;
  return fmt::format(
      "'{}' and '{}' overlap by {:.3g} m at the start, near ({:.4g}, {:.4g}); at most {:.1g} m is allowed"
      " ({} overlapping pair(s) in all)",
      world_->bodies[c.body].name, other, -c.gap, c.point.x(), c.point.y(), allowed,
      found.size() < kOverlapsCounted ? std::to_string(found.size())
                                      : fmt::format("{} or more", kOverlapsCounted));
}

bool CertificateWatch::flight(int k, double to) {
  if (!on_ || walls_.empty() || !material_centre_[k]) return true;
  const Motion& motion = trajectories_->body(k).motion;
  // flights up to the last frame were looked at there
  const double from = std::max(motion.begin(), flown_until_);
  if (!(from < to)) return true;
  // of the centre of mass: a body whose centre has passed a wire is on its other side
  const Vec2 p = motion.place(from), q = motion.place(to);
  // the straight line between the two, by which walls are looked up, lies in the box then: it meets none
  if (clear_[k].contains(p) && clear_[k].contains(q)) return true;
  // about where it ends: the next flight begins there, and may need no look at walls
  clear_[k] = walls_.clear_around(q);
  const auto site = walls_.crossed([&](double t) { return motion.place(t); }, from, to);
  // only the first wall is told; one that the body may pass is no fault
  if (!site || !search_->may_meet(k, trajectories_->body_count() + *site)) return true;
  return report({k, -1, *site, {}}, 0.0, to, "went through a wire of");
}

bool CertificateWatch::approaches(const PairKey& pair, double closing_speed, double rounding) {
  if (!on_ || closing_speed >= -rounding) return true;
  return report(pair, 0.0, run_->time(), "is said to meet, but parts from");
}

bool CertificateWatch::resolved(const PairKey& pair, const FeatureContact& found, Real delay,
                                const Moment* moment) {
  if (!on_) return true;
  const Outline &a = search_->outline_of(pair.body), &b = search_->outline_of(search_->other_owner(pair));
  const double t = run_->time();
  // in the states that the collision left, at the moment at which it was resolved
  const ExtendedState body = trajectories_->body(pair.body).motion.extended_state(t).moved(delay),
                      other = search_->other_state(pair, t).moved(delay);
  const bool on_wire = found.sample_on_a ? thin(a, b, found) : thin(b, a, found);
  if (moment) {
    const double ra = a.bounding_radius, rb = b.bounding_radius;
    const double least =
        moment->gap.high() - states_apart(body, moment->body, ra) - states_apart(other, moment->other, rb);
    const double none = rounding(body, ra) + rounding(other, rb);
    // no deeper than what was seen before, whatever a closer look would give
    if (on_wire ? least > none : -least <= std::min(allowed(), std::max(max_overlap_, none))) return true;
  }
  // what was pushed apart counts as it is now: the world goes on from there
  const double gap = static_cast<double>(contact_in(a, b, body, other, found).gap);
  note_overlap(gap);
  // At a wire the sign of the gap is the side, and a level of it is always left; a solid may sink by
  // roundings.
  if (on_wire ? gap > 0.0 : gap >= -allowed()) return true;
  return report(pair, on_wire ? std::max(0.0, -gap) : -gap, t,
                on_wire ? "is on the other side of a wire of" : "overlaps");
}

bool CertificateWatch::discs_resolved(const PairKey& pair, double gap) {
  return !on_ || -gap <= allowed() || report(pair, -gap, run_->time(), "overlaps");
}

/// Of two who have met, or are near: where one has gone through the other it is on its way still. Not where it would take long.
bool CertificateWatch::do_not_cross(const PairKey& pair) {
  const Motion& body = trajectories_->body(pair.body).motion;
  const Motion& other = trajectories_->motion_of(search_->other_owner(pair));
  const double t = run_->time();
  // who is ahead of the present time, or has not been followed up to it, is looked at another time
  if (body.begin() > t || body.end() < t || other.begin() > t || other.end() < t) return true;
  const std::size_t sites = search_->outline_of(pair.body).sites.size() *
                            search_->outline_of(search_->other_owner(pair)).sites.size();
  if (sites > kMostAtOnce || !search_->may_meet(pair.body, search_->other_owner(pair))) return true;
  const auto crossing = search_->crossing(pair, t, 0.0);
  if (!crossing || -crossing->gap <= allowed()) return true;
  note_overlap(crossing->gap);
  return report(pair, -crossing->gap, t, "crosses");
}

bool CertificateWatch::collided(const PairKey& pair) {
  if (!on_) return true;
  const auto is_wire = [&](int owner) {
    const Outline& o = search_->outline_of(owner);
    return !o.solid && !o.is_point();
  };
  if (!is_wire(pair.body) && !is_wire(search_->other_owner(pair))) return true;
  if (met_last_.empty()) met_last_.resize(world_->bodies.size());
  for (const int k : {pair.body, pair.other_body}) {
    if (k < 0) continue;
    if (met_last_[k] && *met_last_[k] != pair && !do_not_cross(*met_last_[k])) return false;
    met_last_[k] = pair;
  }
  return true;
}

bool CertificateWatch::step_begins(const std::vector<HeldContact>& contacts) {
  if (!on_) return true;
  const PairKey* last = nullptr;
  for (const HeldContact& c : contacts) {  // by pairs
    if (last && *last == c.pair) continue;
    last = &c.pair;
    if (!do_not_cross(c.pair)) return false;
  }
  return true;
}

/// Pairs that may have come to overlap since the last frame; then every centre's flight up to t. Whatever is seen halts
/// the run, which poll() tells.
void CertificateWatch::frame(double t) {
  pairs_.each(t, [&](const PairKey& pair, double at_least, double at_most) {
    const double gap = is_nothing_new(at_least) ? at_least : pair_at_frame(pair, t, at_most);
    return run_->poll() ? std::optional(gap) : std::nullopt;
  });
  flights(t);
}

/// Every centre's flight up to t, which will not be looked at again.
void CertificateWatch::flights(double t) {
  for (int k = 0; k < trajectories_->body_count() && !run_->halt(); ++k) flight(k, t);
  flown_until_ = std::max(flown_until_, t);
}

/// True of two that a line parts: they do not cross, and are no deeper in each other than what was seen before, or than
/// roundings make.
bool CertificateWatch::is_nothing_new(double at_least) const {
  const double little = kLittleOfTolerance * search_->limits().tolerance;
  return at_least >= -std::min(allowed(), std::max(max_overlap_, little));
}

/// By samples first, then by boundaries that cross, where that is not too many intersections. The gap [m], or
/// `at_most` where it is more; where that is an overlap the run has been ended.
double CertificateWatch::pair_at_frame(const PairKey& pair, double t, double at_most) {
  const double gap = search_->gap(pair, t, at_most);
  note_overlap(gap);
  if (on_ && gap < -allowed()) report(pair, -gap, t, "overlaps");
  const std::size_t sites = search_->outline_of(pair.body).sites.size() *
                            search_->outline_of(search_->other_owner(pair)).sites.size();
  if (gap < -allowed() || sites > kMostCrossings) return gap;
  // samples do not see bars that cross, as no vertex of either is in the other
  const auto crossing = search_->crossing(pair, t, gap);
  if (!crossing) return gap;
  if (-crossing->gap > allowed()) {
    note_overlap(crossing->gap);
    if (on_) report(pair, -crossing->gap, t, "crosses");
  }
  return std::min(gap, crossing->gap);
}

/// Ends the run. Always false, so that callers can return it.
bool CertificateWatch::report(const PairKey& pair, double depth, double t, const char* what) {
  const std::string& other =
      pair.with_site() ? world_->sites[pair.other_site].name : world_->bodies[pair.other_body].name;
  run_->stop(
      Termination::failed,
      fmt::format("'{}' {} '{}' at t = {:.17g} (depth {:.3g} m, at most {:.3g} m is allowed): this must not "
                  "be; what a search certified does not hold",
                  world_->bodies[pair.body].name, what, other, t, depth, allowed()));
  return false;
}

}  // namespace brink
