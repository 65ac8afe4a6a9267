#include "brink/core/fields/gl_functions.h"

#include <array>
#include <string>

#include "brink/core/base/error.h"

namespace brink::detail {

namespace {

/// The address of `name` as a function of that type. @throws IoError if the context has none.
template <class Type>
void load(const GlContext& context, const char* name, Type& function) {
  function = reinterpret_cast<Type>(context.function(name));
  if (function == nullptr) throw IoError(std::string(name) + " is missing from " + context.description());
}

/// A shader of that kind, compiled. @throws IoError with the driver's message, cut to the buffer's length.
GLuint compile(const GlFunctions& gl, GLenum kind, const std::string& source) {
  const GLuint shader = gl.CreateShader(kind);
  const char* text = source.c_str();
  gl.ShaderSource(shader, 1, &text, nullptr);
  gl.CompileShader(shader);
  GLint good = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good != 0) return shader;
  std::array<char, 2048> message{};
  gl.GetShaderInfoLog(shader, static_cast<GLsizei>(message.size()), nullptr, message.data());
  gl.DeleteShader(shader);
  throw IoError(std::string("a field shader does not compile: ") + message.data());
}

}  // namespace

GlFunctions load_gl_functions(const GlContext& context) {
  GlFunctions gl;
#define BRINK_GL_LOAD(name, type) load(context, "gl" #name, gl.name);
  BRINK_GL_FUNCTIONS(BRINK_GL_LOAD)
  // of GL 4.3; a 3.3 context need not have them
  if (context.has_storage_buffers()) {
    BRINK_GL_STORAGE_FUNCTIONS(BRINK_GL_LOAD)
  }
#undef BRINK_GL_LOAD
  return gl;
}

GLuint make_program(const GlFunctions& gl, const std::string& vertex, const std::string& fragment) {
  const GLuint program = gl.CreateProgram();
  for (const auto& [kind, source] : {std::pair{GL_VERTEX_SHADER, &vertex}, {GL_FRAGMENT_SHADER, &fragment}}) {
    const GLuint shader = compile(gl, static_cast<GLenum>(kind), *source);
    gl.AttachShader(program, shader);
    // only marked: it goes with the program
    gl.DeleteShader(shader);
  }
  gl.LinkProgram(program);
  GLint good = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &good);
  if (good != 0) return program;
  std::array<char, 2048> message{};
  gl.GetProgramInfoLog(program, static_cast<GLsizei>(message.size()), nullptr, message.data());
  gl.DeleteProgram(program);
  throw IoError(std::string("a field program does not link: ") + message.data());
}

}  // namespace brink::detail
