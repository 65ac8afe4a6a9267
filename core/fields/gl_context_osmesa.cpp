// The OSMesa backend. OSMesa left Mesa in 25.1; where it is missing this file is not compiled.
#include <GL/osmesa.h>

#include <array>

#include "brink/core/fields/gl_backends.h"

namespace brink::detail {

namespace {

/// OSMesa insists on a colour buffer of its own; everything is drawn into framebuffer objects, so one pixel
/// will do.
class OsmesaContext final : public Releasable {
 public:
  OsmesaContext(OSMesaContext context, int version) : context_(context), asked_(version) {}
  ~OsmesaContext() override {
    // as with EGL: current_context() must not be left dangling
    if (current_context() == this) release_current();
    OSMesaDestroyContext(context_);
  }
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  /// Makes this the thread's context; false if OSMesa refuses, and then the thread has none.
  bool bind() {
    if (current_context() == this) return true;
    release_current();
    if (OSMesaMakeCurrent(context_, buffer_.data(), GL_UNSIGNED_BYTE, 1, 1) != GL_TRUE) return false;
    current_context() = this;
    return true;
  }
  void make_current() override { bind(); }
  void release() override { OSMesaMakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }
  void* function(const char* name) const override {
    return reinterpret_cast<void*>(OSMesaGetProcAddress(name));
  }
  std::string_view backend() const override { return "osmesa"; }
  std::string description() const override { return description_; }
  bool has_storage_buffers() const override { return storage_; }

  /// Reads version and renderer. @pre current.
  /// False if GL does not answer, or is older than 3.3.
  bool inspect() {
    const auto get_string = reinterpret_cast<const GLubyte* (*)(GLenum)>(function("glGetString"));
    const auto get_integer = reinterpret_cast<void (*)(GLenum, GLint*)>(function("glGetIntegerv"));
    if (get_string == nullptr || get_integer == nullptr) return false;
    int major = 0, minor = 0;
    get_integer(0x821B /* GL_MAJOR_VERSION */, &major);
    get_integer(0x821C /* GL_MINOR_VERSION */, &minor);
    // asked for 3.3, storage is declared absent even where the driver gives more (GlLevel::only_33)
    storage_ = asked_ >= 43 && 10 * major + minor >= 43;
    const auto* version = reinterpret_cast<const char*>(get_string(GL_VERSION));
    description_ = std::string("OSMesa, OpenGL ") + (version != nullptr ? version : "?");
    return 10 * major + minor >= 33;
  }

 private:
  OSMesaContext context_;
  int asked_;
  bool storage_ = false;
  std::string description_;
  // the one pixel, four bytes of it
  alignas(16) std::array<GLubyte, 16> buffer_{};
};

/// A core-profile context of that version (10 major + minor), or null.
OSMesaContext create(int version) {
  // 0 bits of depth: depth belongs to the framebuffer objects. Zeros at the end close the list.
  const std::array<int, 13> attributes = {OSMESA_FORMAT,
                                          OSMESA_RGBA,
                                          OSMESA_DEPTH_BITS,
                                          0,
                                          OSMESA_PROFILE,
                                          OSMESA_CORE_PROFILE,
                                          OSMESA_CONTEXT_MAJOR_VERSION,
                                          version / 10,
                                          OSMESA_CONTEXT_MINOR_VERSION,
                                          version % 10,
                                          0,
                                          0,
                                          0};
  return OSMesaCreateContextAttribs(attributes.data(), nullptr);
}

}  // namespace

std::unique_ptr<GlContext> open_osmesa(GlLevel level, std::string* why) {
  // Newest first: 4.5, the least with storage buffers, the least that will do.
  for (const int version : {45, 43, 33}) {
    if (level == GlLevel::only_33 && version != 33) continue;
    OSMesaContext raw = create(version);
    if (raw == nullptr) continue;
    auto context = std::make_unique<OsmesaContext>(raw, version);
    if (context->bind() && context->inspect()) return context;
  }
  *why = "OSMesaCreateContextAttribs gave no core profile of 3.3 or later";
  return nullptr;
}

}  // namespace brink::detail
