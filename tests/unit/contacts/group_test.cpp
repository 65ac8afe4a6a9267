// Contacts of one instant taken together: what Smith et al. 2012 ask of such a law, on known answers and at
// random.
#include "brink/core/contacts/group.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "brink/core/base/random.h"
#include "brink/core/contacts/lcp.h"
#include "tests/support/seeded_random.h"

namespace brink::group_test {
namespace {

using Bodies = std::vector<GroupBody>;
using Contacts = std::vector<GroupContact>;
using Law = GroupResult (*)(const Bodies&, const Contacts&, const GoOn&);

GroupBody disc(const RealVec& velocity, double mass = 1.0, double radius = 0.5) {
  return {{velocity, 0}, 1.0 / mass, 1.0 / mass, 2.0 / (mass * radius * radius)};
}

/// Discs of radius 1/2 at `body` and `other` touch; the normal points from `other` to `body`.
GroupContact touch(int body, const RealVec& at_body, int other, const RealVec& at_other, double e = 1.0) {
  GroupContact c;
  c.body = body;
  c.other = other;
  c.normal = (at_body - at_other).normalized();
  c.arm = -c.normal / 2;
  c.other_arm = c.normal / 2;
  c.material.restitution = e;
  return c;
}

/// n equal discs in a row along x, all touching; the first comes with velocity 1.
std::pair<Bodies, Contacts> row(int n, double e) {
  Bodies bodies;
  Contacts contacts;
  for (int k = 0; k < n; ++k) {
    bodies.push_back(disc({k == 0 ? 1 : 0, 0}));
    if (k > 0) contacts.push_back(touch(k - 1, RealVec(k - 1, 0), k, RealVec(k, 0), e));
  }
  return {bodies, contacts};
}

std::vector<Real> speeds_along_x(const GroupResult& result) {
  std::vector<Real> v;
  for (const ExtendedTwist& t : result.twists) v.push_back(t.velocity.x());
  return v;
}

void expect_near(const std::vector<Real>& got, const std::vector<Real>& wanted, double precision) {
  ASSERT_EQ(got.size(), wanted.size());
  for (std::size_t k = 0; k < got.size(); ++k)
    EXPECT_NEAR(static_cast<double>(got[k]), static_cast<double>(wanted[k]), precision) << "body " << k;
}

// Newton's law at all contacts at once: the first disc rebounds at its neighbour's speed less its own, -1;
// the others stay together at u; momentum v0 + (n-1) u = 1 with u - v0 = 1 gives v0 = 2/n - 1, u = 2/n.
TEST(ResolveTogether, ElasticRowSpreadsOut) {
  for (const int n : {2, 3, 5, 12}) {
    const auto [bodies, contacts] = row(n, 1.0);
    std::vector<Real> wanted(n, Real(2) / n);
    wanted[0] -= 1;
    expect_near(speeds_along_x(resolve_together(bodies, contacts)), wanted, 1e-17);
  }
}

TEST(ResolveTogether, InelasticRowMovesAsOne) {
  for (const int n : {2, 5, 40}) {
    const auto [bodies, contacts] = row(n, 0.0);
    expect_near(speeds_along_x(resolve_together(bodies, contacts)), std::vector<Real>(n, Real(1) / n), 1e-17);
    expect_near(speeds_along_x(resolve_reflections(bodies, contacts)), std::vector<Real>(n, Real(1) / n),
                1e-17);
  }
}

// Break-away: reflections hand the velocity on, and the last disc leaves alone.
TEST(ResolveReflections, ElasticRowLetsTheLastGo) {
  for (const int n : {2, 3, 5, 12}) {
    const auto [bodies, contacts] = row(n, 1.0);
    std::vector<Real> wanted(n, 0);
    wanted.back() = 1;
    const GroupResult result = resolve_reflections(bodies, contacts);
    expect_near(speeds_along_x(result), wanted, 1e-17);
    EXPECT_EQ(result.reflections, n - 1);
  }
}

// Two balls let go at each end meet in the middle and leave as they came: the row is symmetric at every step.
TEST(ResolveReflections, SymmetricRowStaysSymmetric) {
  auto [bodies, contacts] = row(5, 1.0);
  bodies[4].twist.velocity.x() = -1;
  expect_near(speeds_along_x(resolve_reflections(bodies, contacts)), {-1, 0, 0, 0, 1}, 1e-17);
  const auto v = speeds_along_x(resolve_together(bodies, contacts));
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(static_cast<double>(v[k]), static_cast<double>(-v[4 - k]), 1e-17);
}

// Disc v = (1, 0) on two at +-30 degrees, all at once: v0 = (-1/5, 0), the others leave at 2 sqrt3 / 5 along
// the normals (momentum 1 = v0 + 2 u cos 30, energy 1 = v0^2 + 2 u^2).
TEST(GroupLaws, DiscOnTwoIsSymmetric) {
  const Real c = sqrt(Real(3)) / 2;
  const RealVec at0(0, 0), at1(c, 0.5), at2(c, -0.5);
  const Bodies bodies{disc({1, 0}), disc({0, 0}), disc({0, 0})};
  const Contacts contacts{touch(0, at0, 1, at1), touch(0, at0, 2, at2)};
  for (const Law law : {resolve_together, resolve_reflections}) {
    const GroupResult result = law(bodies, contacts, {});
    EXPECT_NEAR(static_cast<double>(result.twists[0].velocity.x()), -0.2, 1e-17);
    EXPECT_NEAR(static_cast<double>(result.twists[0].velocity.y()), 0, 1e-17);
    for (const int k : {1, 2})
      EXPECT_NEAR(static_cast<double>(result.twists[k].velocity.norm()), 2 * std::sqrt(3.0) / 5, 1e-17);
    EXPECT_NEAR(static_cast<double>(result.twists[1].velocity.y()),
                static_cast<double>(-result.twists[2].velocity.y()), 1e-18);
  }
}

// One contact: both laws are the impulse law, v_n' = -e v_n, with the tangential impulse that Coulomb's law
// gives to a disc (knt = 0: stick needs vt / 3 per mass, bounded by mu times the normal impulse).
TEST(GroupLaws, OneContactIsTheImpulseLaw) {
  GroupContact floor;
  floor.normal = {0, 1};
  floor.arm = {0, -0.5};
  floor.material.restitution = 0.5;
  floor.material.friction = 0.1;
  for (const Law law : {resolve_together, resolve_reflections}) {
    const GroupResult slip = law({disc({3, -2})}, {floor}, {});
    EXPECT_NEAR(static_cast<double>(slip.normal[0]), 3, 1e-17);  // (1 + e) v_n
    EXPECT_NEAR(static_cast<double>(slip.tangential[0]), 0.3,
                1e-16);  // at the bound; along perp(normal) = -x, against the sliding
    EXPECT_NEAR(static_cast<double>(slip.twists[0].velocity.y()), 1, 1e-17);
    const GroupResult stick = law({disc({0.6, -2})}, {floor}, {});
    EXPECT_NEAR(static_cast<double>(stick.tangential[0]), 0.2, 1e-16);
    EXPECT_NEAR(static_cast<double>(stick.twists[0].at(floor.arm).x()), 0, 1e-17);
  }
}

// A disc that can only move along y, hit by a slanted side that moves: it rebounds as restitution says, whatever the friction,
// which can change the impulse alone. Here it would stop the slip, and with that turn the rebound into an approach.
TEST(GroupLaws, WhatMovesInOneDirectionReboundsWithAnyFriction) {
  const GroupBody body{{{0, -2}, 0}, 0.0, 1.0, 0.0};
  GroupContact c;
  c.body = 0;
  c.normal = RealVec(0.6, 0.8);
  c.arm = -0.3 * c.normal;
  c.other_point_velocity = RealVec(-1, 0.5);
  for (const double e : {1.0, 0.4})
    for (const double mu : {0.0, 0.5, 5.0}) {
      c.material.restitution = e;
      c.material.friction = mu;
      const Real before = (body.twist.velocity - c.other_point_velocity).dot(c.normal);
      for (const Law law : {resolve_together, resolve_reflections}) {
        const GroupResult result = law({body}, {c}, {});
        ASSERT_EQ(result.status, GroupResult::Status::resolved);
        const Real after = (result.twists[0].velocity - c.other_point_velocity).dot(c.normal);
        EXPECT_NEAR(static_cast<double>(after), static_cast<double>(-e * before), 1e-14) << e << " " << mu;
        EXPECT_EQ(result.twists[0].velocity.x(), Real(0));
      }
    }
}

TEST(GroupLaws, SqueezedBetweenWhatCannotMoveIsAJam) {
  GroupContact left, right;
  left.normal = {1, 0};
  left.arm = {-0.5, 0};
  left.other_point_velocity = {1, 0};
  right.normal = {-1, 0};
  right.arm = {0.5, 0};
  right.other_point_velocity = {-1, 0};
  for (const Law law : {resolve_together, resolve_reflections}) {
    EXPECT_NE(law({disc({0, 0})}, {left, right}, {}).status, GroupResult::Status::resolved);
    EXPECT_EQ(law({GroupBody{}}, {left}, {}).status, GroupResult::Status::jam);  // held altogether
  }
}

/// Many discs on a triangular lattice with random masses, velocities and spins; each pair of neighbours
/// touches.
struct RandomGroup {
  Bodies bodies;
  Contacts contacts;
  explicit RandomGroup(Random& r, double e_low, double e_high, double friction, bool equal_e) {
    const int columns = 2 + static_cast<int>(r.below(4)), lines = 1 + static_cast<int>(r.below(4));
    const double common = r.uniform(e_low, e_high);
    std::vector<RealVec> at;
    for (int j = 0; j < lines; ++j)
      for (int i = 0; i < columns; ++i) {
        at.emplace_back(i + Real(j % 2) / 2, j * sqrt(Real(3)) / 2);
        bodies.push_back(disc({r.uniform(-1, 1), r.uniform(-1, 1)}, r.uniform(0.3, 3.0)));
        bodies.back().twist.omega = r.uniform(-2, 2);
      }
    for (std::size_t i = 0; i < at.size(); ++i)
      for (std::size_t j = i + 1; j < at.size(); ++j)
        if ((at[i] - at[j]).norm() < 1 + 1e-12) {
          contacts.push_back(touch(static_cast<int>(i), at[i], static_cast<int>(j), at[j],
                                   equal_e ? common : r.uniform(e_low, e_high)));
          contacts.back().material.friction = friction;
        }
  }
};

struct Sums {
  RealVec momentum = RealVec::Zero();
  Real energy = 0;
  Sums(const Bodies& bodies, const std::vector<ExtendedTwist>& twists) {
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      momentum += twists[k].velocity / bodies[k].inverse_mass_x;
      energy += (twists[k].velocity.squaredNorm() / bodies[k].inverse_mass_x +
                 twists[k].omega * twists[k].omega / bodies[k].inverse_inertia) /
                2;
    }
  }
};

std::vector<ExtendedTwist> twists_of(const Bodies& bodies) {
  std::vector<ExtendedTwist> twists;
  for (const GroupBody& b : bodies) twists.push_back(b.twist);
  return twists;
}

Real normal_velocity(const GroupContact& c, const std::vector<ExtendedTwist>& twists) {
  return (twists[c.body].at(c.arm) - twists[c.other].at(c.other_arm)).dot(c.normal);
}

// Elastic, frictionless: momentum and energy to rounding; impulses only push (one-sidedness); what Newton's
// law demands of every contact holds, with equality where it pushes; reflections leave nothing approaching
// (feasibility) after few (termination). Lattices of 16 discs have up to 33 contacts for 32 velocities:
// redundant ones are met.
TEST(GroupLaws, RandomElasticGroupsKeepEverything) {
  Random r(5);
  int most = 0;
  for (int i = 0; i < 2000; ++i) {
    const RandomGroup g(r, 1.0, 1.0, 0.0, true);
    const auto before_twists = twists_of(g.bodies);
    const Sums before(g.bodies, before_twists);
    for (const Law law : {resolve_together, resolve_reflections}) {
      const GroupResult result = law(g.bodies, g.contacts, {});
      ASSERT_EQ(result.status, GroupResult::Status::resolved) << "case " << i << " of seed 5";
      const Sums after(g.bodies, result.twists);
      ASSERT_LE((after.momentum - before.momentum).norm(), 1e-16) << i;
      ASSERT_LE(abs(after.energy - before.energy), 1e-16 * (1 + before.energy)) << i;
      for (std::size_t k = 0; k < g.contacts.size(); ++k) {
        ASSERT_GE(result.normal[k], 0) << i;
        const Real v = normal_velocity(g.contacts[k], result.twists);
        if (law == resolve_reflections) {
          ASSERT_GE(v, -1e-16) << i;
          continue;
        }
        const Real slack = v + normal_velocity(g.contacts[k], before_twists);
        ASSERT_GE(slack, -1e-15) << i;
        ASSERT_LE(slack * result.normal[k], 1e-15) << i;
      }
      most = std::max(most, result.reflections);
    }
  }
  EXPECT_GT(most, 3);
  EXPECT_LT(most, 300);
}

// With friction and restitutions of all kinds energy only goes, momentum stays, friction keeps within its
// cone.
TEST(GroupLaws, RandomLossyGroupsNeverGainEnergy) {
  Random r(6);
  for (int i = 0; i < 2000; ++i) {
    const RandomGroup g(r, 0.0, 1.0, i % 2 == 0 ? 0.0 : 0.4, i % 3 == 0);
    const Sums before(g.bodies, twists_of(g.bodies));
    for (const Law law : {resolve_together, resolve_reflections}) {
      const GroupResult result = law(g.bodies, g.contacts, {});
      ASSERT_EQ(result.status, GroupResult::Status::resolved) << "case " << i << " of seed 6";
      const Sums after(g.bodies, result.twists);
      ASSERT_LE((after.momentum - before.momentum).norm(), 1e-16) << i;
      ASSERT_LE(after.energy, before.energy + 1e-16) << i;
      for (std::size_t k = 0; k < g.contacts.size(); ++k)
        ASSERT_LE(abs(result.tangential[k]), g.contacts[k].material.friction * result.normal[k] + 1e-18) << i;
    }
  }
}

// Against Coulomb's law without a rebound, asked of every contact by itself: nothing approaches, what parts is not pushed, what
// slips is dragged against its slip with all its friction. Masses are up to 1e6 apart. Of a few Lemke's method finds none, and it says so.
TEST(GroupLaws, PlasticObeysCoulombAtAllContactsAtOnce) {
  Random r(16);
  int slip = 0, stick = 0, open = 0, none = 0;
  for (int i = 0; i < 1000; ++i) {
    RandomGroup g(r, 0.0, 0.9, r.uniform(0.0, 2.0), i % 3 == 0);
    for (GroupBody& b : g.bodies) {
      const double lighter = r.below(3) == 0 ? std::pow(10.0, r.uniform(0.0, 6.0)) : 1.0;
      b.inverse_mass_x *= lighter;
      b.inverse_mass_y *= lighter;
      b.inverse_inertia *= lighter;
    }
    const Sums before(g.bodies, twists_of(g.bodies));
    const auto found = resolve_plastic(g.bodies, g.contacts);
    if (!found) {
      ++none;
      continue;
    }
    const Sums after(g.bodies, found->twists);
    ASSERT_LE((after.momentum - before.momentum).norm(), 1e-15) << i;
    ASSERT_LE(after.energy, before.energy + 1e-15) << i;
    for (std::size_t k = 0; k < g.contacts.size(); ++k) {
      const GroupContact& c = g.contacts[k];
      const Real p = found->normal[k], q = found->tangential[k], v = normal_velocity(c, found->twists);
      const RealVec along(-c.normal.y(), c.normal.x());
      RealVec point = found->twists[c.body].at(c.arm);
      if (c.other >= 0) point -= found->twists[c.other].at(c.other_arm);
      const Real slips = point.dot(along), room = c.material.friction * p - abs(q);
      ASSERT_GE(v, -1e-12) << i;
      ASSERT_GE(p, 0) << i;
      ASSERT_GE(room, -1e-12) << i;
      if (v > 1e-9) {
        ASSERT_LE(p, 1e-12) << i;
        ++open;
      } else if (abs(slips) > 1e-9 && p > 0) {
        ASSERT_LE(room, 1e-12) << i;
        ASSERT_LE(slips * q, 1e-15) << i;
        ++slip;
      } else {
        ++stick;
      }
    }
  }
  EXPECT_GT(slip, 500);
  EXPECT_GT(stick, 500);
  EXPECT_GT(open, 500);
  EXPECT_LE(none, 5);
}

// The order in which contacts are listed is no matter (without friction).
TEST(GroupLaws, NumberingIsNoMatter) {
  Random r(7);
  for (int i = 0; i < 500; ++i) {
    RandomGroup g(r, 0.5, 0.5, 0.0, true);
    const GroupResult together = resolve_together(g.bodies, g.contacts);
    const GroupResult reflected = resolve_reflections(g.bodies, g.contacts);
    std::reverse(g.contacts.begin(), g.contacts.end());
    const GroupResult together2 = resolve_together(g.bodies, g.contacts);
    const GroupResult reflected2 = resolve_reflections(g.bodies, g.contacts);
    for (std::size_t k = 0; k < g.bodies.size(); ++k) {
      ASSERT_LE((together.twists[k].velocity - together2.twists[k].velocity).norm(), 1e-15)
          << i << " of seed 7";
      ASSERT_LE((reflected.twists[k].velocity - reflected2.twists[k].velocity).norm(), 1e-15) << i;
    }
  }
}

// Against the definition: z >= 0, A z + q >= 0, complementary. A = B B^T of less than full rank is what
// redundant contacts give; q in its range has a solution.
TEST(Lcp, RandomSemidefiniteProblemsMeetTheDefinition) {
  Random r(8);
  for (int i = 0; i < 2000; ++i) {
    const int n = 1 + static_cast<int>(r.below(20)), rank = 1 + static_cast<int>(r.below(n));
    RealMatrix B(n, rank);
    RealVector u(rank);
    for (int j = 0; j < rank; ++j) {
      u[j] = r.uniform(-1, 1);
      for (int k = 0; k < n; ++k) B(k, j) = r.uniform(-1, 1);
    }
    const RealMatrix A = B * B.transpose();
    const RealVector q = B * u;
    const LcpAnswer answer = solve_lcp_by_lemke(A, q);
    ASSERT_EQ(answer.status, LcpAnswer::Status::solved) << "case " << i << " of seed 8";
    const RealVector w = A * answer.z + q;
    ASSERT_GE(answer.z.minCoeff(), 0) << i;
    ASSERT_GE(w.minCoeff(), -1e-12) << i;
    ASSERT_LE(abs(w.dot(answer.z)), 1e-10) << i;
  }
}

/// What n contacts on about half as many bodies make: each row reads two bodies' velocities.
SparseRealMatrix contact_matrix(Random& r, int n) {
  const int bodies = n / 2 + 1;
  RealMatrix J = RealMatrix::Zero(n, 2 * bodies);
  for (int i = 0; i < n; ++i) {
    const auto a = static_cast<int>(r.below(bodies)), b = static_cast<int>(r.below(bodies));
    const double angle = r.uniform(0.0, 2.0 * M_PI);
    J(i, 2 * a) += std::cos(angle);
    J(i, 2 * a + 1) += std::sin(angle);
    J(i, 2 * b) -= std::cos(angle + (a == b ? 1.0 : 0.0));
    J(i, 2 * b + 1) -= std::sin(angle + (a == b ? 1.0 : 0.0));
  }
  return RealMatrix(J * J.transpose()).sparseView();
}

// The two methods against the definition and each other; A z is unique. Twice as many rows as velocities:
// most are redundant. q = A times something <= 0 has a solution.
TEST(Lcp, ActiveSetAndLemkeAgree) {
  Random r(10);
  for (int i = 0; i < 300; ++i) {
    const int n = 2 + static_cast<int>(r.below(70));
    const SparseRealMatrix A = contact_matrix(r, n);
    RealVector u(n);
    for (Real& v : u) v = r.below(3) == 0 ? Real(0) : static_cast<Real>(r.uniform(-1, 1));
    const RealVector q = A * u;
    const LcpAnswer quick = solve_lcp_by_active_set(A, q), slow = solve_lcp_by_lemke(RealMatrix(A), q);
    ASSERT_EQ(quick.status, LcpAnswer::Status::solved) << "case " << i << " of seed 10";
    ASSERT_EQ(slow.status, LcpAnswer::Status::solved) << i;
    const RealVector w = A * quick.z + q;
    ASSERT_GE(quick.z.minCoeff(), 0) << i;
    ASSERT_GE(w.minCoeff(), -1e-14) << i;
    ASSERT_LE(abs(w.dot(quick.z)), 1e-12) << i;
    ASSERT_LE((A * (quick.z - slow.z)).cwiseAbs().maxCoeff(), 1e-12) << i;
  }
}

// Rows alike in q: Lemke's method cycles unless it begins at the last of them.
TEST(Lcp, TiesAtTheBeginDoNotCycle) {
  RealMatrix A(4, 4);
  A << 1, 1, -1, -1, 1, 1, -1, 0, -1, 0, 1, 1, 0, 1, 1, 1;
  const LcpAnswer answer = solve_lcp_by_lemke(A, RealVector::Constant(4, -1));
  ASSERT_EQ(answer.status, LcpAnswer::Status::solved);
  EXPECT_LE(answer.pivots, 5);
  const RealVector w = A * answer.z + RealVector::Constant(4, -1);
  EXPECT_GE(std::min(answer.z.minCoeff(), w.minCoeff()), -1e-15);
  EXPECT_LE(abs(w.dot(answer.z)), 1e-15);
}

// Small integers make ties everywhere, whatever class the matrix is of.
TEST(Lcp, RandomTiesAreNeverCapped) {
  Random r(12);
  for (int i = 0; i < 20000; ++i) {
    const int n = 2 + static_cast<int>(r.below(5));
    RealMatrix A = RealMatrix::Identity(n, n);
    RealVector q(n);
    for (int j = 0; j < n; ++j) {
      q[j] = static_cast<int>(r.below(3)) - 2;
      for (int k = 0; k < n; ++k)
        if (j != k) A(j, k) = static_cast<int>(r.below(3)) - 1;
    }
    ASSERT_NE(solve_lcp_by_lemke(A, q).status, LcpAnswer::Status::capped) << "case " << i << " of seed 12";
  }
}

TEST(Lcp, WithoutSolutionSaysSo) {
  RealMatrix A(2, 2);
  A << 1, -1, -1, 1;  // z0 - z1 >= 1 and z1 - z0 >= 1
  EXPECT_EQ(solve_lcp_by_lemke(A, RealVector::Constant(2, -1)).status, LcpAnswer::Status::none);
  EXPECT_EQ(solve_lcp_by_active_set(A.sparseView(), RealVector::Constant(2, -1)).status,
            LcpAnswer::Status::none);
}

TEST(Lcp, StopsWhenAsked) {
  SeededRandom r(11);
  const SparseRealMatrix A = contact_matrix(r, 60);
  const RealVector q = A * RealVector::Constant(60, -1);
  const GoOn never = [] { return false; };
  EXPECT_EQ(solve_lcp(A, q, never).status, LcpAnswer::Status::stopped);
  EXPECT_EQ(solve_lcp_by_lemke(RealMatrix(A), q, never).status, LcpAnswer::Status::stopped);
}

/// A raft of side * side touching discs, and one more that comes from the left.
std::pair<Bodies, Contacts> raft(int side) {
  Bodies bodies{disc({5, 1})};
  std::vector<RealVec> at{{-1, 0}};
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      at.emplace_back(i + Real(j % 2) / 2, j * sqrt(Real(3)) / 2);
      bodies.push_back(disc({0, 0}));
    }
  Contacts contacts;
  for (std::size_t i = 0; i < at.size(); ++i)
    for (std::size_t j = i + 1; j < at.size(); ++j)
      if ((at[i] - at[j]).norm() < 1 + 1e-12)
        contacts.push_back(touch(static_cast<int>(i), at[i], static_cast<int>(j), at[j]));
  return {bodies, contacts};
}

// A box in a slot of its own width that narrows by less than a rounding: impulses of 1e13 would part it, and more where
// the box turns. Nothing approaches by more than a millionth afterwards, and no energy is won.
TEST(GroupLaws, BoxInASlotOfItsOwnWidthIsParted) {
  SeededRandom random(7);
  for (int k = 0; k < 60; ++k) {
    const Real narrows = std::pow(10.0, random.uniform(-17.0, -12.0)), e = random.below(2) ? 1.0 : 0.5;
    const GroupBody box{
        {RealVec(random.uniform(-1, 1), random.uniform(-2, 0)), random.uniform(-1, 1)}, 1, 1, 6};
    Contacts contacts;
    for (const int side : {-1, 1})
      for (const Real y : {Real(-0.5), Real(0.5)}) {
        GroupContact c;
        c.normal = RealVec(-side, narrows).normalized();
        c.arm = RealVec(Real(side) / 2, y);
        c.material.restitution = static_cast<double>(e);
        contacts.push_back(c);
      }
    const GroupResult result = resolve_reflections({box}, contacts, {});
    ASSERT_NE(result.status, GroupResult::Status::jam) << k;
    const ExtendedTwist &before = box.twist, &after = result.twists[0];
    for (const GroupContact& c : contacts) EXPECT_GT(after.at(c.arm).dot(c.normal), -1e-5) << k;
    const auto energy = [](const ExtendedTwist& t) {
      return t.velocity.squaredNorm() + t.omega * t.omega / 6;
    };
    EXPECT_LE(energy(after), energy(before) * (1 + 1e-6L)) << k;
  }
}

// A hit on a raft of 484 discs with 1387 contacts, at once: energy and momentum to rounding, Newton's law at
// each contact.
TEST(GroupLaws, LargeRaftIsSolvedExactly) {
  const auto [bodies, contacts] = raft(22);
  const Sums before(bodies, twists_of(bodies));
  for (const Law law : {resolve_together, resolve_reflections}) {
    const GroupResult result = law(bodies, contacts, {});
    ASSERT_EQ(result.status, GroupResult::Status::resolved);
    const Sums after(bodies, result.twists);
    EXPECT_LE((after.momentum - before.momentum).norm(), 1e-15);
    EXPECT_LE(abs(after.energy - before.energy), 1e-14 * before.energy);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      ASSERT_GE(result.normal[k], 0);
      const Real v = normal_velocity(contacts[k], result.twists),
                 u = normal_velocity(contacts[k], twists_of(bodies));
      ASSERT_GE(law == resolve_reflections ? v : v + u, -1e-14) << k;
    }
  }
}

/// A disc of radius 1/2 in a hole of its own size.
TEST(GroupLaws, DiscInATightHoleIsTakenAndSaysWhatItCost) {
  GroupContact left, right;
  left.normal = {1, 0};
  left.arm = {-0.5, 0};
  right.normal = {-1, 0};
  right.arm = {0.5, 0};
  const GroupResult result = resolve_reflections({disc({1, 0.5})}, {left, right});
  EXPECT_EQ(result.status, GroupResult::Status::endless);
  EXPECT_NEAR(static_cast<double>(result.lost), 0.5, 1e-17);
  EXPECT_NEAR(static_cast<double>(result.twists[0].velocity.x()), 0, 1e-17);
  EXPECT_NEAR(static_cast<double>(result.twists[0].velocity.y()), 0.5, 1e-17);
}

}  // namespace
}  // namespace brink::group_test
