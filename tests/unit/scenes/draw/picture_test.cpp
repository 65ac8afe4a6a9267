// What is on the pictures: sizes, ink where bodies are, order of colours, faults told.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <fstream>
#include <set>

#include "brink/core/shapes/shapes.h"
#include "brink/scenes/draw/color.h"
#include "brink/scenes/draw/draw.h"

namespace brink::picture_test {
namespace {

using ::testing::HasSubstr;

std::shared_ptr<const Outline> outline_of(Shape shape) {
  return std::make_shared<const Outline>(std::move(shape.outline));
}

/// A disc of radius 1 at the origin and a square of side 1 at (4, 0), alone in the plane.
struct TwoBodies {
  World world;
  std::vector<BodyState> states{{}, {}};
  DrawOptions options;

  TwoBodies() {
    Body disc, square;
    disc.name = "disc";
    disc.outline = outline_of(make_disc(1.0));
    square.name = "square";
    square.outline = outline_of(make_box(1.0, 1.0));
    world.bodies = {disc, square};
    states[1].pose.position = {4.0, 0.0};
    options.size = {300, 150};
    options.caption = false;
    options.margin = 0.0;
    // 50 pixels a metre: world (x, y) lies at column 50 (x + 1), row 50 (1.5 - y)
    options.view = Box{{-1.0, -1.5}, {5.0, 1.5}};
  }

  Picture draw(const std::string& layer) {
    options.layer = parse_layer(layer);
    return draw_scene(world, states, {}, options);
  }
};

/// Relative luminance of a pixel, 0..1 (sRGB, gamma left in: the order is what matters).
double brightness(std::uint32_t pixel) {
  return (0.2126 * ((pixel >> 16) & 0xff) + 0.7152 * ((pixel >> 8) & 0xff) + 0.0722 * (pixel & 0xff)) / 255.0;
}

/// Cairo keeps colours in whole steps of its own: one step of 255 in a channel either way is the same colour.
void expect_color(std::uint32_t pixel, const draw::Oklch& color) {
  const std::uint32_t wanted = color.rgb().argb();
  for (const int shift : {0, 8, 16})
    EXPECT_NEAR((pixel >> shift) & 0xff, (wanted >> shift) & 0xff, 1) << "channel " << shift / 8;
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

// Left out: the picture is the same whatever its name is. Beside the other it is there.
TEST(Names, OneThatWouldCoverAnotherIsLeftOut) {
  TwoBodies two;
  two.options.names = true;
  const auto drawn = [&](double apart, const char* name) {
    two.states[1].pose.position = {apart, 0.0};
    two.world.bodies[1].name = name;
    return two.draw("scene").pixels;
  };
  EXPECT_EQ(drawn(0.2, "square"), drawn(0.2, "quadrat"));
  EXPECT_NE(drawn(4.0, "square"), drawn(4.0, "quadrat"));
}

TEST(Png, FileHasTheSignatureAndTheSizeAsked) {
  // PNG (ISO/IEC 15948): eight bytes of signature, then IHDR with width and height at bytes 16 and 20
  TwoBodies two;
  two.options.layer = parse_layer("scene");
  const auto file = std::filesystem::temp_directory_path() / "brink_draw_picture_test.png";
  draw_png(file, two.world, two.states, {}, two.options);
  std::ifstream in(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  std::filesystem::remove(file);
  ASSERT_GT(bytes.size(), 32U);
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(big_endian(bytes, 16), 300U);
  EXPECT_EQ(big_endian(bytes, 20), 150U);
}

TEST(Png, FileThatCannotBeWrittenIsAnIoError) {
  TwoBodies two;
  EXPECT_THROW(draw_png("/nowhere/at/all.png", two.world, two.states, {}, two.options), IoError);
}

TEST(SceneLayer, BodiesAreInTheirOwnColorsAndTheGroundIsLighter) {
  TwoBodies two;
  const Picture picture = two.draw("scene");
  const draw::Palette palette(two.world);
  expect_color(picture.at(50, 95), palette.body(0));   // 0.4 m below the disc's centre: no mark there
  expect_color(picture.at(250, 90), palette.body(1));  // 0.3 m below the square's centre
  for (const auto& [column, row] : {std::pair{5, 5}, {150, 40}, {295, 145}})
    EXPECT_GT(brightness(picture.at(column, row)), 0.8) << column << "," << row;
}

// Cells are rendered twice as finely as the picture, but no wider than a pass may be.
TEST(SceneLayer, WidestPictureHasItsCells) {
  TwoBodies two;
  two.options.size = {8192, 64};
  for (const char* layer : {"scene", "pass:disc"}) {
    const Picture picture = two.draw(layer);
    EXPECT_EQ(picture.width, 8192) << layer;
    const std::set<std::uint32_t> colors(picture.pixels.begin(), picture.pixels.end());
    EXPECT_GT(colors.size(), 10U) << layer;
  }
}

TEST(SceneLayer, EdgesAreCrispAndWhereTheyBelong) {
  // along the row of the centres the disc's edge is at x = 1 (column 100) and the square's at 3.5 (column
  // 225)
  TwoBodies two;
  const Picture picture = two.draw("scene");
  for (const int edge : {100, 225}) {
    double darkest = 1.0;
    for (int column = edge - 2; column <= edge + 1; ++column)
      darkest = std::min(darkest, brightness(picture.at(column, 80)));
    EXPECT_LT(darkest, 0.45) << edge;
  }
  EXPECT_GT(brightness(picture.at(106, 80)), 0.8);
}

TEST(SceneLayer, CellsMeetWhereBothAreEquallyNear) {
  // between disc (edge x = 1) and square (edge x = 3.5) the line of equal distance crosses y = 0 at x = 2.25
  TwoBodies two;
  two.options.diagram = true;
  const Picture picture = two.draw("color");
  const int middle = 162;  // column of x = 2.25, less half a pixel
  EXPECT_NE(picture.at(middle - 3, 75), picture.at(middle + 3, 75));
  EXPECT_EQ(picture.at(middle - 3, 75), picture.at(110, 75));
  EXPECT_EQ(picture.at(middle + 3, 75), picture.at(220, 75));
}

// What stands on a floor is as near as the floor to all that lies behind both: there every pixel of a row is the same.
TEST(SceneLayer, BehindAFloorIsNoCellOfWhatStandsOnIt) {
  World world;
  Body stone;
  stone.name = "stone";
  stone.outline = outline_of(make_box(0.8, 0.2, 0.05));
  world.bodies = {stone};
  FixedSite floor;
  floor.name = "floor";
  floor.outline = outline_of(make_segment({-9.0, 0.0}, {9.0, 0.0}));
  world.sites = {floor};
  std::vector<BodyState> states(1);
  states[0].pose.position = {0.0123, 0.15};
  DrawOptions options;
  options.size = {300, 200};
  options.caption = false;
  options.margin = 0.0;
  options.view = Box{{-1.5, -1.5}, {1.5, 0.5}};  // 100 pixels a metre: the floor is row 50
  const std::vector<Pose> sites(1);
  const Picture picture = draw_scene(world, states, sites, options);
  for (int row = 55; row < 200; ++row)
    for (int column = 0; column < 300; ++column)
      ASSERT_EQ(picture.at(column, row), picture.at(0, row)) << "column " << column << " of row " << row;
  EXPECT_NE(picture.at(150, 20), picture.at(0, 20)) << "above is the stone's cell";
}

TEST(ColorLayer, HoldsOneColorASiteOutsideAndOneInside) {
  // the disc is one site, the square four: five cells, each in two tones (outside and inside its solid)
  TwoBodies two;
  const Picture picture = two.draw("color");
  const std::set<std::uint32_t> colors(picture.pixels.begin(), picture.pixels.end());
  EXPECT_EQ(colors.size(), 10U);
}

TEST(DepthLayer, GetsLighterAlongALineAwayFromADisc) {
  TwoBodies two;
  two.world.bodies.pop_back();
  two.states.pop_back();
  const Picture picture = two.draw("depth");
  double last = brightness(picture.at(104, 75));
  for (int column = 106; column < 300; column += 2) {
    const double now = brightness(picture.at(column, 75));
    EXPECT_GE(now, last) << column;
    last = now;
  }
  EXPECT_GT(last, brightness(picture.at(104, 75)) + 0.5);
  EXPECT_LT(brightness(picture.at(50, 75)), 0.05);  // inside the solid
}

TEST(PassLayer, LeavesTheBodyOut) {
  // seen for itself, the disc fills its middle; in its own pass the square's cell shows there
  TwoBodies two;
  const Picture scene = two.draw("scene"), pass = two.draw("pass:disc");
  const draw::Palette palette(two.world);
  expect_color(scene.at(65, 95), palette.body(0));
  EXPECT_GT(brightness(pass.at(65, 95)), 0.7);
  expect_color(pass.at(250, 90), palette.body(1));
}

TEST(PassLayer, WithoutAViewShowsTheBodysSurroundings) {
  TwoBodies two;
  two.options.view.reset();
  const Picture pass = two.draw("pass:square");
  // the square's corner samples are dots in a darker tone of its colour, about the picture's middle
  std::set<std::uint32_t> middle;
  for (int row = 40; row < 110; ++row)
    for (int column = 115; column < 185; ++column) middle.insert(pass.at(column, row));
  EXPECT_GT(middle.size(), 5U);
}

TEST(Pictures, UnknownBodyIsToldWithThoseThereAre) {
  TwoBodies two;
  try {
    two.draw("pass:ball");
    FAIL() << "no BadInput";
  } catch (const BadInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("pass:ball"));
    EXPECT_THAT(error.what(), HasSubstr("disc, square"));
  }
}

TEST(Pictures, StatesAndPosesThatDoNotFitAreRefused) {
  TwoBodies two;
  two.states.pop_back();
  EXPECT_THROW(two.draw("scene"), BadInput);
  TwoBodies wild;
  wild.states[0].pose.position.x() = std::nan("");
  EXPECT_THROW(wild.draw("scene"), BadInput);
  TwoBodies sites;
  sites.options.layer = parse_layer("scene");
  const std::array<Pose, 1> poses{};
  EXPECT_THROW(draw_scene(sites.world, sites.states, poses, sites.options), BadInput);
}

TEST(Pictures, CaptionTakesAStripAtTheBottomAndWritesInIt) {
  TwoBodies two;
  two.options.caption = true;
  two.options.title = "two bodies";
  two.options.time = 1.5;
  const Picture picture = two.draw("scene");
  int dark = 0;
  for (int row = 128; row < 150; ++row)
    for (int column = 0; column < 150; ++column) dark += brightness(picture.at(column, row)) < 0.5;
  EXPECT_GT(dark, 60);
}

TEST(Pictures, EmptyWorldGivesPlainPaper) {
  DrawOptions options;
  options.size = {64, 64};
  const Picture picture = draw_scene(World{}, {}, {}, options);
  EXPECT_EQ(std::set<std::uint32_t>(picture.pixels.begin(), picture.pixels.end()).size(), 1U);
}

TEST(Pictures, SameWishGivesTheSamePixels) {
  TwoBodies two;
  EXPECT_EQ(two.draw("scene").pixels, two.draw("scene").pixels);
}

// A tick at the very rim has no number: "-1" cut in half would say 1.
TEST(Picture, AxesHaveWholeNumbers) {
  TwoBodies two;
  two.world.bodies.clear();
  two.states.clear();
  two.options.diagram = false;
  const Picture bare = two.draw("scene");
  two.options.axes = true;
  const Picture axes = two.draw("scene");
  const auto inked = [&](int from, int to) {
    int count = 0;
    for (int row = axes.height - 20; row < axes.height - 7; ++row)
      for (int column = from; column < to; ++column) count += axes.at(column, row) != bare.at(column, row);
    return count;
  };
  EXPECT_EQ(inked(0, 30), 0);
  EXPECT_EQ(inked(270, 300), 0);
  EXPECT_GT(inked(30, 270), 20) << "the numbers between are there";
}

}  // namespace
}  // namespace brink::picture_test
