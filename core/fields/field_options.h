#pragma once
/// Choices of the `[field]` table; the only home of their defaults.

#include <string>

namespace brink {

struct FieldOptions {
  int resolution = 0;  ///< pixels along the longer side of a body field; 0: chosen by shape, 16..1024
  double band = 0.0;   ///< width of the rendered band around the outline [m]; 0: chosen by shape
  std::string primitives = "exact";  ///< pass windows: "exact" distances | "mesh" of cones and tents
  double mesh_error = 0.1;           ///< mesh: how far a cone or tent may be off its site's distance [pixel]
  std::string readback = "window";   ///< "full" | "window" | "pixel"
  std::string passes = "each";       ///< detector depth: "each" body's window | "two_layers" for all bodies
  bool truncated = true;  ///< detector depth: draw sites only as far as a contact can be (false: everywhere)
  std::string context = "auto";  ///< "auto" | "osmesa" | "egl"
  int brute_force_below = 16;  ///< outlines of fewer sites than this need no field (0: every outline has one)
  int list_cap = 24;           ///< longest candidate list kept in a pixel; longer ones are answered by a tree

  bool is_valid(std::string* error) const;
};

}  // namespace brink
