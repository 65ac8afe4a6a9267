#include "brink/core/shapes/svg_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "brink/core/base/error.h"
#include "brink/core/shapes/shapes.h"
#include "tests/support/seeded_random.h"

namespace brink::svg_path_test {
namespace {

using ::testing::HasSubstr;
constexpr double pi = std::numbers::pi;

std::string fault(const std::string& d) {
  try {
    parse_svg_path(d);
  } catch (const BadInput& e) {
    return e.what();
  }
  return "no fault";
}

TEST(SvgPath, AbsoluteAndRelativeCommandsSayTheSame) {
  const auto absolute =
      parse_svg_path("M1 2L3 4H5V6C7 8 9 10 11 12S13 14 15 16Q17 18 19 20T21 22A2 3 30 0 1 23 24Z");
  const auto relative = parse_svg_path("m1 2l2 2h2v2c2 2 4 4 6 6s2 2 4 4q2 2 4 4t2 2a2 3 30 0 1 2 2z");
  ASSERT_EQ(absolute.size(), 1u);
  ASSERT_EQ(relative.size(), 1u);
  ASSERT_EQ(absolute[0].pieces.size(), relative[0].pieces.size());
  for (std::size_t k = 0; k < absolute[0].pieces.size(); ++k) {
    const PathPiece &a = absolute[0].pieces[k], &r = relative[0].pieces[k];
    EXPECT_EQ(a.kind, r.kind);
    EXPECT_EQ(a.to, r.to);
    EXPECT_LT((a.control_1 - r.control_1).norm() + (a.control_2 - r.control_2).norm(), 1e-13);
  }
  EXPECT_TRUE(absolute[0].closed);
}

TEST(SvgPath, NumbersNeedNoSeparators) {
  const auto p = parse_svg_path("M.5.5-1e1-2.5E-1+3,4");
  ASSERT_EQ(p[0].pieces.size(), 2u);
  EXPECT_EQ(p[0].pieces[0].from, Vec2(0.5, 0.5));
  EXPECT_EQ(p[0].pieces[0].to, Vec2(-10, -0.25));
  EXPECT_EQ(p[0].pieces[1].to, Vec2(3, 4));
}

TEST(SvgPath, ArcFlagsNeedNoSeparators) {
  const auto p = parse_svg_path("M0 0a1 1 0 00.5.5 1 2 0 1110 20");
  ASSERT_EQ(p[0].pieces.size(), 2u);
  EXPECT_FALSE(p[0].pieces[0].large);
  EXPECT_FALSE(p[0].pieces[0].sweep);
  EXPECT_EQ(p[0].pieces[0].to, Vec2(0.5, 0.5));
  EXPECT_TRUE(p[0].pieces[1].large);
  EXPECT_TRUE(p[0].pieces[1].sweep);
  EXPECT_EQ(p[0].pieces[1].to, Vec2(10.5, 20.5));
}

TEST(SvgPath, PairsAfterMoveAreLines) {
  const auto p = parse_svg_path("m1 1 2 0 0 2z m5 5 1 0 0 1 z");
  ASSERT_EQ(p.size(), 2u);
  EXPECT_EQ(p[0].pieces.size(), 3u);
  EXPECT_EQ(p[1].pieces[0].from, Vec2(6, 6)) << "a relative move after z counts from the subpath's start";
}

TEST(SvgPath, SmoothCommandsMirrorOnlyTheirOwnKind) {
  const auto p = parse_svg_path("M0 0C0 1 1 1 2 0S4 -1 4 0L5 0S6 1 7 0");
  EXPECT_EQ(p[0].pieces[1].control_1, Vec2(3, -1));
  EXPECT_EQ(p[0].pieces[3].control_1, Vec2(5, 0)) << "after a line S starts straight from the current point";
}

TEST(SvgPath, QuadraticIsTheSameCurveAsItsCubic) {
  const PathPiece q = parse_svg_path("M0 0Q1 2 4 1")[0].pieces[0];
  for (double t : {0.25, 0.5, 0.9}) {
    const double s = 1 - t;
    const Vec2 quadratic = 2 * s * t * Vec2(1, 2) + t * t * Vec2(4, 1);
    const Vec2 cubic = 3 * s * s * t * q.control_1 + 3 * s * t * t * q.control_2 + t * t * t * q.to;
    EXPECT_LT((quadratic - cubic).norm(), 1e-15);
  }
}

TEST(SvgPath, FaultsNameTheirCharacter) {
  EXPECT_THAT(fault(""), HasSubstr("character 1"));
  EXPECT_THAT(fault("L1 2"), HasSubstr("character 1: path data must start with M or m, got 'L'"));
  EXPECT_THAT(fault("M1"), HasSubstr("character 3: expected a number, got the end of the data"));
  EXPECT_THAT(fault("M1 2 L3"), HasSubstr("character 8"));
  EXPECT_THAT(fault("M1 2 X3 4"), HasSubstr("character 6: unknown command"));
  EXPECT_THAT(fault("M1,,2"), HasSubstr("character 4"));
  EXPECT_THAT(fault("M,1 2"), HasSubstr("character 2"));
  EXPECT_THAT(fault("M1 2,"), HasSubstr("character 6"));
  EXPECT_THAT(fault("M1 2,L3 4"), HasSubstr("character 6"));
  EXPECT_THAT(fault("M1 2L3 4 #"), HasSubstr("character 10: expected a number, got '#'"));
  EXPECT_THAT(fault("M0 0A1 1 0 2 0 1 1"), HasSubstr("character 12: expected a flag"));
  EXPECT_THAT(fault("M1e999 0L1 1"), HasSubstr("out of range"));
  EXPECT_THAT(fault("Mnan 0"), HasSubstr("character 2: expected a number"));
  EXPECT_THAT(fault("M0 inf"), HasSubstr("character"));
  EXPECT_THAT(fault("M0 0Z5"), HasSubstr("character 6: expected a command"));
  EXPECT_THAT(fault("M0 0L1 -"), HasSubstr("character 8"));
}

TEST(SvgPath, RandomTextEitherParsesOrIsAFault) {
  // no crash, no hang, no other exception, and never a point that is not finite
  SeededRandom random(31);
  const std::string letters = "MmLlHhVvCcSsQqTtAaZz0123456789.,-+eE  \n#";
  for (int trial = 0; trial < 20000; ++trial) {
    std::string d = "M0 0";
    const int n = static_cast<int>(random.below(30));
    for (int k = 0; k < n; ++k) d += letters[random.below(letters.size())];
    try {
      for (const Subpath& s : parse_svg_path(d))
        for (const PathPiece& p : s.pieces) ASSERT_TRUE(p.to.allFinite() && p.control_1.allFinite()) << d;
    } catch (const BadInput&) {
    }
  }
}

TEST(PathShape, TwoHalfTurnsAreAnExactDiscOfQuarterArcs) {
  const Shape disc = make_path("M-3 1a2 2 0 1 0 4 0a2 2 0 1 0-4 0z", 0.5, 1e-6);
  EXPECT_EQ(disc.outline.curve_deviation, 0);
  ASSERT_EQ(disc.outline.sites.size(), 4u);
  for (const Site& s : disc.outline.sites) {
    EXPECT_EQ(s.kind, SiteKind::arc);
    EXPECT_EQ(s.arc_radius, 1);
    EXPECT_GT(s.sweep, 0) << "outer loops run counter-clockwise";
  }
  EXPECT_NEAR(disc.measure.size, pi, 1e-14);
  EXPECT_NEAR((disc.measure.centroid - Vec2(-0.5, -0.5)).norm(), 0, 1e-15) << "y is turned upward";
}

TEST(PathShape, TheFourArcsThroughTwoPointsAreTheFourOfTheFlags) {
  // unit circles through (0, 0) and (1, 1) on screen have centres (1, 0) and (0, 1); sweep 1 is clockwise on
  // screen. Middles of the arcs on screen: small ones bulge by 1 - 1/sqrt 2 to either side of the chord.
  struct Case {
    const char* d;
    Vec2 center;  // upward
    double sweep;
  };
  for (const Case& c :
       {Case{"M0 0A1 1 0 0 1 1 1", {0, -1}, -pi / 2}, Case{"M0 0A1 1 0 0 0 1 1", {1, 0}, pi / 2},
        Case{"M0 0A1 1 0 1 1 1 1", {1, 0}, -3 * pi / 2}, Case{"M0 0A1 1 0 1 0 1 1", {0, -1}, 3 * pi / 2}}) {
    const Shape shape = make_path(c.d, 1, 1e-6);
    double sweep = 0;
    for (const Site& s : shape.outline.sites) {
      EXPECT_LT((s.center - c.center).norm(), 1e-15) << c.d;
      sweep += s.sweep;
    }
    EXPECT_NEAR(sweep, c.sweep, 1e-14) << c.d;
  }
}

TEST(PathShape, TooSmallRadiiAreScaledUp) {
  // SVG 2, 9.5.1: radii that cannot reach are scaled until they just do, here to a half circle of radius 2
  const Shape half = make_path("M-2 0A1 1 0 0 1 2 0Z", 1, 1e-6);
  EXPECT_NEAR(half.measure.size, 2 * pi, 1e-14);
}

TEST(PathShape, EllipseHasPiAB) {
  const Shape ellipse = make_path("M-3 0A3 1 0 0 1 3 0A3 1 0 0 1-3 0Z", 1, 1e-7);
  EXPECT_LE(ellipse.outline.curve_deviation, 1e-7);
  EXPECT_NEAR(ellipse.measure.size, 3 * pi, 14 * 1e-7) << "perimeter 13.4 times the deviation";
}

TEST(PathShape, NearlyRoundEllipsesAreNotTakenForCrossing) {
  // their arcs join with almost the same radius, the hardest case for the check that sides do not meet
  for (const char* ry : {".9", ".999", ".99999", ".9999999"}) {
    const std::string r = std::string("A1 ") + ry + " 0 0 1 ";
    const Shape e = make_path("M-1 0" + r + "1 0" + r + "-1 0Z", 1, 1e-9);
    EXPECT_NEAR(e.measure.size, pi * std::stod(ry), 7e-9) << ry;
  }
}

TEST(PathShape, TooFineAToleranceIsRefused) {
  EXPECT_THROW(make_path("M0 0Q1 1 2 0", 1, 1e-14), BadInput);
  EXPECT_THROW(make_path("M0 0Q1 1 2 0", 1, 1e-300), BadInput);
}

TEST(PathShape, RotatedEllipseHasTheSameArea) {
  // the ends of the long axis at 30 degrees clockwise on screen
  const Shape e = make_path(
      "M-1.7320508075688772-1A2 .5 30 1 0 1.7320508075688772 1A2 .5 30 1 0-1.7320508075688772-1Z", 1, 1e-7);
  EXPECT_NEAR(e.measure.size, pi, 10 * 1e-7);
  EXPECT_NEAR(e.outline.bounds.high.x(), std::hypot(2 * std::cos(pi / 6), 0.5 * std::sin(pi / 6)), 2e-7);
}

TEST(PathShape, NestedLoopsAlternate) {
  const Shape rings = make_path("M0 0H9V9H0ZM1 1H8V8H1ZM2 2H7V7H2Z", 1, 1e-6);
  EXPECT_NEAR(rings.measure.size, 81 - 49 + 25, 1e-13);
}

TEST(PathShape, OpenSubpathsMakeWires) {
  const Shape wire = make_path("M0 0H1M0 1H1V2H0", 1, 1e-6);
  EXPECT_FALSE(wire.outline.solid);
  EXPECT_NEAR(wire.measure.size, 4, 1e-15);
}

// A plate and a line beside it: the plate would have no inside, and nobody would say so.
TEST(PathShape, ClosedAndOpenSubpathsTogetherAreRefused) {
  for (const auto& [d, what] : {std::pair{"M0 0H1V1H0ZM0 2H1", "subpath 1 is closed, subpath 2 is open"},
                                {"M0 2H1M0 0H1V1H0Z", "subpath 1 is open, subpath 2 is closed"},
                                {"m0 0h1v1h-1z l3 3", "subpath 1 is closed, subpath 2 is open"}}) {
    try {
      make_path(d, 1, 1e-6);
      ADD_FAILURE() << "accepted: " << d;
    } catch (const BadInput& e) {
      EXPECT_THAT(e.what(), HasSubstr(what)) << d;
    }
  }
}

TEST(PathShape, RelativeRoundingAtTheEndStillCloses) {
  const Shape box = make_path("m.1.1l.1 0 .1 0 .1 0 0 .3-.1 0-.1 0-.1 0 0-.3", 1, 1e-6);
  EXPECT_TRUE(box.outline.solid);
  EXPECT_NEAR(box.measure.size, 0.09, 1e-15);
}

// The usual circle of SVG: two arcs, whose ends are a rounding apart.
TEST(PathShape, RoundingAtTheEndOfTwoArcsStillCloses) {
  for (const char* d :
       {"M.1 0a.3 .3 0 0 1 .6 0a.3 .3 0 0 1-.6 0z", "M.1 0a.3 .3 0 0 1 .6 0a.3 .3 0 0 1-.6 0"}) {
    const Shape disc = make_path(d, 1, 1e-6);
    EXPECT_TRUE(disc.outline.solid) << d;
    EXPECT_NEAR(disc.measure.size, 0.09 * pi, 1e-15) << d;
  }
}

TEST(PathShape, RoundingAtTheEndOfAnArcAndALineStillCloses) {
  const Shape half = make_path("M.1 0a.3 .3 0 0 1 .6 0h-.6z", 1, 1e-6);
  EXPECT_EQ(half.outline.sites.size(), 3u);
  EXPECT_NEAR(half.measure.size, 0.045 * pi, 1e-15);
}

// An arc whose chord is a rounding: where its circle lies, the chord alone tells.
TEST(PathShape, ArcThatIsAllButWholeKeepsItsCircle) {
  const Shape wire = make_path("M1 0A1 1 0 1 1 1 1e-14", 1, 1e-6);
  EXPECT_NEAR(wire.measure.size, 2 * pi, 1e-6);
}

TEST(PathShape, TwoLinesThereAndBackUpToRoundingStayAWire) {
  const Shape wire = make_path("m.1 0l.6 0-.6 0", 1, 1e-6);  // .1 + .6 - .6 is a rounding short of .1
  EXPECT_FALSE(wire.outline.solid);
  EXPECT_NEAR(wire.measure.size, 1.2, 1e-15);
}

TEST(PathShape, SubpathShorterThanTheToleranceIsRefusedByNumber) {
  for (const char* d : {"M5 5c1e-9 0 0 1e-9 0 0zM0 0h1v1h-1z", "M0 0h1v1h-1zM5 5c1e-9 0 0 1e-9 0 0z",
                        "M5 5c1e-9 0 0 1e-9 0 0M0 0h1"}) {
    try {
      make_path(d, 1, 1e-3);
      ADD_FAILURE() << "accepted: " << d;
    } catch (const BadInput& e) {
      EXPECT_THAT(e.what(), HasSubstr("is shorter than curve_tolerance, 0.001 m")) << d;
    }
  }
}

TEST(PathShape, CrossingSubpathsAreRefused) {
  EXPECT_THROW(make_path("M0 0L2 2H0L2 0Z", 1, 1e-6), BadInput);
  EXPECT_THROW(make_path("M0 0H2V2H0ZM1 1H3V3H1Z", 1, 1e-6), BadInput);
  EXPECT_THROW(make_path("M0 0A1 1 0 0 1 2 0ZM1-1.5V-.5H1.5Z", 1, 1e-6), BadInput);
  EXPECT_THROW(make_path("M0 0", 1, 1e-6), BadInput);
  EXPECT_THROW(make_path("M0 0L1 1", 0, 1e-6), BadInput);
  EXPECT_THROW(make_path("M0 0L1 1", 1, -1), BadInput);
}

}  // namespace
}  // namespace brink::svg_path_test
