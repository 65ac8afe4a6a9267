// Two free discs: the quick response is the general one.
#include "brink/scheduler/resolve/disc_rebound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/base/random.h"
#include "brink/core/contacts/impulse.h"
#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/resolve/extended_contact.h"

namespace brink {
namespace {

struct Disc {
  Outline outline;
  double mass, inertia;
  Motion motion;
};

ImpulseSide side_of(const Disc& d, const ExtendedState& s, const RealVec& point) {
  return {s.twist, point - s.position, 1.0 / d.mass, 1.0 / d.mass, 1.0 / d.inertia};
}

/// Two discs that touch at `time`, to a rounding or so, and approach; both fall and turn.
class Meeting {
 public:
  explicit Meeting(std::uint64_t seed) : random_(seed) {
    restitution = random_.uniform();
    time = 1.0 + 9.0 * random_.uniform();
    const double angle = 6.283185307179586 * random_.uniform();
    const Vec2 normal(std::cos(angle), std::sin(angle));
    a = disc();
    b = disc();
    const double reach = a.outline.bounding_radius + b.outline.bounding_radius;
    const Vec2 place = vector(5.0);
    const Vec2 approach = -(0.5 + random_.uniform()) * normal + 0.3 * vector(1.0);
    const Vec2 drift = vector(2.0);
    start(a, place + reach * normal, drift + 0.5 * approach);
    start(b, place - shift, drift - 0.5 * approach);
  }
  Disc a, b;
  Vec2 shift{3.0, -2.0};
  double time = 0.0, restitution = 1.0;

 private:
  Vec2 vector(double size) {
    return {size * (2.0 * random_.uniform() - 1.0), size * (2.0 * random_.uniform() - 1.0)};
  }
  Disc disc() {
    const double radius = 0.2 + random_.uniform();
    return {outline_of(make_disc(radius)), 0.5 + random_.uniform(), 0.1 + random_.uniform(), {}};
  }
  void start(Disc& d, const Vec2& place, const Vec2& velocity) {
    const double since = random_.uniform();
    const Vec2 gravity(0.0, -9.8);
    BodyState s;
    s.twist.velocity = velocity - since * gravity;
    s.pose.position = place - since * (s.twist.velocity + 0.5 * since * gravity);
    s.pose.angle = random_.uniform();
    s.twist.omega = 4.0 * random_.uniform() - 2.0;
    BodyState low;
    low.pose.position = 1e-17 * vector(1.0);
    low.twist.velocity = 1e-17 * vector(1.0);
    d.motion =
        Motion::ballistic(time - since, s, {gravity, 0.0}, std::numeric_limits<double>::infinity(), low);
  }
  static Outline outline_of(const Shape& shape) { return shape.outline; }
  Random random_;
};

void expect_same(const ExtendedState& general, const DiscRebound::Start& quick, const Vec2& shift) {
  const ExtendedState mine(quick.state, quick.low);
  const double few = 1e-17;  // of values up to 10; a double's own rounding is 1e-15
  EXPECT_LE(static_cast<double>((general.position - shift.cast<Real>() - mine.position).norm()), few);
  EXPECT_LE(static_cast<double>((general.twist.velocity - mine.twist.velocity).norm()), few);
  EXPECT_LE(static_cast<double>(std::abs(general.angle - mine.angle)), few);
  EXPECT_LE(static_cast<double>(std::abs(general.twist.omega - mine.twist.omega)), few);
}

TEST(DiscRebound, IsTheGeneralResponseToRoundingsOfExtendedPrecision) {
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(seed);
    const Meeting m(seed);
    const double latest = 4.0 * ulp(m.time);
    const auto quick = rebound({&m.a.motion, m.a.outline.bounding_radius, 1.0 / m.a.mass},
                               {&m.b.motion, m.b.outline.bounding_radius, 1.0 / m.b.mass}, m.shift, m.time,
                               latest, 0.0, m.restitution);
    ASSERT_TRUE(quick);

    ExtendedState a = m.a.motion.extended_state(m.time),
                  b = m.b.motion.extended_state(m.time).shifted(m.shift);
    FeatureContact like;
    like.sample = like.site = 0;
    const Vec2 offset = (a.position - b.position).cast<double>();
    like.normal = offset.normalized();
    like.gap = offset.norm() - m.a.outline.bounding_radius - m.b.outline.bounding_radius;
    ExtendedContact c = contact_in(m.a.outline, m.b.outline, a, b, like);
    const Real delay = std::clamp(c.gap / c.closing, Real(-latest), Real(latest));
    c = contact_in(m.a.outline, m.b.outline, a.moved(delay), b.moved(delay), like);
    Material material;
    material.restitution = m.restitution;
    material.friction = 0.0;
    const ImpulseResult general = resolve_impulse(side_of(m.a, a.moved(delay), c.point),
                                                  side_of(m.b, b.moved(delay), c.point), c.normal, material);

    EXPECT_NEAR(quick->impulse, general.normal, 4e-16 * general.normal);
    EXPECT_LE(static_cast<double>(std::abs(quick->delay - delay)), 1e-17);
    a.position += delay * (a.twist.velocity - general.body.velocity);
    b.position += delay * (b.twist.velocity - general.other.velocity);
    a.twist = general.body;
    b.twist = general.other;
    expect_same(a, quick->a, Vec2::Zero());
    expect_same(b, quick->b, m.shift);
  }
}

TEST(DiscRebound, SaysNothingOfDiscsThatPart) {
  Meeting m(7);
  BodyState away = m.a.motion.state(m.time);
  const BodyState other = m.b.motion.state(m.time);
  away.twist.velocity = other.twist.velocity + (away.pose.position - other.pose.position - m.shift);
  m.a.motion = Motion::ballistic(m.time, away, m.a.motion.acceleration());
  EXPECT_FALSE(rebound({&m.a.motion, m.a.outline.bounding_radius, 1.0},
                       {&m.b.motion, m.b.outline.bounding_radius, 1.0}, m.shift, m.time, 1e-15, 0.0, 1.0));
}

}  // namespace
}  // namespace brink
