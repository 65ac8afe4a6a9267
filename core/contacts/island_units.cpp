/// Units of mass m, length l and speed v. A translation is measured in v and a turn in v / l, so that forces
/// go by m v, torques by m l v, masses by m and inertias by m l^2; kinetic energy is m v^2 in each. Rows,
/// which give speeds, keep their linear part and have their angular one divided by l.
#include "brink/core/contacts/island_units.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

/// The largest power of two that is not above x; 1 for what is not positive.
double power_of_two(double x) { return x > 0.0 ? std::exp2(std::ilogb(x)) : 1.0; }

/// Per coordinate, 1 and 1 and the angle's.
Vec3 by_length(double angle) { return {1.0, 1.0, angle}; }

}  // namespace

IslandUnits::IslandUnits(const std::vector<Vec3>& masses) : masses_(masses) {
  double mass = 0.0, length = 0.0;
  for (int k = 0; k < static_cast<int>(masses.size()); ++k) {
    // A radius of gyration is of a body that can turn and move; what is held has no part in the units.
    double heaviest = 0.0;
    for (int c = 0; c < 2; ++c)
      if (!held(k, c)) heaviest = std::max(heaviest, masses[k][c]);
    mass = std::max(mass, heaviest);
    // sqrt(inertia / mass), the radius of gyration
    if (!held(k, 2) && heaviest > 0.0) length = std::max(length, std::sqrt(masses[k][2] / heaviest));
  }
  mass_ = power_of_two(mass);
  length_ = power_of_two(length);
}

bool IslandUnits::held(int body, int c) const { return std::isinf(masses_[body][c]); }

/// A power of two as well; 1 where nothing is asked for.
void IslandUnits::set_speed(double speed) { speed_ = power_of_two(speed); }

double IslandUnits::largest(const std::vector<Vec3>& forces) const {
  double most = 0.0;
  for (int k = 0; k < static_cast<int>(forces.size()); ++k)
    for (int c = 0; c < 3; ++c)
      if (!held(k, c)) most = std::max(most, std::abs(forces[k][c]) / (c == 2 ? length_ : 1.0));
  return most;
}

Vec3 IslandUnits::scaled_mass(int body) const {
  Vec3 m = masses_[body].cwiseQuotient(mass_ * by_length(length_ * length_));
  // 1 instead of infinity: without force and without any part in a row, the velocity stays 0 all the same.
  for (int c = 0; c < 3; ++c)
    if (held(body, c)) m[c] = 1.0;
  return m;
}

Vec3 IslandUnits::scaled_force(int body, const Vec3& force) const {
  Vec3 f = force.cwiseQuotient(mass_ * speed_ * by_length(length_));
  for (int c = 0; c < 3; ++c)
    if (held(body, c)) f[c] = 0.0;
  return f;
}

Vec3 IslandUnits::scaled_row(int body, const Vec3& on) const {
  // y = on . w is a speed; with w's angle in units of speed / length, its coefficient [m]
  // is divided by length.
  Vec3 row = on.cwiseQuotient(by_length(length_));
  for (int c = 0; c < 3; ++c)
    if (held(body, c)) row[c] = 0.0;
  return row;
}

Vec3 IslandUnits::speed_of(int body, const Vec3& scaled) const {
  Vec3 w = speed_ * scaled.cwiseQuotient(by_length(length_));
  for (int c = 0; c < 3; ++c)
    if (held(body, c)) w[c] = 0.0;
  return w;
}

}  // namespace brink
