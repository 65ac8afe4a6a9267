// One body without friction that slides over a floor made of bodies: boxes of one height in a row, at rest, side by side or with
// gaps, on a floor of any kind, turned and placed anywhere. As long as all of it is above the row it goes along as fast as it
// began: an edge that roundings have put above the next top, or beside it, stops nobody. Seen from outside at every frame, and
// once more under another policy, stopped on the way. BRINK_SEED moves the seeds, BRINK_WORLDS their number.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <cmath>
#include <string>

#include "brink/core/base/random.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/seeded_worlds.h"

namespace brink::body_floors_test {
namespace {

constexpr double kEnd = 1.2, kFloorEnd = 30.0;
/// A row whose boxes stand a contact tolerance apart in height turns the way by so much [m/s].
constexpr double kSpeedLost = 1e-7;

struct Made {
  World world;
  Frame frame;                                       ///< of the floor: y = 0
  double from = 0, to = 0, top = 0, half_width = 0;  ///< of the row, and of what slides [m]
  double speed = 0;                                  ///< along x [m/s]
};

void add_floor(World& world, Random& random, const Frame& frame, double turn) {
  const auto at = [&](double y) { return frame.to_world({0.0, y}); };
  switch (random.below(3)) {
    case 0:
      testing::add(world, testing::site(make_segment({-kFloorEnd, 0}, {kFloorEnd, 0}), at(0.0), turn));
      return;
    case 1:
      testing::add(world, testing::site(make_box(2.0 * kFloorEnd, 1.0), at(-0.5), turn));
      return;
    default:
      testing::add(world,
                   testing::site(make_segment({-kFloorEnd, 0}, {kFloorEnd, 0}, 0.125), at(-0.125), turn));
      return;
  }
}

Made make(Random& random) {
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  const double turn = random.below(3) != 0 ? 0.0 : random.uniform(-10.0, 10.0),
               far = pick({0.0, 0.0, 1.0, 1e3});
  Made made{World(), Frame(Pose{far * Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)), turn})};
  World& w = made.world;
  w.gravity = made.frame.direction_to_world({0.0, -9.81});
  w.materials[0].restitution = pick({0.0, 0.0, 0.5});
  w.materials[0].friction = 0.0;
  add_floor(w, random, made.frame, turn);
  // what falls on bodies that rebound makes them hop, and there are edges then; so are there while they fall, as steps do not
  // fall as what is free
  const bool falls = w.materials[0].restitution == 0.0;
  const double width = pick({0.5, 1.0, 0.4, 0.37}), height = pick({0.5, 0.3, 0.25}),
               gap = pick({0.0, 0.0, 0.001, 0.01}), mass = pick({1.0, 5.0, 100.0});
  const int boxes = 3 + static_cast<int>(random.below(6));
  made.from = -0.5 * boxes * width;
  double x = made.from;
  for (int k = 0; k < boxes; ++k, x += width + gap)
    testing::add(w,
                 testing::body(make_box(width, height), made.frame.to_world({x + 0.5 * width, 0.5 * height}),
                               Vec2::Zero(), mass, turn));
  made.to = x - gap;
  made.top = height;
  made.speed = pick({-1.0, 1.0}) * random.uniform(0.3, 1.2);
  const double length = pick({0.3, 0.6, 1.2});
  // over a gap, or an edge that is higher by next to nothing, what is round dips
  const Shape shapes[] = {make_box(length, 0.25),
                          make_polygon({{-0.5 * length, -0.1}, {0.5 * length, -0.1}, {0.0, 0.2}}),
                          make_box(length, 0.15, 0.05)};
  const Shape& shape = shapes[random.below(gap > 0.0 ? 2 : 3)];
  made.half_width = 0.5 * (shape.outline.bounds.high.x() - shape.outline.bounds.low.x());
  const Vec2 at(made.speed > 0.0 ? -0.2 : 0.2, height + (falls ? pick({0.0, 0.0, 0.02}) : 0.0) +
                                                   shape.measure.centroid.y() - shape.outline.bounds.low.y());
  testing::add(w, testing::body(shape, made.frame.to_world(at),
                                made.frame.direction_to_world({made.speed, 0.0}), 1.0, turn));
  return made;
}

/// Sees by how much the speed of what slides, which comes last, is not what it was while all of it is above the row.
class SlideWatch final : public outside::FrameWatch {
 public:
  explicit SlideWatch(const Made& made) : FrameWatch(made.world, kEnd, 1e-9), made_(made) {}
  void frame(double t, std::span<const BodyState> states) override {
    FrameWatch::frame(t, states);
    const BodyState& s = states.back();
    const Vec2 at = made_.frame.to_local(s.pose.position);
    on_row_ = on_row_ && at.x() - made_.half_width > made_.from && at.x() + made_.half_width < made_.to;
    if (on_row_)
      lost = std::max(lost, std::abs(made_.frame.direction_to_local(s.twist.velocity).x() - made_.speed));
  }
  double lost = 0.0;

 private:
  const Made& made_;
  bool on_row_ = true;
};

/// "" where it is sound, else what is wrong.
std::string fault_of(std::uint64_t seed) {
  Random random(seed);
  const Made made = make(random);
  SolverOptions solver;
  solver.max_collisions = 20000;
  Simulator simulator(made.world, solver);
  if (!simulator.start_fault().empty()) return simulator.start_fault();
  SlideWatch watch(made);
  RunOptions options = testing::until(kEnd);
  options.frame_interval = 1.0 / 64.0;
  const RunSummary summary = simulator.run(options, &watch);
  if (summary.termination == Termination::failed) return summary.why;
  if (!watch.sound()) return watch.report();
  if (watch.lost > kSpeedLost) return fmt::format("lost {:.3g} m/s of {:.3g}", watch.lost, made.speed);
  return testing::stopped_under_another_policy(made.world, solver, options, 4, seed, summary);
}

TEST(BodyFloors, AreGoneOverAsFastAsTheyWereComeUpon) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      worlds = testing::from_environment("BRINK_WORLDS", 100);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed)
    EXPECT_EQ(fault_of(seed), "") << "seed " << seed;
}

}  // namespace
}  // namespace brink::body_floors_test
