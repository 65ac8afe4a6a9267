#include "brink/core/fields/gl_context.h"

#include <cstdlib>

#include "brink/core/base/error.h"
#include "brink/core/fields/gl_backends.h"

namespace brink {

namespace detail {

GlContext*& current_context() {
  static thread_local GlContext* current = nullptr;
  return current;
}

/// Every context made here is a Releasable, so the cast holds.
void release_current() {
  if (current_context() != nullptr) static_cast<Releasable*>(current_context())->release();
  current_context() = nullptr;
}

}  // namespace detail

namespace {

std::unique_ptr<GlContext> open_named(std::string_view backend, GlLevel level, std::string* why) {
#ifdef BRINK_HAS_OSMESA
  if (backend == "osmesa") return detail::open_osmesa(level, why);
#endif
#ifdef BRINK_HAS_EGL
  if (backend == "egl") return detail::open_egl(level, why);
#endif
  (void)level;
  *why = "this build has no backend \"" + std::string(backend) + "\"";
  return nullptr;
}

}  // namespace

std::vector<std::string_view> gl_backends() {
  std::vector<std::string_view> names;
#ifdef BRINK_HAS_OSMESA
  names.push_back("osmesa");
#endif
#ifdef BRINK_HAS_EGL
  names.push_back("egl");
#endif
  return names;
}

std::unique_ptr<GlContext> open_gl_context(std::string_view backend, GlLevel level) {
  if (backend != "auto" && backend != "osmesa" && backend != "egl") {
    throw BadInput("field.context is \"" + std::string(backend) +
                   "\"; allowed are \"auto\", \"osmesa\", \"egl\"");
  }
  // Before a context is opened: llvmpipe reads it then. What the user has set stays.
  setenv("LP_NUM_THREADS", "0", /*overwrite=*/0);
  std::string answers;
  for (const std::string_view name : gl_backends()) {
    if (backend != "auto" && backend != name) continue;
    std::string why;
    if (auto context = open_named(name, level, &why)) return context;
    answers += "; " + std::string(name) + ": " + why;
  }
  // nothing was tried: the backend was named, and is not in this build
  if (answers.empty()) answers = "; this build has no such backend";
  throw IoError("no OpenGL context for field.context = \"" + std::string(backend) + "\"" + answers);
}

}  // namespace brink
