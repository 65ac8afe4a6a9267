// One implicit step with given friction bounds: answers by hand, the conditions that prove an answer checked
// from outside, and the complementarity problem solved another way.
#include <gtest/gtest.h>

#include "brink/core/base/random.h"
#include "brink/core/contacts/lcp.h"
#include "tests/support/lasting_contacts.h"

namespace brink::cone_qp_step_test {
namespace {

using testing::kGravity;
using Status = StepResult::Status;

/// Relative velocity at a contact: along normal, tangent, and in turning.
Vec3 relative(const StepContact& s, const std::vector<Vec3>& w) {
  const LastingContact& c = s.contact;
  Vec3 v(c.normal_on_body.dot(w[c.body]), c.tangent_on_body.dot(w[c.body]), w[c.body][2]);
  if (c.other >= 0) v[0] += c.normal_on_other.dot(w[c.other]);
  if (c.other >= 0) v[1] += c.tangent_on_other.dot(w[c.other]);
  if (c.other >= 0) v[2] -= w[c.other][2];
  return v - s.support_velocity;
}

void apply(const LastingContact& c, const ContactLoad& load, std::vector<Vec3>& to) {
  const Vec3 torque(0.0, 0.0, load.rolling);
  to[c.body] += load.normal * c.normal_on_body + load.tangential * c.tangent_on_body + torque;
  if (c.other >= 0)
    to[c.other] += load.normal * c.normal_on_other + load.tangential * c.tangent_on_other - torque;
}

/// |x| <= bound, and against y where y is not 0.
void expect_bounded(double x, double bound, double y, double precision, double speed_precision) {
  EXPECT_LE(std::abs(x), bound + precision);
  EXPECT_NEAR(x * y, -bound * std::abs(y),
              precision * std::max(std::abs(y), speed_precision) + bound * speed_precision);
}

/// The conditions of Karush, Kuhn and Tucker. Free coordinates only.
void expect_proved(const StepProblem& problem, const StepResult& result, double part = 1e-9) {
  ASSERT_EQ(result.status, Status::solved);
  const double h = problem.duration;
  double impulse = 0.0, speed = 0.0;
  for (std::size_t k = 0; k < problem.mass.size(); ++k) {
    impulse = std::max(impulse, h * problem.force[k].cwiseAbs().maxCoeff());
    speed = std::max(speed, h * problem.force[k].cwiseQuotient(problem.mass[k]).cwiseAbs().maxCoeff());
    for (const Vec3& v : {problem.velocity[k], result.velocity[k]})
      speed = std::max(speed, v.cwiseAbs().maxCoeff());
  }
  for (const StepContact& s : problem.contacts)
    speed = std::max(speed, s.support_velocity.cwiseAbs().maxCoeff());
  std::vector<Vec3> pushed(problem.mass.size(), Vec3::Zero());
  for (std::size_t k = 0; k < result.loads.size(); ++k) {
    apply(problem.contacts[k].contact, result.loads[k], pushed);
    impulse = std::max({impulse, result.loads[k].normal, std::abs(result.loads[k].tangential)});
  }
  for (std::size_t k = 0; k < problem.mass.size(); ++k)
    for (int c = 0; c < 3; ++c) {
      const double gained = result.velocity[k][c] - problem.velocity[k][c];
      if (std::isinf(problem.mass[k][c])) {
        EXPECT_EQ(gained, 0.0);
        continue;
      }
      EXPECT_NEAR(problem.mass[k][c] * gained, h * problem.force[k][c] + pushed[k][c], part * impulse)
          << "body " << k << ", coordinate " << c;
    }
  for (std::size_t k = 0; k < problem.contacts.size(); ++k) {
    const StepContact& s = problem.contacts[k];
    const Vec3 v = relative(s, result.velocity);
    const ContactLoad& load = result.loads[k];
    const double opening = s.gap / h + v[0];
    EXPECT_GE(load.normal, 0.0);
    EXPECT_GE(opening, -part * speed) << "contact " << k;
    EXPECT_NEAR(load.normal * opening, 0.0, part * impulse * speed) << "contact " << k;
    expect_bounded(load.tangential, s.friction_bound, v[1], part * impulse, part * speed);
    expect_bounded(load.rolling, s.rolling_bound, v[2], part * impulse, part * speed);
  }
}

/// Discs of radius 1/2 and mass 1 under gravity, at rest.
StepProblem discs(int n) {
  StepProblem problem;
  problem.duration = 0.01;
  for (int k = 0; k < n; ++k) {
    problem.mass.emplace_back(1.0, 1.0, 0.125);
    problem.velocity.emplace_back(0.0, 0.0, 0.0);
    problem.force.emplace_back(0.0, -kGravity, 0.0);
  }
  return problem;
}

StepContact on_floor(int body, double friction_bound) {
  StepContact s;
  s.contact = contact_at(body, -1, {0.0, 1.0}, {0.0, -0.5}, {0.0, 0.0});
  s.friction_bound = friction_bound;
  return s;
}

TEST(Step, FallsFreelyWithoutContacts) {
  StepProblem problem = discs(1);
  problem.velocity[0] = {1.0, 2.0, 3.0};
  const StepResult result = ConeQp().step(problem);
  expect_proved(problem, result, 1e-15);
  EXPECT_NEAR(result.velocity[0].y(), 2.0 - 0.01 * kGravity, 1e-15);
}

// It falls as far as the gap lets it, and no farther.
TEST(Step, FallEndsAtTheGap) {
  StepProblem problem = discs(1);
  problem.contacts = {on_floor(0, 0.0)};
  for (const double gap : {0.0, 1e-4, 1e-2}) {
    problem.contacts[0].gap = gap;
    const StepResult result = ConeQp().step(problem);
    expect_proved(problem, result);
    EXPECT_NEAR(result.velocity[0].y(), -std::min(gap / 0.01, 0.01 * kGravity), 1e-14);
  }
}

// A disc that slides at 1 m/s with a bound b loses b / m and gains b r / I; with a large one it rolls, at 2/3.
TEST(Step, FrictionSlowsASlidingDiscUntilItRolls) {
  StepProblem problem = discs(1);
  problem.velocity[0].x() = 1.0;
  problem.contacts = {on_floor(0, 0.05)};
  StepResult result = ConeQp().step(problem);
  expect_proved(problem, result);
  EXPECT_NEAR(result.velocity[0].x(), 0.95, 1e-12);
  EXPECT_NEAR(result.velocity[0][2], -0.05 * 0.5 / 0.125, 1e-11);
  EXPECT_NEAR(result.loads[0].tangential, 0.05, 1e-12);  // along -x: the normal turned by +90 degrees
  problem.contacts[0].friction_bound = 1.0;
  result = ConeQp().step(problem);
  expect_proved(problem, result);
  EXPECT_NEAR(result.velocity[0].x(), 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(result.velocity[0][2], -4.0 / 3.0, 1e-11);
}

TEST(Step, RollingBoundSlowsTurning) {
  StepProblem problem = discs(1);
  problem.velocity[0][2] = 1.0;
  problem.contacts = {on_floor(0, 0.0)};
  problem.contacts[0].rolling_bound = 0.025;
  StepResult result = ConeQp().step(problem);
  expect_proved(problem, result);
  EXPECT_NEAR(result.velocity[0][2], 0.8, 1e-12);
  problem.contacts[0].rolling_bound = 0.5;
  result = ConeQp().step(problem);
  expect_proved(problem, result);
  EXPECT_NEAR(result.velocity[0][2], 0.0, 1e-12);
  EXPECT_NEAR(result.loads[0].rolling, -0.125, 1e-12);
}

// A belt at 2 m/s that rises at 1 m/s carries a box along by its bound, and up.
TEST(Step, SupportThatMovesCarriesAlong) {
  StepProblem problem = discs(1);
  problem.mass[0][2] = std::numeric_limits<double>::infinity();
  problem.contacts = {on_floor(0, 0.05)};
  problem.contacts[0].support_velocity = {1.0, -2.0, 0.0};  // the tangent is -x
  const StepResult result = ConeQp().step(problem);
  expect_proved(problem, result);
  EXPECT_NEAR(result.velocity[0].x(), 0.05, 1e-12);
  EXPECT_NEAR(result.velocity[0].y(), 1.0, 1e-12);
}

// One disc at 1 m/s into a row of others that touch: without restitution all go on together.
TEST(Step, RowShareItsMomentum) {
  StepProblem problem = discs(5);
  for (Vec3& f : problem.force) f.setZero();
  problem.velocity[0].x() = 1.0;
  for (int k = 1; k < 5; ++k) {
    StepContact s;
    s.contact = contact_at(k, k - 1, {1.0, 0.0}, {-0.5, 0.0}, {0.5, 0.0});
    problem.contacts.push_back(s);
  }
  const StepResult result = ConeQp().step(problem);
  expect_proved(problem, result);
  for (const Vec3& w : result.velocity) EXPECT_NEAR(w.x(), 0.2, 1e-12);
}

TEST(Step, LockedCoordinateKeepsItsVelocity) {
  StepProblem problem = discs(2);
  problem.mass[0].y() = std::numeric_limits<double>::infinity();
  problem.velocity[0] = {0.0, 0.5, 0.0};
  StepContact s;
  s.contact = contact_at(1, 0, {0.0, 1.0}, {0.0, -0.5}, {0.0, 0.5});
  problem.contacts = {s};
  const StepResult result = ConeQp().step(problem);
  expect_proved(problem, result);
  EXPECT_EQ(result.velocity[0].y(), 0.5);
  EXPECT_NEAR(result.velocity[1].y(), 0.5, 1e-12);
}

TEST(Step, ContactsTenTimesGivenChangeNothing) {
  StepProblem problem = testing::heap_step(6, 5, 1e-3, 0.5, 1.0 / 120);
  const StepResult single = ConeQp().step(problem);
  const auto once = problem.contacts;
  for (StepContact& s : problem.contacts) s.friction_bound /= 10;
  const auto tenth = problem.contacts;
  for (int k = 1; k < 10; ++k) problem.contacts.insert(problem.contacts.end(), tenth.begin(), tenth.end());
  const StepResult result = ConeQp().step(problem);
  expect_proved(problem, result);
  for (std::size_t k = 0; k < single.velocity.size(); ++k)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(result.velocity[k][c], single.velocity[k][c], 1e-8);
}

// Squeezed between two supports that come closer: there is no answer, and none is claimed.
TEST(Step, SqueezedBodyIsUndecided) {
  StepProblem problem = discs(1);
  problem.contacts = {on_floor(0, 0.0), on_floor(0, 0.0)};
  problem.contacts[1].contact = contact_at(0, -1, {0.0, -1.0}, {0.0, 0.5}, {0.0, 0.0});
  problem.contacts[0].support_velocity[0] = problem.contacts[1].support_velocity[0] = 1.0;
  EXPECT_EQ(ConeQp().step(problem).status, Status::undecided);
}

// What fits between two supports to a rounding may be pressed by both as much as one likes: the step before may have been told
// forces of any size, and friction bounds come of them.
TEST(Step, ForcesBeyondMeasureOfTheStepBeforeDoNotHinder) {
  for (const double told : {1e2, 1e6, 1e10, 1e12, 1e14}) {
    StepProblem problem = discs(3);
    problem.contacts = {on_floor(0, 0.0), on_floor(0, 0.0), on_floor(1, 0.1), on_floor(2, 0.1)};
    problem.contacts[1].contact = contact_at(0, -1, {0.0, -1.0}, {0.0, 0.5}, {0.0, 0.0});
    problem.contacts[2].contact = contact_at(1, 0, {1.0, 0.0}, {-0.5, 0.0}, {0.5, 0.0});
    problem.contacts[0].gap = 1.1e-12;
    problem.contacts[1].gap = -1.2e-12;
    for (StepContact& s : problem.contacts) {
      s.expected.normal = told;
      s.friction_bound = 0.5 * told;
    }
    const StepResult result = ConeQp().step(problem);
    EXPECT_LE(result.residual, 1e-6) << told;  // as islands ask for
    EXPECT_NEAR(result.velocity[0].y(), 0.0, 1e-8);
  }
}

// A hexagonal lattice has twice as many rows as it needs; touching, near to it, and apart.
TEST(Step, HeapOfDiscsIsProved) {
  for (const double apart : {0.0, 1e-6, 1e-3, 3e-2})
    for (const int n : {3, 8, 15}) {
      SCOPED_TRACE(::testing::Message() << n << " wide, " << apart << " apart");
      const StepProblem problem = testing::heap_step(n, n, apart, 0.5, 1.0 / 120);
      const StepResult result = ConeQp().step(problem);
      expect_proved(problem, result);
      EXPECT_LE(result.factorisations, 30);
    }
}

// Units of powers of two are taken out first: an island of grains and one of mountains get the same bits.
TEST(Step, UnitsOfMassAndTimeChangeNoBit) {
  const StepProblem problem = testing::heap_step(6, 5, 1e-3, 0.5, 1.0 / 128);
  StepProblem other = problem;  // masses times 2^30, times times 2^-7, at the same lengths
  const double mass = std::exp2(30), rate = std::exp2(7);
  other.duration /= rate;
  for (Vec3& m : other.mass) m *= mass;
  for (Vec3& f : other.force) f *= mass * rate * rate;
  for (StepContact& s : other.contacts) s.friction_bound *= mass * rate;
  const StepResult result = ConeQp().step(problem), scaled = ConeQp().step(other);
  ASSERT_EQ(result.status, Status::solved);
  for (std::size_t k = 0; k < result.velocity.size(); ++k)
    for (int c = 0; c < 3; ++c) EXPECT_EQ(scaled.velocity[k][c], result.velocity[k][c] * rate);
  for (std::size_t k = 0; k < result.loads.size(); ++k)
    EXPECT_EQ(scaled.loads[k].normal, result.loads[k].normal * mass * rate);
}

// Stopped anywhere, in the look at its graph or in a factor, it says so, and knows nothing wrong afterwards.
TEST(Step, StopsWhereItIsAsked) {
  const StepProblem problem = testing::heap_step(5, 4, 1e-3, 0.5, 1.0 / 128);
  const StepResult fresh = ConeQp().step(problem);
  for (int after = 0; after < 100; after += 7) {
    ConeQp solver;
    int asked = 0;
    const StepResult stopped = solver.step(problem, [&] { return asked++ < after; });
    EXPECT_EQ(stopped.status, Status::stopped);
    EXPECT_EQ(asked, after + 1);
    EXPECT_EQ(stopped.velocity.size(), problem.mass.size());
    EXPECT_EQ(stopped.loads.size(), problem.contacts.size());
    const StepResult again = solver.step(problem);
    EXPECT_EQ(again.status, fresh.status);
    for (std::size_t c = 0; c < fresh.loads.size(); ++c)
      EXPECT_EQ(again.loads[c].normal, fresh.loads[c].normal);
  }
}

TEST(Step, NotANumberIsNeverSolved) {
  StepProblem problem = discs(2);
  problem.contacts = {on_floor(0, 0.1), on_floor(1, 0.1)};
  problem.velocity[1].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ConeQp().step(problem).status, Status::undecided);
}

/// Bodies and contacts that mean nothing: any matrix will do.
StepProblem random_problem(Random& random, bool friction) {
  StepProblem problem;
  problem.duration = std::exp2(random.uniform(-10, 0));
  const int bodies = 1 + static_cast<int>(random.below(8)), contacts = static_cast<int>(random.below(16));
  const auto vec = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  for (int k = 0; k < bodies; ++k) {
    const double mass = std::exp2(random.uniform(-3, 3));
    problem.mass.emplace_back(mass, mass, mass * random.uniform(0.05, 1.0));
    if (friction && random.below(6) == 0)
      problem.mass.back()[random.below(3)] = std::numeric_limits<double>::infinity();
    problem.force.push_back(10 * mass * vec());
    problem.velocity.push_back(vec());
  }
  for (int k = 0; k < contacts; ++k) {
    const int body = static_cast<int>(random.below(bodies));
    int other = static_cast<int>(random.below(bodies + 1)) - 1;
    if (other == body) other = -1;
    const double angle = random.uniform(0.0, std::numbers::pi);  // of a half plane: all can always part
    const Vec2 arm(random.uniform(-1, 1), random.uniform(-1, 1)), other_arm(random.uniform(-1, 1), 0.3);
    const double side = other > body ? -1.0 : 1.0;
    StepContact s;
    s.contact = contact_at(body, other, side * Vec2(std::cos(angle), std::sin(angle)), arm, other_arm);
    s.gap = random.below(3) == 0 ? 0.0 : random.uniform(0.0, 2.0) * problem.duration;
    if (friction && random.below(4) > 0) s.friction_bound = std::exp2(random.uniform(-12, 2));
    const bool turns =
        !std::isinf(problem.mass[body][2]) || (other >= 0 && !std::isinf(problem.mass[other][2]));
    if (friction && turns && random.below(4) == 0) s.rolling_bound = std::exp2(random.uniform(-12, 0));
    problem.contacts.push_back(s);
  }
  return problem;
}

/// With friction. Nobody's place is locked, which may squeeze: then there is no answer.
StepProblem answerable_problem(Random& random) {
  StepProblem problem = random_problem(random, true);
  for (Vec3& m : problem.mass)
    for (int c = 0; c < 2; ++c)
      if (std::isinf(m[c])) m[c] = 1.0;
  return problem;
}

TEST(Step, RandomProblemsAreProved) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const StepProblem problem = answerable_problem(random);
    expect_proved(problem, ConeQp().step(problem));
    if (HasFailure()) return;
  }
}

// Masses a million and more times apart: rounding ends the search of one in some dozens, and the problem is solved by pivots then.
TEST(Step, OfMassesFarApartIsProved) {
  for (const double spread : {1e3, 1e6, 1e9})
    for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
      SCOPED_TRACE(::testing::Message() << "spread " << spread << ", seed " << seed);
      Random random(seed);
      StepProblem problem = answerable_problem(random);
      for (std::size_t k = 0; k < problem.mass.size(); ++k) {
        const double by = std::pow(spread, random.uniform(-0.5, 0.5));
        problem.mass[k] *= by;
        problem.force[k] *= by;
      }
      for (StepContact& s : problem.contacts) {
        const double by = problem.mass[s.contact.body].x();
        s.friction_bound *= by;
        s.rolling_bound *= by;
      }
      const StepResult result = ConeQp().step(problem);
      ASSERT_LE(result.residual, 1e-7);
      double speed = 0.0;
      for (std::size_t k = 0; k < problem.mass.size(); ++k)
        for (const Vec3& v : {problem.velocity[k], result.velocity[k]})
          speed = std::max(speed, v.cwiseAbs().maxCoeff());
      for (std::size_t k = 0; k < problem.contacts.size(); ++k)
        EXPECT_GE(
            problem.contacts[k].gap / problem.duration + relative(problem.contacts[k], result.velocity)[0],
            -1e-6 * speed)
            << "contact " << k;
      // each body by what presses on it
      std::vector<Vec3> pushed(problem.mass.size(), Vec3::Zero());
      std::vector<double> size(problem.mass.size(), 0.0);
      for (std::size_t k = 0; k < result.loads.size(); ++k) {
        const LastingContact& c = problem.contacts[k].contact;
        const ContactLoad& load = result.loads[k];
        apply(c, load, pushed);
        for (const int body : {c.body, c.other})
          if (body >= 0)
            size[body] += 2.0 * (load.normal + std::abs(load.tangential) + std::abs(load.rolling));
      }
      for (std::size_t k = 0; k < problem.mass.size(); ++k)
        for (int c = 0; c < 3; ++c) {
          if (std::isinf(problem.mass[k][c])) continue;
          const double gained = problem.mass[k][c] * (result.velocity[k][c] - problem.velocity[k][c]),
                       given = problem.duration * problem.force[k][c];
          EXPECT_NEAR(gained, given + pushed[k][c],
                      1e-6 * (size[k] + std::abs(given) + problem.mass[k][c] * speed))
              << "body " << k;
        }
      if (HasFailure()) return;
    }
}

// The search may begin near what is expected, rightly or wrongly: it ends with the same answer.
TEST(Step, WhatIsExpectedChangesNoAnswer) {
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    StepProblem problem = answerable_problem(random);
    const StepResult before = ConeQp().step(problem);
    for (std::size_t k = 0; k < problem.contacts.size(); ++k) {
      const ContactLoad& load = before.loads[k];
      const double part = random.uniform(0.0, 2.0);
      problem.contacts[k].expected = {part * load.normal, part * load.tangential, part * load.rolling};
    }
    const StepResult after = ConeQp().step(problem);
    expect_proved(problem, after);
    for (std::size_t k = 0; k < problem.mass.size(); ++k)
      EXPECT_LE((after.velocity[k] - before.velocity[k]).cwiseAbs().maxCoeff(), 1e-6) << "body " << k;
    if (HasFailure()) return;
  }
}

// The search may go on from the last one, for gaps and bounds that are nearly the same, or are not: the answer is that of a
// search of its own.
TEST(Step, GoingOnFromTheLastSearchChangesNoAnswer) {
  int went_on = 0, afresh = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    StepProblem problem = answerable_problem(random);
    ConeQp solver;
    StepProblem first = problem;
    // some contacts come later, and some have had no friction
    first.contacts.resize(
        static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(problem.contacts.size()) + 1.0)));
    for (StepContact& s : first.contacts)
      if (random.uniform(0, 1) < 0.1) s.friction_bound = 0.0;
    solver.step(first);
    const double part = std::exp2(random.uniform(-40, 0));
    for (StepContact& s : problem.contacts) {
      s.gap += part * problem.duration * random.uniform(-1, 1);
      s.friction_bound *= 1.0 + part * random.uniform(-1, 1);
    }
    const StepResult on = solver.step(problem, {}, {StepSearch::From::halfway}), own = ConeQp().step(problem);
    expect_proved(problem, on);
    for (std::size_t k = 0; k < problem.mass.size(); ++k)
      EXPECT_LE((on.velocity[k] - own.velocity[k]).cwiseAbs().maxCoeff(), 1e-6) << "body " << k;
    went_on += on.factorisations;
    afresh += own.factorisations;
    if (HasFailure()) return;
  }
  EXPECT_LT(went_on, afresh);
}

// Of a heap it takes half as many factors, as little as a lift changes; of one without its last contact it ends with what a search of
// its own finds.
TEST(Step, GoingOnTakesFewFactors) {
  StepProblem problem = testing::heap_step(12, 12, 1e-6, 0.5, 1.0 / 120);
  ConeQp solver;
  const int first = solver.step(problem).factorisations;
  for (StepContact& s : problem.contacts) s.gap -= 1e-9;
  const StepResult next = solver.step(problem, {}, {StepSearch::From::halfway});
  expect_proved(problem, next);
  EXPECT_LE(2 * next.factorisations, first + 2);
  problem.contacts.pop_back();
  const StepResult other = solver.step(problem, {}, {StepSearch::From::halfway}),
                   own = ConeQp().step(problem);
  for (std::size_t k = 0; k < problem.mass.size(); ++k)
    EXPECT_LE((other.velocity[k] - own.velocity[k]).cwiseAbs().maxCoeff(), 1e-6) << "body " << k;
}

// A search that ended early is taken to the end as if it had not: same bits, and no factor twice.
TEST(Step, ASearchThatEndedEarlyGoesOnToTheEnd) {
  const StepProblem problem = testing::heap_step(12, 12, 1e-6, 0.5, 1.0 / 120);
  ConeQp solver;
  const StepResult coarse = solver.step(problem, {}, {StepSearch::From::nothing, 1e-8});
  const StepResult end = solver.step(problem, {}, {StepSearch::From::end});
  const StepResult own = ConeQp().step(problem);
  EXPECT_EQ(coarse.status, StepResult::Status::solved);
  EXPECT_LT(coarse.factorisations, own.factorisations);
  EXPECT_EQ(coarse.factorisations + end.factorisations, own.factorisations);
  EXPECT_EQ(end.velocity, own.velocity);
}

/// Without friction: normal impulses as a linear complementarity problem in the contacts.
std::vector<Vec3> by_lcp(const StepProblem& problem) {
  const auto n = static_cast<Eigen::Index>(problem.contacts.size());
  const auto bodies = static_cast<Eigen::Index>(problem.mass.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, 3 * bodies),
                  inverse = Eigen::MatrixXd::Zero(3 * bodies, 3 * bodies);
  Eigen::VectorXd free(3 * bodies), gap(n);
  for (Eigen::Index k = 0; k < bodies; ++k) {
    inverse.diagonal().segment<3>(3 * k) = problem.mass[k].cwiseInverse();
    free.segment<3>(3 * k) =
        problem.velocity[k] + problem.duration * problem.force[k].cwiseQuotient(problem.mass[k]);
  }
  for (Eigen::Index k = 0; k < n; ++k) {
    const LastingContact& c = problem.contacts[k].contact;
    J.block<1, 3>(k, 3 * c.body) = c.normal_on_body.transpose();
    if (c.other >= 0) J.block<1, 3>(k, 3 * c.other) = c.normal_on_other.transpose();
    gap[k] = problem.contacts[k].gap / problem.duration;
  }
  const RealMatrix A = (J * inverse * J.transpose()).cast<Real>();
  const LcpAnswer answer = solve_lcp(A.sparseView(), (gap + J * free).cast<Real>());
  EXPECT_EQ(answer.status, LcpAnswer::Status::solved);
  const Eigen::VectorXd w = free + inverse * J.transpose() * answer.z.cast<double>();
  std::vector<Vec3> result;
  for (Eigen::Index k = 0; k < bodies; ++k) result.emplace_back(w.segment<3>(3 * k));
  return result;
}

TEST(Step, AgreesWithComplementarityProblemWithoutFriction) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const StepProblem problem = random_problem(random, false);
    const StepResult result = ConeQp().step(problem);
    ASSERT_EQ(result.status, Status::solved);
    const std::vector<Vec3> other = by_lcp(problem);
    for (std::size_t k = 0; k < other.size(); ++k)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(result.velocity[k][c], other[k][c], 1e-8) << k;
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace brink::cone_qp_step_test
