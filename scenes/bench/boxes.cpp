/// The meeting is looked for in steps of kLook, then by bisection on whether the boxes are apart. It shares
/// no code with Brink: gaps are of corners against boxes in their frames, the impulse is written out. What
/// is missed is a contact that is over within a step.
#include "brink/scenes/bench/boxes.h"

#include <cmath>

namespace brink::bench {
namespace {

// [s]; in it the boxes of the benchmark come nearer by less than a millimetre.
constexpr long double kLook = 1e-4L;

struct Point {
  long double x, y;
};

/// A corner of one box against the other: how far outside it is, and the side nearest to it.
struct Corner {
  long double gap = INFINITY;
  bool of_first = true;
  Point place{};   ///< world
  Point normal{};  ///< world, out of the box that is hit
};

/// Holds the corners of `carrier` against `hit`, and keeps in `nearest` whatever is nearer than what is
/// there. `of_first`: the carrier is the first of the two.
void look(const SpinningBox& carrier, const SpinningBox& hit, bool of_first, Corner& nearest) {
  const long double cc = std::cos(carrier.angle), cs = std::sin(carrier.angle);
  const long double hc = std::cos(hit.angle), hs = std::sin(hit.angle);
  // Its corners in its own frame, then in the world.
  for (const int sx : {-1, 1})
    for (const int sy : {-1, 1}) {
      const Point p{sx * carrier.half_width, sy * carrier.half_height};
      const Point world{carrier.x + cc * p.x - cs * p.y, carrier.y + cs * p.x + cc * p.y};
      const Point d{world.x - hit.x, world.y - hit.y};
      // Turned back by the angle of the box that is hit: there its sides are parallel to the axes.
      const Point q{hc * d.x + hs * d.y, -hs * d.x + hc * d.y};
      // In the frame of the box that is hit: how far out along either axis. The larger is the gap: exact in
      // sign, and beside a side in size; off a corner less than the distance, which bisection does not mind.
      const long double out_x = std::abs(q.x) - hit.half_width, out_y = std::abs(q.y) - hit.half_height;
      const long double gap = std::max(out_x, out_y);
      // The first of equal ones is kept: boxes that meet side to side would have two, which this reference
      // does not know.
      if (gap >= nearest.gap) continue;
      // The side that it is farther out of, on the corner's own hand; its outward normal is then turned
      // into the world.
      const long double side = out_x > out_y ? std::copysign(1.0L, q.x) : std::copysign(1.0L, q.y);
      nearest = {gap, of_first, world,
                 out_x > out_y ? Point{side * hc, side * hs} : Point{-side * hs, side * hc}};
    }
}

// Two convex polygons that come together touch first at a corner of one of them.
Corner nearest_corner(const SpinningBox& a, const SpinningBox& b) {
  Corner nearest;
  look(a, b, true, nearest);
  look(b, a, false, nearest);
  return nearest;
}

/// First time of contact in (from, end), or infinity.
long double first_contact(const SpinningBox& a, const SpinningBox& b, long double from, long double end) {
  const auto apart = [&](long double t) { return nearest_corner(a.at(t), b.at(t)).gap > 0.0L; };
  long double high = from + kLook;
  // @pre apart at `from`: then low is apart and high is not, which bisection keeps.
  while (high < end && apart(high)) high += kLook;
  // Also a meeting within the last step before the end is not one: steps are not cut there.
  if (high >= end) return INFINITY;
  long double low = high - kLook;
  // 1e-4 / 2^70 s is far below a rounding of any time here.
  for (int k = 0; k < 70; ++k) {
    const long double middle = 0.5L * (low + high);
    (apart(middle) ? low : high) = middle;
  }
  // The last time apart, so that the pair is not found again at once.
  return low;
}

/// Elastic, without friction: the normal rate of the contact points is turned round.
void collide(SpinningBox& a, SpinningBox& b) {
  const Corner c = nearest_corner(a, b);
  const long double turn = c.of_first ? 1.0L : -1.0L;  // the normal points into a
  const Point n{turn * c.normal.x, turn * c.normal.y};
  const Point ra{c.place.x - a.x, c.place.y - a.y}, rb{c.place.x - b.x, c.place.y - b.y};
  // Lengths of the arms across the normal: rates of the contact points along it are v.n + omega arm.
  const long double arm_a = ra.x * n.y - ra.y * n.x, arm_b = rb.x * n.y - rb.y * n.x;
  const long double rate = (a.vx - b.vx) * n.x + (a.vy - b.vy) * n.y + a.omega * arm_a - b.omega * arm_b;
  // What the relative rate changes by for an impulse of 1 N s.
  const long double yield =
      1.0L / a.mass + 1.0L / b.mass + arm_a * arm_a / a.inertia + arm_b * arm_b / b.inertia;
  // Elastic: the rate is to become its own opposite.
  const long double impulse = -2.0L * rate / yield;
  // Equal and opposite impulses at one point: momentum and angular momentum are kept to rounding.
  a.vx += impulse * n.x / a.mass;
  a.vy += impulse * n.y / a.mass;
  a.omega += impulse * arm_a / a.inertia;
  b.vx -= impulse * n.x / b.mass;
  b.vy -= impulse * n.y / b.mass;
  b.omega -= impulse * arm_b / b.inertia;
}

}  // namespace

SpinningBox::SpinningBox(const Body& body, double width, double height)
    : x(body.initial.pose.position.x()),
      y(body.initial.pose.position.y()),
      angle(body.initial.pose.angle),
      vx(body.initial.twist.velocity.x()),
      vy(body.initial.twist.velocity.y()),
      omega(body.initial.twist.omega),
      mass(body.mass),
      inertia(body.inertia),
      half_width(0.5L * width),
      half_height(0.5L * height) {}

SpinningBox SpinningBox::at(long double t) const {
  SpinningBox moved = *this;
  moved.x += t * vx;
  moved.y += t * vy;
  moved.angle += t * omega;
  return moved;
}

BoxCollision meet(const SpinningBox& a, const SpinningBox& b, double end) {
  const long double t = first_contact(a, b, 0.0L, end);
  if (!std::isfinite(t)) throw BadInput("the boxes of the benchmark do not meet");
  SpinningBox a1 = a.at(t), b1 = b.at(t);
  collide(a1, b1);
  // A second meeting would make the end depend on more than this reference knows.
  if (std::isfinite(first_contact(a1, b1, 0.0L, end - t)))
    throw BadInput("the boxes of the benchmark meet twice");
  return {t, {a1.at(end - t), b1.at(end - t)}};
}

}  // namespace brink::bench
