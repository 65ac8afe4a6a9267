#include "brink/scheduler/islands/modes/mode_arrival.h"

#include <algorithm>
#include <cmath>

#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/safe_step.h"
#include "brink/scheduler/islands/tolerances.h"

namespace brink {

namespace {

constexpr int kMostSteps = 1000;
/// Where no bound helps (an arc's sector), so many looks along the whole.
constexpr int kLooksOfArrival = 64;

/// One open contact on its owners' motions.
class Watch {
 public:
  /// `slack` [m]: as of first_arrival(), and the step that the motions are of.
  Watch(const ModeProblem& problem, const ModeContact& contact, const std::vector<PolynomialPiece>& bodies,
        double slack, double from, double to)
      : problem_(problem),
        contact_(contact),
        bodies_(bodies),
        slack_(slack),
        sector_window_((to - from) / kLooksOfArrival),
        fastest_(std::max(bounds(contact.sample_owner, from, to).speed(),
                          bounds(contact.site_owner, from, to).speed())) {}

  enum class Fate {
    stays_open,
    closes,     ///< at `when`
    undecided,  ///< open up to `when`, where the most steps had been made
  };

  /// What becomes of it before `to`.
  Fate look(double from, double to, double& when) const {
    double t = from, clear = from;
    for (int n = 0; t < to; ++n) {
      const ContactRates r = at(t);
      if (r.within >= 0.0 && comes(r)) {
        when = t > from ? last_clear(clear, t) : from;
        return Fate::closes;
      }
      if (n == kMostSteps) {
        when = t;
        return Fate::undecided;
      }
      // Steps may lead to a gap of down to -slack; the crossing is told by halving from the last place
      // where it was not below zero.
      if (r.gap >= 0.0 || r.within < 0.0) clear = t;
      const double s = safe_for(r, t, to);
      if (!(t + s > t)) {  // as near as the clock can tell
        when = t;
        return Fate::closes;
      }
      t += s;
    }
    // the last step may have ended at `to` itself, which the loop does not look at
    const ContactRates r = at(to);
    if (!(r.within >= 0.0 && comes(r))) return Fate::stays_open;
    when = last_clear(clear, to);
    return Fate::closes;
  }

 private:
  /// Its gap is that to where it closes.
  ContactRates at(double t) const {
    ContactRates r = rates_of(contact_.shape, state(contact_.sample_owner, t), state(contact_.site_owner, t));
    r.gap -= contact_.closes_at;
    return r;
  }
  /// A body's on the pieces of this step, a support's on its own motion.
  BodyState state(int owner, double t) const {
    return owner < problem_.bodies() ? bodies_[owner].state(t)
                                     : problem_.supports[owner - problem_.bodies()].state(t);
  }
  /// Of the same motions over part of the step.
  MotionBounds bounds(int owner, double from, double to) const {
    return owner < problem_.bodies() ? bodies_[owner].bounds(from, to)
                                     : problem_.supports[owner - problem_.bodies()].bounds(from, to);
  }

  /// Below zero by less than half the slack it comes only if it closes: what has just been let go, or
  /// passes by the end of a site, starts there by roundings: of places, and of velocities that are nearly the same.
  bool comes(const ContactRates& r) const {
    const double speed = std::max(std::abs(r.tangential_velocity) + std::abs(r.normal_velocity), fastest_);
    return r.gap < -0.5 * slack_ ||
           (!contact_.passes && r.gap < 0.0 && r.normal_velocity < -kNoClosing * speed);
  }

  /// The last double at which the gap is not below zero, by halving.
  double last_clear(double clear, double crossed) const {
    for (int n = 0; n < 100; ++n) {
      const double middle = 0.5 * (clear + crossed);
      if (!(middle > clear && middle < crossed)) break;
      const ContactRates r = at(middle);
      (r.gap >= 0.0 || r.within < 0.0 ? clear : crossed) = middle;
    }
    return clear;
  }

  /// How long it certainly stays open, up to slack [s]: bounds of shorter windows are tighter.
  double safe_for(const ContactRates& r, double t, double to) const {
    double best = 0.0;
    for (double window = to - t, tries = 0; tries < 4 && t + window > t; ++tries) {
      const Bent b = bend(r, t, t + window);
      // The slack on top of the gap keeps the step from shrinking to nothing at a gap of 0; comes() tells
      // at half of it.
      // What is beyond the surface already, beside what there is of it, is safe only as long as it stays beside.
      double s = r.gap > -slack_ ? safe_step(r.gap + slack_, r.normal_velocity, b.of_gap) : 0.0;
      if (r.within < 0.0) s = std::max(s, until_in_range(r, t, b));
      best = std::max(best, std::min(s, window));
      if (s >= 0.25 * window) break;
      // bounds over a long window are loose: over one not much longer than their answer they are nearly as
      // good as there are
      window = 4.0 * s;
    }
    return best;
  }

  struct Bent {
    double of_gap = 0.0;  ///< bound on its second derivative [m/s^2]
    double speed = 0.0;   ///< of the sample, as the site's owner sees it [m/s]
  };

  /// Bounds over [from, to], from where the contact is at `from`.
  Bent bend(const ContactRates& r, double from, double to) const {
    RelativeBounds relative(bounds(contact_.sample_owner, from, to), bounds(contact_.site_owner, from, to));
    const SmoothContact& c = contact_.shape;
    const bool round = c.kind == SmoothContact::Kind::circle;
    SamplePath path;
    path.arm = c.sample.norm();
    // site_arm leads to the point that touches; the sample's point is its radius further along the normal
    path.distance = (r.site_arm + c.sample_radius * r.normal).norm();
    PathBounds p = path_bounds(path, relative, to - from);
    const double speed = p.speed;
    if (round && c.place.isZero(0.0)) {
      // the gap looks the same at any angle of the circle, though what there is of an arc turns with it
      relative.spin_t = relative.alpha_t = 0.0;
      p = path_bounds(path, relative, to - from);
    }
    Bent b{p.acceleration, speed};
    if (!round || !c.hollow) return b;
    // Inside a circle the gap bends down by v^2 / distance, too. The sample comes no nearer to the centre
    // in the window than `least`; right at the centre the bound says nothing, and a thousandth stands for
    // it.
    const double distance = c.radius - c.sample_radius - r.gap - contact_.closes_at,
                 least = distance - p.speed * (to - from);
    b.of_gap += p.speed * p.speed / std::max(least, kNearCentre * distance);
    return b;
  }

  /// How long the sample stays out of the feature's range, or of its own sector.
  /// For every edge that it is beyond: its distance from the edge over the largest speed.
  double until_in_range(const ContactRates& r, double t, const Bent& b) const {
    const Frame frame(Pose{{0.0, 0.0}, state(contact_.site_owner, t).pose.angle});
    // all edges must be met: it is out for as long as the one that takes longest
    const Vec2 q = frame.direction_to_local(r.site_arm + contact_.shape.sample_radius * r.normal);
    double s = is_in_sector(r, t) ? 0.0 : sector_window_;
    for (const HalfPlane& edge : contact_.shape.range)
      if (const double out = -edge.within(q); out > 0.0) s = std::max(s, safe_step(out, -b.speed, 0.0));
    return s;
  }

  /// Of the sample's own: what it would touch with is a part of it.
  bool is_in_sector(const ContactRates& r, double t) const {
    const Frame frame(Pose{{0.0, 0.0}, state(contact_.sample_owner, t).pose.angle});
    const Vec2 to_site = frame.direction_to_local(-r.normal);
    return std::all_of(
        contact_.shape.sector.begin(), contact_.shape.sector.end(),
        [&](const HalfPlane& edge) { return edge.inward.isZero(0.0) || edge.within(to_site) >= 0.0; });
  }

  const ModeProblem& problem_;
  const ModeContact& contact_;
  const std::vector<PolynomialPiece>& bodies_;
  double slack_;
  /// How long to wait where the sample's own sector does not hold the touching direction: of that there is no bound [s].
  double sector_window_;
  double fastest_;  ///< of the two owners [m/s]
};

}  // namespace

Arrival first_arrival(const ModeProblem& problem, const std::vector<MotionMode>& modes,
                      const std::vector<PolynomialPiece>& bodies, double from, double to, double slack) {
  Arrival first;
  first.time = to;
  for (std::size_t k = 0; k < modes.size(); ++k) {
    if (is_closed(modes[k])) continue;
    const Watch watch(problem, problem.contacts[k], bodies, slack, from, to);
    double when = 0.0;
    // nobody is followed past the first that was found; of two at one time the earlier in order stays
    const Watch::Fate fate = watch.look(from, first.time, when);
    if (fate == Watch::Fate::stays_open || (first.found && when >= first.time)) continue;
    if (fate == Watch::Fate::closes)
      first = {true, when, static_cast<int>(k)};
    else
      // up to there all that were asked are open, and the others are asked up to there
      first = {false, when, -1};
  }
  return first;
}

}  // namespace brink
