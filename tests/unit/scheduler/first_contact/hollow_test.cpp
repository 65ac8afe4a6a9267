/// Discs that roll along the inside of a circle, chord after chord: when they meet it again is known.
#include <gtest/gtest.h>

#include <numbers>

#include "brink/core/base/random.h"
#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/first_contact/first_contact.h"

namespace brink::hollow_test {
namespace {

// A disc of radius r in a hollow circle of radius R that leaves it at an angle a to the inner normal meets it
// again after 2 (R - r) cos a / v: also where it starts a part of the contact tolerance short of it.
TEST(Hollow, ADiscMeetsTheCircleItLeavesAfterOneChord) {
  constexpr std::uint64_t kSeed = 7;
  std::cout << "seed " << kSeed << "\n";
  Random random(kSeed);
  SearchScratch scratch;
  WorkCounters work;
  double worst = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double radius = random.uniform(1.0, 5.0), disc = radius * random.uniform(0.01, 0.95);
    const double off = random.below(2) ? 0.0 : 1e-10 * random.uniform(), speed = random.uniform(0.1, 10.0);
    const double at = random.uniform(0.0, 2 * std::numbers::pi), angle = random.uniform(-1.5, 1.5);
    const double way = radius - disc - off, heading = at + std::numbers::pi + angle;
    const auto hollow =
        make_brute_force_index(std::make_shared<const Outline>(make_disc_container(radius).outline));
    const auto body = make_brute_force_index(std::make_shared<const Outline>(make_disc(disc).outline));
    const BodyState start{
        {{way * std::cos(at), way * std::sin(at)}, 0.0},
        {{speed * std::cos(heading), speed * std::sin(heading)}, random.uniform(-1.0, 1.0)}};
    const Motion moves = Motion::ballistic(0.0, start, {}), stands = Motion::still({});
    const double c = way * std::cos(angle), reach = radius - disc;
    const double exact = (c + std::sqrt(c * c + (reach - way) * (reach + way))) / speed;
    const PairAnswer answer =
        first_contact({body.get(), &moves}, {hollow.get(), &stands}, 0.0, 2.0 * exact, {}, scratch, work);
    ASSERT_EQ(answer.status, PairAnswer::Status::contact) << "case " << k;
    worst = std::max(worst, std::abs(answer.until / exact - 1.0));
  }
  std::cout << "worst relative difference of times " << worst << "\n";
  EXPECT_LT(worst, 1e-12);
}

}  // namespace
}  // namespace brink::hollow_test
