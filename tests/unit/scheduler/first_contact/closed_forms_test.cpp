/// Closed forms give what the general search gives, bit for bit.
#include <gtest/gtest.h>

#include <iomanip>

#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/first_contact/first_contact.h"
#include "tests/support/seeded_random.h"

namespace brink {
namespace {

struct Flier {
  std::unique_ptr<SiteIndex> index;
  Motion motion;

  Flier(const Shape& shape, Motion flight)
      : index(make_brute_force_index(std::make_shared<const Outline>(shape.outline))),
        motion(std::move(flight)) {}
  Mover mover() const { return {index.get(), &motion, 0.0}; }
};

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

}  // namespace
}  // namespace brink
