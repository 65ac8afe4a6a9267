#include "brink/core/world/forces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/base/random.h"

namespace brink::forces_test {
namespace {

const Vec2 kOrigin(0.0, 0.0);

using ::testing::ElementsAre;

World world_of(int count) {
  World world;
  for (int k = 0; k < count; ++k) {
    Body body;
    body.mass = 2.0 + k;
    body.inertia = 0.5 + k;
    world.bodies.push_back(body);
  }
  return world;
}

std::vector<Acceleration> accelerations(const Dynamics& dynamics, double t,
                                        std::span<const BodyState> states) {
  std::vector<Acceleration> out(states.size());
  dynamics.accelerations(t, states, out);
  return out;
}
Acceleration acceleration(const World& world, double t, const BodyState& state) {
  return accelerations(*make_components(world)[0].dynamics, t, {&state, 1})[0];
}

TEST(Components, SpringsJoinBodiesAndAllElseIsAlone) {
  World world = world_of(6);
  world.forces.push_back(SpringForce{4, 2});
  world.forces.push_back(SpringForce{2, 0});
  world.forces.push_back(SpringForce{5, -1});  // an anchor joins nobody
  world.forces.push_back(DragForce{{1, 3}, 1.0});
  const auto components = make_components(world);
  ASSERT_EQ(components.size(), 4u);
  EXPECT_THAT(components[0].bodies, ElementsAre(0, 2, 4));
  EXPECT_THAT(components[1].bodies, ElementsAre(1));
  EXPECT_THAT(components[2].bodies, ElementsAre(3));
  EXPECT_THAT(components[3].bodies, ElementsAre(5));
  EXPECT_EQ(components[0].dynamics->size(), 3);
}

TEST(Components, WorldWithoutBodiesHasNone) { EXPECT_TRUE(make_components(World{}).empty()); }

// 10 000 bodies under one drag force must not cost 10 000 copies of its list of bodies.
TEST(Components, ManyBodiesUnderOneForceAreCheap) {
  World world = world_of(20000);
  DragForce drag{{}, 1.0};
  for (int k = 0; k < 20000; ++k) drag.bodies.push_back(k);
  world.forces.push_back(drag);
  EXPECT_EQ(make_components(world).size(), 20000u);
}

TEST(Dynamics, UniformGravityIsConstantAndWithoutBreaks) {
  World world = world_of(1);
  world.gravity = {1.0, -9.81};
  const auto component = make_components(world)[0];
  EXPECT_TRUE(component.dynamics->constant());
  EXPECT_EQ(component.dynamics->next_break(0.0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(acceleration(world, 3.0, {}).linear, Vec2(1.0, -9.81));
}

// Two bodies 2 m apart on a spring of 10 N/m and rest length 1: 10 N inwards; masses 2 and 3 kg.
TEST(Dynamics, SpringPullsBothEndsWithTheSameForce) {
  World world = world_of(2);
  world.forces.push_back(SpringForce{0, 1, kOrigin, kOrigin, 10.0, 0.0, 1.0});
  const std::vector<BodyState> states{{}, {{{2.0, 0.0}, 0.0}, {}}};
  const auto a = accelerations(*make_components(world)[0].dynamics, 0.0, states);
  EXPECT_DOUBLE_EQ(a[0].linear.x(), 5.0);
  EXPECT_DOUBLE_EQ(a[1].linear.x(), -10.0 / 3.0);
  EXPECT_EQ(a[0].angular, 0.0);
}

// Attached at (0, 1) in a frame turned by 90 degrees: that is (-1, 0) in the world. The anchor is at (-1, 3),
// 3 m above: force 3 * 4 N up; torque (-1, 0) x (0, 12) = -12 N m.
TEST(Dynamics, SpringOffTheCentreTurnsTheBody) {
  World world = world_of(1);
  world.forces.push_back(SpringForce{0, -1, {0.0, 1.0}, {-1.0, 3.0}, 4.0, 0.0, 0.0});
  const double right_angle = 0.5 * 3.14159265358979323846;
  const Acceleration a = acceleration(world, 0.0, {{{0.0, 0.0}, right_angle}, {}});
  EXPECT_NEAR(a.linear.x(), 0.0, 1e-14);
  EXPECT_NEAR(a.linear.y(), 6.0, 1e-14);
  EXPECT_NEAR(a.angular, -24.0, 1e-13);
}

// The damper feels the closing speed of its ends only: 1.5 m/s apart * 2 N s/m = 3 N inwards, nothing
// sideways.
// As large as it is halfway, along the line at the start: forces and torques there have no moment about anything.
TEST(Dynamics, SpringAlongTheLineOfTheStartTakesNoAngularMomentum) {
  World world = world_of(2);
  world.forces.push_back(SpringForce{0, 1, {0.1, 0.2}, {-0.3, 0.0}, 10.0, 0.5, 0.7});
  const std::vector<BodyState> start = {{{{0.0, 0.0}, 0.3}, {{1.0, 2.0}, 3.0}},
                                        {{{2.0, 1.0}, -1.0}, {{-1.0, 0.5}, -2.0}}};
  std::vector<BodyState> halfway = start;
  for (BodyState& s : halfway) {
    s.pose.position += 0.1 * s.twist.velocity;
    s.pose.angle += 0.1 * s.twist.omega;
  }
  const auto dynamics = make_components(world)[0].dynamics;
  std::vector<Acceleration> along(2);
  dynamics->accelerations_along(0.0, start, halfway, along);
  const std::vector<Acceleration> there = accelerations(*dynamics, 0.0, halfway);
  double moment = 0.0, moment_there = 0.0;
  for (int k = 0; k < 2; ++k) {
    const Body& b = world.bodies[k];
    moment += b.mass * cross(start[k].pose.position, along[k].linear) + b.inertia * along[k].angular;
    moment_there += b.mass * cross(start[k].pose.position, there[k].linear) + b.inertia * there[k].angular;
  }
  EXPECT_NEAR(moment, 0.0, 1e-14);
  EXPECT_GT(std::abs(moment_there), 0.1);
  EXPECT_NEAR(along[0].linear.norm(), there[0].linear.norm(), 1e-14);
  EXPECT_NEAR((world.bodies[0].mass * along[0].linear + world.bodies[1].mass * along[1].linear).norm(), 0.0,
              1e-14);
  // where both are the same it is the force there
  dynamics->accelerations_along(0.0, halfway, halfway, along);
  EXPECT_EQ(along[1].angular, there[1].angular);
}

TEST(Dynamics, DamperActsAlongTheSpring) {
  World world = world_of(1);
  world.forces.push_back(SpringForce{0, -1, kOrigin, kOrigin, 0.0, 2.0, 1.0});
  const Acceleration a = acceleration(world, 0.0, {{{3.0, 0.0}, 0.0}, {{1.5, 7.0}, 0.0}});
  EXPECT_DOUBLE_EQ(a.linear.x(), -1.5);
  EXPECT_EQ(a.linear.y(), 0.0);
}

TEST(Dynamics, SpringOfNoLengthGivesNoForce) {
  World world = world_of(1);
  world.forces.push_back(SpringForce{0, -1, kOrigin, kOrigin, 10.0, 1.0, 1.0});
  EXPECT_EQ(acceleration(world, 0.0, {}).linear, Vec2(0.0, 0.0));
}

// -(linear + quadratic |v|) v / m at v = (3, 4): -(1 + 2 * 5) * (3, 4) / 2; torque -0.5 * 2 / 0.5.
TEST(Dynamics, DragIsLinearPlusQuadratic) {
  World world = world_of(1);
  world.forces.push_back(DragForce{{0}, 1.0, 2.0, 0.5});
  const Acceleration a = acceleration(world, 0.0, {{}, {{3.0, 4.0}, 2.0}});
  EXPECT_DOUBLE_EQ(a.linear.x(), -16.5);
  EXPECT_DOUBLE_EQ(a.linear.y(), -22.0);
  EXPECT_DOUBLE_EQ(a.angular, -2.0);
}

// strength r^power at r = 2, inwards, whatever the mass.
TEST(Dynamics, AttractorIsAPowerOfTheDistance) {
  for (double power : {-2.0, -1.0, 0.0, 1.0, 3.0}) {
    World world = world_of(1);
    world.forces.push_back(AttractForce{{0}, {1.0, 0.0}, 5.0, power});
    const Acceleration a = acceleration(world, 0.0, {{{3.0, 0.0}, 0.0}, {}});
    EXPECT_DOUBLE_EQ(a.linear.x(), -5.0 * std::pow(2.0, power));
    const Acceleration center = acceleration(world, 0.0, {{{1.0, 0.0}, 0.0}, {}});
    EXPECT_EQ(center.linear.allFinite(), power >= 0.0) << power;
  }
}

// [from, to): on at from, off at to. Breaks are told one after the other.
TEST(Dynamics, ThrustActsInItsWindowAndTellsItsBreaks) {
  World world = world_of(1);
  world.forces.push_back(ThrustForce{0, {4.0, 0.0}, 1.0, 1.0, 2.0});
  EXPECT_EQ(acceleration(world, 0.999, {}).linear.x(), 0.0);
  EXPECT_EQ(acceleration(world, 1.0, {}).linear.x(), 2.0);
  EXPECT_EQ(acceleration(world, 1.0, {}).angular, 2.0);
  EXPECT_EQ(acceleration(world, 2.0, {}).linear.x(), 0.0);
  const auto component = make_components(world)[0];
  EXPECT_TRUE(component.dynamics->constant());
  EXPECT_EQ(component.dynamics->next_break(0.0), 1.0);
  EXPECT_EQ(component.dynamics->next_break(1.0), 2.0);
  EXPECT_EQ(component.dynamics->next_break(2.0), std::numeric_limits<double>::infinity());
}

TEST(Dynamics, FormulaForceSeesTimeStateAndMass) {
  World world = world_of(1);
  world.forces.push_back(FormulaForce{{0},
                                      Formula("m*(t + 10*x + 100*y)", force_formula_variables()),
                                      Formula("m*(vx + 10*vy)", force_formula_variables()),
                                      Formula("0.5*(angle + 10*omega)", force_formula_variables())});
  const Acceleration a = acceleration(world, 1.0, {{{2.0, 3.0}, 4.0}, {{5.0, 6.0}, 7.0}});
  EXPECT_DOUBLE_EQ(a.linear.x(), 321.0);
  EXPECT_DOUBLE_EQ(a.linear.y(), 65.0);
  EXPECT_DOUBLE_EQ(a.angular, 74.0);
  EXPECT_FALSE(make_components(world)[0].dynamics->constant());
  EXPECT_FALSE(make_components(world)[0].dynamics->linear_drag(0.0).valid);
}

TEST(Dynamics, LockedCoordinatesHaveNoAcceleration) {
  World world = world_of(1);
  world.gravity = {1.0, -9.81};
  world.forces.push_back(ThrustForce{0, {1.0, 1.0}, 1.0});
  world.bodies[0].lock_x = world.bodies[0].lock_angle = true;
  const Acceleration a = acceleration(world, 0.0, {});
  EXPECT_EQ(a.linear.x(), 0.0);
  EXPECT_EQ(a.angular, 0.0);
  EXPECT_NE(a.linear.y(), 0.0);
}

// The closed form's own equation must be the acceleration: drive - linear v at any v.
TEST(Dynamics, LinearDragIsRecognizedWithGravityAndThrust) {
  World world = world_of(1);
  world.gravity = {0.0, -9.81};
  world.forces.push_back(DragForce{{0}, 1.0, 0.0, 0.25});
  world.forces.push_back(DragForce{{0}, 0.5, 0.0, 0.0});
  world.forces.push_back(ThrustForce{0, {4.0, 0.0}, 1.0, 1.0, 2.0});
  const auto dynamics = make_components(world)[0].dynamics;
  EXPECT_FALSE(dynamics->constant());
  for (double t : {0.0, 1.5}) {
    const auto form = dynamics->linear_drag(t);
    ASSERT_TRUE(form.valid);
    EXPECT_EQ(form.linear, 0.75);
    EXPECT_EQ(form.angular, 0.5);
    const BodyState state{{{1.0, 2.0}, 3.0}, {{4.0, 5.0}, 6.0}};
    const Acceleration a = acceleration(world, t, state);
    EXPECT_LT((form.drive.linear - form.linear * state.twist.velocity - a.linear).norm(), 1e-13);
    EXPECT_NEAR(form.drive.angular - form.angular * 6.0, a.angular, 1e-13);
  }
  std::get<DragForce>(world.forces[0]).quadratic = 0.1;
  EXPECT_FALSE(make_components(world)[0].dynamics->linear_drag(0.0).valid);
}

// Forces that store energy are minus its gradient: central differences of total_energy agree with m a and I
// alpha.
TEST(Energy, ForcesAreItsGradient) {
  World world = world_of(2);
  world.gravity = {0.5, -9.81};
  world.forces.push_back(SpringForce{0, 1, {0.2, 0.1}, {-0.3, 0.4}, 10.0, 0.0, 0.7});
  world.forces.push_back(SpringForce{1, -1, {0.1, 0.0}, {2.0, 2.0}, 3.0, 0.0, 0.5});
  for (double power : {-2.0, -1.0, 0.5, 2.0})
    world.forces.push_back(AttractForce{{0, 1}, {-1.0, 1.0}, 1.5, power});
  EXPECT_TRUE(conservative(world));
  const std::vector<BodyState> states{{{{0.3, -0.2}, 0.4}, {}}, {{{1.5, 0.6}, -0.7}, {}}};
  const auto a = accelerations(*make_components(world)[0].dynamics, 0.0, states);
  const double h = 1e-5;
  for (int k = 0; k < 2; ++k) {
    const auto slope = [&](auto coordinate) {
      auto up = states, down = states;
      coordinate(up[k].pose) += h;
      coordinate(down[k].pose) -= h;
      return (total_energy(world, up) - total_energy(world, down)) / (2.0 * h);
    };
    const Body& body = world.bodies[k];
    EXPECT_NEAR(slope([](Pose& p) -> double& { return p.position.x(); }), -body.mass * a[k].linear.x(), 1e-7);
    EXPECT_NEAR(slope([](Pose& p) -> double& { return p.position.y(); }), -body.mass * a[k].linear.y(), 1e-7);
    EXPECT_NEAR(slope([](Pose& p) -> double& { return p.angle; }), -body.inertia * a[k].angular, 1e-7);
  }
}

// m v^2 / 2 + I w^2 / 2 + m g h = 2 * 25 / 2 + 0.5 * 4 / 2 + 2 * 10 * 3 = 86 J.
TEST(Energy, KineticAndGravityByHand) {
  World world = world_of(1);
  world.gravity = {0.0, -10.0};
  const BodyState state{{{7.0, 3.0}, 0.0}, {{3.0, 4.0}, 2.0}};
  EXPECT_DOUBLE_EQ(total_energy(world, {&state, 1}), 86.0);
}

// p = 2 (3, 4); L = (7 * 8 - 3 * 6) + 0.5 * 2 = 39.
TEST(Momentum, ByHand) {
  const World world = world_of(1);
  const BodyState state{{{7.0, 3.0}, 0.0}, {{3.0, 4.0}, 2.0}};
  const Momentum momentum = total_momentum(world, {&state, 1});
  EXPECT_EQ(momentum.linear, Vec2(6.0, 8.0));
  EXPECT_DOUBLE_EQ(momentum.angular, 39.0);
}

TEST(Conservative, DragDampingThrustAndFormulaAreNot) {
  const auto with = [](Force force) {
    World world = world_of(2);
    world.forces.push_back(std::move(force));
    return conservative(world);
  };
  EXPECT_TRUE(conservative(world_of(1)));
  EXPECT_TRUE(with(SpringForce{0, 1, kOrigin, kOrigin, 1.0, 0.0, 0.0}));
  EXPECT_TRUE(with(AttractForce{{0}}));
  EXPECT_FALSE(with(SpringForce{0, 1, kOrigin, kOrigin, 1.0, 0.5, 0.0}));
  EXPECT_FALSE(with(DragForce{{0}, 0.1}));
  EXPECT_FALSE(with(ThrustForce{0, {1.0, 0.0}}));
  EXPECT_FALSE(with(FormulaForce{{0}, Formula("1", force_formula_variables()), {}, {}}));
}

}  // namespace
}  // namespace brink::forces_test
