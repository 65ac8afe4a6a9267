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

}  // namespace

SiteIndex::SiteIndex(std::shared_ptr<const Outline> outline) : outline_(std::move(outline)) {
  right_.reserve(outline_->sites.size());
  for (const Site& site : outline_->sites) {
    // normal_at() normalises the segment at every query; of a solid one the answer is the
    // same everywhere on it.
    const bool known = site.solid && site.kind == SiteKind::segment;
    right_.push_back(known ? Vec2(-perp((site.b - site.a).normalized())) : Vec2(Vec2::Zero()));
  }
}

/// The reach is infinite, so that candidates() never answers "farther than that".
FieldAnswer SiteIndex::query(const Vec2& q, Scratch& scratch) const {
  if (!q.allFinite()) return FieldAnswer();
  const Candidates found = candidates(q, std::numeric_limits<double>::infinity(), scratch);
  FieldAnswer answer;
  double best = std::numeric_limits<double>::infinity(), second = best;
  Nearest nearest;
  for (const std::uint32_t i : found.sites) {
    const Site& site = outline_->sites[i];
    // Lists ascend (the tree's: nearest first, then by index), so that with < the lowest index wins ties.
    const Nearest n = nearest_on(site, q);
    const double distance = n.distance - site.radius;
    if (distance < best) {
      second = best;
      best = distance;
      nearest = n;
      answer.site = static_cast<int>(i);
    } else if (distance < second) {
      second = distance;
    }
  }
  if (answer.site < 0) return answer;
  const Site& site = outline_->sites[static_cast<std::size_t>(answer.site)];
  // unsigned distances chose the site; the sign is that site's alone
  answer.gap = side_of_outline(*outline_, site, nearest, q) * nearest.distance - site.radius;
  answer.closest = nearest.point;
  answer.normal = nearest.foot == Foot::interior && site.solid && site.kind == SiteKind::segment
                      ? right_[static_cast<std::size_t>(answer.site)]
                      : normal_at(site, nearest, q);
  // The second nearest may be a site that is not listed.
  answer.runner_up = std::min(second, found.others_at_least);
  return answer;
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
