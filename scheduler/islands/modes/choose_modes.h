#pragma once
/// Which contacts open, stick and slip from now on: Coulomb's law at the level of accelerations.
///
/// Of a contact that slides, friction is -sign(v_t) mu p; of one that does not, with f+ and f- >= 0,
///
///   0 <= a_n _|_ p >= 0,   0 <= g +- a_t _|_ f+- >= 0,   0 <= mu p - f+ - f- _|_ g >= 0
///
/// a linear complementarity problem, solved by Lemke's method. Sources: Glocker & Pfeiffer 1993, "Complementarity
/// problems in multibody systems with planar friction"; Stewart & Trinkle 1996.

#include <optional>

#include "brink/scheduler/islands/modes/mode_problem.h"

namespace brink {

/// What is known of a contact before.
enum class ContactKnown : unsigned char {
  open,         ///< apart, parting, or forced to be open
  still,        ///< v_n = v_t = 0: it may open, stick, or begin to slip either way
  slides_plus,  ///< v_n = 0, v_t > 0: it may open, or goes on
  slides_minus,
};

struct ModeChoice {
  bool found = false;  ///< false: no forces are Coulomb's (Painleve 1895), or none was found
  std::vector<MotionMode> modes;
};

/// @pre moment and known speak of the problem's contacts. Cost: about (3 contacts)^3 in extended precision.
ModeChoice choose_modes(const ModeProblem& problem, const ModeMoment& moment,
                        const std::vector<ContactKnown>& known);

struct PlasticImpact {
  std::vector<BodyState> states;           ///< with the velocities after it
  std::vector<double> normal, tangential;  ///< impulses of each contact, on the sample's owner [N s]
};

/// Contacts that touch have met without a rebound, all of them at once, with Coulomb's law for impulses (Moreau
/// 1988): the same problem for velocities. Nothing: none were found. `touching`: by contact.
std::optional<PlasticImpact> plastic_impact(const ModeProblem& problem, double t,
                                            const std::vector<BodyState>& states,
                                            const std::vector<bool>& touching);

}  // namespace brink
