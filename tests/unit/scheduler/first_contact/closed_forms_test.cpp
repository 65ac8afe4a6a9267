/// Closed forms give what the general search gives, bit for bit.
#include <gtest/gtest.h>

#include <iomanip>

#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/first_contact/closed_forms.h"
#include "brink/scheduler/first_contact/first_contact.h"
#include "tests/support/flier.h"
#include "tests/support/seeded_random.h"

namespace brink::closed_forms_test {
namespace {

using testing::Flier;

Flier disc_towards_the_origin(Random& r, double side, const Vec2& gravity) {
  const double radius = r.uniform(0.1, 1.0), speed = std::pow(10.0, r.uniform(-2.0, 3.0));
  BodyState start{{{3.0 * side, r.uniform(-1.0, 1.0)}, r.uniform(-9.0, 9.0)},
                  {{-side * speed, 0.3 * speed * r.uniform(-1.0, 1.0)}, r.uniform(-50.0, 50.0)}};
  return {make_disc(radius), Motion::ballistic(r.uniform(0.0, 2.0), start, {gravity, r.uniform(-1.0, 1.0)})};
}

/// Looks for the same contact with closed forms and without.
class BothWays {
 public:
  BothWays() { general_.closed_forms = false; }

  PairAnswer quick(const Flier& a, const Flier& b, double from, double to) {
    return first_contact(a.mover(), b.mover(), from, to, closed_, scratch_, work_);
  }
  PairAnswer slow(const Flier& a, const Flier& b, double from, double to) {
    return first_contact(a.mover(), b.mover(), from, to, general_, scratch_, work_);
  }
  std::uint64_t closed_forms() const { return work_.closed_forms; }

 private:
  SearchLimits closed_, general_;
  SearchScratch scratch_;
  WorkCounters work_;
};

bool same(const PairAnswer& x, const PairAnswer& y) {
  const FeatureContact &c = x.contact, &d = y.contact;
  return x.status == y.status && x.until == y.until &&
         (x.status != PairAnswer::Status::contact ||
          (c.time == d.time && c.gap == d.gap && c.closing_speed == d.closing_speed && c.normal == d.normal &&
           c.point == d.point && c.sample == d.sample && c.site == d.site && c.sample_on_a == d.sample_on_a));
}

// Both ways end on the last double at which the same computed gap is above zero; grazing pairs apart, where
// that is not unique (closing at less than a thousandth of the speed).
TEST(ClosedForms, TwoDiscsGiveEveryBitOfTheGeneralSearch) {
  SeededRandom r(11);
  BothWays search;
  int contacts = 0;
  for (int k = 0; k < 50000; ++k) {
    const Vec2 gravity = k % 2 ? Vec2(0.0, -9.81) : Vec2(Vec2::Zero());
    const Flier a = disc_towards_the_origin(r, 1.0, gravity), b = disc_towards_the_origin(r, -1.0, gravity);
    const double from = std::max(a.motion.origin(), b.motion.origin());
    const BodyState sa = a.motion.state(from), sb = b.motion.state(from);
    const double reach = a.mover().outline().bounding_radius + b.mover().outline().bounding_radius;
    if ((sa.pose.position - sb.pose.position).norm() <= reach) continue;
    const double speed = (sa.twist.velocity - sb.twist.velocity).norm();
    const double to = from + 10.0 / speed;
    const PairAnswer quick = search.quick(a, b, from, to);
    const PairAnswer slow = search.slow(a, b, from, to);
    if (slow.status == PairAnswer::Status::contact && slow.contact.closing_speed < 1e-3 * speed) continue;
    contacts += slow.status == PairAnswer::Status::contact;
    ASSERT_TRUE(same(quick, slow)) << "case " << k << ": " << std::setprecision(17) << quick.until << " and "
                                   << slow.until;
  }
  EXPECT_GT(contacts, 10000);
}

// Without its place, and whichever way it is found: with gravity, or close to a rounding, by the way of all.
TEST(ClosedForms, ThatTwoDiscsMeetIsToldWithTheBitsOfTheGeneralSearch) {
  SeededRandom r(13);
  BothWays search;
  const SearchLimits limits;
  int told = 0, met = 0;
  for (int k = 0; k < 50000; ++k) {
    const Vec2 gravity = k % 4 ? Vec2(Vec2::Zero()) : Vec2(0.0, -9.81);
    const Flier a = disc_towards_the_origin(r, 1.0, gravity), b = disc_towards_the_origin(r, -1.0, gravity);
    const double from = std::max(a.motion.origin(), b.motion.origin()), to = from + r.uniform(0.0, 3.0);
    const auto mover = [](const Flier& f) {
      return DiscMover{&f.motion, f.mover().outline().bounding_radius, 0.0};
    };
    const PairAnswer slow = search.slow(a, b, from, to);
    DiscContact contact;
    met += slow.status == PairAnswer::Status::contact;
    if (!discs_meet(mover(a), mover(b), from, to, limits, contact)) continue;
    ++told;
    const double speed = (a.motion.twist(from).velocity - b.motion.twist(from).velocity).norm();
    if (contact.closing_speed < 1e-3 * speed) continue;  // grazing
    ASSERT_EQ(slow.status, PairAnswer::Status::contact) << "case " << k;
    ASSERT_EQ(contact.time, slow.contact.time) << "case " << k;
    ASSERT_EQ(contact.gap, slow.contact.gap) << "case " << k;
    ASSERT_NEAR(contact.closing_speed, slow.contact.closing_speed, 1e-9 * speed) << "case " << k;
    ASSERT_EQ(contact_of_discs(mover(a), mover(b), contact.time).normal, slow.contact.normal);
  }
  EXPECT_GT(told, 5000);
  EXPECT_GT(told, met * 99 / 100);
}

// The same for the time and site of a disc that falls into a chain of segments that does not turn. (Its gap
// and normal are looked at again by first_contact.) It may touch two at once: a notch of two equal flanks,
// every third case.
TEST(ClosedForms, ADiscAndSegmentsGiveTheGeneralSearchsTimeAndSite) {
  SeededRandom r(12);
  BothWays search;
  int contacts = 0;
  for (int k = 0; k < 50000; ++k) {
    const bool notch = k % 3 == 0;
    const double deep = -r.uniform(0.3, 1.5), thick = r.below(2) ? 0.0 : 0.05;
    const std::vector<Vec2> v{{-4.0, 1.0}, {0.0, deep}, {4.0, notch ? 1.0 : r.uniform(0.0, 2.0)}};
    const Flier chain{make_chain(v, false, thick),
                      Motion::still({{0.0, 0.0}, notch ? 0.0 : r.uniform(-0.3, 0.3)})};
    const double x = notch ? 0.0 : r.uniform(-2.0, 2.0);
    const BodyState start{{{x, 3.0}, 0.0}, {{notch ? 0.0 : r.uniform(-0.5, 0.5), r.uniform(-5.0, 2.0)}, 1.0}};
    const Flier disc{make_disc(r.uniform(0.1, 0.5)), Motion::ballistic(0.0, start, {{0.0, -9.81}, 0.0})};
    const std::uint64_t before = search.closed_forms();
    const PairAnswer quick = search.quick(disc, chain, 0.0, 5.0);
    if (search.closed_forms() == before) continue;
    const PairAnswer slow = search.slow(disc, chain, 0.0, 5.0);
    contacts += slow.status == PairAnswer::Status::contact;
    ASSERT_TRUE(quick.status == slow.status && quick.until == slow.until &&
                quick.contact.site == slow.contact.site)
        << "case " << k << ": " << std::setprecision(17) << quick.until << " and " << slow.until << ", sites "
        << quick.contact.site << " and " << slow.contact.site;
  }
  EXPECT_GT(contacts, 10000);
}

// ---- pairs that start at the touch

/// A number of either sign, its size told by powers of ten.
double of_any_size(Random& r, double low, double high) {
  return (r.below(2) ? 1.0 : -1.0) * low * std::pow(high / low, r.uniform());
}

/// Motions of a disc and something else whose gap, at the later of their beginnings, is nothing to speak of: from the
/// rounding of coordinates to what a scene may overlap by.
class AtTheTouch {
 public:
  explicit AtTheTouch(Random& r) : r_(r), begin_(r.below(2) ? 0.0 : r.uniform(0.0, 10.0)) {
    if (r.below(3)) far_ = std::pow(10.0, r.uniform(-1.0, 3.5));
    size_ = std::pow(10.0, r.uniform(-1.3, 1.3));
    gap_ = r.below(3) == 0 ? 0.0 : of_any_size(r, 1e-16, 1e-9) * size_;
    speed_ = std::pow(10.0, r.uniform(-5.0, 1.7));
    drift_ = speed_ * Vec2(r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0));
    base_ = far_ * Vec2(r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0));
  }

  /// `out`: from the other to the disc. Half of the ways lead straight there, others along the surface or anywhere.
  Flier disc(const Vec2& out, const Vec2& along, double reach, double radius, const Vec2& gravity) {
    const double graze = of_any_size(r_, 1e-13, 1.0);
    const Vec2 way = r_.below(2) ? Vec2(-out)
                     : r_.below(2)
                         ? Vec2((perp(out) - graze * out).normalized())
                         : Vec2(Frame({Vec2::Zero(), r_.uniform(0.0, 6.3)}).direction_to_world(out));
    const BodyState start{{base_ + along + (reach + gap_) * out, 0.0}, {drift_ + speed_ * way, 0.0}};
    const double later = begin_ + (r_.below(2) ? 0.0 : r_.uniform(0.0, 1e-10));
    return {make_disc(radius), Motion::ballistic(later, start, {gravity, 0.0})};
  }
  Flier other(const Shape& shape, double angle, const Vec2& gravity) {
    return {shape, Motion::ballistic(begin_, {{base_, angle}, {drift_, 0.0}}, {gravity, 0.0})};
  }
  double size() const { return size_; }

 private:
  Random& r_;
  double begin_, far_ = 0.0, size_ = 0.0, gap_ = 0.0, speed_ = 0.0;
  Vec2 drift_, base_;
};

/// What closed forms and the general search say of a pair from where it began.
struct Agreement {
  BothWays search;
  int contacts = 0;

  bool of(const Flier& a, const Flier& b) {
    const double from = std::max(a.motion.origin(), b.motion.origin());
    const PairAnswer quick = search.quick(a, b, from, from + 2.0), slow = search.slow(a, b, from, from + 2.0);
    contacts += slow.status == PairAnswer::Status::contact;
    return same(quick, slow);
  }
};

TEST(ClosedForms, DiscsThatStartAtTheTouchGiveEveryBit) {
  SeededRandom r(13);
  Agreement both;
  for (int k = 0; k < 50000; ++k) {
    AtTheTouch pair(r);
    const double angle = r.below(4) ? r.uniform(-3.2, 3.2) : 0.0, radius = r.uniform(0.1, 1.0) * pair.size();
    const Vec2 gravity = r.below(2) ? Vec2(0.0, -9.81) : Vec2(0.0, 0.0);
    const Flier b = pair.other(make_disc(pair.size()), 0.0, gravity);
    const Flier a =
        pair.disc({std::cos(angle), std::sin(angle)}, Vec2::Zero(), radius + pair.size(), radius, gravity);
    ASSERT_TRUE(both.of(a, b)) << "case " << k;
  }
  EXPECT_GT(both.contacts, 10000);
  EXPECT_GT(both.search.closed_forms(), 10000U);
}

// A disc that overlaps a wall by less than a scene may, and is pulled deeper, was once let through: its gap had no
// root left.
TEST(ClosedForms, DiscsThatStartAtAWallGiveEveryBit) {
  SeededRandom r(14);
  Agreement both;
  for (int k = 0; k < 50000; ++k) {
    AtTheTouch pair(r);
    const double angle = r.below(3) ? r.uniform(-3.2, 3.2) : 0.0, radius = r.uniform(0.1, 1.0) * pair.size();
    const double half = r.below(2) ? 0.0 : 0.3 * pair.size(), length = 2.0 * pair.size();
    const Vec2 out = Frame({Vec2::Zero(), angle}).direction_to_world({0.0, r.below(2) ? 1.0 : -1.0});
    const Vec2 along = r.uniform(-1.1, 1.1) * length * perp(out);
    const Vec2 pull(0.0, -9.81), none(0.0, 0.0);
    const Flier b =
        pair.other(make_segment({-length, 0.0}, {length, 0.0}, half), angle, r.below(2) ? none : pull);
    const Flier a = pair.disc(out, along, radius + half, radius, r.below(2) ? none : pull);
    ASSERT_TRUE(both.of(a, b)) << "case " << k;
  }
  EXPECT_GT(both.contacts, 10000);
  EXPECT_GT(both.search.closed_forms(), 5000U);
}

/// True if, wherever the window ends about the time of contact, that is told by both ways where it is in the window, and
/// nowhere else.
bool told_by_its_window(BothWays& search, SeededRandom& r, const Flier& a, const Flier& b, double from,
                        double contact) {
  for (int k = 0; k < 24; ++k) {
    const double off = std::pow(10.0, r.uniform(-17.0, -7.0)) * (k % 2 ? 1.0 : -1.0);
    const double to = k < 2 ? std::nextafter(contact, k ? 1e9 : 0.0) : contact + off;
    if (to < from) continue;
    for (const PairAnswer& answer : {search.quick(a, b, from, to), search.slow(a, b, from, to)}) {
      const bool told = answer.status == PairAnswer::Status::contact;
      if (told != (contact <= to) || (told && answer.contact.time != contact)) return false;
    }
  }
  return true;
}

// What creeps towards what it is pressed on takes long over a rounding: whether it meets by the end of a window is for
// the canonical time to say, not for the root of a quadratic.
TEST(ClosedForms, AWindowThatEndsRightAfterTheContactHasIt) {
  SeededRandom r(14);
  BothWays search;
  int met = 0;
  for (int k = 0; k < 4000; ++k) {
    const double radius = r.uniform(0.1, 1.0), from = r.uniform(0.0, 2.0), x = r.uniform(-20.0, 20.0);
    const bool discs = k % 4 == 0;
    const Vec2 gravity(0.0, discs ? 0.0 : -8.0);
    const double creep = discs   ? std::pow(10.0, r.uniform(-8.0, -2.0))
                         : k % 2 ? 0.0
                                 : 1e-8 * r.uniform(-1.0, 1.0);
    // on the end of a floor, or near a disc
    const double floor = r.uniform(-1.0, 1.0), above = discs ? 1e-6 : 0.0;
    const Flier ball(
        make_disc(radius),
        Motion::ballistic(from, {{{x, floor + radius + above}, 0.0}, {{0.0, -creep}, 0.0}}, {gravity, 0.0}));
    const Flier ground =
        discs ? Flier(make_disc(0.5), Motion::still({{x, floor - 0.5}, 0.0}))
              : Flier(make_segment({x, 0.0}, {x + 4.0, 0.0}), Motion::still({{0.0, floor}, 0.0}));
    const PairAnswer first = search.slow(ball, ground, from, from + 1e3);
    if (first.status != PairAnswer::Status::contact || first.contact.time == from) continue;
    ++met;
    ASSERT_TRUE(told_by_its_window(search, r, ball, ground, from, first.contact.time))
        << "case " << k << ": " << std::setprecision(17) << first.contact.time << " from " << from;
  }
  EXPECT_GT(met, 2000);
}

}  // namespace
}  // namespace brink::closed_forms_test
