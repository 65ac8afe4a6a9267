#include "brink/scheduler/islands/modes/choose_modes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "brink/scheduler/islands/modes/mode_forces.h"
#include "tests/support/seeded_random.h"
#include "tests/unit/scheduler/islands/modes/mode_scenes.h"

namespace brink::choose_modes_test {
namespace {

ModeMoment now(const ModeScene& s) { return moment_at(s.problem, 0.0, s.states); }

/// A rod of 1 kg that leans with its lower end on the floor at angle `lean` from it and slides at v along x.
ModeScene leaning_rod(double lean, double v, double friction) {
  const double l = 0.5;
  ModeScene s;
  const Vec2 half = l * Vec2(std::cos(lean), std::sin(lean));
  s.add_body(1.0, 4 * l * l / 12, {{half, lean}, {{v, 0}, 0}});
  const int floor = s.add_still();
  s.add(point_on_line({-l, 0}, {0, 0}, {0, 1}), 0, floor, friction);
  return s;
}

// Painleve 1895: paradox for mu > (1 + 3 c^2) / (3 s c), the least 4/3 at tan = 2; c, s of the lean.
TEST(ChooseModes, PainlevesRodHasNoModesBeyondItsFrictionAndOneBefore) {
  const double lean = std::atan(2.0);
  for (const double mu : {1.30, 1.33, 1.34, 1.5}) {
    const ModeScene into = leaning_rod(lean, -1.0, mu), away = leaning_rod(lean, 1.0, mu);
    const auto known = [](double v) {
      return std::vector{v > 0 ? ContactKnown::slides_plus : ContactKnown::slides_minus};
    };
    const ContactRates r = now(into).contacts[0];
    // friction that presses the end into the floor: it slides the way that the rod leans from
    int without = 0;
    for (const ModeScene* s : {&into, &away}) {
      const double slip = now(*s).contacts[0].tangential_velocity;
      without += !choose_modes(s->problem, now(*s), known(slip)).found;
    }
    EXPECT_EQ(without, mu > 4.0 / 3 ? 1 : 0) << mu << " " << r.gap;
  }
}

TEST(ChooseModes, BoxOnItsEdgeTipsOverOrStaysByWhereItsWeightIs) {
  for (const double angle : {0.3, -0.3}) {  // inclines; friction holds it
    ModeScene s = box_on_incline(0.1, 0.5, angle, 5.0);
    const ModeChoice c = choose_modes(s.problem, now(s), {ContactKnown::still, ContactKnown::still});
    ASSERT_TRUE(c.found);
    const bool left = angle > 0;  // the lower corner
    EXPECT_EQ(c.modes[left ? 0 : 1], MotionMode::stick);
    EXPECT_EQ(c.modes[left ? 1 : 0], MotionMode::open);
  }
}

// Whatever is chosen keeps Coulomb's law: forces in their cones, nothing accelerates into a contact, and what begins
// to slip is held back.
TEST(ChooseModes, RandomBodiesInRandomCornersKeepCoulombsLaw) {
  SeededRandom random(11);
  int closed = 0, found = 0;
  for (int n = 0; n < 500; ++n) {
    SCOPED_TRACE("case " + std::to_string(n));
    ModeScene s;
    s.add_body(random.uniform(0.5, 2), random.uniform(0.1, 1), {});
    s.add_body(random.uniform(0.5, 2), random.uniform(0.1, 1), {{{0.1, 0.9}, 0.2}, {}});
    const int still = s.add_still();
    for (int k = 0; k < 5; ++k) {
      const int on = k % 2, of = k == 4 ? 0 : still;
      const double a = random.uniform(0.5, 2.6);
      s.add(point_on_line({random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)}, {0, 0},
                          {std::cos(a), std::sin(a)}),
            k == 4 ? 1 : on, of, random.uniform(0, 0.6));
    }
    const ModeMoment m = now(s);
    const ModeChoice c = choose_modes(s.problem, m, std::vector(5, ContactKnown::still));
    if (!c.found) continue;
    ++found;
    const ModeForces f = forces_in(s.problem, m, c.modes);
    EXPECT_TRUE(f.consistent);
    EXPECT_GE(f.margin, -1e-9);
    for (std::size_t k = 0; k < 5; ++k) {
      const ContactRates& r = m.contacts[k];
      const double an =
          row_of(s.problem, s.problem.contacts[k], r.normal_on_sample, r.normal_on_site).dot(f.acceleration);
      const double at = row_of(s.problem, s.problem.contacts[k], r.tangent_on_sample, r.tangent_on_site)
                            .dot(f.acceleration);
      EXPECT_GE(an, -1e-9);
      closed += is_closed(c.modes[k]);
      EXPECT_LE(is_slip(c.modes[k]) ? at * f.tangential[k] : 0.0, 1e-12);
      EXPECT_NEAR(c.modes[k] == MotionMode::stick ? at : 0.0, 0.0, 1e-9);
    }
  }
  EXPECT_GT(found, 490);
  EXPECT_GT(closed, 500);
}

}  // namespace
}  // namespace brink::choose_modes_test
