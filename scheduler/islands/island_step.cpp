#include "brink/scheduler/islands/island_step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "brink/core/contacts/coulomb_sweeps.h"
#include "brink/scheduler/islands/step_balance.h"
#include "brink/scheduler/islands/tolerances.h"

namespace brink {

namespace {

constexpr int kLooks = 8;         ///< along a step
constexpr int kBetween = 4;       ///< parts of what lies between two looks, where a corner may be
constexpr int kSections = 24;     ///< golden sections until a corner is found there: to 1e-5 of a part
constexpr double kSags = 0.125;   ///< of its bend what is smooth sags between two looks at most
constexpr int kCorrections = 12;  ///< of gaps that were missed
/// What is left of a miss is not taken to be more than this part of it the next time.
constexpr double kFallsAtMost = 0.5;
/// After so many of them friction is kept: what sweeps leave unsolved would change gaps by more than is left to correct. After
/// a few where that is little beside the way that forces make of rest in the step, so that what the last lifts push is so, too.
constexpr int kFrictionAnew = 1, kFrictionAtMost = 6;
constexpr double kLittleLeft = 1e-2;
/// Where so many times as much is missed, or is sure to be, the search for the step ends early: with products of forces and speeds
/// (StepSearch) that leave velocities off by less than that. What is kept goes to `kFinest`, so that heaps come to rest; those on
/// a site that moves do not.
constexpr double kFarMissed = 100.0, kCoarse = 1e-8, kFine = 1e-12, kFinest = 1e-16;
/// In an island of few members so many solves more take friction bounds from the forces of the one before.
constexpr int kFrictionPasses = 2;
/// In any other friction comes of sweeps: a hundred go on well enough from the step before, an impact takes more.
constexpr int kFewestSweeps = 100, kMostSweeps = 1000;

/// A contact that takes part in the step.
struct Part {
  std::size_t contact;
  double lift = 0.0;     ///< how much higher than its gap it aims [m]
  ContactLoad expected;  ///< impulses, as the solve before has found them
  double missed = 0.0;   ///< by what it was lifted last [m]
};

/// The impulses, if the forces go on as they were. A step before that was shorter than this one counts with its own impulse
/// alone: where it took an impact, its mean force is as large as it was short.
ContactLoad from_step_before(const IslandContact& c, double h) {
  const double lasts = std::min(h, c.force_lasted);
  return {c.normal_force * lasts, c.tangential_force * lasts, 0.0};
}

/// Misses fall by about the same part each time: so far as that leads.
void lift(Part& part, double by) {
  const double falls_to = part.missed > 0.0 ? std::min(by / part.missed, kFallsAtMost) : 0.0;
  part.missed = by;
  part.lift += by / (1.0 - falls_to);
}

/// How far the part's gap comes to lie above its aim at the end of the step, where its site moves, >= 0 [m]: on the way the
/// site may come nearer than there, and no small lift shows then.
double above_aim(const IslandStep& step, const Part& part, double h, const std::vector<Vec3>& velocity) {
  const IslandContact& c = step.contacts[part.contact];
  if (!c.driven) return 0.0;
  const double opens = c.rows.normal_on_body.dot(velocity[c.rows.body]) - c.normal_support;
  return std::max(0.0, std::max(c.gap, 0.0) + h * opens - part.lift);
}

/// The problem of one solve: the contacts that take part, and what is expected of them.
StepProblem problem_of(const IslandStep& step, double h, const std::vector<Part>& parts) {
  StepProblem p;
  p.duration = h;
  p.mass = step.mass;
  p.velocity = step.velocity;
  p.force = step.force;
  p.contacts.reserve(parts.size());
  for (const Part& part : parts) {
    const IslandContact& c = step.contacts[part.contact];
    StepContact s;
    s.contact = c.rows;
    s.contact.friction = c.friction;
    s.contact.rolling_resistance = c.rolling_resistance;
    // A gap below zero by a rounding must not be opened within the step: that takes a speed of gap / h,
    // and the energy of it. Only what a look along the step has missed is made up for.
    s.gap = std::max(c.gap, 0.0) - part.lift;
    s.expected = part.expected;
    s.support_velocity = Vec3(c.normal_support, c.tangential_support, 0.0);
    p.contacts.push_back(s);
  }
  return p;
}

/// What a solve tells of the step.
struct Solved {
  StepResult result;               ///< twists, and the impulses that make them
  std::vector<ContactLoad> loads;  ///< by Coulomb's law, of all that take part
  double residual = 0.0;           ///< what these leave unexplained, or are beyond their cones [N s]
};

/// Impulses beyond the cones of friction, at most [N s].
double beyond_cones(const StepProblem& p, const std::vector<ContactLoad>& loads) {
  double beyond = 0.0;
  for (std::size_t k = 0; k < loads.size(); ++k)
    beyond =
        std::max(beyond, std::abs(loads[k].tangential) - p.contacts[k].contact.friction * loads[k].normal);
  return beyond;
}

/// Of a few members: begins with the bounds of the step before and ends with those of its own forces (Haslinger 1983).
Solved solve_few(ConeQp& solver, StepProblem p, int& factorisations, const GoOn& go_on) {
  for (StepContact& s : p.contacts) {
    s.friction_bound = s.contact.friction * s.expected.normal;
    s.rolling_bound = s.contact.rolling_resistance * s.expected.normal;
  }
  Solved solved;
  for (int pass = 0; pass <= kFrictionPasses; ++pass) {
    solved.result = solver.step(p, go_on);
    factorisations += solved.result.factorisations;
    if (solved.result.status == StepResult::Status::stopped || !(solved.result.residual <= kResidual)) break;
    double most = 0.0, wrong = 0.0;
    for (std::size_t k = 0; k < p.contacts.size(); ++k) {
      StepContact& s = p.contacts[k];
      s.expected = solved.result.loads[k];
      const double bound = s.contact.friction * s.expected.normal,
                   rolling = s.contact.rolling_resistance * s.expected.normal;
      most = std::max(most, s.expected.normal);
      if (bound > 0.0) wrong = std::max(wrong, std::abs(s.friction_bound - bound) / s.contact.friction);
      if (rolling > 0.0)
        wrong = std::max(wrong, std::abs(s.rolling_bound - rolling) / s.contact.rolling_resistance);
      s.friction_bound = bound;
      s.rolling_bound = rolling;
    }
    if (wrong <= kFrictionExact * most) break;
  }
  solved.loads = solved.result.loads;
  solved.residual = beyond_cones(p, solved.loads);
  return solved;
}

/// The speed that the forces alone make of rest in so long, of the body that they pull most [m/s].
double falling_speed(const std::vector<Vec3>& force, const std::vector<Vec3>& mass, double h) {
  double most = 0.0;
  for (std::size_t i = 0; i < mass.size(); ++i)
    most = std::max(most, force[i].cwiseQuotient(mass[i]).head<2>().norm());
  return h * most;
}

/// True if a site that moves pushes: an island on one does not come to rest.
bool is_driven(const IslandStep& step) {
  return std::any_of(step.contacts.begin(), step.contacts.end(),
                     [](const IslandContact& c) { return c.driven && c.normal_force > 0.0; });
}

/// Of many: friction as sweeps find it, gaps as the convex problem with that friction keeps them. Every contact is held
/// within the bounds of its normal force from the sweeps; what slips has its friction at the bound. Which of the normal
/// forces of a heap carry it is not unique, so those of the sweeps are told, which obey Coulomb's law.
class SweptFriction {
 public:
  SweptFriction(StepProblem given, const GoOn& go_on)
      : coulomb_(sweep_by_coulomb(given, kFewestSweeps, kMostSweeps, go_on).loads),
        problem_(std::move(given)) {
    for (std::size_t k = 0; k < problem_.contacts.size(); ++k) {
      StepContact& s = problem_.contacts[k];
      s.expected = coulomb_[k];
      s.friction_bound = s.contact.friction * s.expected.normal;
      s.rolling_bound = s.contact.rolling_resistance * s.expected.normal;
    }
  }

  /// The same friction, and the gaps of another problem of the same contacts.
  void take_gaps(const StepProblem& other) {
    for (std::size_t k = 0; k < problem_.contacts.size(); ++k)
      problem_.contacts[k].gap = other.contacts[k].gap;
  }

  /// See StepSearch: the solver's last problem was this one with other gaps, friction that was swept for them, and perhaps without
  /// the last contacts.
  Solved solve(ConeQp& solver, const StepSearch& search, int& factorisations, const GoOn& go_on) const {
    Solved solved;
    solved.result = solver.step(problem_, go_on, search);
    factorisations += solved.result.factorisations;
    if (solved.result.status == StepResult::Status::stopped || !(solved.result.residual <= kResidual))
      return solved;
    solved.loads = coulomb_;
    solved.residual = unexplained(problem_, solved.result.velocity, solved.loads);
    return solved;
  }

 private:
  std::vector<ContactLoad> coulomb_;
  StepProblem problem_;
};

/// `swept`: the friction of many, kept where `keep` says so, of the solve before this one. Of few that go without it nothing
/// is kept: contacts may have joined since. `product`: of many, how far the search is to go (StepSearch).
Solved solve(ConeQp& solver, const StepProblem& p, std::optional<SweptFriction>& swept, bool keep,
             double product, int& factorisations, const GoOn& go_on) {
  const bool few = p.mass.size() <= kFewMembers;
  if (few) {
    Solved solved = solve_few(solver, p, factorisations, go_on);
    double most = 0.0;
    for (const ContactLoad& load : solved.loads) most = std::max(most, load.normal);
    // where bounds and forces go round in a circle, sweeps do not
    if (solved.result.status == StepResult::Status::stopped || solved.residual <= kFrictionNear * most) {
      swept.reset();
      return solved;
    }
  }
  const bool again = swept.has_value();
  if (keep && again)
    swept->take_gaps(p);
  else
    swept.emplace(p, go_on);
  // the solver's last problem is that of the few, where they are
  const auto from = again && !few ? StepSearch::From::halfway : StepSearch::From::nothing;
  return swept->solve(solver, {from, product}, factorisations, go_on);
}

/// How a gap is missed along the step [m]; 0: not at all.
struct Miss {
  double most = 0.0;
  double lift = 0.0;  ///< how much higher the contact must aim for the step's end, not to miss it
  bool counts = false,
       too_much = false;  ///< by more than kMissCounts of the contact's tolerance, or all of it
};

/// Where a parabola through three looks, one apart, is lowest, from the middle one; 0: at none between them.
/// With x from the middle look the parabola is here + (after - before) x / 2 + bend x^2 / 2.
double lowest(double before, double here, double after) {
  const double bend = before - 2.0 * here + after, at = 0.5 * (before - after) / bend;
  return bend > 0.0 && std::abs(at) < 1.0 ? at : 0.0;
}

/// The least of a gap between two looks, one apart, at which it is `first` and `last` [m]: where a sample comes to the
/// end of a site between the two, the gap falls to there and rises behind it, with a corner in it. Golden sections
/// (Kiefer 1953) about the lowest of some looks between; each look notes the miss.
template <class Look>
void look_for_corner(double from, double first, double last, Look&& look) {
  std::array<double, kBetween + 1> seen;
  int lowest = 1;
  for (int n = 0; n <= kBetween; ++n) {
    const bool known = n == 0 || n == kBetween;
    seen[n] = known ? (n == 0 ? first : last) : look(from + static_cast<double>(n) / kBetween);
    if (!known && seen[n] < seen[lowest]) lowest = n;
  }
  // Both sides of a corner fall no more steeply than between the looks beside it: not to below from so high.
  const double falls = std::max(seen[lowest - 1], seen[lowest + 1]) - seen[lowest];
  if (seen[lowest] > falls) return;
  constexpr double ratio = 0.6180339887498949;
  double low = from + (lowest - 1.0) / kBetween, high = from + (lowest + 1.0) / kBetween;
  double x = high - ratio * (high - low), y = low + ratio * (high - low), at_x = look(x), at_y = look(y);
  for (int n = 0; n < kSections; ++n) {
    if (at_x < at_y) {
      high = y;
      y = x;
      at_y = at_x;
      at_x = look(x = high - ratio * (high - low));
    } else {
      low = x;
      x = y;
      at_x = at_y;
      at_y = look(y = low + ratio * (high - low));
    }
  }
}

/// A corner by which the slope changes by s a look, a part x of the way from one look to the next, adds s (1 - x) to the bend (the
/// second difference) at the first of the two and s x at the second, and goes below the line between them by s x (1 - x). What
/// has no corner bends at either of the two as it has begun to on that side of them, but for a fourth difference. So: how the gap
/// bends there without a corner, and what there is more, which is no less than a corner between looks i and i + 1 goes
/// below. @pre at least seven looks
std::pair<double, double> corner_after(const std::array<double, kLooks + 1>& bends, int i) {
  // bends are known of all looks but the first and the last
  const bool behind = i < kLooks / 2;
  const int at = behind ? i + 1 : i, on = behind ? 1 : -1;
  const double goes_on = 2.0 * bends[at + on] - bends[at + 2 * on];
  return {goes_on, std::abs(bends[at] - goes_on)};
}

/// How far a convex gap comes to lie below its tangent within the step, at most [m].
///
/// In the frame of the site's owner, which turns by w_s, the sample is at p = R_s^T q, with q = x - x_s + R r, and
/// |p''| <= w^2 |r| + 2 |w_s| |q'| + w_s^2 |q|. A distance changes by no more than the place, so a convex one has a second
/// derivative of at least -|p''|. About a site that is round w_s counts as 0, in a frame that does not turn.
double falls_below_tangent(const IslandContact& c, double h, const std::vector<Vec3>& velocity) {
  const Vec3 of_body = velocity[c.rows.body],
             of_other = c.rows.other < 0 ? Vec3(Vec3::Zero()) : velocity[c.rows.other];
  const Vec3 &of_sample = c.sample_on_body ? of_body : of_other,
             &of_site = c.sample_on_body ? of_other : of_body;
  const double turns = std::abs(of_sample[2]), site_turns = c.round_site ? 0.0 : std::abs(of_site[2]);
  const double speed = (of_sample - of_site).head<2>().norm() + turns * c.arm;
  const double bends =
      turns * turns * c.arm + 2.0 * site_turns * speed + site_turns * site_turns * (c.apart + h * speed);
  return 0.5 * h * h * bends;
}

/// True of a gap that cannot be missed: along the tangent it stays open by more than it can fall below it.
bool stays_open(const IslandContact& c, double h, const std::vector<Vec3>& velocity) {
  if (!c.convex) return false;
  double opens = c.rows.normal_on_body.dot(velocity[c.rows.body]);
  if (c.rows.other >= 0) opens += c.rows.normal_on_other.dot(velocity[c.rows.other]);
  // beside an end the tangent itself leads behind the site: nothing below it counts as open there
  const double low = c.at_end ? c.tolerance : -kMissCounts * c.tolerance;
  return c.gap >= low && c.gap + h * opens - falls_below_tangent(c, h, velocity) >= low;
}

/// True if a contact that has pressed turns by so much within the step that its gap may be missed by more than so much [m].
bool turns(const IslandStep& step, double h, double much) {
  return std::any_of(step.contacts.begin(), step.contacts.end(), [&](const IslandContact& c) {
    return c.normal_force > 0.0 && falls_below_tangent(c, h, step.velocity) > much;
  });
}

/// By looks along the step, and where parabolas through them dip in between. A miss that does not count may be told as
/// none. `cheap`: a lift that costs little in this step [m]; what was below 0 before is not lifted by more.
Miss missed(const IslandStep& step, std::size_t k, double h, const std::vector<Vec3>& velocity, double cheap,
            bool rise, const GapAlong& gap) {
  Miss miss;
  if (stays_open(step.contacts[k], h, velocity)) return miss;
  const IslandContact& contact = step.contacts[k];
  const double tolerance = contact.tolerance;
  std::array<double, kLooks + 1> seen;
  const double start = gap(k, 0.0);
  // What the scene lets overlap may stay as deep as it is; what begins at a wire, as near as that, rises along the step if
  // that costs little.
  const double kept = start < -tolerance ? start : 0.0;
  const bool rises = rise && contact.thin && -kept <= cheap;
  const auto look = [&](double at) {
    const double part = at / kLooks, floor = rises ? (1.0 - part) * kept : kept;
    const double there = gap(k, h * part) - floor;
    miss.most = std::max(miss.most, -there);
    // A contact aims for a gap at the end of the step; with constant twists a part of the way has that
    // part of the lift. The least part keeps a miss close to the start from asking for a lift without
    // bound.
    const double own = std::min(start - kept, 0.0) - there, beyond = -there - kLeftBelow * tolerance;
    const double lift = std::min(-there, std::max({own, beyond, cheap}));
    miss.lift = std::max(miss.lift, lift / std::max(part, 0.5 / kLooks));
    return there;
  };
  // the gap at the start is what it is: no velocity changes it, and it counts as no miss
  for (int i = 0; i <= kLooks; ++i) seen[i] = i == 0 ? start - kept : look(i);
  const auto bend = [&](int i) {
    return i > 0 && i < kLooks ? seen[i - 1] - 2.0 * seen[i] + seen[i + 1] : 0.0;
  };
  // From three looks a parabola dips by half of its bend at most.
  for (int i = 1; i < kLooks; ++i)
    if (bend(i) > std::max(seen[i], kNoDip * tolerance))
      if (const double at = lowest(seen[i - 1], seen[i], seen[i + 1]); at != 0.0) look(i + at);
  // Between two looks there may be a corner that goes below by more than counts.
  std::array<double, kLooks + 1> bends;
  for (int i = 0; i <= kLooks; ++i) bends[i] = bend(i);
  for (int i = 0; i < kLooks; ++i) {
    const auto [goes_on, corner] = corner_after(bends, i);
    if (corner > kMissCounts * tolerance &&
        std::min(seen[i], seen[i + 1]) < corner + kSags * std::abs(goes_on))
      look_for_corner(i, seen[i], seen[i + 1], look);
  }
  miss.counts = miss.most > kMissCounts * tolerance;
  miss.too_much = miss.most > tolerance;
  return miss;
}

/// The loads of those that took part, at their contacts' places.
/// All others carry none.
std::vector<ContactLoad> of_all(const std::vector<ContactLoad>& loads, const std::vector<Part>& parts,
                                std::size_t contacts) {
  std::vector<ContactLoad> all(contacts);
  for (std::size_t k = 0; k < parts.size(); ++k) all[parts[k].contact] = loads[k];
  return all;
}

/// The contacts that take part, with what they give.
std::vector<PushingContact> pushing(const std::vector<Part>& parts, const StepResult& result) {
  std::vector<PushingContact> all;
  for (std::size_t k = 0; k < parts.size(); ++k)
    all.push_back({parts[k].contact, parts[k].lift, result.loads[k]});
  return all;
}

/// The first contact of two that were not slowed alike, and that is missed by more than its tolerance: of one who was with one who was
/// not, or who was in another group, or with a site where a group had something in common; or of two who turn about each other as
/// before.
std::optional<std::size_t> missed_by_slowing(const IslandStep& step, double h,
                                             const std::vector<Vec3>& velocity,
                                             const std::vector<int>& groups,
                                             const StepBalance::Slowed& slowed, const GapsAlong& gaps) {
  const GapAlong gap = gaps(velocity);
  const auto was_slowed = [&](int body) { return groups[body] >= 0 && slowed.groups[groups[body]]; };
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const LastingContact& rows = step.contacts[k].rows;
    const bool of_body = was_slowed(rows.body);
    const bool turns = of_body && slowed.turns[groups[rows.body]];
    const bool alike = rows.other < 0
                           ? !of_body || slowed.common[groups[rows.body]].isZero(0.0)
                           : groups[rows.body] == groups[rows.other] || (!of_body && !was_slowed(rows.other));
    if ((turns || !alike) && missed(step, k, h, velocity, 0.0, false, gap).too_much) return k;
  }
  return std::nullopt;
}

/// What a step won is taken from its velocities again. Who does not go the same way, and is met by that, shares it; and where a site
/// is, which what bodies have in common leads past but where one ends or begins, all go slower as one.
void win_nothing(const IslandStep& step, double h, const GapsAlong& gaps, StepBalance& balance,
                 std::vector<Vec3>& velocity) {
  const std::vector<Vec3> as_solved = velocity;
  for (bool keep_turning = true;;) {
    velocity = as_solved;
    const StepBalance::Slowed slowed = balance.win_nothing(velocity, keep_turning);
    const auto k = missed_by_slowing(step, h, velocity, balance.groups(), slowed, gaps);
    if (!k) return;
    const LastingContact& rows = step.contacts[*k].rows;
    const bool in_one = rows.other >= 0 && balance.groups()[rows.body] == balance.groups()[rows.other];
    if (in_one && keep_turning) {
      keep_turning = false;
      continue;
    }
    if (rows.other < 0) break;
    balance.unite(rows.body, rows.other, as_solved);
  }
  velocity = as_solved;
  balance.win_nothing_together(velocity);
}

/// What is left of Coulomb's law, as a part of the largest normal or other force.
double residual(const IslandStep& step, const Solved& solved, double h) {
  double most = 0.0;
  for (const Vec3& f : step.force) most = std::max(most, h * f.head<2>().norm());
  for (const ContactLoad& load : solved.loads) most = std::max(most, load.normal);
  return most > 0.0 ? solved.residual / most : 0.0;
}

bool stops(const GoOn& go_on) { return go_on && !go_on(); }

/// The step on which nobody presses, which is the answer if no gap is missed. For what the solver does not come to:
/// contacts that part far slower than the step is long.
StepOutcome without_loads(IslandStep& step, double h, const GapsAlong& gaps, const GoOn& go_on,
                          const ListFarther& farther, StepOutcome outcome) {
  std::vector<Vec3> velocity = step.velocity;
  for (std::size_t i = 0; i < step.mass.size(); ++i)
    // what is held has an infinite mass: nothing is added to it
    velocity[i] += h * step.force[i].cwiseQuotient(step.mass[i]);
  if (!step.joined_to.empty()) {
    StepBalance balance(step, h, {}, velocity);
    win_nothing(step, h, gaps, balance, velocity);
  }
  if (farther) farther(velocity);
  const GapAlong gap = gaps(velocity);
  // all contacts are asked, those that wait for their turn, too
  for (std::size_t k = 0; k < step.contacts.size(); ++k)
    if (stops(go_on) || missed(step, k, h, velocity, 0.0, false, gap).counts) return outcome;
  step.velocity = std::move(velocity);
  for (IslandContact& c : step.contacts) {
    c.normal_force = c.tangential_force = 0.0;
    c.gives = {};
  }
  outcome.solved = true;
  return outcome;
}

/// One loop to two ends: a contact at an end joins once it is missed, and a gap that was missed aims higher. `rise`: thin
/// ones that begin below what they must keep do so.
StepOutcome take(ConeQp& solver, IslandStep& step, double h, double tolerance, bool rise,
                 const GapsAlong& gaps, const GoOn& go_on, const ListFarther& farther) {
  StepOutcome outcome;
  std::vector<Part> parts;
  std::vector<std::size_t> waiting;
  for (std::size_t k = 0; k < step.contacts.size(); ++k)
    if (step.contacts[k].at_end && !(step.contacts[k].normal_force > 0.0))
      waiting.push_back(k);
    else
      parts.push_back({k, 0.0, from_step_before(step.contacts[k], h), 0.0});
  // the way that the forces alone make of rest in the step [m]
  const double cheap = h * falling_speed(step.force, step.mass, h);
  std::optional<SweptFriction> swept;
  const bool many = step.mass.size() > kFewMembers;
  const double little = kLittleLeft * cheap;
  const double finest = many && is_driven(step) ? kFine : kFinest;
  bool joined = false, finish = false;
  bool coarse = many && turns(step, h, kFarMissed * little);
  double left = std::numeric_limits<double>::infinity();  // to correct [m]
  // Contacts that wait join once each and are not counted as corrections, so that the loop ends.
  for (int again = 0; again < kCorrections && !outcome.solved;) {
    const bool keep = !joined && again > (left <= little ? kFrictionAnew : kFrictionAtMost);
    const double product = coarse ? kCoarse : finest;
    Solved solved =
        finish
            ? swept->solve(solver, {StepSearch::From::end, product}, outcome.factorisations, go_on)
            : solve(solver, problem_of(step, h, parts), swept, keep, product, outcome.factorisations, go_on);
    finish = false;
    StepResult& result = solved.result;
    if (result.status == StepResult::Status::stopped) return outcome;
    outcome.no_room = !(result.residual <= kResidual);
    if (outcome.no_room) return without_loads(step, h, gaps, go_on, farther, outcome);
    const std::size_t listed = step.contacts.size();
    if (farther) farther(result.velocity);
    for (std::size_t k = listed; k < step.contacts.size(); ++k) waiting.push_back(k);
    for (std::size_t k = 0; k < parts.size(); ++k) parts[k].expected = solved.loads[k];
    const GapAlong gap = gaps(result.velocity);
    // those that are missed take part from now on: each comes once
    const auto met = std::stable_partition(waiting.begin(), waiting.end(), [&](std::size_t k) {
      if (stops(go_on)) return true;
      const Miss miss = missed(step, k, h, result.velocity, cheap, rise, gap);
      return !miss.counts || (coarse && miss.most <= little);
    });
    // solved again with them before any lift is asked for: without them the motion is another
    if (met != waiting.end()) {
      for (auto k = met; k != waiting.end(); ++k) parts.push_back({*k, 0.0, {}, 0.0});
      waiting.erase(met, waiting.end());
      joined = true;
      continue;
    }
    joined = false;
    double worst = 0.0;
    bool too_much = false;
    std::vector<double> more;  // lifts that one more solve would need
    for (const Part& part : parts) {
      if (stops(go_on)) return outcome;
      const Miss miss = missed(step, part.contact, h, result.velocity, cheap, rise, gap);
      worst = std::max(worst, miss.most);
      too_much = too_much || miss.too_much;
      // From a tenth of the tolerance on, though only a miss beyond the tolerance asks for that solve, which then
      // makes up for all of them.
      more.push_back(miss.counts ? kAimHigher * miss.lift : 0.0);
    }
    if (coarse && worst <= kFarMissed * little) {
      coarse = false;
      // what coarse velocities say of it is no more than that
      if (finish = worst <= little; finish) continue;
    }
    ++again;
    left = worst;
    if (too_much) {
      for (std::size_t k = 0; k < parts.size(); ++k) {
        const double above = above_aim(step, parts[k], h, result.velocity);
        if (more[k] > 0.0 && above > more[k]) parts[k].lift += above;
        lift(parts[k], more[k]);
      }
      continue;
    }
    StepBalance balance(step, h, pushing(parts, result), result.velocity);
    balance.keep_momentum(tolerance, result.velocity);
    double of = 0.0;
    const double won_here = balance.won(result.velocity, tolerance, of);
    // The caller tries a shorter step: by what faces that turn are missed is of second order in h.
    if (won_here > kWonOf * of) return without_loads(step, h, gaps, go_on, farther, outcome);
    // from here on loads stand at their contacts' places; won() took them at their parts'
    const std::vector<ContactLoad> loads = of_all(solved.loads, parts, step.contacts.size());
    const bool driven = std::any_of(parts.begin(), parts.end(),
                                    [&](const Part& part) { return step.contacts[part.contact].driven; });
    // Slower by one factor, constant twists lead through the same poses, only not as far: no gap is missed
    // that was not before. A site that moves by the clock would be elsewhere at those poses, so its steps
    // keep what they won, and tell it.
    if (!driven) win_nothing(step, h, gaps, balance, result.velocity);
    outcome.won = std::max(0.0, driven ? won_here : std::min(won_here, balance.rise_of_thin()));
    outcome.solved = true;
    outcome.friction_residual = residual(step, solved, h);
    step.velocity = result.velocity;
    for (std::size_t k = 0; k < step.contacts.size(); ++k) {
      // impulses over the step: told as mean forces
      step.contacts[k].normal_force = loads[k].normal / h;
      step.contacts[k].tangential_force = loads[k].tangential / h;
    }
    for (IslandContact& c : step.contacts) c.gives = {};
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const ContactLoad& load = result.loads[k];
      step.contacts[parts[k].contact].gives = {load.normal / h, load.tangential / h, load.rolling / h};
    }
  }
  return outcome;
}

}  // namespace

StepOutcome take_step(ConeQp& solver, IslandStep& step, double h, double tolerance, const GapsAlong& gaps,
                      const GoOn& go_on, const ListFarther& farther) {
  const auto any_thin = [&](auto&& is) {
    return std::any_of(step.contacts.begin(), step.contacts.end(),
                       [&](const IslandContact& c) { return c.thin && is(c); });
  };
  int before = 0;
  const auto attempt = [&](bool rise) {
    StepOutcome outcome = take(solver, step, h, tolerance, rise, gaps, go_on, farther);
    outcome.factorisations += before;
    before = outcome.factorisations;
    return outcome;
  };
  const bool rise = any_thin([](const IslandContact& c) { return c.gap < -c.tolerance; });
  StepOutcome outcome = attempt(rise);
  // what wires hold from both sides has nowhere to rise to
  if (!outcome.solved && rise && !stops(go_on)) outcome = attempt(false);
  // and right by a joint of wires, where another one of them is as near, no lift may reach a gap that is told so finely
  if (!outcome.solved && any_thin([](const IslandContact&) { return true; }) && !stops(go_on)) {
    for (IslandContact& c : step.contacts)
      if (c.thin) c.tolerance = std::max(c.tolerance, tolerance);
    outcome = attempt(false);
  }
  return outcome;
}

/// A question of forces alone: gaps and velocities are not looked at.
bool stays_at_rest(ConeQp& solver, IslandStep& step, const GoOn& go_on) {
  RestProblem p;
  p.mass = step.mass;
  p.force = step.force;
  for (const IslandContact& c : step.contacts) {
    p.contacts.push_back(c.rows);
    p.contacts.back().friction = c.friction;
    p.contacts.back().rolling_resistance = c.rolling_resistance;
  }
  const RestResult result = solver.rest_forces(p, go_on);
  if (result.status != RestResult::Status::rests) return false;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    step.contacts[k].normal_force = result.loads[k].normal;
    step.contacts[k].tangential_force = result.loads[k].tangential;
    step.contacts[k].gives = result.loads[k];
  }
  return true;
}

}  // namespace brink
