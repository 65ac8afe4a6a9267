#include "brink/scheduler/islands/modes/mode_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "brink/core/base/elementary.h"
#include "brink/integrators/dense_output.h"
#include "brink/scheduler/islands/tolerances.h"

namespace brink {

namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
/// Looks along a step: at its gaps, and at what may fail in it.
constexpr int kGapLooks = 8, kLooksAStep = 4;
/// kShortenings: each by a fifth at least, so that they lead to 2e-8 of the first step; what fails even
/// there is lost.
constexpr int kShortenings = 80, kClosings = 200, kApproaches = 8;
/// Changes of mode at one instant, beside a few for every contact.
constexpr int kChanges = 8, kChangesEach = 4;

/// What times near t are rounded to [s].
double ulp(double t) { return kEps * std::max(std::abs(t), std::numeric_limits<double>::min()); }

double slip_sign(MotionMode m) { return m == MotionMode::slip_plus ? 1.0 : -1.0; }

Acceleration as_acceleration(const Eigen::VectorXd& a, int k) { return {a.segment<2>(3 * k), a[3 * k + 2]}; }

/// Of all bodies, on the dense output of one step.
std::vector<BodyState> states_of(const std::vector<PolynomialPiece>& pieces, double t) {
  std::vector<BodyState> states;
  for (const PolynomialPiece& p : pieces) states.push_back(p.state(t));
  return states;
}

}  // namespace

ModeMotion::ModeMotion(const ModeProblem& problem, const ModeLimits& limits, double t,
                       std::vector<BodyState> states)
    : problem_(problem),
      limits_(limits),
      t_(t),
      states_(std::move(states)),
      modes_(problem.contacts.size(), MotionMode::open),
      size_(problem.size) {
  set_scales();
  h_ = limits_.longest;
}

/// Of any point, and what a fall through the size gives.
void ModeMotion::set_scales() {
  std::vector<Acceleration> free(states_.size());
  problem_.free(t_, states_, free);
  double speed = 0.0, pull = 0.0;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    speed = std::max(speed, states_[k].twist.velocity.norm() + size_ * std::abs(states_[k].twist.omega));
    pull = std::max(pull, free[k].linear.norm() + size_ * std::abs(free[k].angular));
  }
  // the last, so that there is something to measure by where nobody moves and nothing pulls
  speed_ = std::max({speed, std::sqrt(pull * size_), kLeastSpeed * size_});
}

bool ModeMotion::begin(const std::vector<bool>& closed) {
  const std::vector<ContactRates> rates = rates_at(problem_, t_, states_);
  std::vector<ContactKnown> known(closed.size(), ContactKnown::open);
  for (std::size_t k = 0; k < closed.size(); ++k) {
    if (!closed[k]) continue;
    // a slip that is no more than what ended bounces leave is none: it may stick
    const double slip = rates[k].tangential_velocity;
    known[k] = std::abs(slip) <= kNoSlipAtFirst * speed_ ? ContactKnown::still
               : slip > 0.0                              ? ContactKnown::slides_plus
                                                         : ContactKnown::slides_minus;
  }
  const ModeChoice choice = choose_modes(problem_, moment_at(problem_, t_, states_), known);
  return choice.found && begin_in(choice.modes);
}

bool ModeMotion::put_on_contacts() {
  auto on = projected(problem_, t_, states_, modes_);
  if (on) states_ = std::move(*on);
  return on.has_value();
}

/// The states are put onto the modes first: forces are those of the projected states.
bool ModeMotion::begin_in(const std::vector<MotionMode>& modes) {
  modes_ = modes;
  if (!put_on_contacts()) return false;
  forces_ = forces_in(problem_, moment_at(problem_, t_, states_, modes_), modes_);
  return forces_.consistent;
}

/// The difference of the two orders in units of the tolerance: places by the size, angles by a radian,
/// velocities by the speed.
double ModeMotion::error_of(const ModeTrial& trial) const {
  double most = 0.0;
  for (const BodyState& e : trial.error) {
    most = std::max({most, e.pose.position.norm() / size_, std::abs(e.pose.angle),
                     e.twist.velocity.norm() / speed_, std::abs(e.twist.omega) * size_ / speed_});
  }
  return trial.finite ? most / limits_.tolerance : std::numeric_limits<double>::infinity();
}

/// All rooms are numbers without unit, so that the least can be told: ways by the size, slips by the speed,
/// forces by the largest of them.
ModeMotion::Look ModeMotion::look_at(double t, const States& states) const {
  const ModeMoment m = moment_at(problem_, t, states, modes_);
  const ModeForces f = forces_in(problem_, m, modes_);
  Look look;
  const auto take = [&](Look::What what, std::size_t contact, double room) {
    if (room < look.room) look = {what, static_cast<int>(contact), room};
  };
  // forces that do not exist fail by as much as can be, and no contact more than another
  if (!f.consistent) look = {Look::What::force, -1, -1.0};
  for (std::size_t k = 0; k < modes_.size(); ++k) {
    if (!is_closed(modes_[k])) continue;
    take(Look::What::range, k, m.contacts[k].within / size_);
    if (is_slip(modes_[k]))
      take(Look::What::slip, k, slip_sign(modes_[k]) * m.contacts[k].tangential_velocity / speed_);
  }
  if (f.margin < look.room) look = {Look::What::force, f.worst, f.margin};
  return look;
}

/// The ends are on their gaps by projection; in between the quintic does not know of them.
bool ModeMotion::gaps_hold(const std::vector<PolynomialPiece>& pieces, double h) const {
  for (int i = 1; i < kGapLooks; ++i) {
    // of the quintic, as it will be told; the trial's own end is on its gaps already
    const double t = t_ + h * i / kGapLooks;
    const std::vector<ContactRates> rates = rates_at(problem_, t, states_of(pieces, t), modes_);
    for (std::size_t k = 0; k < modes_.size(); ++k)
      if (is_closed(modes_[k]) && !(std::abs(rates[k].gap - problem_.contacts[k].kept) <=
                                    std::min(limits_.gap_tolerance, problem_.contacts[k].off)))
        return false;
  }
  return true;
}

/// True if something fails in the step of h; `clear` is how far it holds, to rounding.
bool ModeMotion::fails_within(double h, const std::vector<PolynomialPiece>& pieces, double& clear,
                              Look& failed) const {
  std::array<double, kLooksAStep + 1> at{}, rooms{};  // of the start nothing is asked: it was chosen so
  const auto fails_at = [&](double ahead) {
    failed = look_at(t_ + ahead, states_of(pieces, t_ + ahead));
    return failed.room < 0.0;
  };
  for (int i = 1; i <= kLooksAStep; ++i) {
    at[i] = i == kLooksAStep ? h : h * i / kLooksAStep;
    clear = at[i - 1];
    if (fails_at(at[i])) {
      close_in(pieces, clear, at[i], rooms[i - 1], failed);
      return true;
    }
    rooms[i] = failed.room;
  }
  // what fails and holds again between two looks, as a slip that grazes 0, is looked for where a parabola has its lowest place
  if (rooms[1] < rooms[2]) rooms[0] = look_at(t_, states_).room;
  for (int i = 1; i < kLooksAStep; ++i) {
    const double fall = rooms[i - 1] - rooms[i], rise = rooms[i + 1] - rooms[i];
    if (!(fall > 0.0 && rise > 0.0)) continue;
    const double lowest = at[i] + 0.5 * (fall - rise) / (fall + rise) * (h / kLooksAStep);
    if (!fails_at(lowest)) continue;
    const int before = lowest < at[i] ? i - 1 : i;
    clear = at[before];
    close_in(pieces, clear, lowest, rooms[before], failed);
    return true;
  }
  clear = h;
  return false;
}

/// Regula falsi by the Illinois rule (Dowell & Jarratt 1971); every third time from what has failed alone, for rooms of
/// redundant contacts are known on that side only; and a halving now and then.
void ModeMotion::close_in(const std::vector<PolynomialPiece>& pieces, double& clear, double crossed,
                          double room, Look& failed) const {
  double below = failed.room, before = crossed, below_before = below;
  int side = 0;
  for (int n = 0; n < kClosings && crossed - clear > 2.0 * ulp(t_ + crossed); ++n) {
    double h = 0.5 * (clear + crossed);
    if (n % 3 == 0 && room > 0.0) h = clear + (crossed - clear) * (room / (room - below));
    // The secant through the last two that failed, taken a hundredth of the bracket's rest short of its
    // root, so that it falls on the clear side.
    if (n % 3 == 1 && below_before < below) {
      const double root = crossed + below * (before - crossed) / (below - below_before);
      h = root - 0.01 * (crossed - root);
    }
    if (!(h > clear && h < crossed)) h = 0.5 * (clear + crossed);
    if (!(h > clear && h < crossed)) break;
    const Look look = look_at(t_ + h, states_of(pieces, t_ + h));
    if (look.room < 0.0) {
      // Illinois: an end of the bracket that stays twice in a row counts half, else regula falsi moves one
      // end alone
      if (side < 0) room *= 0.5;
      side = -1;
      before = crossed, below_before = below;
      crossed = h, below = look.room, failed = look;
    } else {
      if (side > 0) below *= 0.5;
      side = 1;
      clear = h, room = look.room;
    }
  }
}

/// How long a step reaches to where the contact has closed to within rounding, near h.
double ModeMotion::arrive(double h, int contact) const {
  double reached = h;
  for (int n = 0; n < kApproaches; ++n) {
    // A step taken anew to h ends beside what the dense output of the longer one says, so Newton goes over
    // steps themselves.
    const auto there = after(h);
    if (!there) break;
    ContactRates r = rates_at(problem_, t_ + h, *there, problem_.contacts[contact]);
    r.gap -= problem_.contacts[contact].closes_at;
    if (r.gap >= 0.0) reached = h;
    if (r.gap >= 0.0 && r.gap <= limits_.touch) break;
    if (!(r.normal_velocity < 0.0)) break;
    // aims for the middle of what counts as touching: on the clear side of 0
    const double next = h + (r.gap - 0.5 * limits_.touch) / -r.normal_velocity;
    if (!(next > 0.0) || next == h) break;
    h = next;
  }
  return reached;
}

/// Quintics from the present states to those at `end`, with the accelerations of the present modes at both
/// ends: the motion's second derivative there is what the contact forces give.
std::vector<PolynomialPiece> ModeMotion::pieces_to(double end, const States& states) const {
  const ModeForces f = forces_in(problem_, moment_at(problem_, end, states, modes_), modes_, false);
  std::vector<PolynomialPiece> pieces;
  for (int k = 0; k < problem_.bodies(); ++k)
    pieces.push_back(quintic_piece(t_, states_[k], as_acceleration(forces_.acceleration, k), end, states[k],
                                   as_acceleration(f.acceleration, k)));
  return pieces;
}

void ModeMotion::accept(double end, States states) {
  // a step of next to no time does not count: modes that change into each other without end must run out
  if (end - t_ > kNoTime * limits_.longest) changes_ = 0;
  t_ = end;
  states_ = std::move(states);
  forces_ = forces_in(problem_, moment_at(problem_, t_, states_, modes_), modes_);
  set_scales();
}

/// What the choice of new modes may take for granted of each contact.
std::vector<ContactKnown> ModeMotion::known_now(const Look& failed) const {
  const std::vector<ContactRates> rates = rates_at(problem_, t_, states_, modes_);
  std::vector<ContactKnown> known(modes_.size(), ContactKnown::open);
  // Where one stops slipping its slip is 0 to the error of a step, and so is that of another contact of the same bodies.
  const double stopped =
      failed.what == Look::What::slip && failed.contact >= 0
          ? std::max(limits_.tolerance * speed_, 2.0 * std::abs(rates[failed.contact].tangential_velocity))
          : 0.0;
  const double no_slip = std::max(kNoSlip * speed_, stopped);
  for (std::size_t k = 0; k < modes_.size(); ++k) {
    if (!is_closed(modes_[k])) continue;
    // What stops slipping may stick or turn round, so its sign is open; what slips on keeps its sign. A
    // contact that is open stays open: it closes by an arrival.
    const bool ends = failed.what == Look::What::slip && failed.contact == static_cast<int>(k);
    known[k] = ContactKnown::still;
    if (is_slip(modes_[k]) && !ends && std::abs(rates[k].tangential_velocity) > no_slip)
      known[k] = slip_sign(modes_[k]) > 0.0 ? ContactKnown::slides_plus : ContactKnown::slides_minus;
  }
  return known;
}

/// Chooses modes anew where something has failed: from where the old ones would lead, a little ahead.
bool ModeMotion::change(const Look& failed) {
  if (++changes_ > kChanges + kChangesEach * static_cast<int>(modes_.size())) return false;
  std::vector<ContactKnown> known = known_now(failed);
  // Right where a force comes to 0 its contact may be open or closed, but for roundings. Where the old
  // modes would lead a little later the one that has failed is wrong beyond doubt.
  const double ahead = std::max(kAhead * h_, 64.0 * ulp(t_));
  const ModeTrial trial = try_step(problem_, modes_, t_, states_, ahead);
  if (!trial.finite) return false;
  const ModeMoment m = moment_at(problem_, t_ + ahead, trial.states, modes_);
  ModeChoice choice = choose_modes(problem_, m, known);
  // the same again would fail again at once: without the contact that failed
  if (choice.found && choice.modes == modes_ && failed.contact >= 0) {
    // it was closed, as only what is closed can fail
    known[failed.contact] = ContactKnown::open;
    choice = choose_modes(problem_, m, known);
  }
  if (!choice.found || choice.modes == modes_) return false;
  modes_ = choice.modes;
  if (!put_on_contacts()) return false;
  forces_ = forces_in(problem_, moment_at(problem_, t_, states_, modes_), modes_);
  return forces_.consistent;
}

/// A step that is accurate enough, from h_ on downwards; h <= 0: there is none.
double ModeMotion::find_step(double until, States& end, std::vector<PolynomialPiece>& pieces) {
  for (int n = 0; n < kShortenings; ++n) {
    // no rest of a rounding is left for a step of its own
    const bool last = until - t_ <= h_ * (1.0 + kSameEnd);
    const double h = last ? until - t_ : h_;
    if (!(t_ + h > t_)) return 0.0;
    const ModeTrial trial = try_step(problem_, modes_, t_, states_, h);
    const double error = error_of(trial);
    if (!(error <= 1.0)) {
      // the error of a step is of order h^5
      h_ = h * (std::isfinite(error) ? std::clamp(0.9 * power(error, -0.2), 0.1, 0.8) : 0.1);
      continue;
    }
    const auto on = projected(problem_, t_ + h, trial.states, modes_);
    if (on) pieces = pieces_to(last ? until : t_ + h, end = *on);
    if (!on || !gaps_hold(pieces, h)) {
      h_ = 0.5 * h;
      continue;
    }
    // a step that was cut to end at `until` says that a longer one would do, not that it should be as
    // short
    const double next = h * std::clamp(0.9 * power(std::max(error, kLeastError), -0.2), 0.2, 4.0);
    h_ = std::min(last ? std::max(h_, next) : next, limits_.longest);
    return h;
  }
  return 0.0;
}

/// The order matters: the longest accurate step; then what fails first on it, which may shorten it; then
/// what arrives first on what is left of it. Each time a step of its own is taken to the new end. Last the
/// modes are changed, at the state in which the step has ended.
ModeStep ModeMotion::step(double until) {
  ModeStep done;
  States end;
  const double h = find_step(until, end, done.pieces);
  if (!(h > 0.0)) return {ModeEnd::lost, -1, {}};
  double at = done.pieces.front().end, clear = h;
  Look failed;
  bool fails = fails_within(h, done.pieces, clear, failed);
  if (fails) at = t_ + clear;
  // beyond the end of the feature by more than a rounding of places, so that the next look finds it left
  if (fails && failed.what == Look::What::range) at = std::min(until, at + kBeyondEnd * size_ / speed_);
  // A step of its own to there, not the first part of the longer one: states and forces at its end are
  // those of the method, and its motion ends in them.
  bool lost = false;
  const auto end_at = [&](double time) {
    const auto there = after(time - t_);
    if (there)
      done.pieces = pieces_to(time, end = *there);
    else
      lost = true;
  };
  if (fails && at > t_) end_at(at);
  Arrival arrival;
  // on the motion that is taken; where something fails before, an arrival after it does not come to be
  if (at > t_) arrival = first_arrival(problem_, modes_, done.pieces, t_, at, limits_.touch);
  if (arrival.found) {
    at = std::min(at, t_ + arrive(arrival.time - t_, arrival.contact));
    if (at > t_) end_at(at);
  } else if (at > t_ && arrival.time < at) {
    // nobody knows what is open beyond: a step to there, and the next looks on
    fails = false;
    at = arrival.time;
    done.end = ModeEnd::hovers;
    if (at > t_) end_at(at);
  }
  if (lost) return {ModeEnd::lost, -1, {}};
  if (at > t_)
    accept(at, std::move(end));
  else
    done.pieces.clear();
  if (arrival.found) {
    done.end = ModeEnd::arrival;
    done.contact = arrival.contact;
  } else if (fails) {
    done.contact = failed.contact;
    if (failed.what == Look::What::range)
      done.end = ModeEnd::range;
    else
      done.end = change(failed) ? ModeEnd::change : ModeEnd::no_modes;
  }
  return done;
}

}  // namespace brink
