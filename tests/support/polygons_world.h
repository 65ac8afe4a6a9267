#pragma once
/// One body and fixed sites of convex pieces, in random scenes: overlaps by axes that part convex outlines, and the same bits.

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/seeded_worlds.h"

namespace brink::testing {

using Polygon = std::vector<Vec2>;

/// The body's outline about its centre of mass, convex pieces of the sites about `place`, and the scene.
struct PolygonsWorld {
  Polygon body;
  std::vector<Polygon> sites;
  Vec2 place;
  std::string text;
};

inline std::string vertices(const Polygon& polygon) {
  std::string text;
  for (const Vec2& p : polygon)
    text += fmt::format("{}[{:.17g}, {:.17g}]", text.empty() ? "" : ", ", p.x(), p.y());
  return "polygon = { vertices = [" + text + "] }\n";
}

/// By how much two convex polygons overlap along the axis along which that is least [m]; below 0: apart.
inline double overlap(const Polygon& a, const Polygon& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const Polygon* of : {&a, &b})
    for (std::size_t k = 0; k < of->size(); ++k) {
      const Vec2 side = (*of)[(k + 1) % of->size()] - (*of)[k], axis = Vec2(side.y(), -side.x()).normalized();
      const auto reach = [&](const Polygon& p, double sign) {
        double most = -std::numeric_limits<double>::infinity();
        for (const Vec2& v : p) most = std::max(most, sign * axis.dot(v));
        return most;
      };
      least = std::min({least, reach(a, 1.0) + reach(b, -1.0), reach(b, 1.0) + reach(a, -1.0)});
    }
  return least;
}

/// The deepest overlap at frames.
class Depth : public Recorder {
 public:
  explicit Depth(const PolygonsWorld& world) : world_(&world) {}
  void frame(double, std::span<const BodyState> states) override {
    const Pose& pose = states[0].pose;
    Polygon body;
    for (const Vec2& v : world_->body)
      body.push_back(pose.position - world_->place + Eigen::Rotation2Dd(pose.angle) * v);
    for (const Polygon& site : world_->sites) deepest = std::max(deepest, overlap(body, site));
    ++frames;
  }

  double deepest = 0.0;
  int frames = 0;

 private:
  const PolygonsWorld* world_;
};

/// Runs so many worlds, or BRINK_WORLDS, to their ends: no overlap at frames, and the same bits under every policy and from
/// any snapshot.
inline void expect_no_overlaps(std::uint64_t count,
                               const std::function<PolygonsWorld(std::uint64_t)>& world_of) {
  for_each_world(
      count, [&](std::uint64_t seed) { return world_of(seed).text; },
      [&](std::uint64_t seed) {
        const PolygonsWorld world = world_of(seed);
        const Scene scene = parse_scene(world.text, "polygons");
        Depth depth(world);
        RunOptions options = until(scene.duration);
        options.frame_interval = scene.duration / 64.0;
        const RunSummary told = Simulator(scene.world, scene.solver).run(options, &depth);
        EXPECT_EQ(told.termination, Termination::reached_end) << told.why;
        EXPECT_GT(depth.frames, 60);
        EXPECT_LE(depth.deepest, 1e-9);
        expect_same_bits(world.text, seed);
      });
}

}  // namespace brink::testing
