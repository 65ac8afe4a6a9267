#pragma once
// Islands with known answers, shared by the tests and the benchmark of the cone QP.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "brink/core/contacts/cone_qp.h"

namespace brink::testing {

constexpr double kGravity = 9.81;

/// Bodies under gravity, built one by one.
struct RestIsland {
  RestProblem problem;
  std::vector<Vec2> centres;

  int add(const Vec2& centre, double mass, double inertia) {
    problem.mass.emplace_back(mass, mass, inertia);
    problem.force.emplace_back(0.0, -mass * kGravity, 0.0);
    centres.push_back(centre);
    return static_cast<int>(centres.size()) - 1;
  }
  int add_box(const Vec2& centre, double width = 1.0, double height = 1.0, double mass = 1.0) {
    return add(centre, mass, mass * (width * width + height * height) / 12.0);
  }
  int add_disc(const Vec2& centre, double radius, double mass = 1.0) {
    return add(centre, mass, mass * radius * radius / 2.0);
  }
  /// At a point of the world; the normal points into `body`.
  LastingContact& touch(int body, int other, const Vec2& normal, const Vec2& point, double friction) {
    const Vec2 other_arm = other < 0 ? Vec2(Vec2::Zero()) : Vec2(point - centres[other]);
    problem.contacts.push_back(contact_at(body, other, normal, point - centres[body], other_arm));
    problem.contacts.back().friction = friction;
    return problem.contacts.back();
  }
};

/// Boxes of side 1 on one another, each `lean` to the right of the one below; the top one weighs `top`.
inline RestIsland stack(int n, double lean = 0.0, double top = 1.0) {
  RestIsland island;
  for (int k = 0; k < n; ++k) {
    const double x = k * lean, below = std::max(0, k - 1) * lean;
    const int box = island.add_box({x, k + 0.5}, 1.0, 1.0, k == n - 1 ? top : 1.0);
    for (const double at : {std::max(x, below) - 0.5, std::min(x, below) + 0.5})
      island.touch(box, box - 1, {0.0, 1.0}, {at, k}, 0.5);
  }
  return island;
}

/// Rows of boxes of side 1, `base` of them below, each box on two.
inline RestIsland pyramid(int base, double friction = 0.6) {
  RestIsland island;
  int below = 0;
  for (int row = 0; row < base; ++row) {
    const int first = static_cast<int>(island.centres.size());
    for (int k = 0; k < base - row; ++k) {
      const double x = 1.05 * (k - 0.5 * (base - row - 1));
      const int box = island.add_box({x, row + 0.5});
      const auto rest_on = [&](int other, double low, double high) {
        for (const double at : {low, high}) island.touch(box, other, {0.0, 1.0}, {at, row}, friction);
      };
      if (row == 0) rest_on(-1, x - 0.5, x + 0.5);
      if (row > 0) rest_on(below + k, x - 0.5, island.centres[below + k].x() + 0.5);
      if (row > 0) rest_on(below + k + 1, island.centres[below + k + 1].x() - 0.5, x + 0.5);
    }
    below = first;
  }
  return island;
}

/// Half a ring of mean radius 1 and `thickness`, of n stones, on the ground at both ends.
inline RestIsland arch(int n, double thickness, double friction) {
  RestIsland island;
  const double inner = 1.0 - thickness / 2, outer = 1.0 + thickness / 2, half = std::numbers::pi / (2 * n);
  const double mass = half * (outer * outer - inner * inner);
  const double middle = 2.0 / 3.0 * (std::pow(outer, 3) - std::pow(inner, 3)) /
                        (outer * outer - inner * inner) * std::sin(half) / half;
  const auto along = [](double angle) { return Vec2(std::cos(angle), std::sin(angle)); };
  for (int k = 0; k < n; ++k) {
    const int stone = island.add(middle * along((2 * k + 1) * half), mass,
                                 mass * (thickness * thickness + 4 * half * half) / 12);
    for (const double r : {inner, outer})
      island.touch(stone, stone - 1, perp(along(2 * k * half)), r * along(2 * k * half), friction);
  }
  for (const double r : {inner, outer}) island.touch(n - 1, -1, {0.0, 1.0}, Vec2(-r, 0.0), friction);
  return island;
}

/// A step of discs of radius 1/4 in a box, `columns` wide and `rows` high, in hexagonal order, `apart` of a
/// radius from touching; friction bounds as of the weight above.
inline StepProblem heap_step(int columns, int rows, double apart, double friction, double duration) {
  constexpr double r = 0.25, mass = std::numbers::pi * r * r;
  const double pitch = 2 * r + apart * r, height = pitch * std::sqrt(3.0) / 2, reach = 1.3 * pitch;
  StepProblem problem;
  problem.duration = duration;
  std::vector<Vec2> centres;
  const auto touch = [&](int body, int other, const Vec2& normal, double gap) {
    StepContact s;
    s.contact = contact_at(body, other, normal, -r * normal, r * normal);
    s.gap = std::max(0.0, gap);
    s.friction_bound = friction * mass * kGravity * duration * (rows - centres[body].y() / height);
    problem.contacts.push_back(s);
  };
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < columns - row % 2; ++k) {
      const int body = static_cast<int>(centres.size());
      centres.emplace_back(r + pitch * (k + row % 2 / 2.0), r + height * row);
      problem.mass.emplace_back(mass, mass, mass * r * r / 2);
      problem.velocity.emplace_back(0.0, 0.0, 0.0);
      problem.force.emplace_back(0.0, -mass * kGravity, 0.0);
      for (int other = std::max(0, body - 2 * columns); other < body; ++other)
        if (const Vec2 d = centres[body] - centres[other]; d.norm() < reach)
          touch(body, other, d.normalized(), d.norm() - 2 * r);
      if (row == 0) touch(body, -1, {0.0, 1.0}, 0.0);
      if (k == 0 && row % 2 == 0) touch(body, -1, {1.0, 0.0}, 0.0);
      if (k == columns - 1) touch(body, -1, {-1.0, 0.0}, apart * r);
    }
  return problem;
}

}  // namespace brink::testing
