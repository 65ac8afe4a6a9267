// Collisions ahead of time: kept, confirmed, undone.
#include "brink/scheduler/kernel/speculation.h"

#include <gtest/gtest.h>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::speculation_test {
namespace {

using namespace testing;

/// Resolves the discs' meeting ahead of time, as the kernel does.
Speculation::Entry resolve_ahead(KernelParts& parts, const Certificate& c) {
  parts.run.set_time(c.time);
  const Speculation::Entry entry = parts.speculation.before(c.pair);
  std::vector<int> changed;
  entry->outcome = *parts.response.collide(c.pair, c.contact, changed);
  entry->end = 4.0;
  parts.speculation.add(entry);
  parts.run.set_time(0.0);
  return entry;
}

TEST(Speculation, FormerMotionsAreCertainUntilTheyAreUndoneOrConfirmed) {
  KernelParts parts(two_discs(), {});
  const Certificate c = meeting(parts);
  const Speculation::Entry entry = resolve_ahead(parts, c);
  EXPECT_EQ(parts.speculation.kept(), 2U);
  EXPECT_EQ(parts.speculation.certain(0).version, 0U);
  EXPECT_EQ(parts.speculation.versions(0), (std::vector<std::uint64_t>{0, 1}));
  EXPECT_EQ(parts.speculation.end_of_version(0, 0), c.time);
  EXPECT_TRUE(std::isinf(*parts.speculation.end_of_version(0, 1)));
  EXPECT_FALSE(parts.speculation.end_of_version(0, 5));
  EXPECT_EQ(parts.speculation.track(1, 0)->motion.twist(0.0).velocity.x(), 0.0);
  EXPECT_TRUE(is_fresh(parts.speculation, c));
  parts.speculation.remove(entry);
  EXPECT_TRUE(parts.speculation.empty());
  EXPECT_EQ(parts.speculation.certain(0).version, 1U);
  EXPECT_FALSE(is_fresh(parts.speculation, c));
}

TEST(Speculation, ARollBackTakesBackWhatHangsOnIt) {
  KernelParts parts(two_discs(), {});
  resolve_ahead(parts, meeting(parts));
  std::vector<int> undone;
  parts.speculation.roll_back(0, 0, 0.5, undone);
  EXPECT_EQ(undone.size(), 2U);
  EXPECT_TRUE(parts.speculation.empty());
  EXPECT_EQ(parts.trajectories.body(0).motion.twist(3.0).velocity.x(), 2.0);
  EXPECT_EQ(parts.run.work().rollbacks, 2U);
  // a version is never given twice
  parts.run.set_time(1.0);
  parts.trajectories.restart_free(0, parts.trajectories.body(0).motion.state(1.0), {});
  EXPECT_EQ(parts.trajectories.body(0).version, 2U);
}

TEST(Speculation, SwappingShowsWhatIsCertainAndBack) {
  KernelParts parts(two_discs(), {});
  resolve_ahead(parts, meeting(parts));
  parts.speculation.swap_with_certain();
  EXPECT_EQ(parts.trajectories.body(0).version, 0U);
  parts.speculation.swap_with_certain();
  EXPECT_EQ(parts.trajectories.body(0).version, 1U);
}

}  // namespace
}  // namespace brink::speculation_test
