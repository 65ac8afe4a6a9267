#pragma once
/// Choices of the `[solver]` table: the only home of their defaults, printed from here by the program and the
/// docs.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "brink/core/fields/field_options.h"
#include "brink/integrators/integrator.h"

namespace brink {

/// Of contacts at one instant: which is resolved first, or that they are taken together.
enum class Order { index, closing_speed, depth, random, lcp, reflections };
/// True if the order resolves all contacts of one instant together; else it picks one after another.
constexpr bool takes_together(Order order) { return order == Order::lcp || order == Order::reflections; }
/// True if the order must see all contacts of an instant to pick one.
constexpr bool picks_among_all(Order order) { return order != Order::index && !takes_together(order); }
/// @throws BadInput if there is none of that name: see orders().
Order order_of(std::string_view name);

struct SolverOptions {
  std::string policy = "body_clocks";  ///< see policies()
  std::string order = "index";         ///< simultaneous contacts: see orders()
  std::string integrator = "auto";     ///< see integrators()
  double tolerance = 1e-10;            ///< relative, adaptive integrators
  double absolute_tolerance = 1e-12;   ///< adaptive integrators
  double step = 0.001;  ///< [s], for fixed-step integrators, policy fixed_step and detector depth
  std::string response = "impulse";  ///< impulse | reflection
  std::string detector = "field";    ///< field | pass | depth
  double contact_tolerance = 1e-10;  ///< of the scene's length
  /// Contacts may last: where bounces come to their limit the run goes on, in steps of order 1 or at rest
  /// (docs/contacts-that-last.md). Else it ends there.
  bool persistent = true;
  /// Islands of few bodies with at most so many contacts move by modes, to `tolerance`; others in steps. Where
  /// forces change with place, velocity or time, 16 at least.
  std::uint64_t modes_contacts = 16;
  /// Steps of islands are so short that nobody's place is off by more in one of them [m]: half of what its change of
  /// velocity moves it. Impacts in a step do not count. 0: steps are as long as the smallest member's fall allows.
  double island_tolerance = 0.0;
  /// Where contacts hold an island and nothing of it is faster than this, it is taken to be at rest [m/s]; the
  /// energy that goes with it is told. 0: an island is at rest where nothing of its motion is left.
  double rest_speed = 0.0;
  std::uint64_t seed = 1;             ///< for order "random"
  std::uint64_t kept_states = 10000;  ///< policy timewarp: former states of bodies kept at most
  std::uint64_t max_collisions = 0;   ///< stop after this many; 0: no limit

  // What may be skipped (each gives the same events on and off; see docs/architecture.md)
  bool closed_forms = true;              ///< quadratics where a pair has them
  bool fields_for_small_shapes = false;  ///< a field, not brute force, for outlines of few sites, too
  bool broad_phase = true;               ///< test only pairs whose moving bounds meet
  bool share_fields = true;              ///< one field a distinct shape, not one a body

  FieldOptions field;

  IntegratorOptions integrator_options() const { return {tolerance, absolute_tolerance, step}; }
  /// True if usable; else writes which option, its value and what is allowed into *error.
  bool is_valid(std::string* error) const;
};

/// A thing that can be chosen by name, with one line that says what it is.
struct Choice {
  std::string_view name;
  std::string_view summary;
};
/// Those of Brink, and those that the program has added (register_policy in scheduler/policies/policy.h).
std::vector<Choice> policies();
std::span<const Choice> orders();
std::span<const Choice> responses();
std::span<const Choice> detectors();

}  // namespace brink
