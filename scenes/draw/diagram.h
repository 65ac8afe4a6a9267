#pragma once
/// The rendered Voronoi diagram as a picture: what lies beneath the bodies, and the raw layers.

#include <functional>
#include <span>
#include <vector>

#include "brink/core/fields/pass_window.h"
#include "brink/scenes/draw/color.h"
#include "brink/scenes/draw/draw.h"
#include "brink/scenes/draw/view.h"

namespace brink::draw {

/// Every outline of the world in its place. Owners: body k is k, fixed site k is (number of bodies) + k.
std::vector<PlacedOutline> placed_outlines(const World& world, std::span<const BodyState> bodies,
                                           std::span<const Pose> sites);

/// The field seen through a view, one pixel a picture pixel. The band is found by a coarse rendering first, so
/// that no pixel is left without a nearest site and few are drawn in vain. @throws IoError.
FieldImage render_field(std::span<const PlacedOutline> placed, const View& view, std::uint32_t excluded,
                        const FieldOptions& options);

/// Largest distance outside solids [m]; 0 if there is none.
double largest_distance(const FieldImage& field);

/// Cells in quiet colours, white where owners meet, and faint lines of equal distance, contour_step(the largest
/// distance seen) [m] apart. The field, `fineness` x `fineness` pixels a picture pixel, is rendered strip by
/// strip: all of it would take 60 bytes a pixel. Pictures wider than kMostPassPixels / fineness are rendered less finely. @throws IoError.
Picture cells_picture(std::span<const PlacedOutline> placed, const View& view, int fineness,
                      std::uint32_t excluded, const FieldOptions& options, const Palette& palette,
                      std::size_t body_count, const std::function<double(double)>& contour_step);

/// One strong hue an owner, one shade a site, darker inside solids. @pre one field pixel a picture pixel.
Picture ids_picture(const FieldImage& field, const Palette& palette, std::size_t body_count);

/// distance_color of distance / full_scale, a dark tone inside solids. @pre one field pixel a picture pixel.
Picture distance_picture(const FieldImage& field, double full_scale);

}  // namespace brink::draw
