// Without friction nothing on a level floor changes how fast a body goes along it, whatever the floor is made of: pieces of
// a polyline, segments or blocks side by side, in any number. BRINK_SEED moves the seeds, BRINK_WORLDS their number.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "brink/core/shapes/shapes.h"
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
  const double least = random.below(2) == 0 ? 0.1 : 0.7, most = random.below(2) == 0 ? 2.0 * least : 5.0;
  const bool even = random.below(2) == 0;
  const double pitch = random.uniform(least, most);
  while (x.back() < 5.0) x.push_back(x.back() + (even ? pitch : random.uniform(least, most)));
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
  Simulator simulator(world, SolverOptions{});
  double worst = 0.0, when = 0.0;
  for (int frame = 1; frame <= 40; ++frame) {
    const RunSummary summary = simulator.run(testing::until(0.05 * frame));
    if (summary.termination != Termination::reached_end) return what + ": " + summary.why;
    const double off = std::abs(simulator.state(0).twist.velocity.x() - along);
    if (off > worst) {
      worst = off;
      if (when == 0.0 && off > 1e-9) when = 0.05 * frame;
    }
  }
  return worst <= 1e-9 ? "" : fmt::format("{}: off by {:.3g} m/s, first seen at {:.2f} s", what, worst, when);
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
