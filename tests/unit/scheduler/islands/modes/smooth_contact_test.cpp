// Smooth contacts against geometry written down once more, differentiated numerically in extended precision.
#include "brink/scheduler/islands/modes/smooth_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "brink/core/shapes/shapes.h"
#include "tests/support/seeded_random.h"

namespace brink::smooth_contact_test {
namespace {

using Long = long double;
struct Point {
  Long x, y;
};
Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
Point operator*(Long s, Point a) { return {s * a.x, s * a.y}; }
Long dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }
Point turned(Point a, Long angle) {
  return {std::cos(angle) * a.x - std::sin(angle) * a.y, std::sin(angle) * a.x + std::cos(angle) * a.y};
}
Point point(const Vec2& v) { return {v.x(), v.y()}; }

/// A body on a parabola.
struct Path {
  BodyState start;
  Acceleration a;

  Point position(Long t) const {
    return point(start.pose.position) + t * point(start.twist.velocity) + (t * t / 2) * point(a.linear);
  }
  Long angle(Long t) const {
    return start.pose.angle + t * Long(start.twist.omega) + t * t / 2 * Long(a.angular);
  }
  Point at(Long t, Point local) const { return position(t) + turned(local, angle(t)); }
  Point velocity(Long t) const { return point(start.twist.velocity) + t * point(a.linear); }
  Long omega(Long t) const { return start.twist.omega + t * Long(a.angular); }
  /// Of the body's point that is at p [m/s].
  Point velocity_at(Long t, Point p) const {
    const Point r = p - position(t);
    return velocity(t) + omega(t) * Point{-r.y, r.x};
  }
  Vec3 acceleration() const { return {a.linear.x(), a.linear.y(), a.angular}; }
  Vec3 twist() const { return {start.twist.velocity.x(), start.twist.velocity.y(), start.twist.omega}; }
};

struct Case {
  SmoothContact contact;
  Path sample, site;

  Point normal(Long t) const {
    const bool line = contact.kind == SmoothContact::Kind::line;
    if (line) return turned(point(contact.normal), site.angle(t));
    const Point way = sample.at(t, point(contact.sample)) - site.at(t, point(contact.place));
    return (contact.hollow ? -1 : 1) / std::sqrt(dot(way, way)) * way;
  }
  Long gap(Long t) const {
    const Point way = sample.at(t, point(contact.sample)) - site.at(t, point(contact.place));
    const Long r = contact.sample_radius, radius = contact.radius;
    if (contact.kind == SmoothContact::Kind::line) return dot(normal(t), way) - r - radius;
    const Long distance = std::sqrt(dot(way, way));
    return contact.hollow ? radius - r - distance : distance - radius - r;
  }
  Long distance() const {
    const Point way = sample.at(0, point(contact.sample)) - site.at(0, point(contact.place));
    return std::sqrt(dot(way, way));
  }
  Long slip(Long t) const {
    const Point n = normal(t), p = sample.at(t, point(contact.sample)) - Long(contact.sample_radius) * n;
    return dot({-n.y, n.x}, sample.velocity_at(t, p) - site.velocity_at(t, p));
  }
};

Long first_derivative(const std::function<Long(Long)>& f) {
  const Long h = 1e-3L;
  return (8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h);
}
Long second_derivative(const std::function<Long(Long)>& f) {
  const Long h = 1e-3L;
  return (16 * (f(h) + f(-h)) - (f(2 * h) + f(-2 * h)) - 30 * f(0)) / (12 * h * h);
}

Path random_path(SeededRandom& random, double far) {
  Path p;
  p.start.pose = {{far * random.uniform(-1, 1), far * random.uniform(-1, 1)}, random.uniform(-3, 3)};
  p.start.twist = {{random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(-1, 1)};
  p.a = {{random.uniform(-2, 2), random.uniform(-2, 2)}, random.uniform(-2, 2)};
  return p;
}

Case random_case(SeededRandom& random, SmoothContact::Kind kind, bool hollow) {
  Case c;
  c.contact.kind = kind;
  c.contact.hollow = hollow;
  c.contact.sample = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)};
  c.contact.sample_radius = random.uniform(0, 0.3);
  c.contact.place = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)};
  const double angle = random.uniform(-3, 3);
  c.contact.normal = {std::cos(angle), std::sin(angle)};
  c.contact.radius = random.uniform(0.5, 2);
  c.sample = random_path(random, 3.0);
  c.site = random_path(random, 0.2);
  return c;
}

class SmoothContactDerivatives : public ::testing::TestWithParam<std::pair<SmoothContact::Kind, bool>> {};

TEST_P(SmoothContactDerivatives, AgreeWithDifferencesOfTheGeometry) {
  SeededRandom random(7);
  for (int n = 0; n < 200; ++n) {
    SCOPED_TRACE("case " + std::to_string(n));
    const Case c = random_case(random, GetParam().first, GetParam().second);
    if (c.distance() < 0.3L) continue;  // where it has no direction
    const ContactRates r = rates_of(c.contact, c.sample.start, c.site.start);
    EXPECT_NEAR(r.gap, static_cast<double>(c.gap(0)), 1e-14);
    EXPECT_NEAR(r.normal.x(), static_cast<double>(c.normal(0).x), 1e-14);
    const auto gap = [&](Long t) { return c.gap(t); };
    const auto slip = [&](Long t) { return c.slip(t); };
    EXPECT_NEAR(r.normal_velocity, static_cast<double>(first_derivative(gap)), 1e-7);
    EXPECT_NEAR(r.tangential_velocity, static_cast<double>(c.slip(0)), 1e-13);
    const double vn = r.normal_on_sample.dot(c.sample.twist()) + r.normal_on_site.dot(c.site.twist());
    const double vt = r.tangent_on_sample.dot(c.sample.twist()) + r.tangent_on_site.dot(c.site.twist());
    EXPECT_NEAR(vn, r.normal_velocity, 1e-13);
    EXPECT_NEAR(vt, r.tangential_velocity, 1e-13);
    const double an = r.normal_on_sample.dot(c.sample.acceleration()) +
                      r.normal_on_site.dot(c.site.acceleration()) + r.normal_bend;
    const double at = r.tangent_on_sample.dot(c.sample.acceleration()) +
                      r.tangent_on_site.dot(c.site.acceleration()) + r.tangential_bend;
    EXPECT_NEAR(an, static_cast<double>(second_derivative(gap)), 1e-6);
    EXPECT_NEAR(at, static_cast<double>(first_derivative(slip)), 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, SmoothContactDerivatives,
                         ::testing::Values(std::pair(SmoothContact::Kind::line, false),
                                           std::pair(SmoothContact::Kind::circle, false),
                                           std::pair(SmoothContact::Kind::circle, true)));

// ---- from features of outlines

SmoothContact made_of(const Outline& a, const Pose& at_a, const Outline& b, const Pose& at_b,
                      std::size_t which = 0) {
  const ExtendedState sa(BodyState{at_a, {}}), sb(BodyState{at_b, {}});
  const auto found = near_features(a, sa, b, sb, 0.1);
  return smooth_contacts(found.at(which), a, sa, b, sb).at(0);
}

TEST(SmoothContactOfAFeature, DiscOnAFloorIsItsCentreAgainstALine) {
  const SmoothContact c =
      made_of(make_disc(0.5).outline, {{0.3, 0.51}, 2.0}, make_segment({-5, 0}, {5, 0}).outline, {});
  EXPECT_EQ(c.kind, SmoothContact::Kind::line);
  const ContactRates r = rates_of(c, {{{0.3, 0.51}, 2.0}, {{1, -2}, 3}}, {});
  EXPECT_NEAR(r.gap, 0.01, 1e-15);
  EXPECT_NEAR(r.normal.y(), 1.0, 1e-15);
  EXPECT_NEAR(r.normal_velocity, -2.0, 1e-15);
  EXPECT_NEAR(r.tangential_velocity, -(1.0 + 3.0 * 0.5), 1e-15);  // the tangent points to the left
  EXPECT_NEAR(r.within, 4.7, 1e-15);                              // to the floor's right end
}

TEST(SmoothContactOfAFeature, DiscInABowlIsInsideACircle) {
  const Pose at{{1.49 * std::cos(4.0), 1.49 * std::sin(4.0)}, 0};
  const SmoothContact c = made_of(make_disc(0.5).outline, at, make_disc_container(2.0).outline, {});
  EXPECT_TRUE(c.hollow);
  EXPECT_EQ(c.radius, 2.0);
  const ContactRates r = rates_of(c, {at, {}}, {});
  EXPECT_NEAR(r.gap, 0.01, 1e-14);
  EXPECT_GT(r.within, 0.0);
}

TEST(SmoothContactOfAFeature, DiscOnATurnedBoxIsAgainstTheFaceOfTheBody) {
  const double angle = 0.4, h = 0.5 + 0.25 + 1e-3;
  const Pose disc{{-h * std::sin(angle), h * std::cos(angle)}, 0}, box{{0, 0}, angle};
  const Outline d = make_disc(0.25).outline, b = make_box(2, 1).outline;
  const SmoothContact c = made_of(d, disc, b, box);
  const ContactRates r = rates_of(c, {disc, {}}, {box, {}});
  EXPECT_NEAR(r.gap, 1e-3, 1e-15);
  EXPECT_NEAR(r.normal.x(), -std::sin(angle), 1e-15);
}

TEST(SmoothContactOfAFeature, DiscBeyondTheEndOfAWireIsAgainstAPoint) {
  const Pose disc{{5.2, 0.46}, 0};
  const SmoothContact c = made_of(make_disc(0.5).outline, disc, make_segment({-5, 0}, {5, 0}).outline, {});
  EXPECT_EQ(c.kind, SmoothContact::Kind::circle);
  const ContactRates r = rates_of(c, {disc, {}}, {});
  EXPECT_NEAR(r.gap, std::hypot(0.2, 0.46) - 0.5, 1e-15);
  EXPECT_NEAR(r.within, 0.2, 1e-15);  // it rolls back onto the wire when that is 0
}

}  // namespace
}  // namespace brink::smooth_contact_test
