// Heaps of bent wires without thickness that hook into each other: V, U, hexagonal rings, rings with stars among them. No two
// wires may cross, at any of many frames; that is told here by signs of areas, from the bodies' poses alone, and shares no code
// with the core. What the program refuses to go on with is no crossing, but a crossing that it tells is one that it has made.
// BRINK_SEED moves the seeds, BRINK_WORLDS their number.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "tests/support/seeded_worlds.h"

namespace brink::wire_heaps_test {
namespace {

/// What buzzes longer is slow, and no crossing.
constexpr std::uint64_t kMostCollisions = 40000;

using Point = std::array<double, 2>;

struct Wire {
  std::string chain;          ///< as a scene has it
  std::vector<Point> points;  ///< from the centre of mass, which the scene is given
  bool closed = false;
};

/// A wire of uniform density along its length has its centre of mass here.
Point centre_of(const std::vector<Point>& p, bool closed) {
  double length = 0.0;
  Point sum{};
  const std::size_t count = closed ? p.size() : p.size() - 1;
  for (std::size_t k = 0; k < count; ++k) {
    const Point &a = p[k], &b = p[(k + 1) % p.size()];
    const double l = std::hypot(b[0] - a[0], b[1] - a[1]);
    length += l;
    for (int c = 0; c < 2; ++c) sum[c] += 0.5 * l * (a[c] + b[c]);
  }
  return {sum[0] / length, sum[1] / length};
}

Wire wire(std::vector<Point> points, bool closed) {
  Wire made;
  made.closed = closed;
  const Point centre = centre_of(points, closed);
  for (const Point& p : points) {
    made.points.push_back({p[0] - centre[0], p[1] - centre[1]});
    made.chain += fmt::format("{}[{:.17g}, {:.17g}]", made.chain.empty() ? "" : ", ", made.points.back()[0],
                              made.points.back()[1]);
  }
  made.chain = fmt::format("chain = {{ vertices = [{}], closed = {} }}", made.chain, closed);
  return made;
}

struct Heap {
  std::string text;
  std::vector<Wire> wires;  ///< of each body
  double duration = 1.0;
};

/// A bin of wire, or a solid drum that turns, between whose wall and a wire others are jammed.
enum class Around { bin, drum };

Heap heap_of(std::uint64_t seed, Around around, double restitution, double friction, double rolling) {
  Random random(seed);
  Heap heap;
  const double size = 0.15;
  const int kind = static_cast<int>(random.below(4));
  std::vector<Wire> kinds;
  const Wire vee = wire({{0.0, size}, {0.0, 0.0}, {size, 0.0}}, false);
  const Wire cup = wire({{0.0, 0.8 * size}, {0.0, 0.0}, {size, 0.0}, {size, 0.8 * size}}, false);
  std::vector<Point> hexagon;
  for (int k = 0; k < 6; ++k)
    hexagon.push_back({0.8 * size * std::cos(k * M_PI / 3.0), 0.8 * size * std::sin(k * M_PI / 3.0)});
  const Wire ring = wire(hexagon, true);
  if (kind == 0) kinds = {vee};
  if (kind == 1) kinds = {cup};
  if (kind == 2) kinds = {ring};
  if (kind == 3) kinds = {vee, cup, ring};
  const bool in_drum = around == Around::drum;
  const int count = 10 + (in_drum ? -1 : static_cast<int>(random.below(8)));
  heap.text = fmt::format(
      "[world]\nduration = {}\ngravity = [0, -9.81]\n[materials.default]\nrestitution = {}\nfriction = {}\n"
      "rolling_resistance = {}\n",
      heap.duration, restitution, friction, rolling);
  if (in_drum) {
    std::string vertices;
    for (int k = 0; k < 10; ++k)
      vertices += fmt::format("{}[{:.17g}, {:.17g}]", k > 0 ? ", " : "", 0.95 * std::cos(k * M_PI / 5.0),
                              0.95 * std::sin(k * M_PI / 5.0));
    heap.text += fmt::format(
        "[[sites]]\nname = 'drum'\npolygon = {{ vertices = [{}] }}\ninside_of = true\n"
        "motion = {{ angular_velocity = {} }}\n",
        vertices, random.uniform(-4.0, 4.0));
  } else {
    heap.text += "[[sites]]\nname = 'bin'\npolyline = [[-2, 8], [-2, 2], [0, 0], [2, 2], [2, 8]]\n";
  }
  for (int k = 0; k < count; ++k) {
    heap.wires.push_back(kinds[random.below(kinds.size())]);
    // far enough apart at first, whatever their angles
    const double x = 0.42 * (k % 3 - 1) + random.uniform(-0.03, 0.03),
                 y = (in_drum ? -0.42 : 0.9) + 0.42 * (k / 3);
    heap.text += fmt::format(
        "[[bodies]]\n{}\nmass = 0.4\ninertia = 0.002\nposition = [{}, {}]\nangle = {}\nvelocity = [{}, {}]\n"
        "angular_velocity = {}\n",
        heap.wires.back().chain, x, y, random.uniform(0.0, 6.28), random.uniform(-1.0, 1.0),
        random.uniform(-4.0, 0.0), random.uniform(-6.0, 6.0));
  }
  return heap;
}

double area(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// How far the nearest end of two segments that cross reaches through the other's line [m]; 0: they do not cross.
double through(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double ab = std::hypot(b[0] - a[0], b[1] - a[1]), cd = std::hypot(d[0] - c[0], d[1] - c[1]);
  const double at_c = area(a, b, c) / ab, at_d = area(a, b, d) / ab, at_a = area(c, d, a) / cd,
               at_b = area(c, d, b) / cd;
  if (at_c * at_d >= 0.0 || at_a * at_b >= 0.0) return 0.0;
  return std::min({std::abs(at_a), std::abs(at_b), std::abs(at_c), std::abs(at_d)});
}

/// The deepest crossing of any two at any frame.
class Crossings : public Recorder {
 public:
  explicit Crossings(const std::vector<Wire>& wires) : wires_(&wires) {}
  double deepest() const { return deepest_; }
  double when() const { return when_; }
  int frames() const { return frames_; }

  void frame(double t, std::span<const BodyState> states) override {
    ++frames_;
    std::vector<std::vector<Point>> placed;
    for (std::size_t k = 0; k < wires_->size(); ++k) {
      const Pose& pose = states[k].pose;
      const double c = std::cos(pose.angle), s = std::sin(pose.angle);
      placed.emplace_back();
      for (const Point& p : (*wires_)[k].points)
        placed.back().push_back(
            {pose.position.x() + c * p[0] - s * p[1], pose.position.y() + s * p[0] + c * p[1]});
      if ((*wires_)[k].closed) placed.back().push_back(placed.back().front());
    }
    for (std::size_t i = 0; i < placed.size(); ++i)
      for (std::size_t j = i + 1; j < placed.size(); ++j)
        for (std::size_t a = 0; a + 1 < placed[i].size(); ++a)
          for (std::size_t b = 0; b + 1 < placed[j].size(); ++b)
            if (const double deep = through(placed[i][a], placed[i][a + 1], placed[j][b], placed[j][b + 1]);
                deep > deepest_)
              deepest_ = deep, when_ = t;
  }

 private:
  const std::vector<Wire>* wires_;
  double deepest_ = 0.0, when_ = 0.0;
  int frames_ = 0;
};

/// Each in its own materials: restitution 0 or not, with friction or without, hard to roll or not.
void pile_up(std::uint64_t seed, Around around) {
  Random random(seed + 77777);
  const double restitution = random.below(2) ? 0.3 : 0.0, friction = random.below(2) ? 0.3 : 0.0,
               rolling = random.below(2) ? 0.02 : 0.0;
  const Heap heap = heap_of(seed, around, restitution, friction, rolling);
  const Scene scene = parse_scene(heap.text, "wires");
  for (std::size_t k = 0; k < heap.wires.size(); ++k)
    // else the outline is not where its points are said to be
    ASSERT_LE(scene.world.bodies[k].outline->sites.front().a.norm(), 1.0);
  Simulator simulator(scene.world, scene.solver);
  Crossings crossings(heap.wires);
  RunOptions options;
  options.until = heap.duration;
  options.frame_interval = 1e-3;
  options.progress = [](double, std::uint64_t collisions) { return collisions < kMostCollisions; };
  const RunSummary summary = simulator.run(options, &crossings);
  const std::string of =
      fmt::format("BRINK_SEED={} BRINK_WORLDS=1, e = {}, mu = {}, rolling {}: at {}: {}", seed, restitution,
                  friction, rolling, summary.end_time, summary.termination_text());
  EXPECT_GT(crossings.frames(), 10) << of;
  // of places that are rounded to doubles, and the contact tolerance
  EXPECT_LE(crossings.deepest(), 1e-9) << of << ", at t = " << crossings.when();
  // In a drum steps may miss a gap by the tolerance and some roundings, which the watch tells: no one has gone through.
  const double missed = around == Around::drum ? 1.1e-10 * scene.world.length() : 0.0;
  EXPECT_TRUE(summary.why.find("cross") == std::string::npos || summary.max_overlap <= missed) << of;
  if (summary.termination == Termination::failed) fmt::print("ended early: {}\n", of);
}

void pile_up_all(std::uint64_t worlds, Around around) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1);
  worlds = testing::from_environment("BRINK_WORLDS", worlds);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed) pile_up(seed, around);
}

TEST(WireHeaps, NoTwoCross) { pile_up_all(6, Around::bin); }

TEST(WireHeaps, NoTwoCrossInADrum) { pile_up_all(4, Around::drum); }

}  // namespace
}  // namespace brink::wire_heaps_test
