// Motions of single bodies on sites of all kinds that are smooth from the begin to the end: over joints of straight sites and arcs, on arcs
// of their own, of straight sites alone, about a corner, to and fro with friction. Modes must follow all of them to the tolerance: no step of first order, no
// impact that is none, and the answer of a closed form or of a fourth-order integration of one angle, which share no code with the
// core. BRINK_SEED moves the seeds, BRINK_WORLDS their number.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "tests/support/seeded_worlds.h"

namespace brink::smooth_motions_test {
namespace {

constexpr double kGravity = 9.81;
/// Of places [m], angles [rad], and of the energy that there was: solver.tolerance is 1e-10 for each of some hundred steps.
constexpr double kNear = 1e-7;

struct Ran {
  RunSummary summary;
  BodyState last;
  std::string other;  ///< "" where another policy, stopped and gone on with, came to the same bits
};

Ran run(const std::string& text) {
  const Scene scene = parse_scene(text, "smooth");
  Simulator simulator(scene.world, scene.solver);
  Ran ran;
  ran.summary = simulator.run(testing::until(scene.duration));
  ran.last = simulator.state(0);
  ran.other = testing::stopped_under_another_policy(scene.world, scene.solver, testing::until(scene.duration),
                                                    4, text.size(), ran.summary);
  return ran;
}

/// "" where it came to the end by modes alone and without a collision.
std::string not_smooth(const Ran& ran) {
  const RunSummary& s = ran.summary;
  if (s.termination != Termination::reached_end) return s.why;
  if (!ran.other.empty()) return ran.other;
  if (s.steps_by_modes != s.island_steps)
    return fmt::format("{} of {} steps are of first order", s.island_steps - s.steps_by_modes,
                       s.island_steps);
  return s.work.collisions == 0 ? "" : fmt::format("{} collisions", s.work.collisions);
}

std::string loses_energy(const Ran& ran) {
  const double lost = (ran.summary.energy_initial - ran.summary.energy_final) /
                      std::max(1.0, std::abs(ran.summary.energy_initial));
  return std::abs(lost) <= kNear ? "" : fmt::format("{:.3g} of the energy lost", lost);
}

std::string misses(const std::string& what, double got, double wanted) {
  return std::abs(got - wanted) <= kNear ? "" : fmt::format("{}: {:.10g} for {:.10g}", what, got, wanted);
}

std::string first_of(std::initializer_list<std::string> faults) {
  for (const std::string& f : faults)
    if (!f.empty()) return f;
  return "";
}

std::string world(double duration, double friction, double gx = 0.0, double gy = -kGravity) {
  return fmt::format(
      "[world]\nduration = {:.17g}\ngravity = [{:.17g}, {:.17g}]\n[output]\nframe_interval = "
      "0\n[materials.m]\n"
      "restitution = 0\nfriction = {:.17g}\n",
      duration, gx, gy, friction);
}

/// A level floor: a wire, a solid, or a wire with thickness.
std::string floor_of(Random& random, double around = 0.0) {
  switch (random.below(3)) {
    case 0:
      return fmt::format("[[sites]]\nname = 'f'\nmaterial = 'm'\nsegment = [[{0:.17g}, 0], [{1:.17g}, 0]]\n",
                         around - 40.0, around + 40.0);
    case 1:
      return fmt::format(
          "[[sites]]\nname = 'f'\nmaterial = 'm'\nbox = {{ width = 80, height = 2 }}\nposition = [{:.17g}, "
          "-1]\n",
          around);
    default:
      return fmt::format(
          "[[sites]]\nname = 'f'\nmaterial = 'm'\nradius = 0.5\nsegment = [[{0:.17g}, -0.5], [{1:.17g}, "
          "-0.5]]\n",
          around - 40.0, around + 40.0);
  }
}

/// Fourth order, by steps of a hundred thousandth of the time.
double integrated(double angle, double until, const std::function<double(double, double)>& acceleration) {
  constexpr int kSteps = 100000;
  const double h = until / kSteps;
  double a = angle, w = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double k1 = w, l1 = acceleration(a, w), k2 = w + 0.5 * h * l1,
                 l2 = acceleration(a + 0.5 * h * k1, w + 0.5 * h * l1), k3 = w + 0.5 * h * l2,
                 l3 = acceleration(a + 0.5 * h * k2, w + 0.5 * h * l2), k4 = w + h * l3,
                 l4 = acceleration(a + h * k3, w + h * l3);
    a += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    w += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
  }
  return a;
}

/// An ellipse rocks without friction: it loses nothing. (Its arcs are near an ellipse, so its angle is not looked at.)
std::string ellipse(Random& random) {
  const double a = random.uniform(0.3, 0.8), b = a * random.uniform(0.4, 0.9);
  const Ran ran =
      run(world(random.uniform(1.0, 3.0), random.below(2) == 0 ? 0.0 : 5.0) + floor_of(random) +
          fmt::format("[[bodies]]\nname = 'b'\nmaterial = 'm'\npath = {{ d = 'M {2:.17g} 0 A {0:.17g} "
                      "{1:.17g} 0 0 0 {0:.17g} 0 A {0:.17g} {1:.17g} 0 0 0 {2:.17g} 0 Z' }}\nangle = "
                      "{3:.17g}\nposition = [0, 3]\ntouching = 'f'\n",
                      a, b, -a, random.uniform(0.1, 1.2)));
  return first_of({not_smooth(ran), loses_energy(ran)});
}

/// A disc slides, or rolls, from a level floor up a quarter of a circle, and comes back as fast.
std::string ramp(Random& random) {
  const double radius = random.uniform(0.5, 3.0), r = radius * random.uniform(0.1, 0.4),
               v = random.uniform(0.3, 0.6) * std::sqrt(kGravity * radius);
  const bool rolls = random.below(2) == 0;
  const std::string arc = fmt::format(
      "[[sites]]\nname = 'a'\nmaterial = 'm'\narc = {{ center = [0, {0:.17g}], radius = {0:.17g}, "
      "from_deg = 270, to_deg = 360 }}\n",
      radius);
  const Ran ran = run(
      world(4.0, rolls ? 5.0 : 0.0) +
      "[[sites]]\nname = 'f'\nmaterial = 'm'\nsegment = [[-40, 0], [0, 0]]\n" + arc +
      fmt::format("[[bodies]]\nname = 'b'\nmaterial = 'm'\ndisc = {{ radius = {0:.17g} }}\nposition = [-1, "
                  "{0:.17g}]\nvelocity = [{1:.17g}, 0]\nangular_velocity = {2:.17g}\n",
                  r, v, rolls ? -v / r : 0.0));
  return first_of({not_smooth(ran), loses_energy(ran), misses("speed", ran.last.twist.velocity.x(), -v)});
}

/// A disc in a bowl of arcs that are near a Bezier curve.
std::string bowl(Random& random) {
  const double low = random.uniform(-1.0, 0.5);
  const Ran ran =
      run(world(3.0, random.below(2) == 0 ? 0.0 : 5.0) +
          fmt::format("[[sites]]\nname = 'f'\nmaterial = 'm'\nbezier = [[-2, 2], [-1, {0:.17g}], [1, "
                      "{0:.17g}], [2, 2]]\n",
                      low) +
          fmt::format(
              "[[bodies]]\nname = 'b'\nmaterial = 'm'\ndisc = {{ radius = {:.17g} }}\nposition = [{:.17g}, "
              "4]\ntouching = 'f'\n",
              random.uniform(0.05, 0.2), random.uniform(0.2, 1.2)));
  return first_of({not_smooth(ran), loses_energy(ran)});
}

/// A box topples about its corner, which sticks: a pendulum that stands on its head.
std::string topples(Random& random) {
  const double w = random.uniform(0.3, 0.6), h = random.uniform(0.8, 1.5),
               tilt = std::atan(w / h) + random.uniform(0.05, 0.2), far = std::atan2(w, h);
  const double arm = 0.5 * std::hypot(w, h), moment = (w * w + h * h) / 12.0 + arm * arm, friction = 3.0,
               first = tilt - far;
  const auto speeds_up = [&](double a) { return kGravity * arm * std::sin(a + first) / moment; };
  // the corner's force from the centre's acceleration, seen from the tilted floor: what presses less than friction needs slips
  const auto sticks = [&](double a) {
    const double b = a + first,
                 squared = 2.0 * kGravity * arm * (std::cos(first) - std::cos(b)) /
                           moment;  // of the angular velocity
    const Vec2 force =
        arm * (speeds_up(a) * Vec2(std::cos(b), -std::sin(b)) - squared * Vec2(std::sin(b), std::cos(b))) +
        Vec2(0.0, kGravity);
    const Vec2 along(std::cos(tilt), -std::sin(tilt));
    return std::abs(along.dot(force)) < friction * perp(along).dot(force);
  };
  double end = 0.6, turned = 0.0;
  for (;; end *= 0.8) {
    turned = integrated(0.0, end, [&](double a, double) { return speeds_up(a); });
    bool all = true;
    for (int k = 0; k <= 100; ++k) all = all && sticks(turned * k / 100.0);
    if (all) break;
  }
  const Ran ran = run(
      world(end, friction, kGravity * std::sin(tilt), -kGravity * std::cos(tilt)) + floor_of(random) +
      fmt::format("[[bodies]]\nname = 'b'\nmaterial = 'm'\nbox = {{ width = {:.17g}, height = {:.17g} }}\n"
                  "position = [0, {:.17g}]\n",
                  w, h, 0.5 * h));
  return first_of({not_smooth(ran), misses("angle", ran.last.pose.angle, -turned)});
}

/// To and fro on a spring with friction: of each swing the middle lies off by mu g / w^2.
std::string oscillates(Random& random) {
  const double mu = random.uniform(0.02, 0.2), k = random.uniform(20.0, 100.0),
               from = random.uniform(0.2, 0.6), end = random.uniform(0.5, 3.0), half = M_PI / std::sqrt(k),
               off = mu * kGravity / k;
  double side = from, t = 0.0;
  while (t + half <= end && std::abs(side) > off) {
    side = side > 0.0 ? -(side - 2.0 * off) : -(side + 2.0 * off);
    t += half;
  }
  const double middle = side > 0.0 ? off : -off;
  const double wanted =
      std::abs(side) <= off ? side : middle + (side - middle) * std::cos(std::sqrt(k) * (end - t));
  const Ran ran = run(
      world(end, mu) + floor_of(random) +
      fmt::format("[[bodies]]\nname = 'b'\nmaterial = 'm'\nmass = 1\nbox = {{ width = 0.5, height = 0.2 }}\n"
                  "position = [{:.17g}, 0.1]\n[[forces]]\nkind = 'spring'\nbody = 'b'\nanchor = [0, 0.1]\n"
                  "stiffness = {:.17g}\nrest_length = 0\n",
                  from, k));
  return first_of({not_smooth(ran), misses("place", ran.last.pose.position.x(), wanted)});
}

/// A block slides to its stop, up to some kilometres from the origin.
std::string far_away(Random& random) {
  const double x = std::pow(10.0, random.uniform(0.0, 3.3)), mu = random.uniform(0.05, 0.3),
               v = random.uniform(1.0, 5.0), end = random.uniform(0.2, 2.0), stop = v / (mu * kGravity),
               t = std::min(end, stop);
  const Ran ran = run(
      world(end, mu) + floor_of(random, x) +
      fmt::format("[[bodies]]\nname = 'b'\nmaterial = 'm'\nbox = {{ width = 1, height = 0.5 }}\nposition = "
                  "[{:.17g}, 0.25]\nvelocity = [{:.17g}, 0]\n",
                  x, v));
  return first_of({not_smooth(ran),
                   misses("place", ran.last.pose.position.x() - x, v * t - 0.5 * mu * kGravity * t * t)});
}

/// A disc or a box slides, or a disc rolls, along a straight slope of pieces that lie end to end: a wire, one with thickness, or the
/// top of a solid. Places are rounded, so what touches may be apart or sunk by that.
std::string over_joints(Random& random) {
  const double turn = random.below(2) == 0 ? 0.0 : random.uniform(-0.3, 0.3), mu = random.uniform(0.05, 0.3),
               v = random.uniform(1.0, 5.0), end = random.uniform(0.2, 1.0),
               thickness = random.below(2) == 0 ? 0.0 : 0.25;
  const Vec2 shift(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0)),
      along(std::cos(turn), std::sin(turn)), up = perp(along);
  std::string top;
  for (double x = -20.0; x < 20.0; x += random.uniform(0.3, 2.0)) {
    const Vec2 p = x * along - thickness * up;
    top += fmt::format("[{:.17g}, {:.17g}], ", p.x(), p.y());
  }
  const bool solid = thickness == 0.0 && random.below(2) == 0;
  const Vec2 low = -3.0 * up;
  std::string text = world(end, mu) + "[[sites]]\nname = 'f'\nmaterial = 'm'\n";
  // counter-clockwise: back along the top
  if (solid)
    text += fmt::format("polygon = {{ vertices = [{}[{:.17g}, {:.17g}]] }}\n", top, low.x(), low.y());
  else
    text += fmt::format("polyline = [{}]\nradius = {:.17g}\n", top, thickness);
  text += fmt::format("position = [{:.17g}, {:.17g}]\n", shift.x(), shift.y());
  const bool disc = random.below(3) != 0;
  const double r = random.uniform(0.05, 0.3);
  const bool rolls = disc && random.below(2) == 0;
  const Vec2 at = shift + r * up;
  text += fmt::format(
      "[[bodies]]\nname = 'b'\nmaterial = 'm'\n{}\nposition = [{:.17g}, {:.17g}]\nangle = {:.17g}\nvelocity "
      "= "
      "[{:.17g}, {:.17g}]\nangular_velocity = {:.17g}\n",
      disc ? fmt::format("disc = {{ radius = {:.17g} }}", r)
           : fmt::format("box = {{ width = {:.17g}, height = {:.17g} }}", 6.0 * r, 2.0 * r),
      at.x(), at.y(), turn, v * along.x(), v * along.y(), rolls ? -v / r : 0.0);
  const double pull = -kGravity * std::sin(turn), press = kGravity * std::cos(turn);
  // what rolls may stop to, and slip: at tan > 3 mu
  if (rolls && std::abs(pull) > 2.9 * mu * press) return "";
  const auto way = [](double speed, double a, double t) { return t * (speed + 0.5 * a * t); };
  double wanted = 0.0;
  if (rolls) {
    wanted = way(v, pull / 1.5, end);
  } else if (disc) {
    // it slides until its rim has the speed of the place: v + a t = r w, with w = 2 mu press t / r
    const double a = pull - mu * press, spun = v / (2.0 * mu * press - a);
    const bool slides_on = pull > 3.0 * mu * press || end <= spun;
    wanted = slides_on
                 ? way(v, a, end)
                 : way(v, a, spun) + way(v + a * spun,
                                         std::abs(pull) <= 3.0 * mu * press ? pull / 1.5 : pull + mu * press,
                                         end - spun);
  } else {
    const double a = pull - mu * press, stop = a < 0.0 ? -v / a : end;
    const bool stays = std::abs(pull) <= mu * press;
    wanted = way(v, a, std::min(stop, end));
    if (stop < end && !stays) wanted += way(0.0, pull + mu * press, end - stop);
  }
  const Ran ran = run(text);
  return first_of({not_smooth(ran), misses("place", along.dot(ran.last.pose.position - shift), wanted)});
}

/// A box slides over pieces that lie end to end, blocks or segments, as they stand or move up and down as one: what presses it follows
/// them.
std::string over_moving_joints(Random& random) {
  const double pace = random.uniform(2.0, 8.0),
               high = random.below(3) == 0 ? 0.0 : random.uniform(0.1, 0.8) * kGravity / (pace * pace),
               mu = random.below(3) == 0 ? 0.0 : random.uniform(0.02, 0.1), end = random.uniform(0.5, 1.5),
               v = random.uniform(3.5, 6.0), width = random.uniform(0.2, 1.0);
  std::string text = world(end, mu);
  const bool blocks = random.below(2) == 0;
  for (double x = -3.0; x < 12.0;) {
    const double to = x + random.uniform(0.4, 3.0);
    text += "[[sites]]\nmaterial = 'm'\n";
    text += blocks ? fmt::format(
                         "polygon = {{ vertices = [[{0:.17g}, -1], [{1:.17g}, -1], [{1:.17g}, 0], [{0:.17g}, "
                         "0]] }}\n",
                         x, to)
                   : fmt::format("segment = [[{:.17g}, 0], [{:.17g}, 0]]\n", x, to);
    if (high > 0.0) text += fmt::format("motion = {{ y = \"{:.17g}*sin({:.17g}*t)\" }}\n", high, pace);
    x = to;
  }
  text += fmt::format(
      "[[bodies]]\nname = 'b'\nmaterial = 'm'\nbox = {{ width = {:.17g}, height = 0.1 }}\nposition = [0, "
      "0.05]\nvelocity = "
      "[{:.17g}, {:.17g}]\n{}",
      width, v, high * pace, random.below(3) == 0 ? "lock = ['angle']\n" : "");
  const Ran ran = run(text);
  const double y = high * std::sin(pace * end);
  return first_of({not_smooth(ran), misses("height", ran.last.pose.position.y(), 0.05 + y),
                   misses("place", ran.last.pose.position.x(),
                          v * end - mu * (0.5 * kGravity * end * end + y - high * pace * end))});
}

std::string fault_of(std::uint64_t seed) {
  Random random(seed);
  switch (seed % 8) {
    case 0:
      return "ellipse: " + ellipse(random);
    case 1:
      return "ramp: " + ramp(random);
    case 2:
      return "bowl: " + bowl(random);
    case 3:
      return "topples: " + topples(random);
    case 4:
      return "oscillates: " + oscillates(random);
    case 5:
      return "over joints: " + over_joints(random);
    case 6:
      return "over moving joints: " + over_moving_joints(random);
    default:
      return "far away: " + far_away(random);
  }
}

TEST(SmoothMotions, AreFollowedByModesAlone) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      worlds = testing::from_environment("BRINK_WORLDS", 60);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed) {
    const std::string fault = fault_of(seed);
    EXPECT_TRUE(fault.ends_with(": ")) << fault << ", seed " << seed;
  }
}

/// A disc rolls along a floor, drawn by gravity, until it meets the nose of a step, or the tip of a wire, of the same site.
TEST(SmoothMotions, OfADiscEndWhereItMeetsANoseOfItsFloor) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const double r = random.uniform(0.1, 0.5), high = r * random.uniform(0.1, 1.5),
                 pull = random.uniform(0.5, 2.0);
    const bool step = high < 0.95 * r && random.below(2) == 0;
    // svg paths count y downwards
    const std::string site =
        step ? fmt::format(
                   "polygon = {{ vertices = [[-9, 0], [2, 0], [2, {0:.17g}], [9, {0:.17g}], [9, -1], [-9, "
                   "-1]] }}",
                   high)
             : fmt::format("path = {{ d = 'M -9 0 L 9 0 M 2 {0:.17g} L 6 {0:.17g}' }}", -high);
    const double way = 2.0 - std::sqrt(r * r - (r - high) * (r - high)), met = std::sqrt(3.0 * way / pull);
    const std::string text = world(met + 0.5, 0.3, pull) + "[[sites]]\nname = 'f'\nmaterial = 'm'\n" + site +
                             fmt::format(
                                 "\n[[bodies]]\nname = 'b'\nmaterial = 'm'\ndisc = {{ radius = {0:.17g} "
                                 "}}\nposition = [0, {0:.17g}]\n",
                                 r);
    const Scene scene = parse_scene(text, "nose");
    Simulator simulator(scene.world, scene.solver);
    testing::Events events;
    const RunSummary s = simulator.run(testing::until(scene.duration), &events);
    ASSERT_EQ(s.termination, Termination::reached_end) << s.why << ", seed " << seed;
    EXPECT_EQ(s.steps_by_modes, s.island_steps) << "seed " << seed;
    ASSERT_FALSE(events.collisions().empty()) << "seed " << seed;
    const Contact first = events.collisions().front().contact;
    EXPECT_NEAR(first.time, met, 1e-9) << "seed " << seed;
    EXPECT_NEAR(first.closing_speed, pull / 1.5 * met * std::sqrt(r * r - (r - high) * (r - high)) / r, 1e-8)
        << "seed " << seed;
  }
}

}  // namespace
}  // namespace brink::smooth_motions_test
