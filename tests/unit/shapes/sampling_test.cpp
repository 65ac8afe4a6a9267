// Particles of the classic method: how many, where, and what slips between them.
#include "brink/core/shapes/sampling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "brink/core/base/error.h"
#include "brink/core/shapes/shapes.h"

namespace brink::sampling_test {
namespace {

using ::testing::HasSubstr;
using Kind = Sampling::Kind;

Sampling by_spacing(Kind kind, double spacing) {
  Sampling s;
  s.kind = kind;
  s.spacing = spacing;
  return s;
}

Sampling by_count(Kind kind, int count, std::uint64_t seed = 1) {
  Sampling s;
  s.kind = kind;
  s.count = count;
  s.seed = seed;
  return s;
}

std::string refusal(const Outline& outline, const Sampling& sampling) {
  try {
    make_particles(outline, sampling);
  } catch (const BadInput& error) {
    return error.what();
  }
  return {};
}

// The classic example: a square of side 1 at spacing 1/2 has three particles an edge, corners shared: eight.
TEST(Sampling, SquareAtHalfItsSideHasEightParticlesThreeAnEdge) {
  const Outline square = make_box(1.0, 1.0).outline;
  const auto particles = make_particles(square, by_spacing(Kind::boundary, 0.5));
  ASSERT_EQ(particles.size(), 8U);
  for (const Vec2& side : {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1)})
    EXPECT_EQ(std::count_if(particles.begin(), particles.end(),
                            [&](const Particle& p) { return p.p.dot(side) > 0.499; }),
              3);
  // a corner of another body enters half a spacing from the nearest particle, whatever lies around it
  EXPECT_NEAR(widest_gap(square, particles), 0.5, 4.0 / 2048);
  EXPECT_EQ(make_particles(square, by_count(Kind::boundary, 8)).size(), 8U);  // boundary 4 m in 8 parts
}

TEST(Sampling, VerticesKeepTheThickness) {
  const auto disc = make_particles(make_disc(0.4).outline, Sampling());
  ASSERT_EQ(disc.size(), 1U);
  EXPECT_EQ(disc[0].radius, 0.4);
  EXPECT_EQ(make_particles(make_box(2, 1).outline, Sampling()).size(), 4U);
}

// Every boundary particle lies on the boundary, thickness included, and neighbours are no farther apart than
// asked.
TEST(Sampling, BoundaryParticlesLieOnTheBoundaryOfThickAndCurvedShapes) {
  for (const Shape& shape :
       {make_disc(0.5), make_capsule(1.0, 0.2), make_box(0.8, 0.5, 0.1), make_chain({{0, 0}, {1, 0}, {1, 1}}),
        make_path("M0 0 L0 10 L4 10 C8 10 8 5 4 5 C9 5 9 0 4 0 Z", 0.1, 1e-3)}) {
    const auto particles = make_particles(shape.outline, by_spacing(Kind::boundary, 0.05));
    for (const Particle& p : particles) EXPECT_NEAR(gap_by_brute_force(shape.outline, p.p), 0.0, 1e-12);
    EXPECT_LE(widest_gap(shape.outline, particles), 0.05 + 1e-9);
    EXPECT_GT(widest_gap(shape.outline, particles), 0.02);
  }
}

// The lattice's areas add up to the shape's: exactly for a box of whole cells; for a disc within half the
// cells that its edge cuts (pi * 2 r / s of them on each side, of random sign: far less).
TEST(Sampling, VolumeParticlesCarryTheShapesArea) {
  const auto area = [](const Shape& shape, double spacing) {
    double sum = 0.0;
    for (const Particle& p : make_particles(shape.outline, by_spacing(Kind::volume, spacing))) sum += p.area;
    return sum;
  };
  EXPECT_NEAR(area(make_box(1.0, 0.5), 0.05), 0.5, 1e-12);
  EXPECT_NEAR(area(make_disc(0.5), 0.01), std::numbers::pi / 4, 0.002);
  const Shape wire = make_chain({{0, 0}, {1, 0}});
  EXPECT_EQ(area(wire, 0.1), 0.0);
  EXPECT_EQ(make_particles(wire.outline, by_spacing(Kind::volume, 0.1)).size(), 11U);
}

TEST(Sampling, RandomIsTheSeedsOwnAndEvenAlongTheBoundary) {
  const Outline box = make_box(3.0, 1.0).outline;
  const auto first = make_particles(box, by_count(Kind::random, 4000, 7));
  const auto again = make_particles(box, by_count(Kind::random, 4000, 7));
  const auto other = make_particles(box, by_count(Kind::random, 4000, 8));
  ASSERT_EQ(first.size(), 4000U);
  int on_long_sides = 0, differ = 0;
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(first[k].p, again[k].p);
    differ += first[k].p != other[k].p;
    EXPECT_NEAR(gap_by_brute_force(box, first[k].p), 0.0, 1e-12);
    on_long_sides += std::abs(std::abs(first[k].p.y()) - 0.5) < 1e-9;
  }
  EXPECT_GT(differ, 3990);
  EXPECT_NEAR(on_long_sides, 3000, 5 * std::sqrt(4000 * 0.75 * 0.25));  // six of eight metres; five sigma
}

// Pixels that the outline passes through: their centres are within half a diagonal of it, and leave no gap
// wider than two diagonals.
TEST(Sampling, RasterParticlesArePixelsOnTheOutline) {
  const Outline star =
      make_polygon({{0, 0}, {2, 0.4}, {4, 0}, {3, 2}, {4, 4}, {2, 3.5}, {0, 4}, {1, 2}}).outline;
  const double pixel = 4.0 / 64;
  const auto particles = make_particles(star, by_spacing(Kind::raster, pixel));
  for (const Particle& p : particles) {
    EXPECT_LE(std::abs(gap_by_brute_force(star, p.p)), pixel * std::sqrt(0.5) + 1e-12);
    const Vec2 cell = (p.p - star.bounds.low) / pixel;
    EXPECT_NEAR(cell.x() - std::floor(cell.x()), 0.5, 1e-9);
  }
  EXPECT_LE(widest_gap(star, particles), 2.0 * std::sqrt(2.0) * pixel);
  EXPECT_EQ(make_particles(star, by_count(Kind::raster, 64)).size(), particles.size());
}

// Where both are given, the spacing counts.
TEST(Sampling, CountIsOnlyAskedWhereThereIsNoSpacing) {
  const Outline box = make_box(1, 1).outline;
  for (const Kind kind : {Kind::boundary, Kind::volume, Kind::random, Kind::raster}) {
    Sampling both = by_spacing(kind, 0.1);
    both.count = 7;
    EXPECT_EQ(make_particles(box, both).size(), make_particles(box, by_spacing(kind, 0.1)).size());
  }
  EXPECT_EQ(make_particles(box, by_spacing(Kind::random, 0.1)).size(), 40U);
}

TEST(Sampling, BarePointSampledByCountIsItself) {
  const Outline point = make_point({1, 2}).outline;
  for (const Kind kind : {Kind::boundary, Kind::volume, Kind::raster}) {
    const auto particles = make_particles(point, by_count(kind, 5));
    ASSERT_EQ(particles.size(), 1U);
    EXPECT_EQ(particles[0].p, Vec2(1, 2));
  }
}

// 4 m of boundary in pixels of 2e-5 m: 200 000 of them, walked in eighths.
TEST(Sampling, RasterIsHeldToItsPixelsNotToTheStepsOfItsWalk) {
  const Outline box = make_box(1, 1).outline;
  EXPECT_NEAR(make_particles(box, by_spacing(Kind::raster, 2e-5)).size(), 200000.0, 10.0);
  EXPECT_THAT(refusal(box, by_spacing(Kind::raster, 3.9e-6)), HasSubstr("at most 1000000"));
}

// A comb has more boundary than cells: neither alone is too much.
TEST(Sampling, VolumeIsHeldToLatticeAndBoundaryTogether) {
  std::vector<Vec2> comb{{1, -0.1}, {0, -0.1}};
  for (int k = 0; k < 200; ++k) {
    comb.emplace_back(k / 200.0, 0.0);
    comb.emplace_back((k + 0.5) / 200.0, 9.0);
  }
  comb.emplace_back(1, 0);
  EXPECT_THAT(refusal(make_polygon(comb).outline, by_spacing(Kind::volume, 4e-3)),
              HasSubstr("at most 1000000"));
}

TEST(Sampling, MissingAndAbsurdNumbersAreRefusedByName) {
  const Outline box = make_box(1, 1).outline;
  EXPECT_THAT(refusal(box, by_spacing(Kind::boundary, 0.0)),
              HasSubstr("boundary needs a spacing or a count"));
  EXPECT_THAT(refusal(box, by_spacing(Kind::volume, std::nan(""))), HasSubstr("volume needs"));
  EXPECT_THAT(refusal(box, by_spacing(Kind::volume, 1e-6)), HasSubstr("at most 1000000"));
  EXPECT_THAT(refusal(box, by_spacing(Kind::raster, -1.0)), HasSubstr("given spacing -1 m"));
  EXPECT_THAT(refusal(box, Sampling{Kind::random, 0.0, 0, 1, {}}), HasSubstr("random needs"));
}

}  // namespace
}  // namespace brink::sampling_test
