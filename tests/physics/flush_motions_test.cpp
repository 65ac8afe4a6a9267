// Boxes that lie upon each other, or side by side, with their edges flush: each corner lies right on a corner of the next, but
// for roundings of any slope. They slide as blocks of one dimension do, whose laws are written down here and share no code with
// the core: modes must follow them to the tolerance, without a step of first order and without a collision. BRINK_SEED moves
// the seeds, BRINK_WORLDS their number.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "tests/support/seeded_worlds.h"

namespace brink::flush_motions_test {
namespace {

constexpr double kGravity = 9.81;
/// Of places [m], and of the angle of what only slides [rad].
constexpr double kNear = 1e-8;

/// Two frictions that are one but for roundings.
constexpr double kRounding = 1e-12;

struct Block {
  double width = 1.0, height = 0.1, mass = 1.0, friction = 0.0, velocity = 0.0;
  Vec2 place = Vec2::Zero();  ///< of its centre, along the floor and above it
};

/// The floor through the origin, turned.
struct Slope {
  double angle = 0.0;
  Vec2 along() const { return {std::cos(angle), std::sin(angle)}; }
  Vec2 up() const { return perp(along()); }
  Vec2 at(const Vec2& place) const { return place.x() * along() + place.y() * up(); }
};

// ---- layers, each upon the one below: Coulomb's law along one line

struct Layers {
  std::vector<double> mass, limit;  ///< limit: of the friction below each [N]
  double pull = 0.0;                ///< along the floor [m/s^2]

  std::size_t count() const { return mass.size(); }
  static double relative(const std::vector<double>& v, std::size_t k) {
    return k == 0 ? v[0] : v[k] - v[k - 1];
  }

  /// With slips of these signs, 0 where one sticks: accelerations, and the friction below each.
  std::pair<std::vector<double>, std::vector<double>> move(const std::vector<int>& sign) const {
    const int n = static_cast<int>(count());
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(2 * n, 2 * n);  // of accelerations, then of friction
    Eigen::VectorXd right(2 * n);
    for (int k = 0; k < n; ++k) {
      m(k, k) = mass[k];
      m(k, n + k) = -1.0;
      if (k + 1 < n) m(k, n + k + 1) = 1.0;
      right[k] = mass[k] * pull;
      right[n + k] = -sign[k] * limit[k];
      m(n + k, sign[k] != 0 ? n + k : k) = 1.0;
      if (sign[k] == 0 && k > 0) m(n + k, k - 1) = -1.0;
    }
    const Eigen::VectorXd x = m.fullPivLu().solve(right);
    return {std::vector<double>(x.data(), x.data() + n), std::vector<double>(x.data() + n, x.data() + 2 * n)};
  }

  /// The accelerations that agree with the law: what slips goes on, what is still sticks or begins to slip.
  std::vector<double> acceleration(const std::vector<double>& v) const {
    std::size_t all = 1;
    for (std::size_t k = 0; k < count(); ++k) all *= 3;
    for (std::size_t code = 0; code < all; ++code) {
      std::vector<int> sign;
      for (std::size_t k = 0, rest = code; k < count(); ++k, rest /= 3)
        sign.push_back(static_cast<int>(rest % 3) - 1);
      const auto [a, friction] = move(sign);
      bool agrees = true;
      for (std::size_t k = 0; k < count(); ++k) {
        const double slip = relative(v, k), gains = relative(a, k);
        agrees = agrees && (slip != 0.0    ? sign[k] == (slip > 0.0 ? 1 : -1)
                            : sign[k] == 0 ? std::abs(friction[k]) <= limit[k] * (1.0 + kRounding)
                                           : sign[k] * gains > 0.0);
      }
      if (agrees) return a;
    }
    ADD_FAILURE() << "no motion agrees with Coulomb's law";
    return std::vector<double>(count(), 0.0);
  }

  /// How far each comes, from these velocities; `apart`: the most that two neighbours are ever shifted.
  std::vector<double> ways(std::vector<double> v, double until, double& apart) const {
    std::vector<double> x(count(), 0.0);
    apart = 0.0;
    for (double t = 0.0; t < until;) {
      const std::vector<double> a = acceleration(v);
      double h = until - t;
      std::size_t stops = count();
      for (std::size_t k = 0; k < count(); ++k) {
        const double slip = relative(v, k), gains = relative(a, k);
        if (slip * gains < 0.0 && -slip / gains < h) h = -slip / gains, stops = k;
      }
      for (std::size_t k = 0; k < count(); ++k) {
        x[k] += h * (v[k] + 0.5 * h * a[k]);
        v[k] += h * a[k];
      }
      // who stops slipping against the one below moves as it does, to the last bit
      if (stops < count()) v[stops] = stops == 0 ? 0.0 : v[stops - 1];
      for (std::size_t k = 1; k < count(); ++k) {
        if (std::abs(relative(v, k)) < 1e-13) v[k] = v[k - 1];
        apart = std::max(apart, std::abs(x[k] - x[k - 1]));
      }
      t = stops < count() ? t + h : until;
    }
    return x;
  }
};

// ---- scenes

std::string scene_of(const Slope& slope, double duration, double gravity_along, double restitution,
                     double floor_friction, const std::vector<Block>& blocks, std::size_t floor,
                     const std::string& more = "") {
  const Vec2 g = slope.at({gravity_along, -kGravity});
  std::string text = fmt::format(
      "[world]\nduration = {:.17g}\ngravity = [{:.17g}, {:.17g}]\nfriction_rule = "
      "'min'\n[output]\nframe_interval = "
      "0\n[materials.floor]\nrestitution = {:.17g}\nfriction = {:.17g}\n",
      duration, g.x(), g.y(), restitution, floor_friction);
  const Vec2 a = slope.at({-60.0, 0.0}), b = slope.at({60.0, 0.0}), low = slope.at({0.0, -1.0});
  if (floor == 0)
    text += fmt::format(
        "[[sites]]\nname = 'f'\nmaterial = 'floor'\nsegment = [[{:.17g}, {:.17g}], [{:.17g}, {:.17g}]]\n",
        a.x(), a.y(), b.x(), b.y());
  else
    text += fmt::format(
        "[[sites]]\nname = 'f'\nmaterial = 'floor'\nbox = {{ width = 120, height = 2 }}\nposition = "
        "[{:.17g}, "
        "{:.17g}]\nangle = {:.17g}\n",
        low.x(), low.y(), slope.angle);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Block& block = blocks[k];
    const Vec2 p = slope.at(block.place), v = block.velocity * slope.along();
    text += fmt::format(
        "[materials.m{0}]\nrestitution = {1:.17g}\nfriction = {2:.17g}\n[[bodies]]\nname = 'b{0}'\nmaterial "
        "= "
        "'m{0}'\nmass = {3:.17g}\nbox = {{ width = {4:.17g}, height = {5:.17g} }}\nposition = [{6:.17g}, "
        "{7:.17g}]\nangle = {8:.17g}\nvelocity = [{9:.17g}, {10:.17g}]\n",
        k, restitution, block.friction, block.mass, block.width, block.height, p.x(), p.y(), slope.angle,
        v.x(), v.y());
  }
  return text + more;
}

/// "" if every block comes so far along the floor, and neither turns nor leaves it.
std::string fault_of(const std::string& text, const Slope& slope, const std::vector<Block>& blocks,
                     const std::vector<double>& ways, std::uint64_t seed, bool lands = false) {
  const Scene scene = parse_scene(text, "flush");
  Simulator simulator(scene.world, scene.solver);
  const RunSummary s = simulator.run(testing::until(scene.duration));
  if (s.termination != Termination::reached_end) return s.why;
  if (s.steps_by_modes != s.island_steps)
    return fmt::format("{} of {} steps are of first order", s.island_steps - s.steps_by_modes,
                       s.island_steps);
  if (s.work.collisions != 0 && !lands) return fmt::format("{} collisions", s.work.collisions);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const BodyState at = simulator.state(static_cast<int>(k));
    const double x = slope.along().dot(at.pose.position), y = slope.up().dot(at.pose.position),
                 wanted = blocks[k].place.x() + ways[k];
    if (!(std::abs(x - wanted) <= kNear)) return fmt::format("block {} at {:.12g} for {:.12g}", k, x, wanted);
    if (!(std::abs(y - blocks[k].place.y()) <= kNear)) return fmt::format("block {} rises to {:.12g}", k, y);
    if (!(std::abs(at.pose.angle - slope.angle) <= kNear)) return fmt::format("block {} turns", k);
  }
  return testing::stopped_under_another_policy(scene.world, scene.solver, testing::until(scene.duration), 4,
                                               seed, s);
}

Slope random_slope(Random& random) { return {random.below(3) == 0 ? 0.0 : random.uniform(-6.0, 6.0)}; }

double random_restitution(Random& random) { return random.below(2) == 0 ? 0.0 : random.uniform(0.0, 0.9); }

/// Two to four of one width, one upon the other, each at its own speed and with its own friction. Their edges are flush at the
/// beginning, and stay so where nothing slips.
std::string stack(Random& random, std::uint64_t seed) {
  for (;;) {
    const Slope slope = random_slope(random);
    const double width = random.uniform(1.0, 2.0), end = random.uniform(0.2, 1.5),
                 floor = random.uniform(0.0, 0.5),
                 along = random.below(2) == 0 ? 0.0 : random.uniform(-4.0, 4.0);
    const bool as_one = random.below(3) == 0;
    std::vector<Block> blocks(2 + random.below(3));
    Layers layers;
    layers.pull = along;
    double above = 0.0, weight = 0.0;
    for (Block& b : blocks) {
      b.width = width;
      b.height = random.uniform(0.04, 0.12);
      b.mass = std::pow(10.0, random.uniform(-1.0, 1.0));
      b.friction = random.uniform(0.05, 0.8);
      b.velocity = as_one ? 2.0 : random.uniform(-1.0, 1.0);
      b.place = {0.0, above + 0.5 * b.height};
      above += b.height;
      layers.mass.push_back(b.mass);
      weight += b.mass * kGravity;
    }
    double below = floor;
    for (const Block& b : blocks) {
      layers.limit.push_back(std::min(below, b.friction) * weight);
      weight -= b.mass * kGravity;
      below = b.friction;
    }
    std::vector<double> v;
    for (const Block& b : blocks) v.push_back(b.velocity);
    double apart = 0.0;
    const std::vector<double> ways = layers.ways(v, end, apart);
    // farther out they would tip over
    if (apart > 0.15 * width) continue;
    return fault_of(scene_of(slope, end, along, random_restitution(random), floor, blocks, random.below(2)),
                    slope, blocks, ways, seed);
  }
}

/// In a row on ice, pushed by a spring at the first: at its natural length that lets the others go.
std::string train(Random& random, std::uint64_t seed) {
  const Slope slope = random_slope(random);
  const double k = random.uniform(20.0, 100.0), pressed = random.uniform(0.1, 0.4),
               end = random.uniform(0.2, 1.0);
  std::vector<Block> blocks(2 + random.below(3));
  const double height = random.uniform(0.2, 0.6);
  const bool level = random.below(2) == 0;  // flush above, too
  double from = 0.0, mass = 0.0;
  for (Block& b : blocks) {
    b.width = random.uniform(0.5, 1.0);
    b.height = level ? height : random.uniform(0.2, 0.6);
    b.mass = random.uniform(0.5, 3.0);
    b.place = {from + 0.5 * b.width, 0.5 * b.height};
    from += b.width;
    mass += b.mass;
  }
  const Vec2 anchor = slope.at(blocks[0].place + Vec2(pressed, 0.0));
  const std::string spring = fmt::format(
      "[[forces]]\nkind = 'spring'\nbody = 'b0'\nanchor = [{:.17g}, {:.17g}]\nstiffness = "
      "{:.17g}\nrest_length = 0\n",
      anchor.x(), anchor.y(), k);
  const double w = std::sqrt(k / mass), lets_go = 0.5 * M_PI / w, v = pressed * w,
               alone = std::sqrt(k / blocks[0].mass);
  std::vector<double> ways;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    ways.push_back(end <= lets_go ? pressed * (1.0 - std::cos(w * end))
                   : i == 0       ? pressed + v / alone * std::sin(alone * (end - lets_go))
                                  : pressed + v * (end - lets_go));
  return fault_of(scene_of(slope, end, 0.0, random_restitution(random), 0.0, blocks, random.below(2), spring),
                  slope, blocks, ways, seed);
}

/// Two side by side and one across both, flush with their outer edges: all at one speed, and slowed down by the floor alike.
std::string bridge(Random& random, std::uint64_t seed) {
  const Slope slope = random_slope(random);
  const double width = random.uniform(0.5, 1.0), height = random.uniform(0.1, 0.2),
               mu = random.uniform(0.05, 0.3), v = random.uniform(0.5, 2.0), end = random.uniform(0.2, 1.0),
               stop = v / (mu * kGravity), t = std::min(end, stop), way = v * t - 0.5 * mu * kGravity * t * t;
  std::vector<Block> blocks(3);
  for (std::size_t k = 0; k < 3; ++k) {
    Block& b = blocks[k];
    b.width = k < 2 ? width : 2.0 * width;
    b.height = height;
    b.friction = 0.9;
    b.velocity = v;
    b.place = k < 2 ? Vec2((static_cast<double>(k) - 0.5) * width, 0.5 * height) : Vec2(0.0, 1.5 * height);
  }
  return fault_of(scene_of(slope, end, 0.0, random_restitution(random), mu, blocks, random.below(2)), slope,
                  blocks, {way, way, way}, seed);
}

/// Where a table that is shaken up and down has thrown what lies on it, which lands without a rebound: how high above its place at
/// the beginning [m].
class Shaken {
 public:
  Shaken(double reach, double pace, double phase) : reach_(reach), pace_(pace), phase_(phase) {}
  double table(double t) const { return reach_ * (std::sin(pace_ * t + phase_) - std::sin(phase_)); }
  double speed(double t) const { return reach_ * pace_ * std::cos(pace_ * t + phase_); }
  std::string formula() const {
    return fmt::format("{0:.17g}*(sin({1:.17g}*t + {2:.17g}) - sin({2:.17g}))", reach_, pace_, phase_);
  }

  /// `near`: the time to the nearest lift-off or landing.
  double thrown(double until, double& near) const {
    constexpr double kStep = 1e-4;
    near = until;
    bool flies = presses(0.0) < 0.0;
    double from = 0.0;
    for (double t = 0.0; t < until;) {
      const double next = std::min(t + kStep, until);
      const auto room = [&](double at) { return flies ? above(from, at) : presses(at); };
      // right after it has begun to fly it is no higher than the table, but for roundings
      const bool begins = flies && t - from < 2.0 * kStep;
      if (begins || room(next) > 0.0) {
        t = next;
        continue;
      }
      double low = t, high = next;
      for (int k = 0; k < 100; ++k) (room(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
      near = std::min(near, until - high);
      flies = !flies || presses(high) < 0.0;
      from = t = high;
    }
    return flies ? table(until) + above(from, until) : table(until);
  }

 private:
  double presses(double t) const { return kGravity - reach_ * pace_ * pace_ * std::sin(pace_ * t + phase_); }
  double above(double from, double t) const {
    const double s = t - from;
    return table(from) + speed(from) * s - 0.5 * kGravity * s * s - table(t);
  }
  double reach_, pace_, phase_;
};

/// One to four boxes on each other, of one width or narrower and narrower, on a table that throws them: they fly and land as one.
std::string shaken(Random& random, std::uint64_t seed) {
  for (;;) {
    const double pace = random.uniform(4.0, 15.0);
    const Shaken table(random.uniform(0.5, 2.5) * kGravity / (pace * pace), pace, random.uniform(0.0, 6.0));
    const double end = random.uniform(0.3, 1.2);
    double near = 0.0;
    const double high = table.thrown(end, near);
    if (near < 1e-3) continue;
    std::vector<Block> blocks(1 + random.below(4));
    double above = 0.0, width = random.uniform(0.5, 1.0);
    const bool flush = random.below(2) == 0;
    for (Block& b : blocks) {
      b.width = width;
      b.height = random.uniform(0.1, 0.3);
      b.mass = random.uniform(0.3, 3.0);
      b.friction = random.uniform(0.0, 0.8);
      b.place = {0.0, above + 0.5 * b.height};
      above += b.height;
      if (!flush) width *= random.uniform(0.5, 0.95);
    }
    std::string text = scene_of({}, end, 0.0, 0.0, 0.4, blocks, random.below(2));
    const auto put = [&](const std::string& after, const std::string& what) {
      const std::size_t at = text.find(after);
      text.insert(text.find('\n', at) + 1, what);
    };
    put("name = 'f'", "motion = { y = \"" + table.formula() + "\" }\n");
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const std::string name = fmt::format("name = 'b{}'", k);
      const std::size_t at = text.find("velocity = [", text.find(name));
      text.replace(at, text.find('\n', at) - at, fmt::format("velocity = [0, {:.17g}]", table.speed(0.0)));
      blocks[k].place.y() += high;
    }
    return fault_of(text, {}, blocks, std::vector<double>(blocks.size(), 0.0), seed, true);
  }
}

TEST(FlushMotions, AreFollowedByModesAlone) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      worlds = testing::from_environment("BRINK_WORLDS", 60);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed) {
    Random random(seed);
    const std::uint64_t kind = seed % 5;
    const std::string fault = kind < 2    ? stack(random, seed)
                              : kind == 2 ? train(random, seed)
                              : kind == 3 ? bridge(random, seed)
                                          : shaken(random, seed);
    EXPECT_EQ(fault, "") << (kind < 2    ? "stack"
                             : kind == 2 ? "train"
                             : kind == 3 ? "bridge"
                                         : "shaken")
                         << ", seed " << seed;
  }
}

}  // namespace
}  // namespace brink::flush_motions_test
