// Impulses by sweeps: answers by hand, and Coulomb's law checked from outside at every contact of random problems.
#include "brink/core/contacts/coulomb_sweeps.h"

#include <gtest/gtest.h>

#include "brink/core/base/random.h"
#include "tests/support/lasting_contacts.h"

namespace brink::coulomb_sweeps_test {
namespace {

using testing::kGravity;

constexpr int kMany = 20000;

/// Velocities that the impulses make, from the definition.
std::vector<Vec3> velocities(const StepProblem& p, const std::vector<ContactLoad>& loads) {
  std::vector<Vec3> impulse;
  for (const Vec3& f : p.force) impulse.push_back(p.duration * f);
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const LastingContact& c = p.contacts[k].contact;
    const Vec3 torque(0.0, 0.0, loads[k].rolling);
    impulse[c.body] += loads[k].normal * c.normal_on_body + loads[k].tangential * c.tangent_on_body + torque;
    if (c.other >= 0)
      impulse[c.other] +=
          loads[k].normal * c.normal_on_other + loads[k].tangential * c.tangent_on_other - torque;
  }
  std::vector<Vec3> w = p.velocity;
  for (std::size_t i = 0; i < w.size(); ++i)
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(p.mass[i][c])) w[i][c] += impulse[i][c] / p.mass[i][c];
  return w;
}

double along(const LastingContact& c, const Vec3& on_body, const Vec3& on_other, const std::vector<Vec3>& w) {
  return on_body.dot(w[c.body]) + (c.other < 0 ? 0.0 : on_other.dot(w[c.other]));
}

/// Signorini's and Coulomb's law at every contact, to a part of the largest impulse and speed.
void expect_lawful(const StepProblem& p, const CoulombLoads& found, double part) {
  const std::vector<Vec3> w = velocities(p, found.loads);
  double impulse = 0.0, speed = 0.0;
  for (const ContactLoad& load : found.loads) impulse = std::max(impulse, load.normal);
  for (const Vec3& v : w) speed = std::max(speed, v.cwiseAbs().maxCoeff());
  for (std::size_t k = 0; k < found.loads.size(); ++k) {
    SCOPED_TRACE(::testing::Message() << "contact " << k);
    const StepContact& s = p.contacts[k];
    const LastingContact& c = s.contact;
    const ContactLoad& load = found.loads[k];
    const double open =
        along(c, c.normal_on_body, c.normal_on_other, w) + s.gap / p.duration - s.support_velocity[0];
    const double slip = along(c, c.tangent_on_body, c.tangent_on_other, w) - s.support_velocity[1];
    EXPECT_GE(load.normal, 0.0);
    EXPECT_GE(open, -part * speed);
    EXPECT_LE(load.normal * open, part * impulse * speed);
    EXPECT_LE(std::abs(load.tangential), c.friction * load.normal * (1.0 + 1e-15));
    // what slips has all of its friction, against the slip
    if (std::abs(slip) > part * speed && load.normal > part * impulse) {
      EXPECT_NEAR(load.tangential, -std::copysign(c.friction * load.normal, slip), part * impulse);
    }
  }
}

StepProblem discs(int count) {
  StepProblem p;
  p.duration = 0.01;
  p.mass.assign(count, {1.0, 1.0, 0.125});
  p.force.assign(count, {0.0, -kGravity, 0.0});
  p.velocity.assign(count, Vec3::Zero());
  return p;
}

StepContact on_floor(int body, double friction, double gap = 0.0) {
  StepContact s;
  s.contact = contact_at(body, -1, {0.0, 1.0}, {0.0, -0.5}, Vec2::Zero());
  s.contact.friction = friction;
  s.gap = gap;
  return s;
}

// A disc that slides at 1 m/s and one that is pressed upon it from above.
TEST(CoulombSweeps, FrictionIsThatOfWhatPresses) {
  StepProblem p = discs(2);
  p.velocity[0].x() = p.velocity[1].x() = 1.0;
  p.contacts = {on_floor(0, 0.1), {}};
  p.contacts[1].contact = contact_at(1, 0, {0.0, 1.0}, {0.0, -0.5}, {0.0, 0.5});
  p.contacts[1].contact.friction = 0.1;
  const CoulombLoads found = sweep_by_coulomb(p, kMany, kMany);
  ASSERT_LT(found.sweeps, kMany);
  const double weight = 0.01 * kGravity;
  EXPECT_NEAR(found.loads[0].normal, 2.0 * weight, 1e-8);
  EXPECT_NEAR(std::abs(found.loads[0].tangential), 0.2 * weight, 1e-9);
  EXPECT_LE(std::abs(found.loads[1].tangential), 0.1 * weight * (1.0 + 1e-8));
}

TEST(CoulombSweeps, BesideTheConeIsHeldOrSlips) {
  for (const double friction : {0.0, 0.19, 0.21, 2.0}) {
    SCOPED_TRACE(::testing::Message() << "friction " << friction);
    StepProblem p = discs(1);
    // a body that does not turn is pushed by a fifth of its weight
    p.mass[0][2] = std::numeric_limits<double>::infinity();
    p.force[0].x() = 0.2 * kGravity;
    p.contacts = {on_floor(0, friction)};
    const CoulombLoads found = sweep_by_coulomb(p, kMany, kMany);
    const double weight = 0.01 * kGravity;
    EXPECT_NEAR(found.loads[0].normal, weight, 1e-12);
    EXPECT_NEAR(found.loads[0].tangential, std::min(friction, 0.2) * weight, 1e-12);
  }
}

// A wheel with a drive of 0.3 N m: held by 0.05 m of rolling resistance only up to 0.05 times its weight.
TEST(CoulombSweeps, RollingResistanceTurnsBackUpToItsBound) {
  for (const double resistance : {0.0, 0.01, 0.05}) {
    SCOPED_TRACE(::testing::Message() << "resistance " << resistance);
    StepProblem p = discs(1);
    p.force[0][2] = 0.3;
    p.contacts = {on_floor(0, 0.0)};
    p.contacts[0].contact.rolling_resistance = resistance;
    const CoulombLoads found = sweep_by_coulomb(p, kMany, kMany);
    EXPECT_NEAR(found.loads[0].rolling, -0.01 * std::min(0.3, resistance * kGravity), 1e-12);
  }
}

TEST(CoulombSweeps, WhatIsOpenOrHeldOnBothSidesCarriesNothing) {
  StepProblem p = discs(1);
  p.contacts = {on_floor(0, 0.5, 1.0)};
  p.contacts[0].expected = {7.0, 3.0, 0.0};
  EXPECT_EQ(sweep_by_coulomb(p, kMany, kMany).loads[0].normal, 0.0);
  p.mass[0] = Vec3::Constant(std::numeric_limits<double>::infinity());
  p.contacts[0].gap = 0.0;
  p.contacts[0].expected = {};
  EXPECT_EQ(sweep_by_coulomb(p, kMany, kMany).loads[0].normal, 0.0);
}

TEST(CoulombSweeps, EndWhereTheyAreTold) {
  StepProblem p = discs(2);
  p.contacts = {on_floor(0, 0.5), on_floor(1, 0.5)};
  EXPECT_EQ(sweep_by_coulomb(p, kMany, kMany, [] { return false; }).sweeps, 0);
  EXPECT_EQ(sweep_by_coulomb(p, 1, 1).sweeps, 1);
}

/// Discs in a box: up to `count`, pressed together at random.
StepProblem random_heap(Random& random, int count) {
  StepProblem p = discs(count);
  std::vector<Vec2> at;
  for (int i = 0; i < count; ++i) {
    at.emplace_back(random.uniform(-1.5, 1.5), 0.5 + 0.9 * i);
    const double heavy = std::exp(random.uniform(-1.0, 1.0));
    p.mass[i] *= heavy;
    p.force[i] *= heavy;
    p.velocity[i] = Vec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-2.0, 2.0));
  }
  const double friction = random.uniform(0.0, 0.8);
  for (int i = 0; i < count; ++i) {
    if (i < 3) p.contacts.push_back(on_floor(i, friction, random.uniform(0.0, 0.01)));
    for (int j = 0; j < i; ++j) {
      if ((at[i] - at[j]).norm() > 1.6) continue;
      const Vec2 n = (at[i] - at[j]).normalized();
      StepContact s;
      s.contact = contact_at(i, j, n, -0.5 * n, 0.5 * n);
      s.contact.friction = friction;
      s.gap = random.uniform(0.0, 0.01);
      p.contacts.push_back(s);
    }
  }
  return p;
}

TEST(CoulombSweeps, ObeyTheLawAtEveryContactOfRandomHeaps) {
  int settled = 0;
  constexpr int kHeaps = 300;
  for (int seed = 1; seed <= kHeaps; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const StepProblem p = random_heap(random, 2 + seed % 12);
    const CoulombLoads found = sweep_by_coulomb(p, kMany, kMany);
    for (std::size_t k = 0; k < found.loads.size(); ++k)
      EXPECT_LE(std::abs(found.loads[k].tangential),
                p.contacts[k].contact.friction * found.loads[k].normal * (1.0 + 1e-15));
    if (found.sweeps == kMany) continue;  // slower than that: nothing is promised but the cones
    ++settled;
    expect_lawful(p, found, 1e-6);
    EXPECT_LE(unexplained(p, velocities(p, found.loads), found.loads), 1e-12);
    if (HasFailure()) return;
  }
  EXPECT_GE(settled, kHeaps * 95 / 100);
}

TEST(CoulombSweeps, EndAfterTheFewestWhereLittleChanges) {
  int sooner = 0;
  for (int seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    StepProblem p = random_heap(random, 2 + seed % 12);
    constexpr int kFewest = 2;
    const CoulombLoads all = sweep_by_coulomb(p, kMany, kMany), near = sweep_by_coulomb(p, kFewest, kMany);
    EXPECT_LE(near.sweeps, all.sweeps);
    EXPECT_GE(near.sweeps, std::min(kFewest, all.sweeps));
    sooner += near.sweeps < all.sweeps;
    // one sweep more changes no impulse by more than some thousandths of the largest
    double largest = 0.0, changed = 0.0;
    for (std::size_t k = 0; k < p.contacts.size(); ++k) p.contacts[k].expected = near.loads[k];
    const CoulombLoads more = sweep_by_coulomb(p, 1, 1);
    for (std::size_t k = 0; k < p.contacts.size(); ++k) {
      largest = std::max(largest, near.loads[k].normal);
      changed = std::max({changed, std::abs(more.loads[k].normal - near.loads[k].normal),
                          std::abs(more.loads[k].tangential - near.loads[k].tangential)});
    }
    EXPECT_LE(changed, 3e-3 * largest);
    if (HasFailure()) return;
  }
  EXPECT_GE(sooner, 20);
}

}  // namespace
}  // namespace brink::coulomb_sweeps_test
