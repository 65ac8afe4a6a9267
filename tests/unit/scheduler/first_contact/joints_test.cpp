// What comes dead on to a joint of two sites, or to a tip, meets it: times by the distance of that place alone.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/first_contact/first_contact.h"

namespace brink::joints_test {
namespace {

constexpr double kPi = std::numbers::pi;

Vec2 direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// A regular polygon whose first vertex is at (radius, 0): the more sides, the less it turns at each.
Outline polygon(int sides, double radius) {
  std::vector<Vec2> p;
  for (int k = 0; k < sides; ++k) p.push_back(radius * direction(2.0 * kPi * k / sides));
  return make_polygon(p).outline;
}

Outline disc_of_arcs(double radius) {
  return make_path("M -1 0 A 1 1 0 0 1 1 0 A 1 1 0 0 1 -1 0 Z", radius, 1e-3).outline;
}

Outline annulus(double radius) {
  return make_path(
             "M -1 0 A 1 1 0 0 1 1 0 A 1 1 0 0 1 -1 0 Z M -0.6 0 A 0.6 0.6 0 0 1 0.6 0 A 0.6 0.6 0 0 1 -0.6 "
             "0 Z",
             radius, 1e-3)
      .outline;
}

/// What comes: how far it reaches ahead of its origin.
struct Comer {
  const char* name;
  Outline outline;
  double reach;
};

std::vector<Comer> comers() {
  return {{"point", make_point(Vec2::Zero(), 0.0).outline, 0.0},
          {"disc", make_disc(0.125).outline, 0.125},
          {"tip", make_polygon({{-0.25, 0.0}, {0.25, -0.0625}, {0.25, 0.0625}}).outline, 0.25}};
}

/// The comer flies along `heading` [rad] at the place of `target` that is `away` [m] from the target's origin, on that side.
struct Case {
  const Outline *target, *comer;
  double away, reach, heading, speed, place;
  bool drifts, falls;
};

/// How far the time of the first contact is off [m of the way]; infinity: there is none.
double error(const Case& c, bool closed_forms, bool outwards) {
  const double from = outwards ? 0.0 : 2.0 * c.away + c.reach;
  const double expected = (outwards ? c.away - c.reach : from - c.away - c.reach) / c.speed;
  const Vec2 ahead = direction(c.heading), base(c.place, -c.place);
  const Vec2 drift = c.drifts ? Vec2(0.3 * c.speed * perp(ahead)) : Vec2::Zero();
  Acceleration pull;
  if (c.falls) pull.linear = {0.1 * c.speed * c.speed, -c.speed * c.speed};
  BodyState comer, target;
  comer.pose = {base - from * ahead, c.heading + kPi};
  comer.twist.velocity = drift + c.speed * ahead;
  target.pose.position = base;
  target.twist.velocity = drift;
  const Motion of_comer = Motion::ballistic(0.0, comer, pull),
               of_target = Motion::ballistic(0.0, target, pull);
  const auto comers = make_brute_force_index(std::make_shared<const Outline>(*c.comer)),
             targets = make_brute_force_index(std::make_shared<const Outline>(*c.target));
  SearchLimits limits;
  limits.closed_forms = closed_forms;
  SearchScratch scratch;
  WorkCounters work;
  const PairAnswer answer = first_contact({comers.get(), &of_comer, 0.0}, {targets.get(), &of_target, 0.0},
                                          0.0, 4.0 * expected, limits, scratch, work);
  if (answer.status != PairAnswer::Status::contact) return std::numeric_limits<double>::infinity();
  return std::abs(answer.contact.time - expected) * c.speed;
}

/// All comers at that place of the target from all sides given; `outwards`: from the origin, as of a container.
void expect_all_meet(const Outline& target, double away, const std::vector<double>& headings, bool outwards,
                     const std::string& name) {
  for (const Comer& comer : comers())
    for (const double heading : headings)
      for (const double speed : {1e-3, 1.0, 5.8e4})
        for (const double place : {0.0, 16.0, 1000.0})
          for (const bool moving : {false, true}) {
            const Case c{&target, &comer.outline, away, comer.reach, heading, speed, place, moving, moving};
            for (const bool closed : {false, true})
              // places are rounded, and so are sines: of the way
              EXPECT_LE(error(c, closed, outwards), 1e-9 * away + 4e-15 * place)
                  << comer.name << " at " << name << ", heading " << heading << ", speed " << speed
                  << ", place " << place << (moving ? ", moving" : "") << (closed ? ", closed form" : "");
          }
}

const std::vector<double> kQuarters{0.0, 0.5 * kPi, kPi, 1.5 * kPi};

TEST(Joints, WhereArcsGoOnIntoEachOther) {
  for (const double radius : {0.6076, 1.0, 0.60761638745712199, 2.0, 1.0 / 3.0}) {
    expect_all_meet(disc_of_arcs(radius), radius, kQuarters, false, "a disc of arcs");
    expect_all_meet(annulus(radius), radius, kQuarters, false, "an annulus");
  }
}

TEST(Joints, WhereSidesTurnByLittleOrMuch) {
  for (const int sides : {3, 4, 5, 12, 100, 1000, 10000})
    for (const double radius : {0.6076, 1.0, 3.0}) {
      std::vector<double> headings;
      // onto a few of the vertices
      for (const int k : {0, 1, sides / 3, sides - 1}) headings.push_back(2.0 * kPi * k / sides + kPi);
      expect_all_meet(polygon(sides, radius), radius, headings, false, std::to_string(sides) + " sides");
    }
}

TEST(Joints, OfWires) {
  for (const double radius : {0.6076, 1.0, 2.0}) {
    expect_all_meet(make_arc(Vec2::Zero(), radius, 0.0, 2.0 * kPi, 0.0).outline, radius, kQuarters, false,
                    "a ring of wire");
    expect_all_meet(
        make_chain({{radius, 0.0}, {0.0, radius}, {-radius, 0.0}, {0.0, -radius}}, true, 0.0).outline, radius,
        kQuarters, false, "a square of wire");
  }
}

TEST(Joints, FromInside) {
  for (const double radius : {0.6076, 1.0, 2.0}) {
    expect_all_meet(as_container(disc_of_arcs(radius)), radius, kQuarters, true,
                    "the inside of a disc of arcs");
    expect_all_meet(make_arc(Vec2::Zero(), radius, 0.0, 2.0 * kPi, 0.0).outline, radius, kQuarters, true,
                    "the inside of a ring of wire");
  }
}

}  // namespace
}  // namespace brink::joints_test
