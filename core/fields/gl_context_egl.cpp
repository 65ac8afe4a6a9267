// The EGL backend: a surfaceless context (EGL_MESA_platform_surfaceless), which needs neither display nor
// device.
// EGL_NO_X11 keeps EGL's headers from including those of X11.
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <cstring>

#include "brink/core/fields/gl_backends.h"

namespace brink::detail {

namespace {

/// Values of glGetString() and glGetIntegerv(): EGL's headers have none of GL's names.
constexpr unsigned kGlVersion = 0x1F02, kGlRenderer = 0x1F01, kGlMajorVersion = 0x821B,
                   kGlMinorVersion = 0x821C;

/// A context without a surface. `version`: the GL version it was asked for, as 10 major + minor.
class EglContext final : public Releasable {
 public:
  EglContext(EGLDisplay display, EGLContext context, int version)
      : display_(display), context_(context), asked_(version) {}
  ~EglContext() override {
    // destroying a context that is current only marks it, and would leave current_context() dangling
    if (current_context() == this) release_current();
    eglDestroyContext(display_, context_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// Makes this the thread's context; false if EGL refuses, and then the thread has none.
  bool bind() {
    if (current_context() == this) return true;
    release_current();
    eglBindAPI(EGL_OPENGL_API);
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE) return false;
    current_context() = this;
    return true;
  }
  void make_current() override { bind(); }
  void release() override { eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }
  void* function(const char* name) const override { return reinterpret_cast<void*>(eglGetProcAddress(name)); }
  std::string_view backend() const override { return "egl"; }
  std::string description() const override { return description_; }
  bool has_storage_buffers() const override { return storage_; }

  /// Reads version and renderer. @pre current.
  /// False if GL does not answer, or is older than 3.3.
  bool inspect() {
    const auto get_string = reinterpret_cast<const unsigned char* (*)(unsigned)>(function("glGetString"));
    const auto get_integer = reinterpret_cast<void (*)(unsigned, int*)>(function("glGetIntegerv"));
    if (get_string == nullptr || get_integer == nullptr) return false;
    int major = 0, minor = 0;
    get_integer(kGlMajorVersion, &major);
    get_integer(kGlMinorVersion, &minor);
    // A driver may give a newer version than the one asked for. Asked for 3.3, storage is declared
    // absent all the same: that is what GlLevel::only_33 is for.
    storage_ = asked_ >= 43 && 10 * major + minor >= 43;
    description_ = "EGL surfaceless, OpenGL ";
    for (const unsigned name : {kGlVersion, kGlRenderer}) {
      const auto* text = reinterpret_cast<const char*>(get_string(name));
      if (text != nullptr) description_ += std::string(name == kGlRenderer ? ", " : "") + text;
    }
    return 10 * major + minor >= 33;
  }

 private:
  EGLDisplay display_;
  EGLContext context_;
  int asked_;
  bool storage_ = false;
  std::string description_;
};

/// The surfaceless display, initialised once a process (EGL answers with the same display every time).
/// EGL_NO_DISPLAY where the platform is missing. It is never terminated: contexts of other threads may live on it.
EGLDisplay open_display() {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (extensions == nullptr || std::strstr(extensions, "EGL_MESA_platform_surfaceless") == nullptr) {
    return EGL_NO_DISPLAY;
  }
  EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) != EGL_TRUE)
    return EGL_NO_DISPLAY;
  return display;
}

/// A core-profile context of that version (10 major + minor), or EGL_NO_CONTEXT.
EGLContext create(EGLDisplay display, int version) {
  const std::array<EGLint, 7> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                            version / 10,
                                            EGL_CONTEXT_MINOR_VERSION,
                                            version % 10,
                                            EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                            EGL_NONE};
  // no configuration: nothing is drawn to a surface, only to framebuffer objects
  return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
}

}  // namespace

std::unique_ptr<GlContext> open_egl(GlLevel level, std::string* why) {
  EGLDisplay display = open_display();
  if (display == EGL_NO_DISPLAY) {
    *why = "no EGL display of the platform EGL_MESA_platform_surfaceless";
    return nullptr;
  }
  eglBindAPI(EGL_OPENGL_API);
  // Newest first: 4.5, the least with storage buffers, the least that will do.
  for (const int version : {45, 43, 33}) {
    if (level == GlLevel::only_33 && version != 33) continue;
    EGLContext raw = create(display, version);
    if (raw == EGL_NO_CONTEXT) continue;
    auto context = std::make_unique<EglContext>(display, raw, version);
    // else it is destroyed here, which releases it, before the next is made
    if (context->bind() && context->inspect()) return context;
  }
  *why = "eglCreateContext gave no core profile of 3.3 or later";
  return nullptr;
}

}  // namespace brink::detail
