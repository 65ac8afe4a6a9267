// Boxes on a floor of wire that ends right at a wall, of wire or of a block, turned and placed anywhere: seen from outside at
// every frame, and once more under another policy, stopped on the way.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "brink/core/base/random.h"
#include "brink/scheduler/policies/policy.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/worlds.h"

namespace brink::wire_ends_test {
namespace {

World world_of(Random& random) {
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  const double turn = random.below(3) == 0 ? 0.0 : random.uniform(-10.0, 10.0), far = pick({0.0, 1.0, 1e3});
  const Vec2 origin(far * random.uniform(-1.0, 1.0), far * random.uniform(-1.0, 1.0));
  const Frame frame(Pose{origin, turn});
  World w;
  w.gravity = frame.direction_to_world({0.0, -pick({0.0, 8.0, 8.0})});
  w.materials[0].restitution = pick({0.0, 0.5, 1.0});
  w.materials[0].friction = pick({0.0, 0.0, 0.5});
  const auto add_site = [&](const Shape& shape) { testing::add(w, testing::site(shape, origin, turn)); };
  add_site(make_segment({-4, 0}, {4, 0}));
  if (random.below(2) == 0) {
    add_site(make_segment({-4, 0}, {-4, 6}));
    add_site(make_segment({4, 0}, {4, 6}));
  } else {
    add_site(make_polygon({{-5, 0}, {-4, 0}, {-4, 6}, {-5, 6}}));
    add_site(make_polygon({{4, 0}, {5, 0}, {5, 6}, {4, 6}}));
  }
  const auto add_box = [&](double width, double height, const Vec2& at, const Vec2& velocity) {
    const double above = random.below(2) == 0 ? 0.0 : random.uniform(0.0, 0.3);
    testing::add(w, testing::body(make_box(width, height), frame.to_world(at + Vec2(0.0, above)),
                                  frame.direction_to_world(velocity), 1.0, turn));
  };
  add_box(1.0, pick({0.5, 1.0}), {2.5, 0.5}, {pick({0.5, 1.0, 3.0}), 0.0});
  add_box(pick({0.5, 1.0}), 1.0, {-3.0, 0.5}, {-pick({0.5, 1.0}), 0.0});
  if (random.below(2) == 0) add_box(0.5, 0.5, {2.5 + pick({-0.25, 0.0, 0.25}), 2.0}, {0.0, 0.0});
  return w;
}

bool is_sound(std::uint64_t seed) {
  Random random(seed);
  const World w = world_of(random);
  SolverOptions solver;
  solver.persistent = random.below(3) != 0;
  solver.max_collisions = 20000;
  Simulator simulator(w, solver);
  if (!simulator.start_fault().empty()) return true;
  const double end = 4.0;
  outside::FrameWatch watch(w, end, 1e-9);
  RunOptions options = testing::until(end);
  options.frame_interval = 0.02;
  const RunSummary s = simulator.run(options, &watch);
  const bool ends =
      s.termination != Termination::failed || (!solver.persistent && s.why.find("Zeno") != std::string::npos);
  EXPECT_TRUE(ends && watch.sound()) << "seed " << seed << ": " << s.why << watch.report();
  solver.policy = exact_policies()[seed % exact_policies().size()];
  Simulator again(w, solver);
  RunSummary t;
  for (int part = 1; part <= 16 && (part == 1 || t.termination == Termination::reached_end); ++part) {
    options.until = end * part / 16.0;
    t = again.run(options);
  }
  const bool same = t.state_hash == s.state_hash && t.termination == s.termination;
  EXPECT_TRUE(same) << "seed " << seed << ": other bits under " << solver.policy;
  return ends && watch.sound() && same;
}

// BRINK_SEED moves the seeds, BRINK_WORLDS their number.
TEST(WireEnds, NobodyGoesThroughTheEndOfAFloorAtAWall) {
  const auto asked = [](const char* name, std::uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text ? std::strtoull(text, nullptr, 10) : otherwise;
  };
  const std::uint64_t first = asked("BRINK_SEED", 1), count = asked("BRINK_WORLDS", 200);
  int wrong = 0;
  for (std::uint64_t k = 0; k < count; ++k) wrong += !is_sound(first + k);
  EXPECT_EQ(wrong, 0) << "of " << count;
}

}  // namespace
}  // namespace brink::wire_ends_test
