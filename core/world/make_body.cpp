#include "brink/core/world/make_body.h"

#include <fmt/core.h>

#include <cmath>

#include "brink/core/base/error.h"

namespace brink {

namespace {

/// @throws BadInput unless value is finite and > 0; `what` names it.
void check(const char* what, double value) {
  if (!(std::isfinite(value) && value > 0.0))
    throw BadInput(fmt::format("make_body: {} = {} must be a finite number > 0", what, value));
}

}  // namespace

Body make_body(const Shape& shape, Mass mass) {
  check("mass", mass.value);
  if (!(shape.measure.size > 0.0))
    throw BadInput("make_body: the shape has no area or length; a point's inertia must be given");
  Body body;
  Shape about_centre = centered(shape);
  body.outline = std::make_shared<const Outline>(std::move(about_centre.outline));
  body.mass = mass.value;
  // The measure is of density 1: mass / size is the density, by which the second moment is scaled.
  body.inertia = mass.value * shape.measure.second_moment / shape.measure.size;
  // The outline moves by minus its centroid and the pose by plus it: the shape stays where it was drawn.
  body.initial.pose.position = shape.measure.centroid;
  return body;
}

/// A shape without area or length comes to a mass of 0, which is refused as one.
Body make_body(const Shape& shape, Density density) {
  check("density", density.value);
  return make_body(shape, Mass{density.value * shape.measure.size});
}

}  // namespace brink
