// The classic text data file: what is read, and where faults are said to be.
#include "brink/core/shapes/sample_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/base/random.h"

namespace brink::sample_file_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kSquare = R"(// the classic square
8                      // number of samples

10  1 2  3 -4  30 20   // mass  x y  vx vy  rotation  omega
-0.5 -0.5
0 -0.5
+0.5 -0.5
0.5 0
0.5 5e-1
0 0.5
-0.5 0.5   // the last corner
-0.5 0
)";

TEST(SampleFile, StateAndSamplesAreReadAndCommentsAreNot) {
  std::vector<SampleFileFault> faults;
  const SampledBody body = read_sample_file(kSquare, faults);
  ASSERT_TRUE(faults.empty());
  EXPECT_EQ(body.mass, 10.0);
  EXPECT_EQ(body.position, Vec2(1, 2));
  EXPECT_EQ(body.velocity, Vec2(3, -4));
  EXPECT_EQ(body.rotation_degrees, 30.0);
  EXPECT_EQ(body.omega, 20.0);
  ASSERT_EQ(body.samples.size(), 8U);
  EXPECT_EQ(body.samples[4], Vec2(0.5, 0.5));
}

// A square of side 1 has area 1 and second moment 1/6, in file order or listed row by row (its hull).
TEST(SampleFile, SamplesStandForTheShapeTheyGoRound) {
  std::vector<SampleFileFault> faults;
  const std::vector<Vec2> round = read_sample_file(kSquare, faults).samples;
  std::vector<Vec2> rows = round;
  std::sort(rows.begin(), rows.end(),
            [](const Vec2& a, const Vec2& b) { return std::pair(a.y(), a.x()) < std::pair(b.y(), b.x()); });
  rows.emplace_back(0.0, 0.0);  // one inside
  for (const auto& samples : {round, rows}) {
    const Shape shape = shape_of_samples(samples);
    EXPECT_TRUE(shape.outline.solid);
    EXPECT_NEAR(shape.measure.size, 1.0, 1e-15);
    EXPECT_NEAR(shape.measure.second_moment, 1.0 / 6.0, 1e-15);
  }
  EXPECT_FALSE(shape_of_samples({{0, 0}, {1, 1}, {0.5, 0.5}}).outline.solid);  // a wire
  EXPECT_TRUE(shape_of_samples({{2, 3}}).outline.is_point());
}

// Decimal places of one line are off it by roundings, near the origin and far away; wherever the line goes.
TEST(SampleFile, SamplesOnOneLineUpToRoundingAreAWireFromEndToEnd) {
  EXPECT_NEAR(shape_of_samples({{0.1, 0.3}, {0.3, 0.9}, {0.2, 0.6}}).measure.size, 0.2 * std::sqrt(10),
              1e-15);
  Random random(71);
  for (int k = 0; k < 500; ++k) {
    const Vec2 from(random.uniform(-1, 1), random.uniform(-1e3, 1e3));
    const Vec2 along = k % 5 == 0 ? Vec2(0, 1) : Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    std::vector<Vec2> samples{from + 2 * along, from};
    for (int j = 0; j < 6; ++j) samples.push_back(from + random.uniform(0, 2) * along);
    const Shape wire = shape_of_samples(samples);
    EXPECT_FALSE(wire.outline.solid) << "case " << k << " of seed 71";
    EXPECT_NEAR(wire.measure.size, 2 * along.norm(), 1e-12) << "case " << k << " of seed 71";
  }
}

TEST(SampleFile, SamplesAHairOffOneLineStandForASolid) {
  EXPECT_TRUE(shape_of_samples({{0, 0}, {1, 0}, {0.5, 1e-9}}).outline.solid);
}

TEST(SampleFile, WordThatIsNoNumberIsOneFault) {
  for (const char* text :
       {"three\n1 0 0 0 0 0 0\n0 0\n", "1\nheavy 0 0 0 0 0 0\n0 0\n", "1\n1 0 0 0 0 0 0\n0 here\n"}) {
    std::vector<SampleFileFault> faults;
    read_sample_file(text, faults);
    EXPECT_EQ(faults.size(), 1U) << text;
  }
}

struct FaultCase {
  const char *name, *text;
  int line, column;
  const char* message;
};

class SampleFileFaults : public ::testing::TestWithParam<FaultCase> {};

TEST_P(SampleFileFaults, AreLocated) {
  std::vector<SampleFileFault> faults;
  read_sample_file(GetParam().text, faults);
  ASSERT_FALSE(faults.empty());
  EXPECT_EQ(faults[0].line, GetParam().line);
  EXPECT_EQ(faults[0].column, GetParam().column);
  EXPECT_THAT(faults[0].message, HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Each, SampleFileFaults,
    ::testing::Values(FaultCase{"Empty", "", 1, 1, "ends too soon"},
                      FaultCase{"NoCount", "three\n", 1, 1, "not a number; given \"three\""},
                      FaultCase{"BrokenCount", "2.5\n1 0 0 0 0 0 0\n", 1, 1, "no count; given \"2.5\""},
                      FaultCase{"HugeCount", "1e12\n1 0 0 0 0 0 0\n", 1, 1, "no count"},
                      FaultCase{"ShortState", "1\n1 0 0 0\n0 0\n", 2, 7, "the line has 4 words"},
                      FaultCase{"NoMass", "1\n0 0 0 0 0 0 0\n0 0\n", 2, 1, "the mass is not > 0"},
                      FaultCase{"NanPlace", "1\n1 nan 0 0 0 0 0\n0 0\n", 2, 3, "not a number; given \"nan\""},
                      FaultCase{"WordSample", "1\n1 0 0 0 0 0 0\n  1 x // y\n", 3, 5,
                                "not a number; given \"x\""},
                      FaultCase{"ThreeNumbers", "1\n1 0 0 0 0 0 0\n1 2 3\n", 3, 5, "the line has 3 words"},
                      FaultCase{"TooFew", "2\n1 0 0 0 0 0 0\n0 0\n", 4, 1, "given 1 samples, allowed: the 2"},
                      FaultCase{"TooMany", "1\n1 0 0 0 0 0 0\n0 0\n1 1\n", 4, 1, "more than the 1 samples"},
                      FaultCase{"Repeat", "2\n1 0 0 0 0 0 0\n0 0\n 0 0\n", 4, 2, "that of line 3"}),
    [](const auto& info_) { return info_.param.name; });

}  // namespace
}  // namespace brink::sample_file_test
