/// Walls without thickness, far away from the origin and from whoever comes upon them: met by all who must meet them,
/// and no longer looked at by who leaves them behind.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/same_events.h"
#include "tests/support/seeded_random.h"

namespace brink::far_walls_test {
namespace {

/// A disc that is to come, on a parabola or straight on, with its centre upon a wire in so long, if nothing were there:
/// it touches before, be it near an end of the wire.
struct Shot {
  World world;
  double time;  ///< [s]
  bool apart;   ///< of the disc and the wire at the start, by half a radius or more

  explicit Shot(Random& random) {
    const auto any_size = [&](double low, double high) { return std::pow(10.0, random.uniform(low, high)); };
    const auto direction = [&] {
      const double angle = random.uniform(0.0, 2.0 * M_PI);
      return Vec2(std::cos(angle), std::sin(angle));
    };
    const double away = any_size(0.0, 5.0), length = any_size(-1.0, 3.0), radius = any_size(-2.0, 1.0),
                 speed = any_size(-2.0, 4.0);
    time = away / speed;
    const Vec2 from = any_size(-1.0, 6.0) * direction(), to = from + away * direction();
    const Vec2 along =
        random.below(3) == 0 ? Vec2(random.below(2) == 0 ? Vec2::UnitX() : Vec2::UnitY()) : direction();
    const double part = random.below(3) == 0 ? any_size(-9.0, -2.0) : random.uniform(0.0, 1.0);
    const Vec2 begin = to - part * length * along, end = begin + length * along;
    if (random.below(3) == 0) world.gravity = 0.1 * away / (time * time) * direction();
    testing::add(world,
                 testing::body(make_disc(radius), from, (to - from) / time - 0.5 * time * world.gravity));
    testing::add(world, testing::site(make_segment(begin, end)));
    const double foot = std::clamp((from - begin).dot(along), 0.0, length);
    apart = (from - begin - foot * along).norm() > 1.5 * radius;
  }
};

TEST(FarWalls, AreMetByAllWhoComeUponThem) {
  SeededRandom random(20261125);
  int shots = 0, undecided = 0;
  for (int k = 0; k < 3000; ++k) {
    const Shot shot(random);
    if (!shot.apart) continue;
    std::vector<double> times;
    for (const std::string& policy : exact_policies()) {
      SolverOptions options;
      options.policy = policy;
      options.max_collisions = 1;
      Simulator simulator(shot.world, options);
      testing::Events events;
      const RunSummary summary = simulator.run(testing::until(1.01 * shot.time), &events);
      if (summary.termination == Termination::failed) {
        EXPECT_NE(summary.why.find("too far from the origin"), std::string::npos) << summary.why;
        break;
      }
      ASSERT_FALSE(events.collisions().empty()) << "shot " << k << ", " << policy;
      times.push_back(events.collisions().front().contact.time);
      EXPECT_LE(times.back(), shot.time) << "shot " << k << ", " << policy;
      EXPECT_EQ(times.back(), times.front()) << "shot " << k << ", " << policy;
    }
    times.empty() ? ++undecided : ++shots;
  }
  std::printf("%d shots, %d undecided\n", shots, undecided);
  EXPECT_LE(undecided, shots / 500);
}

// Each flight is held against the walls that it comes towards: two of four.
TEST(FarWalls, ThatAreLeftBehindAreNotSearched) {
  World world;
  testing::add(world, testing::body(make_disc(0.25), {0.3, 0.2}, {1.0, 0.83}));
  const Vec2 corners[] = {{-2.0, -1.5}, {2.0, -1.5}, {2.0, 1.5}, {-2.0, 1.5}};
  for (int k = 0; k < 4; ++k)
    testing::add(world, testing::site(make_segment(corners[k], corners[(k + 1) % 4])));
  const RunSummary summary = Simulator(world, {}).run(testing::until(50.0));
  ASSERT_EQ(summary.collisions, 31u);
  EXPECT_LE(summary.work.pair_searches, 2 * (summary.collisions + 1));
}

}  // namespace
}  // namespace brink::far_walls_test
