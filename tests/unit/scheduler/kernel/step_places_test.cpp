// Gaps along a step, asked for contact after contact: what is kept between them changes none.
#include "brink/scheduler/kernel/step_places.h"

#include <gtest/gtest.h>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::step_places_test {
namespace {

using namespace testing;

/// Boxes that turn on a floor that moves, two of them across the edge of a periodic world.
World boxes() {
  World world = on_floor(make_box(1.0, 1.0));
  world.periods.size = {40.0, 0.0};
  world.sites[0].motion = ConstantMotion{{{0.5, 0.0}, 0.1}};
  add(world, body(make_box(1.0, 1.0), {1.0, 0.5}, {0.0, 0.0}));
  add(world, body(make_box(1.0, 1.0), {19.6, 0.5}, {0.0, 0.0}));
  add(world, body(make_box(1.0, 1.0), {-19.4, 0.5}, {0.0, 0.0}));
  return world;
}

TEST(StepPlaces, GapsAreThoseOfEachContactByItselfToTheBit) {
  KernelParts parts(boxes(), {});
  hold(parts, {0, 1, 2, 3});
  const IslandMembers members = members_of(parts, {0, 1, 2, 3});
  const std::vector<HeldContact> contacts = members.contacts(1e-2);
  int images = 0;
  for (const HeldContact& c : contacts) images += c.pair.image != Image{};
  ASSERT_GE(images, 1);
  const std::vector<Vec3> velocity = {
      {0.3, -0.1, 1.0}, {-0.2, 0.4, -3.0}, {0.1, 0.7, 0.2}, {1.0, -1.0, 700.0}};
  StepPlaces places(members, velocity);
  for (int round = 0; round < 2; ++round)  // what is new, and what is known
    for (int look = 0; look < 30; ++look)  // more moments than are kept
      for (const HeldContact& c : contacts) {
        const double later = 0.01 * look / 8.0;
        ASSERT_EQ(places.gap(c, later), members.gap(c, later, velocity)) << look;
      }
}

}  // namespace
}  // namespace brink::step_places_test
