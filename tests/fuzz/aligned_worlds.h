#pragma once
/// Worlds as people draw them by hand: boxes whose places, sizes and velocities are quarters of a metre, on wires and
/// blocks: flush on each other, corner on corner, at the ends of wires, at rest or not. Nothing there is in general
/// position.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "brink/scheduler/policies/policy.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/seeded_random.h"
#include "tests/support/worlds.h"

namespace brink::aligned {

struct AlignedWorld {
  World world;
  SolverOptions options;
};

class AlignedWorldMaker {
 public:
  explicit AlignedWorldMaker(std::uint64_t seed) : random_(seed) {}

  AlignedWorld make() {
    World& w = made_.world;
    w.gravity = {0.0, -pick({8.0, 8.0, 8.0, 0.0})};
    w.materials[0].restitution = pick({0.0, 0.5, 1.0});
    w.materials[0].friction = pick({0.0, 0.0, 0.5});
    ground();
    walls();
    if (random_.below(2)) block(0.5 * std::floor(random_.uniform(-6.0, 5.0)));
    const std::size_t most = 1 + random_.below(7);
    for (std::size_t k = 0; k < 6 * most && w.bodies.size() < most; ++k) add_body();
    made_.options.order = orders()[random_.below(orders().size())].name;
    made_.options.persistent = random_.below(4) != 0;
    made_.options.max_collisions = 20000;
    return made_;
  }

 private:
  double pick(std::initializer_list<double> of) { return *(of.begin() + random_.below(of.size())); }

  void solid(const std::vector<Vec2>& corners) {
    testing::add(made_.world, testing::site(make_polygon(corners)));
  }
  void wire(const Vec2& a, const Vec2& b) { testing::add(made_.world, testing::site(make_segment(a, b))); }

  void ground() {
    switch (random_.below(3)) {
      case 0:
        return wire({-4, 0}, {4, 0});
      case 1:
        wire({-4, 0}, {0, 0});
        return wire({0, 0}, {4, 0});
      default:
        return solid({{-4, -1}, {4, -1}, {4, 0}, {-4, 0}});
    }
  }
  void walls() {
    if (random_.below(2)) {
      wire({-4, 0}, {-4, 6});
      wire({4, 0}, {4, 6});
    } else {
      solid({{-5, 0}, {-4, 0}, {-4, 6}, {-5, 6}});
      solid({{4, 0}, {5, 0}, {5, 6}, {4, 6}});
    }
  }
  void block(double x) {
    solid({{x, 0}, {x + 1, 0}, {x + 1, 1}, {x, 1}});
    taken_.push_back({{x, 0}, {x + 1, 1}});
  }

  /// Where it may touch others, but is in none.
  void add_body() {
    const double width = pick({0.5, 1.0, 1.0, 2.0}), height = pick({0.5, 1.0, 1.0});
    const double x = 0.25 * std::floor(random_.uniform(-16.0, 16.999 - 4.0 * width)),
                 y = 0.25 * std::floor(random_.uniform(0.0, 16.0));
    const Box box{{x, y}, {x + width, y + height}};
    const auto meets = [&](const Box& b) {
      return box.low.x() < b.high.x() && b.low.x() < box.high.x() && box.low.y() < b.high.y() &&
             b.low.y() < box.high.y();
    };
    if (x + width > 4.0 || std::any_of(taken_.begin(), taken_.end(), meets)) return;
    taken_.push_back(box);
    const Vec2 velocity(pick({0, 0, 0, -1, -0.5, 0.5, 1}), pick({0, 0, 0, -1, 1, 0.5}));
    const Shape shape = random_.below(5) ? make_box(width, height) : make_disc(0.5 * std::min(width, height));
    Body body = testing::body(shape, box.center(), velocity);
    body.lock_angle = random_.below(2) == 1;
    testing::add(made_.world, body);
  }

  SeededRandom random_;
  AlignedWorld made_;
  std::vector<Box> taken_;
};

struct Tally {
  int runs = 0, failed = 0, overlaps = 0, different = 0, zeno = 0;
};

inline std::ostream& operator<<(std::ostream& out, const Tally& t) {
  return out << t.runs << " worlds: " << t.failed << " ended by a fault, " << t.overlaps << " with overlaps, "
             << t.different << " differ under another policy, " << t.zeno << " end as Zeno\n";
}

/// Two seconds of a world, looked at from outside at every frame, and once more under another exact policy, stopped at
/// every quarter of a second, where much happens at once. True if nothing is wrong.
inline bool run(std::uint64_t seed, Tally& tally) {
  const AlignedWorld a = AlignedWorldMaker(seed).make();
  outside::FrameWatch watch(a.world, 2.0, 1e-9);
  RunOptions options = testing::until(2.0);
  options.frame_interval = 0.02;
  const auto begin = std::chrono::steady_clock::now();
  options.progress = [&](double, std::uint64_t) {
    return std::chrono::steady_clock::now() - begin < std::chrono::seconds(60);
  };
  Simulator simulator(a.world, a.options);
  const RunSummary s = simulator.run(options, &watch);
  const bool zeno = s.why.find("Zeno") != std::string::npos;
  const bool failed = s.termination == Termination::failed && !(zeno && !a.options.persistent);
  SolverOptions other = a.options;
  other.policy = exact_policies()[seed % exact_policies().size()];
  Simulator again(a.world, other);
  RunSummary t;
  for (int quarter = 1; quarter <= 8; ++quarter) {
    options.until = 0.25 * quarter;
    t = again.run(options);
    if (t.termination != Termination::reached_end) break;
  }
  const bool differs = t.state_hash != s.state_hash || t.termination != s.termination;
  ++tally.runs;
  tally.failed += failed;
  tally.zeno += zeno;
  tally.overlaps += !failed && !watch.sound();
  tally.different += differs;
  if (failed) std::cout << "seed " << seed << ": " << s.why << '\n';
  if (!failed && !watch.sound()) std::cout << "seed " << seed << ": " << watch.report() << '\n';
  if (differs) std::cout << "seed " << seed << ": differs under " << other.policy << '\n';
  return !failed && !differs && watch.sound();
}

}  // namespace brink::aligned
