// Without friction nothing on a level floor changes how fast a body goes along it, whatever the floor is made of: pieces of
// a polyline, segments or blocks side by side, in any number, turned and placed anywhere, or across the edge of a plane that
// repeats. Seen from outside, and once more under another policy, stopped on the way. BRINK_SEED moves the seeds, BRINK_WORLDS
// their number.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "brink/core/shapes/shapes.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/worlds.h"

namespace brink::level_floors_test {
namespace {

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

struct Named {
  const char* name;
  Shape shape;
};

std::vector<Named> bodies() {
  return {
      {"box", make_box(1.0, 0.5)},
      {"low bar", make_box(1.0, 0.02)},
      {"tall box", make_box(0.2, 0.6)},
      {"triangle", make_polygon({{0.0, 0.0}, {1.0, 0.0}, {0.5, 0.5}})},
      {"leaning triangle", make_polygon({{0.0, 0.0}, {0.6, 0.0}, {0.9, 0.5}})},
      {"hexagon", make_polygon({{0.0, 0.0}, {0.5, 0.0}, {0.75, 0.4}, {0.5, 0.8}, {0.0, 0.8}, {-0.25, 0.4}})},
      {"L", make_polygon({{0.0, 0.0}, {0.8, 0.0}, {0.8, 0.2}, {0.2, 0.2}, {0.2, 0.8}, {0.0, 0.8}})},
      {"table",
       make_polygon(
           {{0.0, 0.0}, {0.1, 0.0}, {0.1, 0.3}, {0.7, 0.3}, {0.7, 0.0}, {0.8, 0.0}, {0.8, 0.4}, {0.0, 0.4}})},
      {"rounded box", make_box(0.6, 0.3, 0.05)},
      {"U of wire", make_chain({{0.0, 0.5}, {0.0, 0.0}, {1.0, 0.0}, {1.0, 0.5}}, false)},
      {"ring of wire", make_chain({{0.0, 0.0}, {0.7, 0.0}, {0.7, 0.4}, {0.0, 0.4}}, true)},
      {"rod", make_chain({{-0.4, 0.0}, {0.4, 0.0}}, false)},
      {"thick rod", make_chain({{-0.4, 0.0}, {0.4, 0.0}}, false, 0.05)},
      {"disc", make_disc(0.25)}};
}

/// Along the line y = 0 from -5 to 5, with joints at places drawn.
std::vector<double> joints(Random& random) {
  std::vector<double> x{-5.0};
  const double least = random.below(2) == 0 ? 0.1 : 0.7, most = random.below(2) == 0 ? 2.0 * least : 4.0;
  const bool even = random.below(2) == 0;
  const double pitch = random.uniform(least, most);
  while (x.back() < 5.0 - least) x.push_back(x.back() + (even ? pitch : random.uniform(least, most)));
  x.back() = 5.0;
  return x;
}

constexpr int kFloors = 6;

/// Adds one of the floors; returns its name.
std::string add_floor(World& world, Random& random) {
  const std::vector<double> x = joints(random);
  const auto put = [&](FixedSite s) { testing::add(world, std::move(s)); };
  std::vector<Vec2> line;
  for (const double at : x) line.emplace_back(at, 0.0);
  switch (random.below(kFloors)) {
    case 0:
      put(testing::site(make_chain(line, false)));
      return "polyline";
    case 1:
      for (std::size_t k = 1; k < line.size(); ++k) put(testing::site(make_segment(line[k - 1], line[k])));
      return "segments";
    case 2:
      for (std::size_t k = 1; k < line.size(); ++k)
        put(testing::site(make_polygon({{x[k - 1], -0.5}, {x[k], -0.5}, {x[k], 0.0}, {x[k - 1], 0.0}})));
      return "blocks";
    case 3: {
      std::vector<Vec2> corners(line.rbegin(), line.rend());
      corners.emplace_back(x.front(), -0.5);
      corners.emplace_back(x.back(), -0.5);
      put(testing::site(make_polygon(corners)));
      return "polygon with flat corners";
    }
    case 4:
      put(testing::site(make_chain(line, false, 0.05), {0.0, -0.05}));
      return "thick polyline";
    default:
      for (std::size_t k = 1; k < line.size(); ++k)
        put(testing::site(make_box(x[k] - x[k - 1], 0.5), {0.5 * (x[k] + x[k - 1]), -0.25}));
      return "boxes";
  }
}

constexpr double kEnd = 2.0;

/// Everything, gravity too, turned about the origin and then moved.
void turn_and_move(World& world, double angle, const Vec2& by) {
  const Frame frame(Pose{by, angle});
  world.gravity = frame.direction_to_world(world.gravity);
  for (FixedSite& s : world.sites) s.pose = {frame.to_world(s.pose.position), s.pose.angle + angle};
  for (Body& b : world.bodies) {
    b.initial.pose = {frame.to_world(b.initial.pose.position), b.initial.pose.angle + angle};
    b.initial.twist.velocity = frame.direction_to_world(b.initial.twist.velocity);
  }
}

/// Sees, too, how fast the body goes along the floor at every frame.
class FloorWatch final : public outside::FrameWatch {
 public:
  FloorWatch(const World& world, const Vec2& along) : FrameWatch(world, kEnd, 1e-9), along_(along) {}
  void frame(double t, std::span<const BodyState> states) override {
    speeds.push_back(along_.dot(states[0].twist.velocity));
    FrameWatch::frame(t, states);
  }
  std::vector<double> speeds;

 private:
  Vec2 along_;
};

/// "" where it is sound, else what is wrong.
std::string fault_of(std::uint64_t seed) {
  Random random(seed);
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  World world;
  world.gravity = {0.0, -9.81};
  Material& material = world.materials[0];
  material.restitution = pick({0.0, 0.0, 0.25, 0.5, 0.8});
  material.friction = 0.0;
  const std::string floor = add_floor(world, random);
  const std::vector<Named> all = bodies();
  const Named& named = all[random.below(all.size())];
  Body body = testing::body(named.shape, {0.0, 0.0}, {0.0, 0.0});
  double low = 0.0;  // of its outline, as it is built
  for (const Site& s : body.outline->sites) low = std::min({low, s.a.y() - s.radius, s.b.y() - s.radius});
  const bool falls = random.below(2) == 0, turned = falls && random.below(3) == 0;
  const double along = pick({0.3, 0.7, 1.0, 2.0}) * (random.below(2) == 0 ? 1.0 : -1.0);
  const double height = falls ? random.uniform(0.01, 0.5) : 0.0;
  // as long as the floor: its ends meet across the edge
  const bool repeats = random.below(4) == 0;
  body.initial.pose.position = {along > 0.0 ? -2.0 : 2.0, -low + height + (turned ? 0.6 : 0.0)};
  body.initial.twist.velocity = {along, 0.0};
  if (turned) body.initial.pose.angle = random.uniform(-3.0, 3.0);
  if (turned) body.initial.twist.omega = random.uniform(-2.0, 2.0);
  testing::add(world, std::move(body));
  const std::string what = fmt::format("{} {} on {}, e = {}, {} m/s",
                                       turned  ? "turned"
                                       : falls ? "falling"
                                               : "standing",
                                       named.name, floor, material.restitution, along);
  if (repeats)
    world.periods.size = {10.0, 0.0};
  else
    turn_and_move(world, random.uniform(-4.0, 4.0),
                  pick({0.0, 10.0, 1e3}) * Vec2(random.uniform(-1.0, 1.0), 1.0));
  const Vec2 way = world.bodies[0].initial.twist.velocity / along;
  FloorWatch watch(world, way);
  SolverOptions solver;
  RunOptions options = testing::until(kEnd);
  options.frame_interval = 0.05;
  Simulator simulator(world, solver);
  const RunSummary summary = simulator.run(options, &watch);
  if (summary.termination != Termination::reached_end) return what + ": " + summary.why;
  if (!repeats && !watch.sound()) return what + ": " + watch.report();
  for (const double speed : watch.speeds)
    if (!(std::abs(speed - along) <= 1e-9)) return fmt::format("{}: {} m/s", what, speed);
  solver.policy = random.below(2) == 0 ? "timewarp" : "global_backup";
  Simulator other(world, solver);
  RunSummary last;
  for (int k = 1; k <= 4; ++k) last = other.run(testing::until(0.25 * k * kEnd));
  return last.state_hash == summary.state_hash ? "" : what + ": differs under " + solver.policy;
}

// Rods that lie on a wire, on which side nothing but their weight tells; and corners that come down beyond a joint of a thick
// polyline, into its next piece, within a step.
TEST(LevelFloors, ThatOnceFailedAreSound) {
  for (const std::uint64_t seed : {799, 3868, 4141, 4347, 5547, 5705, 7361, 14072})
    EXPECT_EQ(fault_of(seed), "") << "seed " << seed;
}

TEST(LevelFloors, KeepWhoSlidesOverTheirJointsAsFastAsItWas) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1),
                      worlds = from_environment("BRINK_WORLDS", 150);
  int faults = 0;
  for (std::uint64_t seed = first; seed < first + worlds; ++seed) {
    const std::string fault = fault_of(seed);
    if (fault.empty()) continue;
    ++faults;
    ADD_FAILURE() << "seed " << seed << ": " << fault;
  }
  if (worlds > 150) fmt::print("{} worlds, {} faults\n", worlds, faults);
}

}  // namespace
}  // namespace brink::level_floors_test
