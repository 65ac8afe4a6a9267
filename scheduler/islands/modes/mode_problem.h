#pragma once
/// Bodies, the contacts that may last between them, and their forces: what modes are chosen and followed of.

#include <functional>
#include <span>
#include <vector>

#include "brink/integrators/motion.h"
#include "brink/scheduler/islands/modes/smooth_contact.h"

namespace brink {

/// What a contact does while nothing changes. Slip's sign is that of v_t.
enum class MotionMode : unsigned char {
  open,   ///< no force
  stick,  ///< v_n = v_t = 0
  slip_plus,
  slip_minus,  ///< v_n = 0, friction at its bound against the slip
  smooth,      ///< v_n = 0, and no friction there
};
constexpr bool is_closed(MotionMode m) { return m != MotionMode::open; }
constexpr bool is_slip(MotionMode m) { return m == MotionMode::slip_plus || m == MotionMode::slip_minus; }

/// Owners are indices into the problem's bodies and, after them, its supports.
struct ModeContact {
  SmoothContact shape;
  int sample_owner = 0, site_owner = 0;
  double friction = 0.0;  ///< Coulomb, >= 0
  double kept = 0.0;      ///< the gap that it keeps while it is closed [m]
  double closes_at =
      0.0;  ///< the gap at which an open one closes [m]: at a wire, which has no inside, a touch
  /// What its gap may be off inside a step [m].
  double off = std::numeric_limits<double>::infinity();
  bool passes =
      false;  ///< open: the end of a site that goes on, by which the sample passes, but for roundings
};

/// Accelerations of all but contacts at time t [s], of bodies at those states.
using FreeAccelerations =
    std::function<void(double t, std::span<const BodyState> states, std::span<Acceleration> out)>;

struct ModeProblem {
  std::vector<Vec3> inverse_mass;  ///< of each body: x, y [1/kg], angle [1/(kg m^2)]; 0: held
  std::vector<Motion> supports;    ///< owners that yield to nothing
  std::vector<ModeContact> contacts;
  FreeAccelerations free;
  double size = 1.0;  ///< of the smallest body [m]: what tolerances are parts of
  /// Where forces or the supports' accelerations jump, at which steps end: up to there they are those of `before_jump` [s].
  double jump = std::numeric_limits<double>::infinity(), before_jump = jump;
  double before(double t) const { return t < jump ? t : before_jump; }

  int bodies() const { return static_cast<int>(inverse_mass.size()); }
};

/// One moment: contacts' rates with the supports' accelerations in their bends, and free accelerations.
struct ModeMoment {
  std::vector<ContactRates> contacts;
  Eigen::VectorXd free;  ///< x, y, angle of each body
};

ModeMoment moment_at(const ModeProblem& problem, double t, std::span<const BodyState> states);
std::vector<ContactRates> rates_at(const ModeProblem& problem, double t, std::span<const BodyState> states);
/// The same of closed contacts alone; others are left as they are made.
ModeMoment moment_at(const ModeProblem& problem, double t, std::span<const BodyState> states,
                     const std::vector<MotionMode>& modes);
std::vector<ContactRates> rates_at(const ModeProblem& problem, double t, std::span<const BodyState> states,
                                   const std::vector<MotionMode>& modes);
/// Of one contact.
ContactRates rates_at(const ModeProblem& problem, double t, std::span<const BodyState> states,
                      const ModeContact& contact);
/// The state of an owner, a body or a support, at that moment.
BodyState state_of(const ModeProblem& problem, int owner, double t, std::span<const BodyState> states);

/// Row of one contact over all bodies: x, y, angle of each. Supports have no columns.
Eigen::VectorXd row_of(const ModeProblem& problem, const ModeContact& contact, const Vec3& on_sample,
                       const Vec3& on_site);

/// The most that accelerations of such size could give along a row: of each body its linear one in any direction, and its
/// angular one. What comes out of them is rounded by a part of that. Both over x, y, angle of each body.
template <class Row, class Accelerations>
typename Row::Scalar most_along(const Row& row, const Accelerations& a) {
  using std::abs;
  typename Row::Scalar most = 0;
  for (Eigen::Index k = 0; k < row.size(); k += 3)
    most += row.template segment<2>(k).norm() * a.template segment<2>(k).norm() + abs(row[k + 2] * a[k + 2]);
  return most;
}

}  // namespace brink
