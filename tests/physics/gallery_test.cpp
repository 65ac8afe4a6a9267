// Every scene of the gallery: it parses, starts without overlaps, runs, and keeps what physics says is kept.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "brink/core/world/forces.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink::gallery_test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> gallery() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(BRINK_SOURCE_DIR) / "scenes" / "gallery"))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// How long a scene runs here: a share of its duration that holds collisions in every scene.
constexpr double kShare = 0.2;

bool sites_stand_still(const World& world) {
  return std::all_of(world.sites.begin(), world.sites.end(), [](const FixedSite& site) {
    return std::holds_alternative<std::monostate>(site.motion);
  });
}

/// True if no pair of materials can lose energy: restitution 1, and no friction or the elastic rough law
/// without a limit.
bool collisions_keep_energy(const World& world) {
  std::set<int> used;
  for (const Body& body : world.bodies) used.insert(body.material);
  for (const FixedSite& site : world.sites) used.insert(site.material);
  for (const int a : used)
    for (const int b : used) {
      const Material pair = combined(world, a, b);
      if (pair.restitution != 1.0) return false;
      if (pair.friction != 0.0 && !(pair.tangential_restitution == 1.0 && pair.friction >= 1e5)) return false;
    }
  return true;
}

/// What can slip between a body's particles [m].
double widest_gap_of(const World& world) {
  double widest = 0.0;
  for (const Body& body : world.bodies)
    widest = std::max(widest, widest_gap(*body.outline, make_particles(*body.outline, body.sampling)));
  return widest;
}

bool left_to_itself(const World& world) {
  return world.sites.empty() && world.gravity.isZero() && world.forces.empty();
}

class Gallery : public ::testing::TestWithParam<fs::path> {};

TEST_P(Gallery, SceneIsSoundAtTheStart) {
  const Scene scene = load_scene(GetParam());
  EXPECT_FALSE(scene.world.title.empty());
  EXPECT_GT(scene.world.bodies.size(), 0U);
  const Simulator simulator(scene.world, scene.solver);
  for (const Contact& overlap : simulator.overlaps())
    ADD_FAILURE() << scene.world.bodies[overlap.body].name << " overlaps by " << -overlap.gap << " m with "
                  << (overlap.other_body >= 0 ? scene.world.bodies[overlap.other_body].name
                                              : scene.world.sites[overlap.other_site].name);
}

TEST_P(Gallery, RunKeepsWhatIsConserved) {
  const Scene scene = load_scene(GetParam());
  const World& world = scene.world;
  Simulator simulator(world, scene.solver);
  const Momentum before = total_momentum(world, simulator.states());
  RunOptions options;
  options.until = kShare * scene.duration;
  options.frame_interval = options.until / 20.0;
  const RunSummary summary = simulator.run(options);

  EXPECT_EQ(summary.termination, Termination::reached_end) << summary.termination_text();
  EXPECT_GT(summary.collisions + summary.contacts_lasting, 0U);
  // nothing is ever allowed into anything by more than the contact tolerance; the classic detector knows what
  // is at its samples alone: it is held to what fits between them
  const double slips = scene.solver.detector == "depth" ? widest_gap_of(world) : 0.0;
  EXPECT_LE(summary.max_overlap,
            std::max(slips, scene.solver.contact_tolerance * std::max(1.0, world.length())));
  for (const BodyState& state : simulator.states())
    EXPECT_TRUE(state.pose.position.allFinite() && state.twist.velocity.allFinite());

  // adaptive integrators keep energy to about their tolerance a second; closed forms to rounding
  if (conservative(world) && collisions_keep_energy(world) && sites_stand_still(world)) {
    const bool closed_forms = world.forces.empty() && scene.solver.integrator == "auto";
    const double allowed = closed_forms ? 1e-13 * static_cast<double>(10 + summary.collisions) : 1e-6;
    EXPECT_NEAR(summary.energy_final, summary.energy_initial, allowed * std::abs(summary.energy_initial));
  }
  if (left_to_itself(world)) {
    EXPECT_NEAR((summary.momentum - before.linear).norm(), 0.0, 1e-12 * before.linear.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Gallery, ::testing::ValuesIn(gallery()),
                         [](const auto& file) { return file.param.stem().string(); });

// Stones with corners slide past each other's corners all the time: five times its duration ended at 14.24 s once.
TEST(DrumWithFriction, TurnsOnPastItsEndWithNobodyInAnybodyElse) {
  const Scene scene =
      load_scene(fs::path(BRINK_SOURCE_DIR) / "scenes" / "gallery" / "drum_with_friction.toml");
  Simulator simulator(scene.world, scene.solver);
  RunOptions options;
  options.until = 5.0 * scene.duration;
  options.frame_interval = 0.01;
  options.checkpoint_seconds = -1.0;
  const RunSummary summary = simulator.run(options);
  EXPECT_TRUE(summary.sound()) << summary.termination_text();
  EXPECT_DOUBLE_EQ(summary.end_time, options.until);
}

TEST(GalleryFolder, HoldsScenesAndEveryRuleOfConservationHasOne) {
  // so that no check above is idle
  int energy = 0, momentum = 0;
  for (const fs::path& file : gallery()) {
    const World world = load_scene(file).world;
    energy += conservative(world) && collisions_keep_energy(world) && sites_stand_still(world);
    momentum += left_to_itself(world);
  }
  EXPECT_GE(gallery().size(), 14U);
  EXPECT_GE(energy, 10);
  EXPECT_GE(momentum, 1);
}

}  // namespace
}  // namespace brink::gallery_test
