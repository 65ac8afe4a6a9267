#include "brink/scheduler/resolve/joint_contacts.h"

#include <gtest/gtest.h>

#include "brink/core/shapes/shapes.h"

namespace brink::joint_contacts_test {
namespace {

int corner_at(const Outline& outline, const Vec2& p) {
  for (int i = 0; i < static_cast<int>(outline.samples.size()); ++i)
    if (outline.samples[i].p == p) return i;
  return -1;
}

// A box whose corner is upon the end of the wire that it lies on: whatever way was taken for the normal, it is that of the
// wire, looked at from the box or from the wire.
TEST(JointContacts, ACornerOnTheEndOfAWireThatItLiesOnHasTheNormalOfThatWire) {
  const Outline box = make_box(1, 1).outline, floor = make_segment({-4, 0}, {4, 0}).outline;
  const ExtendedState at(BodyState{{{3.5, 0.5}, 0.0}, {{-0.1, 0.0}, 1.2}}), stands{BodyState{}};
  for (const Vec2& way :
       {Vec2(0.6, 0.8), Vec2(-0.6, -0.8), Vec2(1, 0), Vec2(-1, 0), Vec2(0, -1), Vec2(0, 1)}) {
    FeatureContact f;
    f.normal = way;
    f.sample_on_a = true;
    f.sample = corner_at(box, {0.5, -0.5});
    f.site = 0;
    const auto of_box = joint_contacts(box, at, floor, stands, f, 1e-10);
    ASSERT_EQ(of_box.size(), 1U);
    EXPECT_NEAR((of_box[0].normal - Vec2(0, 1)).norm(), 0.0, 1e-15) << way.transpose();
    f.sample_on_a = false;
    f.sample = corner_at(floor, {4, 0});
    f.site = 0;
    const auto of_wire = joint_contacts(box, at, floor, stands, f, 1e-10);
    ASSERT_EQ(of_wire.size(), 1U);
    EXPECT_NEAR((of_wire[0].normal - Vec2(0, 1)).norm(), 0.0, 1e-15) << way.transpose();
  }
}

// Where the wire leads away from the corner, a range of normals parts the two, and the one that was found is kept.
TEST(JointContacts, ACornerThatMeetsTheTipOfAWireKeepsTheNormalThatWasFound) {
  const Outline box = make_box(1, 1).outline, spike = make_segment({0, -2}, {0, 0}).outline;
  const ExtendedState at(BodyState{{{0.5, 0.5}, 0.0}, {{0.0, -1.0}, 0.0}}), stands{BodyState{}};
  FeatureContact f;
  f.sample_on_a = true;
  f.sample = corner_at(box, {-0.5, -0.5});
  f.site = 0;
  f.normal = Vec2(0.6, 0.8);
  const auto found = joint_contacts(box, at, spike, stands, f, 1e-10);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR((found[0].normal - Vec2(0.6, 0.8)).norm(), 0.0, 1e-15);
}

}  // namespace
}  // namespace brink::joint_contacts_test
