// Rods of wire that lie, fly and are thrown flat between a floor and a ceiling of wire, in one piece or many, turned and placed
// anywhere, whichever way they are pulled: a rod has no inside, so nothing but where it came from tells on which side of a wire
// it is. Seen from outside at every frame, and once more under another policy, stopped on the way. BRINK_SEED moves the seeds,
// BRINK_WORLDS their number.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <cmath>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/seeded_worlds.h"

namespace brink::flat_rods_test {
namespace {

constexpr double kEnd = 1.5, kHalfRod = 0.4, kHigh = 1.0, kWallEnd = 20.0;

/// A wire along y = height, in one outline or several.
void add_wall(World& world, Random& random, const Frame& frame, double turn, double height) {
  const int pieces = *(std::initializer_list<int>{1, 2, 7, 90}.begin() + random.below(4));
  std::vector<Vec2> places;
  for (int k = 0; k <= pieces; ++k) places.push_back({kWallEnd * (2.0 * k / pieces - 1.0), 0.0});
  const Vec2 origin = frame.to_world({0.0, height});
  if (random.below(2) == 0) {
    testing::add(world, testing::site(make_chain(places, false), origin, turn));
  } else {
    for (int k = 0; k < pieces; ++k)
      testing::add(world, testing::site(make_segment(places[k], places[k + 1]), origin, turn));
  }
}

struct Made {
  World world;
  Frame frame;      ///< of the walls: the floor is y = 0
  double pull = 0;  ///< along y [m/s^2]
};

Made make(Random& random) {
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  const double turn = random.below(3) == 0 ? 0.0 : random.uniform(-10.0, 10.0), far = pick({0.0, 1.0, 1e3});
  Made made{World(), Frame(Pose{far * Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)), turn}),
            pick({-9.81, -9.81, 0.0, 9.81})};
  World& w = made.world;
  w.gravity = made.frame.direction_to_world({pick({0.0, 0.0, 1.0}), made.pull});
  w.materials[0].restitution = pick({0.0, 0.0, 0.3, 0.8, 1.0});
  w.materials[0].friction = pick({0.0, 0.3});
  add_wall(w, random, made.frame, turn, 0.0);
  add_wall(w, random, made.frame, turn, kHigh);
  const int rods = 1 + static_cast<int>(random.below(3));
  for (int k = 0; k < rods; ++k) {
    // one may lie where its weight holds it
    const bool lies = k == 0 && made.pull != 0.0 && random.below(3) == 0;
    const double y = lies ? (made.pull < 0.0 ? 0.0 : kHigh) : kHigh * (k + 1.0) / (rods + 1.0);
    const Vec2 at(random.uniform(-0.3, 0.3), y),
        v(random.uniform(-1.0, 1.0), lies ? 0.0 : pick({-5, -1, 0, 2, 5}));
    const Shape shape = random.below(2) == 0 ? make_segment({-kHalfRod, 0}, {kHalfRod, 0})
                                             : make_chain({{-kHalfRod, 0}, {0.1, 0}, {kHalfRod, 0}}, false);
    testing::add(w,
                 testing::body(shape, made.frame.to_world(at), made.frame.direction_to_world(v), 1.0, turn));
  }
  return made;
}

/// Sees how far any end of a rod comes out of the room, and whether one hangs where its weight draws it away.
class RoomWatch final : public outside::FrameWatch {
 public:
  explicit RoomWatch(const Made& made) : FrameWatch(made.world, kEnd, 1e-9), made_(made) {}
  void frame(double t, std::span<const BodyState> states) override {
    FrameWatch::frame(t, states);
    std::size_t hanging = 0;
    for (const BodyState& s : states) {
      const Vec2 middle = made_.frame.to_local(s.pose.position);
      const Vec2 along = made_.frame.direction_to_local({std::cos(s.pose.angle), std::sin(s.pose.angle)});
      for (const double end : {-kHalfRod, kHalfRod}) {
        const double y = (middle + end * along).y();
        out = std::max({out, -y, y - kHigh});
      }
      const double off = made_.pull < 0.0 ? kHigh - middle.y() : middle.y();
      hanging += made_.pull != 0.0 && off < 1e-6 && s.twist.velocity.norm() < 10.0;
    }
    // a throw lets it touch in one frame, not in so many
    hung = hanging > 0 ? hung + 1 : 0;
    longest_hung = std::max(longest_hung, hung);
  }
  double out = 0.0;
  int hung = 0, longest_hung = 0;

 private:
  const Made& made_;
};

/// "" where it is sound, else what is wrong.
std::string fault_of(std::uint64_t seed) {
  Random random(seed);
  const Made made = make(random);
  SolverOptions solver;
  solver.max_collisions = 20000;
  Simulator simulator(made.world, solver);
  if (!simulator.start_fault().empty()) return simulator.start_fault();
  RoomWatch watch(made);
  RunOptions options = testing::until(kEnd);
  options.frame_interval = 0.02;
  const RunSummary summary = simulator.run(options, &watch);
  if (summary.termination == Termination::failed) return summary.why;
  if (!watch.sound()) return watch.report();
  if (watch.out > 1e-9) return fmt::format("an end is {} m out of the room", watch.out);
  if (watch.longest_hung > 3) return fmt::format("one hangs for {} frames", watch.longest_hung);
  return testing::stopped_under_another_policy(made.world, solver, options, 8, seed, summary);
}

TEST(FlatRods, StayOnTheirSideOfAWire) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      worlds = testing::from_environment("BRINK_WORLDS", 200);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed)
    EXPECT_EQ(fault_of(seed), "") << "seed " << seed;
}

// Contacts of a rod with several pieces of a wall were on different sides of it, and those of two rods told by the middle of one.
TEST(FlatRods, ThatOnceFailedAreSound) {
  for (const std::uint64_t seed : {2228, 2721, 6024, 7418, 9292, 10143})
    EXPECT_EQ(fault_of(seed), "") << "seed " << seed;
}

}  // namespace
}  // namespace brink::flat_rods_test
