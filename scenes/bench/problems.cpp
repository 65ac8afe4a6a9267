/// Every answer is computed apart from what is measured: closed forms and references (reference.h, boxes.h)
/// in long double, with the same doubles for gravity, restitution and places that the world has. So what is
/// left as error is Brink's, down to roundings of double.
///
///     bouncing_ball, dropped_disc     falls onto a floor: the series of impacts in closed form
///     rectangle                       a disc between walls: reflections unfolded into straight flights
///     cradle                          equal discs in a row: each collision hands the velocity on
///     shaken_spring, ball_in_air      no motion in closed form for Brink, one for the reference
///     two_boxes                       collision with rotation: the meeting by bisection in long double
#include "brink/scenes/bench/problems.h"

#include <algorithm>
#include <cmath>

#include "brink/core/shapes/shapes.h"
#include "brink/core/world/forces.h"
#include "brink/core/world/make_body.h"
#include "brink/scenes/bench/boxes.h"
#include "brink/scenes/bench/reference.h"

namespace brink::bench {
namespace {

/// A body of mass 1 kg with its centre of mass at `position` [m].
void add_body(World& world, const Shape& shape, const Vec2& position, const Vec2& velocity,
              double angle = 0.0, double omega = 0.0) {
  Body body = make_body(shape, Mass{1.0});
  body.name = "body" + std::to_string(world.bodies.size());
  body.initial = {{position, angle}, {velocity, omega}};
  world.bodies.push_back(std::move(body));
}

/// A wire from one place to another [m], felt from both sides.
void add_wall(World& world, const Vec2& from, const Vec2& to) {
  FixedSite site;
  site.name = "wall" + std::to_string(world.sites.size());
  site.kind = "segment";
  site.outline = std::make_shared<const Outline>(make_segment(from, to).outline);
  world.sites.push_back(std::move(site));
}

/// A disc of that radius with its lowest point `height` above the floor, at rest [m]. The floor is 20 m
/// wide.
World ball_over_floor(double height, double radius, double restitution) {
  World world;
  world.gravity = {0.0, -kGravity};
  world.materials[0].restitution = restitution;
  add_body(world, make_disc(radius), {0.0, height + radius}, {0.0, 0.0});
  add_wall(world, {-10.0, 0.0}, {10.0, 0.0});
  return world;
}

/// Impacts taken in order. One that never came is late by what was left of the run, at least.
/// Impacts beyond those that are known do not count here.
double worst_impact_time(const Problem& problem, const Outcome& outcome) {
  double worst = 0.0;
  for (std::size_t k = 0; k < problem.hits.size(); ++k) {
    const double hit = k < outcome.hits.size() ? outcome.hits[k] : problem.until;
    worst = std::max(worst, std::abs(hit - problem.hits[k]));
  }
  return worst;
}

/// Impact n at t1 (1 + 2 (e + e^2 + ... + e^(n-1))), t1 = sqrt(2 h / g).
std::vector<double> bouncing_impacts(double height, double restitution, double until) {
  const long double t1 = std::sqrt(2.0L * height / static_cast<long double>(kGravity));
  std::vector<double> times;
  long double power = restitution;
  // From impact n to the next a flight of 2 e^n t1: it leaves with e^n of the first impact's speed g t1.
  for (long double t = t1; t < until; t += 2.0L * t1 * power, power *= restitution)
    times.push_back(static_cast<double>(t));
  return times;
}

/// Judged by its impact times alone.
Problem impacts(std::string name, std::string title, World world, double until, std::vector<double> hits,
                bool driven) {
  return {std::move(name), std::move(title), "worst impact time [s]", std::move(world), until,
          std::move(hits), driven,           worst_impact_time};
}

// 44 impacts: with e = 0.9 they would pile up at t1 (1 + e) / (1 - e) = 8.58 s, and 8.5 s is just before
// that.
Problem bouncing_ball() {
  return impacts("bouncing_ball", "ball dropped from 1 m, restitution 0.9: 44 impacts in 8.5 s",
                 ball_over_floor(1.0, 0.5, 0.9), 8.5, bouncing_impacts(1.0, 0.9, 8.5), false);
}

/// Judged by its height at 5 s, after two impacts, in which an error of the impact's time shows as one of
/// place.
Problem dropped_disc() {
  const auto height_error = [](const Problem& p, const Outcome& o) {
    // Elastic: after an impact it leaves with the speed sqrt(2 g h) of a fall through h = 9.5 m.
    const long double g = kGravity, s = static_cast<long double>(p.until) - p.hits.back();
    const long double v = std::sqrt(2.0L * 9.5L * g);
    return static_cast<double>(std::abs(o.states[0].pose.position.y() - (0.5L + v * s - 0.5L * g * s * s)));
  };
  return {"dropped_disc",
          "disc dropped from 10 m, elastic, 5 s",
          "height at the end [m]",
          ball_over_floor(9.5, 0.5, 1.0),
          5.0,
          bouncing_impacts(9.5, 1.0, 5.0),
          false,
          height_error};
}

/// In long double, as the place known is [m].
double distance(const Vec2& at, long double x, long double y) {
  return static_cast<double>(std::hypot(at.x() - x, at.y() - y));
}

/// A coordinate that runs to and fro between -half and half.
struct Unfolded {
  // Reflections unfolded: a straight flight, folded back every width, from left to right and back.
  long double start, speed, half;
  // @pre start + half + speed t >= 0, as it is of a speed > 0: fmod() takes the sign of its first argument.
  long double at(long double t) const {
    const long double width = 2.0L * half, u = std::fmod(start + half + speed * t, 2.0L * width);
    return (u < width ? u : 2.0L * width - u) - half;
  }
  void add_hits(double until, std::vector<double>& times) const {
    // The first wall is the right one, as the speed is > 0; each way across takes 2 half / speed.
    for (long double t = (half - start) / speed; t < until; t += 2.0L * half / speed)
      times.push_back(static_cast<double>(t));
  }
};

Problem rectangle() {
  const double radius = 0.25, until = 50.0;
  // The frame reaches 2 m and 1.5 m to either side of the origin.
  const Vec2 half(2.0, 1.5), p(0.3, 0.2), v(1.0, 0.83);
  // Without friction x and y do not depend on each other: two unfolded flights.
  Problem problem;
  problem.name = "rectangle";
  problem.title = "disc in a rectangle without gravity, 50 s";
  problem.error_of = "place at the end [m]";
  problem.until = until;
  add_body(problem.world, make_disc(radius), p, v);
  // Around once counter-clockwise, each wall to the next corner.
  const Vec2 corners[] = {-half, {half.x(), -half.y()}, half, {-half.x(), half.y()}};
  for (int k = 0; k < 4; ++k) add_wall(problem.world, corners[k], corners[(k + 1) % 4]);
  // The centre runs between walls moved inward by the radius.
  const Unfolded x{p.x(), v.x(), half.x() - radius}, y{p.y(), v.y(), half.y() - radius};
  x.add_hits(until, problem.hits);
  y.add_hits(until, problem.hits);
  std::sort(problem.hits.begin(), problem.hits.end());
  problem.error = [x, y](const Problem& q, const Outcome& o) {
    const Vec2& at = o.states[0].pose.position;
    return distance(at, x.at(q.until), y.at(q.until));
  };
  return problem;
}

/// Equal discs with gaps: each collision hands the whole velocity on.
Problem cradle() {
  const int discs = 5;
  const double gap = 0.0625, speed = 1.7, until = 1.0;
  // Short binary fractions, so that places are exact; the first disc stands 1/4 m further off.
  const auto place = [gap](int k) { return k * (1.0 + gap) - (k == 0 ? 0.25 : 0.0); };
  Problem problem;
  problem.name = "cradle";
  problem.title = "five equal discs in a row with gaps, the first at 1.7 m/s";
  problem.error_of = "worst place at the end [m]";
  problem.until = until;
  for (int k = 0; k < discs; ++k)
    add_body(problem.world, make_disc(0.5), {place(k), 0.0}, {k == 0 ? speed : 0.0, 0.0});
  // At the k-th contact whoever moved has come 1/4 m and k gaps in all.
  for (int k = 1; k < discs; ++k)
    problem.hits.push_back(static_cast<double>((0.25L + k * static_cast<long double>(gap)) / speed));
  problem.error = [=](const Problem& p, const Outcome& o) {
    double worst = 0.0;
    for (int k = 0; k < discs; ++k) {
      const bool last = k == discs - 1;
      // Each disc goes on to where it touches the next one: a gap further, the first 1/4 m more.
      const double stop = place(k) + (k == 0 ? 0.25 + gap : gap);
      const double end = last ? place(k) + speed * (p.until - p.hits.back()) : stop;
      worst = std::max(worst, (o.states[k].pose.position - Vec2(end, 0.0)).norm());
    }
    return worst;
  };
  return problem;
}

/// A reference's ball before its forces.
World world_of(const auto& ball, double radius) {
  return ball_over_floor(static_cast<double>(ball.height), radius, static_cast<double>(ball.restitution));
}

/// Damper, spring and a force in time at once: no motion that Brink has in closed form, so its integrators
/// work.
Problem shaken_spring() {
  const SpringBall b;
  const double radius = 0.25;
  World world = world_of(b, radius);
  SpringForce spring;  // hangs from 3 m; every length a short binary fraction
  spring.at_b = {0.0, 3.0};
  spring.stiffness = static_cast<double>(b.stiffness);
  spring.damping = static_cast<double>(b.damping);
  // Rest in the reference is a gap of the lowest point; the spring holds the centre, a radius higher.
  spring.rest_length = 3.0 - radius - static_cast<double>(b.rest);
  FormulaForce shaking;
  shaking.bodies = {0};
  // F cos(w t) with the reference's numbers.
  shaking.fy = Formula("4*cos(7*t)", force_formula_variables());
  world.forces = {spring, shaking};
  return impacts("shaken_spring", "ball pressed to a floor by a damped spring and shaken, 5 s", world, 5.0,
                 impact_times(b, 5.0), true);
}

/// Quadratic drag, in which up and down are different motions.
Problem ball_in_air() {
  const BallInAir b;
  World world = world_of(b, 0.25);
  DragForce drag;
  drag.bodies = {0};
  drag.quadratic = static_cast<double>(b.drag);
  world.forces = {drag};
  return impacts("ball_in_air", "ball bouncing in air with quadratic drag, 6 s", world, 6.0,
                 impact_times(b, 6.0), true);
}

/// Different boxes off each other's middle, both turning, so that every term of the impulse takes part.
Problem two_boxes() {
  World world;
  add_body(world, make_box(1.0, 0.5), {-2.0, 0.125}, {1.5, 0.0}, 0.3, 1.5);
  add_body(world, make_box(0.75, 0.75), {2.0, -0.125}, {-1.0, 0.0625}, 1.1, -0.75);
  // No closed form: the meeting is found in extended precision (boxes.h).
  // The boxes' own masses and moments, as the world has them.
  const BoxCollision collision =
      meet(SpinningBox(world.bodies[0], 1.0, 0.5), SpinningBox(world.bodies[1], 0.75, 0.75), 4.0);
  const auto place_error = [collision](const Problem&, const Outcome& o) {
    double worst = 0.0;
    for (int k = 0; k < 2; ++k) {
      const Vec2& at = o.states[k].pose.position;
      worst = std::max(worst, distance(at, collision.end[k].x, collision.end[k].y));
      worst = std::max(worst, static_cast<double>(std::abs(o.states[k].pose.angle - collision.end[k].angle)));
    }
    return worst;
  };
  return {"two_boxes",
          "two spinning boxes meet, elastic, 4 s",
          "worst place or angle at the end [m, rad]",
          world,
          4.0,
          {static_cast<double>(collision.time)},
          false,
          place_error};
}

}  // namespace

std::vector<Problem> problems() {
  return {bouncing_ball(), dropped_disc(), rectangle(), cradle(),
          shaken_spring(), ball_in_air(),  two_boxes()};
}

}  // namespace brink::bench
