#pragma once
/// Internal to core/fields: what each backend of GlContext offers to open_gl_context().

#include <memory>
#include <string>

#include "brink/core/fields/gl_context.h"

namespace brink::detail {

/// Opens a context of this backend, or returns null and says why.
std::unique_ptr<GlContext> open_osmesa(GlLevel level, std::string* why);
std::unique_ptr<GlContext> open_egl(GlLevel level, std::string* why);

/// The context that is current in this thread (null: none). Backends share Mesa's dispatch table of the
/// thread, so one must be released before another is made current.
GlContext*& current_context();

/// Called by a backend before it makes another context current: releases the thread's current one.
class Releasable : public GlContext {
 public:
  virtual void release() = 0;
};
void release_current();

}  // namespace brink::detail
