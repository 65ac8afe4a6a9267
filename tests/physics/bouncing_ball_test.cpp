/// A ball dropped from height h on a floor, restitution e: impact n at t1 (1 + 2 sum_{k=1}^{n-1} e^k), t1 =
/// sqrt(2h/g).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/worlds.h"

namespace brink::bouncing_ball_test {
namespace {

using testing::Events;

constexpr double kGravity = 9.81;

World ball_over_floor(double e, double height, double radius) {
  World world;
  world.gravity = {0.0, -kGravity};
  world.materials[0].restitution = e;
  testing::add(world, testing::body(make_disc(radius), {0.0, height + radius}, {0.0, 0.0}));
  testing::add(world, testing::site(make_segment({-10.0, 0.0}, {10.0, 0.0})));
  return world;
}

struct Case {
  double e;
  const char* integrator;
};

class BouncingBall : public ::testing::TestWithParam<Case> {};

TEST_P(BouncingBall, EveryImpactBeforeTheZenoTimeIsWhereTheGeometricSeriesPutsIt) {
  const double e = GetParam().e, height = 1.0;
  const double t1 = std::sqrt(2.0 * height / kGravity), zeno = t1 * (1.0 + e) / (1.0 - e);
  SolverOptions options;
  options.integrator = GetParam().integrator;
  options.tolerance = 1e-13;
  options.absolute_tolerance = 1e-15;
  Simulator simulator(ball_over_floor(e, height, 0.5), options);
  Events events;
  const RunSummary summary = simulator.run(testing::until(0.999 * zeno), &events);
  ASSERT_EQ(summary.termination, Termination::reached_end) << summary.why;

  std::vector<double> expected;
  for (double t = t1, power = e; t < 0.999 * zeno; t += 2.0 * t1 * power, power *= e) expected.push_back(t);
  const auto hits = events.collisions();
  ASSERT_EQ(hits.size(), expected.size());
  double worst = 0.0;
  for (std::size_t n = 0; n < hits.size(); ++n)
    worst = std::max(worst, std::abs(hits[n].contact.time - expected[n]));
  RecordProperty("worst_time_error", std::to_string(worst));
  printf("e = %.1f %s: %zu impacts, worst time error %.2e s\n", e, GetParam().integrator, hits.size(), worst);
  EXPECT_LE(worst, 5e-12);
  EXPECT_LE(summary.max_overlap, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Restitutions, BouncingBall,
                         ::testing::Values(Case{0.5, "ballistic"}, Case{0.8, "ballistic"},
                                           Case{0.9, "ballistic"}, Case{0.5, "erk"}, Case{0.8, "erk"},
                                           Case{0.9, "erk"}));

TEST(BouncingBall, DroppedFromTenMetresElasticStaysOnTheClosedFormForFiveSeconds) {
  const double height = 9.5, t1 = std::sqrt(2.0 * height / kGravity);
  Simulator simulator(ball_over_floor(1.0, height, 0.5), {});
  ASSERT_EQ(simulator.run(testing::until(5.0)).termination, Termination::reached_end);
  // period 2 t1; phase measured from an impact
  const double phase = std::fmod(5.0 + t1, 2.0 * t1), v = kGravity * t1;
  const double y = 0.5 + v * phase - 0.5 * kGravity * phase * phase;
  EXPECT_NEAR(simulator.state(0).pose.position.y(), y, 1e-12);
}

TEST(BouncingBall, PastTheZenoTimeARunOfCollisionsAloneEndsHonestly) {
  for (const double e : {0.5, 0.8, 0.9}) {
    const double t1 = std::sqrt(2.0 / kGravity), zeno = t1 * (1.0 + e) / (1.0 - e);
    SolverOptions options;
    options.persistent = false;
    Simulator simulator(ball_over_floor(e, 1.0, 0.5), options);
    Events events;
    const RunSummary summary = simulator.run(testing::until(10.0), &events);
    EXPECT_EQ(summary.termination, Termination::failed);
    EXPECT_NE(summary.why.find("Zeno"), std::string::npos) << summary.why;
    ASSERT_FALSE(events.events.empty());
    EXPECT_EQ(events.events.back().kind, EventKind::zeno);
    EXPECT_NEAR(events.events.back().contact.time, zeno, 1e-11);
  }
}

}  // namespace
}  // namespace brink::bouncing_ball_test
