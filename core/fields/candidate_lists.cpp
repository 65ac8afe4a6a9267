#include "brink/core/fields/candidate_lists.h"

#include <algorithm>
#include <cmath>

#include "brink/core/base/error.h"
#include "brink/core/shapes/distance.h"

namespace brink::detail {

namespace {

/// Pixels of the window that a quad can cover: low x, high x, low y, high y (high ones excluded).
/// The quad's box, as the sum of what its two half axes reach along x and y, and a pixel more on each side: a
/// pixel too many only costs a distance. Of an arc's quad, which is wider on one side, the wider half counts.
std::array<int, 4> covered(const SiteInstance& s, const PixelGrid& grid) {
  const double along = std::max(-s.extent[0], s.extent[1]), across = std::max(-s.extent[2], s.extent[3]);
  const double x = std::abs(s.frame[2]) * along + std::abs(s.frame[3]) * across + 1.0;
  const double y = std::abs(s.frame[3]) * along + std::abs(s.frame[2]) * across + 1.0;
  const double cx = s.frame[0] + 0.5 * grid.width, cy = s.frame[1] + 0.5 * grid.height;
  const auto clip = [](double v, int n) {
    return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(n)));
  };
  return {clip(cx - x, grid.width), clip(cx + x + 1.0, grid.width), clip(cy - y, grid.height),
          clip(cy + y + 1.0, grid.height)};
}

/// The second draw for GL older than 4.3: the same test in double precision.
/// It goes over the boxes of the quads. A pixel that no quad covers has an infinite bound and takes every
/// site whose box reaches it; fill_cells() gives it no list. Cost: the pixels of all boxes.
std::vector<PixelEntry> collect_on_cpu(const Outline& outline, const PixelGrid& grid, const SiteBatch& batch,
                                       const std::vector<float>& bounds, double slack) {
  std::vector<PixelEntry> entries;
  for (const SiteInstance& instance : batch.instances) {
    const Site& site = outline.sites[instance.id];
    const auto [x0, x1, y0, y1] = covered(instance, grid);
    for (int j = y0; j < y1; ++j) {
      for (int i = x0; i < x1; ++i) {
        const auto pixel = static_cast<std::uint32_t>(j * grid.width + i);
        const Vec2 p = grid.low + grid.pixel * Vec2(i + 0.5, j + 0.5);
        // [pixel], shifted as the drawn bound is
        const double value = (nearest_on(site, p).distance - site.radius) / grid.pixel + batch.offset;
        // the plain value: in double precision its rounding is far below that of the drawn upper bound
        if (value <= bounds[pixel] + slack) entries.push_back({pixel, instance.id});
      }
    }
  }
  return entries;
}

/// Sorts entries by pixel into `sites` (each list ascending) and returns where every pixel's list starts.
std::vector<std::uint32_t> sort_by_pixel(const std::vector<PixelEntry>& entries, std::size_t pixels,
                                         std::vector<std::uint32_t>& sites) {
  // Counting sort: fragments of many threads arrive in any order, and lists must not depend on it.
  // start[i + 1] is first the length of list i, then where it ends; next[i] is where its next entry goes.
  std::vector<std::uint32_t> start(pixels + 1, 0);
  for (const PixelEntry& e : entries) ++start[e.pixel + 1];
  for (std::size_t i = 0; i < pixels; ++i) start[i + 1] += start[i];
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  sites.resize(entries.size());
  for (const PixelEntry& e : entries) {
    // Within a pixel fragments mostly arrive in the order of the sites: insertion is a plain append.
    std::uint32_t at = next[e.pixel]++;
    for (; at > start[e.pixel] && sites[at - 1] > e.site; --at) sites[at] = sites[at - 1];
    sites[at] = e.site;
  }
  return start;
}

/// A float below x, by less than two units in its last place: a lower bound stays one.
float round_down(double x) {
  return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}

/// Fills the cells; equal lists of neighbouring pixels are kept once.
/// What a pixel becomes goes by U, the least upper bound at its centre: without one in the band it has no
/// list, only a lower bound; a list that is too long is left to the tree; any other is kept.
void fill_cells(const std::vector<std::uint32_t>& start, const std::vector<std::uint32_t>& sorted,
                const std::vector<float>& bounds, const SiteBatch& batch, const ListRules& rules,
                CandidateLists& lists) {
  const double band = rules.band / lists.grid.pixel;
  // Where no upper bound is within the band, each distance exceeds the band less twice the error: an
  // upper bound is above the true distance by that much at most.
  const float out_of_band = round_down((band - 2.0 * batch.largest_error) * lists.grid.pixel);
  lists.cells.resize(bounds.size());
  std::uint32_t last_first = 0, last_count = 0;
  double near_entries = 0.0, near_pixels = 0.0;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    CandidateLists::Cell& cell = lists.cells[i];
    // infinite where nothing was drawn
    const double nearest = bounds[i] - batch.offset;
    if (!(nearest <= band)) {
      cell.others = out_of_band;
      continue;
    }
    // A site that is not listed has its lower bound, and so its distance, above U + slack >= U + 2 h.
    cell.others = round_down((nearest + 2.0 * kHalfDiagonal) * lists.grid.pixel);
    const std::uint32_t count = start[i + 1] - start[i];
    // whatever becomes of the list: a cap must not make the mean look short
    if (nearest < 2.0) {
      near_entries += count;
      near_pixels += 1.0;
    }
    // A pixel with a bound lists at least the site that gave it. Should a driver say
    // otherwise, the tree is right.
    if (count == 0 || count > static_cast<std::uint32_t>(rules.list_cap)) {
      cell.packed = CandidateLists::kTree;
      ++lists.pixels_over_cap;
      continue;
    }
    ++lists.pixels_listed;
    lists.entries += count;
    // both lists ascend, so equal sets are equal sequences
    const auto list = sorted.begin() + start[i];
    // Only the list before is compared: along a row, neighbours are mostly alike.
    if (count != last_count || !std::equal(list, list + count, lists.sites.begin() + last_first)) {
      last_first = static_cast<std::uint32_t>(lists.sites.size());
      last_count = count;
      lists.sites.insert(lists.sites.end(), list, list + count);
    }
    cell.packed = last_first << 8 | count;
  }
  lists.mean_near_outline = near_entries / std::max(1.0, near_pixels);
  // 24 bits of a cell are for the place of its list; cells whose place did not fit go with the rest
  if (lists.sites.size() >= (1U << 24))
    throw IoError("the candidate lists of a field are too long; lower field.resolution");
}

}  // namespace

CandidateLists render_lists(FieldRenderer& renderer, const Outline& outline, const PixelGrid& grid,
                            const ListRules& rules) {
  CandidateLists lists;
  lists.grid = grid;
  const PlacedOutline placed{&outline, Pose(), 0};
  // A site that can be nearest in a pixel of the band lies within band + 2 h of the centre: the quads of
  // the second draw must reach that far, so those of the first do as well (the two draws use one batch).
  const BatchRules batch_rules{rules.band, 2.0 * (kHalfDiagonal + grid.snap()) + 0.01, /*bounds=*/true};
  const SiteBatch batch = make_batch(grid, std::span(&placed, 1), FieldImage::kNone, batch_rules);
  // The sum of bound and slack is rounded to single precision in the shader: a few units in the last place.
  const double slack = 2.0 * (kHalfDiagonal + grid.snap()) + 0x1.0p-22 * batch.largest_value;
  // Nothing else may be drawn until the candidates are: they are compared with what this leaves in its target.
  const std::vector<float> bounds = renderer.draw_bounds(grid, batch);
  std::vector<std::uint32_t> sorted;
  std::vector<std::uint32_t> start;
  if (renderer.context().has_storage_buffers() && !rules.collect_on_cpu) {
    // Four sites a pixel is a guess; one that is too low costs another draw.
    const std::size_t capacity = rules.capacity > 0 ? rules.capacity : 4 * bounds.size() + 1024;
    start = sort_by_pixel(renderer.draw_candidates(grid, batch, slack, capacity), bounds.size(), sorted);
  } else {
    start = sort_by_pixel(collect_on_cpu(outline, grid, batch, bounds, slack), bounds.size(), sorted);
  }
  fill_cells(start, sorted, bounds, batch, rules, lists);
  return lists;
}

}  // namespace brink::detail
