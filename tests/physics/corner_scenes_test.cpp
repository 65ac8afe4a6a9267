// Scenes that users wrote, which once ended early, or went through a wall, or did not end: seen from outside at every frame.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "brink/scenes/scene/scene.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/worlds.h"

namespace brink::corner_scenes_test {
namespace {

/// Runs to the end, a frame every so many seconds, each seen from outside.
RunSummary watched(const Scene& scene, double until, double frame_interval, double* x = nullptr) {
  Simulator simulator(scene.world, scene.solver);
  outside::FrameWatch watch(scene.world, until, 1e-9);
  RunOptions options = testing::until(until);
  options.frame_interval = frame_interval;
  const RunSummary summary = simulator.run(options, &watch);
  EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
  EXPECT_TRUE(watch.sound()) << watch.report();
  if (x) *x = simulator.state(0).pose.position.x();
  return summary;
}

/// It slides along the one piece of a polyline into the other: its corner fills the hollow one of the wire.
TEST(CornerScenes, ABoxSlidesIntoTheCornerOfAPolyline) {
  for (const char* friction : {"0.0", "0.05"})
    for (const char* restitution : {"0.0", "0.25", "0.5"})
      for (const char* speed : {"1.0", "3.0"}) {
        const Scene scene = parse_scene(std::string(R"(
[world]
duration = 4.0
gravity = [0.0, -10.0]
[materials.default]
restitution = )") + restitution +
                                            "\nfriction = " + friction + R"(
[[sites]]
polyline = [[-14.0, 0.0], [4.0, 0.0], [4.0, 6.0]]
[[bodies]]
box = { width = 1.0, height = 0.5 }
position = [2.0, 0.25]
velocity = [)" + speed + ", 0.0]\n",
                                        "corner.toml");
        SCOPED_TRACE(std::string(friction) + " " + restitution + " " + speed);
        double x = 0.0;
        watched(scene, 4.0, 0.002, &x);
        EXPECT_LE(x, 3.5 + 1e-9);
        if (std::string(restitution) == "0.0" && std::string(friction) == "0.0") {
          EXPECT_NEAR(x, 3.5, 1e-9);
        }
      }
}

// A square of wire in a corner of wire that it fills: each of the two corners is in the other, and neither was held.
TEST(CornerScenes, ASquareOfWireSlidesIntoTheCornerOfAPolyline) {
  for (const char* friction : {"0.0", "0.05"})
    for (const char* speed : {"0.5", "1.0", "3.0"}) {
      const Scene scene = parse_scene(std::string(R"(
[world]
duration = 5.0
gravity = [0.0, -10.0]
[materials.default]
restitution = 0.0
friction = )") + friction + R"(
[[sites]]
polyline = [[-14.0, 0.0], [4.0, 0.0], [4.0, 6.0]]
[[bodies]]
chain = { vertices = [[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]], closed = true }
position = [2.0, 0.25]
velocity = [)" + speed + ", 0.0]\n",
                                      "square.toml");
      SCOPED_TRACE(std::string(friction) + " " + speed);
      double x = 0.0;
      watched(scene, 5.0, 0.002, &x);
      EXPECT_LE(x, 3.75 + 1e-9);
    }
}

const char* const kAnLFallsWithItsNotchOnAPoint = R"scene(
[world]
duration = 3.0
gravity = [0.0, -9.8125]
[output]
frame_interval = 0.001953125
[materials.m]
restitution = 0.0
friction = 1.0
[[sites]]
name = "o0"
point = [1.8909759521484375, 0.8727502822875977]
material = "m"
[[sites]]
name = "o1"
point = [0.6700353622436523, 2.226578712463379]
material = "m"
[[bodies]]
name = "b0"
polygons = [{ vertices = [[0.0, 0.0], [0.7660684585571289, 0.0], [0.7660684585571289, 0.2553558349609375], [0.0, 0.2553558349609375]] }, { vertices = [[0.0, 0.0], [0.2553558349609375, 0.0], [0.2553558349609375, 0.7660684585571289], [0.0, 0.7660684585571289]] }]
position = [0.5882749557495117, 4.060018539428711]
angle = 0.0
mass = 1.0
velocity = [0.5675077438354492, 0.33870792388916016]
angular_velocity = 0.0
material = "m"
)scene";

TEST(CornerScenes, AnLFallsWithItsNotchOnAPoint) {
  watched(parse_scene(kAnLFallsWithItsNotchOnAPoint, "scene.toml"), 3.0, 0.001953125);
}

const char* const kAnLAndARingMeetAsTheyFall = R"scene(
[world]
duration = 3.0
gravity = [0.0, -9.8125]
[output]
frame_interval = 0.001953125
[materials.m]
restitution = 0.0
friction = 0.0
[[bodies]]
name = "b0"
polygons = [{ vertices = [[0.0, 0.0], [0.7639751434326172, 0.0], [0.7639751434326172, 0.25465869903564453], [0.0, 0.25465869903564453]] }, { vertices = [[0.0, 0.0], [0.25465869903564453, 0.0], [0.25465869903564453, 0.7639751434326172], [0.0, 0.7639751434326172]] }]
position = [1.4616165161132812, 4.899838447570801]
angle = 0.0
mass = 1.0
velocity = [1.9798479080200195, -1.2446718215942383]
angular_velocity = -4.140273094177246
material = "m"
[[bodies]]
name = "b1"
chain = { vertices = [[0.4451780319213867, 0.0], [-0.22258853912353516, 0.38553524017333984], [-0.22258949279785156, -0.38553524017333984]], closed = true }
position = [3.0329723358154297, 3.8545589447021484]
angle = 2.303380012512207
mass = 1.0
velocity = [-1.0396270751953125, 1.536153793334961]
angular_velocity = 0.0
material = "m"
)scene";

TEST(CornerScenes, AnLAndARingMeetAsTheyFall) {
  watched(parse_scene(kAnLAndARingMeetAsTheyFall, "scene.toml"), 3.0, 0.001953125);
}

const char* const kAnLTurnsOnAThickArc = R"scene(
[world]
duration = 3.0
gravity = [0.0, 0.0]
[output]
frame_interval = 0.015625
[materials.m]
restitution = 0.0
friction = 0.0
[[sites]]
name = "o0"
arc = { center = [0.1766805648803711, 3.6362133026123047], radius = 0.5, from_deg = 323.85075759887695, to_deg = 553.276873588562 }
material = "m"
[[bodies]]
name = "b0"
polygons = [{ vertices = [[0.0, 0.0], [0.73138427734375, 0.0], [0.73138427734375, 0.24379444122314453], [0.0, 0.24379444122314453]] }, { vertices = [[0.0, 0.0], [0.24379444122314453, 0.0], [0.24379444122314453, 0.73138427734375], [0.0, 0.73138427734375]] }]
position = [-2.1214609146118164, 1.5824871063232422]
angle = 0.0
mass = 2.018278121948242
velocity = [1.7762155532836914, 1.7316474914550781]
angular_velocity = 0.0
material = "m"
)scene";

TEST(CornerScenes, AnLTurnsOnAThickArc) {
  watched(parse_scene(kAnLTurnsOnAThickArc, "scene.toml"), 3.0, 0.015625);
}

const char* const kATriangleSlidesIntoTheNotchOfAnL = R"scene(
[world]
duration = 3.0
gravity = [0.0, -9.8125]
[output]
frame_interval = 0.001953125
[materials.m]
restitution = 0.5
friction = 0.2896251678466797
[[sites]]
name = "walls"
polyline = [[-4.0, 1.5], [-2.0, 0.25], [-1.0, 0.5], [0.0, 0.0], [1.0, 0.5], [2.0, 0.0], [4.0, 1.0], [4.0, 6.0], [-4.0, 6.0], [-4.0, 1.5]]
material = "m"
[[bodies]]
name = "b0"
polygon = { vertices = [[0.0, 0.0], [0.3394021987915039, 0.0], [0.0508270263671875, 0.2673015594482422]] }
position = [1.4088268280029297, 3.903371810913086]
angle = 0.0
mass = 1.0
velocity = [0.0, 0.0]
angular_velocity = 1.3877315521240234
material = "m"
[[bodies]]
name = "b5"
polygons = [{ vertices = [[0.0, 0.0], [0.36913585662841797, 0.0], [0.36913585662841797, 0.12304496765136719], [0.0, 0.12304496765136719]] }, { vertices = [[0.0, 0.0], [0.12304496765136719, 0.0], [0.12304496765136719, 0.36913585662841797], [0.0, 0.36913585662841797]] }]
position = [3.1285343170166016, 4.297320365905762]
angle = 0.0
mass = 1.0
velocity = [1.5588569641113281, -0.7379674911499023]
angular_velocity = 0.0
material = "m"
)scene";

TEST(CornerScenes, ATriangleSlidesIntoTheNotchOfAnL) {
  watched(parse_scene(kATriangleSlidesIntoTheNotchOfAnL, "scene.toml"), 3.0, 0.001953125);
}

const char* const kABoxSlidesInACupOfWire = R"scene(
[world]
duration = 3.0
gravity = [0.0, -10.0]
[output]
frame_interval = 0.00390625
[materials.m]
restitution = 0.0
friction = 0.0
[[sites]]
segment = [[-20.0, 0.0], [20.0, 0.0]]
material = "m"
name = "s0"
[[bodies]]
chain = { vertices = [[-1.0, 1.0], [-1.0, 0.0], [1.0, 0.0], [1.0, 1.0]] }
centered = false
position = [0.0, 0.0]
velocity = [2.0, 0.0]
mass = 5.0
material = "m"
name = "b0"
[[bodies]]
box = { width = 0.5, height = 0.5 }
position = [0.0, 0.25]
material = "m"
name = "b1"
)scene";

TEST(CornerScenes, ABoxSlidesInACupOfWire) {
  watched(parse_scene(kABoxSlidesInACupOfWire, "scene.toml"), 3.0, 0.001953125);
}

/// A disc so slow that a tenth of its size takes it a month: sites that move by formulas are not followed that far.
const char* const kSlow = R"scene(
[world]
duration = 3.0
gravity = [0.0, 0.0]
[output]
frame_interval = 0.0078125
[materials.m]
restitution = 0.0
friction = 0.0
[[sites]]
name = "walls"
polyline = [[-4.0, 1.5], [-2.0, 0.25], [-1.0, 0.5], [0.0, 0.0], [1.0, 0.5], [2.0, 0.0], [4.0, 1.0], [4.0, 6.0], [-4.0, 6.0], [-4.0, 1.5]]
material = "m"
[[sites]]
name = "o0"
segment = [[-0.35919952392578125, 3.9693479537963867], [-0.5374889373779297, 4.953326225280762]]
radius = 0.0625
material = "m"
motion = { angle = "0.263*t" }
[[sites]]
name = "o1"
segment = [[-2.090949058532715, 3.2365589141845703], [-3.0647287368774414, 3.46405029296875]]
radius = 0.0625
material = "m"
motion = { angle = "-0.549*t" }
[[sites]]
name = "o2"
arc = { center = [2.5774383544921875, 4.325260162353516], radius = 0.5, from_deg = 180.24609470367432, to_deg = 434.738507270813 }
material = "m"
motion = { x = "0.482*sin(1.654*t)", angle = "0.457*t" }
[[bodies]]
name = "b3"
disc = { radius = 0.29671669006347656 }
position = [-1.5483617782592773, 3.6089391708374023]
angle = 0.0
mass = 1.6662893295288086
velocity = [-0.8095083236694336, 0.4551420211791992]
angular_velocity = 0.0
material = "m"
lock = ["angle"]
[[bodies]]
name = "b4"
box = { width = 0.5972690582275391, height = 0.5219316482543945, radius = 0.07542896270751953 }
position = [0.8730630874633789, 4.618137359619141]
angle = 1.997838020324707
mass = 1.4727144241333008
velocity = [-1.27008056640625, 0.398101806640625]
angular_velocity = 0.0
material = "m"
)scene";

TEST(CornerScenes, StepsOfWhatHardlyMovesAreNotEndless) {
  const Scene scene = parse_scene(kSlow, "slow.toml");
  const RunSummary summary = watched(scene, 3.0, 0.0078125);
  EXPECT_LT(summary.work.pair_searches, 1000000U);
}

// A rod slides down a slope of wire into its hollow corner. The vertex there was taken to be on the other side of the rod,
// whose edge lies along the slope: on that of the walls' middle.
TEST(CornerScenes, ARodComesToTheHollowCornerOfASlopeOfWire) {
  const Scene scene = parse_scene(R"scene(
[world]
duration = 3.0
gravity = [0.0, -9.8125]
[materials.default]
restitution = 0.5
friction = 0.0
[[sites]]
polyline = [[-4.0, 1.5], [-2.0, 0.25], [-1.0, 0.5], [0.0, 0.0], [1.0, 0.5], [2.0, 0.0], [4.0, 1.0], [4.0, 6.0], [-4.0, 6.0], [-4.0, 1.5]]
[[bodies]]
chain = { vertices = [[0.0, 0.0], [0.23570823669433594, -0.11293220520019531], [0.1658344268798828, -0.36478519439697266], [-0.09104537963867188, -0.31656932830810547]] }
position = [0.19448566436767578, 4.518935203552246]
mass = 1.0
velocity = [-1.1390771865844727, 1.8957061767578125]
[[bodies]]
chain = { vertices = [[0.0, 0.0], [-0.5164690017700195, 0.2387237548828125]] }
position = [-1.5174198150634766, 4.39116096496582]
mass = 1.0
)scene",
                                  "slope.toml");
  watched(scene, 3.0, 0.001953125);
}

const char* const kALightTriangleUnderAHeavyBox = R"scene([world]
duration = 2.0
gravity = [0, -9.81]
[materials.m]
restitution = 0
friction = 0
[[sites]]
segment = [[-2, 0], [2, 0]]
material = "m"
[[bodies]]
name = "light"
polygon = { vertices = [[0, 0], [0.55, 0], [0.35, 0.4]] }
position = [0, 0.5]
mass = 1.0
material = "m"
[[bodies]]
name = "heavy"
box = { width = 0.4, height = 0.3 }
position = [0, 1.5]
mass = 100000.0
velocity = [0, -2]
material = "m"
[[bodies]]
name = "side"
disc = { radius = 0.1 }
position = [1, 0.3]
mass = 100000.0
velocity = [-1.5, 0]
material = "m"
)scene";

const char* const kALightBoxUnderAHeavyDisc = R"scene([world]
duration = 2.0
gravity = [0, -9.81]
[materials.m]
restitution = 0
friction = 0.5
[[sites]]
segment = [[-2, 0], [2, 0]]
material = "m"
[[bodies]]
name = "light"
box = { width = 0.4, height = 0.3 }
position = [0, 0.5]
mass = 1e-06
material = "m"
[[bodies]]
name = "heavy"
disc = { radius = 0.2 }
position = [0.2, 1.5]
mass = 1000.0
material = "m"
[[bodies]]
name = "side"
disc = { radius = 0.1 }
position = [1, 0.12]
mass = 1000000.0
velocity = [-1.5, 0]
material = "m"
)scene";

// The forces of a step were no numbers there, and neither was then the state.
TEST(CornerScenes, ALightBodyBetweenHeavyOnesHasAState) {
  for (const char* text : {kALightTriangleUnderAHeavyBox, kALightBoxUnderAHeavyDisc})
    watched(parse_scene(text, "light.toml"), 2.0, 0.01);
}

const char* const kAFastDrum = R"scene([world]
duration = 3.0
gravity = [0.0, -9.8125]
restitution_rule = "geometric_mean"
friction_rule = "mean"
[output]
frame_interval = 0.015625
[materials.m]
restitution = 0.5
friction = 0.25
[materials.n]
restitution = 0.13337993621826172
friction = 0.4746675491333008
[[sites]]
name = "f"
disc = { radius = 1.5 }
inside_of = true
position = [0.0, 1.5]
motion = { angular_velocity = 4.736555099487305 }
material = "m"
[[bodies]]
name = "b0"
polygon = { vertices = [[0.0, 0.0], [0.31661415100097656, 0.0], [0.1289987564086914, 0.15578651428222656]] }
position = [-0.1282825469970703, 1.4394874572753906]
angle = 0.0
mass = 1.0
material = "n"
angular_velocity = 2.10811710357666
[[bodies]]
name = "b1"
polygon = { vertices = [[0.1530590057373047, 0.0], [0.07652950286865234, 0.1325531005859375], [-0.07652950286865234, 0.1325531005859375], [-0.1530590057373047, 0.0], [-0.07652950286865234, -0.1325531005859375], [0.07652950286865234, -0.1325531005859375]] }
position = [-0.6453275680541992, 1.3079090118408203]
angle = 0.0
mass = 1.0
material = "m"
[[bodies]]
name = "b2"
box = { width = 0.3207664489746094, height = 0.20254135131835938 }
position = [0.40953922271728516, 2.040302276611328]
angle = 0.0
mass = 1.0
material = "m"
angular_velocity = 3.373600959777832
[[bodies]]
name = "b3"
capsule = { length = 0.1906108856201172, radius = 0.04084491729736328 }
position = [-0.19757747650146484, 2.0838871002197266]
angle = 1.729466438293457
mass = 1.721510887145996
material = "n"
velocity = [-0.8208951950073242, -1.9248476028442383]
[[bodies]]
name = "b4"
box = { width = 0.33956241607666016, height = 0.3451824188232422 }
position = [0.50360107421875, 1.115443229675293]
angle = 0.0
mass = 1.0
material = "m"
velocity = [-0.4866819381713867, 0.7779407501220703]
angular_velocity = -3.2100439071655273
)scene";

// The corner of a box, sunk beside the tip of a triangle by less than the contact tolerance, came out on the tip's other side,
// and the two went into each other by 5e-7 m, between the frames of 1/64 s.
TEST(CornerScenes, ACornerThatHasSunkBesideATipStaysOnItsSide) {
  const Scene scene = parse_scene(kAFastDrum, "drum.toml");
  Simulator simulator(scene.world, scene.solver);
  RunOptions options = testing::until(3.0);
  options.frame_interval = 0.0005;
  const RunSummary summary = simulator.run(options);
  EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
}

}  // namespace
}  // namespace brink::corner_scenes_test
