// Force chains: what contacts that last carry.
#include <algorithm>
#include <cmath>
#include <vector>

#include "brink/scenes/draw/sheet.h"

namespace brink::draw {
namespace {

constexpr double kWidestOfBody = 0.6;           // of a body of middle size, its bounding radius
constexpr double kWidest = 14.0, kLeast = 3.0;  // [pixels], of the widest line
constexpr double kThinnest = 0.12;              // [pixels]: thinner lines are not drawn
constexpr double kOneLine = 0.05;               // between two unit normals
constexpr double kOnePlace = 1e-6;              // of a body's size: two corners that meet there press as one

/// Those of one body at one place along one line as one.
/// A box on a corner has a contact of each feature that meets there; two lines over each other would show
/// the wider alone, and not their sum. What presses there along another line is a force of its own. Contacts of one body are few, so all of them are compared.
std::vector<DrawnForce> merged(const Sheet& sheet) {
  std::vector<DrawnForce> out;
  std::vector<std::vector<std::size_t>> of_body(sheet.bodies.size());
  for (const DrawnForce& f : sheet.options.forces) {
    const double near = kOnePlace * sheet.world.bodies[f.body].outline->bounding_radius;
    auto& known = of_body[f.body];
    const auto same = std::find_if(known.begin(), known.end(), [&](std::size_t k) {
      return (out[k].arm - f.arm).norm() <= near && (out[k].normal - f.normal).norm() <= kOneLine;
    });
    if (same != known.end()) {
      out[*same].newtons += f.newtons;
      continue;
    }
    known.push_back(out.size());
    out.push_back(f);
  }
  return out;
}

/// The width of the widest line [pixels].
/// Of the median body, so that one huge body does not make all lines wide.
double widest(const Sheet& sheet) {
  std::vector<double> radii;
  for (const Body& body : sheet.world.bodies) radii.push_back(body.outline->bounding_radius);
  if (radii.empty()) return kLeast;
  // The upper median of an even number; linear in the number of bodies.
  std::nth_element(radii.begin(), radii.begin() + radii.size() / 2, radii.end());
  return std::clamp(kWidestOfBody * radii[radii.size() / 2] * sheet.view.scale, kLeast, kWidest);
}

/// 0 where there are none [N].
double largest(const std::vector<DrawnForce>& forces) {
  double most = 0.0;
  for (const DrawnForce& f : forces) most = std::max(most, f.newtons);
  return most;
}

}  // namespace

// The legend names the same force that the widest line has: both are of merged forces.
double largest_force(const Sheet& sheet) { return largest(merged(sheet)); }

void draw_forces(Canvas& canvas, const Sheet& sheet) {
  const std::vector<DrawnForce> forces = merged(sheet);
  const double most = largest(forces), width = widest(sheet);
  const Color color = Oklch{0.45, 0.17, 25.0}.rgb();
  for (const DrawnForce& f : forces) {
    const double pixels = most > 0.0 ? width * f.newtons / most : 0.0;
    if (pixels < kThinnest) continue;
    const Vec2 from = sheet.bodies[f.body].pose.position;
    Box box;
    box.add(from);
    box.add(from + f.arm);
    for (const Vec2& by : images_of(sheet, box)) canvas.line(from + by, from + by + f.arm, color, pixels);
  }
}

}  // namespace brink::draw
