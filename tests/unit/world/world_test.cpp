#include "brink/core/world/world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "brink/core/base/error.h"

namespace brink::world_test {
namespace {

const Vec2 kOrigin(0.0, 0.0);

using ::testing::HasSubstr;

std::shared_ptr<Outline> disc(double radius) {
  auto outline = std::make_shared<Outline>();
  Site site;
  site.radius = radius;
  outline->sites.push_back(site);
  outline->bounding_radius = radius;
  return outline;
}

/// Two discs, a floor and one force of every kind; check() accepts it.
World good_world() {
  World world;
  world.gravity = {0.0, -9.81};
  for (const char* name : {"a", "b"}) {
    Body body;
    body.name = std::string(name);
    body.outline = disc(0.5);
    body.inertia = 0.125;
    world.bodies.push_back(body);
  }
  FixedSite site;
  site.name = std::string("floor");
  site.outline = disc(3.0);
  site.motion = FormulaMotion{Formula("0.1*sin(t)", {"t"}), {}, {}};
  world.sites.push_back(site);
  world.forces.push_back(SpringForce{0, 1, kOrigin, kOrigin, 10.0, 0.0, 1.0});
  world.forces.push_back(DragForce{{0, 1}, 0.1, 0.0, 0.0});
  world.forces.push_back(AttractForce{{0}, kOrigin, 1.0, -2.0});
  world.forces.push_back(ThrustForce{1, {1.0, 0.0}, 0.0, 0.0, 1.0});
  world.forces.push_back(FormulaForce{{0}, Formula("-x", force_formula_variables()), {}, {}});
  return world;
}

template <class T>
T& force(World& world) {
  for (Force& f : world.forces)
    if (T* found = std::get_if<T>(&f)) return *found;
  throw std::logic_error("no such force");
}

TEST(World, GoodWorldIsAccepted) { EXPECT_NO_THROW(good_world().check()); }

// Every fault names its owner and the parameter, and says what is allowed.
TEST(World, EveryFaultIsNamed) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<std::vector<std::string>, std::function<void(World&)>>> faults{
      {{"body \"a\"", "mass is 0"}, [](World& w) { w.bodies[0].mass = 0.0; }},
      {{"body \"a\"", "mass is -1"}, [](World& w) { w.bodies[0].mass = -1.0; }},
      {{"body \"a\"", "mass is inf"}, [=](World& w) { w.bodies[0].mass = inf; }},
      {{"body \"b\"", "inertia is nan"}, [=](World& w) { w.bodies[1].inertia = nan; }},
      {{"body \"a\"", "outline"}, [](World& w) { w.bodies[0].outline = nullptr; }},
      {{"body \"a\"", "material is 1", "0 to 0"}, [](World& w) { w.bodies[0].material = 1; }},
      {{"body \"a\"", "position is nan"}, [=](World& w) { w.bodies[0].initial.pose.position.y() = nan; }},
      {{"body \"a\"", "angle is inf"}, [=](World& w) { w.bodies[0].initial.pose.angle = inf; }},
      {{"body \"a\"", "velocity is inf"}, [=](World& w) { w.bodies[0].initial.twist.velocity.x() = inf; }},
      {{"body \"a\"", "angular_velocity is nan"}, [=](World& w) { w.bodies[0].initial.twist.omega = nan; }},
      {{"body \"a\"", "velocity in x is 2", "lock"},
       [](World& w) {
         w.bodies[0].lock_x = true;
         w.bodies[0].initial.twist.velocity.x() = 2.0;
       }},
      {{"body \"a\"", "spacing is -1"}, [](World& w) { w.bodies[0].sampling.spacing = -1.0; }},
      {{"body \"a\"", "twice"}, [](World& w) { w.bodies[1].name = w.bodies[0].name; }},
      {{"body \"a\"", "container"},
       [](World& w) {
         auto outline = disc(1.0);
         outline->container = true;
         w.bodies[0].outline = outline;
       }},
      {{"fixed site \"floor\"", "material is -1"}, [](World& w) { w.sites[0].material = -1; }},
      {{"fixed site \"floor\"", "outline"},
       [](World& w) { w.sites[0].outline = std::make_shared<Outline>(); }},
      {{"fixed site \"floor\"", "position is nan"}, [=](World& w) { w.sites[0].pose.position.x() = nan; }},
      {{"fixed site \"floor\"", "motion velocity is nan"},
       [=](World& w) {
         w.sites[0].motion = ConstantMotion{{{nan, 0.0}, 0.0}};
       }},
      {{"fixed site \"floor\"", "motion x = \"1/t\" is inf at t = 0"},
       [](World& w) {
         w.sites[0].motion = FormulaMotion{Formula("1/t", {"t"}), {}, {}};
       }},
      {{"material \"default\"", "restitution is 1.1", "0 to 1"},
       [](World& w) { w.materials[0].restitution = 1.1; }},
      {{"material \"default\"", "restitution is -1e-310"},  // subnormal
       [](World& w) { w.materials[0].restitution = -1e-310; }},
      {{"material \"default\"", "restitution is nan"}, [=](World& w) { w.materials[0].restitution = nan; }},
      {{"material \"default\"", "friction is -0.1"}, [](World& w) { w.materials[0].friction = -0.1; }},
      {{"material \"default\"", "tangential_restitution is -2", "-1 to 1"},
       [](World& w) { w.materials[0].tangential_restitution = -2.0; }},
      {{"material \"default\"", "slip is inf"}, [=](World& w) { w.materials[0].slip = inf; }},
      {{"world", "gravity is nan"}, [=](World& w) { w.gravity.x() = nan; }},
      {{"(spring)", "body_a is 7", "0 to 1"}, [](World& w) { force<SpringForce>(w).body_a = 7; }},
      {{"(spring)", "body_b", "is 2"}, [](World& w) { force<SpringForce>(w).body_b = 2; }},
      {{"(spring)", "itself"}, [](World& w) { force<SpringForce>(w).body_b = 0; }},
      {{"(spring)", "stiffness is -1"}, [](World& w) { force<SpringForce>(w).stiffness = -1.0; }},
      {{"(spring)", "rest_length is nan"}, [=](World& w) { force<SpringForce>(w).rest_length = nan; }},
      {{"(drag)", "linear is -1"}, [](World& w) { force<DragForce>(w).linear = -1.0; }},
      {{"(drag)", "bodies is 9"}, [](World& w) { force<DragForce>(w).bodies = {9}; }},
      {{"(drag)", "twice"},
       [](World& w) {
         force<DragForce>(w).bodies = {1, 1};
       }},
      {{"(attract)", "power is nan"}, [=](World& w) { force<AttractForce>(w).power = nan; }},
      {{"(thrust)", "to is 0"}, [](World& w) { force<ThrustForce>(w).to = 0.0; }},
      {{"(thrust)", "body is -1"}, [](World& w) { force<ThrustForce>(w).body = -1; }},
      {{"(formula)", "no formula"}, [](World& w) { force<FormulaForce>(w).fx.reset(); }},
  };
  for (const auto& [words, spoil] : faults) {
    World world = good_world();
    spoil(world);
    try {
      world.check();
      ADD_FAILURE() << "accepted: " << words[0] << " " << words[1];
    } catch (const BadInput& error) {
      for (const std::string& word : words) EXPECT_THAT(error.what(), HasSubstr(word));
    }
  }
}

TEST(World, UnnamedThingsMayShareTheirEmptyName) {
  World world = good_world();
  for (Body& body : world.bodies) body.name.clear();
  EXPECT_NO_THROW(world.check());
}

TEST(World, LengthIsTheLargestBodyDiameter) {
  World world = good_world();
  world.bodies[1].outline = disc(0.75);
  EXPECT_EQ(world.length(), 1.5);
}

TEST(World, LengthOfPointBodiesIsTheSitesAndNeverZero) {
  World world = good_world();
  world.bodies[0].outline = world.bodies[1].outline = disc(0.0);
  EXPECT_EQ(world.length(), 6.0);
  world.sites.clear();
  EXPECT_EQ(world.length(), 1.0);
}

TEST(Combined, RulesAreTheWorlds) {
  World world;
  world.materials = {{"steel", 0.9, 0.4, 0.5, 0.5, 2.0}, {"rubber", 0.2, 0.9, -1.0, 0.25, 3.0}};
  const Material pair = combined(world, 0, 1);
  EXPECT_EQ(pair.restitution, 0.9);
  EXPECT_DOUBLE_EQ(pair.friction, 0.6);
  EXPECT_EQ(pair.tangential_restitution, 0.5);
  EXPECT_EQ(pair.slip, 0.125);
  EXPECT_EQ(pair.spin, 6.0);
  const auto friction = [&](Combine rule) {
    world.friction_rule = rule;
    EXPECT_EQ(combined(world, 0, 1).friction, combined(world, 1, 0).friction);
    return combined(world, 0, 1).friction;
  };
  EXPECT_EQ(friction(Combine::max), 0.9);
  EXPECT_EQ(friction(Combine::min), 0.4);
  EXPECT_DOUBLE_EQ(friction(Combine::mean), 0.65);
  EXPECT_DOUBLE_EQ(friction(Combine::product), 0.36);
}

}  // namespace
}  // namespace brink::world_test
