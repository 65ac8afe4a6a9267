/// The way of an outline to its first contact, against known ways, and against gaps along the way that share no
/// code.
#include "brink/core/query/cast_outline.h"

#include <gtest/gtest.h>

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "brink/core/base/error.h"
#include "brink/core/base/random.h"
#include "brink/core/query/outline_gap.h"
#include "brink/core/shapes/shapes.h"
#include "tests/unit/query/query_shapes.h"

namespace brink::cast_outline_test {
namespace {

constexpr double pi = std::numbers::pi;
using Status = OutlineHit::Status;

double way(const Outline& a, const Pose& pose_a, const Vec2& direction, const Outline& b,
           const Pose& pose_b = {}) {
  const OutlineHit hit = cast_outline(a, pose_a, direction, b, pose_b);
  return hit.status == Status::touches ? hit.distance : hit.status == Status::passes ? -1.0 : -2.0;
}

// From (3, 10) down, with radii 3 + 2 = 5: the centres are 5 apart at (3, 4).
TEST(CastOutline, DiscsMeetAtTheSumOfTheirRadii) {
  const Outline small = make_disc(2.0).outline, large = make_disc(3.0).outline;
  EXPECT_NEAR(way(small, {{3, 10}, 0.7}, {0, -1}, large), 6.0, 1e-14);
  EXPECT_NEAR(way(small, {{3, 10}, 0.7}, {0, 1}, large), -1.0, 0.0);  // it moves away
  EXPECT_EQ(way(small, {{6, 10}, 0.7}, {0, -1}, large), -1.0);        // it passes, 1 m beside
}

TEST(CastOutline, ABoxOnABoxOfItsOwnWidthLiesOnItExactly) {
  const Outline box = make_box(1.0, 1.0).outline;
  EXPECT_EQ(way(box, {{0, 8}, 0.0}, {0, -1}, box), 7.0);
  EXPECT_EQ(way(box, {{0.25, 8}, 0.0}, {0, -1}, box), 7.0);
  EXPECT_EQ(way(box, {{0, 1}, 0.0}, {0, -1}, box), 0.0);  // touches where it starts
  EXPECT_EQ(way(box, {{0, 1}, 0.0}, {0, 1}, box), -1.0);  // and leaves
  EXPECT_EQ(way(box, {{0.5, 0.5}, 0.0}, {0, 1}, box), -2.0);
  EXPECT_EQ(way(box, {{1.0, 8}, 0.0}, {0, -1}, box), -1.0);  // down along its side: it slides past
}

// Parallelograms, whose slanted sides come to lie on each other; a ledge 1e-6 below a corner that is grazed.
TEST(CastOutline, FlushSidesAndGrazedCornersAreTold) {
  const Outline slant = make_polygon({{0, 0}, {1, 0}, {3, 0.5}, {2, 0.5}}).outline;
  EXPECT_NEAR(way(slant, {{8, 0}, 0.0}, {-1, 0}, slant), 7.0, 1e-15);
  const Outline steps =
      make_polygon({{-1, -1}, {2, -1}, {2, -1e-6}, {0.5, -1e-6}, {0.5, 0}, {-1, 0}}).outline;
  const Outline box = make_box(1.0, 1.0).outline;
  EXPECT_NEAR(way(box, {{1, 2}, 0.0}, {0, -1}, steps), 1.5 + 1e-6, 1e-15);
  EXPECT_NEAR(way(box, {{1 - 1e-9, 2}, 0.0}, {0, -1}, steps), 1.5, 1e-15);
}

// A floor without thickness; a corner of a box turned by 45 degrees is sqrt(1/2) below its centre.
TEST(CastOutline, AWireIsMetByFacesAndByCorners) {
  const Outline box = make_box(1.0, 1.0).outline, floor = make_segment({-5, 0}, {5, 0}).outline;
  EXPECT_EQ(way(box, {{1, 2}, 0.0}, {0, -1}, floor), 1.5);
  EXPECT_NEAR(way(box, {{1, 2}, pi / 4}, {0, -1}, floor), 2.0 - std::sqrt(0.5), 1e-15);
  EXPECT_EQ(way(box, {{1, -2}, 0.0}, {0, 1}, floor), 1.5);  // from below
  const Outline flush = make_segment({-0.5, 0}, {0.5, 0}).outline;
  EXPECT_EQ(way(box, {{0, 2}, 0.0}, {0, -1}, flush), 1.5);
}

// A disc of radius 1 falls into a bowl of radius 3 about the origin, 1 beside its middle: the centres are 2 apart
// then, sqrt(3) below. Through the open top; from beside, it meets the rim's end first.
TEST(CastOutline, ADiscFallsIntoABowl) {
  const Outline ball = make_disc(1.0).outline, bowl = make_arc({0, 0}, 3.0, pi, 2 * pi).outline;
  EXPECT_NEAR(way(ball, {{1, 10}, 0.0}, {0, -1}, bowl), 10.0 + std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(way(ball, {{3, 10}, 0.0}, {0, -1}, bowl), 9.0, 1e-14);
  const Outline room = make_disc_container(3.0).outline;
  EXPECT_NEAR(way(ball, {{1, 0}, 0.0}, {0, -1}, room), std::sqrt(3.0), 1e-14);
}

// The round side of a thin half ring, not the whole of its circle, comes down on a post inside of it.
TEST(CastOutline, AnArcIsThereInItsSectorAlone) {
  const Outline arch = make_arc({0, 0}, 3.0, 0.0, pi, 0.1).outline, post = make_box(1.0, 2.0).outline;
  EXPECT_NEAR(way(arch, {{0, 9}, 0.0}, {0, -1}, post), 9.0 + std::sqrt(2.9 * 2.9 - 0.25) - 1.0, 1e-14);
}

// 1 / sqrt(2) written with nine digits is 2.6e-10 short.
// Of an ellipse's flat arcs the lowest place is near the end of one: the next one's circle would come down before it.
TEST(CastOutline, FlatArcsComeDownToWhereTheyTouch) {
  Random random(3);
  const Outline floor = make_box(80.0, 2.0).outline;
  for (int k = 0; k < 300; ++k) {
    const double a = random.uniform(0.3, 0.8), b = a * random.uniform(0.4, 0.9);
    const std::string arc = fmt::format("A {:.17g} {:.17g} 0 0 0 ", a, b);
    const Outline ellipse =
        make_path(fmt::format("M {0:.17g} 0 {1} {2:.17g} 0 {1} {0:.17g} 0 Z", -a, arc, a), 1.0, 1e-4).outline;
    const Pose pose{{0.0, 3.0}, random.uniform(0.0, 6.0)};
    const double down = way(ellipse, pose, {0, -1}, floor, {{0.0, -1.0}, 0.0});
    const double gap =
        outline_gap(ellipse, {pose.position - Vec2(0.0, down), pose.angle}, floor, {{0.0, -1.0}, 0.0}).gap;
    EXPECT_NEAR(gap, 0.0, 1e-10) << k;
  }
}

TEST(CastOutline, ADirectionOfNearlyUnitLengthCountsAsUnit) {
  const Outline ball = make_disc(1.0).outline;
  EXPECT_NEAR(way(ball, {{-7, -7}, 0.0}, {0.707106781, 0.707106781}, ball), 7 * std::sqrt(2.0) - 2, 1e-14);
  EXPECT_NEAR(way(ball, {{-7, -7}, 2.0}, {0.707106782, 0.707106781}, ball), 7 * std::sqrt(2.0) - 2, 1e-14);
}

TEST(CastOutline, PlacesTooFarToHaveADistanceAreRefused) {
  const Outline ball = make_disc(1.0).outline;
  EXPECT_THROW(cast_outline(ball, {{1e200, 0}, 0.0}, {-1, 0}, ball, {}), BadInput);
}

TEST(CastOutline, ADirectionThatIsNoUnitVectorIsRefused) {
  const Outline ball = make_disc(1.0).outline;
  EXPECT_THROW(cast_outline(ball, {}, {0, -2}, ball, {}), BadInput);
  EXPECT_THROW(cast_outline(ball, {}, {NAN, 0}, ball, {}), BadInput);
}

// A wire that is the graph of a function comes down by its least height over another, also where it is the same graph: the
// two are clear of each other before and after.
struct Graph {
  std::vector<Vec2> vertices;  // from left to right

  double height(double x) const {
    for (std::size_t k = 1; k < vertices.size(); ++k) {
      const Vec2 &a = vertices[k - 1], &b = vertices[k];
      if (x <= b.x()) return a.y() + (b.y() - a.y()) * (x - a.x()) / (b.x() - a.x());
    }
    return vertices.back().y();
  }
};

double least_height(const Graph& over, const Graph& under) {
  double least = INFINITY;
  for (const Graph* of : {&over, &under})
    for (const Vec2& p : of->vertices)
      if (p.x() >= std::max(over.vertices.front().x(), under.vertices.front().x()) &&
          p.x() <= std::min(over.vertices.back().x(), under.vertices.back().x()))
        least = std::min(least, over.height(p.x()) - under.height(p.x()));
  return least;
}

Graph random_graph(Random& random) {
  Graph graph;
  double x = random.uniform(-0.5, 0.0);
  for (int k = 0, n = 2 + static_cast<int>(random.below(5)); k < n; ++k, x += random.uniform(0.05, 0.5))
    graph.vertices.emplace_back(x, random.uniform(-0.4, 0.4));
  return graph;
}

TEST(CastOutline, WiresComeDownByTheLeastHeightOfTheirGraphs) {
  Random random(506);
  for (int k = 0; k < 400; ++k) {
    SCOPED_TRACE(k);
    const Graph under = random_graph(random);
    Graph over = k % 2 == 0 ? under : random_graph(random);
    // Flat parts on flat parts, of one width or not.
    if (k % 4 == 1)
      for (Vec2& p : over.vertices) p.y() = 0.25;
    const Outline a = make_chain(over.vertices).outline, b = make_chain(under.vertices).outline;
    const double angle = random.uniform(-4.0, 4.0), up = random.uniform(1.0, 9.0);
    const Frame turned({Vec2::Zero(), angle});
    const Vec2 place = turned.to_world({0.0, up}), down = turned.direction_to_world({0.0, -1.0});
    const double least = least_height(over, under);
    EXPECT_NEAR(way(a, {place, angle}, down, b, {Vec2::Zero(), angle}), std::isinf(least) ? -1.0 : up + least,
                1e-13);
  }
}

TEST(CastOutline, ArcsOfOneFormLieInEachOther) {
  Random random(507);
  for (int k = 0; k < 100; ++k) {
    SCOPED_TRACE(k);
    const double middle = (k % 2 == 0 ? 0.5 : 1.5) * pi, half = random.uniform(0.1, 1.4),
                 up = random.uniform(2, 9);
    const Outline arc = make_arc({0, 0}, random.uniform(0.2, 1.5), middle - half, middle + half).outline;
    EXPECT_NEAR(way(arc, {{0, up}, 0.0}, {0, -1}, arc), up, 1e-14);
    EXPECT_NEAR(way(arc, {{0, -up}, 0.0}, {0, 1}, arc), up, 1e-14);
    EXPECT_EQ(way(arc, {{0, up}, 0.0}, {0, 1}, arc), -1.0);
  }
}

class AlongTheWay {
 public:
  AlongTheWay(const Outline& a, const Pose& pose_a, const Vec2& direction, const Outline& b,
              const Pose& pose_b)
      : a_(outside::shape_of(a)), b_(outside::shape_of(b)), pose_a_(pose_a), pose_b_(pose_b), d_(direction) {}

  double gap(double distance) const {
    const outside::Vec at = outside::vec(pose_a_.position) + outside::vec(d_) * distance;
    return static_cast<double>(
        outside::gap(a_, {at, pose_a_.angle}, b_, {outside::vec(pose_b_.position), pose_b_.angle}));
  }
  double least_before(double distance) const {
    double least = gap(0.0);
    for (int k = 1; k < 50; ++k) least = std::min(least, gap(distance * k / 50.0));
    return least;
  }

 private:
  outside::Shape a_, b_;
  Pose pose_a_, pose_b_;
  Vec2 d_;
};

TEST(CastOutline, GapsAlongTheWayAgree) {
  constexpr std::uint64_t seed = 505;
  Random random(seed);
  const std::vector<NamedOutline> outlines = query_outlines();
  int touching = 0, passing = 0, inside = 0;
  for (const NamedOutline& a : outlines)
    for (const NamedOutline& b : outlines)
      for (int k = 0; k < 4; ++k) {
        if (a.outline.container) continue;
        SCOPED_TRACE(a.name + " to " + b.name + ", case " + std::to_string(k) + ", seed " +
                     std::to_string(seed));
        const double heading = random.uniform(0, 2 * pi);
        const Vec2 d(std::cos(heading), std::sin(heading));
        const double back = b.outline.container ? 0.0 : 6.0;
        const Pose pose_b{anywhere(random, 2.0), random.uniform(-9, 9)};
        const Pose pose_a{pose_b.position - back * d + anywhere(random, b.outline.container ? 0.5 : 1.5),
                          random.uniform(-9, 9)};
        const OutlineHit hit = cast_outline(a.outline, pose_a, d, b.outline, pose_b);
        const AlongTheWay reference(a.outline, pose_a, d, b.outline, pose_b);
        const double noise = 1e-12 + looseness(a.outline) + looseness(b.outline);
        if (hit.status == Status::overlaps) {
          EXPECT_LE(reference.gap(0.0), noise);
          ++inside;
        } else if (hit.status == Status::touches) {
          EXPECT_NEAR(reference.gap(hit.distance), 0.0, noise);
          EXPECT_GE(reference.least_before(hit.distance), -noise);
          // Roundings before and after the touch as well: no closer place may be overlooked there.
          for (const double before : {1e-9, 1e-12, 1e-14, 1e-15, 0.0, -1e-15}) {
            const double way = hit.distance - before;
            const Pose there{pose_a.position + way * d, pose_a.angle};
            const double gap = outline_gap(a.outline, there, b.outline, pose_b).gap, is = reference.gap(way);
            // How deep they overlap has several measures; that they do has one.
            EXPECT_LE(gap, is + noise) << before << " before the touch";
            EXPECT_TRUE(gap >= is - noise || is <= noise)
                << gap << " is not " << is << ", " << before << " before";
          }
          ++touching;
        } else {
          EXPECT_GE(reference.least_before(20.0), -noise);
          ++passing;
        }
      }
  EXPECT_GT(touching, 500);
  EXPECT_GT(passing, 50);
  EXPECT_GT(inside, 50);
}

}  // namespace
}  // namespace brink::cast_outline_test
