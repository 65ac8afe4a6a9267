#pragma once
/// One scene in every way that must give the same events: policies, skips, detectors, resumes; each looked at
/// from outside.

#include <chrono>
#include <iostream>
#include <string>
#include <vector>

#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/policies/policy.h"
#include "tests/support/outside/watch.h"
#include "tests/support/same_events.h"

namespace brink::worlds {

/// What a run told.
struct Told {
  std::vector<Event> events;
  RunSummary summary;
  struct Checkpoint {
    std::size_t events = 0;  ///< told before it
    std::vector<std::byte> state;
  };
  std::vector<Checkpoint> checkpoints;
  bool too_long = false;  ///< broken off by the watchdog
};

class Keeper : public Recorder {
 public:
  Keeper(Told& told, Recorder* also) : told_(told), also_(also) {}
  void frame(double t, std::span<const BodyState> states) override {
    if (also_) also_->frame(t, states);
  }
  void event(const Event& e) override {
    told_.events.push_back(e);
    if (also_) also_->event(e);
  }
  void checkpoint(double, const std::vector<std::byte>& state) override {
    told_.checkpoints.push_back({told_.events.size(), state});
  }

 private:
  Told& told_;
  Recorder* also_;
};

constexpr double kPatience =
    90.0;  ///< seconds that one run may take before it is broken off: no hang, only slow

inline RunOptions options_of(const Scene& scene, Told& told) {
  RunOptions options;
  options.until = scene.duration;
  options.frame_interval = scene.duration / 64.0;
  options.checkpoint_seconds = -1.0;
  const auto begin = std::chrono::steady_clock::now();
  options.progress = [begin, &told](double, std::uint64_t) {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
    return !(told.too_long = spent.count() > kPatience);
  };
  return options;
}

inline Told run(const Scene& scene, Recorder* also = nullptr, double checkpoints = -1.0) {
  Told told;
  Keeper keeper(told, also);
  Simulator simulator(scene.world, scene.solver);
  RunOptions options = options_of(scene, told);
  options.checkpoint_seconds = checkpoints;
  told.summary = simulator.run(options, &keeper);
  return told;
}

/// Runs to a part of the end, and on in a simulator that knows the first by its snapshot alone.
inline Told run_in_two(const Scene& scene, double part) {
  Told told;
  Keeper keeper(told, nullptr);
  RunOptions options = options_of(scene, told);
  Simulator first(scene.world, scene.solver);
  options.until = part * scene.duration;
  told.summary = first.run(options, &keeper);
  if (told.summary.termination != Termination::reached_end) return told;
  Simulator second(scene.world, scene.solver);
  second.restore(first.snapshot());
  options.until = scene.duration;
  options.first_frame = false;
  told.summary = second.run(options, &keeper);
  return told;
}

/// From a checkpoint in the middle of a run to the end.
inline Told run_from(const Scene& scene, const std::vector<std::byte>& checkpoint) {
  Told told;
  Keeper keeper(told, nullptr);
  Simulator simulator(scene.world, scene.solver);
  simulator.restore(checkpoint);
  RunOptions options = options_of(scene, told);
  options.first_frame = false;
  told.summary = simulator.run(options, &keeper);
  return told;
}

inline std::string exactly(const Event& e) {
  const Contact& c = e.contact;
  std::ostringstream out;
  out.precision(17);
  out << to_string(e.kind) << " " << e.seq << " at " << c.time << " + " << c.time_low << " of " << c.body
      << " on " << (c.other_body >= 0 ? "body " : "site ") << std::max(c.other_body, c.other_site)
      << ", feature " << c.site << ", sample " << c.sample << (c.sample_on_body ? "" : " of the other")
      << ", closing " << c.closing_speed << ", gap " << c.gap << ", impulse " << e.impulse_n;
  return out.str();
}

/// How two runs differ, in words; empty: not at all. The other may have begun later: its events go by their
/// numbers.
inline std::string difference(const Told& a, const Told& b) {
  const auto begin =
      b.events.empty() ? a.events.end() : std::find_if(a.events.begin(), a.events.end(), [&](const Event& e) {
        return e.seq == b.events.front().seq;
      });
  const auto skipped = static_cast<std::size_t>(begin - a.events.begin());
  for (std::size_t k = 0; k < std::min(a.events.size() - skipped, b.events.size()); ++k)
    if (!testing::same(a.events[k + skipped], b.events[k]))
      return exactly(b.events[k]) + "; not " + exactly(a.events[k + skipped]);
  if (a.events.size() - skipped != b.events.size())
    return std::to_string(b.events.size()) + " events, not " + std::to_string(a.events.size() - skipped);
  if (a.summary.termination_text() != b.summary.termination_text())
    return "ends '" + b.summary.termination_text() + "', not '" + a.summary.termination_text() + "'";
  if (a.summary.state_hash != b.summary.state_hash) return "another state at the end";
  return {};
}

/// What was found out about one scene.
struct Verdict {
  std::vector<std::string> faults;
  std::uint64_t collisions = 0;
  long looks = 0;
  int runs = 0;
  bool reached_end = false;
  std::string ending;
};

/// One way to run a scene.
struct Way {
  std::string name;
  std::vector<std::string> sets;
};

/// What is followed from outside by the impulses that are told; contacts that last have checks of their own.
inline const std::string kCollisionsAlone = "solver.persistent=false";

inline std::vector<Way> ways(bool with_pass) {
  std::vector<Way> all;
  for (const std::string& policy : exact_policies())
    if (policy != SolverOptions().policy) all.push_back({policy, {"solver.policy=" + policy}});
  const std::vector<Way> skips{
      {"no closed forms", {"solver.closed_forms=false"}},
      {"fields for all", {"solver.fields_for_small_shapes=true"}},
      {"no broad phase", {"solver.broad_phase=false"}},
      {"no shared fields", {"solver.share_fields=false", "solver.policy=global_backup"}},
  };
  all.insert(all.end(), skips.begin(), skips.end());
  if (with_pass) all.push_back({"pass", {"solver.detector=pass"}});
  for (Way& way : all) way.sets.push_back(kCollisionsAlone);
  return all;
}

class Examiner {
 public:
  bool detectors = true;
  double start_overlap = 0;  ///< that the world starts with [m]

  Verdict examine(const std::string& text, const std::string& name) {
    verdict_ = {};
    const Scene scene = parse_scene(text, name, {kCollisionsAlone});
    const Told reference = watched(scene);
    verdict_.ending = reference.summary.termination_text();
    verdict_.collisions = reference.summary.collisions;
    verdict_.reached_end = reference.summary.termination == Termination::reached_end;
    if (reference.too_long) {
      verdict_.faults.push_back("body_clocks: broken off after " + std::to_string(kPatience) + " s");
      return verdict_;
    }
    const bool pass = detectors && !scene.world.periods.any();
    for (const Way& way : ways(pass))
      attempt(
          way.name, [&] { return run(parse_scene(text, name, way.sets)); }, reference);
    for (const double part : {0.37, 0.71})
      attempt(
          "in two runs", [&] { return run_in_two(scene, part); }, reference);
    from_checkpoint(scene, reference);
    return verdict_;
  }

 private:
  Told watched(const Scene& scene) {
    outside::WatchOptions options;
    options.until = scene.duration;
    options.contact_tolerance = scene.solver.contact_tolerance;
    options.start_overlap = start_overlap;
    options.laws = !takes_together(order_of(scene.solver.order)) && scene.solver.response == "impulse";
    outside::Watch watch(scene.world, options);
    const Told told = run(scene, &watch);
    ++verdict_.runs;
    verdict_.looks += watch.looks;
    for (const std::string& f : watch.faults) verdict_.faults.push_back("seen from outside: " + f);
    return told;
  }

  template <class Run>
  void attempt(const std::string& name, const Run& run, const Told& reference) {
    ++verdict_.runs;
    try {
      const Told told = run();
      const std::string what = told.too_long ? "broken off: too long" : difference(reference, told);
      if (!what.empty()) verdict_.faults.push_back(name + ": " + what);
    } catch (const std::exception& e) {
      verdict_.faults.push_back(name + ": throws " + e.what());
    }
  }

  /// From the first checkpoint after half of the events.
  void from_checkpoint(const Scene& scene, const Told& reference) {
    const Told whole = run(scene, nullptr, 0.0);
    for (const Told::Checkpoint& c : whole.checkpoints)
      if (2 * c.events >= whole.events.size() && c.events < whole.events.size())
        return attempt(
            "from a checkpoint", [&] { return run_from(scene, c.state); }, reference);
  }

  Verdict verdict_;
};

}  // namespace brink::worlds
