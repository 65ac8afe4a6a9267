// Bounds of flights, and bodies by place, against brute force.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "brink/core/base/random.h"
#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/broad_phase/flight.h"
#include "brink/scheduler/broad_phase/flight_batch.h"
#include "brink/scheduler/broad_phase/neighbourhood.h"
#include "tests/support/seeded_random.h"

namespace brink::neighbourhood_test {
namespace {

Flight random_flight(Random& random) {
  Flight f;
  f.x = random.uniform(-5, 5);
  f.y = random.uniform(-5, 5);
  f.vx = random.uniform(-2, 2);
  f.vy = random.uniform(-2, 2);
  f.start = random.uniform(-3, 0);
  f.radius = random.uniform(0.1, 1.0);
  f.free = 1;
  return f;
}

/// Gap of the two bounding discs at t, b moved by `shift`.
double gap_at(const Flight& a, const Flight& b, const Vec2& shift, const Vec2& gravity, double t) {
  const auto place = [&](const Flight& f) {
    const double s = t - f.start;
    return Vec2(Vec2(f.x, f.y) + s * (Vec2(f.vx, f.vy) + 0.5 * s * gravity));
  };
  return (place(a) - place(b) - shift).norm() - a.radius - b.radius;
}

TEST(Flight, MeetingHoldsEveryOverlapOfTheBoundingDiscs) {
  SeededRandom random(13);
  int met = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Flight a = random_flight(random), b = random_flight(random);
    const Vec2 gravity(trial % 2 ? 0.0 : 0.5, trial % 3 ? 0.0 : -9.8);
    const Vec2 shift = trial % 5 ? Vec2(0, 0) : Vec2(3, -4);
    const MeetingTimes m = meeting(Course(a, gravity, 0.0), b, shift, 0.0);
    met += std::isfinite(m.begin);
    for (double t = 0.0; t < 10.0; t += 0.05)
      if (t < m.begin || t > m.end) {
        ASSERT_GT(gap_at(a, b, shift, gravity, t), -1e-7) << "trial " << trial << " t " << t;
      }
    if (std::isfinite(m.begin) && m.begin > 0.0) {
      ASSERT_NEAR(gap_at(a, b, shift, gravity, m.begin), 0.0, 1e-6)
          << "trial " << trial;  // and not too early
    }
  }
  EXPECT_GT(met, 500);
}

// However many the processor compares at once: bare discs and others, resting, touching, and not free.
TEST(FlightBatch, TellsTheBitsOfMeetingsOneByOne) {
  SeededRandom random(16);
  FlightBatch batch;
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<Flight> flights;
    const int count = static_cast<int>(random.below(FlightBatch::kMost));
    for (int j = 0; j < count + 1; ++j) {
      flights.push_back(random_flight(random));
      Flight& f = flights.back();
      f.disc = random.below(2);
      if (random.below(5) == 0) f.vx = f.vy = 0.0;
      if (random.below(9) == 0) f.x += 1e6;
      if (random.below(9) == 0) {
        f.free = 0;
        f.x = std::numeric_limits<double>::quiet_NaN();
      }
      batch.bodies()[j] = j;
    }
    const double now = random.uniform(0, 3);
    const Course course(random_flight(random), Vec2(0.0, trial % 3 ? 0.0 : -9.8), now);
    const unsigned met = batch.meet(count, flights.data(), course, now, now + 1.0);
    unsigned expected = 0;
    for (int i = 0; i < count; ++i) expected |= (batch.begin(i) < now + 1.0 ? 1U : 0U) << i;
    ASSERT_EQ(met, expected);
    for (int i = 0; i < count; ++i) {
      const Flight& f = flights[i];
      ASSERT_EQ(batch.body(i), i);
      ASSERT_EQ(batch.begin(i), f.free ? meeting(course, f, Vec2::Zero(), now).begin : now)
          << "trial " << trial;
    }
  }
}

TEST(Flight, StaysInABoxUntilTheTimeItIsTold) {
  SeededRandom random(14);
  for (int trial = 0; trial < 5000; ++trial) {
    const Flight f = random_flight(random);
    const Vec2 gravity(trial % 2 ? 0.0 : 0.5, trial % 3 ? 0.0 : -9.8);
    const Course course(f, gravity, 0.0);
    const Box box{course.place - Vec2(random.uniform(0.01, 2), random.uniform(0.01, 2)),
                  course.place + Vec2(random.uniform(0.01, 2), random.uniform(0.01, 2))};
    const double stay = stay_in(box, course);
    for (int i = 0; i < 50; ++i) ASSERT_TRUE(box.grown(1e-12).contains(course.after(stay * i / 50.0)));
    ASSERT_FALSE(box.contains(course.after(stay + 1e-9)));
  }
}

/// Bodies at random places, small and large, near each other or wherever cells put them.
struct Crowd {
  std::vector<Flight> flights;
  std::vector<BodyClock> clocks;
  std::vector<Vec2> places;

  Crowd(Random& random, std::size_t count, double size) : flights(count), clocks(count) {
    for (std::size_t k = 0; k < count; ++k) {
      flights[k].radius = k % 7 ? random.uniform(0.2, 0.5) : random.uniform(0.5, 2.0);
      places.emplace_back(random.uniform(0, size), random.uniform(0, size));
    }
  }
};

/// Every two bodies whose bounding discs overlap must see each other, in the image in which they do.
void expect_near(const Crowd& crowd, const Neighbourhood& near, const Periods& periods) {
  const int count = static_cast<int>(crowd.places.size());
  for (int k = 0; k < count; ++k) {
    std::set<std::tuple<int, int, int>> seen;
    near.near(k, [&](int j, const Image& image) {
      EXPECT_NE(j, k);
      EXPECT_TRUE(seen.emplace(j, image.right, image.up).second) << "twice";
    });
    for (int j = 0; j < count; ++j) {
      if (j == k) continue;
      const double reach = crowd.flights[k].radius + crowd.flights[j].radius;
      Image image;
      const Vec2 apart = crowd.places[k] - crowd.places[j];
      if (periods.any())
        image = {static_cast<int>(std::lround(apart.x() / periods.size.x())),
                 static_cast<int>(std::lround(apart.y() / periods.size.y()))};
      if ((apart - periods.shift(image)).norm() >= reach) continue;
      ASSERT_TRUE(seen.count({j, image.right, image.up})) << k << " does not see " << j;
    }
  }
}

TEST(Neighbourhood, BodiesThatOverlapSeeEachOtherWhereverTheyGo) {
  SeededRandom random(15);
  for (const bool periodic : {false, true})
    for (int trial = 0; trial < 10; ++trial) {
      Periods periods;
      if (periodic) periods.size = {12.0, 15.0};
      Crowd crowd(random, 60, 12.0);
      Neighbourhood near(crowd.flights, crowd.clocks, crowd.places, {}, periods, true);
      for (int step = 0; step < 20; ++step) {
        expect_near(crowd, near, periods);
        for (std::size_t k = 0; k < crowd.places.size(); ++k) {
          crowd.places[k] += Vec2(random.uniform(-2, 2), random.uniform(-2, 2));
          near.put_into_cell(static_cast<int>(k), crowd.places[k]);
          ASSERT_TRUE(near.box_of(static_cast<int>(k)).contains(crowd.places[k]));
        }
      }
    }
}

TEST(Neighbourhood, BodiesAroundAreThoseNear) {
  SeededRandom random(17);
  int asked = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Crowd crowd(random, 20 + random.below(200), random.uniform(8.0, 60.0));
    for (Flight& f : crowd.flights) f.radius = 0.4;  // one level
    Neighbourhood near(crowd.flights, crowd.clocks, crowd.places, {}, {}, true);
    for (int step = 0; step < 10; ++step)
      for (int k = 0; k < static_cast<int>(crowd.places.size()); ++k) {
        int around[CellGrid::kMostAround + 4];
        if (const int count = near.around(k, around); count >= 0) {
          ++asked;
          std::set<int> expected{k};
          near.near(k, [&](int j, const Image&) { expected.insert(j); });
          ASSERT_EQ(std::set<int>(around, around + count), expected);
          ASSERT_EQ(static_cast<int>(expected.size()), count) << "twice";
        }
        crowd.places[k] += Vec2(random.uniform(-2, 2), random.uniform(-2, 2));
        const Cell former = crowd.flights[k].cell;
        near.put_into_cell(k, crowd.places[k]);
        if (const int count = near.around(k, around, &former); count >= 0) {
          std::set<int> came_near;
          near.near(
              k, [&](int j, const Image&) { came_near.insert(j); }, &former);
          std::set<int> seen(around, around + count);
          seen.erase(k);
          ASSERT_EQ(seen, came_near);
        }
      }
  }
  EXPECT_GT(asked, 5000);
}

}  // namespace
}  // namespace brink::neighbourhood_test
