/// Every draw goes the same way:
///
///     make the context current
///     fit()      binds a target of at least the window's size, and clears it
///     use()      binds the program, which is compiled at its first use, and tells it the window
///     upload()   the batch into its buffer
///     draw()     one call for all sites
///     read back
///
/// draw_candidates() and the second layer draw the batch that is in the buffer already. Targets, programs and
/// buffers are kept as long as the renderer.
#include "brink/core/fields/field_renderer.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <map>
#include <string>

#include "brink/core/base/error.h"

namespace brink::detail {

namespace {

/// Longest side of a square target [pixels].
/// Larger targets are of pictures: as large as they must be, not powers of two, which are four times as much.
constexpr unsigned kMostSquare = 1024;
constexpr int kPictureStep = 64;  ///< their sides are whole multiples of this [pixels]
/// Texture units. `first` and `nearest` are never in one program, so they share one.
constexpr int kUnitFirst = 0, kUnitNearest = 0, kUnitOwners = 1;

/// Where the vertex shader finds one of its inputs in a buffer's entry [bytes]. Integers must not come as
/// floats: an id may have 31 bits, a float holds 24.
struct Attribute {
  int components;
  std::size_t offset;
  bool integer;
};

/// In the order of the locations in the shaders.
/// Id and kind lie side by side, and are one attribute.
constexpr std::array<Attribute, 7> kAttributes = {{{4, offsetof(SiteInstance, frame), false},
                                                   {4, offsetof(SiteInstance, extent), false},
                                                   {4, offsetof(SiteInstance, ends), false},
                                                   {4, offsetof(SiteInstance, arc), false},
                                                   {4, offsetof(SiteInstance, pseudo), false},
                                                   {2, offsetof(SiteInstance, shift), false},
                                                   {2, offsetof(SiteInstance, id), true}}};

/// The same for triangles; value and side are one attribute too.
constexpr std::array<Attribute, 3> kMeshAttributes = {{{2, offsetof(MeshVertex, place), false},
                                                       {2, offsetof(MeshVertex, value), false},
                                                       {2, offsetof(MeshVertex, id), true}}};

/// By the whole scene, not by what is drawn of it: has_arcs does not change with the owner that is left out,
/// so that the others are drawn by the same program and get the same bits.
FieldPrimitives primitives_of(const SiteBatch& batch) {
  return batch.is_mesh    ? FieldPrimitives::mesh
         : batch.has_arcs ? FieldPrimitives::with_arcs
                          : FieldPrimitives::straight;
}

}  // namespace

/// Makes a vertex array and its buffer. `step`: instances between two entries (0: one a vertex).
template <class Attributes>
void FieldRenderer::make_array(const Attributes& attributes, std::size_t stride, GLuint step, GLuint& array,
                               GLuint& buffer) {
  gl_.GenVertexArrays(1, &array);
  gl_.BindVertexArray(array);
  gl_.GenBuffers(1, &buffer);
  gl_.BindBuffer(GL_ARRAY_BUFFER, buffer);
  for (GLuint i = 0; i < attributes.size(); ++i) {
    const Attribute& a = attributes[i];
    // With a buffer bound, the pointer is an offset into it.
    const auto* at = reinterpret_cast<const void*>(a.offset);
    gl_.EnableVertexAttribArray(i);
    gl_.VertexAttribDivisor(i, step);
    const auto size = static_cast<GLsizei>(stride);
    if (a.integer) {
      gl_.VertexAttribIPointer(i, a.components, GL_UNSIGNED_INT, size, at);
    } else {
      gl_.VertexAttribPointer(i, a.components, GL_FLOAT, GL_FALSE, size, at);
    }
  }
}

FieldRenderer::FieldRenderer(std::unique_ptr<GlContext> context) : context_(std::move(context)) {
  context_->make_current();
  gl_ = load_gl_functions(*context_);
  make_array(kMeshAttributes, sizeof(MeshVertex), 0, mesh_vertices_, mesh_);
  make_array(kAttributes, sizeof(SiteInstance), 1, vertices_, instances_);
  gl_.GenBuffers(1, &owner_buffer_);
  gl_.GenTextures(1, &owner_texture_);
  // texels have 4 bytes, so that rows are read without gaps
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 4);
  // Of equal depths the first drawn stays: sites come in ascending order, so the lowest index wins ties.
  gl_.DepthFunc(GL_LESS);
}

FieldRenderer::~FieldRenderer() {
  // Names belong to this context, and another may be current in this thread.
  context_->make_current();
  for (Program& program : programs_) {
    if (program.name != 0) gl_.DeleteProgram(program.name);
  }
  for (Targets* targets : {&image_[0], &image_[1], &bound_}) {
    for (Target& target : *targets) destroy(target);
  }
  gl_.DeleteTextures(1, &owner_texture_);
  for (GLuint* buffer : {&owner_buffer_, &instances_, &mesh_, &storage_}) gl_.DeleteBuffers(1, buffer);
  gl_.DeleteVertexArrays(1, &vertices_);
  gl_.DeleteVertexArrays(1, &mesh_vertices_);
}

/// The program of a kind for the primitives of this batch, bound. The window is set each time; what else a
/// draw needs is set by the caller, at the locations in the answer.
FieldRenderer::Program& FieldRenderer::use(FieldProgram kind, const PixelGrid& grid, const SiteBatch& batch) {
  const FieldPrimitives primitives = primitives_of(batch);
  Program& program =
      programs_[kFieldPrimitives * static_cast<std::size_t>(kind) + static_cast<std::size_t>(primitives)];
  if (program.name == 0) {
    program.name = make_program(gl_, vertex_shader(kind, primitives), fragment_shader(kind, primitives));
    gl_.UseProgram(program.name);
    const auto at = [&](const char* name) { return gl_.GetUniformLocation(program.name, name); };
    // Of a uniform that the program does not have the location is -1, and setting it does nothing.
    program.half_size = at("half_size");
    program.depth_scale = at("depth_scale");
    program.limit = at("limit");
    program.offset = at("offset");
    program.slack = at("slack");
    program.capacity = at("capacity");
    program.width = at("width");
    // Which unit a sampler reads is state of the program: set once.
    gl_.Uniform1i(at("first"), kUnitFirst);
    gl_.Uniform1i(at("nearest"), kUnitNearest);
    gl_.Uniform1i(at("owners"), kUnitOwners);
  }
  gl_.UseProgram(program.name);
  gl_.Uniform2f(program.half_size, 0.5F * static_cast<float>(grid.width),
                0.5F * static_cast<float>(grid.height));
  return program;
}

/// An empty texture of the target's size, one channel, no mipmaps.
GLuint FieldRenderer::texture(GLenum internal, GLenum format, GLenum type, const Target& target) {
  GLuint name = 0;
  gl_.GenTextures(1, &name);
  gl_.BindTexture(GL_TEXTURE_2D, name);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal), target.width, target.height, 0, format, type,
                 nullptr);
  // without mipmaps, and with integers, any other filter leaves a texture incomplete
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return name;
}

/// Also of a target that was made in part. It is then as if it had never been made.
void FieldRenderer::destroy(Target& target) {
  for (GLuint* name : {&target.ids, &target.values, &target.depth}) {
    if (*name != 0) gl_.DeleteTextures(1, name);
  }
  if (target.framebuffer != 0) gl_.DeleteFramebuffers(1, &target.framebuffer);
  target = Target();
}

/// Ids are whole numbers of 32 bits, as their top bit means "inside". Values and depths both have the 24
/// bits of single precision, so that the depth test orders the exact shaders' values without merging any.
/// @throws IoError if the driver does not take the combination.
void FieldRenderer::make_target(Target& target, int width, int height, bool with_ids) {
  target.width = width;
  target.height = height;
  // textures are bound to the active unit: not to that of the owners' table
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.GenFramebuffers(1, &target.framebuffer);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  std::vector<GLenum> buffers;
  const auto attach = [&](GLuint name) {
    const auto slot = static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + buffers.size());
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, slot, GL_TEXTURE_2D, name, 0);
    buffers.push_back(slot);
  };
  // The order of attachments is that of the shaders' outputs: ids at 0 and values at 1,
  // or values alone at 0.
  if (with_ids) attach(target.ids = texture(GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, target));
  attach(target.values = texture(GL_R32F, GL_RED, GL_FLOAT, target));
  target.depth = texture(GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, target);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, target.depth, 0);
  gl_.DrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
  if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    // else the next window of this size would find it made
    destroy(target);
    throw IoError("the framebuffer of a field (" + std::to_string(width) + " x " + std::to_string(height) +
                  " pixels) is incomplete on " + context_->description());
  }
}

/// Draws from now on into a target at least as large as the window, cleared.
void FieldRenderer::fit(Targets& targets, const PixelGrid& grid, bool with_ids) {
  // The index is the exponent: 5 for the least size, 13 for windows of 8192 pixels, the largest there are.
  const auto size = std::bit_ceil(static_cast<unsigned>(std::max({grid.width, grid.height, 32})));
  Target& target = targets[static_cast<std::size_t>(std::bit_width(size)) - 1];
  // One target for each power of two, the smallest of 32 pixels; larger windows of the same power of two
  // share a slot, and the target is made again when their sides differ.
  const bool picture = size > kMostSquare;
  const auto side = [&](int pixels) {
    return picture ? (pixels + kPictureStep - 1) / kPictureStep * kPictureStep : static_cast<int>(size);
  };
  const int width = side(grid.width), height = side(grid.height);
  if (target.width != width || target.height != height) destroy(target);
  if (target.framebuffer == 0) make_target(target, width, height, with_ids);
  current_ = &target;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  // The viewport cuts to the window. Clears do not heed it: they cost the whole target.
  gl_.Viewport(0, 0, grid.width, grid.height);
  const GLuint none[4] = {0xffffffffU, 0, 0, 0};
  const float far = 1.0F, infinite[4] = {std::numeric_limits<float>::infinity(), 0, 0, 0};
  // What stays where nothing is drawn: FieldImage::kNone, an infinite value, and a depth that every drawn one
  // is below. The numbers are those of draw buffers: values come second where there are ids.
  if (with_ids) gl_.ClearBufferuiv(GL_COLOR, 0, none);
  gl_.ClearBufferfv(GL_COLOR, with_ids ? 1 : 0, infinite);
  gl_.ClearBufferfv(GL_DEPTH, 0, &far);
}

/// The batch into the buffer of its kind, where draw() finds it.
void FieldRenderer::upload(const SiteBatch& batch) {
  const auto send = [&](GLuint buffer, const auto& entries) {
    gl_.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(entries.size() * sizeof(entries[0])),
                   entries.data(), GL_STREAM_DRAW);
  };
  batch.is_mesh ? send(mesh_, batch.triangles) : send(instances_, batch.instances);
}

/// One call for all sites of the batch that was uploaded last. An empty batch draws nothing, and counts.
void FieldRenderer::draw(const PixelGrid& grid, const SiteBatch& batch) {
  gl_.BindVertexArray(batch.is_mesh ? mesh_vertices_ : vertices_);
  if (!batch.triangles.empty()) {
    gl_.DrawArraysInstanced(GL_TRIANGLES, 0, static_cast<GLsizei>(batch.triangles.size()), 1);
  } else if (!batch.instances.empty()) {
    gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(batch.instances.size()));
  }
  // the window once, not its fragments, which are more where quads overlap
  pixels_drawn_ += static_cast<std::uint64_t>(grid.width) * static_cast<std::uint64_t>(grid.height);
}

void FieldRenderer::draw_image(const PixelGrid& grid, const SiteBatch& batch, double limit, int layer,
                               const std::vector<std::uint32_t>& owners) {
  context_->make_current();
  // before fit() makes the other layer's target the current one
  const GLuint first_ids = layer == 1 ? current_->ids : 0;
  fit(image_[layer], grid, /*with_ids=*/true);
  Program& program = use(layer == 0 ? FieldProgram::first : FieldProgram::second, grid, batch);
  // a power of two: scaling changes no bit of a value, so that depths compare as values do
  gl_.Uniform1f(program.depth_scale, static_cast<float>(batch.depth_scale));
  gl_.Uniform1f(program.limit, static_cast<float>(limit));
  gl_.Uniform1f(program.offset, static_cast<float>(batch.offset));
  // The second layer asks of each fragment whose site the first one shows there: it reads that layer's ids, and
  // a table of owners by id. The batch is in its buffer since the first.
  if (layer == 1) {
    gl_.ActiveTexture(GL_TEXTURE0 + kUnitFirst);
    gl_.BindTexture(GL_TEXTURE_2D, first_ids);
    gl_.BindBuffer(GL_TEXTURE_BUFFER, owner_buffer_);
    gl_.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(owners.size() * sizeof(std::uint32_t)),
                   owners.data(), GL_STREAM_DRAW);
    gl_.ActiveTexture(GL_TEXTURE0 + kUnitOwners);
    gl_.BindTexture(GL_TEXTURE_BUFFER, owner_texture_);
    gl_.TexBuffer(GL_TEXTURE_BUFFER, GL_R32UI, owner_buffer_);
  } else {
    upload(batch);
  }
  gl_.Enable(GL_DEPTH_TEST);
  draw(grid, batch);
}

/// Of the framebuffer that is bound, in the context that is current: nothing else may have been drawn since.
/// Waits until the draw is done.
void FieldRenderer::read_image(int x, int y, int width, int height, std::uint32_t* ids, float* values) {
  gl_.ReadBuffer(GL_COLOR_ATTACHMENT0);
  gl_.ReadPixels(x, y, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, ids);
  gl_.ReadBuffer(GL_COLOR_ATTACHMENT1);
  gl_.ReadPixels(x, y, width, height, GL_RED, GL_FLOAT, values);
  pixels_read_ += static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
}

std::vector<float> FieldRenderer::draw_bounds(const PixelGrid& grid, const SiteBatch& batch) {
  context_->make_current();
  fit(bound_, grid, /*with_ids=*/false);
  Program& program = use(FieldProgram::bound, grid, batch);
  gl_.Uniform1f(program.depth_scale, static_cast<float>(batch.depth_scale));
  // Values are upper bounds here, as the batch was made with BatchRules::bounds.
  upload(batch);
  gl_.Enable(GL_DEPTH_TEST);
  draw(grid, batch);
  std::vector<float> bounds(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height));
  gl_.ReadBuffer(GL_COLOR_ATTACHMENT0);
  gl_.ReadPixels(0, 0, grid.width, grid.height, GL_RED, GL_FLOAT, bounds.data());
  pixels_read_ += bounds.size();
  return bounds;
}

/// A storage buffer of at least this size at binding 0.
/// It never shrinks; where it grows, what it held is lost.
void FieldRenderer::bind_storage(std::size_t bytes) {
  if (storage_ == 0) gl_.GenBuffers(1, &storage_);
  // binds the general target as well, which BufferData and the calls after this one work on
  gl_.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, storage_);
  if (storage_bytes_ < bytes) {
    gl_.BufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_READ);
    storage_bytes_ = bytes;
  }
}

std::vector<PixelEntry> FieldRenderer::draw_candidates(const PixelGrid& grid, const SiteBatch& batch,
                                                       double slack, std::size_t capacity) {
  Program& program = use(FieldProgram::append, grid, batch);
  gl_.Uniform1f(program.slack, static_cast<float>(slack));
  gl_.Uniform1ui(program.width, static_cast<GLuint>(grid.width));
  gl_.ActiveTexture(GL_TEXTURE0 + kUnitNearest);
  gl_.BindTexture(GL_TEXTURE_2D, current_->values);
  // No colour is written while the shader reads the values of the same target. Without a depth test
  // every site has its fragment, not only the nearest.
  gl_.Disable(GL_DEPTH_TEST);
  gl_.DrawBuffers(0, nullptr);
  // The two words in front of the entries (kAppend): how many there are, and one unused.
  std::array<std::uint32_t, 2> head{};
  // At most two rounds: how many entries there are does not depend on the room.
  for (bool fits = false; !fits;) {
    // the counter starts from 0 in each round
    bind_storage(8 + capacity * sizeof(PixelEntry));
    head = {0, 0};
    gl_.BufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof(head), head.data());
    gl_.Uniform1ui(program.capacity, static_cast<GLuint>(capacity));
    draw(grid, batch);
    // without it GetBufferSubData may not see what the shaders wrote
    gl_.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl_.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof(head), head.data());
    // the count goes on past the capacity: it is the room that the next round needs
    fits = head[0] <= capacity;
    if (!fits) ++redraws_;
    capacity = std::max<std::size_t>(capacity, head[0]);
  }
  std::vector<PixelEntry> entries(head[0]);
  gl_.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 8, static_cast<GLsizeiptr>(head[0] * sizeof(PixelEntry)),
                       entries.data());
  // The draw buffers are state of the target, which draw_bounds() will use again.
  const GLenum first = GL_COLOR_ATTACHMENT0;
  gl_.DrawBuffers(1, &first);
  return entries;
}

/// Nothing of the picture is looked at: the target only makes the rasteriser go over the window.
std::vector<std::uint32_t> FieldRenderer::draw_marks(const PixelGrid& grid, const SiteBatch& batch,
                                                     double limit, std::size_t count) {
  context_->make_current();
  fit(bound_, grid, /*with_ids=*/false);
  Program& program = use(FieldProgram::mark, grid, batch);
  gl_.Uniform1f(program.limit, static_cast<float>(limit));
  upload(batch);
  std::vector<std::uint32_t> marks(count, 0);
  // Never empty: a buffer without storage cannot be bound to a block.
  bind_storage(std::max<std::size_t>(count, 1) * sizeof(std::uint32_t));
  gl_.BufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(count * sizeof(std::uint32_t)),
                    marks.data());
  gl_.Disable(GL_DEPTH_TEST);
  gl_.DrawBuffers(0, nullptr);
  draw(grid, batch);
  gl_.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  gl_.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(count * sizeof(std::uint32_t)),
                       marks.data());
  const GLenum first = GL_COLOR_ATTACHMENT0;
  gl_.DrawBuffers(1, &first);
  // marks that are read back count as pixels
  pixels_read_ += count;
  return marks;
}

FieldRenderer& thread_renderer(const std::string& backend) {
  // A context belongs to its thread, and opening one costs milliseconds: it is kept as
  // long as the thread lives.
  static thread_local std::map<std::string, std::unique_ptr<FieldRenderer>> renderers;
  auto& renderer = renderers[backend];
  if (!renderer) renderer = std::make_unique<FieldRenderer>(open_gl_context(backend));
  return *renderer;
}

}  // namespace brink::detail
