/// One contract for every integrator by name. The fixed-step ones run at a step of 1/64 s.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "brink/core/base/error.h"
#include "brink/core/base/random.h"
#include "brink/integrators/integrator.h"
#include "tests/support/seeded_random.h"
#include "tests/unit/integrators/problems.h"

namespace brink::contract_test {
namespace {

using namespace problems;

const IntegratorOptions kOptions{1e-9, 1e-11, 1.0 / 64.0};

/// A closed form exists for it, so that `auto` and `ballistic` can be held to the contract too.
class Falling : public Dynamics {
 public:
  int size() const override { return 2; }
  void accelerations(double, std::span<const BodyState>, std::span<Acceleration> out) const override {
    out[0] = {{0.5, kGravity}, 0.25};
    out[1] = {{-1.0, 2.0}, -3.0};
  }
  bool constant() const override { return true; }
};

class IntegratorContract : public ::testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<Dynamics> dynamics() const {
    if (GetParam() == "ballistic") return std::make_shared<Falling>();
    return spring_pair();
  }
  std::unique_ptr<Integrator> make(std::shared_ptr<Dynamics> d, WorkCounters* work = nullptr) const {
    return make_integrator(GetParam(), std::move(d), kOptions, work);
  }
  std::unique_ptr<Integrator> make() const { return make(dynamics()); }
};

bool same_bits(const BodyState& a, const BodyState& b) {
  return a.pose.position == b.pose.position && a.pose.angle == b.pose.angle &&
         a.twist.velocity == b.twist.velocity && a.twist.omega == b.twist.omega;
}

// The states given to start() come back unchanged: nothing was computed.
TEST_P(IntegratorContract, StartedMotionBeginsWithTheGivenStatesExactly) {
  const auto integrator = make();
  const auto states = spring_pair_start();
  integrator->start(0.7, states);
  EXPECT_EQ(integrator->motion(1).begin(), 0.7);
  EXPECT_EQ(integrator->motion(1).end(), 0.7);
  EXPECT_TRUE(same_bits(integrator->motion(1).state(0.7), states[1]));
  ASSERT_EQ(integrator->extend(1.0).status, Extent::Status::reached);
  for (int k = 0; k < 2; ++k) EXPECT_TRUE(same_bits(integrator->motion(k).state(0.7), states[k]));
}

TEST_P(IntegratorContract, ExtendCoversTheAskedTimeAndNeverGoesBack) {
  const auto integrator = make();
  integrator->start(0.0, spring_pair_start());
  double before = 0.0;
  for (double t : {0.5, 0.25, 2.0, 2.0}) {
    const Extent extent = integrator->extend(t);
    EXPECT_EQ(extent.status, Extent::Status::reached);
    EXPECT_GE(extent.end, std::max(t, before));
    EXPECT_EQ(extent.end, integrator->motion(0).end());
    before = extent.end;
  }
}

// Steps come from the component's history alone, so the motion may not feel how it was asked for: not one
// bit.
TEST_P(IntegratorContract, ManySmallAsksGiveTheBitsOfOneBigAsk) {
  const auto big = make(), small = make();
  big->start(0.0, spring_pair_start());
  small->start(0.0, spring_pair_start());
  big->extend(5.0);
  const std::uint64_t seed = 7;
  Random random(seed);
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  for (double t = 0.0; t < 5.0; t += random.uniform(0.0, 0.05)) {
    small->extend(t);
    small->motion(0).state(t);
  }
  small->extend(5.0);
  for (int i = 0; i < 1000; ++i) {
    const double t = random.uniform(0.0, 5.0);
    for (int k = 0; k < 2; ++k)
      ASSERT_TRUE(same_bits(big->motion(k).state(t), small->motion(k).state(t))) << t;
  }
  EXPECT_EQ(big->motion(0).end(), small->motion(0).end());
}

// A restarted integrator carries nothing over: it gives the bits of a new one.
TEST_P(IntegratorContract, RestartGivesTheBitsOfANewIntegrator) {
  const auto used = make(), fresh = make();
  used->start(0.0, spring_pair_start());
  used->extend(3.3);
  auto states = spring_pair_start();
  states[0].twist.velocity = {1.0, -2.0};
  used->start(3.25, states);
  fresh->start(3.25, states);
  EXPECT_EQ(used->extend(6.0).end, fresh->extend(6.0).end);
  for (double t = 3.25; t < 6.0; t += 0.01)
    ASSERT_TRUE(same_bits(used->motion(1).state(t), fresh->motion(1).state(t)));
}

// Somebody may still back up inside an old motion after its component was restarted.
TEST_P(IntegratorContract, MotionsTakenBeforeARestartStayAsTheyWere) {
  const auto integrator = make();
  integrator->start(0.0, spring_pair_start());
  integrator->extend(2.0);
  const Motion old = integrator->motion(0);
  const double end = old.end();
  std::vector<BodyState> before;
  for (double t = 0.0; t <= 2.0; t += 0.125) before.push_back(old.state(t));
  auto states = spring_pair_start();
  states[0].pose.position.x() += 5.0;
  integrator->start(1.0, states);
  integrator->extend(4.0);
  EXPECT_EQ(old.end(), end);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_TRUE(same_bits(old.state(0.125 * i), before[i]));
}

// Pose and twist may not jump anywhere: between two doubles next to each other they differ by rounding only.
// Pieces begin at the accepted states and end there to rounding.
TEST_P(IntegratorContract, PoseAndTwistAreContinuousAcrossJoins) {
  const auto integrator = make();
  integrator->start(0.0, spring_pair_start());
  integrator->extend(5.0);
  const Motion motion = integrator->motion(1);
  // joins are where the state one double earlier belongs to another piece; scan for them by bisection on a
  // fine grid
  for (int i = 0; i < 200000; ++i) {
    const double t = i * 2.5e-5, next = std::nextafter(t, 10.0);
    const BodyState a = motion.state(t), b = motion.state(next);
    ASSERT_LT(difference(a, b), 2e-13) << "at t = " << t;
  }
}

// The twist is the derivative of the pose: central differences of the pose agree with it to O(h^2).
TEST_P(IntegratorContract, TwistIsTheDerivativeOfThePose) {
  const auto integrator = make();
  integrator->start(0.0, spring_pair_start());
  integrator->extend(5.0);
  const Motion motion = integrator->motion(0);
  SeededRandom random(11);
  for (int i = 0; i < 2000; ++i) {
    const double t = random.uniform(0.1, 4.9), h = 1e-5;
    const Vec2 slope = (motion.pose(t + h).position - motion.pose(t - h).position) / (2.0 * h);
    const double turn = (motion.pose(t + h).angle - motion.pose(t - h).angle) / (2.0 * h);
    ASSERT_LT((slope - motion.twist(t).velocity).norm(), 5e-5) << t;
    ASSERT_LT(std::abs(turn - motion.twist(t).omega), 5e-5) << t;
  }
}

// bounds() must hold every rate sampled inside a random sub-interval (accelerations by differences of the
// twist, which by the mean value theorem lie in the convex enclosure).
TEST_P(IntegratorContract, BoundsEncloseSampledRates) {
  const auto integrator = make();
  integrator->start(0.0, spring_pair_start());
  integrator->extend(5.0);
  const Motion motion = integrator->motion(1);
  const std::uint64_t seed = 3;
  Random random(seed);
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  for (int i = 0; i < 500; ++i) {
    const double from = random.uniform(0.0, 5.0);
    const double to = from + (5.0 - from) * std::pow(10.0, random.uniform(-5.0, 0.0));
    const MotionBounds b = motion.bounds(from, to);
    for (int j = 0; j < 20; ++j) {
      const double s = random.uniform(from, to), e = random.uniform(from, to);
      const Twist w = motion.twist(s), u = motion.twist(e);
      ASSERT_LE((w.velocity - b.velocity).norm(), b.velocity_radius + 1e-12);
      ASSERT_LE(std::abs(w.omega - b.omega), b.omega_radius + 1e-12);
      if (std::abs(s - e) < 1e-6) continue;
      const Vec2 a = (w.velocity - u.velocity) / (s - e);
      ASSERT_LE((a - b.acceleration).norm(), b.acceleration_radius + 1e-8);
      ASSERT_LE(std::abs((w.omega - u.omega) / (s - e)), b.alpha + 1e-8);
    }
  }
}

TEST_P(IntegratorContract, WorkIsCounted) {
  WorkCounters work;
  const auto integrator = make(dynamics(), &work);
  integrator->start(0.0, spring_pair_start());
  integrator->extend(1.0);
  EXPECT_GE(work.right_hand_sides, 1u);
  EXPECT_GE(work.solver_steps, 1u);
  EXPECT_GE(work.right_hand_sides, work.solver_steps);
}

// A thrust of 5 m/s^2 from 0.3 to 0.55 changes the speed by exactly 5 * 0.25; a step across a jump would miss
// it. Every method of order 1 or more is exact in the velocity where the force is constant.
TEST_P(IntegratorContract, BreaksOfTheForcesAreHitExactly) {
  const auto thrusted = std::make_shared<Thrusted>(0.3, 0.55, true);
  const auto integrator = make(thrusted);
  integrator->start(0.0, std::vector<BodyState>{{}});
  ASSERT_EQ(integrator->extend(1.0).status, Extent::Status::reached);
  const Motion motion = integrator->motion(0);
  // at step ends: between them the Euler methods' interpolated twist wavers where the pose is not a parabola
  EXPECT_EQ(motion.twist(0.3).velocity.x(), 0.0);
  EXPECT_NEAR(motion.twist(0.55).velocity.x(), 1.25, 1e-12);
  EXPECT_NEAR(motion.twist(1.0).velocity.x(), 1.25, 1e-12);
  EXPECT_NEAR(motion.twist(1.0).omega, 0.75, 1e-12);
  EXPECT_NEAR(motion.twist(0.3).velocity.y(), 0.3 * kGravity, 1e-8);
  EXPECT_NEAR(motion.twist(0.55).velocity.y(), 0.55 * kGravity, 1e-8);
  // x = 5 (1/4)^2 / 2 at the end of the thrust, known to first order for the Euler methods
  const double error = GetParam().find("euler") == std::string::npos ? 1e-9 : 0.02;
  EXPECT_NEAR(motion.pose(0.55).position.x(), 5.0 / 32.0, error);
}

TEST_P(IntegratorContract, StartAgainBeforeABreakDoesNotRememberIt) {
  // The first run is stopped short of a break at 0.5; the second begins behind all breaks and must be like a
  // new one.
  const auto thrusted = std::make_shared<Thrusted>(0.5, 0.6, true);
  const auto used = make(thrusted), fresh = make(thrusted);
  used->start(0.0, std::vector<BodyState>{{}});
  used->extend(0.1);
  used->start(2.0, std::vector<BodyState>{{}});
  fresh->start(2.0, std::vector<BodyState>{{}});
  EXPECT_EQ(used->extend(3.0).end, fresh->extend(3.0).end);
  EXPECT_TRUE(same_bits(used->motion(0).state(2.9), fresh->motion(0).state(2.9)));
}

/// No force until x = 0.5, then one that is not a number; claims to be constant where `constant` is asked
/// for.
class Poisoned : public Dynamics {
 public:
  Poisoned(bool everywhere) : everywhere_(everywhere) {}
  int size() const override { return 1; }
  void accelerations(double, std::span<const BodyState> s, std::span<Acceleration> out) const override {
    const bool bad = everywhere_ || s[0].pose.position.x() > 0.5;
    out[0] = {{0.0, bad ? std::nan("") : -1.0}, 0.0};
  }
  bool constant() const override { return everywhere_; }

 private:
  bool everywhere_;
};

TEST_P(IntegratorContract, ForceThatIsNotANumberAtTheStartFails) {
  const auto integrator = make(std::make_shared<Poisoned>(true));
  integrator->start(1.0, std::vector<BodyState>{{}});
  for (int i = 0; i < 2; ++i) {
    const Extent extent = integrator->extend(2.0);
    EXPECT_EQ(extent.status, Extent::Status::failed);
    EXPECT_EQ(extent.end, 1.0);
    EXPECT_THAT(extent.why, ::testing::HasSubstr("not finite"));
  }
  EXPECT_TRUE(same_bits(integrator->motion(0).state(1.0), BodyState{}));
}

// At 1 m/s the body meets the bad region at t = 0.5. The motion up to the failure is kept, is finite, and the
// failure is the same however it was asked for.
TEST_P(IntegratorContract, ForceThatIsNotANumberOnTheWayFailsThereAndKeepsTheMotion) {
  if (GetParam() == "ballistic") GTEST_SKIP() << "a closed form cannot depend on the place";
  BodyState state;
  state.twist.velocity = {1.0, 0.0};
  Extent first;
  for (double ask : {0.01, 10.0}) {
    const auto integrator = make(std::make_shared<Poisoned>(false));
    integrator->start(0.0, std::vector<BodyState>{state});
    Extent extent;
    for (double t = ask; extent.status == Extent::Status::reached && t < 20.0; t += ask)
      extent = integrator->extend(t);
    EXPECT_EQ(extent.status, Extent::Status::failed);
    EXPECT_THAT(extent.why, ::testing::HasSubstr("not finite"));
    EXPECT_GT(extent.end, 0.3);
    EXPECT_LT(extent.end, 0.6);
    const Motion motion = integrator->motion(0);
    EXPECT_EQ(motion.end(), extent.end);
    for (int i = 0; i <= 100; ++i)
      EXPECT_TRUE(std::isfinite(difference(motion.state(extent.end * i / 100.0), BodyState{})));
    if (ask > 1.0) {
      EXPECT_EQ(extent.end, first.end);
    }
    first = extent;
    // a new start heals
    integrator->start(0.0, std::vector<BodyState>{{}});
    EXPECT_EQ(integrator->extend(0.2).status, Extent::Status::reached);
  }
}

// Weights of error tests are up to 1 / absolute_tolerance: their squares overflow.
TEST_P(IntegratorContract, ForceThatIsNotANumberFailsUnderATinyAbsoluteTolerance) {
  if (GetParam() == "ballistic") GTEST_SKIP() << "a closed form cannot depend on the place";
  const IntegratorOptions tiny{1e-9, 1e-200, 1.0 / 64.0};
  const auto integrator = make_integrator(GetParam(), std::make_shared<Poisoned>(false), tiny);
  // what moves is not near 0, where it would be held to the absolute tolerance
  const BodyState state{{{0.05, 5.0}, 0.0}, {{1.0, 3.0}, 0.0}};
  integrator->start(0.0, std::vector<BodyState>{state});
  const Extent extent = integrator->extend(10.0);
  EXPECT_EQ(extent.status, Extent::Status::failed);
  EXPECT_THAT(extent.why, ::testing::HasSubstr("not finite"));
  EXPECT_NEAR(extent.end, 0.45, 0.15);
  EXPECT_TRUE(std::isfinite(difference(integrator->motion(0).state(extent.end), BodyState{})));
}

TEST_P(IntegratorContract, BadStartIsRefused) {
  const auto integrator = make();
  auto states = spring_pair_start();
  EXPECT_THROW(integrator->start(std::nan(""), states), BadInput);
  EXPECT_THROW(integrator->start(0.0, std::span(states).first(1)), BadInput);
  states[1].twist.omega = std::numeric_limits<double>::infinity();
  EXPECT_THROW(integrator->start(0.0, states), BadInput);
}

TEST_P(IntegratorContract, AskThatIsNotANumberIsRefused) {
  const auto integrator = make();
  integrator->start(0.0, spring_pair_start());
  EXPECT_THROW(integrator->extend(std::nan("")), BadInput);
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const IntegratorInfo& info : integrators()) all.emplace_back(info.name);
  return all;
}
INSTANTIATE_TEST_SUITE_P(All, IntegratorContract, ::testing::ValuesIn(names()),
                         [](const auto& made) { return made.param; });

TEST(Integrators, FirstListedIsAuto) { EXPECT_EQ(integrators().front().name, "auto"); }

TEST(Integrators, UnknownNameIsRefusedAndTheNearestNamed) {
  try {
    make_integrator("rk5", spring_pair(), {});
    FAIL();
  } catch (const BadInput& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("did you mean \"rk4\""));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("semi_implicit_euler"));
  }
}

TEST(Integrators, BallisticWithoutAClosedFormIsRefused) {
  EXPECT_THROW(make_integrator("ballistic", spring_pair(), {}), BadInput);
}

/// Names a break that is not later than it was asked.
class Standing : public Falling {
 public:
  double next_break(double t) const override { return t; }
};

TEST(Integrators, BreakThatIsNotLaterIsNamed) {
  const auto integrator = make_integrator("ballistic", std::make_shared<Standing>(), {});
  integrator->start(0.25, spring_pair_start());
  const Extent extent = integrator->extend(1.0);
  EXPECT_EQ(extent.status, Extent::Status::failed);
  EXPECT_EQ(extent.end, 0.25);
  EXPECT_THAT(extent.why, ::testing::HasSubstr("next break is at t = 0.25, which is not later"));
}

TEST(Integrators, BadOptionsAreRefusedAndNamed) {
  std::string error;
  EXPECT_TRUE(IntegratorOptions{}.is_valid(&error));
  for (auto [bad, name] :
       {std::pair{IntegratorOptions{0.0, 1e-12, 0.001}, "tolerance"},
        std::pair{IntegratorOptions{std::nan(""), 1e-12, 0.001}, "tolerance"},
        std::pair{IntegratorOptions{1e-8, -1.0, 0.001}, "absolute_tolerance"},
        std::pair{IntegratorOptions{1e-8, 1e-12, 0.0}, "step"},
        std::pair{IntegratorOptions{1e-8, 1e-12, std::numeric_limits<double>::infinity()}, "step"}}) {
    EXPECT_FALSE(bad.is_valid(&error));
    EXPECT_THAT(error, ::testing::HasSubstr(name));
    EXPECT_THROW(make_integrator("erk", spring_pair(), bad), BadInput);
  }
}

TEST(Integrators, AutoTakesTheParabolaWhereForcesAreConstant) {
  const auto integrator = make_integrator("auto", std::make_shared<Falling>(), {});
  integrator->start(0.0, spring_pair_start());
  EXPECT_EQ(integrator->extend(std::numeric_limits<double>::infinity()).status, Extent::Status::reached);
  EXPECT_TRUE(integrator->motion(0).is_ballistic());
}

}  // namespace
}  // namespace brink::contract_test
