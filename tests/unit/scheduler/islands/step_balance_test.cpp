// What a step may not make, and what nobody takes from it.
#include "brink/scheduler/islands/step_balance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace brink::step_balance_test {
namespace {

constexpr double kStep = 0.01, kTolerance = 1e-10;

/// Three bodies of 1, 2 and 4 kg in a row; the first two touch, and the third touches nobody.
IslandStep three_bodies() {
  IslandStep step;
  for (const double m : {1.0, 2.0, 4.0}) {
    step.mass.emplace_back(m, m, 0.1 * m);
    step.force.push_back(Vec3::Zero());
  }
  step.velocity = {{1.0, 0.5, 0.0}, {-1.0, 0.5, 0.2}, {3.0, 0.0, 1.0}};
  IslandContact touching;
  touching.rows = contact_at(0, 1, {-1.0, 0.0}, {0.5, 0.0}, {-0.5, 0.0});
  step.contacts.push_back(touching);
  return step;
}

/// With an impulse of so much [N s] between the first two.
std::vector<Vec3> after(const IslandStep& step, double impulse) {
  std::vector<Vec3> v = step.velocity;
  v[0] += impulse * step.contacts[0].rows.normal_on_body.cwiseQuotient(step.mass[0]);
  v[1] += impulse * step.contacts[0].rows.normal_on_other.cwiseQuotient(step.mass[1]);
  return v;
}

Vec2 momentum(const IslandStep& step, const std::vector<Vec3>& velocity) {
  Vec2 sum = Vec2::Zero();
  for (std::size_t i = 0; i < velocity.size(); ++i) sum += step.mass[i].x() * velocity[i].head<2>();
  return sum;
}

double kinetic(const IslandStep& step, const std::vector<Vec3>& velocity) {
  double sum = 0.0;
  for (std::size_t i = 0; i < velocity.size(); ++i)
    sum += 0.5 * velocity[i].dot(step.mass[i].cwiseProduct(velocity[i]));
  return sum;
}

TEST(StepBalance, WhatIsWonIsTakenFromThoseWhomContactsPush) {
  const IslandStep step = three_bodies();
  // more than an elastic impact gives back, which is 2 * 2 / (1 + 1 / 2)
  std::vector<Vec3> v = after(step, 2.8);
  ASSERT_GT(kinetic(step, v), kinetic(step, step.velocity));
  StepBalance balance(step, kStep, {{0, 0.0, {2.8, 0.0, 0.0}}}, v);
  EXPECT_EQ(balance.groups(), (std::vector<int>{0, 0, -1}));
  double of = 0.0;
  EXPECT_NEAR(balance.won(v, kTolerance, of), kinetic(step, v) - kinetic(step, step.velocity), 1e-14);
  EXPECT_GT(of, 0.0);
  balance.win_nothing(v, true);
  EXPECT_NEAR(kinetic(step, v), kinetic(step, step.velocity), 1e-13);
  EXPECT_NEAR((momentum(step, v) - momentum(step, step.velocity)).norm(), 0.0, 1e-14);
  EXPECT_EQ(v[2], step.velocity[2]);
}

// What bodies of one velocity have relative to each other are roundings, and so is what they won: nothing may come of it.
TEST(StepBalance, RoundingsOfOneVelocityStayRoundings) {
  IslandStep step;
  step.mass.emplace_back(1.748, 1.748, 0.1);
  step.force.emplace_back(0.0, -1.748 * 9.81, 0.0);
  step.velocity = {{0.785203778064, -4e-16, -1.4e-15}};
  IslandContact floor;
  floor.rows = contact_at(0, -1, {0.0, 1.0}, {0.1, -0.5}, {0.0, 0.0});
  floor.convex = true;
  step.contacts.push_back(floor);
  for (int k = -8; k <= 8; ++k) {
    const std::vector<Vec3> solved = {{step.velocity[0].x() + k * 1e-16, 1.4e-23, 2e-31}};
    std::vector<Vec3> v = solved;
    StepBalance balance(step, kStep, {{0, 0.0, {1.748 * 9.81 * kStep, 0.0, 0.0}}}, v);
    balance.win_nothing(v, true);
    EXPECT_NEAR((v[0] - solved[0]).norm(), 0.0, 1e-15) << k;
  }
}

TEST(StepBalance, MomentumThatTheSolverLostIsGivenBack) {
  IslandStep step = three_bodies();
  std::vector<Vec3> v = after(step, 1.0);
  v[0].x() += 1e-9;
  StepBalance balance(step, kStep, {{0, 0.0, {1.0, 0.0, 0.0}}}, v);
  balance.keep_momentum(kTolerance, v);
  EXPECT_NEAR((momentum(step, v) - momentum(step, step.velocity)).norm(), 0.0, 1e-15);
}

TEST(StepBalance, AFloorTakesMomentumAcrossAndNoneAlong) {
  IslandStep step = three_bodies();
  step.contacts[0].rows = contact_at(0, -1, {0.0, 1.0}, {0.0, -0.5}, {0.0, 0.0});
  std::vector<Vec3> v = step.velocity;
  v[0].y() = 0.0;
  StepBalance balance(step, kStep, {{0, 0.0, {-0.5, 0.0, 0.0}}}, v);
  EXPECT_EQ(balance.common_velocity(0, v), Vec2(1.0, 0.0));
}

// What two walls squeeze, by far more than what the floor under it takes, has nothing in common that no site takes.
TEST(StepBalance, WhatIsSqueezedBetweenWallsFeelsTheFloorStill) {
  IslandStep step = three_bodies();
  step.contacts.clear();
  for (const Vec2& n : {Vec2(1.0, 0.0), Vec2(-1.0, 0.0), Vec2(0.0, 1.0)}) {
    IslandContact c;
    c.rows = contact_at(0, -1, n, -0.5 * n, {0.0, 0.0});
    step.contacts.push_back(c);
  }
  step.velocity[0] = Vec3(0.0, -3.0, 0.0);
  std::vector<Vec3> v = step.velocity;
  v[0].y() = 0.0;
  StepBalance balance(step, kStep,
                      {{0, 0.0, {1e12, 0.0, 0.0}}, {1, 0.0, {1e12, 0.0, 0.0}}, {2, 0.0, {3.0, 0.0, 0.0}}}, v);
  EXPECT_EQ(balance.common_velocity(0, v), Vec2(0.0, 0.0));
  balance.keep_momentum(kTolerance, v);
  EXPECT_EQ(v[0], Vec3(0.0, 0.0, 0.0));
}

// Who is pushed by nobody but a floor pays nothing of what others win, and takes nothing of what they lose.
TEST(StepBalance, GroupsThatDoNotPushEachOtherAreBalancedApart) {
  IslandStep step = three_bodies();
  IslandContact floor;
  floor.rows = contact_at(2, -1, {0.0, 1.0}, {0.0, -0.5}, {0.0, 0.0});
  floor.convex = true;
  step.contacts.push_back(floor);
  step.force[2].y() = -40.0;
  std::vector<Vec3> v = after(step, 2.8);
  const Vec3 third = v[2];
  const std::vector<PushingContact> contacts = {{0, 0.0, {2.8, 0.0, 0.0}},
                                                {1, 0.0, {40.0 * kStep, 0.0, 0.0}}};
  StepBalance balance(step, kStep, contacts, v);
  EXPECT_EQ(balance.groups(), (std::vector<int>{0, 0, 1}));
  v[0].x() += 1e-9;
  balance.keep_momentum(kTolerance, v);
  const StepBalance::Slowed slowed = balance.win_nothing(v, true);
  EXPECT_EQ(slowed.groups[0], true);
  EXPECT_NEAR((momentum(step, v) - momentum(step, step.velocity)).norm(), 0.0, 1e-14);
  EXPECT_NEAR((v[2] - third).norm(), 0.0, 1e-15);
}

// Turned by a couple, without a push.
TEST(StepBalance, WhatIsTurnedIsPushed) {
  IslandStep step = three_bodies();
  std::vector<Vec3> v = step.velocity;
  v[0][2] += 1.0;
  EXPECT_EQ(StepBalance(step, kStep, {}, v).groups(), (std::vector<int>{0, -1, -1}));
}

// What rises to a wire's level by less than a thousandth of the tolerance is not paid for by who goes along.
TEST(StepBalance, TheRiseOfAWireIsFree) {
  IslandStep step = three_bodies();
  step.mass.resize(1);
  step.force = {Vec3(0.0, -10.0, 0.0)};
  step.velocity = {Vec3(1e-5, 0.0, 0.0)};
  IslandContact& c = step.contacts[0];
  c.rows = contact_at(0, -1, {0.0, 1.0}, {0.0, -0.5}, {0.0, 0.0});
  c.thin = true;
  c.gap = -1e-13;
  c.tolerance = 1e-14;
  std::vector<Vec3> v = {Vec3(1e-5, 1e-13 / kStep, 0.0)};
  StepBalance balance(step, kStep, {{0, 1e-13, {10.0 * kStep, 0.0, 0.0}}}, v);
  double of = 0.0;
  EXPECT_LE(balance.won(v, kTolerance, of), balance.rise_of_thin() * (1.0 + 1e-9));
  EXPECT_GT(balance.rise_of_thin(), 0.0);
}

// What one on an axle gives to another is not won: the two are a group though neither push moves the first.
TEST(StepBalance, WhatTurnsOnAnAxleIsPushedToo) {
  constexpr double kHeld = std::numeric_limits<double>::infinity();
  IslandStep step;
  step.mass = {{kHeld, kHeld, 0.5}, {1.0, 1.0, 0.1}};
  step.force = {Vec3::Zero(), Vec3::Zero()};
  step.velocity = {{0.0, 0.0, 2.0}, {0.0, 0.0, 0.0}};
  IslandContact tooth;
  // half a metre beside the axle, and under the middle of the other
  tooth.rows = contact_at(1, 0, {0.0, 1.0}, {0.0, -0.2}, {0.5, 0.0});
  step.contacts.push_back(tooth);
  // v_n = -1 m/s comes to 0
  const double impulse = 1.0 / (1.0 / 1.0 + 0.25 / 0.5);
  std::vector<Vec3> v = step.velocity;
  v[1] += impulse * tooth.rows.normal_on_body.cwiseQuotient(step.mass[1]);
  v[0] += impulse * tooth.rows.normal_on_other.cwiseQuotient(step.mass[0]);
  const StepBalance balance(step, kStep, {{0, 0.0, {impulse, 0.0, 0.0}}}, v);
  EXPECT_EQ(balance.groups(), (std::vector<int>{0, 0}));
  double of = 0.0;
  EXPECT_NEAR(balance.won(v, kTolerance, of), -0.5 * impulse, 1e-15);
  EXPECT_GT(of, 0.5);
  // by itself it is pushed as well, by a site
  step.contacts[0].rows = contact_at(0, -1, {0.0, 1.0}, {0.5, 0.0}, {0.0, 0.0});
  v = step.velocity;
  v[0][2] = 0.0;
  EXPECT_EQ(StepBalance(step, kStep, {{0, 0.0, {2.0, 0.0, 0.0}}}, v).groups(), (std::vector<int>{0, -1}));
}

double angular_momentum(const IslandStep& step, const std::vector<Vec3>& velocity) {
  double sum = 0.0;
  for (std::size_t i = 0; i < velocity.size(); ++i)
    sum += step.mass[i].x() * cross(step.place[i], Vec2(velocity[i].head<2>())) +
           step.mass[i].z() * velocity[i].z();
  return sum;
}

// Two that turn about each other, and are pushed apart by more than they had: what they won is taken from how they part, not from
// their turning.
TEST(StepBalance, TheTurningOfWhoNobodyHoldsIsKept) {
  IslandStep step = three_bodies();
  step.place = {{0.0, 0.0}, {1.0, 0.0}, {9.0, 9.0}};
  step.velocity = {{1.5, 2.0, 2.0}, {-0.5, 4.0, 2.0}, {3.0, 0.0, 1.0}};
  const double impulse = 2.8;  // see above
  std::vector<Vec3> v = after(step, impulse);
  const double turns = angular_momentum(step, v);
  const Vec2 moves = momentum(step, v);
  const StepBalance balance(step, kStep, {{0, 0.0, {impulse, 0.0, 0.0}}}, v);
  double of = 0.0;
  ASSERT_GT(balance.won(v, kTolerance, of), 0.0);
  std::vector<Vec3> all_slower = v;
  const StepBalance::Slowed slowed = balance.win_nothing(v, true);
  EXPECT_TRUE(slowed.turns[0]);
  EXPECT_NEAR(balance.won(v, kTolerance, of), 0.0, 1e-12);
  EXPECT_NEAR(angular_momentum(step, v), turns, 1e-12);
  EXPECT_NEAR((momentum(step, v) - moves).norm(), 0.0, 1e-12);
  // not asked for, it is slowed with all else
  EXPECT_FALSE(balance.win_nothing(all_slower, false).turns[0]);
  EXPECT_NEAR(balance.won(all_slower, kTolerance, of), 0.0, 1e-12);
  EXPECT_GT(std::abs(angular_momentum(step, all_slower) - turns), 1e-3);
}

// What a spring does to two that no contact pushes, along its line at the start of the step, may be more than it has stored less.
TEST(StepBalance, WhoAreJoinedBySpringsWinNothingTogether) {
  IslandStep step = three_bodies();
  const Vec3 pull(40.0, 0.0, 0.0);
  step.force = {pull, -pull, Vec3::Zero()};
  step.spending = {0.5 * pull, -0.5 * pull, Vec3::Zero()};
  std::vector<Vec3> v = step.velocity;
  for (int i = 0; i < 2; ++i) v[i] += kStep * step.force[i].cwiseQuotient(step.mass[i]);
  double of = 0.0;
  step.joined_to = {0, 0, 2};
  const StepBalance balance(step, kStep, {}, v);
  EXPECT_EQ(balance.groups(), (std::vector<int>{0, 0, -1}));
  ASSERT_GT(balance.won(v, kTolerance, of), 0.0);
  balance.win_nothing(v, true);
  EXPECT_NEAR(balance.won(v, kTolerance, of), 0.0, 1e-12);
  EXPECT_NEAR((momentum(step, v) - momentum(step, step.velocity)).norm(), 0.0, 1e-13);
}

}  // namespace
}  // namespace brink::step_balance_test
