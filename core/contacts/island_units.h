#pragma once
/// An island's masses and lengths brought to order 1, and coordinates that are held taken out.

#include <vector>

#include "brink/core/contacts/interior_point.h"

namespace brink {

/// Units are powers of two: no bit of a result is lost to them. A coordinate of infinite mass has no part in
/// any row, so that nothing moves it.
class IslandUnits {
 public:
  /// In units of the largest mass and the largest radius of gyration.
  explicit IslandUnits(const std::vector<Vec3>& masses);

  /// Of what the unknowns are: velocities or accelerations. Forces or impulses then go by it times mass().
  void set_speed(double speed);
  double mass() const { return mass_; }
  double length() const { return length_; }
  double speed() const { return speed_; }
  double force() const { return mass_ * speed_; }
  /// The largest force on a coordinate that is not held; torques count by the length.
  double largest(const std::vector<Vec3>& forces) const;

  Vec3 scaled_mass(int body) const;                      ///< held: 1
  Vec3 scaled_force(int body, const Vec3& force) const;  ///< held: 0
  /// What a row sees of a body, for speeds. held: 0
  Vec3 scaled_row(int body, const Vec3& on) const;
  /// Back to a velocity or acceleration. held: 0
  Vec3 speed_of(int body, const Vec3& scaled) const;

 private:
  bool held(int body, int c) const;

  const std::vector<Vec3>& masses_;
  double mass_ = 1.0, length_ = 1.0, speed_ = 1.0;
};

}  // namespace brink
