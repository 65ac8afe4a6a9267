#include "brink/scenes/bench/classic_worlds.h"

#include "brink/core/world/make_body.h"
#include "brink/scenes/bench/hits.h"

namespace brink::bench {

Body sampled_body(const Shape& shape, const Pose& pose, const Twist& twist, double spacing) {
  Body body = make_body(shape, Mass{1.0});
  body.initial = {pose, twist};
  body.sampling.kind = Sampling::Kind::boundary;
  body.sampling.spacing = spacing;
  return body;
}

void add_fixed(World& world, const Shape& shape, const Pose& pose) {
  FixedSite site;
  site.name = "site" + std::to_string(world.sites.size());
  site.outline = std::make_shared<const Outline>(shape.outline);
  site.pose = pose;
  world.sites.push_back(std::move(site));
}

SolverOptions backing_up(const char* detector, double step) {
  SolverOptions options;
  // The classic detector backs up under every policy but fixed_step; this one is the reference.
  options.policy = "global_backup";
  options.detector = detector;
  options.step = step;
  return options;
}

std::vector<double> hits_of(const World& world, const SolverOptions& options, double until) {
  Simulator simulator(world, options);
  Hits hits;
  RunOptions run;
  run.until = until;
  // No checkpoints: they would take time.
  run.checkpoint_seconds = -1.0;
  simulator.run(run, &hits);
  return hits.times;
}

}  // namespace brink::bench
