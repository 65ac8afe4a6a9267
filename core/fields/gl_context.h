#pragma once
/// One off-screen OpenGL context behind one interface: OSMesa, or EGL surfaceless, chosen at run time.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace brink {

/// An off-screen core-profile context (GL >= 3.3; 4.3 wanted). Belongs to the thread that made it.
class GlContext {
 public:
  virtual ~GlContext() = default;
  /// Makes this the thread's context; nothing to do if it is already.
  virtual void make_current() = 0;
  /// Address of a GL function, or null.
  virtual void* function(const char* name) const = 0;
  virtual std::string_view backend() const = 0;  ///< "osmesa" or "egl"
  virtual std::string description() const = 0;   ///< renderer and GL version, for people
  /// True if GL >= 4.3: storage buffers and atomic counters, so candidate lists are collected by the
  /// renderer.
  virtual bool has_storage_buffers() const = 0;
};

/// Backends that this build knows, best first.
std::vector<std::string_view> gl_backends();

/// Which GL a context is asked for.
enum class GlLevel {
  newest,   ///< 4.5, else 4.3, else 3.3
  only_33,  ///< 3.3, storage buffers declared absent: the path that older drivers take
};

/// Opens a context. `backend`: "auto" (the first that opens), "osmesa" or "egl".
///
/// Sets LP_NUM_THREADS=0 in the environment if it is unset: llvmpipe then draws in the calling thread, which
/// is fastest for the small windows drawn here. Cost: 5 to 80 ms.
/// @throws BadInput on an unknown name; IoError (saying what each backend answered) if none opens.
std::unique_ptr<GlContext> open_gl_context(std::string_view backend = "auto",
                                           GlLevel level = GlLevel::newest);

}  // namespace brink
