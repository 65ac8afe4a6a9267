// Forces that hold an island at rest: statics with answers by hand, and each answer's proof checked from outside.
#include <gtest/gtest.h>

#include "brink/core/base/random.h"
#include "tests/support/lasting_contacts.h"

namespace brink::cone_qp_rest_test {
namespace {

using testing::kGravity;
using testing::RestIsland;
using Status = RestResult::Status;

Status status_of(const RestIsland& island) { return ConeQp().rest_forces(island.problem).status; }

/// What contacts do on each body.
std::vector<Vec3> contact_forces(const RestProblem& problem, const std::vector<ContactLoad>& loads) {
  std::vector<Vec3> forces(problem.mass.size(), Vec3::Zero());
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const LastingContact& c = problem.contacts[k];
    const Vec3 torque(0.0, 0.0, loads[k].rolling);
    forces[c.body] += loads[k].normal * c.normal_on_body + loads[k].tangential * c.tangent_on_body + torque;
    if (c.other >= 0)
      forces[c.other] +=
          loads[k].normal * c.normal_on_other + loads[k].tangential * c.tangent_on_other - torque;
  }
  return forces;
}

/// Relative motion at a contact: along normal, tangent, and in turning.
Vec3 relative(const LastingContact& c, const std::vector<Vec3>& w) {
  Vec3 v(c.normal_on_body.dot(w[c.body]), c.tangent_on_body.dot(w[c.body]), w[c.body][2]);
  if (c.other >= 0)
    v -= Vec3(-c.normal_on_other.dot(w[c.other]), -c.tangent_on_other.dot(w[c.other]), w[c.other][2]);
  return v;
}

/// The conditions of Karush, Kuhn and Tucker, which prove the answer, whatever found it. Free coordinates only.
void expect_proved(const RestProblem& problem, const RestResult& result, double part = 1e-9) {
  ASSERT_NE(result.status, Status::undecided);
  double force = 0.0, speed = 0.0;
  for (const Vec3& f : problem.force) force = std::max(force, f.cwiseAbs().maxCoeff());
  for (const ContactLoad& load : result.loads) force = std::max(force, load.normal);
  for (const Vec3& w : result.acceleration) speed = std::max(speed, w.cwiseAbs().maxCoeff());
  EXPECT_EQ(speed > 0.0, result.status == Status::moves);

  const std::vector<Vec3> pushed = contact_forces(problem, result.loads);
  for (std::size_t k = 0; k < problem.mass.size(); ++k)
    for (int c = 0; c < 3; ++c)
      if (std::isinf(problem.mass[k][c]))
        EXPECT_EQ(result.acceleration[k][c], 0.0);
      else
        EXPECT_NEAR(problem.mass[k][c] * result.acceleration[k][c], problem.force[k][c] + pushed[k][c],
                    part * force)
            << "body " << k << ", coordinate " << c;
  for (std::size_t k = 0; k < problem.contacts.size(); ++k) {
    const LastingContact& c = problem.contacts[k];
    const ContactLoad& load = result.loads[k];
    const Vec3 v = relative(c, result.acceleration);
    EXPECT_GE(load.normal, 0.0);
    EXPECT_LE(std::abs(load.tangential), c.friction * load.normal * (1 + 1e-12));
    EXPECT_LE(std::abs(load.rolling), c.rolling_resistance * load.normal * (1 + 1e-12));
    EXPECT_GE(v[0] - c.friction * std::abs(v[1]) - c.rolling_resistance * std::abs(v[2]), -part * speed);
    EXPECT_NEAR(load.normal * v[0] + load.tangential * v[1] + load.rolling * v[2], 0.0, part * force * speed);
  }
}

/// A box of side 1 on a plane that rises by `angle`, in the plane's own axes.
RestIsland incline(double angle, double friction) {
  RestIsland island;
  island.add_box({0.0, 0.5});
  island.problem.force[0] = {-kGravity * std::sin(angle), -kGravity * std::cos(angle), 0.0};
  for (const double x : {-0.5, 0.5}) island.touch(0, -1, {0.0, 1.0}, {x, 0.0}, friction);
  return island;
}

// A box slides where the slope is more than the friction: tan(angle) > mu.
TEST(RestForces, BoxOnInclineSticksBelowTheAngleOfFriction) {
  const double angle = std::atan(0.363970);
  EXPECT_EQ(status_of(incline(angle, 0.363971)), Status::rests);
  EXPECT_EQ(status_of(incline(angle, 0.363970 * (1 + 1e-7))), Status::rests);
  EXPECT_EQ(status_of(incline(angle, 0.363969)), Status::moves);
  EXPECT_EQ(status_of(incline(angle, 0.363970 * (1 - 1e-7))), Status::moves);
  expect_proved(incline(angle, 0.363971).problem, ConeQp().rest_forces(incline(angle, 0.363971).problem));
}

// At mu = 0 the box slides at g sin(angle) and does not lift.
TEST(RestForces, FrictionlessBoxMovesAtItsAcceleration) {
  const RestIsland island = incline(0.3, 0.0);
  const RestResult result = ConeQp().rest_forces(island.problem);
  expect_proved(island.problem, result);
  EXPECT_NEAR(result.acceleration[0].x(), -kGravity * std::sin(0.3), 1e-11);
  EXPECT_NEAR(result.acceleration[0].y(), 0.0, 1e-11);
}

// However rough: a wedge of friction holds at any slope that it covers.
TEST(RestForces, RoughnessHasNoLimit) {
  for (const double friction : {10.0, 1e3, 1e6}) {
    RestIsland box = incline(std::atan(0.9 * friction), friction);
    box.problem.mass[0][2] = std::numeric_limits<double>::infinity();  // or it tips over
    EXPECT_EQ(status_of(box), Status::rests) << friction;
    box.problem.force = incline(std::atan(1.1 * friction), friction).problem.force;
    EXPECT_EQ(status_of(box), Status::moves) << friction;
  }
}

// Each joint carries what is above it.
TEST(RestForces, StackCarriesTheWeightAbove) {
  for (const int n : {1, 10, 50, 200}) {
    const RestIsland island = testing::stack(n);
    const RestResult result = ConeQp().rest_forces(island.problem);
    ASSERT_EQ(result.status, Status::rests) << n;
    expect_proved(island.problem, result);
    for (int k = 0; k < n; ++k) {
      EXPECT_NEAR(result.loads[2 * k].normal, (n - k) * kGravity / 2, 1e-9 * n * kGravity) << k;
      EXPECT_NEAR(result.loads[2 * k + 1].normal, (n - k) * kGravity / 2, 1e-9 * n * kGravity) << k;
    }
  }
}

// Boxes shifted by d each: the nine above the first have their centre 5 d beyond its; it must lie over the
// support, 5 d <= 1/2.
TEST(RestForces, LeaningStackFallsBeyondItsCriticalLean) {
  EXPECT_EQ(status_of(testing::stack(10, 0.0998)), Status::rests);
  EXPECT_EQ(status_of(testing::stack(10, 0.09999)), Status::rests);
  EXPECT_EQ(status_of(testing::stack(10, 0.1)), Status::rests);
  EXPECT_EQ(status_of(testing::stack(10, 0.10001)), Status::moves);
  EXPECT_EQ(status_of(testing::stack(10, 0.1002)), Status::moves);
}

// A uniform ladder on a wall without friction stands while tan(angle to the floor) >= 1 / (2 mu); with friction
// at both ends while tan >= (1 - mu mu') / (2 mu).
TEST(RestForces, LadderStandsWhileSteep) {
  const auto ladder = [](double tangent, double floor, double wall) {
    RestIsland island;
    const Vec2 foot(1.0, 0.0), head(0.0, tangent);
    island.add((foot + head) / 2, 1.0, (head - foot).squaredNorm() / 12);
    island.touch(0, -1, {0.0, 1.0}, foot, floor);
    island.touch(0, -1, {1.0, 0.0}, head, wall);
    return island;
  };
  EXPECT_EQ(status_of(ladder(1.0 + 1e-6, 0.5, 0.0)), Status::rests);
  EXPECT_EQ(status_of(ladder(1.0 - 1e-6, 0.5, 0.0)), Status::moves);
  EXPECT_EQ(status_of(ladder(0.91 + 1e-6, 0.5, 0.18)), Status::rests);
  EXPECT_EQ(status_of(ladder(0.91 - 1e-6, 0.5, 0.18)), Status::moves);
}

// Two faces on two sides of a right-angled groove without friction: each side carries weight / sqrt 2. Four
// contacts for three coordinates.
TEST(RestForces, BoxInAGrooveLoadsBothSides) {
  RestIsland island;
  const double s = std::sqrt(0.5);
  island.add_box({0.0, s});
  for (const double side : {-1.0, 1.0})
    for (const double along : {0.0, 1.0}) island.touch(0, -1, {-side * s, s}, Vec2(side * s, s) * along, 0.0);
  const RestResult result = ConeQp().rest_forces(island.problem);
  ASSERT_EQ(result.status, Status::rests);
  expect_proved(island.problem, result);
  EXPECT_NEAR(result.loads[0].normal + result.loads[1].normal, kGravity * s, 1e-9);
  EXPECT_NEAR(result.loads[2].normal + result.loads[3].normal, kGravity * s, 1e-9);
}

TEST(RestForces, ContactsTenTimesGivenShareTheirLoad) {
  for (const double lean : {0.0, 0.0998, 0.1002}) {
    RestIsland island = testing::stack(10, lean);
    const auto once = island.problem.contacts;
    const RestResult single = ConeQp().rest_forces(island.problem);
    for (int k = 1; k < 10; ++k)
      island.problem.contacts.insert(island.problem.contacts.end(), once.begin(), once.end());
    const RestResult result = ConeQp().rest_forces(island.problem);
    EXPECT_EQ(result.status, single.status);
    expect_proved(island.problem, result);
    for (std::size_t k = 0; k < once.size(); ++k) {
      double sum = 0.0;
      for (std::size_t copy = k; copy < result.loads.size(); copy += once.size())
        sum += result.loads[copy].normal;
      EXPECT_NEAR(sum, single.loads[k].normal, 1e-8 * 10 * kGravity) << k;
    }
  }
}

// What stands on a million or a thousand million times less mass.
TEST(RestForces, HeavyOnLightRests) {
  for (const double top : {1e6, 1e9, 1e-6, 1e-9}) {
    const RestIsland island = testing::stack(10, 0.0, top);
    const RestResult result = ConeQp().rest_forces(island.problem);
    ASSERT_EQ(result.status, Status::rests) << top;
    expect_proved(island.problem, result, 1e-12);
    EXPECT_NEAR(result.loads[0].normal, (9 + top) * kGravity / 2, 1e-9 * std::max(1.0, top) * kGravity);
  }
}

TEST(RestForces, PyramidLoadsTheFloorWithItsWeight) {
  const int base = 20;
  const RestIsland island = testing::pyramid(base);
  const RestResult result = ConeQp().rest_forces(island.problem);
  ASSERT_EQ(result.status, Status::rests);
  expect_proved(island.problem, result);
  double floor = 0.0;
  for (int k = 0; k < 2 * base; ++k) floor += result.loads[k].normal;
  EXPECT_NEAR(floor, base * (base + 1) / 2 * kGravity, 1e-8);
}

// Half a ring stands if it is thicker than about .107 of its radius (Milankovitch 1907; by stones a little
// less), and if its stones do not slide (friction above about .31).
TEST(RestForces, ArchStandsIfThickAndRough) {
  EXPECT_EQ(status_of(testing::arch(15, 0.22, 0.7)), Status::rests);
  EXPECT_EQ(status_of(testing::arch(15, 0.115, 0.7)), Status::rests);
  EXPECT_EQ(status_of(testing::arch(16, 0.10, 0.7)), Status::moves);
  EXPECT_EQ(status_of(testing::arch(15, 0.084, 0.7)), Status::moves);
  EXPECT_EQ(status_of(testing::arch(15, 0.22, 0.12)), Status::moves);
}

// One disc on two: the angle between vertical and the line of centres is 30 degrees; without friction the
// lower ones part, between walls they stand and each wall is pushed by tan(30 degrees) / 2 of the weight.
TEST(RestForces, HeapWithoutFrictionNeedsWalls) {
  RestIsland heap;
  heap.add_disc({-0.5, 0.5}, 0.5);
  heap.add_disc({0.5, 0.5}, 0.5);
  heap.add_disc({0.0, 0.5 + std::sqrt(0.75)}, 0.5);
  for (const int k : {0, 1}) {
    heap.touch(k, -1, {0.0, 1.0}, {heap.centres[k].x(), 0.0}, 0.0);
    heap.touch(2, k, heap.centres[2] - heap.centres[k], (heap.centres[2] + heap.centres[k]) / 2, 0.0);
  }
  const RestResult free = ConeQp().rest_forces(heap.problem);
  EXPECT_EQ(free.status, Status::moves);
  expect_proved(heap.problem, free);
  heap.touch(0, -1, {1.0, 0.0}, {-1.0, 0.5}, 0.0);
  heap.touch(1, -1, {-1.0, 0.0}, {1.0, 0.5}, 0.0);
  const RestResult walled = ConeQp().rest_forces(heap.problem);
  ASSERT_EQ(walled.status, Status::rests);
  expect_proved(heap.problem, walled);
  EXPECT_NEAR(walled.loads[4].normal, kGravity * std::tan(std::numbers::pi / 6) / 2, 1e-9);
  EXPECT_NEAR(walled.loads[0].normal, 1.5 * kGravity, 1e-9);
}

// Exactly above one another, discs balance; a hair beside, friction or not, they do not.
TEST(RestForces, DiscOnDiscBalancesOnlyUpright) {
  const auto two = [](double aside) {
    RestIsland island;
    island.add_disc({0.0, 0.5}, 0.5);
    island.add_disc({aside, 0.5 + std::sqrt(1 - aside * aside)}, 0.5);
    island.touch(0, -1, {0.0, 1.0}, {0.0, 0.0}, 0.5);
    island.touch(1, 0, island.centres[1] - island.centres[0], (island.centres[1] + island.centres[0]) / 2,
                 0.5);
    return island;
  };
  EXPECT_EQ(status_of(two(0.0)), Status::rests);
  EXPECT_EQ(status_of(two(1e-6)), Status::moves);
}

// A disc on an incline rolls unless tan(angle) <= rolling resistance / radius.
TEST(RestForces, RollingResistanceHoldsADisc) {
  const auto disc = [](double tangent, double resistance) {
    RestIsland island;
    island.add_disc({0.0, 0.5}, 0.5);
    island.problem.force[0] = Vec3(-tangent, -1.0, 0.0) * kGravity;
    island.touch(0, -1, {0.0, 1.0}, {0.0, 0.0}, 0.9).rolling_resistance = resistance;
    return island;
  };
  EXPECT_EQ(status_of(disc(0.1, 0.0)), Status::moves);
  EXPECT_EQ(status_of(disc(0.1, 0.05 * (1 - 1e-6))), Status::moves);
  EXPECT_EQ(status_of(disc(0.1, 0.05 * (1 + 1e-6))), Status::rests);
  const RestIsland held = disc(0.1, 0.06);
  const RestResult result = ConeQp().rest_forces(held.problem);
  expect_proved(held.problem, result);
  EXPECT_NEAR(std::abs(result.loads[0].rolling), 0.1 * kGravity * 0.5, 1e-9);
}

// A box locked in x stays on any incline; one locked in everything stays in the air; a disc on an incline that
// is locked in its angle stays by friction alone.
TEST(RestForces, LocksHold) {
  constexpr double held = std::numeric_limits<double>::infinity();
  RestIsland box = incline(0.5, 0.0);
  box.problem.mass[0].x() = held;
  const RestResult result = ConeQp().rest_forces(box.problem);
  ASSERT_EQ(result.status, Status::rests);
  expect_proved(box.problem, result);
  RestIsland nailed;
  nailed.add_box({0.0, 0.0});
  nailed.problem.mass[0] = {held, held, held};
  EXPECT_EQ(status_of(nailed), Status::rests);
  RestIsland disc;
  disc.add_disc({0.0, 0.5}, 0.5);
  disc.problem.force[0] = {-0.3 * kGravity, -kGravity, 0.0};
  disc.touch(0, -1, {0.0, 1.0}, {0.0, 0.0}, 0.4);
  EXPECT_EQ(status_of(disc), Status::moves);
  disc.problem.mass[0][2] = held;
  EXPECT_EQ(status_of(disc), Status::rests);
}

TEST(RestForces, NothingToHold) {
  EXPECT_EQ(ConeQp().rest_forces({}).status, Status::rests);
  RestIsland falling;
  falling.add_box({0.0, 0.0});
  const RestResult result = ConeQp().rest_forces(falling.problem);
  EXPECT_EQ(result.status, Status::moves);
  EXPECT_NEAR(result.acceleration[0].y(), -kGravity, 1e-12);
  falling.problem.force[0].setZero();
  EXPECT_EQ(status_of(falling), Status::rests);
}

/// Bodies and contacts that mean nothing: any matrix will do.
RestProblem random_problem(Random& random) {
  RestProblem problem;
  const int bodies = 1 + static_cast<int>(random.below(8)), contacts = static_cast<int>(random.below(20));
  const auto vec = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  for (int k = 0; k < bodies; ++k) {
    const double mass = std::exp2(random.uniform(-3, 3));
    problem.mass.emplace_back(mass, mass, mass * random.uniform(0.05, 1.0));
    if (random.below(6) == 0) problem.mass.back()[random.below(3)] = std::numeric_limits<double>::infinity();
    problem.force.push_back(mass * vec());
  }
  for (int k = 0; k < contacts; ++k) {
    const int body = static_cast<int>(random.below(bodies));
    int other = static_cast<int>(random.below(bodies + 1)) - 1;
    if (other == body) other = -1;
    const double angle = random.uniform(0.0, 2 * std::numbers::pi);
    const Vec2 arm(random.uniform(-1, 1), random.uniform(-1, 1)), other_arm(random.uniform(-1, 1), 0.3);
    problem.contacts.push_back(contact_at(body, other, {std::cos(angle), std::sin(angle)}, arm, other_arm));
    if (random.below(4) > 0) problem.contacts.back().friction = random.uniform(0.0, 1.5);
    if (random.below(4) == 0) problem.contacts.back().rolling_resistance = random.uniform(0.0, 0.2);
  }
  return problem;
}

TEST(RestForces, RandomProblemsAreProved) {
  int rests = 0;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const RestProblem problem = random_problem(random);
    const RestResult result = ConeQp().rest_forces(problem);
    expect_proved(problem, result);
    rests += result.status == Status::rests;
    if (HasFailure()) return;
  }
  EXPECT_GT(rests, 50);
}

/// Forces that one may expect: those of the answer, off by a part of the largest, where that is large such as mean nothing.
std::vector<ContactLoad> random_loads(Random& random, const RestResult& answer, double part) {
  std::vector<ContactLoad> loads = answer.loads;
  double most = 0.0;
  for (const ContactLoad& load : loads) most = std::max(most, load.normal);
  const auto off = [&] { return part * most * random.uniform(-1, 1); };
  for (ContactLoad& load : loads)
    load = {std::max(0.0, load.normal + off()), load.tangential + off(), load.rolling + off()};
  return loads;
}

/// By what two accelerations differ, as the root of the kinetic energy, and the root of that of the first.
std::pair<double, double> differ(const RestProblem& problem, const std::vector<Vec3>& a,
                                 const std::vector<Vec3>& b) {
  double of = 0.0, all = 0.0;
  for (std::size_t k = 0; k < problem.mass.size(); ++k)
    for (int c = 0; c < 3; ++c)
      if (!std::isinf(problem.mass[k][c])) {
        of += problem.mass[k][c] * (a[k][c] - b[k][c]) * (a[k][c] - b[k][c]);
        all += problem.mass[k][c] * a[k][c] * a[k][c];
      }
  return {std::sqrt(of), std::sqrt(all)};
}

// Whatever forces are expected, and however near to them the search begins: the answer is that of a search which knows nothing.
// Ended early it says the same of rest, and accelerations to as many digits. With masses spread over 1e6, and contacts given twice.
TEST(RestForces, AnswersDoNotDependOnWhatIsExpected) {
  int decided = 0;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    RestProblem problem = random_problem(random);
    if (random.below(3) == 0)
      for (std::size_t k = 0; k < problem.mass.size(); ++k) {
        const double times = std::exp2(random.uniform(-10, 10));
        problem.mass[k] *= times;
        problem.force[k] *= times;
      }
    for (LastingContact& c : problem.contacts)
      if (random.below(3) == 0) c.friction = random.uniform(0.0, 2.0);
    if (!problem.contacts.empty() && random.below(3) == 0)
      problem.contacts.push_back(problem.contacts.front());
    const RestResult plain = ConeQp().rest_forces(problem);
    // rounding, where masses are spread that far
    if (plain.status == Status::undecided) continue;
    ++decided;
    for (const double part : {0.0, 1e-3, 0.1, 1.0, 100.0})
      for (const double near : {1e-1, 1e-2, 1e-3}) {
        SCOPED_TRACE(::testing::Message() << "off by " << part << ", near to " << near);
        problem.expected = random_loads(random, plain, part);
        problem.near = near;
        const RestResult exact = ConeQp().rest_forces(problem),
                         early = ConeQp().rest_forces(problem, {}, 1e-4);
        EXPECT_EQ(exact.status, plain.status);
        EXPECT_EQ(early.status, plain.status);
        const auto [of_exact, all] = differ(problem, plain.acceleration, exact.acceleration);
        const auto [of_early, same] = differ(problem, plain.acceleration, early.acceleration);
        EXPECT_LE(of_exact, 1e-6 * all);
        EXPECT_LE(of_early, 2e-2 * same);
        if (exact.status == Status::rests) expect_proved(problem, early);
        if (HasFailure()) return;
      }
  }
  EXPECT_GT(decided, 1950);
}

TEST(RestForces, SameBitsWhateverWasSolvedBefore) {
  ConeQp used;
  used.rest_forces(testing::pyramid(5).problem);
  used.rest_forces(testing::arch(15, 0.22, 0.7).problem);
  for (int k = 0; k < 2; ++k) {
    const RestResult again = used.rest_forces(testing::arch(15, 0.22, 0.7).problem);
    const RestResult fresh = ConeQp().rest_forces(testing::arch(15, 0.22, 0.7).problem);
    ASSERT_EQ(again.loads.size(), fresh.loads.size());
    for (std::size_t c = 0; c < fresh.loads.size(); ++c) {
      EXPECT_EQ(again.loads[c].normal, fresh.loads[c].normal);
      EXPECT_EQ(again.loads[c].tangential, fresh.loads[c].tangential);
    }
  }
}

// Stopped anywhere it says so, and knows nothing wrong afterwards.
TEST(RestForces, StopWhereTheyAreAsked) {
  const RestProblem problem = testing::arch(15, 0.22, 0.7).problem;
  const RestResult fresh = ConeQp().rest_forces(problem);
  for (int after = 0; after < 80; after += 3) {  // 30: while its graph is looked at
    ConeQp stopped;
    int asked = 0;
    EXPECT_EQ(stopped.rest_forces(problem, [&] { return asked++ < after; }).status, Status::stopped);
    EXPECT_EQ(asked, after + 1);
    const RestResult again = stopped.rest_forces(problem);
    EXPECT_EQ(again.status, fresh.status);
    for (std::size_t c = 0; c < fresh.loads.size(); ++c)
      EXPECT_EQ(again.loads[c].normal, fresh.loads[c].normal);
  }
}

}  // namespace
}  // namespace brink::cone_qp_rest_test
