// Heaps of convex polygons with rolling resistance: they go by steps however few they are. Told from outside, by separating
// axes from the bodies' poses alone: nobody is in another at any of many frames, and every run comes to its end.
// BRINK_SEED moves the seeds, BRINK_WORLDS their number.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "tests/support/seeded_worlds.h"

namespace brink::rolling_heaps_test {
namespace {

using Polygon = std::vector<Vec2>;

/// How deep two convex polygons are in each other [m]: the least overlap along any side's normal; below 0: apart.
double depth_along_sides(const Polygon& p, const Polygon& q) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec2 side = p[(k + 1) % p.size()] - p[k];
    const Vec2 out = Vec2(side.y(), -side.x()).normalized();  // corners go round anticlockwise
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec2& corner : q) nearest = std::min(nearest, out.dot(corner - p[k]));
    least = std::min(least, -nearest);
  }
  return least;
}

/// The deepest overlap of any two bodies at any frame.
class Overlaps : public Recorder {
 public:
  /// `corners`: about the centre of mass, at angle 0.
  explicit Overlaps(const Polygon& corners) : corners_(corners) {}
  void frame(double t, std::span<const BodyState> states) override {
    ++frames;
    std::vector<Polygon> placed;
    for (const BodyState& s : states) {
      placed.emplace_back();
      const double c = std::cos(s.pose.angle), d = std::sin(s.pose.angle);
      for (const Vec2& p : corners_)
        placed.back().emplace_back(s.pose.position.x() + c * p.x() - d * p.y(),
                                   s.pose.position.y() + d * p.x() + c * p.y());
    }
    for (std::size_t i = 0; i < placed.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const double deep =
            std::min(depth_along_sides(placed[i], placed[j]), depth_along_sides(placed[j], placed[i]));
        if (deep > deepest) deepest = deep, when = t;
      }
  }

  double deepest = 0.0, when = 0.0;
  int frames = 0;

 private:
  Polygon corners_;
};

Vec2 centre_of(const Polygon& p) {
  double twice_area = 0.0;
  Vec2 sum = Vec2::Zero();
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec2 &a = p[k], &b = p[(k + 1) % p.size()];
    const double part = a.x() * b.y() - a.y() * b.x();
    twice_area += part;
    sum += part * (a + b);
  }
  return sum / (3.0 * twice_area);
}

void pile_up(std::uint64_t seed) {
  Random random(seed);
  const int sides = 3 + static_cast<int>(random.below(4)), count = 4 + static_cast<int>(random.below(21));
  const double size = random.uniform(0.08, 0.2), half = random.uniform(0.6, 1.2);
  Polygon corners;
  std::string vertices;
  for (int k = 0; k < sides; ++k) {
    const double angle = 2.0 * M_PI * k / sides + random.uniform(-0.2, 0.2);
    corners.emplace_back(size * std::cos(angle), size * std::sin(angle));
  }
  const Vec2 centre = centre_of(corners);
  for (Vec2& p : corners) {
    p -= centre;
    vertices += fmt::format("{}[{:.17g}, {:.17g}]", vertices.empty() ? "" : ", ", p.x(), p.y());
  }
  const double restitution = 0.25 * static_cast<double>(random.below(3)),
               friction = random.below(2) ? random.uniform(0.1, 1.0) : 0.0;
  const std::string text = fmt::format(
      "[world]\nduration = 1.5\ngravity = [0, -9.81]\nseed = {}\n"
      "[materials.default]\nrestitution = {}\nfriction = {}\nrolling_resistance = {}\n"
      "[[sites]]\npolyline = [[{}, 9], [{}, 0], [{}, 0], [{}, 9]]\nradius = {}\n"
      "[[bodies]]\npolygon = {{ vertices = [{}] }}\ndensity = 1\nposition = [0, {}]\n"
      "pile = {{ count = {}, width = {}, random_angle = {} }}\n",
      seed + 1, restitution, friction, std::pow(10.0, random.uniform(-3.0, -1.5)), -half, -half, half, half,
      random.below(3) ? 0.0 : 0.02, vertices, 1.5 * size, count, 2.0 * half - 2.5 * size,
      random.below(2) ? "true" : "false");
  const Scene scene = parse_scene(text, "polygons");
  Overlaps overlaps(corners);
  RunOptions options;
  options.until = 1.5;
  options.frame_interval = 5e-3;
  const RunSummary summary = Simulator(scene.world, scene.solver).run(options, &overlaps);
  SCOPED_TRACE(fmt::format("BRINK_SEED={} BRINK_WORLDS=1", seed));
  EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
  EXPECT_GT(overlaps.frames, 100);
  EXPECT_LE(overlaps.deepest, 1e-9 * size) << "at t = " << overlaps.when;
  EXPECT_LE(summary.energy_final, summary.energy_initial);
}

TEST(RollingHeaps, NobodyIsInAnotherAndEveryRunComesToItsEnd) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      worlds = testing::from_environment("BRINK_WORLDS", 40);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed) pile_up(seed);
}

}  // namespace
}  // namespace brink::rolling_heaps_test
