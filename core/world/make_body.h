#pragma once
/// Bodies of a shape and a mass or a density.

#include "brink/core/shapes/shapes.h"
#include "brink/core/world/world.h"

namespace brink {

/// [kg], > 0.
struct Mass {
  double value;
};
/// [kg/m^2]; of a wire without thickness [kg/m]; > 0.
struct Density {
  double value;
};

/// A body of that shape, everywhere equally dense: outline about the centre of mass, mass, and inertia by the
/// shape's measure. It stands where the shape was drawn, at rest.
/// @throws BadInput if mass or density is not finite and > 0, or the shape has no measure (a point: it needs an
/// inertia of its own).
Body make_body(const Shape& shape, Mass mass);
Body make_body(const Shape& shape, Density density);

}  // namespace brink
