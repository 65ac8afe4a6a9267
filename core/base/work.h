#pragma once
/// Work counters: what a run did, beside how long it took. Plain sums, cheap enough to be always on.

#include <cstdint>
#include <string_view>

namespace brink {

struct WorkCounters {
  // fields
  std::uint64_t passes = 0;                 ///< tests of one body against everything else
  std::uint64_t pixels_drawn = 0;           ///< pixels of rendered targets
  std::uint64_t pixels_read = 0;            ///< pixels read back
  std::uint64_t distance_queries = 0;       ///< points whose nearest sites were asked for
  std::uint64_t candidate_evaluations = 0;  ///< exact point-site distances
  // motion
  std::uint64_t right_hand_sides = 0;  ///< evaluations of accelerations
  std::uint64_t solver_steps = 0;      ///< accepted integrator steps
  std::uint64_t component_resets = 0;  ///< integrators restarted after a resolve
  // scheduling
  std::uint64_t advances = 0;     ///< bodies taken forward
  std::uint64_t backups = 0;      ///< bodies taken back inside their motion
  std::uint64_t rollbacks = 0;    ///< bodies whose motion was undone because of a contact that came late
  std::uint64_t states_kept = 0;  ///< former states of bodies kept to roll back to: the most at once
  double body_seconds_thrown_away = 0.0;  ///< simulated time undone by backups and rollbacks [s]
  std::uint64_t certificates_issued = 0;
  std::uint64_t certificates_stale = 0;
  std::uint64_t certificates_undecided =
      0;                                ///< searches that stopped short, of an instalment or of their cap
  std::uint64_t queue_operations = 0;   ///< certificates put into the agenda or taken out
  std::uint64_t pair_searches = 0;      ///< first-contact searches of one pair
  std::uint64_t search_iterations = 0;  ///< certified Newton steps
  std::uint64_t closed_forms = 0;       ///< searches answered by a quadratic
  std::uint64_t horizons = 0;           ///< broad-phase rebuilds
  // resolving
  std::uint64_t collisions = 0;
  std::uint64_t collisions_body_body = 0;
  std::uint64_t collisions_body_site = 0;
  std::uint64_t collisions_quick = 0;  ///< of plain discs alone in their instant, resolved in one go
  std::uint64_t let_go = 0;            ///< overlapping but receding contacts let go (Bannerman et al. 2012)
  // wall-clock seconds of the stages, each without those within it; what is left is the policy's own
  double seconds_look = 0.0;      ///< who is near whom: broad phase, views, passes
  double seconds_search = 0.0;    ///< first contacts of pairs
  double seconds_motion = 0.0;    ///< integrators
  double seconds_response = 0.0;  ///< collisions and groups
  double seconds_islands = 0.0;   ///< contacts that last
  double seconds_record = 0.0;    ///< frames with their checks, checkpoints

  /// Calls visit(name, member, unit) for every counter, in a fixed order. `Self` may be const.
  template <class Self, class Visit>
  static void for_each(Self& w, Visit&& visit) {
    visit("passes", w.passes, "1");
    visit("pixels_drawn", w.pixels_drawn, "pixel");
    visit("pixels_read", w.pixels_read, "pixel");
    visit("distance_queries", w.distance_queries, "1");
    visit("candidate_evaluations", w.candidate_evaluations, "1");
    visit("right_hand_sides", w.right_hand_sides, "1");
    visit("solver_steps", w.solver_steps, "1");
    visit("component_resets", w.component_resets, "1");
    visit("advances", w.advances, "1");
    visit("backups", w.backups, "1");
    visit("rollbacks", w.rollbacks, "1");
    visit("states_kept", w.states_kept, "1");
    visit("body_seconds_thrown_away", w.body_seconds_thrown_away, "s");
    visit("certificates_issued", w.certificates_issued, "1");
    visit("certificates_stale", w.certificates_stale, "1");
    visit("certificates_undecided", w.certificates_undecided, "1");
    visit("queue_operations", w.queue_operations, "1");
    visit("pair_searches", w.pair_searches, "1");
    visit("search_iterations", w.search_iterations, "1");
    visit("closed_forms", w.closed_forms, "1");
    visit("horizons", w.horizons, "1");
    visit("collisions", w.collisions, "1");
    visit("collisions_body_body", w.collisions_body_body, "1");
    visit("collisions_body_site", w.collisions_body_site, "1");
    visit("collisions_quick", w.collisions_quick, "1");
    visit("let_go", w.let_go, "1");
    visit("seconds_look", w.seconds_look, "s");
    visit("seconds_search", w.seconds_search, "s");
    visit("seconds_motion", w.seconds_motion, "s");
    visit("seconds_response", w.seconds_response, "s");
    visit("seconds_islands", w.seconds_islands, "s");
    visit("seconds_record", w.seconds_record, "s");
  }
};

}  // namespace brink
