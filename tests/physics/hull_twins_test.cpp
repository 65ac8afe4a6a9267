// One body that falls on a convex hull and slides, rolls or tumbles off it, once with the hull as a polygon and once as a closed
// wire: from outside the two are the same, so that all must go the same way. At corners it is other code that says who touches whom. BRINK_SEED
// moves the seeds, BRINK_WORLDS their number; BRINK_KEEP names a folder for the scenes that fail.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "brink/core/base/random.h"
#include "tests/support/seeded_worlds.h"

namespace brink::hull_twins_test {
namespace {

std::string hull(Random& random) {
  const int corners = 4 + static_cast<int>(random.below(4));
  std::string list;
  // on an ellipse, so that it is convex
  for (int k = 0; k < corners; ++k) {
    const double angle = (k + random.uniform(0.0, 0.7)) * 2.0 * M_PI / corners;
    list += fmt::format("{}[{:.17g}, {:.17g}]", list.empty() ? "" : ", ", 0.9 * std::cos(angle),
                        0.5 * std::sin(angle));
  }
  return list;
}

std::string shape(Random& random) {
  const double size = random.uniform(0.1, 0.4), thin = random.uniform(0.1, 1.0) * size;
  switch (random.below(6)) {
    case 0:
      return fmt::format("box = {{ width = {}, height = {} }}\n", 2 * size, thin);
    case 1:
      return fmt::format("polygon = {{ vertices = [[0, 0], [{}, 0], [{}, {}]] }}\n", 2 * size, 2 * size,
                         thin);
    case 2:
      return fmt::format("chain = {{ vertices = [[-{}, 0], [{}, 0]] }}\nmass = 1\n", size, size);
    case 3:
      return fmt::format(
          "chain = {{ vertices = [[-{0}, 0], [{0}, 0], [0, {1}]], closed = true }}\nmass = 1\n", size, thin);
    case 4:
      return fmt::format("path = {{ d = 'M -{0} 0 A {1} {1} 0 0 {2} {0} 0' }}\nmass = 1\n", size,
                         size * random.uniform(1.0, 3.0), random.below(2));
    default:
      return fmt::format("capsule = {{ length = {}, radius = {} }}\n", 2 * size, 0.3 * thin);
  }
}

std::string fallen(std::uint64_t seed, bool as_wire) {
  Random random(seed);
  const std::string outline = hull(random), body = shape(random);
  const double friction = std::array{0.0, 0.3, 1.0}[random.below(3)], x = random.uniform(-0.4, 0.4),
               angle = random.uniform(0.0, 2.0 * M_PI), turn = random.uniform(-2.0, 2.0),
               speed = random.uniform(-2.0, 2.0);
  return fmt::format(
      "[world]\nduration = 0.8\ngravity = [0, -9.81]\n[materials.default]\nrestitution = 0\nfriction = {}\n"
      "[[sites]]\nname = 'hull'\n{} = {{ vertices = [{}]{} }}\n[[bodies]]\n{}position = [{}, 1.1]\n"
      "angle = {}\nvelocity = [{}, 0]\nangular_velocity = {}\n",
      friction, as_wire ? "chain" : "polygon", outline, as_wire ? ", closed = true" : "", body, x, angle,
      speed, turn);
}

BodyState end_of(const std::string& text) {
  class Last : public Recorder {
   public:
    void frame(double, std::span<const BodyState> all) override { state = all[0]; }
    BodyState state;
  } last;
  const Scene scene = parse_scene(text, "hull");
  const RunSummary told = Simulator(scene.world, scene.solver).run(testing::until(scene.duration), &last);
  EXPECT_EQ(told.termination, Termination::reached_end) << told.why;
  return last.state;
}

TEST(HullTwins, APolygonAndAClosedWireAreOneFromOutside) {
  const auto solid = [](std::uint64_t seed) { return fallen(seed, false); };
  testing::for_each_world(80, solid, [&](std::uint64_t seed) {
    const BodyState a = end_of(solid(seed)), b = end_of(fallen(seed, true));
    // a wire is met a touching distance before, and every hit makes more of that
    EXPECT_LE((a.pose.position - b.pose.position).norm(), 1e-6);
    EXPECT_NEAR(a.pose.angle, b.pose.angle, 1e-5);
  });
}

}  // namespace
}  // namespace brink::hull_twins_test
