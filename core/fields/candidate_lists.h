#pragma once
/// Internal to core/fields: every pixel's list of the sites that can be nearest somewhere in it.
///
/// Let p be a pixel's centre, h half its diagonal and d1 the nearest distance at p. Each distance is
/// 1-Lipschitz, so a site is nearest somewhere in the pixel only if d_s(p) <= d1(p) + 2 h. The first draw
/// gives an upper bound U >= d1; the second lists every site whose lower bound is <= U + 2 h. A site that is
/// not listed has d_s(p) > U + 2 h.

#include <cstdint>
#include <vector>

#include "brink/core/fields/field_renderer.h"

namespace brink::detail {

struct CandidateLists {
  static constexpr std::uint32_t kTree = 255;  ///< count of a pixel whose list was longer than the cap

  struct Cell {
    std::uint32_t packed = 0;  ///< first << 8 | count; count 0: out of the band
    float others = 0.0F;       ///< every site that is not listed is at least this far from the centre [m]
    std::uint32_t first() const { return packed >> 8; }
    std::uint32_t count() const { return packed & 0xffU; }
  };

  PixelGrid grid;
  std::vector<Cell> cells;
  std::vector<std::uint32_t> sites;
  std::size_t entries = 0;  ///< total length of all lists, before equal neighbours were shared
  int pixels_listed = 0;    ///< pixels with a list
  int pixels_over_cap = 0;
  double mean_near_outline = 0.0;  ///< mean list of pixels within two pixels of the outline, whatever the cap
};

struct ListRules {
  double band = 0.0;  ///< [m]
  int list_cap = 24;
  std::size_t capacity = 0;     ///< entries to make room for at first; 0: guessed
  bool collect_on_cpu = false;  ///< even where the context has storage buffers
};

/// Renders the lists of one outline. @throws IoError if GL refuses.
CandidateLists render_lists(FieldRenderer& renderer, const Outline& outline, const PixelGrid& grid,
                            const ListRules& rules);

}  // namespace brink::detail
