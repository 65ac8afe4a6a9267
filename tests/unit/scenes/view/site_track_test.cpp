// Sites that move, from state to state along cubics, beside their formulas.
#include "brink/scenes/view/site_track.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "brink/core/base/random.h"
#include "brink/core/shapes/shapes.h"

namespace brink::site_track_test {
namespace {

constexpr double kEnd = 3.0;

FixedSite box() {
  FixedSite site;
  site.outline = std::make_shared<const Outline>(make_box(1.0, 0.2).outline);
  return site;
}

FixedSite along_x(const std::string& formula) {
  FixedSite site = box();
  FormulaMotion motion;
  motion.x.emplace(formula, std::vector<std::string>{"t"});
  site.motion = motion;
  return site;
}

double x_at(const SiteTrack& track, double t) {
  const auto after = std::upper_bound(track.times.begin(), track.times.end() - 1, t);
  const auto k = static_cast<std::size_t>(after - track.times.begin()) - 1;
  const BodyState &l = track.states[k], &r = track.states[k + 1];
  const double h = track.times[k + 1] - track.times[k], s = t - track.times[k];
  const double a = l.pose.position.x(), va = l.twist.velocity.x(), vb = r.twist.velocity.x(),
               slope = (r.pose.position.x() - a) / h;
  return a + s * (va + s * ((3 * slope - 2 * va - vb) / h + s * (va + vb - 2 * slope) / (h * h)));
}

TEST(SiteTrack, IsTheFormulaHoweverQuickItIs) {
  struct Given {
    const char* formula;
    std::function<double(double)> x;
  };
  for (const Given& given : {Given{"0.3*sin(20*t)", [](double t) { return 0.3 * std::sin(20 * t); }},
                             Given{"abs(sin(5*t))", [](double t) { return std::abs(std::sin(5 * t)); }},
                             Given{"0.01*sin(300*t)", [](double t) { return 0.01 * std::sin(300 * t); }},
                             Given{"2*t^2", [](double t) { return 2 * t * t; }},
                             Given{"0.2*cos(6.283185307179586*t)",
                                   [](double t) { return 0.2 * std::cos(6.283185307179586 * t); }}}) {
    const SiteTrack track = track_site(along_x(given.formula), 0.0, kEnd, 100'000);
    EXPECT_TRUE(track.whole);
    Random random(5);
    double worst = 0.0;
    for (int k = 0; k < 20000; ++k) {
      const double t = random.uniform(0.0, kEnd);
      worst = std::max(worst, std::abs(x_at(track, t) - given.x(t)));
    }
    EXPECT_LT(worst, 2e-7) << given.formula;
    // what it says of itself is of three places between two states
    EXPECT_LT(worst, 2.0 * track.off + 1e-10) << given.formula;
  }
}

TEST(SiteTrack, OfAConstantTwistHasTwoStates) {
  FixedSite site = box();
  site.motion = ConstantMotion{{{1.0, -2.0}, 3.0}};
  const SiteTrack track = track_site(site, 0.5, 1e6, 1000);
  ASSERT_EQ(track.times.size(), 2U);
  EXPECT_EQ(track.states[1].pose.position.x(), 1e6);
  EXPECT_TRUE(track.whole);
}

TEST(SiteTrack, SaysWhereItHasNoRoomOrTheMotionFails) {
  const SiteTrack full = track_site(along_x("0.3*sin(20*t)"), 0.0, kEnd, 100);
  EXPECT_FALSE(full.whole);
  EXPECT_EQ(full.times.size(), 100U);
  const SiteTrack failed = track_site(along_x("sqrt(1-t)"), 0.0, kEnd, 100'000);
  EXPECT_FALSE(failed.whole);
  EXPECT_LE(failed.times.back(), 1.0);
}

}  // namespace
}  // namespace brink::site_track_test
