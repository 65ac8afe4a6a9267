#include "brink/core/fields/body_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brink::detail {

namespace {

/// Allowed range of a resolution that is chosen by shape [pixel]; FieldOptions::is_valid() has the same.
constexpr int kLeastResolution = 16, kMostResolution = 1024;
/// Lists near the outline are made no shorter than this on average: vertices always have two.
constexpr double kMeanList = 2.2;
/// Band of the trials that choose the resolution [pixel].
/// A trial asks for the lists within two pixels of the outline only.
constexpr double kTrialBand = 4.0;
/// Fragments that both draws together may cost when the band is chosen by shape.
constexpr double kFragments = 4e5;

/// Of the core [m]; 0 of a point.
double length_of(const Site& site) {
  if (site.kind == SiteKind::point) return 0.0;
  return site.kind == SiteKind::arc ? site.arc_radius * std::abs(site.sweep) : (site.b - site.a).norm();
}

/// Median length of the sites that have one; the size of the outline over the number of sites where none has.
double typical_length(const Outline& outline, double size) {
  std::vector<double> lengths;
  for (const Site& site : outline.sites) {
    const double length = length_of(site);
    if (length > 0.0) lengths.push_back(length);
  }
  if (lengths.empty()) return size / std::max<double>(1.0, static_cast<double>(outline.sites.size()));
  // the median: one long side among many short ones must not make the pixels coarse
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

/// Where the search for a resolution starts: two pixels a typical site, and a pixel a site.
int first_resolution(const Outline& outline, double size) {
  // 1.3: the window is larger than the outline by a band of a seventh of its size on either side
  const double pixels =
      std::max(2.0 * 1.3 * size / typical_length(outline, size), static_cast<double>(outline.sites.size()));
  return static_cast<int>(std::clamp(pixels, static_cast<double>(kLeastResolution), 1.0 * kMostResolution));
}

/// Fragments of one draw with this band [m] at this pixel [m].
/// Each site's quad counts whole, also what of it lies beside the window.
double fragments(const Outline& outline, double pixel, double band) {
  // 3: what a quad covers beyond its band, 2 h = 1.42 of margin and 1.5 for the rasteriser (site_batch.cpp)
  const double grow = band / pixel + 3.0;
  double sum = 0.0;
  for (const Site& site : outline.sites) {
    const double grown = grow + site.radius / pixel;
    sum += (length_of(site) / pixel + 2.0 * grown) * 2.0 * grown;
  }
  return sum;
}

}  // namespace

BodyFieldPlan plan_body_field(const Outline& outline, const FieldOptions& options) {
  // The band is needed for the window, and a pixel's length for the band: it is taken from the window that the
  // widest band would give.
  const Vec2 extent = outline.bounds.extent();
  // never 0: it is divided by
  const double size = std::max(extent.maxCoeff(), 1e-300);
  BodyFieldPlan plan;
  const int resolution = options.resolution != 0 ? options.resolution : first_resolution(outline, size);
  plan.band = options.band;
  if (plan.band == 0.0) {
    const double pixel = size * 1.3 / resolution;
    plan.band = size / 7.0;
    // Narrower bands cost fewer fragments; what lies beyond is answered by the tree,
    // which is slower but exact.
    while (plan.band > 4.0 * pixel && 2.0 * fragments(outline, pixel, plan.band) > kFragments)
      plan.band *= 0.8;
  }
  // One pixel of border, so that rounding at the window's edge stays outside the band.
  plan.grid.pixel = (size + 2.0 * plan.band) / std::max(1, resolution - 2);
  // 1e-9: whole pixels up to rounding are not one more
  const auto pixels = [&](double length) {
    return static_cast<int>(std::ceil((length + 2.0 * plan.band) / plan.grid.pixel - 1e-9)) + 2;
  };
  plan.grid.width = pixels(extent.x());
  plan.grid.height = pixels(extent.y());
  plan.grid.low = outline.bounds.center() - 0.5 * plan.grid.pixel * Vec2(plan.grid.width, plan.grid.height);
  return plan;
}

BodyField::BodyField(std::shared_ptr<const Outline> outline, CandidateLists lists)
    : SiteIndex(std::move(outline)),
      lists_(std::move(lists)),
      per_pixel_(1.0 / lists_.grid.pixel),
      snap_(lists_.grid.snap()),
      tree_(*outline_) {}

Candidates BodyField::candidates(const Vec2& q, double reach, Scratch& scratch) const {
  const double x = (q.x() - lists_.grid.low.x()) * per_pixel_, y = (q.y() - lists_.grid.low.y()) * per_pixel_;
  // written so that NaN goes outside, too, where it is answered
  if (!(x >= 0.0 && x < lists_.grid.width && y >= 0.0 && y < lists_.grid.height))
    return outside(q, reach, scratch);
  // Which pixel q is put into may be wrong by a rounding; snap_ and the slack of the lists allow for that.
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const CandidateLists::Cell cell =
      lists_.cells[static_cast<std::size_t>(j) * static_cast<std::size_t>(lists_.grid.width) +
                   static_cast<std::size_t>(i)];
  // |v| <= max + (sqrt 2 - 1) min: no square root.
  const double dx = std::abs(x - i - 0.5), dy = std::abs(y - j - 0.5);
  // Exact along axes and diagonals, at most 8 % too long between them.
  const double off = std::max(dx, dy) + 0.41421357 * std::min(dx, dy) + snap_;
  // distances are 1-Lipschitz: from the pixel's centre to q each changes by |q - centre| at most
  const double others = cell.others - off * lists_.grid.pixel;
  const std::uint32_t count = cell.count();
  if (count != 0 && count != CandidateLists::kTree) [[likely]] {
    return {std::span(lists_.sites.data() + cell.first(), count), others};
  }
  // Out of the band the picture only says that everything is at least so far. That will
  // do for a short reach.
  if (count == 0 && others >= reach) return {{}, others};
  return by_tree(q, scratch);
}

/// Beyond the window: nothing is nearer than the box of the outline, its thickness included.
Candidates BodyField::outside(const Vec2& q, double reach, Scratch& scratch) const {
  if (!q.allFinite()) return {{}, 0.0};
  const Box& box = outline_->bounds;
  const Vec2 away = (box.low - q).cwiseMax(q - box.high).cwiseMax(Vec2::Zero());
  const double rounding = 0x1.0p-50 * (box.low.cwiseAbs().maxCoeff() + box.high.cwiseAbs().maxCoeff());
  // A lower bound for what is computed site by site: less by the rounding of both.
  const double distance = away.norm() * (1.0 - 0x1.0p-48) - rounding;
  if (distance >= reach) return {{}, distance};
  return by_tree(q, scratch);
}

/// The exact answer: the few nearest sites, nearest first, and a bound on all others.
Candidates BodyField::by_tree(const Vec2& q, Scratch& scratch) const {
  ++scratch.tree_searches;
  const double others = tree_.nearest(*outline_, q, scratch.sites);
  return {scratch.sites, others};
}

namespace {

/// The resolution at which lists near the outline are short: tried with a narrow band, which costs little.
int choose_resolution(const Outline& outline, const FieldOptions& options, FieldRenderer& renderer) {
  FieldOptions trial = options;
  const double size = std::max(outline.bounds.extent().maxCoeff(), 1e-300);
  ListRules rules;
  rules.list_cap = options.list_cap;
  trial.resolution = first_resolution(outline, size);
  // A resolution that cannot be doubled any more is taken without a trial.
  for (double before = std::numeric_limits<double>::infinity(); 2 * trial.resolution <= kMostResolution;) {
    trial.band = rules.band = kTrialBand * size / trial.resolution;
    const double mean =
        render_lists(renderer, outline, plan_body_field(outline, trial).grid, rules).mean_near_outline;
    // No finer where lists are short enough, or where halving the pixels no longer shortens them.
    if (mean <= kMeanList || mean > 0.95 * before) break;
    before = mean;
    trial.resolution *= 2;
  }
  return trial.resolution;
}

}  // namespace

std::unique_ptr<BodyField> render_body_field(std::shared_ptr<const Outline> outline,
                                             const FieldOptions& options, FieldRenderer& renderer) {
  FieldOptions chosen = options;
  // A resolution that was asked for is taken as it is, without trials.
  if (chosen.resolution == 0) chosen.resolution = choose_resolution(*outline, options, renderer);
  const BodyFieldPlan plan = plan_body_field(*outline, chosen);
  ListRules rules;
  rules.list_cap = options.list_cap;
  rules.band = plan.band;
  CandidateLists lists = render_lists(renderer, *outline, plan.grid, rules);
  return std::make_unique<BodyField>(std::move(outline), std::move(lists));
}

}  // namespace brink::detail
