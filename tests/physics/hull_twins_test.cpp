// One body that falls on a convex hull and slides, rolls or tumbles off it, turned and away from the origin or not, once with the hull as a polygon and once as a closed
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

/// Where the whole scene stands: turned, and up to 100 m away.
struct Place {
  double angle;
  Vec2 origin;

  Vec2 turned(const Vec2& v) const { return Eigen::Rotation2Dd(angle) * v; }
  std::string direction(const Vec2& v) const {
    const Vec2 w = turned(v);
    return fmt::format("[{:.17g}, {:.17g}]", w.x(), w.y());
  }
  std::string point(const Vec2& p) const {
    const Vec2 w = origin + turned(p);
    return fmt::format("[{:.17g}, {:.17g}]", w.x(), w.y());
  }
};

std::string hull(Random& random, const Place& place) {
  const int corners = 4 + static_cast<int>(random.below(4));
  std::string list;
  // on an ellipse, so that it is convex
  for (int k = 0; k < corners; ++k) {
    const double angle = (k + random.uniform(0.0, 0.7)) * 2.0 * M_PI / corners;
    list += (list.empty() ? "" : ", ") + place.point({0.9 * std::cos(angle), 0.5 * std::sin(angle)});
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
  Place place{random.uniform(0.0, 2.0 * M_PI),
              {random.uniform(-100.0, 100.0), random.uniform(-100.0, 100.0)}};
  if (random.below(2)) place = {0.0, Vec2::Zero()};
  const std::string outline = hull(random, place), body = shape(random);
  const double friction = std::array{0.0, 0.3, 1.0}[random.below(3)], x = random.uniform(-0.4, 0.4),
               angle = random.uniform(0.0, 2.0 * M_PI), turn = random.uniform(-2.0, 2.0),
               speed = random.uniform(-2.0, 2.0);
  return fmt::format(
      "[world]\nduration = 0.8\ngravity = {}\n[materials.default]\nrestitution = 0\nfriction = {}\n"
      "[[sites]]\nname = 'hull'\n{} = {{ vertices = [{}]{} }}\n[[bodies]]\n{}position = {}\n"
      "angle = {}\nvelocity = {}\nangular_velocity = {}\n",
      place.direction({0.0, -9.81}), friction, as_wire ? "chain" : "polygon", outline,
      as_wire ? ", closed = true" : "", body, place.point({x, 1.1}), angle + place.angle,
      place.direction({speed, 0.0}), turn);
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
    if (seed % 8 == 0) {
      testing::expect_same_bits(solid(seed), seed);
      testing::expect_same_bits(fallen(seed, true), seed);
    }
  });
}

}  // namespace
}  // namespace brink::hull_twins_test
