#include "brink/core/fields/pass_window.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "brink/core/base/error.h"
#include "brink/core/fields/field_renderer.h"
#include "brink/core/fields/site_mesh.h"
#include "brink/core/fields/site_tiles.h"
#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/text.h"

namespace brink {

namespace {

using detail::PixelGrid;
using detail::SiteBatch;

/// Of a drawn id: kImage (field_shaders.cpp) sets it.
constexpr std::uint32_t kInside = 0x80000000U;
/// Pixels along the longer side of the window in which near owners are looked for: one margin finer costs
/// more than the few owners that it would spare.
constexpr int kNearResolution = 16;

/// @throws BadInput naming what cannot be drawn. The window may be one point here: make_grid() asks for a size.
void check_window(const Box& window, std::span<const PlacedOutline> scene) {
  if (window.empty() || !window.low.allFinite() || !window.high.allFinite()) {
    throw BadInput("the pass window is empty or not finite");
  }
  for (const PlacedOutline& item : scene) {
    if (item.outline == nullptr) throw BadInput("a pass window's scene has an entry without an outline");
    if (!item.pose.position.allFinite() || !std::isfinite(item.pose.angle)) {
      throw BadInput("a pass window's scene has a pose that is not finite (owner " +
                     std::to_string(item.owner) + ")");
    }
  }
}

/// An infinite distance is allowed, NaN is not.
void check_distance(const char* name, double value) {
  if (!(value >= 0.0)) {
    throw BadInput(std::string("the pass window's ") + name + " is " + std::to_string(value) +
                   " m; it must be >= 0");
  }
}

/// Square pixels that cover the window, about its centre: of the two sides that would do, the larger.
PixelGrid make_grid(const Box& window, int width, int height) {
  if (width < 1 || height < 1 || width > kMostPassPixels || height > kMostPassPixels) {
    throw BadInput("a pass window of " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels; allowed are 1 to " + std::to_string(kMostPassPixels) + " a side");
  }
  PixelGrid grid;
  grid.width = width;
  grid.height = height;
  grid.pixel = std::max(window.extent().x() / width, window.extent().y() / height);
  if (!(grid.pixel > 0.0)) throw BadInput("the pass window has no size");
  grid.low = window.center() - 0.5 * grid.pixel * Vec2(width, height);
  return grid;
}

/// Whose site an id is, and which of its outline.
struct SiteNames {
  std::vector<std::uint32_t> owner, site;

  explicit SiteNames(std::span<const PlacedOutline> scene) {
    for (const PlacedOutline& item : scene) {
      for (std::uint32_t i = 0; i < item.outline->sites.size(); ++i) {
        owner.push_back(item.owner);
        site.push_back(i);
      }
    }
    // all ids must leave the top bit free, and none may be kNone
    if (owner.size() >= kInside) throw BadInput("a pass window can hold 2^31 - 1 sites at most");
  }
};

/// Turns ids and drawn values into what they mean.
struct Decoder {
  const SiteNames& names;
  const PixelGrid& grid;
  const SiteBatch& batch;

  // from a value in pixels, shifted by the offset, to metres from the surface
  PixelValue decode(std::uint32_t id, float value) const {
    if (id == FieldImage::kNone) return {};
    const std::uint32_t plain = id & ~kInside;
    return {names.owner[plain], names.site[plain],
            static_cast<float>((static_cast<double>(value) - batch.offset) * grid.pixel),
            (id & kInside) != 0};
  }
};

}  // namespace

/// A public call is: check, grid, names, draw, read back, count.
struct PassRenderer::Impl {
  bool mesh;          ///< cones and tents, else exact distances
  bool reads_target;  ///< all of it, not the window alone
  bool reads_pixels;  ///< one by one
  double mesh_error;  ///< [pixel]
  WorkCounters* work;
  detail::FieldRenderer renderer;
  std::vector<std::uint32_t> ids;
  std::vector<float> values;

  /// What draw() has drawn last, and whether `ids` and `values` hold it.
  struct Drawn {
    PixelGrid grid;
    SiteBatch batch;
    SiteNames names{{}};
    bool was_read = false;
  } drawn;

  Impl(const FieldOptions& o, WorkCounters* w)
      : mesh(o.primitives == "mesh"),
        reads_target(o.readback == "full"),
        reads_pixels(o.readback == "pixel"),
        mesh_error(o.mesh_error),
        work(w),
        renderer(open_gl_context(o.context)) {}

  /// Adds what was drawn and read since the renderer's counters stood at the two numbers given.
  void count(std::uint64_t passes, std::uint64_t drawn_before, std::uint64_t read_before) const {
    if (work == nullptr) return;
    work->passes += passes;
    work->pixels_drawn += renderer.pixels_drawn() - drawn_before;
    work->pixels_read += renderer.pixels_read() - read_before;
  }

  /// Reads the window into ids and values; returns the length of their rows.
  int read(const PixelGrid& grid) {
    // the target's rows may be longer than the window's
    const int width = reads_target ? renderer.target_width() : grid.width,
              height = reads_target ? renderer.target_height() : grid.height;
    ids.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    values.resize(ids.size());
    renderer.read_image(0, 0, width, height, ids.data(), values.data());
    return width;
  }

  /// The layer that was drawn last, read and decoded. Cost: all pixels.
  FieldImage image(const PixelGrid& grid, const SiteBatch& batch, const SiteNames& names) {
    const int row = read(grid);
    FieldImage out;
    out.window = grid.box();
    out.pixel = grid.pixel;
    out.width = grid.width;
    out.height = grid.height;
    const std::size_t size = static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
    out.owner.resize(size);
    out.site.resize(size);
    out.distance.resize(size);
    out.inside.resize(size);
    const Decoder decoder{names, grid, batch};
    std::size_t at = 0;
    // only of pixels that show something: the others are infinite
    float farthest = 0.0F;
    for (int j = 0; j < grid.height; ++j) {
      const std::size_t from = static_cast<std::size_t>(j) * static_cast<std::size_t>(row);
      for (std::size_t i = from; i < from + static_cast<std::size_t>(grid.width); ++i, ++at) {
        const PixelValue value = decoder.decode(ids[i], values[i]);
        out.owner[at] = value.owner;
        out.site[at] = value.site;
        out.distance[at] = value.distance;
        out.inside[at] = value.inside ? 1 : 0;
        if (value.owner != FieldImage::kNone) farthest = std::max(farthest, value.distance);
      }
    }
    // 1.001: bounds stay bounds when they are rounded to single precision
    out.tessellation = static_cast<float>(1.001 * batch.tessellation * grid.pixel);
    // 2^-23 of the farthest: decode() rounds to single precision once more
    out.rounding = static_cast<float>(1.001 * batch.largest_error * grid.pixel + 0x1.0p-23 * farthest);
    return out;
  }

  /// Draws the first layer; with `layers` = 2 the batch is kept complete for the second.
  SiteBatch draw_first(const PixelGrid& grid, std::span<const PlacedOutline> scene, std::uint32_t excluded,
                       double band, const SiteNames& names, int layers) {
    check_distance("band", band);
    SiteBatch batch = mesh ? detail::make_mesh_batch(grid, scene, excluded, band, mesh_error)
                           : detail::make_batch(grid, scene, excluded, {band, 0.0, false});
    // a band narrower than a tile cuts sites closer than tiles would
    const bool large = !mesh && std::min(grid.width, grid.height) > detail::kTile &&
                       batch.instances.size() > 1 && band / grid.pixel > detail::kTile;
    if (large) detail::cut_into_tiles(batch, grid, names.owner, band / grid.pixel, layers);
    // the limit is a drawn value: pixels, with the offset
    renderer.draw_image(grid, batch, band / grid.pixel + batch.offset, 0, names.owner);
    return batch;
  }

  /// Reads what draw() has drawn, at the pixels that hold the points. The context is current still, as nothing
  /// else has been drawn since.
  std::vector<PixelValue> pick(std::span<const Vec2> points) {
    const PixelGrid& grid = drawn.grid;
    const Decoder decoder{drawn.names, grid, drawn.batch};
    // the picture is read once, however often points of it are asked for
    if (!reads_pixels && !drawn.was_read) read(grid);
    drawn.was_read = !reads_pixels;
    const std::size_t row = reads_target ? renderer.target_width() : grid.width;
    std::vector<PixelValue> picked;
    picked.reserve(points.size());
    for (const Vec2& p : points) {
      // it would pass through clamp(), and has no pixel
      if (p.hasNaN())
        throw BadInput("a pass window is read at " + text(p) + "; allowed: places that are numbers");
      const Vec2 at = (p - grid.low) / grid.pixel;
      // a point outside: its nearest pixel
      const int i = static_cast<int>(std::clamp(at.x(), 0.0, grid.width - 1.0));
      const int j = static_cast<int>(std::clamp(at.y(), 0.0, grid.height - 1.0));
      // from the target pixel by pixel, or from what was read whole
      std::uint32_t id = 0;
      float value = 0.0F;
      if (reads_pixels) {
        renderer.read_image(i, j, 1, 1, &id, &value);
      } else {
        const std::size_t place = static_cast<std::size_t>(j) * row + static_cast<std::size_t>(i);
        id = ids[place];
        value = values[place];
      }
      picked.push_back(decoder.decode(id, value));
    }
    return picked;
  }
};

PassRenderer::PassRenderer(const FieldOptions& options, WorkCounters* work) {
  std::string error;
  if (!options.is_valid(&error)) throw BadInput(error);
  impl_ = std::make_unique<Impl>(options, work);
}

PassRenderer::~PassRenderer() = default;

std::string PassRenderer::description() const { return impl_->renderer.context().description(); }

FieldImage PassRenderer::render(const Box& window, int width, int height,
                                std::span<const PlacedOutline> scene, std::uint32_t excluded, double band) {
  check_window(window, scene);
  const PixelGrid grid = make_grid(window, width, height);
  const std::uint64_t drawn = impl_->renderer.pixels_drawn(), read = impl_->renderer.pixels_read();
  const SiteNames names(scene);
  const SiteBatch batch = impl_->draw_first(grid, scene, excluded, band, names, 1);
  FieldImage image = impl_->image(grid, batch, names);
  impl_->count(1, drawn, read);
  return image;
}

void PassRenderer::draw(const Box& window, int width, int height, std::span<const PlacedOutline> scene,
                        std::uint32_t excluded, double band) {
  check_window(window, scene);
  Impl::Drawn& drawn = impl_->drawn;
  const std::uint64_t drawn_before = impl_->renderer.pixels_drawn(), read = impl_->renderer.pixels_read();
  const PixelGrid grid = make_grid(window, width, height);
  SiteNames names(scene);
  SiteBatch batch = impl_->draw_first(grid, scene, excluded, band, names, 1);
  // only now, as what was drawn before may still be read where this throws
  drawn.grid = grid;
  drawn.names = std::move(names);
  drawn.batch = std::move(batch);
  drawn.was_read = false;
  impl_->count(1, drawn_before, read);
}

std::vector<PixelValue> PassRenderer::read(std::span<const Vec2> points) {
  const std::uint64_t drawn = impl_->renderer.pixels_drawn(), read = impl_->renderer.pixels_read();
  std::vector<PixelValue> picked = impl_->pick(points);
  impl_->count(0, drawn, read);
  return picked;
}

std::vector<PixelValue> PassRenderer::render_at(const Box& window, int width, int height,
                                                std::span<const PlacedOutline> scene, std::uint32_t excluded,
                                                double band, std::span<const Vec2> points) {
  draw(window, width, height, scene, excluded, band);
  return read(points);
}

std::array<FieldImage, 2> PassRenderer::render_two_layers(const Box& window, int width, int height,
                                                          std::span<const PlacedOutline> scene, double band) {
  check_window(window, scene);
  const PixelGrid grid = make_grid(window, width, height);
  const std::uint64_t drawn = impl_->renderer.pixels_drawn(), read = impl_->renderer.pixels_read();
  const SiteNames names(scene);
  // Nobody is left out: who reads as body k takes the layer in which k does not show.
  const SiteBatch batch = impl_->draw_first(grid, scene, FieldImage::kNone, band, names, 2);
  std::array<FieldImage, 2> layers;
  layers[0] = impl_->image(grid, batch, names);
  // After layer 0 was read: read_image() reads the target drawn last.
  impl_->renderer.draw_image(grid, batch, band / grid.pixel + batch.offset, 1, names.owner);
  layers[1] = impl_->image(grid, batch, names);
  impl_->count(2, drawn, read);
  return layers;
}

namespace {

/// A grid of about kNearResolution pixels that covers the window; a window of no size gets one tiny pixel.
PixelGrid near_grid(const Box& window, double margin) {
  const Vec2 extent = window.extent();
  // A window of no size has a pixel too, one beside which neither the margin (1e-3) nor the place (1e-9)
  // is so large that roundings count.
  const double scale = std::max({extent.maxCoeff(), 1e-3 * margin, 1e-9 * window.center().norm(), 1e-12});
  PixelGrid grid;
  grid.pixel = scale / kNearResolution;
  // one more than needed, so that rounding leaves no strip of the window out
  grid.width = static_cast<int>(std::ceil(extent.x() / grid.pixel)) + 1;
  grid.height = static_cast<int>(std::ceil(extent.y() / grid.pixel)) + 1;
  grid.low = window.center() - 0.5 * grid.pixel * Vec2(grid.width, grid.height);
  return grid;
}

/// The draw for GL older than 4.3, in double precision: 1 for every site that comes within `limit` [m] of a
/// pixel centre.
/// Sites that the batch has left out lie beside the window by more than its margin, and stay 0. Cost: pixels
/// times sites, less where a site is near an early pixel.
std::vector<std::uint32_t> mark_on_cpu(const PixelGrid& grid, const SiteBatch& batch,
                                       std::span<const PlacedOutline> scene, double limit,
                                       std::size_t count) {
  std::vector<std::uint32_t> marks(count, 0);
  auto next = batch.instances.begin();
  std::uint32_t first = 0;
  for (const PlacedOutline& item : scene) {
    const Frame frame(item.pose);
    const auto end = first + static_cast<std::uint32_t>(item.outline->sites.size());
    // instances ascend by id, as the scene's items do: one walk serves both
    for (; next != batch.instances.end() && next->id < end; ++next) {
      const Site& site = item.outline->sites[next->id - first];
      for (int k = 0; k < grid.width * grid.height && marks[next->id] == 0; ++k) {
        const Vec2 p = grid.low + grid.pixel * Vec2(k % grid.width + 0.5, k / grid.width + 0.5);
        if (nearest_on(site, frame.to_local(p)).distance - site.radius <= limit) marks[next->id] = 1;
      }
    }
    first = end;
  }
  return marks;
}

/// True if the solid holds the window, given that no part of its outline comes near the window.
bool holds(const PlacedOutline& item, const Vec2& center) {
  if (!item.outline->solid) return false;
  const Vec2 local = Frame(item.pose).to_local(center);
  // beyond its bounding circle only a container is solid; saves the walk over all sites
  if (!item.outline->container && local.norm() > item.outline->bounding_radius) return false;
  return gap_by_brute_force(*item.outline, local) < 0.0;
}

}  // namespace

NearOwners PassRenderer::near_owners(const Box& window, double margin, std::span<const PlacedOutline> scene,
                                     std::uint32_t excluded) {
  check_window(window, scene);
  check_distance("margin", margin);
  detail::FieldRenderer& renderer = impl_->renderer;
  const std::uint64_t drawn = renderer.pixels_drawn(), read = renderer.pixels_read();
  const PixelGrid grid = near_grid(window, margin);
  // Its quads reach half a pixel's diagonal beyond the margin, as the limit does.
  const SiteBatch batch =
      detail::make_batch(grid, scene, excluded, {margin, detail::kHalfDiagonal + 0.01, true});
  // ids count on over what is left out, so marks are needed for all
  std::size_t count = 0;
  for (const PlacedOutline& item : scene) count += item.outline->sites.size();
  // A point of the window within the margin of a site puts its pixel's centre within margin + half a
  // diagonal. The last factor covers the rounding of the limit to single precision.
  const double limit = (margin / grid.pixel + detail::kHalfDiagonal + batch.offset) * (1.0 + 0x1.0p-22);
  const std::vector<std::uint32_t> marks =
      renderer.context().has_storage_buffers()
          ? renderer.draw_marks(grid, batch, limit, count)
          : mark_on_cpu(grid, batch, scene, (limit - batch.offset) * grid.pixel, count);
  NearOwners near;
  near.others_at_least = std::numeric_limits<double>::infinity();
  auto mark = marks.begin();
  for (const PlacedOutline& item : scene) {
    const auto end = mark + static_cast<std::ptrdiff_t>(item.outline->sites.size());
    const bool marked = std::find(mark, end, 1U) != end;
    mark = end;
    if (item.owner == excluded) continue;
    // Where no outline comes near the window, all of the window is inside the solid or
    // none of it is: its centre tells.
    if (marked || holds(item, window.center())) {
      near.owners.push_back(item.owner);
    } else {
      // one that is not named exists, and is beyond the margin; without any the bound stays infinite
      near.others_at_least = margin;
    }
  }
  std::sort(near.owners.begin(), near.owners.end());
  // an owner may have several outlines in the scene
  near.owners.erase(std::unique(near.owners.begin(), near.owners.end()), near.owners.end());
  impl_->count(1, drawn, read);
  return near;
}

}  // namespace brink
