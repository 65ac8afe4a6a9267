#pragma once
/// Internal to core/fields: the shaders of the instanced draws.

#include <string>

namespace brink::detail {

/// Which program: all share the vertex shader and the distance function.
enum class FieldProgram {
  image,   ///< site id and distance of the nearest site (first or second layer)
  bound,   ///< upper bound of the nearest distance only
  append,  ///< (pixel, site) of every candidate into a storage buffer; GL 4.3
  mark     ///< a flag for every owner within a limit into a storage buffer; GL 4.3
};

std::string vertex_shader(FieldProgram program);
std::string fragment_shader(FieldProgram program);

}  // namespace brink::detail
