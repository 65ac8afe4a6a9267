#include "brink/core/fields/site_index.h"

#include <numeric>

#include "brink/core/base/error.h"
#include "brink/core/fields/body_field.h"
#include "brink/core/shapes/distance.h"

namespace brink {

namespace {

/// All sites are candidates at every place, so that nothing has to be said of others.
class BruteForceIndex final : public SiteIndex {
 public:
  explicit BruteForceIndex(std::shared_ptr<const Outline> outline) : SiteIndex(std::move(outline)) {
    all_.resize(outline_->sites.size());
    std::iota(all_.begin(), all_.end(), 0U);
  }
  Candidates candidates(const Vec2&, double, Scratch&) const override {
    return {all_, std::numeric_limits<double>::infinity()};
  }

 private:
  std::vector<std::uint32_t> all_;
};

/// A raster needs an outline of some size, also beside its distance from the frame's origin.
bool can_be_drawn(const Outline& outline) {
  if (outline.sites.empty()) return false;
  const double size = outline.bounds.extent().maxCoeff();
  const double farthest =
      std::max(outline.bounds.low.cwiseAbs().maxCoeff(), outline.bounds.high.cwiseAbs().maxCoeff());
  // 1e-9: pixels, up to some thousand a side, are then wider than the rounding of a coordinate by far.
  // Between 1e-100 and 1e100 squares of lengths neither vanish nor overflow.
  return size > 1e-100 && size > 1e-9 * farthest && farthest < 1e100;
}

/// The nearest of what was added, and how far the second nearest is: by masks, as the order is as good as random.
struct NearestTwo {
  using Two = double __attribute__((vector_size(16)));
  Two least = {std::numeric_limits<double>::infinity(), 0.0},
      second = least;  ///< [m], the first of each counts
  int site = -1;
  /// Of equally near ones the first stays. What is not a number is nowhere.
  void add(std::uint32_t index, double at) {
    const Two distance = {at, 0.0};
    const auto nearer = distance < least;
    const Two farther = nearer ? least : distance;
    site ^= (site ^ static_cast<int>(index)) & static_cast<int>(nearer[0]);
    second = farther < second ? farther : second;
    least = nearer ? distance : least;
  }
};

}  // namespace

/// Which end of a segment is nearest, or its inside, is as good as random among candidates, so that a processor would guess
/// wrong: all three are computed, side by side for the two, and selected from by masks.
inline SiteIndex::Two SiteIndex::distances(std::uint32_t i, std::uint32_t j, const Vec2& q) const {
  const Site &s = outline_->sites[i], &t = outline_->sites[j];
  const Two radius = {s.radius, t.radius};
  if (s.kind != SiteKind::segment || t.kind != SiteKind::segment)
    return Two{nearest_on(s, q).distance, nearest_on(t, q).distance} - radius;
  const Two ax = {s.a.x(), t.a.x()}, ay = {s.a.y(), t.a.y()}, bx = {s.b.x(), t.b.x()},
            by = {s.b.y(), t.b.y()};
  const Two dx = bx - ax, dy = by - ay, wx = q.x() - ax, wy = q.y() - ay, vx = q.x() - bx, vy = q.y() - by;
  const Two along = wx * dx + wy * dy, length2 = dx * dx + dy * dy, cross = dx * wy - dy * wx;
  const auto at_start = along <= 0.0, inside = ~at_start & ~(along >= length2);
  const Two to_end2 = at_start ? wx * wx + wy * wy : vx * vx + vy * vy;
  const Two offset = cross / Two{lines_[i].length, lines_[j].length};
  return (inside ? (offset < 0.0 ? -offset : offset) : Two{std::sqrt(to_end2[0]), std::sqrt(to_end2[1])}) -
         radius;
}

SiteIndex::SiteIndex(std::shared_ptr<const Outline> outline) : outline_(std::move(outline)) {
  lines_.reserve(outline_->sites.size());
  for (const Site& site : outline_->sites) {
    const Vec2 along = site.b - site.a;
    lines_.push_back(site.kind == SiteKind::segment ? Line{-perp(along.normalized()), along.norm()} : Line{});
  }
}

[[gnu::always_inline]] inline FieldAnswer SiteIndex::answer_by(int index, const Vec2& q,
                                                               double runner_up) const {
  const Site& site = outline_->sites[static_cast<std::size_t>(index)];
  const Line& line = lines_[static_cast<std::size_t>(index)];
  if (site.kind == SiteKind::segment && site.solid) {
    // Abreast of a solid's segment, as most places near an outline are: what follows, without asking for the side.
    const Vec2 d = site.b - site.a, w = q - site.a;
    const double along = w.dot(d), length2 = d.squaredNorm(), inwards = cross(d, w) / line.length;
    if (along > 0.0 && along < length2 && !is_beyond(*outline_, std::abs(inwards)))
      return {0.0 - inwards - site.radius, index, site.a + d * (along / length2), line.right, runner_up};
  }
  const Nearest nearest = nearest_on(site, q);
  // too far for its square
  if (!(nearest.distance < std::numeric_limits<double>::infinity())) return FieldAnswer();
  // unsigned distances chose the site; the sign is that site's alone
  return {side_of_outline(*outline_, site, nearest, q) * nearest.distance - site.radius, index, nearest.point,
          normal_at(site, nearest, q), runner_up};
}

/// The reach is infinite, so that candidates() never answers "farther than that".
FieldAnswer SiteIndex::query(const Vec2& q, Scratch& scratch) const {
  if (!q.allFinite()) return FieldAnswer();
  const Candidates found = candidates(q, std::numeric_limits<double>::infinity(), scratch);
  const std::size_t count = found.sites.size();
  NearestTwo seen;
  if (count == 1) seen.site = static_cast<int>(found.sites[0]);  // about every second time near an outline
  // Lists ascend (the tree's: nearest first, then by index), so that of equally near ones the lowest index wins.
  for (std::size_t k = 0; count > 1 && k < count; k += 2) {
    const std::uint32_t i = found.sites[k], j = found.sites[std::min(k + 1, count - 1)];
    const Two distance = distances(i, j, q);
    seen.add(i, distance[0]);
    if (i != j) seen.add(j, distance[1]);
  }
  return seen.site < 0 ? FieldAnswer()
                       : answer_by(seen.site, q, std::min(seen.second[0], found.others_at_least));
}

std::unique_ptr<SiteIndex> make_brute_force_index(std::shared_ptr<const Outline> outline) {
  return std::make_unique<BruteForceIndex>(std::move(outline));
}

std::unique_ptr<SiteIndex> make_site_index(std::shared_ptr<const Outline> outline,
                                           const FieldOptions& options, WorkCounters* work) {
  std::string error;
  if (!options.is_valid(&error)) throw BadInput(error);
  const bool few = outline->sites.size() < static_cast<std::size_t>(options.brute_force_below);
  // before a renderer is asked for: no context is opened where none is needed
  if (few || !can_be_drawn(*outline)) return make_brute_force_index(std::move(outline));
  detail::FieldRenderer& renderer = detail::thread_renderer(options.context);
  // the renderer counts since it was made; this field's share is the difference
  const std::uint64_t drawn = renderer.pixels_drawn(), read = renderer.pixels_read();
  auto field = detail::render_body_field(std::move(outline), options, renderer);
  if (work != nullptr) {
    work->pixels_drawn += renderer.pixels_drawn() - drawn;
    work->pixels_read += renderer.pixels_read() - read;
  }
  return field;
}

}  // namespace brink
