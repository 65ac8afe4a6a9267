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

/// A way to a context: what `field.context` calls it, and how it is opened (gl_backends.h).
struct Backend {
  std::string_view name;
  std::unique_ptr<GlContext> (*open)(GlLevel level, std::string* why);
};

/// Those of this build, the first choice first.
const std::vector<Backend>& backends() {
  static const std::vector<Backend> all{
#ifdef BRINK_HAS_OSMESA
      {"osmesa", detail::open_osmesa},
#endif
#ifdef BRINK_HAS_EGL
      {"egl", detail::open_egl},
#endif
  };
  return all;
}

}  // namespace

std::vector<std::string_view> gl_backends() {
  std::vector<std::string_view> names;
  for (const Backend& each : backends()) names.push_back(each.name);
  return names;
}

/// Each backend is asked in turn; the first context that opens is taken. What the others answered is told
/// only if none does.
std::unique_ptr<GlContext> open_gl_context(std::string_view backend, GlLevel level) {
  // By all names, not by those of this build: a known one that is missing is no mistake of the caller.
  if (backend != "auto" && backend != "osmesa" && backend != "egl") {
    throw BadInput("field.context is \"" + std::string(backend) +
                   "\"; allowed are \"auto\", \"osmesa\", \"egl\"");
  }
  // Before a context is opened: llvmpipe reads it then. What the user has set stays.
  setenv("LP_NUM_THREADS", "0", /*overwrite=*/0);
  std::string answers;
  for (const Backend& each : backends()) {
    if (backend != "auto" && backend != each.name) continue;
    std::string why;
    if (auto context = each.open(level, &why)) return context;
    answers += "; " + std::string(each.name) + ": " + why;
  }
  // nothing was tried: the backend was named, and is not in this build
  if (answers.empty()) answers = "; this build has no such backend";
  throw IoError("no OpenGL context for field.context = \"" + std::string(backend) + "\"" + answers);
}

}  // namespace brink
