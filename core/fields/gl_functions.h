#pragma once
/// Internal to core/fields: the GL functions used here, loaded from a GlContext. No loader library, no linked
/// GL.

#include <GL/glcorearb.h>

#include "brink/core/fields/gl_context.h"

// name, type
#define BRINK_GL_FUNCTIONS(X)                                  \
  X(GetIntegerv, PFNGLGETINTEGERVPROC)                         \
  X(GetError, PFNGLGETERRORPROC)                               \
  X(CreateShader, PFNGLCREATESHADERPROC)                       \
  X(ShaderSource, PFNGLSHADERSOURCEPROC)                       \
  X(CompileShader, PFNGLCOMPILESHADERPROC)                     \
  X(GetShaderiv, PFNGLGETSHADERIVPROC)                         \
  X(GetShaderInfoLog, PFNGLGETSHADERINFOLOGPROC)               \
  X(DeleteShader, PFNGLDELETESHADERPROC)                       \
  X(CreateProgram, PFNGLCREATEPROGRAMPROC)                     \
  X(AttachShader, PFNGLATTACHSHADERPROC)                       \
  X(LinkProgram, PFNGLLINKPROGRAMPROC)                         \
  X(GetProgramiv, PFNGLGETPROGRAMIVPROC)                       \
  X(GetProgramInfoLog, PFNGLGETPROGRAMINFOLOGPROC)             \
  X(DeleteProgram, PFNGLDELETEPROGRAMPROC)                     \
  X(UseProgram, PFNGLUSEPROGRAMPROC)                           \
  X(GetUniformLocation, PFNGLGETUNIFORMLOCATIONPROC)           \
  X(Uniform1i, PFNGLUNIFORM1IPROC)                             \
  X(Uniform1ui, PFNGLUNIFORM1UIPROC)                           \
  X(Uniform1f, PFNGLUNIFORM1FPROC)                             \
  X(Uniform2f, PFNGLUNIFORM2FPROC)                             \
  X(GenVertexArrays, PFNGLGENVERTEXARRAYSPROC)                 \
  X(DeleteVertexArrays, PFNGLDELETEVERTEXARRAYSPROC)           \
  X(BindVertexArray, PFNGLBINDVERTEXARRAYPROC)                 \
  X(GenBuffers, PFNGLGENBUFFERSPROC)                           \
  X(DeleteBuffers, PFNGLDELETEBUFFERSPROC)                     \
  X(BindBuffer, PFNGLBINDBUFFERPROC)                           \
  X(BufferData, PFNGLBUFFERDATAPROC)                           \
  X(BufferSubData, PFNGLBUFFERSUBDATAPROC)                     \
  X(GetBufferSubData, PFNGLGETBUFFERSUBDATAPROC)               \
  X(VertexAttribPointer, PFNGLVERTEXATTRIBPOINTERPROC)         \
  X(VertexAttribIPointer, PFNGLVERTEXATTRIBIPOINTERPROC)       \
  X(EnableVertexAttribArray, PFNGLENABLEVERTEXATTRIBARRAYPROC) \
  X(VertexAttribDivisor, PFNGLVERTEXATTRIBDIVISORPROC)         \
  X(DrawArraysInstanced, PFNGLDRAWARRAYSINSTANCEDPROC)         \
  X(GenTextures, PFNGLGENTEXTURESPROC)                         \
  X(DeleteTextures, PFNGLDELETETEXTURESPROC)                   \
  X(BindTexture, PFNGLBINDTEXTUREPROC)                         \
  X(ActiveTexture, PFNGLACTIVETEXTUREPROC)                     \
  X(TexImage2D, PFNGLTEXIMAGE2DPROC)                           \
  X(TexParameteri, PFNGLTEXPARAMETERIPROC)                     \
  X(TexBuffer, PFNGLTEXBUFFERPROC)                             \
  X(GenFramebuffers, PFNGLGENFRAMEBUFFERSPROC)                 \
  X(DeleteFramebuffers, PFNGLDELETEFRAMEBUFFERSPROC)           \
  X(BindFramebuffer, PFNGLBINDFRAMEBUFFERPROC)                 \
  X(FramebufferTexture2D, PFNGLFRAMEBUFFERTEXTURE2DPROC)       \
  X(CheckFramebufferStatus, PFNGLCHECKFRAMEBUFFERSTATUSPROC)   \
  X(DrawBuffers, PFNGLDRAWBUFFERSPROC)                         \
  X(ReadBuffer, PFNGLREADBUFFERPROC)                           \
  X(ReadPixels, PFNGLREADPIXELSPROC)                           \
  X(PixelStorei, PFNGLPIXELSTOREIPROC)                         \
  X(Viewport, PFNGLVIEWPORTPROC)                               \
  X(Enable, PFNGLENABLEPROC)                                   \
  X(Disable, PFNGLDISABLEPROC)                                 \
  X(DepthFunc, PFNGLDEPTHFUNCPROC)                             \
  X(DepthMask, PFNGLDEPTHMASKPROC)                             \
  X(ClearBufferuiv, PFNGLCLEARBUFFERUIVPROC)                   \
  X(ClearBufferfv, PFNGLCLEARBUFFERFVPROC)

// GL 4.3: null where the context has no storage buffers.
#define BRINK_GL_STORAGE_FUNCTIONS(X)        \
  X(BindBufferBase, PFNGLBINDBUFFERBASEPROC) \
  X(MemoryBarrier, PFNGLMEMORYBARRIERPROC)

namespace brink::detail {

struct GlFunctions {
#define BRINK_GL_MEMBER(name, type) type name = nullptr;
  BRINK_GL_FUNCTIONS(BRINK_GL_MEMBER)
  BRINK_GL_STORAGE_FUNCTIONS(BRINK_GL_MEMBER)
#undef BRINK_GL_MEMBER
};

/// @pre `context` is current. @throws IoError naming a function that is missing.
GlFunctions load_gl_functions(const GlContext& context);

/// Compiles and links. @throws IoError with the compiler's message.
GLuint make_program(const GlFunctions& gl, const std::string& vertex, const std::string& fragment);

}  // namespace brink::detail
