#pragma once
/// Internal to core/fields: large windows are cut into tiles, and each site is drawn only in the tiles where
/// it can show.
///
/// With c the centre of a tile and R half its diagonal, a site is nearest somewhere in the tile only if
/// d_s(c) <= d1(c) + 2 R (distances are 1-Lipschitz), and it is nearest of another owner than the first layer
/// shows only if d_s(c) <= d2(c) + 2 R, d2 being the smallest distance of any owner but the nearest one's.
/// What is drawn where it shows has the same bits as without tiles; only work that cannot be seen is left
/// out.

#include <vector>

#include "brink/core/fields/site_batch.h"

namespace brink::detail {

/// Side of a tile [pixel].
inline constexpr int kTile = 32;

/// Replaces the batch's quads by tiles. `owners`: by id. `band` [pixel] as in the batch's rules; `layers`: 1
/// or 2. Cost: tiles times sites.
void cut_into_tiles(SiteBatch& batch, const PixelGrid& grid, const std::vector<std::uint32_t>& owners,
                    double band, int layers);

}  // namespace brink::detail
