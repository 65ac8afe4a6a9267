#include "brink/core/shapes/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "brink/core/base/error.h"
#include "brink/core/base/random.h"
#include "brink/core/shapes/boundary_walk.h"
#include "brink/core/shapes/text.h"

namespace brink {

namespace {

/// The spacing asked for [m], or what `count` makes of a length.
double spacing_of(const char* kind, const Sampling& sampling, double of_count) {
  // infinite for a count of 0, or NaN where the length is 0 too
  const double spacing = sampling.spacing > 0.0 ? sampling.spacing : of_count / sampling.count;
  if (std::isfinite(spacing) && sampling.spacing >= 0.0 && sampling.count >= 0 && spacing >= 0.0)
    return spacing;
  throw BadInput(std::string("sampling: ") + kind + " needs a spacing or a count; given spacing " +
                 text(sampling.spacing) + " m and count " + std::to_string(sampling.count) +
                 ", allowed: one of them > 0 and finite");
}

/// @throws BadInput if so many are too many for one outline. Asked before they are made, as far as is known then.
void check_number(const char* kind, double number) {
  if (number <= kMostParticles) return;
  throw BadInput(std::string("sampling: ") + kind + " would make about " + text(number) +
                 " particles of one shape, allowed: at most " + std::to_string(kMostParticles));
}

/// Particles on the surface: without thickness, and without an area of their own.
std::vector<Particle> on(const std::vector<Vec2>& points) {
  std::vector<Particle> particles;
  for (const Vec2& p : points) particles.push_back({p, 0.0, 0.0});
  return particles;
}

/// The vertices among the exact samples: arcs are left out.
std::vector<Particle> vertices(const Outline& outline) {
  std::vector<Particle> particles;
  for (const Sample& sample : outline.samples)
    if (sample.arc_site < 0) particles.push_back({sample.p, sample.radius, 0.0});
  return particles;
}

/// At most `spacing` [m] apart along the pieces.
std::vector<Particle> boundary(const std::vector<Site>& pieces, double spacing) {
  // parts are rounded up, by at most one a piece; ends that meet are kept once
  check_number("boundary", total_length(pieces) / spacing + static_cast<double>(pieces.size()));
  return on(walk(pieces, spacing));
}

std::vector<Particle> boundary(const Outline& outline, const Sampling& sampling) {
  const std::vector<Site> pieces = boundary_pieces(outline);
  return boundary(pieces, spacing_of("boundary", sampling, total_length(pieces)));
}

/// A lattice in the middle of its cells, so that a box of whole cells is filled evenly.
std::vector<Particle> volume(const Outline& outline, const Sampling& sampling) {
  const Vec2 extent = outline.bounds.extent();
  const double spacing = spacing_of("volume", sampling, extent.maxCoeff());
  // the box's cells now, so that no lattice is begun that is too large; the boundary comes on top
  check_number("volume", extent.x() * extent.y() / (spacing * spacing));
  std::vector<Particle> particles = boundary(boundary_pieces(outline), spacing);
  // its solid goes on for ever
  if (outline.container) return particles;
  // 1e-6: whole cells up to rounding are no cell more
  const Vec2 cells = (extent.array() / spacing - 1e-6).ceil().max(1.0);
  const Vec2 low = outline.bounds.center() - 0.5 * spacing * cells;
  for (double j = 0.5; j < cells.y(); ++j)
    for (double i = 0.5; i < cells.x(); ++i) {
      const Vec2 p = low + spacing * Vec2(i, j);
      if (gap_by_brute_force(outline, p) < 0.0) particles.push_back({p, 0.0, spacing * spacing});
    }
  check_number("volume", static_cast<double>(particles.size()));
  return particles;
}

/// With a spacing, as many as it would take to walk round; at least one.
std::vector<Particle> random(const Outline& outline, const Sampling& sampling) {
  const std::vector<Site> pieces = boundary_pieces(outline);
  const double whole = total_length(pieces);
  const double spacing = spacing_of("random", sampling, whole);
  const double count = sampling.spacing > 0.0 ? std::ceil(whole / spacing) : sampling.count;
  check_number("random", count);
  Random draw(sampling.seed);
  std::vector<Vec2> points;
  for (int k = 0; k < static_cast<int>(std::max(count, 1.0)); ++k)
    // by length, so that every place of the boundary is equally likely
    points.push_back(point_at(pieces, draw.uniform(0.0, whole)));
  return on(points);
}

/// Pixels that a walk along the boundary, in steps of an eighth of a pixel, comes through.
std::vector<Particle> raster(const Outline& outline, const Sampling& sampling) {
  const double pixel = spacing_of("raster", sampling, outline.bounds.extent().maxCoeff());
  const std::vector<Site> pieces = boundary_pieces(outline);
  // before the walk, about as many as there will be: as many as lie along the axes
  check_number("raster", total_length(pieces) / pixel);
  // sorted, so that the order of pixels does not depend on where the walk begins
  std::set<std::pair<double, double>> drawn;  // row, column
  for (const Vec2& p : walk(pieces, pixel / 8.0)) {
    const Vec2 at = ((p - outline.bounds.low) / pixel).array().floor();
    drawn.insert({at.y(), at.x()});
  }
  check_number("raster", static_cast<double>(drawn.size()));
  std::vector<Vec2> points;
  for (const auto& [row, column] : drawn)
    points.emplace_back(outline.bounds.low + pixel * Vec2(column + 0.5, row + 0.5));
  return on(points);
}

/// True where a count is to divide what has no length: a bare point, which is its one particle then.
bool divides_a_point(const Outline& outline, const Sampling& sampling) {
  using Kind = Sampling::Kind;
  return (sampling.kind == Kind::boundary || sampling.kind == Kind::volume ||
          sampling.kind == Kind::raster) &&
         outline.is_point() && outline.sites[0].radius == 0.0 && sampling.spacing == 0.0 &&
         sampling.count > 0;
}

}  // namespace

std::vector<Particle> make_particles(const Outline& outline, const Sampling& sampling) {
  if (divides_a_point(outline, sampling)) return vertices(outline);
  switch (sampling.kind) {
    case Sampling::Kind::vertices:
      break;
    case Sampling::Kind::boundary:
      return boundary(outline, sampling);
    case Sampling::Kind::volume:
      return volume(outline, sampling);
    case Sampling::Kind::random:
      return random(outline, sampling);
    case Sampling::Kind::raster:
      return raster(outline, sampling);
    case Sampling::Kind::file:
      return on(sampling.points);
  }
  return vertices(outline);
}

double widest_gap(const Outline& outline, const std::vector<Particle>& particles, int steps) {
  const std::vector<Site> pieces = boundary_pieces(outline);
  const double whole = total_length(pieces);
  double widest = 0.0;
  // the distance to the nearest particle changes by no more than the way along the boundary, and no place
  // is farther than half a step from one that is looked at
  for (int k = 0; k <= steps; ++k) {
    const Vec2 q = point_at(pieces, whole * k / steps);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Particle& particle : particles)
      nearest = std::min(nearest, std::max(0.0, (q - particle.p).norm() - particle.radius));
    // the disc about q that holds no particle reaches just to the nearest one; its diameter counts
    widest = std::max(widest, 2.0 * nearest);
  }
  return widest;
}

}  // namespace brink
