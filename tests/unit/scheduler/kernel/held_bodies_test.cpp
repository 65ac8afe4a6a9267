// What is kept of held bodies: what they go back to, and how far they have come in a step.
#include "brink/scheduler/kernel/held_bodies.h"

#include <gtest/gtest.h>

namespace brink::held_bodies_test {
namespace {

TEST(HeldBodies, AreLetGoToWhatTheyWere) {
  HeldBodies held;
  held.add(3, {2, {}, {}});
  held.add(1, {BodyTrack::kFree, {{0.0, -10.0}, 0.0}, {}});
  std::vector<int> ids;
  held.each([&](int k, const HeldBody&) { ids.push_back(k); });
  EXPECT_EQ(ids, (std::vector{1, 3}));
  EXPECT_EQ(held.take(3).component, 2);
  EXPECT_EQ(held.take(1).acceleration.linear.y(), -10.0);
  held.each([](int k, const HeldBody&) { ADD_FAILURE() << k << " is held still"; });
}

// From 2 m/s to 6 m/s in the step from 1 s to 3 s: the motion has 6 m/s all along.
TEST(HeldBodies, ComeToTheirTwistByTheTimeThatHasGoneBy) {
  HeldBodies held;
  held.add(0, {});
  Twist at_end;
  at_end.velocity = {6.0, 0.0};
  at_end.omega = -2.0;
  HeldStep step{1.0, 3.0, {}};
  step.before.velocity = {2.0, 0.0};
  step.before.omega = 2.0;
  held.note_step(0, step);
  const auto at = [&](double now) { return held.come_to(0, now, ExtendedTwist(at_end)).rounded(); };
  EXPECT_EQ(at(1.0).velocity.x(), 2.0);
  EXPECT_EQ(at(1.5).velocity.x(), 3.0);
  EXPECT_EQ(at(2.5).omega, -1.0);
  EXPECT_EQ(at(3.0).velocity.x(), 6.0);
  EXPECT_EQ(at(0.0).velocity.x(), 2.0);
  held.forget_step(0);
  EXPECT_EQ(at(1.5).velocity.x(), 6.0);
}

}  // namespace
}  // namespace brink::held_bodies_test
