#include "brink/integrators/stepping.h"

#include <cmath>
#include <sstream>

#include "brink/core/base/error.h"
#include "brink/integrators/dense_output.h"

namespace brink {

bool is_finite(const BodyState& s) {
  return s.pose.position.allFinite() && std::isfinite(s.pose.angle) && s.twist.velocity.allFinite() &&
         std::isfinite(s.twist.omega);
}
bool is_finite(const Acceleration& a) { return a.linear.allFinite() && std::isfinite(a.angular); }

// False for NaN, too: no comparison with it holds.
bool is_in_range(const BodyState& s) {
  // Energies are sums of squares of such numbers: 1e300 each, while the largest double is 1.8e308.
  constexpr double most = 1e150;
  const auto ok = [](double x) { return std::abs(x) <= most; };
  return ok(s.pose.position.x()) && ok(s.pose.position.y()) && ok(s.pose.angle) && ok(s.twist.velocity.x()) &&
         ok(s.twist.velocity.y()) && ok(s.twist.omega);
}

/// A failure beyond what was asked for does not count: what was asked for is covered.
Extent extent_at(double end, double t, const std::string& failure) {
  if (end >= t) return {Extent::Status::reached, end, {}};
  if (failure.empty()) return {Extent::Status::unfinished, end, {}};
  return {Extent::Status::failed, end, failure};
}

std::string time_text(double t) {
  std::ostringstream out;
  // more than the default of six, which would not tell steps from each other after 1000 s
  out.precision(12);
  out << t;
  return out.str();
}

void check_start(const Dynamics& dynamics, double t, std::span<const BodyState> states) {
  if (!std::isfinite(t)) throw BadInput("integrator start: t is " + time_text(t) + "; allowed: finite times");
  if (states.size() != static_cast<std::size_t>(dynamics.size()))
    throw BadInput("integrator start: " + std::to_string(states.size()) + " states given for " +
                   std::to_string(dynamics.size()) + " bodies");
  for (std::size_t k = 0; k < states.size(); ++k)
    if (!is_finite(states[k]))
      throw BadInput("integrator start: the state of body " + std::to_string(k) +
                     " of the component is not finite; allowed: finite poses and twists");
}

void check_finite_time(double t) {
  if (!std::isfinite(t))
    throw BadInput("integrator extend: t is " + time_text(t) + "; allowed: finite times");
}

void SteppingIntegrator::start(double t, std::span<const BodyState> states) {
  check_start(*dynamics_, t, states);
  time_ = t;
  states_.assign(states.begin(), states.end());
  tracks_.clear();
  // New tracks: motions made before keep theirs.
  for (int k = 0; k < size(); ++k) tracks_.push_back(std::make_shared<Track>());
  in_segment_ = false;
  why_.clear();
  failure_.clear();
}

/// At most so many steps, then "unfinished": the caller may look at its clock, or at a signal, and ask again.
Extent SteppingIntegrator::extend(double t, std::uint64_t most_steps) {
  check_finite_time(t);
  for (std::uint64_t n = 0; time_ < t && failure_.empty() && n < most_steps; ++n) {
    why_.clear();
    // One step at a time until t is covered; t itself is not told to the method, so that
    // steps cannot depend on it.
    if (in_segment_ || next_segment()) step();
  }
  return extent_at(time_, t, failure_);
}

// A motion that somebody holds shares its track: it forgets with it (Motion::remembered_until()).
void SteppingIntegrator::forget_before(double t) {
  for (const auto& track : tracks_) track->forget_before(t);
}

Motion SteppingIntegrator::motion(int k) const {
  // before the first step: the starting time alone
  if (tracks_.at(k)->pieces.empty()) return Motion::ballistic(time_, states_[k], {}, time_);
  return Motion::dense(tracks_[k]);
}

/// The stretch up to the next break, on which the forces do not jump. False: fail() was called.
bool SteppingIntegrator::next_segment() {
  segment_end_ = dynamics_->next_break(time_);
  if (!(segment_end_ > time_)) return fail("the next break of the forces is not later than this time");
  in_segment_ = begin_segment();
  return in_segment_;
}

/// What every method asks for its right-hand sides; counts them. False where one is not finite: why() says whose.
bool SteppingIntegrator::accelerations(double t, std::span<const BodyState> states,
                                       std::span<Acceleration> out) {
  if (work_) ++work_->right_hand_sides;
  // A stage at the segment's end belongs to it: the forces after the jump would be those
  // of the next segment.
  const double inside = t < segment_end_ ? t : std::nextafter(segment_end_, time_);
  dynamics_->accelerations(inside, states, out);
  for (std::size_t k = 0; k < out.size(); ++k) {
    // a sum that is finite has no part that is not
    if (std::isfinite(out[k].linear.x() + out[k].linear.y() + out[k].angular) || is_finite(out[k])) continue;
    why_ = dynamics_->not_finite(inside, states);
    if (!why_.empty()) return false;
    why_ = "the acceleration of body " + std::to_string(k) +
           " of the component is not finite at t = " + time_text(inside) + ", position (" +
           time_text(states[k].pose.position.x()) + ", " + time_text(states[k].pose.position.y()) + ")";
    return false;
  }
  return true;
}

/// The step to t is made: its end states become the present ones. Where a piece has left out what the clock rounded
/// (dense_output.cpp), the next goes on from where it ended: pieces meet to the rounding of the place.
bool SteppingIntegrator::accept(double t, std::span<const BodyState> states) {
  states_.assign(states.begin(), states.end());
  for (int k = 0; k < size(); ++k) {
    const Pose met = tracks_[k]->pieces.back().state(t).pose;
    Pose& pose = states_[k].pose;
    for (int i = 0; i < 2; ++i)
      if (!is_rounding_of(met.position[i], pose.position[i])) pose.position[i] = met.position[i];
    if (!is_rounding_of(met.angle, pose.angle)) pose.angle = met.angle;
  }
  time_ = t;
  if (work_) ++work_->solver_steps;
  // at a break the method starts afresh with the next step
  if (time_ >= segment_end_) in_segment_ = false;
  return true;
}

/// Lasting until start(). False, for callers to return.
bool SteppingIntegrator::fail(std::string why) {
  failure_ = "integration stopped at t = " + time_text(time_) + ": " + std::move(why);
  return false;
}

}  // namespace brink
