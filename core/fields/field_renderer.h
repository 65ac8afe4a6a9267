#pragma once
/// Internal to core/fields: a GL context with the programs and targets that draw site batches.

#include <memory>
#include <optional>
#include <vector>

#include "brink/core/base/work.h"
#include "brink/core/fields/field_shaders.h"
#include "brink/core/fields/gl_functions.h"
#include "brink/core/fields/site_batch.h"

namespace brink::detail {

/// A pixel of a window and a site that can be nearest in it.
struct PixelEntry {
  std::uint32_t pixel;
  std::uint32_t site;
};

/// Draws batches. Belongs to the thread that made it.
class FieldRenderer {
 public:
  explicit FieldRenderer(std::unique_ptr<GlContext> context);
  ~FieldRenderer();
  FieldRenderer(const FieldRenderer&) = delete;
  FieldRenderer& operator=(const FieldRenderer&) = delete;

  const GlContext& context() const { return *context_; }

  /// Draws ids and values of layer 0 (nearest) or 1 (nearest of another owner than layer 0 shows; @pre layer
  /// 0 has just been drawn with the same batch). Sites beyond `limit` (a drawn value) are left out. `owners`:
  /// by id.
  void draw_image(const PixelGrid& grid, const SiteBatch& batch, double limit, int layer,
                  const std::vector<std::uint32_t>& owners);
  /// Reads a rectangle of the layer drawn last, row-major from the bottom.
  void read_image(int x, int y, int width, int height, std::uint32_t* ids, float* values);
  /// The target that holds the image: at least the window [pixels].
  int target_width() const { return current_->width; }
  int target_height() const { return current_->height; }

  /// Draws the nearest upper bounds; infinity where nothing is drawn.
  std::vector<float> draw_bounds(const PixelGrid& grid, const SiteBatch& batch);
  /// Every (pixel, site) with lower bound <= nearest upper bound + slack, unsorted. @pre draw_bounds() just
  /// before, and storage buffers. Draws again with more room if `capacity` entries do not hold them.
  std::vector<PixelEntry> draw_candidates(const PixelGrid& grid, const SiteBatch& batch, double slack,
                                          std::size_t capacity);
  /// For every id below `count`: 1 if somewhere in the window its lower bound is <= limit. @pre storage
  /// buffers.
  std::vector<std::uint32_t> draw_marks(const PixelGrid& grid, const SiteBatch& batch, double limit,
                                        std::size_t count);

  int redraws() const { return redraws_; }  ///< draws repeated because a list was too short
  std::uint64_t pixels_drawn() const { return pixels_drawn_; }  ///< since construction
  std::uint64_t pixels_read() const { return pixels_read_; }

 private:
  struct Program {
    GLuint name = 0;
    GLint half_size = -1, depth_scale = -1, limit = -1, offset = -1, slack = -1, capacity = -1, width = -1;
  };
  struct Target {
    GLuint framebuffer = 0, ids = 0, values = 0, depth = 0;
    int width = 0, height = 0;
  };

  template <class Attributes>
  void make_array(const Attributes& attributes, std::size_t stride, GLuint step, GLuint& array,
                  GLuint& buffer);
  Program& use(FieldProgram kind, const PixelGrid& grid, const SiteBatch& batch);
  /// Targets of one use by size: squares of powers of two, and larger ones as their windows are. A clear costs
  /// the whole target, so a small window gets a small one.
  using Targets = std::array<Target, 14>;

  void fit(Targets& targets, const PixelGrid& grid, bool with_ids);
  void make_target(Target& target, int width, int height, bool with_ids);
  void upload(const SiteBatch& batch);
  void draw(const PixelGrid& grid, const SiteBatch& batch);
  GLuint texture(GLenum internal, GLenum format, GLenum type, const Target& target);
  void destroy(Target& target);
  void bind_storage(std::size_t bytes);

  std::unique_ptr<GlContext> context_;
  GlFunctions gl_;
  std::array<Program, kFieldPrimitives * kFieldPrograms> programs_{};  ///< by kind and primitives
  Targets image_[2], bound_;
  Target* current_ = nullptr;  ///< the target drawn into last
  GLuint vertices_ = 0, instances_ = 0, mesh_vertices_ = 0, mesh_ = 0, storage_ = 0, owner_buffer_ = 0,
         owner_texture_ = 0;
  std::size_t storage_bytes_ = 0;
  int redraws_ = 0;
  std::uint64_t pixels_drawn_ = 0, pixels_read_ = 0;
};

/// This thread's renderer for a backend ("auto", "osmesa", "egl"), opened at the first call.
FieldRenderer& thread_renderer(const std::string& backend);

}  // namespace brink::detail
