#include "brink/core/contacts/impulse.h"

#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/base/random.h"
#include "tests/support/seeded_random.h"

namespace brink::impulse_test {
namespace {

RealVec relative_velocity(const ImpulseSide& a, const ExtendedTwist& wa, const ImpulseSide& b,
                          const ExtendedTwist& wb) {
  return wa.at(a.arm) - wb.at(b.arm);
}

Real energy(const ImpulseSide& s, const ExtendedTwist& w) {
  return 0.5 * (w.velocity.squaredNorm() / s.inverse_mass_x + w.omega * w.omega / s.inverse_inertia);
}

ImpulseSide random_side(Random& r) {
  ImpulseSide s;
  s.twist = {{r.uniform(-2, 2), r.uniform(-2, 2)}, r.uniform(-3, 3)};
  s.arm = {r.uniform(-1, 1), r.uniform(-1, 1)};
  s.inverse_mass_x = s.inverse_mass_y = r.uniform(0.2, 3.0);
  s.inverse_inertia = r.uniform(0.2, 6.0);
  return s;
}

// Newton: v_n' = -e v_n at every speed; momentum is exchanged, none made; friction stays in its cone and
// opposes what sliding is left, or there is none left.
TEST(Impulse, RandomCollisionsMeetRestitutionMomentumAndCoulombsLaw) {
  Random r(11);
  int sticks = 0, slips = 0, reverses = 0;
  for (int i = 0; i < 100000; ++i) {
    const ImpulseSide a = random_side(r), b = random_side(r);
    const double angle = r.uniform(0.0, 2.0 * M_PI);
    const RealVec n(std::cos(angle), std::sin(angle)), t = extended::perp(n);
    Material m;
    m.restitution = r.uniform();
    m.friction = r.uniform(0.0, 0.6);
    const RealVec before = relative_velocity(a, a.twist, b, b.twist);
    const ImpulseResult result = resolve_impulse(a, b, n, m);
    if (before.dot(n) >= 0.0) {
      ASSERT_EQ(result.kind, ImpulseKind::separating);
      continue;
    }
    const RealVec after = relative_velocity(a, result.body, b, result.other);
    const double scale = 10.0 + std::abs(result.normal);
    ASSERT_NEAR(static_cast<double>(after.dot(n)), static_cast<double>(-m.restitution * before.dot(n)),
                1e-14 * scale)
        << "case " << i << " of seed 11";
    const RealVec momentum = (result.body.velocity - a.twist.velocity) / a.inverse_mass_x +
                             (result.other.velocity - b.twist.velocity) / b.inverse_mass_x;
    ASSERT_LE(momentum.norm(), 1e-14 * scale);
    ASSERT_LE(std::abs(result.tangential), m.friction * result.normal * (1.0 + 1e-14));
    const double sliding = static_cast<double>(after.dot(t));
    if (result.kind == ImpulseKind::stick)
      ASSERT_NEAR(sliding, 0.0, 1e-13 * scale);
    else
      ASSERT_LE(sliding * result.tangential, 1e-13 * scale) << "friction pushes along the sliding";
    sticks += result.kind == ImpulseKind::stick;
    slips += result.kind == ImpulseKind::slip;
    reverses += result.kind == ImpulseKind::reverse;
  }
  EXPECT_GT(sticks, 1000);
  EXPECT_GT(slips, 1000);
  EXPECT_GT(reverses, 10);
}

// The same with any friction, any tangential restitution and slender bodies, where Coulomb's friction and Newton's restitution
// together would gain (Kane & Levinson 1985): there friction is as much as gains nothing, to the rounding of two doubles.
TEST(Impulse, NoCollisionGainsEnergy) {
  SeededRandom r(13);
  int bounded = 0;
  for (int i = 0; i < 100000; ++i) {
    ImpulseSide a = random_side(r), b = random_side(r);
    a.inverse_inertia = std::pow(10.0, r.uniform(-2.0, 3.0));
    const double angle = r.uniform(0.0, 2.0 * M_PI);
    const RealVec n(std::cos(angle), std::sin(angle)), t = extended::perp(n);
    Material m;
    m.restitution = i % 3 == 0 ? 1.0 : r.uniform();
    m.friction = std::pow(10.0, r.uniform(-2.0, 1.0));
    m.tangential_restitution = i % 2 == 0 ? 0.0 : r.uniform(-1.0, 1.0);
    const ImpulseResult result = resolve_impulse(a, b, n, m);
    if (result.kind == ImpulseKind::separating) continue;
    const Real before = energy(a, a.twist) + energy(b, b.twist);
    const Real after = energy(a, result.body) + energy(b, result.other);
    // the normal is a unit vector to the rounding of one double
    ASSERT_LE(static_cast<double>(after - before), 1e-15 * static_cast<double>(before)) << "case " << i;
    const Real closing = relative_velocity(a, a.twist, b, b.twist).dot(n);
    const RealVec parting = relative_velocity(a, result.body, b, result.other);
    ASSERT_NEAR(static_cast<double>(parting.dot(n)), static_cast<double>(-m.restitution * closing),
                1e-14 * (10.0 + std::abs(static_cast<double>(closing))))
        << "case " << i;
    ASSERT_GE(result.normal, 0.0);
    ASSERT_LE(std::abs(result.tangential), m.friction * result.normal * (1.0 + 1e-14)) << "case " << i;
    if (result.kind != ImpulseKind::bounded) continue;
    ++bounded;
    // it is the most that friction can do on that side: nothing of the energy is lost
    ASSERT_NEAR(static_cast<double>(after / before), 1.0, 1e-15) << "case " << i;
    ASSERT_TRUE(std::isfinite(static_cast<double>(parting.dot(t))));
  }
  EXPECT_GT(bounded, 1000);
}

TEST(Impulse, ElasticAndFrictionlessKeepsEnergy) {
  SeededRandom r(12);
  for (int i = 0; i < 20000; ++i) {
    const ImpulseSide a = random_side(r), b = random_side(r);
    const double angle = r.uniform(0.0, 2.0 * M_PI);
    const ImpulseResult result = resolve_impulse(a, b, {std::cos(angle), std::sin(angle)}, Material{});
    const Real before = energy(a, a.twist) + energy(b, b.twist);
    const Real after = energy(a, result.body) + energy(b, result.other);
    ASSERT_LE(abs(after - before), 2e-14 * before) << "case " << i;
  }
}

// A tiny approach is met with restitution like any other: there is no threshold.
TEST(Impulse, RestitutionHasNoThreshold) {
  for (const double v : {1e-3, 1e-9, 1e-15, 1e-100}) {
    const ImpulseSide ball{{{0.0, -v}, 0.0}, RealVec::Zero(), 1.0, 1.0, 1.0};
    const ImpulseSide floor{{}, RealVec::Zero(), 0.0, 0.0, 0.0};
    Material m;
    m.restitution = 0.7;
    EXPECT_DOUBLE_EQ(resolve_impulse(ball, floor, {0.0, 1.0}, m).body.velocity.y().high(), 0.7 * v);
  }
}

TEST(Impulse, TwoHeldSidesJam) {
  const ImpulseSide held{{{0.0, -1.0}, 0.0}, RealVec::Zero(), 0.0, 0.0, 0.0};
  const ImpulseSide floor{{}, RealVec::Zero(), 0.0, 0.0, 0.0};
  EXPECT_EQ(resolve_impulse(held, floor, {0.0, 1.0}, Material{}).kind, ImpulseKind::jam);
}

// A rod at tan th = 2 with friction beyond Painleve's 4/3: the answer stays finite and leaves the floor.
TEST(Impulse, PainleveRodGivesAFiniteSeparatingAnswer) {
  const double th = std::atan(2.0), length = 2.0;
  for (const double mu : {1.0, 4.0 / 3.0, 2.0, 10.0})
    for (const double slide : {-5.0, -0.1, 0.1, 5.0}) {
      ImpulseSide rod;
      rod.twist = {{slide, -1.0}, 0.0};
      rod.arm = RealVec(-std::cos(th), -std::sin(th)) * (0.5 * length);
      rod.inverse_mass_x = rod.inverse_mass_y = 1.0;
      rod.inverse_inertia = 12.0 / (length * length);
      Material m;
      m.restitution = 0.0;
      m.friction = mu;
      const ImpulseResult result = resolve_impulse(rod, {}, {0.0, 1.0}, m);
      EXPECT_TRUE(isfinite(result.body.omega) && result.body.velocity.allFinite());
      EXPECT_GE(result.normal, 0.0);
      EXPECT_NEAR(result.body.at(rod.arm).y().high(), 0.0, 1e-13);
    }
}

// The mirror keeps its factor 2: a head-on bounce returns with the speed it came with; slip scales the
// tangent.
TEST(Reflection, MirrorsTheNormalAndScalesTheTangent) {
  const ImpulseSide ball{{{3.0, -2.0}, 0.0}, {0.0, -0.5}, 1.0, 1.0, 0.0};
  const ImpulseSide floor{{}, RealVec::Zero(), 0.0, 0.0, 0.0};
  Material m;
  m.slip = 0.5;
  const ImpulseResult result = resolve_reflection(ball, floor, {0.0, 1.0}, m);
  EXPECT_DOUBLE_EQ(result.body.velocity.y().high(), 2.0);
  EXPECT_DOUBLE_EQ(result.body.velocity.x().high(), 1.5);
}

// The angular change is the impulse's moment divided by the inertia, times the pair's spin scalar: a rod's
// end (arm (1, 0), I = 1/3, m = 1) on a floor has effective mass 1 / (1 + 3) and takes 2 m_eff v = v / 2.
TEST(Reflection, AngularChangeIsDividedByTheInertiaAndScaledBySpin) {
  const ImpulseSide rod{Twist{{0.0, -2.0}, 0.0}, RealVec(-1.0, 0.0), 1.0, 1.0, 3.0};
  const ImpulseSide floor{Twist{}, RealVec::Zero(), 0.0, 0.0, 0.0};
  for (const double spin : {1.0, 0.25, 0.0}) {
    Material m;
    m.spin = spin;
    const ImpulseResult result = resolve_reflection(rod, floor, RealVec(0.0, 1.0), m);
    EXPECT_DOUBLE_EQ(result.normal, 1.0);
    EXPECT_DOUBLE_EQ(static_cast<double>(result.body.velocity.y()), -1.0);
    EXPECT_DOUBLE_EQ(static_cast<double>(result.body.omega), -3.0 * spin);
  }
}

}  // namespace
}  // namespace brink::impulse_test
