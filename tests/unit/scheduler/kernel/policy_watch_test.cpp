// A policy is held to the contacts that it has been told of.
#include "brink/scheduler/kernel/policy_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "brink/core/base/error.h"
#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::policy_watch_test {
namespace {

using namespace testing;

TEST(PolicyWatch, GoingPastAKnownContactThrowsAndNamesIt) {
  KernelParts parts(two_discs(), {});
  parts.policy_watch.found(meeting(parts));
  EXPECT_NO_THROW(parts.policy_watch.going_to(2.0)) << "it has not begun";
  parts.policy_watch.begin();
  parts.policy_watch.found(meeting(parts));
  EXPECT_NO_THROW(parts.policy_watch.going_to(0.5));
  try {
    parts.policy_watch.going_to(2.0);
    FAIL();
  } catch (const BadInput& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("'body0' on 'body1' meet at t = "));
  }
}

TEST(PolicyWatch, AContactOfAMotionThatHasEndedIsForgotten) {
  KernelParts parts(two_discs(), {});
  parts.policy_watch.begin();
  parts.policy_watch.found(meeting(parts));
  parts.trajectories.restart_free(0, {}, {});
  EXPECT_NO_THROW(parts.policy_watch.going_to(2.0));
}

TEST(PolicyWatch, ComingBackTooEarlyThrows) {
  KernelParts parts(two_discs(), {});
  parts.policy_watch.begin();
  EXPECT_NO_THROW(parts.policy_watch.returned(1.0, 1.0));
  EXPECT_THROW(parts.policy_watch.returned(0.5, 1.0), BadInput);
}

}  // namespace
}  // namespace brink::policy_watch_test
