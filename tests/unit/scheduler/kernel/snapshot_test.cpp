// Snapshots: whatever is wrong with them is told before anything changes.
#include "brink/scheduler/kernel/snapshot.h"

#include <gtest/gtest.h>

#include "brink/core/base/error.h"
#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::snapshot_test {
namespace {

using namespace testing;

TEST(Snapshot, GoesOnWithTheSameBitsAndRefusesEveryShorterOne) {
  Simulator a(on_a_spring(), {}), b(on_a_spring(), {});
  a.run(until(1.5));
  const std::vector<std::byte> bytes = a.snapshot();
  const std::uint64_t before = b.state_hash();
  for (std::size_t n = 0; n < bytes.size(); n += 7)
    EXPECT_THROW(b.restore({bytes.data(), n}), BadInput) << n << " of " << bytes.size() << " bytes";
  EXPECT_EQ(b.state_hash(), before);
  EXPECT_EQ(b.time(), 0.0);
  b.restore(bytes);
  EXPECT_EQ(b.state_hash(), a.state_hash());
  a.run(until(4.0));
  b.run(until(4.0));
  EXPECT_EQ(b.state_hash(), a.state_hash());
}

TEST(Snapshot, DamagedInAnyByteIsRefusedAndChangesNothing) {
  World world;
  world.gravity = {0.0, -10.0};
  world.materials[0].restitution = 0.0;
  add(world, body(make_box(1.0, 1.0), {0.0, 0.5}, {0.0, 0.0}));
  add(world, body(make_box(1.0, 1.0), {0.0, 1.6}, {0.1, 0.0}));
  add(world, site(make_segment({-9, 0}, {9, 0})));
  Simulator a(world, {});
  a.run(until(1.0));
  const std::vector<std::byte> bytes = a.snapshot();
  Simulator b(world, {});
  const std::uint64_t before = b.state_hash();
  for (std::size_t n = 0; n < bytes.size(); ++n)
    for (const unsigned char flip : {0x01, 0x10, 0x80, 0xff}) {
      std::vector<std::byte> damaged = bytes;
      damaged[n] ^= static_cast<std::byte>(flip);
      EXPECT_THROW(b.restore(damaged), BadInput) << "byte " << n;
    }
  EXPECT_EQ(b.state_hash(), before);
  b.restore(bytes);
  EXPECT_EQ(b.state_hash(), a.state_hash());
}

// What decides the motion must be the same: materials, forces, periods, geometry, detector, seed.
TEST(Snapshot, OfAnotherWorldIsRefused) {
  Simulator a(on_a_spring(), {});
  a.run(until(0.5));
  const std::vector<std::byte> bytes = a.snapshot();
  const auto refuses = [&](const char* what, auto&& change) {
    World world = on_a_spring();
    SolverOptions options;
    change(world, options);
    Simulator b(world, options);
    EXPECT_THROW(b.restore(bytes), BadInput) << what;
  };
  refuses("material", [](World& w, SolverOptions&) { w.materials[0].restitution = 0.5; });
  refuses("force", [](World& w, SolverOptions&) { std::get<SpringForce>(w.forces[0]).stiffness = 3.0; });
  refuses("period", [](World& w, SolverOptions&) {
    w.sites.clear();
    w.periods.size = {40.0, 40.0};
  });
  refuses("geometry", [](World& w, SolverOptions&) { w.bodies[2].outline = outline(make_disc(0.4)); });
  refuses("mass", [](World& w, SolverOptions&) { w.bodies[2].mass = 2.0; });
  refuses("site", [](World& w, SolverOptions&) { w.sites[0].pose.position.x() = 1.0; });
  refuses("seed", [](World&, SolverOptions& o) { o.seed = 2; });
  refuses("detector", [](World&, SolverOptions& o) { o.detector = "pass"; });
  refuses("integrator", [](World&, SolverOptions& o) { o.integrator = "erk"; });
}

}  // namespace
}  // namespace brink::snapshot_test
