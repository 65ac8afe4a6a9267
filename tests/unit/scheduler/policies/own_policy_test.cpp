// A program's own policies: how they are added, and that none can leave out a contact that it knows of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "brink/core/base/error.h"
#include "brink/scheduler/kernel/run_kernel.h"
#include "brink/scheduler/policies/policy.h"
#include "tests/consumer/earliest_first.h"
#include "tests/support/gases.h"
#include "tests/support/same_events.h"

namespace brink::own_policy_test {
namespace {

using ::testing::HasSubstr;

/// Takes every contact but the third.
class SkipsOne : public Policy {
 public:
  void run(Kernel& kernel, double until) override {
    if (!kernel.extend_motions(until)) return;
    int contacts = 0;
    std::vector<int> changed;
    Agenda agenda;
    look(kernel, agenda, until);
    while (const auto next = take_earliest(kernel, agenda)) {
      if (++contacts == 3) continue;
      kernel.record_frames(next->time);
      kernel.advance_all(next->time);
      if (!kernel.resolve(next->pair, next->contact, changed) || !kernel.extend_motions(until)) return;
      look(kernel, agenda, until);
    }
    kernel.record_frames(until);
    kernel.advance_all(until);
  }

 private:
  static void look(Kernel& kernel, Agenda& agenda, double until) {
    agenda.clear();
    for (const PairKey& pair : kernel.near_pairs(kernel.time(), until))
      if (const auto c = kernel.search(pair, kernel.time(), until)) agenda.insert(*c);
  }
};

/// The same, but it says so.
class SaysThatItSkips final : public SkipsOne {
 public:
  bool approximate() const override { return true; }
};

/// Goes nowhere.
class Lazy final : public Policy {
 public:
  void run(Kernel&, double) override {}
};

/// Looks at nobody.
class Blind final : public Policy {
 public:
  void run(Kernel& kernel, double until) override {
    if (!kernel.extend_motions(until) || !kernel.record_frames(until)) return;
    kernel.advance_all(until);
  }
};

template <class P>
void add(const std::string& name) {
  register_policy(name, "of a test", [] { return std::make_unique<P>(); });
}

World small_gas() { return testing::boxed(testing::lattice_gas(16, make_disc(0.5), 0.5)); }

/// What a run of the gas under the policy says when it throws; empty if it does not.
std::string fault_of(const std::string& policy) {
  try {
    testing::run_under(small_gas(), {}, policy, 5.0);
  } catch (const BadInput& e) {
    return e.what();
  }
  return {};
}

TEST(OwnPolicy, IsListedAndGivesTheEventsOfTheOthers) {
  add<EarliestFirst>("earliest_first");
  EXPECT_EQ(policies().back().name, "earliest_first");
  const auto own = testing::run_under(small_gas(), {}, "earliest_first", 5.0);
  const auto reference = testing::run_under(small_gas(), {}, "global_backup", 5.0);
  EXPECT_GT(own.summary.collisions, 50U);
  EXPECT_EQ(own.summary.state_hash, reference.summary.state_hash);
  ASSERT_EQ(own.events.events.size(), reference.events.events.size());
  for (std::size_t k = 0; k < own.events.events.size(); ++k)
    EXPECT_TRUE(testing::same(own.events.events[k], reference.events.events[k])) << k;
}

TEST(OwnPolicy, ThatSkipsAContactIsCaughtAndTheContactNamed) {
  add<SkipsOne>("skips_one");
  const std::string fault = fault_of("skips_one");
  // the third contact is the one that every other policy resolves third
  const auto events = testing::run_under(small_gas(), {}, "global_backup", 5.0).events.collisions();
  const World world = small_gas();
  EXPECT_THAT(fault, HasSubstr("policy \"skips_one\" skips a contact"));
  EXPECT_THAT(fault, HasSubstr("'" + world.bodies[events[2].contact.body].name + "' on '"));
  EXPECT_THAT(fault, HasSubstr(std::to_string(events[2].contact.time).substr(0, 6)));
}

TEST(OwnPolicy, ThatIsApproximateMaySkip) {
  add<SaysThatItSkips>("says_that_it_skips");
  EXPECT_EQ(fault_of("says_that_it_skips"), "");
}

TEST(OwnPolicy, ThatComesBackTooEarlyIsCaught) {
  add<Lazy>("lazy");
  EXPECT_THAT(fault_of("lazy"), HasSubstr("policy \"lazy\" returned at t = 0"));
}

// One disc goes through another, of 1 m, between t = 9 s and t = 11 s: no frame is near.
TEST(OwnPolicy, ThatSeesNobodyIsCaughtBetweenFrames) {
  add<Blind>("blind");
  World world;
  world.bodies = {testing::body(make_disc(0.5), {0.0, 0.0}, {0.0, 0.0}),
                  testing::body(make_disc(0.5), {-10.0, 0.1}, {1.0, 0.0})};
  world.bodies[0].name = "still";
  world.bodies[1].name = "thrown";
  SolverOptions solver;
  solver.policy = "blind";
  RunOptions options;
  for (const double interval : {0.0, 30.0}) {
    options.frame_interval = interval;
    for (const double stop : {0.0, 4.0, 8.9}) {
      Simulator simulator(world, solver);
      options.until = stop;
      simulator.run(options);
      options.until = 32.0;
      const RunSummary summary = simulator.run(options);
      EXPECT_EQ(summary.termination, Termination::failed);
      EXPECT_THAT(summary.why, HasSubstr("'still' overlaps 'thrown' at t = 9.5 "));
      EXPECT_NEAR(summary.max_overlap, 1.0 - std::hypot(0.5, 0.1), 1e-12);
    }
  }
}

TEST(OwnPolicy, NamesThatAreTakenOrMissingAreRefused) {
  EXPECT_THROW(add<Lazy>("body_clocks"), BadInput);
  EXPECT_THROW(add<Lazy>(""), BadInput);
  EXPECT_THROW(register_policy("no_maker", "", PolicyMaker()), BadInput);
}

TEST(OwnPolicy, UnknownNamesAreRefusedWithAListThatHasTheAddedOnes) {
  add<EarliestFirst>("another_one");
  EXPECT_THAT(fault_of("anothr_one"), HasSubstr("another_one"));
}

// Brink's own are not watched as they run, which would cost; here they are, and go past nothing.
TEST(OwnPolicy, BrinksOwnPassUnderWatch) {
  for (const std::string& name : exact_policies()) {
    if (is_added_policy(name)) continue;
    SolverOptions options;
    options.policy = name;
    RunKernel kernel(small_gas(), options);
    kernel.hold_to_known_contacts();
    RunOptions run;
    run.frame_interval = 0.3;
    kernel.begin(run, nullptr);
    make_policy(name)->run(kernel, 5.0);
    EXPECT_NO_THROW(kernel.check_returned(5.0)) << name;
    EXPECT_GT(kernel.collisions(), 50U) << name;
  }
}

}  // namespace
}  // namespace brink::own_policy_test
