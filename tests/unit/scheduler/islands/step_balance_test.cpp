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
  const StepBalance balance(step, kStep, {{0, 0.0, {2.8, 0.0, 0.0}}}, v);
  EXPECT_EQ(balance.pushed(), (std::vector<bool>{true, true, false}));
  double of = 0.0;
  EXPECT_NEAR(balance.won(v, kTolerance, of), kinetic(step, v) - kinetic(step, step.velocity), 1e-14);
  EXPECT_GT(of, 0.0);
  balance.win_nothing(balance.common_velocity(v), v);
  EXPECT_NEAR(kinetic(step, v), kinetic(step, step.velocity), 1e-13);
  EXPECT_NEAR((momentum(step, v) - momentum(step, step.velocity)).norm(), 0.0, 1e-14);
  EXPECT_EQ(v[2], step.velocity[2]);
}

TEST(StepBalance, MomentumThatTheSolverLostIsGivenBack) {
  IslandStep step = three_bodies();
  std::vector<Vec3> v = after(step, 1.0);
  v[0].x() += 1e-9;
  const StepBalance balance(step, kStep, {{0, 0.0, {1.0, 0.0, 0.0}}}, v);
  balance.keep_momentum(kTolerance, v);
  EXPECT_NEAR((momentum(step, v) - momentum(step, step.velocity)).norm(), 0.0, 1e-15);
}

TEST(StepBalance, AFloorTakesMomentumAcrossAndNoneAlong) {
  IslandStep step = three_bodies();
  step.contacts[0].rows = contact_at(0, -1, {0.0, 1.0}, {0.0, -0.5}, {0.0, 0.0});
  std::vector<Vec3> v = step.velocity;
  v[0].y() = 0.0;
  const StepBalance balance(step, kStep, {{0, 0.0, {-0.5, 0.0, 0.0}}}, v);
  EXPECT_EQ(balance.common_velocity(v), Vec2(1.0, 0.0));
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
  const StepBalance balance(
      step, kStep, {{0, 0.0, {1e12, 0.0, 0.0}}, {1, 0.0, {1e12, 0.0, 0.0}}, {2, 0.0, {3.0, 0.0, 0.0}}}, v);
  EXPECT_EQ(balance.common_velocity(v), Vec2(0.0, 0.0));
  balance.keep_momentum(kTolerance, v);
  EXPECT_EQ(v[0], Vec3(0.0, 0.0, 0.0));
}

// Turned by a couple, without a push.
TEST(StepBalance, WhatIsTurnedIsPushed) {
  IslandStep step = three_bodies();
  std::vector<Vec3> v = step.velocity;
  v[0][2] += 1.0;
  EXPECT_EQ(StepBalance(step, kStep, {}, v).pushed(), (std::vector<bool>{true, false, false}));
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
  const StepBalance balance(step, kStep, {{0, 1e-13, {10.0 * kStep, 0.0, 0.0}}}, v);
  double of = 0.0;
  EXPECT_LE(balance.won(v, kTolerance, of), balance.rise_of_thin() * (1.0 + 1e-9));
  EXPECT_GT(balance.rise_of_thin(), 0.0);
}

}  // namespace
}  // namespace brink::step_balance_test
