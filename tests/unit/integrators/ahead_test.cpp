// Steps that were made ahead are the steps: same pieces, same work, same failures, at the same question.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "brink/integrators/integrator.h"
#include "tests/support/seeded_random.h"
#include "tests/unit/integrators/problems.h"

namespace brink::ahead_test {
namespace {

using namespace problems;

const IntegratorOptions kOptions{1e-9, 1e-11, 1.0 / 64.0};

void expect_same(const Integrator& a, const Integrator& b, int bodies) {
  for (int k = 0; k < bodies; ++k) {
    const Motion x = a.motion(k), y = b.motion(k);
    ASSERT_EQ(x.begin(), y.begin());
    ASSERT_EQ(x.end(), y.end());
    for (int i = 0; i <= 8; ++i) {
      const double t = x.begin() + (x.end() - x.begin()) * i / 8.0;
      ASSERT_EQ(x.state(t).pose.position, y.state(t).pose.position);
      ASSERT_EQ(x.state(t).twist.omega, y.state(t).twist.omega);
    }
  }
}

TEST(StepsMadeAhead, AreTheSteps) {
  SeededRandom random(3);
  for (const IntegratorInfo& info : integrators()) {
    if (info.name == "ballistic") continue;
    WorkCounters plain_work, ahead_work;
    const auto plain = make_integrator(info.name, spring_pair(), kOptions, &plain_work),
               ahead = make_integrator(info.name, spring_pair(), kOptions, &ahead_work);
    for (int round = 0; round < 5; ++round) {
      const auto states = spring_pair_start();
      double t = random.uniform(0.0, 1.0);
      plain->start(t, states);
      ahead->start(t, states);
      expect_same(*plain, *ahead, 2);
      for (int k = 0; k < 20; ++k) {
        t += random.uniform(0.0, 0.3);
        const std::uint64_t most = 1 + random.below(12);
        ahead->extend_ahead(t + random.uniform(-0.3, 0.5), 1 + random.below(30));
        expect_same(*plain, *ahead, 2);
        const Extent x = plain->extend(t, most), y = ahead->extend(t, most);
        ASSERT_EQ(x.status, y.status);
        ASSERT_EQ(x.end, y.end);
        expect_same(*plain, *ahead, 2);
        ASSERT_EQ(plain_work.solver_steps, ahead_work.solver_steps) << info.name;
        ASSERT_EQ(plain_work.right_hand_sides, ahead_work.right_hand_sides) << info.name;
      }
    }
  }
}

/// Falls freely until its force is no number; or until it throws.
class Ends final : public Dynamics {
 public:
  explicit Ends(bool throws) : throws_(throws) {}
  int size() const override { return 1; }
  void accelerations(double t, std::span<const BodyState>, std::span<Acceleration> out) const override {
    if (throws_ && t > 1.0) throw std::runtime_error("no force");
    out[0] = {{0.0, t > 1.0 ? std::nan("") : -1.0}, 0.0};
  }
  bool constant() const override { return false; }

 private:
  bool throws_;
};

TEST(StepsMadeAhead, FailWhereTheStepsDo) {
  for (const char* name : {"rk4", "erk", "adams"}) {
    const auto plain = make_integrator(name, std::make_shared<Ends>(false), kOptions),
               ahead = make_integrator(name, std::make_shared<Ends>(false), kOptions);
    const BodyState start;
    plain->start(0.0, {&start, 1});
    ahead->start(0.0, {&start, 1});
    ahead->extend_ahead(10.0, 1000000);
    for (const double t : {0.25, 0.5, 2.0, 3.0}) {
      const Extent x = plain->extend(t), y = ahead->extend(t);
      EXPECT_EQ(x.status, y.status) << name;
      EXPECT_EQ(x.end, y.end) << name;
      EXPECT_EQ(x.why, y.why) << name;
      ahead->extend_ahead(10.0, 1000000);
    }
    ahead->start(0.0, {&start, 1});  // the failure has gone
    EXPECT_EQ(ahead->extend(0.5).status, Extent::Status::reached);
  }
}

TEST(StepsMadeAhead, ThrowWhereTheStepsDo) {
  const auto integrator = make_integrator("rk4", std::make_shared<Ends>(true), kOptions);
  const BodyState start;
  integrator->start(0.0, {&start, 1});
  EXPECT_NO_THROW(integrator->extend_ahead(10.0, 1000000));
  EXPECT_EQ(integrator->extend(0.5).status, Extent::Status::reached);
  EXPECT_THROW(integrator->extend(2.0), std::runtime_error);
}

}  // namespace
}  // namespace brink::ahead_test
