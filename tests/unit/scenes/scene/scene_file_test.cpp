// The scene file: what is written is what is built, and every fault is placed.
#include "brink/scenes/scene/scene.h"

#include <gmock/gmock.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "brink/core/shapes/outline.h"
#include "brink/scenes/scene/start.h"
#include "brink/scenes/toml/codec.h"

namespace brink::scene_file_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// Faults as "LINE:COLUMN message".
std::vector<std::string> faults_of(std::string_view text, const std::vector<std::string>& overrides = {}) {
  std::vector<std::string> out;
  try {
    parse_scene(text, "test.toml", overrides);
  } catch (const SceneFaults& faults) {
    for (const SceneFault& f : faults.faults())
      out.push_back(std::to_string(f.line) + ":" + std::to_string(f.column) + " " + f.message);
  }
  return out;
}

std::string with_ball(const std::string& more) {
  return "[[bodies]]\nname = \"ball\"\ndisc = { radius = 0.5 }\n" + more;
}

// A gap between outlines by the definition: the least over both sample sets.
double gap_between(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b) {
  double least = std::numeric_limits<double>::infinity();
  const auto one_way = [&](const Outline& from, const Frame& f, const Outline& to, const Frame& t) {
    for (const Sample& s : from.samples)
      least = std::min(least, gap_by_brute_force(to, t.to_local(f.to_world(s.p))) - s.radius);
  };
  one_way(a, Frame(pose_a), b, Frame(pose_b));
  one_way(b, Frame(pose_b), a, Frame(pose_a));
  return least;
}

TEST(SceneFile, ContractExampleReadsAsWritten) {
  // The example of the contract; disc of mass 1 and radius 1/2: inertia m r^2 / 2 = 1/8.
  const Scene scene = parse_scene(R"toml(title = "two discs and a floor"
[world]
duration = 5.0
gravity  = [0.0, -9.81]
seed     = 7
[solver]
policy     = "body_clocks"
tolerance  = 1e-9
[output]
frame_interval = 0.02
[materials.steel]
restitution = 0.75
[[sites]]
name = "floor"
segment = [[-10, 0], [10, 0]]
material = "steel"
[[bodies]]
name = "ball"
disc = { radius = 0.5 }
mass = 1.0
position = [0, 10]
angle_deg = 90
angular_velocity = 2
material = "steel"
)toml",
                                  "test.toml");
  EXPECT_EQ(scene.world.title, "two discs and a floor");
  EXPECT_EQ(scene.duration, 5.0);
  EXPECT_EQ(scene.world.gravity, Vec2(0.0, -9.81));
  EXPECT_EQ(scene.solver.seed, 7U);
  EXPECT_EQ(scene.solver.tolerance, 1e-9);
  EXPECT_EQ(scene.output.frame_interval, 0.02);
  ASSERT_EQ(scene.world.bodies.size(), 1U);
  const Body& ball = scene.world.bodies[0];
  EXPECT_EQ(ball.initial.pose.position, Vec2(0.0, 10.0));
  EXPECT_DOUBLE_EQ(ball.initial.pose.angle, std::numbers::pi / 2);
  EXPECT_EQ(ball.initial.twist.omega, 2.0);
  EXPECT_DOUBLE_EQ(ball.inertia, 0.125);
  EXPECT_EQ(scene.world.materials[static_cast<std::size_t>(ball.material)].restitution, 0.75);
  ASSERT_EQ(scene.world.sites.size(), 1U);
  EXPECT_EQ(scene.world.sites[0].kind, "segment");
  EXPECT_THAT(scene.options_json, HasSubstr("\"tolerance\":1e-09"));
}

// Headers on which toml++ would assert (and assumes away in release builds): faults with their line.
TEST(SceneFile, HeadersWithoutAKeyAreFaultsWithTheirLine) {
  for (const char* header : {"[.]", "[[.a]]", "[\u00e9]", "[\u00e9.a]", "[!]"}) {
    const auto faults = faults_of("[world]\nduration = 1.0\n" + std::string(header) + "\na = 1\n");
    ASSERT_EQ(faults.size(), 1U) << header;
    EXPECT_EQ(faults[0], "3:1 not valid TOML: expected a key of letters, digits, - and _, or one in quotes")
        << header;
  }
}

TEST(SceneFile, UnknownPolicyIsAFaultThatNamesWhatThereIs) {
  const auto faults = faults_of("[solver]\npolicy = \"timewrap\"\n");
  ASSERT_EQ(faults.size(), 1U);
  for (const char* part : {"2:10 ", "timewrap", "body_clocks", "island_backup", "timewarp", "fixed_step"})
    EXPECT_THAT(faults.front(), HasSubstr(part));
}

TEST(SceneFile, OffCentrePolygonIsCentredUnlessTold) {
  // A unit square with a corner at its frame's origin: centroid (1/2, 1/2), inertia m (1 + 1) / 12. Turned by
  // 90 degrees, the centroid stands at (-1/2, 1/2) from the origin.
  const std::string square =
      "[[bodies]]\npolygon = { vertices = [[0,0],[1,0],[1,1],[0,1]] }\nmass = 3\nposition = [10, 0]\n"
      "angle_deg = 90\n";
  const Body centred = parse_scene(square, "t").world.bodies[0];
  EXPECT_EQ(centred.initial.pose.position, Vec2(10.0, 0.0));
  EXPECT_NEAR(centred.inertia, 0.5, 1e-15);
  const Body kept = parse_scene(square + "centered = false\n", "t").world.bodies[0];
  EXPECT_NEAR(kept.initial.pose.position.x(), 9.5, 1e-15);
  EXPECT_NEAR(kept.initial.pose.position.y(), 0.5, 1e-15);
  const Scene site = parse_scene("[[sites]]\npolygon = { vertices = [[0,0],[1,0],[1,1],[0,1]] }\n", "t");
  EXPECT_NEAR(site.world.sites[0].outline->bounds.low.x(), 0.0, 1e-15);
}

TEST(SceneFile, DensityTimesAreaIsMass) {
  // box 2 x 3: area 6; wire of length 5 without thickness: 5 kg at 1 kg/m, inertia m l^2 / 12.
  EXPECT_NEAR(
      parse_scene("[[bodies]]\nbox = { width = 2, height = 3 }\ndensity = 2\n", "t").world.bodies[0].mass,
      12.0, 1e-13);
  const Body wire =
      parse_scene("[[bodies]]\nchain = { vertices = [[0,0],[5,0]] }\ndensity = 1\n", "t").world.bodies[0];
  EXPECT_NEAR(wire.mass, 5.0, 1e-14);
  EXPECT_NEAR(wire.inertia, 125.0 / 12.0, 1e-13);
}

TEST(SceneFile, EveryShapeBuilds) {
  const std::map<std::string, bool> shapes{
      // true: bodies may have it too
      {"disc = { radius = 1 }", true},
      {"box = { width = 1, height = 2, radius = 0.1 }", true},
      {"polygon = { vertices = [[0,0],[2,0],[1,0.5],[2,2]] }", true},
      {"polygons = [{ vertices = [[0,0],[1,0],[1,1]] }]", true},
      {"capsule = { length = 1, radius = 0.2 }", true},
      {"chain = { vertices = [[0,0],[1,0],[1,1]], closed = true }", true},
      {"path = { d = \"M0 0 L2 0 L2 2 Z\", scale = 0.5 }", true},
      {"point = [1, 2]", false},
      {"segment = [[0, 0], [1, 0]]", false},
      {"polyline = [[0, 0], [1, 0], [1, 1]]", false},
      {"arc = { center = [0, 0], radius = 2, from_deg = 0, to_deg = 270 }", false},
      {"bezier = [[0, 0], [1, 0], [1, 1], [2, 1]]", false}};
  for (const auto& [shape, body] : shapes) {
    EXPECT_EQ(parse_scene("[[sites]]\n" + shape, "t").world.sites.size(), 1U) << shape;
    const std::string as_body = "[[bodies]]\n" + shape;
    if (body) {
      EXPECT_EQ(parse_scene(as_body, "t").world.bodies.size(), 1U) << shape;
    } else {
      EXPECT_THAT(faults_of(as_body), Contains(HasSubstr("2:1 unknown key"))) << shape;
    }
  }
}

TEST(SceneFile, InsideOfMakesAContainer) {
  for (const char* shape :
       {"disc = { radius = 2 }", "polygon = { vertices = [[-2,-2],[2,-2],[2,2],[-2,2]] }"}) {
    const Scene scene = parse_scene(std::string("[[sites]]\ninside_of = true\n") + shape, "t");
    const Outline& outline = *scene.world.sites[0].outline;
    EXPECT_TRUE(outline.container);
    EXPECT_NEAR(gap_by_brute_force(outline, {1.5, 0.0}), 0.5, 1e-15);  // free inside, half from the wall
  }
}

TEST(SceneFile, EqualShapesShareOneOutline) {
  const World world = parse_scene(R"toml([[bodies]]
name = "a"
disc = { radius = 1 }
grid = { columns = 2, rows = 3, spacing = [3, 4] }
[[bodies]]
name = "b"
disc = { radius = 1 }
position = [0, 20]
[[bodies]]
name = "c"
disc = { radius = 2 }
position = [0, 40]
)toml",
                                  "t")
                          .world;
  ASSERT_EQ(world.bodies.size(), 8U);
  EXPECT_EQ(world.bodies[0].outline, world.bodies[6].outline);
  EXPECT_NE(world.bodies[0].outline, world.bodies[7].outline);
  EXPECT_EQ(world.bodies[3].name, "a[3]");  // row 1, column 1
  EXPECT_EQ(world.bodies[3].initial.pose.position, Vec2(3.0, 4.0));
}

std::string scatter(const std::string& shape, int count, const std::string& more = "") {
  return "[world]\nseed = 5\n[[sites]]\nname = \"peg\"\ndisc = { radius = 0.5 }\nposition = [5, "
         "5]\n[[bodies]]\nname "
         "= \"s\"\n" +
         shape + "\nscatter = { count = " + std::to_string(count) +
         ", region = [[0, 0], [10, 10]], speed = 3, angular_speed = 2, random_angle = true" + more + " }\n";
}

TEST(SceneFile, ScatterHasNoOverlapsAndKeepsClearOfSites) {
  // sparse discs, discs beyond random insertion (60 % of the area), and long rods whose discs would not fit
  for (const std::string& text :
       {scatter("disc = { radius = 0.1 }", 300), scatter("disc = { radius = 0.3 }", 200),
        scatter("capsule = { length = 2, radius = 0.05 }", 60)}) {
    const World world = parse_scene(text, "t").world;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const Body& a = world.bodies[i];
      EXPECT_NEAR(a.initial.twist.velocity.norm(), 3.0, 1e-12);
      EXPECT_EQ(std::abs(a.initial.twist.omega), 2.0);
      EXPECT_GT(gap_between(*a.outline, a.initial.pose, *world.sites[0].outline, world.sites[0].pose), 0.0);
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_GT(
            gap_between(*a.outline, a.initial.pose, *world.bodies[j].outline, world.bodies[j].initial.pose),
            0.0);
    }
  }
}

TEST(SceneFile, ScatterIsTheSameForTheSameSeedAndGrowsAtItsEnd) {
  const World ten = parse_scene(scatter("disc = { radius = 0.1 }", 10), "t").world;
  const World twenty = parse_scene(scatter("disc = { radius = 0.1 }", 20), "t").world;
  const World other = parse_scene(scatter("disc = { radius = 0.1 }", 10), "t", {"world.seed=6"}).world;
  for (std::size_t k = 0; k < 10; ++k) {
    EXPECT_EQ(ten.bodies[k].initial.pose.position, twenty.bodies[k].initial.pose.position);
    EXPECT_EQ(ten.bodies[k].initial.twist.velocity, twenty.bodies[k].initial.twist.velocity);
    EXPECT_NE(ten.bodies[k].initial.pose.position, other.bodies[k].initial.pose.position);
  }
}

// In a world that repeats every 4 m, over the whole of it: copies and sites stand across the edges too. 40 %
// of the area is taken, so that without images some pair would overlap.
TEST(SceneFile, ScatterKeepsClearOfImages) {
  const World world = parse_scene(R"toml(
[world]
periodic = [4, 4]
[[sites]]
disc = { radius = 0.5 }
position = [0, 4]
[[bodies]]
name = "ball"
disc = { radius = 0.2 }
scatter = { count = 40, region = [[0, 0], [4, 4]] }
)toml",
                                  "t")
                          .world;
  const auto apart = [](const Vec2& a, const Vec2& b) {
    const auto along = [&](int axis) { return std::remainder(a[axis] - b[axis], 4.0); };
    return std::hypot(along(0), along(1));
  };
  ASSERT_EQ(world.bodies.size(), 40U);
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Vec2& p = world.bodies[i].initial.pose.position;
    EXPECT_GT(apart(p, {0, 0}), 0.7);
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT(apart(p, world.bodies[j].initial.pose.position), 0.4);
  }
}

// So full that a lattice is needed, over the whole period: its last column is beside the image of its first.
TEST(SceneFile, ScatterOnALatticeKeepsClearOfImages) {
  for (const char* region : {"[[0, 0], [4, 4]]", "[[-1, -3], [5, 3]]"}) {
    const World world = parse_scene(std::string(R"toml(
[world]
periodic = [4, 4]
[[bodies]]
name = "ball"
disc = { radius = 0.2 }
scatter = { count = 80, region = )toml") +
                                        region + " }\n",
                                    "t")
                            .world;
    ASSERT_EQ(world.bodies.size(), 80U);
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Vec2 d = world.bodies[i].initial.pose.position - world.bodies[j].initial.pose.position;
        ASSERT_GT(std::hypot(std::remainder(d.x(), 4.0), std::remainder(d.y(), 4.0)), 0.4) << region;
      }
  }
}

// A site as large as a million periods leaves no room; it is not copied a million times to find out.
TEST(SceneFile, ScatterAmongCountlessImagesIsAFault) {
  EXPECT_THAT(
      faults_of("[world]\nperiodic = [1e-6, 1e-6]\n[[sites]]\nsegment = [[0, 0], [1, 1]]\n[[bodies]]\n"
                "disc = { radius = 1e-9 }\nscatter = { count = 2, region = [[0, 0], [1e-6, 1e-6]] }\n"),
      Contains(HasSubstr("the region is too small")));
}

TEST(SceneFile, ScatterThatDoesNotFitIsAFault) {
  // 500 discs of radius 0.3 cover more than the region
  EXPECT_THAT(faults_of(scatter("disc = { radius = 0.3 }", 500)),
              Contains(HasSubstr("the region is too small")));
}

TEST(SceneFile, ForcesFindTheirBodies) {
  const World world = parse_scene(R"toml([[bodies]]
name = "a"
polygon = { vertices = [[0,0],[1,0],[1,1],[0,1]] }
centered = false
[[bodies]]
name = "b"
disc = { radius = 0.5 }
grid = { columns = 3, spacing = [2, 0] }
position = [5, 5]
[[forces]]
kind = "spring"
bodies = ["a", "b[1]"]
at = [[1, 1], [0, 0.25]]
stiffness = 10
rest_length = 1
[[forces]]
kind = "drag"
bodies = ["b"]
linear = 0.5
[[forces]]
kind = "attract"
center = [-5, 0]
strength = 2
[[forces]]
kind = "formula"
bodies = ["a"]
fx = "-x + sin(t)"
)toml",
                                  "t")
                          .world;
  ASSERT_EQ(world.forces.size(), 4U);
  const auto& spring = std::get<SpringForce>(world.forces[0]);
  EXPECT_EQ(spring.body_b, 2);
  // the corner (1, 1) of the file's frame is (1/2, 1/2) from the centre of mass
  EXPECT_NEAR((spring.at_a - Vec2(0.5, 0.5)).norm(), 0.0, 1e-15);
  EXPECT_EQ(std::get<DragForce>(world.forces[1]).bodies, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(std::get<AttractForce>(world.forces[2]).bodies.size(), 4U);
}

TEST(SceneFile, MotionsOfSites) {
  const World world = parse_scene(R"toml([[sites]]
name = "belt"
segment = [[0, 0], [1, 0]]
motion = { velocity = [1, 0], angular_velocity = 2 }
[[sites]]
name = "table"
segment = [[0, 1], [1, 1]]
motion = { y = "0.1*sin(6*t)" }
)toml",
                                  "t")
                          .world;
  EXPECT_EQ(std::get<ConstantMotion>(world.sites[0].motion).twist.omega, 2.0);
  const double t = 0.5;
  EXPECT_DOUBLE_EQ((*std::get<FormulaMotion>(world.sites[1].motion).y)({&t, 1}), 0.1 * std::sin(3.0));
}

// Corners are no fault, and what jumps or ends on the way is met by the run.
TEST(SceneFile, MotionsAreMadeAheadForWhatNothingBounds) {
  for (const char* taken : {"abs(sin(5*t))", "min(t, 1)", "max(sin(t), cos(t))", "abs(t - rint(t))",
                            "0.1*sin(1e6*t)", "sqrt(0.5 - t)*0 + t", "t < 0.7 ? 0 : 1e-3"}) {
    const std::string scene =
        std::string("[world]\nduration = 0.4\n[[sites]]\npoint = [0, 0]\nmotion = { y = \"") + taken +
        "\" }\n";
    EXPECT_NO_THROW(parse_scene(scene, "t")) << taken;
  }
}

TEST(SceneFile, OverridesReachTablesArraysAndNames) {
  const Scene scene = parse_scene(with_ball("mass = 1\n"), "t",
                                  {"solver.integrator=rk4", "bodies.0.mass=2", "bodies.ball.position=[1, 2]",
                                   "world.gravity=[0, -1]", "world.gravity.1=-2", "title=free words"});
  EXPECT_EQ(scene.solver.integrator, "rk4");
  EXPECT_EQ(scene.world.bodies[0].mass, 2.0);
  EXPECT_EQ(scene.world.bodies[0].initial.pose.position, Vec2(1.0, 2.0));
  EXPECT_EQ(scene.world.gravity, Vec2(0.0, -2.0));
  EXPECT_EQ(scene.world.title, "free words");
}

struct FaultCase {
  const char* name;
  std::string text;
  const char* expected;  ///< part of one fault, with its place
};

class SceneFault_ : public ::testing::TestWithParam<FaultCase> {};

TEST_P(SceneFault_, IsPlacedAndNamed) {
  EXPECT_THAT(faults_of(GetParam().text), Contains(HasSubstr(GetParam().expected)));
}

INSTANTIATE_TEST_SUITE_P(
    SceneFile, SceneFault_,
    ::testing::Values(
        FaultCase{"Syntax", "[world]\nduration = = 3\n", "2:12 not valid TOML"},
        FaultCase{"UnknownKey", "[world]\ndurration = 3\n",
                  "2:1 unknown key \"durration\" in world; the nearest known key is \"duration\""},
        FaultCase{"UnknownTable", "[wrold]\n",
                  "unknown key \"wrold\" in the file; the nearest known key is \"world\""},
        FaultCase{"WrongType", "[world]\nduration = \"long\"\n",
                  "2:12 duration: wrong type; given the string \"long\""},
        FaultCase{"TableIsANumber", "world = 3\n", "1:9 world: wrong type; given 3"},
        FaultCase{"Nan", "[world]\nduration = nan\n", "2:12 duration: not a finite number; given nan"},
        FaultCase{"Inf", "[world]\ngravity = [0, -inf]\n", "2:15 gravity: not a finite number; given -inf"},
        FaultCase{"OutOfRange", "[materials.m]\nrestitution = 1.5\n",
                  "2:15 restitution: out of range; given 1.5, allowed: a number >= 0 and <= 1"},
        FaultCase{"NegativeSeed", "[world]\nseed = -1\n", "2:8 seed: out of range"},
        FaultCase{"UnknownIntegrator", "[solver]\nintegrator = \"rk5\"\n",
                  "2:14 integrator: not known; given \"rk5\", allowed: one of auto"},
        FaultCase{"Mesh", "[field]\nprimitives = \"cones\"\n",
                  "2:14 primitives: not known; given \"cones\", allowed: one of exact, mesh"},
        FaultCase{"Samples", "[[bodies]]\nsamples = { file = \"nowhere.rb\" }\n",
                  "2:11 samples: the file cannot be read; given \"nowhere.rb\""},
        FaultCase{"SamplingWithoutSpacing", with_ball("sampling = { kind = \"boundary\" }\n"),
                  "sampling: boundary needs a spacing or a count; given spacing 0 m and count 0"},
        FaultCase{"NoShape", "[[bodies]]\nname = \"a\"\n", "1:1 \"a\" needs exactly one shape; given none"},
        FaultCase{"TwoShapes", with_ball("box = { width = 1, height = 1 }\n"),
                  "needs exactly one shape; given"},
        FaultCase{"MissingKey", "[[bodies]]\ndisc = {}\n", "2:8 disc: radius is missing"},
        FaultCase{"NegativeRadius", "[[bodies]]\ndisc = { radius = -1 }\n",
                  "2:19 radius: out of range; given -1"},
        FaultCase{"CrossedPolygon", "[[bodies]]\npolygon = { vertices = [[0,0],[2,1],[2,0],[0,2]] }\n",
                  "2:11 polygon"},
        FaultCase{"ZeroSegment", "[[sites]]\nsegment = [[1,1],[1,1]]\n", "2:11 segment"},
        FaultCase{"DuplicateName", with_ball("") + with_ball("position = [5, 5]\n"),
                  "5:8 name: is used twice; given \"ball\""},
        FaultCase{"UnknownMaterial", "[materials.steel]\n" + with_ball("material = \"stel\"\n"),
                  "5:12 no material is called \"stel\"; the nearest name is \"steel\""},
        FaultCase{"MassAndDensity", with_ball("mass = 1\ndensity = 1\n"), "5:11 mass is given twice"},
        FaultCase{"TwoAngles", with_ball("angle = 1\nangle_deg = 1\n"), "5:13 angle is given twice"},
        FaultCase{"GridAndScatter",
                  with_ball("grid = { columns = 2, spacing = [2, 2] }\nscatter = { count = 1, region = "
                            "[[0,0],[9,9]] }\n"),
                  "5:11 copies are asked for twice"},
        FaultCase{"TooManyCopies", with_ball("grid = { columns = 10000, rows = 10000, spacing = [2, 2] }\n"),
                  "4:8 too many copies"},
        FaultCase{"HeldVelocity", with_ball("lock = [\"x\"]\nvelocity = [1, 0]\n"),
                  "5:12 velocity: a held coordinate does not move"},
        FaultCase{"UnknownLock", with_ball("lock = [\"z\"]\n"),
                  "4:9 lock: not known; given \"z\", allowed: one of x, y, angle"},
        FaultCase{"UnknownForce", "[[forces]]\nkind = \"sprng\"\n",
                  "2:8 kind: not known; given \"sprng\", allowed: one of spring"},
        FaultCase{"ForceWithoutKind", "[[forces]]\n", "1:1 forces: kind is missing"},
        FaultCase{"UnknownBody", with_ball("[[forces]]\nkind = \"thrust\"\nbody = \"bal\"\n"),
                  "6:8 no body is called \"bal\"; the nearest name is \"ball\""},
        FaultCase{"BadFormula", with_ball("[[forces]]\nkind = \"formula\"\nfx = \"2*(x\"\n"), "6:6 "},
        FaultCase{"InfiniteFormula", with_ball("[[forces]]\nkind = \"formula\"\nfx = \"1/x\"\n"),
                  "6:6 formula \"1/x\" is not finite"},
        FaultCase{"MotionThatCannotBegin", "[[sites]]\npoint = [0, 0]\nmotion = { y = \"sin(-1e16*t)\" }\n",
                  "y = \"sin(-1e16*t)\" jumps, or is infinitely fast, near t = 0 s"},
        FaultCase{"MotionThatIsTooFast", "[[sites]]\npoint = [0, 0]\nmotion = { y = \"1e300*t\" }\n",
                  "y = \"1e300*t\" is too fast, or goes too far, near t = 0 s"},
        FaultCase{"MotionThatCannotBeBounded",
                  "[[sites]]\npoint = [0, 0]\nmotion = { x = \"t\", y = \"max(sin(t), sin(t) + 0)\" }\n",
                  "3:25 fixed site"},
        FaultCase{"MotionOfBothKinds",
                  "[[sites]]\npoint = [0, 0]\nmotion = { velocity = [1, 0], x = \"t\" }\n",
                  "3:10 motion: is not clear"},
        FaultCase{"InsideOfASegment", "[[sites]]\nsegment = [[0,0],[1,0]]\ninside_of = true\n",
                  "3:13 inside_of: segment has no inside"},
        FaultCase{"NulInAFormula", with_ball("[[forces]]\nkind = \"formula\"\nfx = \"x\\u0000+1\"\n"),
                  "6:6 formula \"x\\x00+1\": at character 2: holds a NUL character"},
        FaultCase{"NulInAName", "[[bodies]]\ndisc = { radius = 1 }\nname = \"a\\u0000b\"\n",
                  "3:8 name: holds a NUL character; given \"a\\x00b\" (character 2)"},
        FaultCase{"ControlsInAName", with_ball("material = \"\\u001b[2J\\n\\u202e\"\n"),
                  "4:12 no material is called \"\\x1b[2J\\n\\u202e\""},
        FaultCase{"GridInOnePlace", with_ball("grid = { columns = 3, rows = 1, spacing = [0, 2] }\n"),
                  "4:8 grid: copies would stand in one place; given spacing [0, 2]"},
        FaultCase{"TooManyFrames", with_ball("[output]\nframe_interval = 1e-6\n[world]\nduration = 200\n"),
                  "4:1 output: too many rows of frames; given 200000002"},
        FaultCase{"NegativePeriod", "[world]\nperiodic = [4, -1]\n",
                  "2:16 periodic: out of range; given -1, allowed: a number >= 0 in m"},
        FaultCase{"SpringOfNobody", with_ball("[[forces]]\nkind = \"spring\"\nstiffness = 1\n"),
                  "4:1 spring: who it joins is not clear; given nothing, allowed: bodies"},
        FaultCase{"NoClosedForm",
                  "[solver]\nintegrator = \"ballistic\"\n" +
                      with_ball("[[forces]]\nkind = \"drag\"\nquadratic = 1\n[[forces]]\nkind = "
                                "\"formula\"\nfx = \"t\"\n"),
                  "2:14 integrator: ballistic has no closed form for these forces; given quadratic drag, "
                  "formula, allowed: "},
        FaultCase{"DateAsNumber", "[world]\nduration = 2020-01-01\n",
                  "2:12 duration: wrong type; given a date or time"}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

TEST(SceneFile, AllFaultsComeAtOnceInFileOrder) {
  // six faults of six kinds, the last of them a name that only forces use
  const auto faults = faults_of(R"toml([world]
duration = -1
[solver]
response = "bounce"
[[bodies]]
name = "a"
disc = { radius = 0 }
mas = 1
[[bodies]]
name = "b"
material = "wood"
disc = { radius = 1 }
[[forces]]
kind = "thrust"
body = "c"
)toml");
  ASSERT_EQ(faults.size(), 6U) << ::testing::PrintToString(faults);
  const char* places[] = {"2:12", "4:12", "7:19", "8:1", "11:12", "15:8"};
  for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(faults[k].substr(0, faults[k].find(' ')), places[k]);
}

// What is found later than by reading the keys: names that touching, forces and materials use, options together, frames,
// the integrator. None hides another.
TEST(SceneFile, FaultsOfLaterStagesComeWithTheOthers) {
  const auto faults = faults_of(R"toml([world]
duration = 1e9
[solver]
integrator = "ballistic"
order = "lcp"
response = "reflection"
[output]
frame_interval = 1e-6
[[bodies]]
name = "a"
disc = { radius = 1 }
mas = 1
[[bodies]]
name = "b"
material = "wood"
touching = "flor"
touching_direction = [0, -1]
disc = { radius = 1 }
[[bodies]]
name = "c"
touching = "d"
touching_direction = [0, -1]
disc = { radius = 1 }
[[bodies]]
name = "d"
touching = "c"
touching_direction = [0, -1]
disc = { radius = 1 }
[[forces]]
kind = "formula"
bodies = ["e"]
fx = "t"
[[forces]]
kind = "attract"
center = [0, 0]
strength = 1
)toml");
  std::vector<std::string> places;
  for (const std::string& fault : faults) places.push_back(fault.substr(0, fault.find(' ')));
  EXPECT_EQ(places,
            (std::vector<std::string>{"4:14", "5:9", "7:1", "12:1", "15:12", "16:12", "21:12", "31:10"}))
      << ::testing::PrintToString(faults);
}

// The loader refuses what an integrator without steps would, and nothing else.
TEST(SceneFile, BallisticIsRefusedWhereItHasNoClosedForm) {
  for (const auto& [force, closed] :
       {std::pair("kind = \"thrust\"\nbody = \"ball\"\nforce = [1, 0]\n", true),
        {"kind = \"drag\"\nlinear = 1\n", true},
        {"kind = \"drag\"\nquadratic = 1\n", false},
        {"kind = \"formula\"\nfx = \"1\"\n", false},
        {"kind = \"attract\"\ncenter = [5, 5]\nstrength = 1\n", false},
        {"kind = \"spring\"\nbody = \"ball\"\nanchor = [5, 5]\nstiffness = 1\n", false}}) {
    const std::string text = with_ball(std::string("[[forces]]\n") + force);
    EXPECT_EQ(faults_of(text, {"solver.integrator=ballistic"}).empty(), closed) << force;
    const Scene scene = parse_scene(text, "t");
    SolverOptions ballistic;
    ballistic.integrator = "ballistic";
    if (closed)
      EXPECT_NO_THROW(Simulator(scene.world, ballistic)) << force;
    else
      EXPECT_THROW(Simulator(scene.world, ballistic), BadInput) << force;
  }
}

// What is not what it should be is told once: that it is there is known.
TEST(SceneFile, AKeyOfAWrongTypeIsNotMissing) {
  for (const char* force :
       {"kind = \"spring\"\nbody = 0\nanchor = [0, 1]\nstiffness = 1\n",
        "kind = \"spring\"\nbodies = 3\nstiffness = 1\n",
        "kind = \"spring\"\nbody = \"ball\"\nanchor = 1\nstiffness = 1\n",
        "kind = \"thrust\"\nbody = 0\nforce = [1, 0]\n", "kind = \"formula\"\nfx = [1]\n"}) {
    const auto faults = faults_of(with_ball(std::string("[[forces]]\n") + force));
    ASSERT_EQ(faults.size(), 1U) << ::testing::PrintToString(faults);
    EXPECT_THAT(faults[0], HasSubstr(": wrong type; given ")) << force;
  }
}

TEST(SceneFile, AnOverlapAtTheStartIsToldAtItsBody) {
  const Scene scene =
      parse_scene(with_ball("") + "[[bodies]]\nname = \"k\"\ndisc = { radius = 1 }\nposition = [5, 0]\n" +
                      "grid = { columns = 2, spacing = [1, 0] }\n",
                  "test.toml");
  ASSERT_EQ(scene.body_places.size(), 3U);
  try {
    require_start(scene, Simulator(scene.world, scene.solver));
    FAIL();
  } catch (const SceneFaults& faults) {
    EXPECT_THAT(faults.what(), HasSubstr("test.toml:4:1: 'k[0]' and 'k[1]' overlap by 1 m at the start"));
  }
}

TEST(SceneFile, OverridesKnowTheNamesOfEntriesWithoutOne) {
  const std::string text = "[[sites]]\npoint = [9, 9]\n" + with_ball("") +
                           "[[bodies]]\ndisc = { radius = 0.5 }\nposition = [3, 0]\n";
  const Scene scene = parse_scene(text, "t", {"bodies.body1.mass=2", "sites.site0.position=[1, 0]"});
  EXPECT_EQ(scene.world.bodies[1].mass, 2.0);
  EXPECT_EQ(scene.world.sites[0].pose.position, Vec2(1.0, 0.0));
  EXPECT_THAT(faults_of(text, {"bodies.body0.mass=2"}), Contains(HasSubstr("nothing is called \"body0\"")))
      << "that one is called ball";
  EXPECT_THAT(faults_of(text, {"forces.body0.mass=2"}), Contains(HasSubstr("forces")));
}

TEST(SceneFile, FaultsOfOverridesNameThePath) {
  EXPECT_THAT(faults_of("", {"solver.step=-1"}),
              Contains(HasSubstr("0:0 --set solver.step: step: out of range")));
  EXPECT_THAT(faults_of("", {"solver.stp=1"}), Contains(HasSubstr("--set solver.stp: unknown key \"stp\"")));
  EXPECT_THAT(faults_of(with_ball(""), {"bodies.cube.mass=1"}),
              Contains(HasSubstr("nothing is called \"cube\"")));
  EXPECT_THAT(faults_of(with_ball(""), {"bodies.7.mass=1"}), Contains(HasSubstr("nothing is called \"7\"")));
  EXPECT_THAT(faults_of("", {"nothing"}), Contains(HasSubstr("must be PATH=VALUE")));
}

TEST(SceneFile, WhatListsFilePlaceAndMessage) {
  try {
    parse_scene("[world]\nseed = -1\n", "dir/s.toml");
    FAIL();
  } catch (const SceneFaults& faults) {
    EXPECT_THAT(faults.what(), HasSubstr("dir/s.toml:2:8: seed: out of range"));
  }
}

TEST(SceneFile, KeyWithoutEndIsAFaultAndNoCrash) {
  std::string deep = "a";
  for (int k = 0; k < 200000; ++k) deep += ".a";
  EXPECT_THAT(faults_of(deep + " = 1\n"), Contains(HasSubstr("too many parts")));
  EXPECT_FALSE(faults_of("x = " + std::string(100000, '[')).empty());
  // 64 parts are allowed, 65 are not
  std::string parts = "a";
  for (int k = 1; k < 64; ++k) parts += ".a";
  EXPECT_THAT(faults_of(parts + " = 1\n"), Not(Contains(HasSubstr("too many parts"))));
  EXPECT_THAT(faults_of(parts + ".a = 1\n"), Contains(HasSubstr("too many parts")));
}

TEST(SceneFile, MissingFileIsAnIoError) {
  EXPECT_THROW(load_scene("/no/such/file.toml"), IoError);
  EXPECT_THROW(load_scene("/"), IoError);
}

TEST(SceneFile, EveryPeerSceneReadsAndChecks) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(BRINK_SOURCE_DIR "/tests/regression/peer-scenes")) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    EXPECT_NO_THROW(load_scene(entry.path()).world.check()) << entry.path();
  }
  EXPECT_EQ(count, 21);
}

TEST(SceneFile, EveryGallerySceneReadsAndChecks) {
  for (const auto& entry : std::filesystem::directory_iterator(BRINK_SOURCE_DIR "/scenes/gallery"))
    if (entry.path().extension() == ".toml") {
      EXPECT_NO_THROW(load_scene(entry.path()).world.check()) << entry.path();
    }
}

TEST(SceneOptions, ThePageNamesEveryKeyWithItsDefault) {
  // The page's tables are rows of this very list.
  std::ifstream in(BRINK_SOURCE_DIR "/docs/scene-format.md");
  std::stringstream page;
  page << in.rdbuf();
  const std::string text = page.str();
  for (const OptionInfo& option : scene_options()) {
    const std::string row = "| `" + option.key + "` | " + option.type + " | " + option.default_value + " | " +
                            option.meaning + " |";
    EXPECT_THAT(text, HasSubstr(row)) << option.table;
  }
}

TEST(SceneOptions, NoKeyIsDeclaredTwice) {
  std::set<std::pair<std::string, std::string>> seen;
  for (const OptionInfo& option : scene_options())
    EXPECT_TRUE(seen.emplace(option.table, option.key).second) << option.table << '.' << option.key;
}

// As many of each as a file may hold, not of both together.
TEST(SceneFile, AMillionBodiesStandBesideASite) {
  const Scene scene = parse_scene(
      "[world]\nduration = 1\n[output]\nframe_interval = 0\n[[sites]]\nsegment = [[-1, -9], [1, "
      "-9]]\n[[bodies]]\nname = \"d\"\n"
      "disc = { radius = 0.1 }\ngrid = { columns = 1000, rows = 1000, spacing = [1, 1] }\n",
      "million.toml");
  EXPECT_EQ(scene.world.bodies.size(), 1000000U);
  EXPECT_EQ(scene.world.sites.size(), 1U);
}

// Of three to five quotes in a row the last three end a string; what follows is scanned for keys again.
TEST(SceneFile, DeepKeysAreRefusedAfterStringsThatEndInQuotes) {
  std::string deep = "a";
  for (int k = 0; k < 100; ++k) deep += ".a";
  for (const char quote : {'\'', '"'})
    for (const std::size_t own : {0, 1, 2}) {
      const std::string string = std::string(3, quote) + "a" + std::string(own + 3, quote);
      const std::string text = "x = {s = " + string + ", " + deep + " = 1}\n";
      EXPECT_THAT(faults_of(text), Contains(HasSubstr("a dotted key has too many parts"))) << text;
    }
  EXPECT_EQ(parse_scene("title = '''a'''''\n", "t").world.title, "a''");
}

// Told by World::check(), of which no table knows: who is meant stands in the message.
TEST(SceneFile, AFaultOfTheWholeIsPlacedAtTheBodyOfThatName) {
  const std::string two =
      "[world]\nperiodic = [1, 0]\n[[bodies]]\nname = \"a\"\ndisc = { radius = 0.1 }\n[[bodies]]\n";
  const std::string wide = "disc = { radius = 0.4 }\nposition = [0, 2]\n";
  EXPECT_THAT(faults_of(two + "name = \"ab\"\n" + wide), Contains(HasSubstr("6:1 body \"ab\": is 0.8 m")));
  EXPECT_THAT(faults_of(two + wide), Contains(HasSubstr("6:1 body \"body1\": is 0.8 m")));
  EXPECT_THAT(faults_of(two + "name = \"c\"\ngrid = { columns = 1, rows = 2, spacing = [0, 2] }\n" + wide),
              Contains(HasSubstr("6:1 body \"c[0]\": is 0.8 m")));
}

TEST(Scatter, CopiesKeepClearOfWhereAMovingSiteStarts) {
  const Scene scene = parse_scene(R"([[sites]]
name = "box"
box = { width = 1, height = 1 }
motion = { x = "2 + 0*t" }
[[bodies]]
name = "b"
disc = { radius = 0.05 }
scatter = { count = 30, region = [[1.2, -1], [2.8, 1]] }
)",
                                  "t");
  ASSERT_EQ(scene.world.bodies.size(), 30u);
  for (const Body& body : scene.world.bodies) {
    const Vec2 p = body.initial.pose.position;
    EXPECT_GT(std::max(std::abs(p.x() - 2.0), std::abs(p.y())), 0.53) << p.transpose();
  }
}

TEST(Scatter, ARegionOfOnePlaceHoldsOnePoint) {
  const auto scattered = [](int count) {
    return "[[sites]]\npoint = [0, 0]\nscatter = { count = " + std::to_string(count) +
           ", region = [[3, 4], [3, 4]] }\n" + with_ball("");
  };
  EXPECT_EQ(parse_scene(scattered(1), "t").world.sites.at(0).pose.position, Vec2(3, 4));
  EXPECT_THAT(faults_of(scattered(2)), Contains(HasSubstr("scatter: the region is too small")));
}

// A bin as thick as the world is wide: every place above the position lies in it.
TEST(Scatter, APileWithoutRoomIsRefusedSoon) {
  const std::string text =
      "[world]\ngravity = [0, -9.81]\n[[sites]]\npolyline = [[-2.2, 5], [-2.2, 0], [2.2, 0], [2.2, 5]]\n"
      "radius = 1e15\n[[bodies]]\ndisc = { radius = 0.2 }\npile = { count = 70, width = 3.6 }\n";
  const std::clock_t begin = std::clock();
  EXPECT_THAT(faults_of(text), Contains(HasSubstr("pile: there is no room above; given 70 copies")));
  // It takes a few milliseconds; asking every height for every place took more than a second.
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 0.5);
}

TEST(Scatter, APileRisesOutOfWhatBuriesItsBase) {
  const Scene scene = parse_scene(
      "[world]\ngravity = [0, -9.81]\n[[sites]]\nsegment = [[-9, 0], [9, 0]]\nradius = 40\n[[bodies]]\n"
      "disc = { radius = 0.2 }\npile = { count = 20, width = 3.6 }\n",
      "t");
  ASSERT_EQ(scene.world.bodies.size(), 20u);
  for (const Body& body : scene.world.bodies) EXPECT_GT(body.initial.pose.position.y(), 40.2);
}

TEST(SceneNotes, APositionThatScatterDoesNotUseIsToldByName) {
  const std::string scattered =
      "disc = { radius = 0.1 }\nscatter = { count = 2, region = [[0, 0], [3, 3]] }\n";
  EXPECT_THAT(parse_scene("[[bodies]]\nposition = [1, 1]\n" + scattered, "t").notes,
              Contains(HasSubstr("position of \"body0\" is not used")));
  EXPECT_TRUE(parse_scene("[[bodies]]\n" + scattered, "t").notes.empty());
}

TEST(Points, TooManyAreToldWithTheirMost) {
  const auto told = [](const std::string& value) {
    TomlDocument document("p = " + value, {});
    std::vector<Vec2> out;
    points(2, 3).read(*document.root().get("p"), document, "p", out);
    try {
      document.faults().throw_if_any("t");
    } catch (const SceneFaults& faults) {
      return std::string(faults.what());
    }
    return std::string("no fault");
  };
  EXPECT_EQ(told("[[0, 0], [1, 0], [2, 0]]"), "no fault");
  EXPECT_THAT(told("[[0, 0], [1, 0], [2, 0], [3, 0]]"),
              HasSubstr("p: too many points; given an array of 4, allowed: at most 3 points"));
  EXPECT_THAT(told("[[0, 0]]"), HasSubstr("p: wrong type; given an array of 1, allowed: 2 or more points"));
}

}  // namespace
}  // namespace brink::scene_file_test
