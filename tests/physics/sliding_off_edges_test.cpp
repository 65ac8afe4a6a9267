// Boxes that slide flat off the edges of tables, wedges, bent wires and necks: once the box is off, nothing pushes it, so that its
// twist changes by gravity alone; how far off it is is told here from poses, by distances of segments. The same bits under
// every policy and from any snapshot. BRINK_SEED moves the seeds, BRINK_WORLDS their number; BRINK_KEEP names a folder
// for the scenes that fail.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "tests/support/seeded_worlds.h"

namespace brink::sliding_off_edges_test {
namespace {

constexpr double kGravity = 9.81;
/// What is farther off than this touches nobody [m]: contacts end within some 1e-10 of the sizes beyond an edge.
constexpr double kOff = 1e-8;
constexpr double kFrame = 2e-3;  ///< [s]

using Points = std::vector<Vec2>;

struct Edge {
  Points line;  ///< of the site, closed by repeating its first
  double wide = 0.0, high = 0.0;
  std::string text;
};

std::string list_of(const Points& points) {
  std::string text;
  for (const Vec2& p : points)
    text += fmt::format("{}[{:.17g}, {:.17g}]", text.empty() ? "" : ", ", p.x(), p.y());
  return text;
}

Edge edge(std::uint64_t seed) {
  Random random(seed);
  Edge made;
  const bool level = random.below(2) == 0;
  const double slope = level ? 0.0 : random.uniform(0.4, 1.0);
  const Vec2 along(std::cos(slope), -std::sin(slope)), out(std::sin(slope), std::cos(slope));
  const Points ground{-2.0 * along, {0.0, 0.0}};
  std::string site;
  switch (random.below(6)) {
    case 0:  // a solid's edge, of whatever angle
      made.line = {ground[0], -2.0 * along - 1.0 * out, random.uniform(-1.5, 0.0) * along - 1.0 * out,
                   ground[1]};
      site = "polygon = { vertices = [" + list_of(made.line) + "] }";
      made.line.push_back(made.line.front());
      break;
    case 1:  // a thin sheet
      made.line = {ground[0], -2.0 * along - 0.02 * out, -0.02 * out, ground[1]};
      site = "polygon = { vertices = [" + list_of(made.line) + "] }";
      made.line.push_back(made.line.front());
      break;
    case 2:  // a wire's free end
      made.line = ground;
      site = "polyline = [" + list_of(made.line) + "]";
      break;
    case 3: {  // a bent wire
      const double turn = random.uniform(0.1, 3.0);
      made.line = {ground[0], ground[1], 0.8 * (std::cos(turn) * along - std::sin(turn) * out)};
      site = "polyline = [" + list_of(made.line) + "]";
      break;
    }
    case 4:  // one that is folded back
      made.line = {ground[0], ground[1], {ground[0].x(), ground[0].y() - random.uniform(0.5, 2.0)}};
      site = "polyline = [" + list_of(made.line) + "]";
      break;
    default: {  // a neck
      const double deep = random.uniform(0.05, 0.3);
      made.line = {ground[0], ground[1], {0.0, -deep}, {-2.0 * along.x(), -deep + 2.0 * along.y() - 0.1}};
      site = "chain = { vertices = [" + list_of(made.line) + "] }";
    }
  }
  made.wide = random.uniform(0.08, 0.3);
  made.high = random.uniform(0.05, 0.2);
  const double before = random.uniform(0.2, 0.5), friction = std::array{0.0, 0.1, 0.3}[random.below(3)];
  const double speed =
      random.uniform(0.0, 3.0) + (level ? 0.5 + std::sqrt(2.0 * friction * kGravity * before) : 0.0);
  const Vec2 place = -before * along + (0.5 * made.high + 0.1) * out;
  made.text = fmt::format(
      "[world]\nduration = 1\ngravity = [0, -{}]\n[materials.default]\nrestitution = {}\nfriction = {}\n"
      "[[sites]]\nname = 'edge'\n{}\n[[bodies]]\nbox = {{ width = {:.17g}, height = {:.17g} }}\n"
      "position = [{:.17g}, {:.17g}]\nangle = {:.17g}\nvelocity = [{:.17g}, {:.17g}]\ntouching = 'edge'\n"
      "touching_direction = [{:.17g}, {:.17g}]\n",
      kGravity, std::array{0.0, 0.2, 0.5}[random.below(3)], friction, site, made.wide, made.high, place.x(),
      place.y(), -slope, speed * along.x(), speed * along.y(), -out.x(), -out.y());
  return made;
}

double distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const double part = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - part * (b - a)).norm();
}

/// Of two that do not cross [m].
double distance(const Points& p, const Points& q) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [one, other] : {std::pair(&p, &q), std::pair(&q, &p)})
    for (const Vec2& v : *one)
      for (std::size_t k = 0; k + 1 < other->size(); ++k)
        least = std::min(least, distance(v, (*other)[k], (*other)[k + 1]));
  return least;
}

/// Holds the twist from frame to frame against gravity's.
class Off : public Recorder {
 public:
  explicit Off(const Edge& edge) : edge_(&edge) {}
  void event(const Event& event) override {
    if (event.kind == EventKind::lift) {
      ++lifts;
      farthest_lift = std::max(farthest_lift, event.contact.gap);
    }
    if (event.kind == EventKind::collision) last_collision_ = event.contact.time;
  }
  void frame(double t, std::span<const BodyState> states) override {
    const BodyState& now = states[0];
    const double w = 0.5 * edge_->wide, h = 0.5 * edge_->high;
    Points box;
    for (const Vec2& v : {Vec2(-w, -h), Vec2(w, -h), Vec2(w, h), Vec2(-w, h), Vec2(-w, -h)})
      box.push_back(now.pose.position + Eigen::Rotation2Dd(now.pose.angle) * v);
    const bool off = distance(box, edge_->line) > kOff;
    if (off && was_off_ && last_collision_ <= before_t_) {
      const Vec2 dv = now.twist.velocity - before_.velocity + Vec2(0.0, kGravity * (t - before_t_));
      worst = std::max({worst, dv.norm(), w * std::abs(now.twist.omega - before_.omega)});
      ++intervals;
    }
    before_ = now.twist;
    before_t_ = t;
    was_off_ = off;
  }

  double worst = 0.0, farthest_lift = 0.0;
  int intervals = 0, lifts = 0;

 private:
  const Edge* edge_;
  Twist before_;
  double before_t_ = 0.0, last_collision_ = -1.0;
  bool was_off_ = false;
};

TEST(SlidingOffEdges, NothingPushesWhatIsOff) {
  const auto text_of = [](std::uint64_t seed) { return edge(seed).text; };
  int intervals = 0, lifts = 0;
  testing::for_each_world(40, text_of, [&](std::uint64_t seed) {
    const Edge world = edge(seed);
    const Scene scene = parse_scene(world.text, "edge");
    Off off(world);
    RunOptions options = testing::until(scene.duration);
    options.frame_interval = kFrame;
    const RunSummary told = Simulator(scene.world, scene.solver).run(options, &off);
    EXPECT_EQ(told.termination, Termination::reached_end) << told.why;
    EXPECT_LE(off.worst, 1e-9);
    EXPECT_LE(off.farthest_lift, 1e-8);
    intervals += off.intervals;
    lifts += off.lifts;
    testing::expect_same_bits(world.text, seed);
  });
  EXPECT_GT(intervals, 100);
  EXPECT_GT(lifts, 20);
}

/// What stands on a tip, or on the end of a wire, and slides over a level floor off its edge without friction; floor and all are
/// moved by that velocity [m/s].
std::string on_a_tip(std::uint64_t seed, const Vec2& moved) {
  Random random(seed);
  const double long_ = random.uniform(0.2, 0.6), thin = random.uniform(0.03, 1.0),
               side = random.below(2) ? 1.0 : -1.0, leans = random.uniform(0.02, 0.6);
  const auto at = [&](double radius, double angle) {
    return fmt::format("[{:.17g}, {:.17g}]", side * radius * std::cos(angle), radius * std::sin(angle));
  };
  const double place = -random.uniform(0.02, 0.2), speed = random.uniform(1.0, 4.0);
  const bool by_formula = random.below(2) == 0;
  std::string shape, site;
  switch (random.below(4)) {
    case 0:  // a wedge, the tip at the origin, its lower side up by `leans`
      shape = side > 0.0 ? at(long_, leans) + ", " + at(long_, leans + thin)
                         : at(long_, leans + thin) + ", " + at(long_, leans);
      shape = "polygon = { vertices = [[0, 0], " + shape + "] }\n";
      break;
    case 1:
      shape = "chain = { vertices = [[0, 0], " + at(long_, leans) + "] }\nmass = 1\n";
      break;
    case 2:  // two rods that meet
      shape = "chain = { vertices = [" + at(long_, leans) + ", [0, 0], " + at(long_, leans + thin) +
              "] }\nmass = 1\n";
      break;
    default: {  // an arc that rises from its end, and bends to either side
      const double radius = long_ * random.uniform(0.8, 3.0);
      shape =
          fmt::format("path = {{ d = 'M 0 0 A {} {} 0 0 {} {:.17g} {:.17g}' }}\nmass = 1\n", radius, radius,
                      random.below(2), side * long_ * std::cos(leans + 0.7), -long_ * std::sin(leans + 0.7));
    }
  }
  switch (random.below(3)) {
    case 0:
      site = "box = { width = 2, height = 0.5 }\nposition = [-1, -0.25]\n";
      break;
    case 1:
      site = "polygon = { vertices = [[-2, 0], [-2, -0.02], [0, -0.02], [0, 0]] }\n";
      break;
    default:
      site = "segment = [[-2, 0], [0, 0]]\n";
  }
  if (!moved.isZero(0.0))
    site += !by_formula ? fmt::format("motion = {{ velocity = [{}, {}] }}\n", moved.x(), moved.y())
                        : fmt::format("motion = {{ x = '{}*t', y = '{}*t' }}\n", moved.x(), moved.y());
  return fmt::format(
      "[world]\nduration = 0.2\ngravity = [0, -{}]\n[materials.default]\nrestitution = 0\nfriction = 0\n"
      "[[sites]]\nname = 'edge'\n{}[[bodies]]\n{}centered = false\nposition = [{}, 0.05]\ntouching = 'edge'\n"
      "velocity = [{}, {}]\n",
      kGravity, site, shape, place, speed + moved.x(), moved.y());
}

/// States at frames, and how often something was hit.
class Seen : public Recorder {
 public:
  void event(const Event& event) override { hits += event.kind == EventKind::collision; }
  void frame(double, std::span<const BodyState> all) override {
    states.push_back(all[0]);
    hits_before.push_back(hits);
  }
  std::vector<BodyState> states;
  std::vector<int> hits_before;
  int hits = 0;
};

Seen seen_on_a_tip(const std::string& text) {
  const Scene scene = parse_scene(text, "tip");
  RunOptions options = testing::until(scene.duration);
  options.frame_interval = kFrame;
  Seen seen;
  const RunSummary told = Simulator(scene.world, scene.solver).run(options, &seen);
  EXPECT_EQ(told.termination, Termination::reached_end) << told.why;
  return seen;
}

// The tip has no velocity into the floor where it leaves that, and what rises from it is clear of the edge: nothing pushes. Until
// something is hit energy is kept, and all is the same where everything moves along: a push of an instant would show in both.
TEST(SlidingOffEdges, WhatLeavesOnATipIsNotPushed) {
  const auto still = [](std::uint64_t seed) { return on_a_tip(seed, Vec2::Zero()); };
  int left = 0;
  testing::for_each_world(60, still, [&](std::uint64_t seed) {
    const Scene scene = parse_scene(still(seed), "tip");
    const double inertia = scene.world.bodies[0].inertia / scene.world.bodies[0].mass;
    const Seen at_rest = seen_on_a_tip(still(seed));
    Random random(seed + 1);
    const Vec2 moved(random.uniform(-3.0, 3.0), random.uniform(-2.0, 2.0));
    const Seen along = seen_on_a_tip(on_a_tip(seed, moved));
    ASSERT_EQ(at_rest.states.size(), along.states.size());
    for (std::size_t k = 0; k < at_rest.states.size(); ++k) {
      const auto energy = [&](const BodyState& s) {
        return 0.5 * s.twist.velocity.squaredNorm() + 0.5 * inertia * s.twist.omega * s.twist.omega +
               kGravity * s.pose.position.y();
      };
      const BodyState &a = at_rest.states[k], &b = along.states[k];
      EXPECT_TRUE(at_rest.hits_before[k] > 0 || std::abs(energy(a) - energy(at_rest.states[0])) < 1e-8)
          << k << ": " << energy(a) - energy(at_rest.states[0]);
      const Vec2 off = b.pose.position - a.pose.position - moved * (kFrame * static_cast<double>(k));
      EXPECT_LE(off.norm(), 1e-7) << k;
      EXPECT_NEAR(a.pose.angle, b.pose.angle, 1e-6) << k;
    }
    EXPECT_EQ(at_rest.hits, along.hits);
    if (seed % 4 == 0) testing::expect_same_bits(on_a_tip(seed, moved), seed);
    left += at_rest.hits == 0;
  });
  EXPECT_GT(left, 20);
}

}  // namespace
}  // namespace brink::sliding_off_edges_test
