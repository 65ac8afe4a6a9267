// One disc and one wall that stands still, the disc coming from anywhere: beside the wall's line, beyond its ends, towards a
// tip while it goes away from the line. Whether and when the two meet is told by marching along the flight, which shares
// nothing with the core; every exact policy must say the same.
// BRINK_SEED moves the seeds, BRINK_WORLDS their number.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "brink/core/base/random.h"
#include "brink/scheduler/policies/policy.h"
#include "tests/support/seeded_worlds.h"
#include "tests/support/worlds.h"

namespace brink::wall_tips_test {
namespace {

struct Flight {
  Vec2 a, b;  ///< of the wall
  double thickness = 0.0, radius = 0.0;
  Vec2 from, velocity, gravity = Vec2::Zero();
  double ends = 0.0;  ///< [s]

  Vec2 place(double t) const { return from + t * velocity + 0.5 * t * t * gravity; }
  double gap(double t) const {
    const Vec2 way = b - a, q = place(t) - a;
    const double part = std::clamp(q.dot(way) / way.squaredNorm(), 0.0, 1.0);
    return (q - part * way).norm() - radius - 0.5 * thickness;
  }
  /// By steps that no gap can close in; infinity: not before it ends.
  double meets() const {
    const double fastest = velocity.norm() + ends * gravity.norm();
    for (double t = 0.0; t < ends;) {
      const double left = gap(t);
      if (left < 1e-11) return t;
      t += left / fastest;
    }
    return kForever;
  }
  /// How deep it would go [m].
  double deepest() const {
    double least = 0.0;
    for (int k = 0; k <= 2000; ++k) least = std::min(least, gap(ends * k / 2000.0));
    return -least;
  }
};

/// Three of four times the disc begins beside the wall's line, where its circle spans it or nearly, beyond an end.
Flight flight_of(Random& random) {
  Flight f;
  f.radius = std::pow(10.0, random.uniform(-1.5, 0.5));
  const double length = f.radius * std::pow(10.0, random.uniform(-1.0, 1.0)), turn = random.uniform(0.0, 7.0);
  const Vec2 along(std::cos(turn), std::sin(turn)), across = perp(along);
  f.a = Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
  f.b = f.a + length * along;
  f.thickness = random.below(3) == 0 ? f.radius * random.uniform(0.0, 0.5) : 0.0;
  const double reach = f.radius + 0.5 * f.thickness, speed = std::pow(10.0, random.uniform(-1.0, 1.0));
  if (random.below(4) == 0) {
    const double way = random.uniform(0.0, 7.0);
    f.from = f.a + (2.0 * length + 3.0 * reach) * Vec2(std::cos(way), std::sin(way));
    const Vec2 aim = f.a + random.uniform(-0.2, 1.2) * length * along;
    f.velocity = speed * (aim - f.from).normalized();
  } else {
    const double height = reach * random.uniform(-1.3, 1.3), beyond = reach * random.uniform(1.0, 4.0);
    const bool at_start = random.below(2) == 0;
    const Vec2 out = at_start ? Vec2(-along) : along;
    f.from = (at_start ? f.a : f.b) + beyond * out + height * across;
    const double aside = random.uniform(-0.5, 0.5);
    f.velocity = speed * (aside * across - out).normalized();
  }
  if (random.below(4) == 0) f.gravity = {random.uniform(-1.0, 1.0), random.uniform(-3.0, 3.0)};
  f.ends = random.uniform(1.0, 2.0) * (2.0 * length + 6.0 * reach) / speed;
  return f;
}

/// Whatever decides it by a rounding is left out.
bool is_told(const Flight& f, double meets) {
  if (f.gap(0.0) < 0.01 * f.radius) return false;
  if (meets == kForever) {
    double least = kForever;
    for (int k = 0; k <= 2000; ++k) least = std::min(least, f.gap(f.ends * k / 2000.0));
    return least > 1e-3 * f.radius;
  }
  return f.deepest() > 1e-4 * f.radius && meets < 0.999 * f.ends;
}

/// The first collision, and when.
class First : public Recorder {
 public:
  void event(const Event& e) override {
    if (e.kind == EventKind::collision && time_ == kForever) time_ = e.contact.time;
  }
  double time() const { return time_; }

 private:
  double time_ = kForever;
};

TEST(WallTips, AreMetWhereverADiscComesFrom) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      flights = testing::from_environment("BRINK_WORLDS", 4000);
  int met = 0, at_tips = 0;
  for (std::uint64_t seed = first; seed < first + flights; ++seed) {
    Random random(seed);
    const Flight f = flight_of(random);
    const double meets = f.meets();
    if (!is_told(f, meets)) continue;
    World world;
    world.gravity = f.gravity;
    testing::add(world, testing::site(make_segment(f.a, f.b, 0.5 * f.thickness)));
    testing::add(world, testing::body(make_disc(f.radius), f.from, f.velocity));
    std::uint64_t hash = 0;
    for (const std::string& policy : exact_policies()) {
      SolverOptions options;
      options.policy = policy;
      // with a recorder, which asks for the common way, and without
      First told;
      RunOptions until = testing::until(f.ends);
      Simulator watched(world, options), simulator(world, options);
      ASSERT_EQ(watched.run(until, &told).termination, Termination::reached_end) << "seed " << seed;
      const RunSummary s = simulator.run(until);
      ASSERT_EQ(s.termination, Termination::reached_end) << "seed " << seed << ": " << s.why;
      if (meets == kForever) {
        ASSERT_EQ(s.work.collisions, 0U) << "seed " << seed << " " << policy;
      } else {
        ASSERT_GT(s.work.collisions, 0U)
            << "seed " << seed << " " << policy << ": flies through it at " << meets;
        ASSERT_NEAR(told.time(), meets, 1e-8 * (f.radius / f.velocity.norm() + meets)) << "seed " << seed;
      }
      ASSERT_EQ(watched.state_hash(), s.state_hash) << "seed " << seed << " " << policy;
      if (hash == 0) hash = s.state_hash;
      ASSERT_EQ(s.state_hash, hash) << "seed " << seed << " " << policy;
    }
    if (meets == kForever) continue;
    ++met;
    const Vec2 way = f.b - f.a;
    const double part = (f.place(meets) - f.a).dot(way) / way.squaredNorm();
    at_tips += part < 0.0 || part > 1.0;
  }
  EXPECT_GT(met, static_cast<int>(flights) / 3);
  EXPECT_GT(at_tips, static_cast<int>(flights) / 4);
}

}  // namespace
}  // namespace brink::wall_tips_test
