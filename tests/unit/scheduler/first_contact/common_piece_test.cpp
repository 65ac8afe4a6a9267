// The parts of two motions' common pieces: they tile each piece, and are the same whichever of their times is asked for.
#include "brink/scheduler/first_contact/common_piece.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "brink/core/base/random.h"

namespace brink::common_piece_test {
namespace {

Motion pieces_between(const std::vector<double>& times) {
  auto track = std::make_shared<Track>();
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    PolynomialPiece piece;
    piece.begin = piece.origin = times[k];
    piece.end = times[k + 1];
    track->pieces.push_back(piece);
  }
  return Motion::dense(track);
}

TEST(CommonPiece, EndsWhereTheFirstOfTheTwoEnds) {
  const Motion a = pieces_between({1.0, 2.0, 4.0}), b = pieces_between({0.5, 1.5, 8.0}),
               flies = Motion::still({});
  const auto expect = [](const detail::Stretch& found, double begin, double end) {
    EXPECT_EQ(found.begin, begin);
    EXPECT_EQ(found.end, end);
  };
  expect(detail::common_piece(a, b, 1.25), 1.0, 1.5);
  expect(detail::common_piece(a, b, 1.5), 1.5, 2.0);  // the later one, where two meet
  expect(detail::common_piece(a, b, 3.0), 2.0, 4.0);
  expect(detail::common_piece(a, b, 4.0), 2.0, 4.0);  // the end is the last one's
  expect(detail::common_piece(flies, b, 7.0), 1.5, 8.0);
}

TEST(CommonPiece, PartsTileAPieceAndAreTheSameForAllTheirTimes) {
  Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const double begin = random.uniform(0.0, 1e3);
    // from a few roundings to seconds
    const double end = begin + std::max(std::pow(10.0, random.uniform(-15.0, 1.0)), 4e-16 * begin);
    const Motion a = pieces_between({begin, end}), b = pieces_between({begin - 1.0, end + 1.0});
    int parts = 0;
    for (double t = begin; t < end; ++parts) {
      const detail::Stretch part = detail::part_of_piece(a, b, t);
      ASSERT_EQ(part.begin, t);
      ASSERT_LT(part.begin, part.end);
      for (const double within : {random.uniform(), 0.0, 1.0}) {
        const double last = std::nextafter(part.end, begin);
        const double time = std::min(part.begin + within * (part.end - part.begin), last);
        const detail::Stretch again = detail::part_of_piece(a, b, time);
        ASSERT_EQ(again.begin, part.begin);
        ASSERT_EQ(again.end, part.end);
      }
      t = part.end;
      ASSERT_LE(t, end);
    }
    EXPECT_LE(parts, 16);
    EXPECT_EQ(detail::part_of_piece(a, b, end).end, end);
  }
}

}  // namespace
}  // namespace brink::common_piece_test
