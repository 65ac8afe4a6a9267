// Scenes that start touching: where bodies come to lie that are put on others, and rows that touch. Gaps are seen
// from outside.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "brink/scenes/scene/scene.h"
#include "tests/support/outside/worlds.h"

namespace brink::touching_test {
namespace {

using ::testing::HasSubstr;

const std::string kDown = "[world]\ngravity = [0, -9.81]\n";
const std::string kFloor = "[[sites]]\nname = \"floor\"\nsegment = [[-50, 0], [50, 0]]\n";

World read(const std::string& text) { return parse_scene(text, "test.toml").world; }

std::string fault_of(const std::string& text) {
  try {
    parse_scene(text, "test.toml");
  } catch (const SceneFaults& faults) {
    const SceneFault& f = faults.faults().front();
    return std::to_string(f.line) + ":" + std::to_string(f.column) + " " + f.message;
  }
  return "no fault";
}

/// How many pairs touch to `most`; every gap is at least `least`.
int touching_pairs(const World& world, double least, double most) {
  const std::vector<outside::Standing> things = outside::standing(world);
  int count = 0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    for (std::size_t j = i + 1; j < things.size(); ++j) {
      const double gap = outside::gap(things[i], things[j]);
      EXPECT_GE(gap, least) << i << " and " << j;
      count += gap <= most;
    }
  return count;
}

Vec2 place(const World& world, std::size_t k) { return world.bodies[k].initial.pose.position; }

TEST(Touching, ABallIsLetDownOntoTheFloor) {
  const World world = read(kDown + kFloor + R"([[bodies]]
disc = { radius = 0.5 }
position = [3, 7]
touching = "floor"
)");
  EXPECT_EQ(place(world, 0), Vec2(3, 0.5));
}

// On a wire itself a corner would be on no side of it: 3/4 of the touching distance, 1e-13 of the scene's
// length, is left.
TEST(Touching, CornersStandJustAboveAWire) {
  const World world = read(kDown + kFloor + R"([[bodies]]
box = { width = 3, height = 4 }
position = [0, 7]
touching = "floor"
)");
  EXPECT_GE(place(world, 0).y() - 2.0, 0.75 * 5e-13);
  EXPECT_LE(place(world, 0).y() - 2.0, 5e-13);
}

// A box of 20 degrees on a slope of 20 degrees, let down by gravity: its face lies on it, half its height away.
TEST(Touching, ABoxLiesOnASlopeOfItsOwnAngle) {
  const World world = read(kDown + R"([[sites]]
name = "slope"
box = { width = 20, height = 1 }
angle_deg = 20
[[bodies]]
box = { width = 1, height = 0.6 }
angle_deg = 20
position = [2, 9]
touching = "slope"
)");
  const double angle = 20.0 * std::numbers::pi / 180.0;
  EXPECT_EQ(place(world, 0).x(), 2.0);
  EXPECT_NEAR(place(world, 0).dot(Vec2(-std::sin(angle), std::cos(angle))), 0.8, 5e-15);
  EXPECT_EQ(touching_pairs(world, 0.0, 5e-15), 1);
}

// Two towers of unlike height, a plank on both: it meets the higher; written first, it is placed last.
TEST(Touching, BodiesAreLetDownInTheOrderInWhichTheyDepend) {
  const World world = read(kDown + kFloor + R"([[bodies]]
name = "plank"
box = { width = 6, height = 0.2 }
position = [0, 40]
touching = ["left", "right"]
[[bodies]]
name = "left"
box = { width = 1, height = 2 }
position = [-2, 30]
touching = "floor"
[[bodies]]
name = "right"
box = { width = 1, height = 2.5 }
position = [2, 20]
touching = "floor"
[[bodies]]
name = "ball"
disc = { radius = 0.25 }
position = [-1, 90]
touching = "plank"
)");
  EXPECT_NEAR(place(world, 1).y(), 1.0, 6e-13);
  EXPECT_NEAR(place(world, 2).y(), 1.25, 6e-13);
  EXPECT_NEAR(place(world, 0).y(), 2.6, 6e-13);
  EXPECT_NEAR(place(world, 3).y(), 2.95, 6e-13);
  EXPECT_EQ(touching_pairs(world, -1e-15, 6e-13), 4);
}

// Beside a disc, pulled to the left: centres at one height are the sum of the radii apart.
TEST(Touching, ADirectionTakesThePlaceOfGravity) {
  const World world = read(R"([[sites]]
name = "post"
disc = { radius = 2 }
[[bodies]]
disc = { radius = 1 }
position = [8, 0]
touching = "post"
touching_direction = [-3, 0]
)");
  EXPECT_EQ(place(world, 0), Vec2(3, 0));
}

// The floor of a world that repeats every 4 m, whose image is below; the table that starts 0.1 m up.
TEST(Touching, ImagesAndMovedSitesAreGrounds) {
  const World world = read(kDown + R"toml(periodic = [4, 0]
[[sites]]
name = "floor"
segment = [[0, 0], [4, 0]]
motion = { y = "0.1*cos(t)" }
[[bodies]]
disc = { radius = 0.5 }
position = [41, 3]
touching = "floor"
)toml");
  EXPECT_NEAR((place(world, 0) - Vec2(41, 0.6)).norm(), 0.0, 1e-15);
}

// 1e4 m out a double has 1.8e-12 m: so much, and not more, is between the bodies.
TEST(Touching, FarAwayTheGapIsARoundingOfThePlace) {
  const World world = read(kDown + R"([[sites]]
name = "floor"
polygon = { vertices = [[9990, 9000], [10010, 9000.7], [10010, 8990], [9990, 8990]] }
[[bodies]]
name = "s"
polygon = { vertices = [[0, 0], [1, 0.1], [0.8, 0.9], [0.1, 0.7]] }
position = [10000.1, 9500]
stack = 20
touching = "floor"
)");
  EXPECT_EQ(touching_pairs(world, -1e-15, 2e-11), 20);
}

struct Rows {
  const char* name;
  const char* shape;
  const char* copies;
  const char* gravity;
  int bodies, touching;  // counted by hand
};
class RowsThatTouch : public ::testing::TestWithParam<Rows> {};

TEST_P(RowsThatTouch, HaveGapsOfZeroAndNoOverlap) {
  for (const char* at : {"[0, 0]", "[10000.3, -9999.9]"}) {
    SCOPED_TRACE(at);
    const World world = read(std::string("[world]\ngravity = ") + GetParam().gravity + "\n[[bodies]]\n" +
                             GetParam().shape + "\n" + GetParam().copies + "\nposition = " + at + "\n");
    ASSERT_EQ(world.bodies.size(), static_cast<std::size_t>(GetParam().bodies));
    const double rounding = at[1] == '0' ? 1e-14 : 2e-11;
    EXPECT_EQ(touching_pairs(world, -1e-15, rounding), GetParam().touching);
  }
}

constexpr const char* kBox = "box = { width = 0.7, height = 0.3 }";
constexpr const char* kDisc = "disc = { radius = 0.35 }";
constexpr const char* kPolygon =
    "polygon = { vertices = [[0, 0], [1, -0.1], [1.2, 0.5], [0.4, 0.9], [-0.1, 0.4]] }";
constexpr const char* kStar =
    "polygon = { vertices = [[1, 0], [0.3, 0.3], [0, 1], [-0.3, 0.3], [-1, 0], [-0.3, -0.3], [0, -1], [0.3, "
    "-0.3]] }";
constexpr const char* kPlain = "[0, -9.81]";
constexpr const char* kTilted = "[4, -9]";

// A pyramid of n has n (n - 1) / 2 pairs side by side, and as many copies that lie on two; so has a wall of
// bricks, row by row. Boxes side by side touch those below by face, discs by one point. On the tips of crossed
// stars lie those two rows up.
INSTANTIATE_TEST_SUITE_P(
    Touching, RowsThatTouch,
    ::testing::Values(Rows{"StackOfBoxes", kBox, "stack = 30", kPlain, 30, 29},
                      Rows{"StackOfDiscs", kDisc, "stack = 30", kTilted, 30, 29},
                      Rows{"StackOfPolygons", kPolygon, "angle = 0.3\nstack = 12", kPlain, 12, 11},
                      Rows{"StackUnderTilt", kBox, "angle = 0.2\nstack = 12", kTilted, 12, 11},
                      Rows{"StackWithoutGravity", kBox, "stack = 4", "[0, 0]", 4, 3},
                      Rows{"PyramidOfBoxes", kBox, "pyramid = 8", kPlain, 36, 84},
                      Rows{"PyramidOfDiscs", kDisc, "pyramid = 8", kPlain, 36, 84},
                      Rows{"PyramidOfDiscsUnderTilt", kDisc, "pyramid = 6", kTilted, 21, 45},
                      Rows{"WallOfBoxes", kBox, "wall = [5, 4]", kPlain, 18, 14 + 24},
                      Rows{"WallOfOneRow", kBox, "wall = [5, 1]", kPlain, 5, 4},
                      Rows{"WallOfOneColumn", kBox, "wall = [1, 5]", kPlain, 5, 4},
                      Rows{"Capsules", "capsule = { length = 1, radius = 0.2 }", "pyramid = 5", kPlain, 15,
                           30}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

// Of shapes that hook into each other somebody touches; nobody overlaps.
TEST(Rows, OfAnyShapeOverlapNowhere) {
  for (const char* shape :
       {kPolygon, kStar, "path = { d = \"M 0 0 L 2 0 L 2 2 L 0 2 L 0 1.5 L 1.5 1.5 L 1.5 0.5 L 0 0.5 Z\" }",
        "polygon = { vertices = [[0, 0], [1, 0], [3, 0.5], [2, 0.5]] }",
        "chain = { vertices = [[0, 0], [1, 0.4], [2, 0]], radius = 0.05 }"})
    for (const char* copies : {"stack = 6", "pyramid = 5", "wall = [4, 5]"})
      for (const char* gravity : {kPlain, kTilted}) {
        SCOPED_TRACE(std::string(shape) + copies + gravity);
        const World world = read(std::string("[world]\ngravity = ") + gravity + "\n[[bodies]]\n" + shape +
                                 "\n" + copies + "\n");
        EXPECT_GE(touching_pairs(world, -1e-15, 1e-14), static_cast<int>(world.bodies.size()) - 1);
      }
}

// Wires of one form come down until one lies in the other, and not on each other's bounds.
TEST(Rows, WiresOfOneFormLieInEachOther) {
  for (const char* shape : {"chain = { vertices = [[-0.2, 0.1], [0, 0], [0.2, 0.1]] }",
                            "chain = { vertices = [[-0.3, 0.1], [-0.1, 0], [0.1, 0.2], [0.3, 0]] }",
                            "path = { d = \"M 0.2 0 A 0.3 0.3 0 0 0 -0.2 0\" }",
                            "path = { d = \"M -0.2 0 A 0.3 0.3 0 0 0 0.2 0\" }"})
    for (const char* gravity : {kPlain, kTilted}) {
      SCOPED_TRACE(std::string(shape) + gravity);
      const World world =
          read(std::string("[world]\ngravity = ") + gravity + "\n[[bodies]]\n" + shape + "\nstack = 5\n");
      ASSERT_EQ(world.bodies.size(), 5U);
      for (std::size_t k = 1; k < 5; ++k) EXPECT_LE((place(world, k) - place(world, k - 1)).norm(), 1e-9);
    }
}

TEST(Rows, AHundredBoxesAreFiveLines) {
  const World world = read(R"(world = { gravity = [0, -10] }
sites = [{ name = "floor", box = { width = 40, height = 2 }, position = [0, -1] }]
[[bodies]]
name = "b"
box = { width = 1, height = 0.5 }
position = [3, 1]
pyramid = 13
touching = "floor"
)");
  ASSERT_EQ(world.bodies.size(), 91U);
  EXPECT_EQ(place(world, 0), Vec2(-3, 0.25));  // the lowest row is 13 wide about x = 3
  EXPECT_EQ(place(world, 90), Vec2(3, 6.25));
  EXPECT_EQ(world.bodies[90].name, "b[90]");
  EXPECT_EQ(touching_pairs(world, 0.0, 0.0), 13 + 13 * 12 / 2 * 3);
}

TEST(Pile, LiesAboveItsPlaceWithoutOverlap) {
  for (const char* gravity : {kPlain, kTilted}) {
    const World world = read(std::string("[world]\ngravity = ") + gravity + R"(
[[sites]]
name = "peg"
disc = { radius = 0.5 }
position = [1, 4]
[[bodies]]
name = "p"
box = { width = 0.3, height = 0.2 }
position = [1, 2]
pile = { count = 80, width = 3, random_angle = true }
)");
    ASSERT_EQ(world.bodies.size(), 80U);
    EXPECT_EQ(touching_pairs(world, 1e-12, 0.0), 0);
    const Vec2 up = -world.gravity.normalized(), along(up.y(), -up.x());
    for (const Body& body : world.bodies) {
      const Vec2 from = body.initial.pose.position - Vec2(1, 2);
      EXPECT_GE(from.dot(up), 0.5 * std::hypot(0.3, 0.2) - 1e-12);
      EXPECT_LE(std::abs(from.dot(along)), 1.5 + 1e-12);
    }
  }
}

struct Fault {
  const char* name;
  std::string text;
  const char* expected;
};
class TouchingFault : public ::testing::TestWithParam<Fault> {};

TEST_P(TouchingFault, IsPlacedAndNamed) {
  EXPECT_THAT(fault_of(GetParam().text), HasSubstr(GetParam().expected));
}

const std::string kBall = "[[bodies]]\nname = \"ball\"\ndisc = { radius = 0.5 }\n";
const std::string kCube = "[[bodies]]\nname = \"cube\"\nbox = { width = 1, height = 1 }\n";

INSTANTIATE_TEST_SUITE_P(
    Touching, TouchingFault,
    ::testing::Values(
        Fault{"UnknownName", kDown + kFloor + kBall + "touching = \"flor\"\n",
              "9:12 touching: no body or site is called \"flor\"; the nearest name is \"floor\""},
        Fault{"UnknownCopy", kDown + kFloor + kBall + "stack = 3\ntouching = \"floor[0]\"\n",
              "10:12 touching: no body or site is called \"floor[0]\""},
        Fault{"NoWayDown", kFloor + kBall + "position = [0, 3]\ntouching = \"floor\"\n",
              "8:12 touching: there is no way down; given no gravity"},
        Fault{"NoDirection", kFloor + kBall + "touching_direction = [0, 0]\ntouching = \"floor\"\n",
              "7:22 touching_direction: is no direction"},
        Fault{"DirectionAlone", kBall + "touching_direction = [0, 1]\n",
              "4:22 touching_direction: has no meaning alone"},
        Fault{"NeverMeets", kDown + kFloor + kBall + "position = [0, -3]\ntouching = \"floor\"\n",
              "10:12 touching: never meets \"floor\"; given \"ball\" at [0, -3], moved along [0, -1]"},
        Fault{"Overlaps", kDown + kFloor + kBall + "touching = \"floor\"\n",
              "9:12 touching: overlaps \"floor\" where it is written; given \"ball\" at [0, 0]"},
        Fault{"Itself", kDown + kBall + "touching = \"ball\"\n",
              "6:12 touching: is the body itself; given \"ball\""},
        Fault{"ItsOwnCopy", kDown + kBall + "stack = 2\ntouching = \"ball[0]\"\n",
              "7:12 touching: is the body itself; given \"ball[0]\""},
        Fault{"Circle", kDown + kBall + "touching = \"cube\"\n" + kCube + "touching = \"ball\"\n",
              "6:12 touching: goes round in a circle; given \"ball on cube on ball\""},
        Fault{"Scatter",
              kDown + kBall + "touching = \"cube\"\n" + kCube +
                  "scatter = { count = 1, region = [[0,0],[9,9]] }\n",
              "6:12 touching: has no place before the others; given \"cube\""},
        Fault{"BesidePile",
              kDown + kFloor + kBall + "pile = { count = 2, width = 3 }\ntouching = \"floor\"\n",
              "10:12 touching: has no meaning beside what is placed at random; given pile"},
        Fault{"Nobody", kDown + kBall + "touching = []\n", "6:12 touching: names nobody"},
        Fault{"StackAndWall", kBall + "stack = 2\nwall = [2, 2]\n",
              "5:8 copies are asked for twice; given stack, wall, allowed: one of them"},
        Fault{"WallOfOneNumber", kBall + "wall = [2]\n", "4:8 wall: wrong type; given"},
        Fault{"WallOfNoRows", kBall + "wall = [2, 0]\n", "4:12 wall: out of range; given 0"},
        Fault{"TooManyCopies", kBall + "wall = [100000, 100000]\n", "4:8 too many copies"},
        Fault{"TiltedPileAmongImages",
              "[world]\ngravity = [1, -1]\nperiodic = [9, 0]\n" + kBall + "pile = { count = 2, width = 3 }\n",
              "7:8 pile: the plane repeats"}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

}  // namespace
}  // namespace brink::touching_test
