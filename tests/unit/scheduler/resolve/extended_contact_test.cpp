#include "brink/scheduler/resolve/extended_contact.h"

#include <gtest/gtest.h>

#include <random>

#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/shapes.h"

namespace brink::extended_contact_test {
namespace {

class Random {
 public:
  double upto(double size) { return std::uniform_real_distribution<double>(-size, size)(engine_); }
  ExtendedState state() {
    return {BodyState{{{upto(3.0), upto(3.0)}, upto(10.0)}, {{upto(5.0), upto(5.0)}, upto(5.0)}}};
  }

 private:
  std::mt19937_64 engine_{20261124};
};

/// How b's site and a's sample meet, from their places in doubles; nothing where they are too near for a direction.
std::optional<FeatureContact> told(const Outline& a, const ExtendedState& at_a, int sample, const Outline& b,
                                   const ExtendedState& at_b, int site) {
  const Frame frame_a(at_a.rounded().pose), frame_b(at_b.rounded().pose);
  const Vec2 p = frame_b.to_local(frame_a.to_world(a.samples[sample].p));
  const Nearest nearest = nearest_on(b.sites[site], p);
  if (nearest.distance < 0.05) return std::nullopt;
  FeatureContact f;
  f.sample_on_a = true;
  f.sample = sample;
  f.site = site;
  f.normal = frame_b.direction_to_world((p - nearest.point) / nearest.distance);
  f.gap = nearest.distance - b.sites[site].radius - a.samples[sample].radius;
  return f;
}

// What is moved on to first order is what is seen in the states moved on, but for the square of the way.
TEST(ExtendedContact, MovedOnIsWhatIsSeenAMomentLater) {
  const Outline outlines[] = {make_disc(0.4).outline, make_box(1.0, 0.6).outline,
                              make_capsule(1.0, 0.2).outline, make_arc({0.0, 0.0}, 1.0, 0.3, 2.0).outline,
                              make_segment({-1, 0}, {1, 0.3}).outline};
  Random random;
  constexpr double moment = 1e-10;
  int straight = 0, about = 0;
  for (int round = 0; round < 200; ++round)
    for (const Outline& a : outlines)
      for (const Outline& b : outlines) {
        const ExtendedState at_a = random.state(), at_b = random.state();
        for (int i = 0; i < static_cast<int>(a.samples.size()); ++i)
          for (int j = 0; j < static_cast<int>(b.sites.size()); ++j) {
            if (a.samples[i].arc_site >= 0) continue;
            const auto like = told(a, at_a, i, b, at_b, j);
            if (!like) continue;
            const ExtendedContact now = contact_in(a, b, at_a, at_b, *like), moved = now.moved(moment),
                                  then = contact_in(a, b, at_a.moved(moment), at_b.moved(moment), *like);
            // normals turn by up to 1000 rad/s, over arms of some metres: 10 (1000 moment)^2; to first order it is 1e-8
            const double square = 1e-13;
            ASSERT_LE(static_cast<double>((moved.point - then.point).norm()), square);
            ASSERT_LE(static_cast<double>((moved.normal - then.normal).norm()), square);
            ASSERT_LE(static_cast<double>(abs(moved.gap - then.gap)), square);
            (now.turn_rate == at_b.twist.omega.high() ? straight : about) += 1;
          }
      }
  EXPECT_GT(straight, 1000);
  EXPECT_GT(about, 1000);
}

}  // namespace
}  // namespace brink::extended_contact_test
