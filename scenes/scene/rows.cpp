/// Distances are found once, between two copies: all have one shape and one angle, so they are the same
/// for every pair with the same offset. A wall of 100 000 copies casts as many outlines as there are
/// offsets at which two may touch; at() adds up, and pushes apart what roundings have left too near.
/// Places along a row are counted in half distances, as whole numbers.
#include "brink/scenes/scene/rows.h"

#include <algorithm>
#include <cmath>

#include "brink/core/query/cast_outline.h"
#include "brink/scenes/scene/landing.h"

namespace brink {

namespace {

constexpr double kMayTouch = 1e-6;  // of a copy's radius: nearer ones may touch

// From where a copy is clear of another, a power of two, so that what is exact stays so.
// From two to four times the distance of the centres at which the two discs touch.
double far_away(const Outline& outline) {
  return std::exp2(std::ceil(std::log2(2.0 * outline.bounding_radius * (1.0 + kMayTouch))) + 1.0);
}

}  // namespace

/// Rows from the lowest up, as each stands on those below. Members are made in the order of the class:
/// the extents and the distance need `along_`.
TouchingRows::TouchingRows(RowsAsk ask)
    : ask_(std::move(ask)),
      along_(-perp(ask_.up)),
      high_(extent_along(ask_.up)),
      wide_(extent_along(along_)),
      width_(distance_in_row()) {
  CopyGaps gaps(*ask_.outline);
  for (std::size_t row = 0; row < ask_.lengths.size(); ++row) {
    heights_.push_back(height_of(row));
    neighbours_.push_back(neighbours_of(row, gaps));
  }
}

/// At least a copy's size along a direction; an arc counts as its whole circle. It decides who is looked
/// at, so more is safe.
double TouchingRows::extent_along(const Vec2& direction) const {
  // The direction in the outline's frame: turned once, in place of all sites.
  const Vec2 local = Frame({Vec2::Zero(), ask_.angle}).direction_to_local(direction);
  double least = std::numeric_limits<double>::infinity(), most = -least;
  const auto add = [&](const Vec2& p, double radius) {
    least = std::min(least, p.dot(local) - radius);
    most = std::max(most, p.dot(local) + radius);
  };
  for (const Site& site : ask_.outline->sites) {
    add(site.a, site.radius);
    add(site.b, site.radius);
    if (site.kind == SiteKind::arc) add(site.center, site.radius + site.arc_radius);
  }
  return (most - least) * (1.0 + kMayTouch);
}

/// From copy to copy in a row; where the one that comes only grazes the other, as far as their discs.
double TouchingRows::distance_in_row() const {
  const double far = far_away(*ask_.outline);
  const OutlineHit hit = cast_outline(*ask_.outline, {far * along_, ask_.angle}, -along_, *ask_.outline,
                                      {Vec2::Zero(), ask_.angle});
  return hit.status == OutlineHit::Status::touches ? far - hit.distance : 2.0 * ask_.outline->bounding_radius;
}

/// How high above another a copy comes to lie that is let down onto it, so many half distances beside; minus
/// infinity if it falls past it.
/// Kept by offset, as rows of a wall ask for the same few again and again; by its sign, too, since a
/// shape need not lie on the left of another as it does on the right.
double TouchingRows::drop(std::int64_t halves) {
  if (const auto known = drops_.find(halves); known != drops_.end()) return known->second;
  const double far = far_away(*ask_.outline);
  const OutlineHit hit = cast_outline(*ask_.outline, {offset(halves, far), ask_.angle}, -ask_.up,
                                      *ask_.outline, {Vec2::Zero(), ask_.angle});
  const double height = hit.status == OutlineHit::Status::touches ? far - hit.distance
                                                                  : -std::numeric_limits<double>::infinity();
  return drops_.emplace(halves, height).first->second;
}

/// visit(halves) for every distance to the side at which a copy of `row` and one of `below` are, as far as
/// they can touch.
/// The copies of a row of n stand at 1 - n, 3 - n ... n - 1 half distances, so rows whose lengths differ
/// by one are shifted by half a distance, and distances between two rows are all odd or all even.
template <class Visit>
void TouchingRows::for_offsets(std::size_t row, std::size_t below, Visit&& visit) const {
  // Beyond this many halves the two are more than a copy's width apart.
  const auto reach = (width_ > 0.0 ? static_cast<std::int64_t>(2.0 * wide_ / width_) : 0) + 1;
  std::int64_t low = first(row) - last(below);
  const std::int64_t high = std::min(last(row) - first(below), reach);
  if (low < -reach) low += (-reach - low + 1) / 2 * 2;  // keeps what is odd odd
  for (std::int64_t halves = low; halves <= high; halves += 2) visit(halves);
}

/// How high the row's middle is above that of the lowest [m]. It is let down as one, so the highest
/// that any pair of copies asks for holds for all.
double TouchingRows::height_of(std::size_t row) {
  if (row == 0) return 0.0;
  double height = -std::numeric_limits<double>::infinity();
  // Rows are looked at from the top down, as far as a copy that stands on one of them could be higher
  // than what has been found. Where everything falls past them it is put on the row below by its size.
  for (std::size_t below = row; below-- > 0 && heights_[below] + high_ > height;)
    for_offsets(row, below,
                [&](std::int64_t halves) { height = std::max(height, heights_[below] + drop(halves)); });
  return std::isfinite(height) ? height : heights_[row - 1] + high_;
}

/// Copies beside and below that may touch one of this row, found once for all places of the row.
std::vector<TouchingRows::Neighbour> TouchingRows::neighbours_of(std::size_t row, CopyGaps& gaps) const {
  std::vector<Neighbour> out;
  const Pose here{Vec2::Zero(), ask_.angle};
  // With the neighbour at the origin: a gap depends on where the two are to each other alone.
  const auto look = [&](std::size_t below, std::int64_t halves) {
    const Pose there{offset(halves, heights_[row] - heights_[below]), ask_.angle};
    if (gaps.between(there, here).gap < kMayTouch * ask_.outline->bounding_radius)
      out.push_back({below, halves});
  };
  // Of its own row only those that at() has placed before it.
  for_offsets(row, row, [&](std::int64_t halves) {
    if (halves > 0) look(row, halves);  // those before it
  });
  for (std::size_t below = row; below-- > 0 && heights_[below] + high_ >= heights_[row];)
    for_offsets(row, below, [&](std::int64_t halves) { look(below, halves); });
  return out;
}

std::vector<Pose> TouchingRows::at(const Vec2& middle, std::size_t most) const {
  std::vector<Pose> out;
  CopyGaps gaps(*ask_.outline);
  // Copies of all rows stand in one list, as they are numbered; this is where each row begins.
  std::vector<std::size_t> begin;  // of each row, in out
  for (std::size_t row = 0; row < ask_.lengths.size() && out.size() < most; ++row) {
    begin.push_back(out.size());
    for (std::int64_t place = first(row); place <= last(row) && out.size() < most; place += 2) {
      Pose pose{middle + offset(place, heights_[row]), ask_.angle};
      std::vector<Touched> touched;
      for (const Neighbour& neighbour : neighbours_[row]) {
        // A place at the end of a row has no copy where one in the middle has.
        const std::int64_t other = place - neighbour.halves;
        if (other < first(neighbour.row) || other > last(neighbour.row)) continue;
        const auto k = static_cast<std::size_t>((other - first(neighbour.row)) / 2);
        touched.push_back(
            {{ask_.outline, out[begin[neighbour.row] + k]}, neighbour.row == row ? along_ : ask_.up});
      }
      // Those that it may touch stand already, and stay: only this one is pushed.
      push_apart(*ask_.outline, pose, touched, ask_.thin, gaps);
      out.push_back(pose);
    }
  }
  return out;
}

}  // namespace brink
