// Each problem is in one mode of contact from its beginning on, or ends in one: rolling, or sliding and
// then rest. With restitution 0 and a start on the ground nothing bounces.
#include "brink/scenes/bench/lasting_problems.h"

#include <fmt/format.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <numbers>

#include "brink/core/shapes/shapes.h"
#include "brink/core/world/make_body.h"

namespace brink::bench {

namespace {

/// One body on one site, without rebound.
/// `pose` is the ground's; the body has mass 1 kg and begins at `start`.
World world_of(double friction, const Shape& ground, const Pose& pose, const Shape& shape,
               const BodyState& start) {
  // Restitution 0: what bounces would add its own error to that of the mode.
  World world;
  world.gravity = {0.0, -kGravity};
  world.materials[0].restitution = 0.0;
  world.materials[0].friction = friction;
  FixedSite site;
  site.name = "ground";
  site.outline = std::make_shared<const Outline>(ground.outline);
  site.pose = pose;
  world.sites.push_back(site);
  Body body = make_body(shape, Mass{1.0});
  body.name = "body";
  body.initial = start;
  world.bodies.push_back(body);
  return world;
}

/// A disc that rolls in a bowl is a pendulum: (1 + 1/2)(R - r) phi'' = -g sin phi.
/// Rolling r |omega| = (R - r) |phi'|, so the kinetic energy is (1 + 1/2) m (R - r)^2 phi'^2 / 2 with the
/// disc's inertia m r^2 / 2. Friction 1 keeps it from slipping: it asks for tan(60 deg) / 3 = 0.58 at most.
Problem rolling_in_a_bowl() {
  const double R = 2.0, r = 0.25, from = std::numbers::pi / 3, until = 5.0;
  const double k = std::sin(from / 2), rate = std::sqrt(2.0 / 3 * kGravity / (R - r));
  // phi(t) = 2 asin(k sn(K(k) - rate t, k)), k = sin(phi(0) / 2): the pendulum from rest, by
  // Jacobi's function.
  const double known = 2 * std::asin(k * boost::math::jacobi_sn(k, boost::math::ellint_1(k) - rate * until));
  Problem p;
  p.name = "rolling_bowl";
  p.title = "disc rolls in a round bowl from 60 degrees, 5 s";
  p.error_of = "angle at the end [rad]";
  // Put on the wall at rest: the centre runs on a circle of radius R - r, phi from straight below.
  p.world = world_of(1.0, make_disc_container(R), {}, make_disc(r),
                     {{(R - r) * Vec2(std::sin(from), -std::cos(from)), 0.0}, {Vec2::Zero(), 0.0}});
  p.until = until;
  p.error = [known](const Problem&, const Outcome& o) {
    const Vec2& at = o.states[0].pose.position;
    // From straight below, positive to the right.
    return std::abs(std::atan2(at.x(), -at.y()) - known);
  };
  return p;
}

/// v^2 / (2 mu g), and stays there.
/// Friction mu m g takes the speed in v / (mu g) = 0.68 s, well before the end.
Problem sliding_to_rest() {
  const double mu = 0.3, v = 2.0;
  Problem p;
  p.name = "stopping_block";
  p.title = "block slides to rest from 2 m/s, friction 0.3, 3 s";
  p.error_of = "place at the end [m]";
  // The block's middle is half its height above y = 0; the ground's upper side is y = 0.
  p.world = world_of(mu, make_box(40.0, 1.0), {{0.0, -0.5}, 0.0}, make_box(1.0, 0.5),
                     {{{0.0, 0.25}, 0.0}, {{v, 0.0}, 0.0}});
  p.until = 3.0;
  p.error = [mu, v](const Problem&, const Outcome& o) {
    return std::abs(o.states[0].pose.position.x() - v * v / (2 * mu * kGravity));
  };
  return p;
}

/// A disc put onto a slope spins up, slipping, where tan of the slope is more than 3 mu; else it rolls at once.
Problem rolling_down() {
  // A disc needs a friction of tan(slope) / 3 = 0.18 to roll.
  const double slope = 0.5, r = 0.25, until = 1.5;  // of tangent 0.546 < 3 * 0.3
  const Vec2 up(-std::sin(slope), std::cos(slope));
  Problem p;
  p.name = "rolling_down";
  p.title = "disc rolls down a slope of 0.5 rad without slip, 1.5 s";
  p.error_of = "place at the end [m]";
  // The ground's upper side passes through the origin; the disc's centre is a radius above it, along the
  // normal.
  p.world = world_of(0.3, make_box(60.0, 1.0), {-0.5 * up, slope}, make_disc(r),
                     {{r * up, 0.0}, {Vec2::Zero(), 0.0}});
  p.until = until;
  p.error = [slope, r, until, up](const Problem&, const Outcome& o) {
    // Two thirds of g sin(slope): the disc's inertia about its rim is 3/2 m r^2.
    const double way = 0.5 * (2.0 / 3) * kGravity * std::sin(slope) * until * until;
    return (o.states[0].pose.position - (r * up - way * Vec2(std::cos(slope), std::sin(slope)))).norm();
  };
  return p;
}

}  // namespace

std::vector<Problem> lasting_problems() { return {rolling_in_a_bowl(), rolling_down(), sliding_to_rest()}; }

std::vector<Setting> lasting_settings() {
  std::vector<Setting> all;
  // Looser ones give the bits of 1e-10: contacts ask for shorter steps.
  for (const int digits : {10, 11, 12, 13}) {
    Setting s{"modes", fmt::format("tolerance 1e-{}", digits), false, {}};
    // Far more than one body has: all of it moves by modes.
    s.options.modes_contacts = 16;
    s.options.tolerance = std::pow(10.0, -digits);
    // Two digits below the relative one, for places near 0.
    s.options.absolute_tolerance = 0.01 * s.options.tolerance;
    all.push_back(s);
  }
  // No modes: islands move in steps of first order, whatever the tolerance.
  Setting steps{"steps", "first order", false, {}};
  steps.options.modes_contacts = 0;
  all.push_back(steps);
  return all;
}

}  // namespace brink::bench
