#pragma once
/// A contact that lasts as a smooth constraint: a sample of one body against the line or the circle of a site of
/// another, with everything that its second derivative in time needs.
///
/// With r_S the arm of the sample's point, rho its place from the site's owner T, and w its velocity seen from T's
/// turning frame, the second derivative of the gap is  J_n a + normal_bend, where a are the accelerations of both:
///
///   line    n.(-omega_S^2 r_S - 2 omega_T x w + omega_T^2 rho)
///   circle  n.(-omega_S^2 r_S + omega_T^2 c) +- (t.u)^2 / L,  c: centre from T, u: velocity of the point against it
///
/// and likewise along the tangent, for the velocity of the material points that touch.

#include <array>
#include <limits>
#include <vector>

#include "brink/core/base/extended.h"
#include "brink/core/contacts/cone_qp.h"
#include "brink/scheduler/islands/near_features.h"

namespace brink {

/// inward . q >= least; everything, where `inward` is zero.
struct HalfPlane {
  Vec2 inward = Vec2::Zero();  ///< unit
  double least = -std::numeric_limits<double>::infinity();

  double within(const Vec2& q) const { return inward.dot(q) - least; }
};

/// A sample against one smooth piece of a surface; places in each owner's frame [m].
struct SmoothContact {
  enum class Kind : unsigned char { line, circle };
  Kind kind = Kind::line;
  bool hollow = false;         ///< circle: the sample is inside
  Vec2 sample = Vec2::Zero();  ///< the sample's point, in its owner's frame
  double sample_radius = 0.0;  ///< its thickness
  Vec2 place = Vec2::Zero();   ///< line: a point of the core; circle: the centre; in the site's owner's frame
  Vec2 normal = Vec2::UnitX();  ///< line: out of the site, unit, likewise
  double radius = 0.0;          ///< line: thickness; circle: of the surface
  Vec2 offset =
      Vec2::Zero();  ///< what is added to the sample's owner's place against the site's (images); world
  std::array<HalfPlane, 2> range;   ///< where the sample's point must be, in the site's frame
  std::array<HalfPlane, 2> sector;  ///< where the way to the site must point, in the sample's frame
};

/// What a contact is at one moment. The normal points from the site's owner to the sample's, the tangent is the
/// normal turned by +90 degrees, and relative velocities are the sample's owner minus the site's.
struct ContactRates {
  double gap = 0.0;  ///< [m]
  Vec2 normal = Vec2::UnitX();
  Vec2 arm = Vec2::Zero(),
       site_arm = Vec2::Zero();  ///< from either owner to the point that touches; world [m]
  /// v_n = normal_on_sample . v_S + normal_on_site . v_T, each v = (x, y [m/s], angle [rad/s]).
  Vec3 normal_on_sample = Vec3::Zero(), normal_on_site = Vec3::Zero();
  Vec3 tangent_on_sample = Vec3::Zero(), tangent_on_site = Vec3::Zero();
  double normal_velocity = 0.0, tangential_velocity = 0.0;  ///< [m/s]
  double normal_bend = 0.0, tangential_bend = 0.0;          ///< their rates where nobody accelerates [m/s^2]
  double within = 0.0;  ///< how far inside the range of the feature [m]; < 0: it has left it
};

/// Cost: some 200 flops.
ContactRates rates_of(const SmoothContact& contact, const BodyState& sample_owner,
                      const BodyState& site_owner);

/// The feature of outlines that are there, as such constraints: first what the sample is nearest to now, then what
/// else the site has (its interior, its ends), which the sample may come to. Nothing where the first has no one shape
/// around this place: a sharp point on a sharp point, a disc about its container's centre.
std::vector<SmoothContact> smooth_contacts(const NearFeature& feature, const Outline& a,
                                           const ExtendedState& state_a, const Outline& b,
                                           const ExtendedState& state_b);

}  // namespace brink
