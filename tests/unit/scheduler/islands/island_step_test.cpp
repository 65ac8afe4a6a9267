// One step of an island: contacts that part slowly, and gaps that dip between two looks along the step.
#include "brink/scheduler/islands/island_step.h"

#include <gtest/gtest.h>

#include <functional>

namespace brink::island_step_test {
namespace {

constexpr double kTolerance = 2e-10;

/// The gap of contact k so long into a step with these velocities.
using GapOf = std::function<double(std::size_t k, double later, const std::vector<Vec3>& velocity)>;

GapsAlong along(const GapOf& gap) {
  return [gap](const std::vector<Vec3>& v) {
    return [gap, &v](std::size_t k, double later) { return gap(k, later, v); };
  };
}

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
    contact.tolerance = kTolerance;
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
    const GapOf gap = [](std::size_t k, double later, const std::vector<Vec3>& v) {
      return 6.7e-9 + later * (v[0].y() + (k == 0 ? -1.0 : 1.0) * v[0].z());
    };
    ASSERT_TRUE(take_step(solver, step, h, kTolerance, along(gap)).solved) << h;
    EXPECT_NEAR(step.velocity[0].y(), 1.2e-8, 1e-10) << h;
    for (const IslandContact& c : step.contacts) EXPECT_LE(c.normal_force * h, 1e-9) << h;
  }
}

// The gap falls along a parabola to a corner at 0.36 of the step, below 0, and rises from there: of eight looks none
// is near it.
TEST(IslandStep, GapThatDipsBetweenTwoLooksIsKept) {
  const double h = 0.01;
  IslandStep step = over_floor(1.2e-6, Vec3(1.0, 0.0, 0.0));
  const GapOf gap = [&](std::size_t, double later, const std::vector<Vec3>& v) {
    const double s = later / h, fall = s / 0.36;
    return (s < 0.36 ? 1.2e-6 - 1.4e-6 * fall * fall : -2e-7 + 4e-5 * (s - 0.36)) + later * v[0].y();
  };
  ASSERT_LT(gap(0, 0.36 * h, step.velocity), -1.9e-7);
  ConeQp solver;
  ASSERT_TRUE(take_step(solver, step, h, kTolerance, along(gap)).solved);
  for (int i = 0; i <= 10000; ++i) ASSERT_GE(gap(0, h * i / 10000.0, step.velocity), -kTolerance) << i;
}

// However much of a lift is lost again: the gap opens by little more than half of what its contact aims higher.
TEST(IslandStep, LiftsOfWhichPartIsLostReachTheGap) {
  const double h = 0.01, lost = 0.45, misses = 1e-4;
  IslandStep step = over_floor(0.0, Vec3(0.0, -1.0, 0.0));
  const GapOf gap = [&](std::size_t, double later, const std::vector<Vec3>& v) {
    return (1.0 - lost) * later * v[0].y() - misses * later / h;
  };
  ConeQp solver;
  ASSERT_TRUE(take_step(solver, step, h, kTolerance, along(gap)).solved);
  for (int i = 0; i <= 8; ++i) EXPECT_GE(gap(0, h * i / 8.0, step.velocity), -kTolerance);
  EXPECT_NEAR(step.velocity[0].y(), misses / h / (1.0 - lost), 1e-3);
}

// At a wire it keeps the gap that it has to the touching distance, far below the tolerance of places; and rises to what it
// must keep in a step in which that costs little.
TEST(IslandStep, GapAtAWireIsKeptFinely) {
  constexpr double kTouch = 1e-3 * kTolerance;
  for (const double h : {1e-7, 1e-2}) {
    const double sinks = h > 1e-3 ? 0.5 * kTolerance : 0.0;            // of a face that turns, say
    IslandStep step = over_floor(-8.0 * kTouch, Vec3(1.0, 0.0, 0.0));  // it has what that costs
    step.force[0].y() = -9.81;
    for (IslandContact& c : step.contacts) {
      c.tolerance = 0.125 * kTouch;
      c.thin = true;
    }
    const GapOf gap = [&](std::size_t, double later, const std::vector<Vec3>& v) {
      return -8.0 * kTouch + later * v[0].y() - sinks * later / h * later / h;
    };
    ConeQp solver;
    ASSERT_TRUE(take_step(solver, step, h, kTolerance, along(gap)).solved) << h;
    const double least = h > 1e-3 ? 0.0 : -8.0 * kTouch;
    const double ends = gap(0, h, step.velocity);
    EXPECT_GE(ends, least - 0.125 * kTouch) << h;
    EXPECT_LE(ends, least + 2e-3 * sinks) << h;  // corrections aim a thousandth too high
  }
}

// A contact that nobody came to at first is listed where an impulse leads to it, and bars the way as the others do.
TEST(IslandStep, ContactThatIsListedLateBarsTheWay) {
  const double h = 0.01, far = 0.02;
  // the heavy one drives the light one before it towards a wall
  IslandStep step;
  step.mass = {Vec3(1.0, 1.0, 1.0), Vec3(100.0, 100.0, 100.0)};
  step.velocity = {Vec3(0.0, 0.0, 0.0), Vec3(5.0, 0.0, 0.0)};
  step.force = {Vec3::Zero(), Vec3::Zero()};
  IslandContact hit;
  hit.tolerance = kTolerance;
  hit.rows = contact_at(0, 1, {1.0, 0.0}, Vec2::Zero(), Vec2::Zero());
  step.contacts.push_back(hit);
  IslandContact wall;
  wall.rows = contact_at(0, -1, {-1.0, 0.0}, Vec2::Zero(), Vec2::Zero());
  wall.gap = far;
  wall.tolerance = kTolerance;
  const GapOf gap = [&](std::size_t k, double later, const std::vector<Vec3>& v) {
    return k == 0 ? later * (v[0].x() - v[1].x()) : far - later * v[0].x();
  };
  int listed = 0;
  const ListFarther farther = [&](const std::vector<Vec3>& v) {
    if (h * v[0].x() > 0.5 * far && step.contacts.size() == 1) {
      step.contacts.push_back(wall);
      ++listed;
    }
  };
  ConeQp solver;
  ASSERT_TRUE(take_step(solver, step, h, kTolerance, along(gap), {}, farther).solved);
  EXPECT_EQ(listed, 1);
  EXPECT_NEAR(step.velocity[0].x(), far / h, 1e-8);
  EXPECT_NEAR(step.velocity[1].x(), far / h, 1e-8);
  EXPECT_NEAR(step.contacts[1].normal_force * h, 100.0 * (5.0 - far / h) - far / h, 1e-6);
}

// Wherever it is stopped, there is no step, and the problem is as it was.
TEST(IslandStep, StoppedIsNone) {
  const GapOf gap = [](std::size_t k, double later, const std::vector<Vec3>& v) {
    return 1e-3 + later * (v[0].y() + (k == 0 ? -1.0 : 1.0) * v[0].z());
  };
  const auto take = [&](int most, int& asked) {
    IslandStep step = over_floor(1e-3, Vec3(0.0, -1.0, 0.1));
    ConeQp solver;
    const bool solved =
        take_step(solver, step, 0.01, kTolerance, along(gap), [&] { return asked++ < most; }).solved;
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
