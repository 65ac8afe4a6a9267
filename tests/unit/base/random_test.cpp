#include "brink/core/base/random.h"

#include <gtest/gtest.h>

#include "tests/support/seeded_random.h"

namespace brink::random_test {
namespace {

TEST(Random, SameSeedGivesTheSameStreamAndAnotherSeedDoesNot) {
  Random a(7), b(7), c(8);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const auto x = a.next();
    EXPECT_EQ(x, b.next());
    differs |= x != c.next();
  }
  EXPECT_TRUE(differs);
}

TEST(Random, RestoredStateContinuesTheStream) {
  Random a(3);
  for (int i = 0; i < 10; ++i) a.next();
  Random b(99);
  b.set_state(a.state());
  for (int i = 0; i < 10; ++i) EXPECT_EQ(a.next(), b.next());
}

TEST(Random, UniformHasTheMeanAndVarianceOfTheUnitInterval) {
  SeededRandom r(5);
  const int n = 200000;
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < n; ++i) {
    const double u = r.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    squares += u * u;
  }
  // standard errors: 6.5e-4 and 6.7e-4; five of them
  EXPECT_NEAR(sum / n, 0.5, 3.3e-3);
  EXPECT_NEAR(squares / n, 1.0 / 3.0, 3.4e-3);
}

}  // namespace
}  // namespace brink::random_test
