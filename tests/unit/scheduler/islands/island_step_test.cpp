// One step of an island: contacts that part slowly, and gaps that dip between two looks along the step.
#include "brink/scheduler/islands/island_step.h"

#include <gtest/gtest.h>

namespace brink::island_step_test {
namespace {

constexpr double kTolerance = 2e-10;

/// A body of 1 kg and 1 kg m^2 over a floor, under no force; contacts at both its feet.
IslandStep over_floor(double gap, const Vec3& velocity) {
  IslandStep step;
  step.mass = {Vec3(1.0, 1.0, 1.0)};
  step.velocity = {velocity};
  step.force = {Vec3::Zero()};
  for (const double x : {-1.0, 1.0}) {
    IslandContact contact;
    contact.rows = contact_at(0, -1, {0.0, 1.0}, {x, -0.5}, {x, 0.0});
    contact.gap = gap;
    step.contacts.push_back(contact);
  }
  return step;
}

// Nobody presses, so the velocities stay as they are to the bit, however much longer the step is than what parts.
TEST(IslandStep, ContactsThatPartSlowlyGoOnAsTheyDo) {
  for (const double h : {1e-3, 1.0, 1122.0, 1e6}) {
    const Vec3 velocity(0.0, 1.2e-8, -3e-14);
    IslandStep step = over_floor(6.7e-9, velocity);
    ConeQp solver;
    const GapAlong gap = [](std::size_t k, double later, const std::vector<Vec3>& v) {
      return 6.7e-9 + later * (v[0].y() + (k == 0 ? -1.0 : 1.0) * v[0].z());
    };
    ASSERT_TRUE(take_step(solver, step, h, kTolerance, gap).solved) << h;
    EXPECT_NEAR(step.velocity[0].y(), 1.2e-8, 1e-10) << h;
    for (const IslandContact& c : step.contacts) EXPECT_LE(c.normal_force * h, 1e-9) << h;
  }
}

// The gap falls along a parabola to a corner at 0.36 of the step, below 0, and rises from there: of eight looks none
// is near it.
TEST(IslandStep, GapThatDipsBetweenTwoLooksIsKept) {
  const double h = 0.01;
  IslandStep step = over_floor(1.2e-6, Vec3(1.0, 0.0, 0.0));
  const GapAlong gap = [&](std::size_t, double later, const std::vector<Vec3>& v) {
    const double s = later / h, fall = s / 0.36;
    return (s < 0.36 ? 1.2e-6 - 1.4e-6 * fall * fall : -2e-7 + 4e-5 * (s - 0.36)) + later * v[0].y();
  };
  ASSERT_LT(gap(0, 0.36 * h, step.velocity), -1.9e-7);
  ConeQp solver;
  ASSERT_TRUE(take_step(solver, step, h, kTolerance, gap).solved);
  for (int i = 0; i <= 10000; ++i) ASSERT_GE(gap(0, h * i / 10000.0, step.velocity), -kTolerance) << i;
}

// Wherever it is stopped, there is no step, and the problem is as it was.
TEST(IslandStep, StoppedIsNone) {
  const GapAlong gap = [](std::size_t k, double later, const std::vector<Vec3>& v) {
    return 1e-3 + later * (v[0].y() + (k == 0 ? -1.0 : 1.0) * v[0].z());
  };
  const auto take = [&](int most, int& asked) {
    IslandStep step = over_floor(1e-3, Vec3(0.0, -1.0, 0.1));
    ConeQp solver;
    const bool solved = take_step(solver, step, 0.01, kTolerance, gap, [&] { return asked++ < most; }).solved;
    EXPECT_EQ(step.velocity[0] == Vec3(0.0, -1.0, 0.1), !solved);
    return solved;
  };
  int needed = 0;
  ASSERT_TRUE(take(1000, needed));
  EXPECT_GT(needed, 2);
  for (int most = 0; most < needed; ++most) {
    int asked = 0;
    EXPECT_FALSE(take(most, asked));
    EXPECT_EQ(asked, most + 1);
  }
}

}  // namespace
}  // namespace brink::island_step_test
