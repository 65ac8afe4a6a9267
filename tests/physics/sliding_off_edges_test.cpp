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

}  // namespace
}  // namespace brink::sliding_off_edges_test
