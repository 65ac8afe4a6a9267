/// brink check: parse, validate, report overlaps at the start, print the plan; runs nothing.

#include <fmt/format.h>

#include "brink/core/base/error.h"
#include "brink/core/base/printable.h"
#include "brink/core/fields/stencil_overlap.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/terminal.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/kernel/site_motion.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink {
namespace {

/// A pile that was placed wrongly has thousands, and the first few say what is wrong.
constexpr std::size_t kOverlapsShown = 20;

void heading(std::string_view text) { fmt::print("{}\n", paint(stdout, Paint::heading, text)); }

std::string counted(std::size_t n, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

/// What the scene holds, in numbers, and the notes that reading it left.
void print_contents(const Scene& scene) {
  const World& w = scene.world;
  heading(w.title.empty() ? scene.path.filename().string() : w.title);
  fmt::print("  {}, {}, {}, {} s\n", counted(w.bodies.size(), "body", "bodies"),
             counted(w.sites.size(), "fixed site", "fixed sites"),
             counted(w.forces.size(), "force", "forces"), scene.duration);
  for (const std::string& note : scene.notes) fmt::print("  {}\n", printable(note));
}

/// Of the contact's other side, a body or a fixed site.
std::string other_name(const World& world, const Contact& c) {
  return c.other_body >= 0 ? world.bodies[c.other_body].name : world.sites[c.other_site].name;
}

/// Owner 0 is the contact's body, 1 the other.
/// Sites that move are taken where they are at the start.
PlacedOutline placed(const World& world, int body, int site) {
  if (body >= 0) return {world.bodies[body].outline.get(), world.bodies[body].initial.pose, 0};
  return {world.sites[site].outline.get(), told_pose(world.sites[site], 0.0), 1};
}

/// ", 0.02 m^2" by a stencil count; nothing where no GL context opens or there is no area.
std::string area_text(const Scene& scene, const Contact& c) {
  try {
    // A context for each overlap that is shown: this is a report, at most kOverlapsShown of them.
    PassRenderer renderer(scene.solver.field);
    const StencilOverlap overlap = stencil_overlap(renderer, placed(scene.world, c.body, -1),
                                                   placed(scene.world, c.other_body, c.other_site));
    // Overlaps shallower than a pixel, and wires, count none: the depth has been told.
    if (overlap.pixels == 0) return {};
    return fmt::format(", {:.3g} +- {:.1g} m^2 ({} pixels counted)", overlap.area, overlap.error,
                       overlap.pixels);
  } catch (const IoError&) {
    return {};
  }
}

void print_overlaps(const Scene& scene, const std::vector<Contact>& overlaps) {
  const World& world = scene.world;
  heading("Overlaps at the start");
  if (overlaps.empty()) fmt::print("  none\n");
  for (std::size_t i = 0; i < std::min(overlaps.size(), kOverlapsShown); ++i) {
    const Contact& c = overlaps[i];
    fmt::print("  {} '{}' and '{}' by {:.3g} m{} at ({:.6g}, {:.6g})\n",
               paint(stdout, Paint::bad, "warning:"), printable(world.bodies[c.body].name),
               printable(other_name(world, c)), -c.gap, area_text(scene, c), c.point.x(), c.point.y());
  }
  if (overlaps.size() > kOverlapsShown) fmt::print("  and {} more\n", overlaps.size() - kOverlapsShown);
}

}  // namespace

int check_command(const CheckArguments& arguments) {
  const Scene scene = load_scene(arguments.scene, arguments.overrides);
  // Planned by its constructor; nothing is run.
  const Simulator simulator(scene.world, scene.solver);
  print_contents(scene);
  heading("Plan");
  // What the kernel would do with these options: what it skips, and why.
  for (const std::string& line : simulator.plan().lines) fmt::print("  {}\n", printable(line));
  print_overlaps(scene, simulator.overlaps());
  return kDone;
}

}  // namespace brink
