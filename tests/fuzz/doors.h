#pragma once
/// Scripts of what a program does with a simulator between runs, and how they are carried out: run on, go to
/// the next event, put a body elsewhere, push one, let pairs pass through each other.

#include <set>

#include "world_runs.h"

namespace brink::doors {

using Passing = std::set<std::pair<int, int>>;

/// One thing that a program does.
struct Door {
  enum class Kind { run, step, put, push, filter };
  Kind kind = Kind::run;
  double until = 0.0;  ///< run, step: at the latest [s]
  int body = 0;        ///< put, push
  BodyState state;     ///< put
  Vec2 impulse{0, 0};  ///< push [N s]
  Vec2 point{0, 0};    ///< push [m]
  Passing passing;     ///< filter: owners that pass through each other
};
using Script = std::vector<Door>;

/// What was told while a script was carried out, and what there was after each door.
struct Told : worlds::Told {
  struct Stop {
    double time = 0.0;
    std::uint64_t hash = 0;
    std::string ending;
  };
  std::vector<Stop> stops;
};

/// Carries doors out, one after another.
class Driver {
 public:
  explicit Driver(const Scene& scene, Recorder* also = nullptr)
      : scene_(&scene), keeper_(told, also), simulator_(scene.world, scene.solver) {}

  Told told;
  double checkpoints = -1.0;  ///< RunOptions::checkpoint_seconds
  bool interrupted = false;   ///< runs are broken off now and then, and gone on with

  Simulator& simulator() { return simulator_; }
  const Passing& passing() const { return passing_; }
  /// False where the run has come to an end before its time.
  bool carry_out(const Door& door) {
    told.stops.push_back({});
    switch (door.kind) {
      case Door::Kind::run:
      case Door::Kind::step:
        if (!run(door)) return false;
        break;
      case Door::Kind::put:
        simulator_.set_state(door.body, door.state);
        break;
      case Door::Kind::push:
        simulator_.apply_impulse(door.body, door.impulse, door.point);
        break;
      case Door::Kind::filter:
        filter(door.passing);
        break;
    }
    told.stops.back() = {simulator_.time(), simulator_.state_hash(), told.summary.termination_text()};
    return true;
  }
  /// All that a killed program leaves behind is put into a new simulator.
  void die_and_rise() { rise_from(simulator_.snapshot()); }
  void rise_from(const std::vector<std::byte>& bytes) {
    simulator_ = Simulator(scene_->world, scene_->solver);
    simulator_.restore(bytes);
    if (!passing_.empty()) filter(passing_);
  }
  void filter(const Passing& passing) {
    passing_ = passing;
    simulator_.set_pair_filter([passing](int a, int b) { return !passing.contains({a, b}); });
  }

 private:
  bool run(const Door& door) {
    RunOptions options = worlds::options_of(*scene_, told);
    options.until = std::max(door.until, simulator_.time());
    options.checkpoint_seconds = checkpoints;
    const bool step = door.kind == Door::Kind::step;
    if (step)
      told.summary = simulator_.step_to_next_event(options, &keeper_);
    else if (interrupted)
      go_by_parts(options);
    else
      told.summary = simulator_.run(options, &keeper_);
    told.stops.back() = {simulator_.time(), simulator_.state_hash(), told.summary.termination_text()};
    const bool stepped = step && told.summary.why.starts_with("a collision at");
    return stepped || told.summary.termination == Termination::reached_end;
  }

  /// Breaks the run off after some work, ever more of it, and goes on.
  void go_by_parts(RunOptions options) {
    const auto patient = options.progress;
    int most = 1;
    do {
      int asked = 0;
      options.progress = [&](double t, std::uint64_t n) { return asked++ < most && patient(t, n); };
      told.summary = simulator_.run(options, &keeper_);
      most *= 2;
    } while (told.summary.why == "on request" && !told.too_long);
  }

  const Scene* scene_;
  worlds::Keeper keeper_;
  Simulator simulator_;
  Passing passing_;
};

}  // namespace brink::doors
