// Gases of discs against kinetic theory, small; gas_stress.cpp has the long runs.
#include <gtest/gtest.h>

#include "tests/support/gas_statistics.h"

namespace brink::gas_test {
namespace {

using testing::measure_compressibility;

// Z of hard discs (known values: simulations of this system, and the virial series). 1e5 collisions of 1024
// discs give it to 1 %, and its two measures agree better than that.
TEST(Gas, EquationOfStateOfHardDiscs) {
  const auto dilute = measure_compressibility(1024, 0.2, 100000);
  EXPECT_NEAR(dilute.by_momentum, 1.5705, 0.01 * 1.5705);
  EXPECT_NEAR(dilute.by_rate, dilute.by_momentum, 0.005 * dilute.by_momentum);
  const auto dense = measure_compressibility(1024, 0.5, 100000);
  EXPECT_NEAR(dense.by_momentum, 4.106, 0.01 * 4.106);
  EXPECT_NEAR(dense.by_rate, dense.by_momentum, 0.005 * dense.by_momentum);
}

// Haff's law: each collision takes (1 - e^2) kT on average, a little less as the gas departs from Maxwell's
// distribution. T / T0 after 5 and 10 collisions a disc.
TEST(Gas, InelasticDiscsCoolAsHaffSays) {
  const int count = 10000;
  World world = testing::lattice_gas(count, make_disc(0.5), 0.2);
  SolverOptions options;
  options.max_collisions = 10 * count;
  Simulator warm(world, options);
  warm.run(testing::until(1e9));
  for (int k = 0; k < count; ++k) world.bodies[k].initial = warm.state(k);
  world.materials[0].restitution = 0.9;
  for (const auto& [each, expected] : {std::pair(5, 0.624), std::pair(10, 0.393)}) {
    options.max_collisions = static_cast<std::uint64_t>(each * count / 2);  // two discs a collision
    const RunSummary s = Simulator(world, options).run(testing::until(1e9));
    const double cooled = s.energy_final / s.energy_initial;
    std::printf("%d collisions a disc: T / T0 = %.4f, expected %.3f\n", each, cooled, expected);
    EXPECT_NEAR(std::log(cooled), std::log(expected), 0.02 * std::abs(std::log(expected)));
  }
}

}  // namespace
}  // namespace brink::gas_test
