#pragma once
/// Internal to core/fields: the shaders of the instanced draws.

#include <string>

namespace brink::detail {

/// Which program: all share the vertex shader and the distance functions.
enum class FieldProgram {
  first,   ///< site id and distance of the nearest site
  second,  ///< the same, of the nearest site of another owner than the first layer shows
  bound,   ///< upper bound of the nearest distance only
  append,  ///< (pixel, site) of every candidate into a storage buffer; GL 4.3
  mark     ///< a flag for every site within a limit into a storage buffer; GL 4.3
};
inline constexpr int kFieldPrograms = 5;

/// What the sites are drawn as. llvmpipe runs both sides of a branch, so the code for arcs costs even where
/// all sites are straight: they have a program of their own.
enum class FieldPrimitives { straight, with_arcs, mesh };
inline constexpr int kFieldPrimitives = 3;

/// @pre mesh: `first` or `second`.
std::string vertex_shader(FieldProgram program, FieldPrimitives primitives);
std::string fragment_shader(FieldProgram program, FieldPrimitives primitives);

}  // namespace brink::detail
