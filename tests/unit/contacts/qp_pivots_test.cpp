// Small convex programs solved exactly: an answer by hand, the law of every row, and the interior point's velocities.
#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/base/random.h"
#include "brink/core/contacts/qp_pivots.h"

namespace brink::qp_pivots_test {
namespace {

QpRow row(int body, const Vec3& on_body, double offset,
          double bound = std::numeric_limits<double>::infinity()) {
  QpRow r;
  r.body = body;
  r.on_body = on_body;
  r.offset = offset;
  r.bound = bound;
  return r;
}

// A body of mass 2 on a floor, under a weight of 3 and a push of 2 along it: friction of at most .5 takes what it can.
TEST(QpPivots, OfAPushedBlock) {
  QpProblem p;
  p.mass = {{2.0, 2.0, 1.0}};
  p.force = {{2.0, -3.0, 0.0}};
  p.rows = {row(0, Vec3::UnitY(), 0.0), row(0, Vec3::UnitX(), 0.0, 0.5)};
  const auto s = solve_by_pivots(p);
  ASSERT_TRUE(s);
  EXPECT_EQ(s->force[0], 3.0);
  EXPECT_EQ(s->force[1], -0.5);
  EXPECT_EQ(s->velocity[0], Vec3(0.75, 0.0, 0.0));
  p.rows[1].bound = 5.0;
  EXPECT_EQ(solve_by_pivots(p)->velocity[0], Vec3(0.0, 0.0, 0.0));
}

// Squeezed between two rows that ask for opposite speeds.
TEST(QpPivots, WhatHasNoAnswerGetsNone) {
  QpProblem p;
  p.mass = {{1.0, 1.0, 1.0}};
  p.force = {Vec3::Zero()};
  p.rows = {row(0, Vec3::UnitY(), -1.0), row(0, -Vec3::UnitY(), -1.0)};
  EXPECT_FALSE(solve_by_pivots(p));
}

QpProblem random_problem(Random& random, double spread) {
  QpProblem p;
  const int bodies = 1 + static_cast<int>(random.below(6)), rows = 1 + static_cast<int>(random.below(16));
  const auto vec = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  for (int k = 0; k < bodies; ++k) {
    const double mass = std::pow(spread, -random.uniform(0.0, 1.0));
    p.mass.emplace_back(mass, mass, mass * random.uniform(0.1, 1.0));
    p.force.push_back(mass * vec());
  }
  for (int k = 0; k < rows; ++k) {
    QpRow r = row(static_cast<int>(random.below(bodies)), vec(), 0.0);
    // normals of a half plane, so that all can part
    if (r.on_body.y() < 0.0) r.on_body = -r.on_body;
    if (random.below(2) == 0) r.bound = random.uniform(0.01, 1.0) * p.mass[r.body].x();
    const int other = static_cast<int>(random.below(bodies));
    if (other < r.body) {
      r.other = other;
      r.on_other = vec();
      if (r.on_other.y() > 0.0) r.on_other = -r.on_other;
    }
    if (std::isfinite(r.bound) || random.below(2) == 0) r.offset = random.uniform(0.0, 1.0);
    p.rows.push_back(r);
  }
  return p;
}

TEST(QpPivots, KeepTheLawOfEveryRow) {
  int found = 0;
  for (const double spread : {1.0, 1e6, 1e12})
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
      SCOPED_TRACE(::testing::Message() << "spread " << spread << ", seed " << seed);
      Random random(seed);
      const QpProblem p = random_problem(random, spread);
      const auto s = solve_by_pivots(p);
      if (!s) continue;
      ++found;
      EXPECT_LE(s->residual, 1e-9);
      for (std::size_t k = 0; k < p.rows.size(); ++k) {
        const QpRow& r = p.rows[k];
        const double x = s->force[k], y = r.offset + r.on_body.dot(s->velocity[r.body]) +
                                          (r.other < 0 ? 0.0 : r.on_other.dot(s->velocity[r.other]));
        if (std::isfinite(r.bound)) {
          EXPECT_LE(std::abs(x), r.bound * (1.0 + 1e-9));
          if (std::abs(y) > 1e-9) {
            EXPECT_NEAR(x, y > 0.0 ? -r.bound : r.bound, 1e-9 * r.bound);
          }
        } else {
          EXPECT_GE(y, -1e-9);
          EXPECT_GE(x, 0.0);
          if (x > 1e-9 * p.mass[r.body].x()) {
            EXPECT_LE(y, 1e-9);
          }
        }
      }
      if (HasFailure()) return;
    }
  EXPECT_GT(found, 600);
}

TEST(QpPivots, FindTheVelocitiesOfTheInteriorPoint) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const QpProblem p = random_problem(random, 1.0);
    const auto s = solve_by_pivots(p);
    InteriorPoint interior;
    interior.begin(p);
    for (int n = 0; n < 60 && interior.mean_product() > 1e-15 && interior.step(); ++n) continue;
    if (!s || interior.mean_product() > 1e-14 || interior.row_residual() > 1e-9) continue;
    ++compared;
    for (std::size_t k = 0; k < p.mass.size(); ++k)
      EXPECT_LE((s->velocity[k] - interior.velocity(static_cast<int>(k))).cwiseAbs().maxCoeff(), 1e-5)
          << "seed " << seed;
  }
  EXPECT_GT(compared, 150);
}

}  // namespace
}  // namespace brink::qp_pivots_test
