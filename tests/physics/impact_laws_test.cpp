/// Single impacts with closed forms: superball, stick against slip, a rod that lands on its end.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/worlds.h"

namespace brink::impact_laws_test {
namespace {

using testing::Events;

// Garwin 1969: an elastic rough disc, I = m R^2 / 2, bouncing between floor and ceiling. Tangential velocity
// reverses at each hit; with v the speed along the floor and R omega the spin: 1, 1/3, -7/9, -23/27 and 0,
// 4/3, -8/9, -20/27.
TEST(Superball, ThreeHitsBetweenFloorAndCeilingGiveTheClosedForm) {
  const double radius = 0.5;
  World world;
  world.materials[0] = {"super", 1.0, 1e6, 1.0, 1.0, 1.0};
  testing::add(world, testing::body(make_disc(radius), {0.0, 1.0}, {1.0, -1.0}));
  testing::add(world, testing::site(make_segment({-10.0, 0.0}, {10.0, 0.0})));
  testing::add(world, testing::site(make_segment({-10.0, 2.0}, {10.0, 2.0})));
  Simulator simulator(world, {});
  const double v[] = {1.0, 1.0 / 3.0, -7.0 / 9.0, -23.0 / 27.0};
  const double spin[] = {0.0, -4.0 / 3.0, 8.0 / 9.0, 20.0 / 27.0};  // rolling forward turns clockwise
  for (int hit = 0; hit <= 3; ++hit) {
    // hits at 0.5, 1.5, 2.5 s
    ASSERT_EQ(simulator.run(testing::until(hit + 0.1)).collisions, static_cast<std::uint64_t>(hit));
    EXPECT_NEAR(simulator.state(0).twist.velocity.x(), v[hit], 1e-14) << "after hit " << hit;
    EXPECT_NEAR(radius * simulator.state(0).twist.omega, spin[hit], 1e-14) << "after hit " << hit;
  }
}

// A disc with normal speed vn and slip u at the contact: sticking needs a tangential impulse m u / 3 <= mu m
// (1+e) vn.
TEST(CoulombBounce, DiscSticksJustBelowTheBoundAndSlipsJustAboveIt) {
  const double mu = 0.2, e = 0.6, vn = 1.3, radius = 0.4;
  for (const double factor : {1.0 - 1e-12, 1.0 + 1e-12, 0.3, 2.5}) {
    const double slip = factor * 3.0 * mu * (1.0 + e) * vn;
    World world;
    world.materials[0] = {"rough", e, mu, 0.0, 1.0, 1.0};
    testing::add(world, testing::body(make_disc(radius), {0.0, radius + 1.0}, {slip, -vn}));
    testing::add(world, testing::site(make_segment({-50.0, 0.0}, {50.0, 0.0})));
    Simulator simulator(world, {});
    ASSERT_EQ(simulator.run(testing::until(2.0 / vn)).collisions, 1U);
    const Twist after = simulator.state(0).twist;
    const double left = after.velocity.x() + radius * after.omega;  // slip at the contact
    const double expected = factor <= 1.0 ? 0.0 : slip - 3.0 * mu * (1.0 + e) * vn;
    EXPECT_NEAR(left, expected, 1e-12 * slip) << "factor " << factor;
    EXPECT_NEAR(after.velocity.y(), e * vn, 1e-14);
    const double impulse = std::min(slip / 3.0, mu * (1.0 + e) * vn);
    EXPECT_NEAR(after.velocity.x(), slip - impulse, 1e-12 * slip);
  }
}

// A uniform rod, length L, falling flat at v without turning, at angle th, one end on a frictionless floor:
// omega' = 6 (1+e) v cos th / (L (1 + 3 cos^2 th)). Here with e; the sign turns the rod towards the floor.
TEST(Rod, LandingOnOneEndTurnsAtTheClosedFormRate) {
  for (const double angle : {0.1, 0.5, 1.0, 1.4})
    for (const double e : {0.0, 0.5, 1.0}) {
      const double length = 1.6, v = 2.0;
      World world;
      world.materials[0].restitution = e;
      testing::add(world, testing::body(make_chain({{-length / 2, 0.0}, {length / 2, 0.0}}), {0.0, 2.0},
                                        {0.0, -v}, 1.3, angle));
      testing::add(world, testing::site(make_segment({-50.0, 0.0}, {50.0, 0.0})));
      Simulator simulator(world, {});
      const double landing = (2.0 - 0.5 * length * std::sin(angle)) / v;
      ASSERT_EQ(simulator.run(testing::until(landing + 1e-6)).collisions, 1U);
      const double c = std::cos(angle);
      const double expected = 6.0 * (1.0 + e) * v * c / (length * (1.0 + 3.0 * c * c));
      // the lower end is the left one: the impulse up on it turns the rod clockwise
      EXPECT_NEAR(simulator.state(0).twist.omega, -expected, 1e-12 * expected)
          << "angle " << angle << " e " << e;
    }
}

}  // namespace
}  // namespace brink::impact_laws_test
