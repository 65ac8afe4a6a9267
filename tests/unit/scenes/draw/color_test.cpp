// Colours: the conversion against published values, and the order that the distance map promises.
#include "brink/scenes/draw/color.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace brink::draw::color_test {
namespace {

World named(std::initializer_list<const char*> names) {
  World world;
  for (const char* name : names) {
    Body body;
    body.name = name;
    world.bodies.push_back(body);
  }
  return world;
}

/// CIE lightness L* of an sRGB colour, by its definition (IEC 61966-2-1 and CIE 15): independent of OKLab.
double lightness(const Color& c) {
  const auto linear = [](double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); };
  const double y = 0.2126 * linear(c.red) + 0.7152 * linear(c.green) + 0.0722 * linear(c.blue);
  return y > 216.0 / 24389.0 ? 116.0 * std::cbrt(y) - 16.0 : 24389.0 / 27.0 * y;
}

TEST(Oklch, PrimariesComeOutAsPublished) {
  // Ottosson 2020; the same figures in CSS Color 4: red is oklch(0.62796 0.25768 29.234), blue (0.45201
  // 0.31321 264.05)
  EXPECT_EQ((Oklch{0.62796, 0.25768, 29.234}.rgb().argb()), 0xffff0000U);
  EXPECT_EQ((Oklch{0.45201, 0.31321, 264.052}.rgb().argb()), 0xff0000ffU);
  EXPECT_EQ((Oklch{1.0, 0.0, 0.0}.rgb().argb()), 0xffffffffU);
  EXPECT_EQ((Oklch{0.0, 0.0, 0.0}.rgb().argb()), 0xff000000U);
}

TEST(Oklch, TooMuchChromaIsTakenBackWithoutChangingLightness) {
  const Color wild = Oklch{0.7, 0.5, 140.0}.rgb(), tame = Oklch{0.7, 0.12, 140.0}.rgb();
  EXPECT_NEAR(lightness(wild), lightness(tame), 4.0);
}

TEST(DistanceColor, LightnessGrowsEverywhereAndNearlyEvenly) {
  for (int k = 1; k <= 100; ++k) {
    const double step = lightness(distance_color(k / 100.0)) - lightness(distance_color((k - 1) / 100.0));
    EXPECT_GT(step, 0.3) << k;
    EXPECT_LT(step, 1.4) << k;
  }
}

TEST(DistanceColor, OutsideZeroToOneIsClamped) {
  EXPECT_EQ(distance_color(-3.0).argb(), distance_color(0.0).argb());
  EXPECT_EQ(distance_color(7.0).argb(), distance_color(1.0).argb());
}

TEST(Palette, CopiesShareAHueAndDifferInShade) {
  const Palette palette(named({"disc[0]", "disc[1]", "box[0]"}));
  EXPECT_NEAR(palette.body(0).hue, palette.body(1).hue, 20.0);
  EXPECT_NE(palette.body(0).lightness, palette.body(1).lightness);
  EXPECT_GT(std::abs(palette.body(0).hue - palette.body(2).hue), 30.0);
}

TEST(Palette, BodiesOfOneNameAloneGetDifferentHues) {
  const Palette palette(named({"ball_1", "ball_2", "ball_3"}));
  EXPECT_GT(std::abs(palette.body(0).hue - palette.body(1).hue), 30.0);
  EXPECT_GT(std::abs(palette.body(1).hue - palette.body(2).hue), 30.0);
}

}  // namespace
}  // namespace brink::draw::color_test
