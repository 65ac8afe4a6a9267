// How long a pair is told to be apart at a glance: never longer than until its first contact, by gaps that are looked at
// densely.
#include "brink/scheduler/first_contact/apart.h"

#include <gtest/gtest.h>

#include "brink/core/shapes/shapes.h"
#include "tests/support/flier.h"
#include "tests/support/seeded_random.h"

namespace brink::apart_test {
namespace {

using testing::Flier;

Shape any_body(Random& r) {
  switch (r.below(8)) {
    case 4:
      return make_polygon({{0.3, 0.0}, {0.05, 0.05}, {0.0, 0.3}, {-0.05, 0.05}, {-0.3, 0.0}, {0.0, -0.1}});
    case 5:
      return make_box(r.uniform(0.2, 0.5), r.uniform(0.2, 0.5), r.uniform(0.0, 0.1));
    case 6:
      return make_arc({r.uniform(-0.2, 0.2), 0.0}, r.uniform(0.1, 0.4), r.uniform(-3.0, 0.0),
                      r.uniform(0.1, 3.0));
    case 7:
      return make_path("M -1 -1 A 1.2 1.2 0 0 1 1 -1 L 1 1 A 2 2 0 0 0 -1 1 Z", 0.2, 1e-6);
    case 0:
      return make_disc(r.uniform(0.01, 0.3));
    case 1:
      return make_box(r.uniform(0.01, 0.5), r.uniform(0.01, 0.5));
    case 2:
      return make_segment({-0.2, 0.0}, {0.2, 0.0}, r.uniform(0.0, 0.1));
    default:
      return make_chain({{-0.2, 0.0}, {0.0, 0.1}, {0.2, 0.0}}, false);
  }
}

Shape any_wall(Random& r) {
  const double length = r.uniform(0.1, 30.0);
  switch (r.below(4)) {
    case 0:
      return make_segment({-length, 0.0}, {length, 0.0});
    case 1:
      return make_segment({-length, 0.0}, {length, 0.0}, r.uniform(0.0, 0.5));
    case 2:
      return make_polygon({{-length, -1.0}, {length, -1.0}, {length, 0.0}, {-length, 0.0}});
    default:
      return make_chain({{-length, 0.5}, {0.0, 0.0}, {length, 0.5}}, false);
  }
}

/// Half of them stand, the others go somewhere and turn.
Motion of_a_wall(Random& r, const Vec2& base) {
  const Pose pose{base, r.uniform(-3.2, 3.2)};
  if (r.below(2)) return Motion::still(pose);
  const Twist twist{{r.uniform(-2.0, 2.0), r.uniform(-2.0, 2.0)}, r.uniform(-3.0, 3.0)};
  return Motion::ballistic(0.0, {pose, twist}, {{0.0, r.uniform(-9.81, 0.0)}, 0.0});
}

TEST(Apart, IsNeverToldForLongerThanUntilTheFirstContact) {
  SeededRandom r(20261124);
  SearchScratch scratch;
  int told = 0, beside = 0, stopped = 0;
  for (int k = 0; k < 8000; ++k) {
    const double far = r.below(3) ? 0.0 : std::pow(10.0, r.uniform(0.0, 6.0));
    const Vec2 base(far * r.uniform(-1.0, 1.0), far * r.uniform(-1.0, 1.0));
    const Shape of_body = any_body(r), of_wall = r.below(2) ? any_wall(r) : any_body(r);
    const Vec2 offset(r.uniform(-4.0, 4.0), r.uniform(-4.0, 4.0));
    const Vec2 way = -r.uniform(0.0, 5.0) * offset + Vec2(r.uniform(-3.0, 3.0), r.uniform(-3.0, 3.0));
    const Flier body = Flier(
        of_body, Motion::ballistic(0.0, {{base + offset, r.uniform(-3.2, 3.2)}, {way, r.uniform(-9.0, 9.0)}},
                                   {{0.0, -9.81}, 0.0}));
    const Flier wall = Flier(of_wall, of_a_wall(r, base));
    const bool first = r.below(2) != 0;
    const Mover a = (first ? body : wall).mover(), b = (first ? wall : body).mover();
    SearchLimits limits;
    if (r.below(2)) limits.max_iterations = 3;
    if (pair_gap(a, b, 0.0, limits, scratch) < 1e-3) continue;
    const detail::Apart apart = detail::apart_until(a, b, 0.0, 1.0, limits);
    const double until = apart.until;
    stopped += apart.stopped;
    ASSERT_FALSE(apart.stopped && limits.max_iterations > 3);
    ASSERT_GE(until, 0.0);
    told += until > 0.0;
    beside += of_wall.outline.bounding_radius > 2.0 * of_body.outline.bounding_radius && until > 0.05;
    for (int i = 0; i <= 200; ++i) {
      const double t = std::min(until, 1.0) * i / 200.0;
      ASSERT_GT(pair_gap(a, b, t, limits, scratch), 0.0) << "case " << k << " at " << t << " of " << until;
    }
  }
  EXPECT_GT(told, 4000);
  EXPECT_GT(beside, 500);
  EXPECT_GT(stopped, 100);
}

// Two bars that pass each other by a hand's breadth: no disc tells that, a line between them does, all the way.
TEST(Apart, OfBarsThatPassALineTellsToTheEnd) {
  const Flier still = Flier(make_box(2.0, 0.2), Motion::still({}));
  const Flier bar =
      Flier(make_box(2.0, 0.2), Motion::ballistic(0.0, {{{-5.0, 0.3}, 0.0}, {{5.0, 0.0}, 0.0}}, {}));
  EXPECT_EQ(detail::apart_until(bar.mover(), still.mover(), 0.0, 2.0, SearchLimits()).until, 2.0);
}

// Few steps are an instalment: what was told so far is the answer, and one that goes on from there comes to the same end.
TEST(Apart, InInstalmentsComesToTheSameContact) {
  SeededRandom r(7);
  SearchScratch scratch;
  int contacts = 0;
  for (int k = 0; k < 500; ++k) {
    const Flier a = Flier(any_body(r), Motion::ballistic(0.0,
                                                         {{{2.0, r.uniform(-0.3, 0.3)}, r.uniform(-3.0, 3.0)},
                                                          {{-3.0, 0.0}, r.uniform(-20.0, 20.0)}},
                                                         {}));
    const Flier b = Flier(any_body(r), Motion::ballistic(0.0, {{}, {{}, r.uniform(-20.0, 20.0)}}, {}));
    WorkCounters work;
    const PairAnswer whole = first_contact(a.mover(), b.mover(), 0.0, 1.5, SearchLimits(), scratch, work);
    SearchLimits few;
    few.max_iterations = 3;
    PairAnswer answer{PairAnswer::Status::undecided, 0.0, {}};
    for (int i = 0; i < 10000 && answer.status == PairAnswer::Status::undecided; ++i)
      answer = first_contact(a.mover(), b.mover(), answer.until, 1.5, few, scratch, work);
    ASSERT_EQ(answer.status, whole.status) << "case " << k;
    ASSERT_EQ(answer.until, whole.until) << "case " << k;
    contacts += answer.status == PairAnswer::Status::contact;
  }
  EXPECT_GT(contacts, 250);
}

TEST(Apart, OfAContainerNothingIsTold) {
  const Flier room = Flier(make_disc_container(4.0), Motion::still({}));
  const Flier disc = Flier(make_disc(0.1), Motion::ballistic(0.0, {{}, {{1.0, 0.0}, 0.0}}, {}));
  EXPECT_EQ(detail::apart_until(disc.mover(), room.mover(), 0.25, 1.0, SearchLimits()).until, 0.25);
}

}  // namespace
}  // namespace brink::apart_test
