#pragma once
/// Points of two outlines that face each other, found by walking along both: neither can be moved a little
/// along its outline and come nearer to the other. In extended precision, by code of its own.

#include <vector>

#include "brink/core/shapes/outline.h"
#include "tests/support/outside/gap.h"

namespace brink {

struct FacingPoints {
  double gap = 0.0;   ///< thickness and all [m]
  Vec2 on_a, normal;  ///< on a's core, in the world; from b into a
};

/// An outline's core, piece after piece.
class Walk {
 public:
  Walk(const Outline& outline, const Pose& pose)
      : shape_(outside::shape_of(outline)),
        pieces_(outside::placed(shape_, pose.angle, outside::vec(pose.position))),
        sweeps_(outline.sites.size(), 0) {
    for (std::size_t k = 0; k < sweeps_.size(); ++k) sweeps_[k] = outline.sites[k].sweep;
  }
  const outside::Pieces& pieces() const { return pieces_; }
  bool within(const outside::Vec& p) const { return outside::in_solid(shape_, pieces_, p); }
  outside::Vec at(std::size_t piece, outside::Real part) const {
    const outside::Piece& p = pieces_[piece];
    if (p.kind != outside::Piece::Kind::arc) return p.a + (p.b - p.a) * part;
    return p.center + outside::Turn(sweeps_[piece] * part)(p.a - p.center);
  }
  /// How far along a piece a point of it is: 0 at its start, 1 at its end.
  outside::Real part_of(std::size_t piece, const outside::Vec& q) const {
    const outside::Piece& p = pieces_[piece];
    if (p.kind == outside::Piece::Kind::point) return 0;
    if (p.kind == outside::Piece::Kind::segment) return dot(q - p.a, p.b - p.a) / dot(p.b - p.a, p.b - p.a);
    const outside::Vec from = p.a - p.center, to = q - p.center;
    return std::atan2(wedge(from, to), dot(from, to)) / sweeps_[piece];
  }
  /// True if no point a little before or after q, a point of the outline, is nearer to p.
  bool is_nearest_here(const outside::Vec& q, const outside::Vec& p) const {
    constexpr outside::Real kAside = 1e-3L, kNearer = 1e-5L;
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      if (outside::to_core(q, pieces_[k]) > 1e-12L) continue;
      for (const outside::Real by : {-kAside, kAside}) {
        const outside::Vec aside = at(k, std::clamp<outside::Real>(part_of(k, q) + by, 0, 1));
        if (norm(p - aside) < norm(p - q) - kNearer * norm(aside - q)) return false;
      }
    }
    return true;
  }

 private:
  outside::Shape shape_;
  outside::Pieces pieces_;
  std::vector<outside::Real> sweeps_;
};

/// The point of a piece's core that is nearest to p.
inline outside::Vec foot_on(const outside::Piece& c, const outside::Vec& p) {
  using Kind = outside::Piece::Kind;
  const outside::Vec end = norm(p - c.a) <= norm(p - c.b) ? c.a : c.b;
  if (c.kind == Kind::point) return c.a;
  if (c.kind == Kind::arc) {
    const outside::Vec w = p - c.center;
    return outside::in_sector(c, w) ? c.center + w * (c.circle / norm(w)) : end;
  }
  const outside::Vec d = c.b - c.a;
  const outside::Real along = dot(p - c.a, d) / dot(d, d);
  return along <= 0 ? c.a : along >= 1 ? c.b : c.a + d * along;
}

/// Steps along each piece of a; each least distance to each piece of b is made sharp between its neighbours.
inline std::vector<FacingPoints> facing_points(const Outline& a, const Pose& at_a, const Outline& b,
                                               const Pose& at_b) {
  constexpr int kSteps = 400;
  const Walk of_a(a, at_a), of_b(b, at_b);
  std::vector<FacingPoints> found;
  for (std::size_t i = 0; i < of_a.pieces().size(); ++i)
    for (std::size_t j = 0; j < of_b.pieces().size(); ++j) {
      const auto distance = [&](outside::Real part) {
        return outside::to_core(of_a.at(i, part), of_b.pieces()[j]);
      };
      for (int step = 0; step <= kSteps; ++step) {
        outside::Real low = std::max(0, step - 1) / outside::Real(kSteps),
                      high = std::min(kSteps, step + 1) / outside::Real(kSteps);
        const outside::Real middle = step / outside::Real(kSteps);
        if (distance(low) < distance(middle) || distance(high) < distance(middle)) continue;
        for (int k = 0; k < 100; ++k) {
          const outside::Real x = low + (high - low) / 3, y = high - (high - low) / 3;
          (distance(x) <= distance(y) ? high : low) = distance(x) <= distance(y) ? y : x;
        }
        outside::Real part = (low + high) / 2;
        if (step == 0 && part < 1e-9L) part = 0;
        if (step == kSteps && part > 1 - 1e-9L) part = 1;
        const outside::Vec p = of_a.at(i, part), q = foot_on(of_b.pieces()[j], p);
        const outside::Real d = norm(p - q);
        const outside::Vec n = (p - q) * (1 / d);
        const bool faces = !of_b.within(q + n * 1e-6L) && !of_a.within(p - n * 1e-6L);
        if (!faces || !of_b.is_nearest_here(q, p) || !of_a.is_nearest_here(p, q)) continue;
        const outside::Real gap = d - of_a.pieces()[i].thickness - of_b.pieces()[j].thickness;
        found.push_back({static_cast<double>(gap),
                         {static_cast<double>(p.x), static_cast<double>(p.y)},
                         {static_cast<double>(n.x), static_cast<double>(n.y)}});
      }
    }
  return found;
}

}  // namespace brink
