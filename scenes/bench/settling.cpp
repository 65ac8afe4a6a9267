// All engines are given the same world and are looked at in the same frames with the same measure of
// overlap, deepest_overlap(). What is timed is processor time of their steps alone.
#include "brink/scenes/bench/settling.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "brink/core/query/outline_gap.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink::bench {

namespace {

/// [s], the end. Who is not at rest by then has infinity as its time.
constexpr double kSettled = 8.0;
/// [m] Brink's: without it a disc that rolls on the level floor does so for ever. Peers stop whoever is slower than 1 cm/s.
constexpr double kRollingResistance = 1e-4;

/// A bin of three walls, and bodies in a pile above it to fall; as a scene file, so that
/// anybody can make it.
Heap heap(std::string name, const std::string& shape, int count, double width) {
  // Restitution 0: an engine that bounces would come to rest later for that alone.
  std::string text = fmt::format(
      "[world]\nduration = {}\ngravity = [0, -9.81]\nseed = 7\n[materials.default]\nrestitution = "
      "0\nfriction = 0.5\nrolling_resistance = {}\n",
      kSettled, kRollingResistance);
  // High enough for the pile; walls are boxes, a shape that all engines have.
  const double height = 20.0, thick = 0.5;
  // Its middle [m], width and height.
  const auto wall = [&](double x, double y, double w, double h) {
    text += fmt::format("[[sites]]\nbox = {{ width = {}, height = {} }}\nposition = [{}, {}]\n", w, h, x, y);
  };
  wall(0.0, -thick / 2, width + 2 * thick, thick);
  // Their inner sides are `width` apart.
  for (const double side : {-1.0, 1.0}) wall(side * (width + thick) / 2, height / 2, thick, height);
  text +=
      fmt::format("[[bodies]]\n{}\ndensity = 1\nposition = [0, 0.2]\npile = {{ count = {}, width = {} }}\n",
                  shape, count, 0.9 * width);
  return {std::move(name), parse_scene(text, "heap")};
}

}  // namespace

std::vector<Heap> heaps() {
  return {heap("100 discs", "disc = { radius = 0.1 }", 100, 2.2),
          heap("200 discs", "disc = { radius = 0.1 }", 200, 3.0),
          heap("60 boxes", "box = { width = 0.2, height = 0.14 }", 60, 2.0)};
}

double deepest_overlap(const World& world, const std::vector<Pose>& bodies) {
  double deepest = 0.0;
  const auto look = [&](std::size_t i, const Outline& other, const Pose& at, bool site) {
    // outline_gap() costs samples times sites: with n bodies it is asked for the few that are near, not for
    // n^2 / 2.
    const Outline& outline = *world.bodies[i].outline;
    const double reach = outline.bounding_radius + other.bounding_radius;
    // Far bodies by their discs alone. Sites are few, and a wall's disc would reach all of the bin.
    if (!site && (bodies[i].position - at.position).squaredNorm() > reach * reach) return;
    deepest = std::max(deepest, -outline_gap(outline, bodies[i], other, at).gap);
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) look(i, *world.bodies[j].outline, bodies[j], false);
    for (const FixedSite& site : world.sites) look(i, *site.outline, site.pose, true);
  }
  return deepest;
}

Settled settle_with_brink(const Heap& heap) {
  const World& world = heap.scene.world;
  // Planned once, before any clock: drawing of fields is no step.
  Simulator simulator(world, heap.scene.solver);
  Settled settled{"Brink"};
  // Steps of a frame each, as the peers have; Brink's own events lie between.
  for (int frame = 1; frame * kFrame < heap.scene.duration; ++frame) {
    // Each run goes on from where the last one ended.
    RunOptions how;
    how.until = frame * kFrame;
    how.checkpoint_seconds = -1.0;
    // Of the run alone, as with the peers.
    const std::clock_t begin = std::clock();
    const RunSummary summary = simulator.run(how);
    settled.cpu_seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    if (summary.termination != Termination::reached_end) {
      settled.why = summary.termination_text();
      break;
    }
    std::vector<Pose> poses;
    for (const BodyState& s : simulator.states()) poses.push_back(s.pose);
    settled.overlap = std::max(settled.overlap, deepest_overlap(world, poses));
    // Everybody asleep: the first time that they are.
    if (summary.resting == world.bodies.size()) settled.at_rest = std::min(settled.at_rest, how.until);
  }
  return settled;
}

}  // namespace brink::bench
