// Cones and tents, the long way: a million pixels of every primitive at every resolution.
#include "tests/unit/fields/mesh_errors.h"

namespace brink::site_mesh_stress {
namespace {

// From the smallest resolution that an option allows to nearly the largest.
TEST(SiteMesh, EveryDepthIsWithinTheStatedBoundOnAMillionPixelsOfEveryPrimitiveAndResolution) {
  mesh_test::expect_bounds(1'000'000, {16, 64, 250, 1000}, 77);
}

}  // namespace
}  // namespace brink::site_mesh_stress
