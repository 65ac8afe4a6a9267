// Belts and lifts that change their speed at once, or within down to a billionth of a second, under who lies on them: friction gives
// no more than Coulomb's law has, what a lift stops under flies on, and what it starts under goes along, whatever the restitution. Against closed forms that share no code with the core,
// and once more under another policy, stopped on the way. BRINK_SEED moves the seeds, BRINK_WORLDS their number.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "tests/support/seeded_worlds.h"

namespace brink::corners_in_time_test {
namespace {

constexpr double kGravity = 9.81, kNear = 1e-7;
/// Of a speed.
struct Change {
  double before = 0.0, after = 0.0, at = 0.0;  ///< speeds [m/s], time [s]
  double within = 0.0;                         ///< about so long [s]; 0: at once
  std::string place;                           ///< as a formula
};

Change change_of_speed(Random& random) {
  Change c{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(0.05, 0.6), 0.0, ""};
  if (random.below(3) == 0)
    c.at = std::round(c.at * 16.0) / 16.0 + 0.0625;  // where pieces of motions end anyway
  const double by = c.after - c.before;
  switch (random.below(4)) {
    case 0:
      c.place = fmt::format("{:.17g}*t + {:.17g}*max(t - {:.17g}, 0)", c.before, by, c.at);
      break;
    case 1:
      c.place = fmt::format("{:.17g}*t + {:.17g}*abs(t - {:.17g}) - {:.17g}", c.before + 0.5 * by, 0.5 * by,
                            c.at, 0.5 * by * c.at);
      break;
    case 2:
      c.place = fmt::format("t < {0:.17g} ? {1:.17g}*t : {2:.17g} + {3:.17g}*(t - {0:.17g})", c.at, c.before,
                            c.before * c.at, c.after);
      break;
    default:
      c.within = std::pow(10.0, random.uniform(-9.0, -4.0));
      c.place = fmt::format("{:.17g}*t + {:.17g}*(t - {:.17g} + sqrt((t - {:.17g})^2 + {:.17g}))", c.before,
                            0.5 * by, c.at, c.at, c.within * c.within);
  }
  return c;
}

std::string world(double until, double restitution, double mu, const std::string& motion, bool disc,
                  double angle_of_velocity, double speed) {
  return fmt::format(
      "[world]\nduration = {:.17g}\ngravity = [0, -9.81]\n[output]\nframe_interval = "
      "0\n[materials.m]\nrestitution = "
      "{:.17g}\nfriction = {:.17g}\n[[sites]]\nname = 'f'\nmaterial = 'm'\nsegment = [[-40, 0], [40, "
      "0]]\nmotion = "
      "{{ {} }}\n"
      "[[bodies]]\nname = 'b'\nmaterial = 'm'\n{}\nposition = [0, 0.1]\nvelocity = [{:.17g}, {:.17g}]\n",
      until, restitution, mu, motion,
      disc ? "disc = { radius = 0.1 }" : "box = { width = 0.8, height = 0.2 }",
      speed * std::cos(angle_of_velocity), speed * std::sin(angle_of_velocity));
}

double any_restitution(Random& random) { return random.below(2) == 0 ? 0.0 : random.uniform(0.1, 0.9); }

std::string fault_of(const std::string& text, const Vec2& place, const Vec2& velocity, double near,
                     std::uint64_t seed) {
  const Scene scene = parse_scene(text, "corner");
  Simulator simulator(scene.world, scene.solver);
  const RunSummary s = simulator.run(testing::until(scene.duration));
  if (s.termination != Termination::reached_end) return s.why;
  // with a rebound one step leads over a corner
  if (s.steps_by_modes != s.island_steps && scene.world.materials[1].restitution == 0.0)
    return "steps of first order";
  const BodyState at = simulator.state(0);
  if (!((at.pose.position - place).norm() <= near))
    return fmt::format("at ({:.10g}, {:.10g}) for ({:.10g}, {:.10g})", at.pose.position.x(),
                       at.pose.position.y(), place.x(), place.y());
  if (!((at.twist.velocity - velocity).norm() <= 10.0 * near))
    return fmt::format("with ({:.10g}, {:.10g}) for ({:.10g}, {:.10g})", at.twist.velocity.x(),
                       at.twist.velocity.y(), velocity.x(), velocity.y());
  return testing::stopped_under_another_policy(scene.world, scene.solver, testing::until(scene.duration), 3,
                                               seed, s);
}

/// A block slides on until it has the belt's new speed; a disc until it rolls.
std::string belt(Random& random, std::uint64_t seed) {
  const Change c = change_of_speed(random);
  const double mu = random.uniform(0.1, 0.6), until = c.at + random.uniform(0.02, 0.6), t = until - c.at;
  const bool disc = random.below(2) == 0;
  const double by = c.after - c.before, a = std::copysign(mu * kGravity, by),
               // of a disc the slip goes three times as fast as the speed
      slides = std::min(t, std::abs(by) / (mu * kGravity * (disc ? 3.0 : 1.0)));
  const double gained = a * slides,
               place = c.before * until + 0.5 * a * slides * slides + gained * (t - slides);
  // in the tails of a quick change the belt gains more than friction gives for some (within^2 by / mu g)^(1/3)
  const double near = kNear + 20.0 * std::cbrt(c.within * c.within);
  return fault_of(world(until, any_restitution(random), mu, "x = \"" + c.place + "\"", disc, 0.0, c.before),
                  {place, 0.1}, {c.before + gained, 0.0}, near, seed);
}

/// What a lift that slows down leaves flies on, and lands; what one that speeds up is under goes with it.
std::string lift(Random& random, std::uint64_t seed) {
  const Change c = change_of_speed(random);
  const double until = c.at + random.uniform(0.005, 0.4), t = until - c.at, by = c.after - c.before,
               flies = by < 0.0 ? -2.0 * by / kGravity : 0.0;
  if (std::abs(t - flies) < 1e-3) return "";  // right at its landing
  const bool lands = t > flies;
  const double y = c.before * c.at + (lands ? c.after * t : c.before * t - 0.5 * kGravity * t * t),
               v = lands ? c.after : c.before - kGravity * t;
  // what lands rebounds
  const double restitution = by < 0.0 && lands ? 0.0 : any_restitution(random);
  return fault_of(world(until, restitution, random.uniform(0.0, 0.6), "y = \"" + c.place + "\"",
                        random.below(2) == 0, 0.5 * M_PI, c.before),
                  {0.0, 0.1 + y}, {0.0, v}, kNear + 20.0 * std::cbrt(c.within * c.within), seed);
}

TEST(CornersInTime, AreFollowedByWhoLiesOnThem) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      worlds = testing::from_environment("BRINK_WORLDS", 100);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed) {
    Random random(seed);
    const std::string fault = seed % 2 == 0 ? belt(random, seed) : lift(random, seed);
    EXPECT_EQ(fault, "") << (seed % 2 == 0 ? "belt" : "lift") << ", seed " << seed;
  }
}

}  // namespace
}  // namespace brink::corners_in_time_test
