#pragma once
/// Coulomb's law of many contacts, one contact after the other.

#include <vector>

#include "brink/core/contacts/cone_qp.h"

namespace brink {

struct CoulombLoads {
  std::vector<ContactLoad> loads;  ///< of each contact: p >= 0, |q| <= mu p, |torque| <= r p, to the bit
  int sweeps = 0;
};

/// Impulses of the step that obey Coulomb's law and nearly balance:
///
///   until no impulse changes any more, or after the `fewest` by next to nothing, or `most` times
///     for every contact, forwards and backwards in turn
///       its impulse := what closes its gap with the impulses of all others as they are: none, or one that holds it,
///                      or one that slips
///
/// It begins with the impulses that are expected, and so goes on from step to step where forces hardly change. Near what it
/// comes to it is slow, the slower the deeper the heap: gaps and twists are for ConeQp::step(), which takes its friction from
/// here. Contacts that share no body are taken eight at a time, which changes no bit: cost of a sweep some 6 ns a contact.
/// Sources: Moreau 1999, "Numerical aspects of the sweeping process"; Jean 1999, "The non-smooth contact dynamics method".
CoulombLoads sweep_by_coulomb(const StepProblem& problem, int fewest, int most, const GoOn& go_on = {});

/// The largest force by which those impulses fail to make the velocities of the step [N s]: M (w - v) - h f - J^T load. Torques
/// are not looked at.
double unexplained(const StepProblem& problem, const std::vector<Vec3>& velocity,
                   const std::vector<ContactLoad>& loads);

}  // namespace brink
