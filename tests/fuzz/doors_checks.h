#pragma once
/// Random scripts in random worlds: looked at from outside, and carried out in every way that must give the
/// same bits.

#include "doors_author.h"
#include "random_worlds_checks.h"

namespace brink::doors {

using worlds::Tally;
using worlds::Verdict;

/// How two ways of one script differ, in words; empty: not at all.
inline std::string difference(const Told& a, const Told& b) {
  if (const std::string what = worlds::difference(a, b); !what.empty()) return what;
  if (a.stops.size() != b.stops.size()) return std::to_string(b.stops.size()) + " doors passed";
  for (std::size_t k = 0; k < a.stops.size(); ++k) {
    const Told::Stop &x = a.stops[k], &y = b.stops[k];
    if (x.hash == y.hash && x.time == y.time && x.ending == y.ending) continue;
    std::ostringstream out;
    out.precision(17);
    out << "after door " << k << ": t = " << y.time << ", '" << y.ending << "'; not " << x.time << ", '"
        << x.ending << "'";
    return out.str();
  }
  return {};
}

/// How a script is carried out.
struct Way {
  bool interrupted = false;
  std::set<std::size_t> deaths = {};  ///< doors after which the program is killed
};

inline Told carry_out(const Scene& scene, const Script& script, const Way& way) {
  Driver driver(scene);
  driver.interrupted = way.interrupted;
  for (std::size_t k = 0; k < script.size() && driver.carry_out(script[k]); ++k)
    if (way.deaths.contains(k)) driver.die_and_rise();
  return driver.told;
}

/// Killed in the middle of a run, at a checkpoint: the events from there on, and what follows.
inline std::optional<Told> from_a_checkpoint(const Scene& scene, const Script& script) {
  Driver whole(scene);
  whole.checkpoints = 0.0;
  for (std::size_t k = 0; k < script.size(); ++k) {
    const std::size_t earlier = whole.told.checkpoints.size();
    const bool goes_on = whole.carry_out(script[k]);
    const std::size_t written = whole.told.checkpoints.size() - earlier;
    if (k >= script.size() / 2 && script[k].kind == Door::Kind::run && written > 2) {
      const worlds::Told::Checkpoint& c = whole.told.checkpoints[earlier + written / 2];
      Driver second(scene);
      second.filter(whole.passing());
      second.rise_from(c.state);
      second.told.events.assign(whole.told.events.begin(), whole.told.events.begin() + c.events);
      second.told.stops.assign(whole.told.stops.begin(), whole.told.stops.end() - 1);
      for (std::size_t j = k; j < script.size() && second.carry_out(script[j]); ++j) {
      }
      return second.told;
    }
    if (!goes_on) break;
  }
  return std::nullopt;
}

class Examiner {
 public:
  Verdict examine(std::uint64_t seed, const std::string& text, const std::string& name) {
    const Scene scene = parse_scene(text, name);
    outside::WatchOptions options;
    options.until = scene.duration;
    options.contact_tolerance = scene.solver.contact_tolerance;
    options.laws = !takes_together(order_of(scene.solver.order));
    outside::DoorWatch watch(scene.world, options);
    Author author(seed, scene, watch);
    author.go();
    const Told& reference = author.told();
    ++verdict_.runs;
    verdict_.looks = watch.looks;
    verdict_.ending = reference.summary.termination_text();
    verdict_.collisions = reference.summary.collisions;
    verdict_.reached_end = reference.summary.termination == Termination::reached_end;
    for (const std::string& f : watch.faults) verdict_.faults.push_back("seen from outside: " + f);
    if (reference.too_long) return verdict_;
    in_every_way(text, name, author.script, reference);
    return verdict_;
  }

 private:
  void in_every_way(const std::string& text, const std::string& name, const Script& script,
                    const Told& reference) {
    const Scene scene = parse_scene(text, name);
    std::set<std::size_t> all, some;
    for (std::size_t k = 0; k < script.size(); ++k) {
      all.insert(k);
      if (k % 3 == 1) some.insert(k);
    }
    for (const std::string& policy : exact_policies()) {
      const Scene by = parse_scene(text, name, {"solver.policy=" + policy});
      attempt(policy, reference, [&] { return carry_out(by, script, {}); });
      attempt(policy + ", killed", reference, [&] { return carry_out(by, script, {false, some}); });
    }
    attempt("killed after every door", reference, [&] { return carry_out(scene, script, {false, all}); });
    attempt("interrupted", reference, [&] { return carry_out(scene, script, {true, {}}); });
    attempt("no closed forms", reference,
            [&] { return carry_out(parse_scene(text, name, {"solver.closed_forms=false"}), script, {}); });
    attempt("from a checkpoint", reference,
            [&] { return from_a_checkpoint(scene, script).value_or(reference); });
  }

  template <class Run>
  void attempt(const std::string& name, const Told& reference, const Run& run) {
    ++verdict_.runs;
    try {
      const Told told = run();
      const std::string what = told.too_long ? "broken off: too long" : difference(reference, told);
      if (!what.empty()) verdict_.faults.push_back(name + ": " + what);
    } catch (const std::exception& e) {
      verdict_.faults.push_back(name + ": throws " + e.what());
    }
  }

  Verdict verdict_;
};

/// Examines the script of a seed in the world of that seed; on a fault the scene is kept.
inline bool examine_seed(std::uint64_t seed, Tally& tally) {
  worlds::Taste taste;
  taste.hits = 40;
  const std::string text = worlds::random_world(seed, taste);
  return worlds::count(seed, text, tally,
                       [&](const std::string& name) { return Examiner().examine(seed, text, name); });
}

}  // namespace brink::doors
