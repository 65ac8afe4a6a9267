// Two free discs, or one and a wall: the quick response is the general one.
#include "brink/scheduler/resolve/disc_rebound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/base/random.h"
#include "brink/core/contacts/impulse.h"
#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/resolve/extended_contact.h"

namespace brink::disc_rebound_test {
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
class TwoDiscs {
 public:
  explicit TwoDiscs(std::uint64_t seed) : random_(seed) {
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
  EXPECT_LE(static_cast<double>(abs(general.angle - mine.angle)), few);
  EXPECT_LE(static_cast<double>(abs(general.twist.omega - mine.twist.omega)), few);
}

TEST(DiscRebound, IsTheGeneralResponseToRoundingsOfExtendedPrecision) {
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(seed);
    const TwoDiscs m(seed);
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
    EXPECT_LE(static_cast<double>(abs(quick->delay - delay)), 1e-17);
    a.position += delay * (a.twist.velocity - general.body.velocity);
    b.position += delay * (b.twist.velocity - general.other.velocity);
    a.twist = general.body;
    b.twist = general.other;
    expect_same(a, quick->a, Vec2::Zero());
    expect_same(b, quick->b, m.shift);
  }
}

/// To the bit.
void expect_alike(const BodyState& x, const BodyState& y) {
  EXPECT_EQ(x.pose.position, y.pose.position);
  EXPECT_EQ(x.pose.angle, y.pose.angle);
  EXPECT_EQ(x.twist.velocity, y.twist.velocity);
  EXPECT_EQ(x.twist.omega, y.twist.omega);
}

// What nobody can feel, an acceleration of 1e-300, keeps numbers from being taken for such as never leave their range.
TEST(DiscRebound, IsTheSameWhetherItsRangeIsLookedAtOrNot) {
  DiscRebound result;  // used again and again, after discs that turn, too
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(seed);
    const TwoDiscs m(seed);
    const auto straight = [&](const Disc& d, double pull) {
      BodyState s = d.motion.state(m.time), low = d.motion.start_low();
      const double since = 0.5;
      s.pose.position -= since * s.twist.velocity;
      low.pose.position = 1e-17 * s.pose.position;  // less than half a rounding
      low.twist.velocity = 1e-17 * s.twist.velocity;
      if (seed % 2) s.twist.omega = low.twist.omega = 0.0;
      if (seed % 3 == 0) s.twist.velocity.x() = low.twist.velocity.x() = 0.0;  // not plain either
      return Motion::ballistic(m.time - since, s, {{pull, pull}, 0.0},
                               std::numeric_limits<double>::infinity(), low);
    };
    const auto after = [&](double pull) {
      const Motion a = straight(m.a, pull), b = straight(m.b, pull);
      return rebound({&a, m.a.outline.bounding_radius, 1.0 / m.a.mass},
                     {&b, m.b.outline.bounding_radius, 1.0 / m.b.mass}, m.shift, m.time, 4.0 * ulp(m.time),
                     0.0, m.restitution, result);
    };
    const bool quick = after(0.0);
    const DiscRebound unlooked = result;
    ASSERT_EQ(after(1e-300), quick);
    if (!quick) continue;
    EXPECT_EQ(unlooked.impulse, result.impulse);
    EXPECT_EQ(unlooked.delay, result.delay);
    EXPECT_EQ(unlooked.gap, result.gap);
    EXPECT_EQ(unlooked.magnitude, result.magnitude);
    expect_alike(unlooked.a.state, result.a.state);
    expect_alike(unlooked.a.low, result.a.low);
    expect_alike(unlooked.b.state, result.b.state);
    expect_alike(unlooked.b.low, result.b.low);
  }
}

/// A disc that touches a wall at `time`, to a rounding or so, and comes down on it.
struct Landing {
  Outline disc, wall;
  Motion motion;
  ExtendedState stands;
  Vec2 normal;
  double time, restitution, mass = 2.0;

  explicit Landing(std::uint64_t seed) {
    Random random(seed);
    const auto upto = [&](double size) { return size * (2.0 * random.uniform() - 1.0); };
    restitution = random.uniform();
    time = 1.0 + 9.0 * random.uniform();
    const double radius = 0.2 + random.uniform(), thickness = seed % 2 == 0 ? 0.1 : 0.0;
    disc = make_disc(radius).outline;
    wall = make_segment({-3.0, upto(1.0)}, {4.0, upto(1.0)}, thickness).outline;
    stands.angle = seed % 3 == 0 ? 0.0 : upto(3.0);
    stands.position = Vec2(upto(5.0), upto(5.0)).cast<Real>();
    const Site& site = wall.sites.front();
    const Vec2 a = stands.to_world(site.a).cast<double>(), b = stands.to_world(site.b).cast<double>();
    normal = (seed % 5 == 0 ? -1.0 : 1.0) * perp((b - a).normalized());
    const double along = 0.2 + 0.6 * random.uniform();
    BodyState s;
    s.pose.position = a + along * (b - a) + (radius + site.radius) * normal;
    s.twist.velocity = -(0.5 + random.uniform()) * normal + 2.0 * upto(1.0) * perp(normal);
    s.pose.angle = upto(3.0);
    s.twist.omega = upto(2.0);
    const double since = random.uniform();
    const Vec2 gravity(0.3, -9.8);
    s.twist.velocity -= since * gravity;
    s.pose.position -= since * (s.twist.velocity + 0.5 * since * gravity);
    s.pose.angle -= since * s.twist.omega;
    motion = Motion::ballistic(time - since, s, {gravity, 0.0});
  }

  WallSide side() const {
    const Site& site = wall.sites.front();
    return {stands.to_world(site.a), stands.to_world(site.b), site.radius, normal};
  }
};

// The law at the moment of contact, with the velocity of that moment.
TEST(DiscRebound, OfAWallIsTheGeneralResponseToRoundingsOfExtendedPrecision) {
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(seed);
    const Landing m(seed);
    const double latest = 4.0 * ulp(m.time);
    const auto quick = rebound({&m.motion, m.disc.bounding_radius, 1.0 / m.mass}, m.side(), m.time, latest,
                               0.0, m.restitution);
    ASSERT_TRUE(quick);

    ExtendedState s = m.motion.extended_state(m.time);
    FeatureContact like;
    like.sample = like.site = 0;
    like.normal = m.normal;
    like.gap = static_cast<double>(contact_in(m.disc, m.wall, s, m.stands, like).gap);
    ExtendedContact c = contact_in(m.disc, m.wall, s, m.stands, like);
    const Real delay = std::clamp(c.gap / c.closing, Real(-latest), Real(latest));
    ExtendedState then = s.moved(delay);
    then.twist.velocity += delay * m.motion.acceleration().linear.cast<Real>();
    c = contact_in(m.disc, m.wall, then, m.stands, like);
    Material material;
    material.restitution = m.restitution;
    material.friction = 0.0;
    const ImpulseResult general =
        resolve_impulse({then.twist, c.point - then.position, 1.0 / m.mass, 1.0 / m.mass, 1.0},
                        {m.stands.twist, c.point - m.stands.position, 0.0, 0.0, 0.0}, c.normal, material);

    EXPECT_NEAR(quick->impulse, general.normal, 4e-16 * general.normal);
    EXPECT_LE(static_cast<double>(abs(quick->delay - delay)), 1e-17);
    const RealVec change = general.body.velocity - then.twist.velocity;
    s.position -= delay * change;
    s.twist.velocity += change;
    expect_same(s, quick->a, Vec2::Zero());
  }
}

// As of two discs; walls along an axis, too.
TEST(DiscRebound, OfAWallIsTheSameWhetherItsRangeIsLookedAtOrNot) {
  DiscRebound result;
  int rebounds = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(seed);
    const Landing m(seed);
    const WallSide along{{-3.0, 0.0}, {4.0, 0.0}, 0.0, {0.0, 1.0}},
        across{{0.0, 5.0}, {0.0, -5.0}, 0.1, {1.0, 0.0}};
    for (const WallSide& wall : {m.side(), along, across}) {
      const Vec2 out = wall.normal;
      const Vec2 begin(wall.begin.cast<double>()), end(wall.end.cast<double>());
      BodyState s = m.motion.state(m.time);
      if (seed % 2) s.twist.omega = 0.0;
      s.pose.position = begin + 0.4 * (end - begin) + (m.disc.bounding_radius + wall.radius) * out;
      s.twist.velocity = Vec2(1.3, -0.7) - (1.5 + s.twist.velocity.norm()) * out;
      const double since = 0.5;
      s.pose.position -= since * s.twist.velocity;
      BodyState low;
      low.pose.position = 1e-17 * s.pose.position;  // less than half a rounding
      low.twist.velocity = 1e-17 * s.twist.velocity;
      const auto after = [&](double pull) {
        const Motion motion = Motion::ballistic(m.time - since, s, {{pull, pull}, 0.0},
                                                std::numeric_limits<double>::infinity(), low);
        return rebound({&motion, m.disc.bounding_radius, 1.0 / m.mass}, wall, m.time, 4.0 * ulp(m.time), 0.0,
                       m.restitution, result);
      };
      const bool quick = after(0.0);
      const DiscRebound unlooked = result;
      ASSERT_EQ(after(1e-300), quick);
      if (!quick) continue;
      ++rebounds;
      EXPECT_EQ(unlooked.impulse, result.impulse);
      EXPECT_EQ(unlooked.delay, result.delay);
      EXPECT_EQ(unlooked.gap, result.gap);
      EXPECT_EQ(unlooked.magnitude, result.magnitude);
      expect_alike(unlooked.a.state, result.a.state);
      expect_alike(unlooked.a.low, result.a.low);
    }
  }
  EXPECT_GT(rebounds, 2500);
}

TEST(DiscRebound, SaysNothingOfWhatIsNotAbreastOfAWallOrParts) {
  const Landing m(3);
  const DiscSide disc{&m.motion, m.disc.bounding_radius, 1.0 / m.mass};
  const auto met = [&](const WallSide& wall) {
    return rebound(disc, wall, m.time, 1e-15, 0.0, 1.0).has_value();
  };
  WallSide wall = m.side();
  EXPECT_TRUE(met(wall));
  const RealVec way = wall.end - wall.begin;
  for (const double aside : {-2.0, 2.0})
    EXPECT_FALSE(met({wall.begin + aside * way, wall.end + aside * way, wall.radius, wall.normal}));
  wall.normal = -wall.normal;
  EXPECT_FALSE(met(wall)) << "from behind it goes away";
}

TEST(DiscRebound, SaysNothingOfDiscsThatPart) {
  TwoDiscs m(7);
  BodyState away = m.a.motion.state(m.time);
  const BodyState other = m.b.motion.state(m.time);
  away.twist.velocity = other.twist.velocity + (away.pose.position - other.pose.position - m.shift);
  m.a.motion = Motion::ballistic(m.time, away, m.a.motion.acceleration());
  EXPECT_FALSE(rebound({&m.a.motion, m.a.outline.bounding_radius, 1.0},
                       {&m.b.motion, m.b.outline.bounding_radius, 1.0}, m.shift, m.time, 1e-15, 0.0, 1.0));
}

}  // namespace
}  // namespace brink::disc_rebound_test
