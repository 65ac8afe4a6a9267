/// The kernel's watch over what searches have certified: overlaps and sides of the pairs just resolved, all
/// pairs at frames, ways through wires. What it sees ends the run.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/outline_crossing.h"
#include "brink/scheduler/kernel/kernel.h"
#include "brink/scheduler/resolve/extended_contact.h"

namespace brink {

namespace {

/// More pairs of segments than this are not looked at for a crossing at every frame.
constexpr std::size_t kMostCrossings = 4096;

bool thin(const Outline& samples, const Outline& sites, const FeatureContact& f) {
  return !sites.sites[f.site].solid && sites.sites[f.site].radius + samples.samples[f.sample].radius == 0.0;
}

}  // namespace

void Kernel::hold_to_certificates(bool exact) {
  checked_ = exact && !depth_;
  if (!checked_ || world_.periods.any() || walls_made_) return;
  walls_made_ = true;
  for (int s = 0; s < static_cast<int>(sites_.size()); ++s) {
    if (sites_[s].moves()) continue;
    const Outline placed = transformed(outline_of(body_count() + s), sites_[s].motion().pose(0.0));
    for (const Site& site : placed.sites)
      if (!site.solid && site.radius == 0.0 && site.kind == SiteKind::segment) walls_.add(site.a, site.b, s);
  }
  for (const Body& b : world_.bodies) {
    const Outline& o = *b.outline;
    const bool solid = o.is_point() ? o.sites[0].radius > 0.0 : o.solid;
    material_centre_.push_back(solid && !o.container && gap_by_brute_force(o, Vec2::Zero()) < 0.0);
  }
}

bool Kernel::check_resolved(const PairKey& pair, const FeatureContact& found, Real delay) {
  if (!checked_) return true;
  const Outline &a = outline_of(pair.body), &b = outline_of(other_owner(pair));
  const ExtendedContact now = contact_in(a, b, bodies_[pair.body].motion.extended_state(time_).moved(delay),
                                         other_state(pair, time_).moved(delay), found);
  const bool on_wire = found.sample_on_a ? thin(a, b, found) : thin(b, a, found);
  const double gap = static_cast<double>(now.gap);
  note_overlap(gap);
  if (on_wire ? gap > 0.0 : gap >= -allowed_overlap()) return true;
  return report_overlap(pair, on_wire ? std::max(0.0, -gap) : -gap, time_,
                        on_wire ? "is on the other side of a wire of" : "overlaps");
}

bool Kernel::check_flight(int k, double to) {
  if (!checked_ || walls_.empty() || !material_centre_[k]) return true;
  const Motion& motion = bodies_[k].motion;
  const double from = std::max(motion.begin(), checked_until_);
  if (!(from < to)) return true;
  const auto site = walls_.crossed([&](double t) { return motion.pose(t).position; }, from, to);
  if (!site) return true;
  return report_overlap({k, -1, *site, {}}, 0.0, to, "went through a wire of");
}

void Kernel::check_overlaps_at(double t) {
  each_near_at(t, [&](const PairKey& pair) {
    check_overlap(pair, t);
    return poll();
  });
  for (int k = 0; k < body_count() && !halt_; ++k) check_flight(k, t);
  checked_until_ = t;
}

bool Kernel::check_overlap(const PairKey& pair, double t) {
  const double gap = pair_gap(mover(pair.body), other_mover(pair), t, limits_, scratch_);
  note_overlap(gap);
  if (!checked_) return true;
  if (gap < -allowed_overlap()) return report_overlap(pair, -gap, t, "overlaps");
  if (outline_of(pair.body).sites.size() * outline_of(other_owner(pair)).sites.size() > kMostCrossings)
    return true;
  const auto crossing = crossing_at(pair, t);
  if (!crossing || -crossing->gap <= allowed_overlap()) return true;
  note_overlap(crossing->gap);
  return report_overlap(pair, -crossing->gap, t, "crosses");
}

bool Kernel::report_overlap(const PairKey& pair, double depth, double t, const char* what) {
  const std::string& other =
      pair.with_site() ? world_.sites[pair.other_site].name : world_.bodies[pair.other_body].name;
  stop(Termination::failed,
       fmt::format(
           "'{}' {} '{}' at t = {:.17g} (depth {:.3g} m, at most {:.3g} m is allowed): this must not be; "
           "what a search certified does not hold",
           world_.bodies[pair.body].name, what, other, t, depth, allowed_overlap()));
  return false;
}

}  // namespace brink
