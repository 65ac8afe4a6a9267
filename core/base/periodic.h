#pragma once
/// A plane that repeats: every place stands for all its images, whole periods away. Coordinates are never
/// wrapped; who meets whom is told with the image of the one that the other meets.

#include <algorithm>
#include <cmath>
#include <compare>
#include <type_traits>

#include "brink/core/base/geometry.h"

namespace brink {

/// Whole periods to the right and up.
struct Image {
  int right = 0, up = 0;
  auto operator<=>(const Image&) const = default;
  Image operator-() const { return {-right, -up}; }
  Image operator+(const Image& other) const { return {right + other.right, up + other.up}; }
};

/// The periods of a world [m]; 0: the plane goes on for ever along that axis.
struct Periods {
  Vec2 size = Vec2::Zero();

  bool any() const { return size.x() > 0.0 || size.y() > 0.0; }
  /// The least of them; infinite where nothing repeats.
  double least() const {
    const auto along = [&](int axis) {
      return size[axis] > 0.0 ? size[axis] : std::numeric_limits<double>::infinity();
    };
    return std::min(along(0), along(1));
  }
  Vec2 shift(const Image& image) const { return {image.right * size.x(), image.up * size.y()}; }

  /// Calls visit(image) for every image of b that overlaps a, row by row, until it returns false (a visitor that returns
  /// nothing sees all); in a plane that does not repeat for b itself. @pre finite boxes along axes that repeat.
  template <class Visit>
  void overlaps(const Box& a, const Box& b, Visit&& visit) const {
    const Span right = span(a, b, 0);
    if (right.last < right.first) return;  // most are not near
    const Span up = span(a, b, 1);
    for (int j = up.first; j <= up.last; ++j)
      for (int i = right.first; i <= right.last; ++i)
        if constexpr (std::is_void_v<std::invoke_result_t<Visit&, const Image&>>)
          visit(Image{i, j});
        else if (!visit(Image{i, j}))
          return;
  }

  static constexpr double kFarthest = 1e9;  ///< periods from the origin [1]: images beyond have no number

 private:
  struct Span {
    int first, last;
  };
  /// Of images along one axis.
  Span span(const Box& a, const Box& b, int axis) const {
    const double least = a.low[axis] - b.high[axis], most = a.high[axis] - b.low[axis];
    if (size[axis] > 0.0) return images(least / size[axis], most / size[axis]);
    return {0, least <= 0.0 && most >= 0.0 ? 0 : -1};
  }
  static Span images(double first, double last) {
    const auto whole = [](double periods) {
      return static_cast<int>(std::clamp(periods, -kFarthest, kFarthest));
    };
    return {whole(std::ceil(first)), whole(std::floor(last))};
  }
};

}  // namespace brink
