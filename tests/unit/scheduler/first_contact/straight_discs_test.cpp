// Two discs that go straight at each other: the general search's contact, bit for bit, however many doubles its rounding
// spans.
#include "brink/scheduler/first_contact/straight_discs.h"

#include <gtest/gtest.h>

#include "brink/core/base/random.h"
#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/first_contact/sixteen_probes.h"
#include "tests/support/flier.h"
#include "tests/support/seeded_random.h"

namespace brink::straight_discs_test {
namespace {

using testing::Flier;

Flier disc_of(double radius, double origin, const Vec2& place, const Vec2& velocity) {
  return {make_disc(radius), Motion::ballistic(origin, {{place, 0.0}, {velocity, 0.0}}, {})};
}

DiscMover disc(const Flier& flier) { return {&flier.motion, flier.index->outline().bounding_radius, 0.0}; }

// A distance is the rounded root of a square: what is more than the root must be told by the square, at roots of every size.
TEST(StraightDiscs, SquaresTellWhatRootsTell) {
  Random random(3);
  for (int k = 0; k < 100000; ++k) {
    const double root = std::ldexp(1.0 + random.uniform(), static_cast<int>(random.below(1900)) - 950);
    const double square = greatest_square_within(root);
    ASSERT_LE(std::sqrt(square), root) << std::hexfloat << root;
    ASSERT_GT(std::sqrt(next_after(square)), root) << std::hexfloat << root;
  }
}

// Late on the clock a double of time is more than a gap's rounding, early and far from the origin a small part of it.
TEST(StraightDiscs, MeetAtTheGeneralSearchsTimeEarlyAndLateNearAndFar) {
  SeededRandom r(21);
  SearchLimits limits;
  limits.closed_forms = false;
  SearchScratch scratch;
  WorkCounters work;
  int met = 0, told = 0;
  for (int k = 0; k < 40000; ++k) {
    const double late = std::pow(10.0, r.uniform(-3.0, 5.0)), far = std::pow(10.0, r.uniform(-1.0, 3.0)),
                 speed = std::pow(10.0, r.uniform(-1.0, 1.0));
    const auto flier = [&](double side) {
      const Vec2 velocity(-side * speed * r.uniform(0.2, 1.0), speed * r.uniform(-0.3, 0.3));
      const double since = r.uniform(0.0, std::min(late, 1.0));
      const Vec2 place = Vec2(far + 2.0 * side, far * r.uniform(-1e-3, 1e-3) + r.uniform(-0.5, 0.5));
      return disc_of(r.uniform(0.2, 0.8), late - since, place - since * velocity, velocity);
    };
    const Flier a = flier(1.0), b = flier(-1.0);
    const double from = std::max(a.motion.origin(), b.motion.origin()), to = from + 20.0 / speed;
    DiscContact contact;
    const bool straight = straight_discs_meet(disc(a), disc(b), from, to, limits, contact);
    const PairAnswer slow = first_contact(a.mover(), b.mover(), from, to, limits, scratch, work);
    met += slow.status == PairAnswer::Status::contact;
    told += straight;
    if (!straight || contact.closing_speed < 1e-2 * speed) continue;  // grazing
    ASSERT_EQ(slow.status, PairAnswer::Status::contact) << "case " << k;
    ASSERT_EQ(contact.time, slow.contact.time) << "case " << k << " late " << late << " far " << far;
    ASSERT_EQ(contact.gap, slow.contact.gap) << "case " << k;
  }
  EXPECT_GT(met, 10000);
  EXPECT_GT(told, met * 9 / 10);
}

/// Of a rounding of that size.
Vec2 left_over(SeededRandom& r, const Vec2& of) {
  const auto low = [&](double x) { return r.uniform(-0.5, 0.5) * ulp(x); };
  return {low(of.x()), low(of.y())};
}

// So far that all searches see the pair from its own place, in extended precision, and starts have a low-order part.
TEST(StraightDiscs, MeetAtTheGeneralSearchsTimeWherePlacesInDoublesDoNotTellGaps) {
  SeededRandom r(22);
  SearchLimits limits;
  limits.closed_forms = false;
  SearchScratch scratch;
  WorkCounters work;
  int met = 0, told = 0;
  for (int k = 0; k < 40000; ++k) {
    const double late = std::pow(10.0, r.uniform(-3.0, 4.0)), far = std::pow(10.0, r.uniform(2.3, 7.0)),
                 speed = std::pow(10.0, r.uniform(-1.0, 1.0));
    const auto flier = [&](double side) {
      Vec2 velocity(-side * speed * r.uniform(0.2, 1.0), speed * r.uniform(-0.3, 0.3));
      if (k % 16 == 0) velocity.y() = 0.0;
      const double since = r.uniform(0.0, std::min(late, 1.0));
      const Vec2 place = Vec2(far + 2.0 * side, -0.5 * far + r.uniform(-0.5, 0.5));
      const Vec2 start = place - since * velocity;
      const BodyState low{{left_over(r, start), 0.0}, {left_over(r, velocity), 0.0}};
      return Flier{make_disc(r.uniform(0.2, 0.8)),
                   Motion::ballistic(late - since, {{start, 0.3}, {velocity, 0.7}}, {},
                                     std::numeric_limits<double>::infinity(), low)};
    };
    const Flier a = flier(1.0), b = flier(-1.0);
    const double from = std::max(a.motion.origin(), b.motion.origin()), to = from + 20.0 / speed;
    DiscContact contact;
    const bool straight = straight_discs_meet(disc(a), disc(b), from, to, limits, contact);
    const PairAnswer slow = first_contact(a.mover(), b.mover(), from, to, limits, scratch, work);
    met += slow.status == PairAnswer::Status::contact;
    told += straight;
    if (!straight || contact.closing_speed < 1e-2 * speed) continue;  // grazing
    ASSERT_EQ(slow.status, PairAnswer::Status::contact) << "case " << k;
    ASSERT_EQ(contact.time, slow.contact.time) << "case " << k << " late " << late << " far " << far;
    ASSERT_EQ(contact.gap, slow.contact.gap) << "case " << k;
    ASSERT_NEAR(contact.closing_speed, slow.contact.closing_speed, 1e-9 * speed) << "case " << k;
    const PairAnswer quick = first_contact(a.mover(), b.mover(), from, to, SearchLimits(), scratch, work);
    ASSERT_EQ(quick.contact.time, slow.contact.time) << "case " << k;
    ASSERT_EQ(quick.contact.gap, slow.contact.gap) << "case " << k;
    ASSERT_EQ(quick.contact.level, slow.contact.level) << "case " << k;
    ASSERT_EQ(quick.contact.closing_speed, slow.contact.closing_speed) << "case " << k;
    ASSERT_EQ(quick.contact.normal, slow.contact.normal) << "case " << k;
    ASSERT_EQ(quick.contact.point, slow.contact.point) << "case " << k;
  }
  EXPECT_GT(work.closed_forms, 10000U);
  EXPECT_GT(met, 10000);
  EXPECT_GT(told, met * 9 / 10);
}

}  // namespace
}  // namespace brink::straight_discs_test
