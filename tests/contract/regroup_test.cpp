// Bodies that a response joins into one component, and parts again, at random collisions: every exact policy,
// and every run that was killed, gives the same bits.
#include <gtest/gtest.h>

#include "brink/core/base/hash.h"
#include "brink/scheduler/kernel/run_kernel.h"
#include "tests/fuzz/random_worlds_checks.h"

namespace brink::regroup_test {
namespace {

using worlds::from_environment;
using worlds::Told;

/// What nobody could foresee: after about every second collision some sets of bodies, the two of the
/// collision in the first of them.
Grouping at_random(std::uint64_t seed) {
  return [seed](const KernelView& view, const PairKey& pair) -> std::optional<std::vector<std::vector<int>>> {
    Random random(seed ^ (0x9e3779b97f4a7c15ULL * view.collisions()));
    if (random.below(2) == 0) return std::nullopt;
    std::vector<std::vector<int>> sets(random.below(3));
    for (std::vector<int>& set : sets) {
      set = {pair.body};
      if (&set == &sets.front() && !pair.with_site()) set.push_back(pair.other_body);
      if (&set != &sets.front()) set.front() = static_cast<int>(random.below(view.body_count()));
      while (random.below(2) == 0) set.push_back(static_cast<int>(random.below(view.body_count())));
    }
    return sets;
  };
}

/// A run with a response that groups bodies.
class GroupedRun {
 public:
  GroupedRun(const Scene& scene, const Grouping& grouping)
      : kernel_(scene.world, scene.solver), policy_(make_policy(scene.solver.policy)) {
    policy_->prepare(kernel_);
    kernel_.hold_to_certificates();
    kernel_.hold_to_known_contacts();
    kernel_.set_grouping(grouping);
  }

  void run(double until, Told& told, double checkpoints = -1.0, Recorder* also = nullptr) {
    worlds::Keeper keeper(told, also);
    RunOptions options;
    options.until = until;
    options.frame_interval = until / 16.0;
    options.checkpoint_seconds = checkpoints;
    kernel_.begin(options, &keeper);
    policy_->run(kernel_, until);
    kernel_.check_returned(until);
    kernel_.end();
    told.summary.termination = kernel_.halt() ? kernel_.halt()->termination : Termination::reached_end;
    told.summary.why = kernel_.halt() ? kernel_.halt()->why : "";
    told.summary.collisions = kernel_.collisions();
    told.summary.state_hash = hash();
  }
  std::uint64_t hash() const {
    StateHash h;
    h.add(kernel_.time());
    for (const BodyState& s : kernel_.states(kernel_.time())) h.add(s);
    return h.value();
  }
  std::uint64_t groupings() const { return kernel_.groupings(); }
  std::vector<BodyState> states() const { return kernel_.states(kernel_.time()); }
  std::vector<std::byte> snapshot() const { return kernel_.snapshot(); }
  void restore(std::span<const std::byte> bytes) { kernel_.restore(bytes); }

 private:
  RunKernel kernel_;
  std::unique_ptr<Policy> policy_;
};

/// In so many runs, each but the first in a program that knows the last by its snapshot alone.
Told killed(const Scene& scene, const Grouping& grouping, int parts) {
  Told told;
  std::vector<std::byte> left;
  for (int part = 1; part <= parts; ++part) {
    GroupedRun run(scene, grouping);
    if (!left.empty()) run.restore(left);
    run.run(scene.duration * part / parts, told);
    if (told.summary.termination != Termination::reached_end) break;
    left = run.snapshot();
  }
  return told;
}

/// From the first checkpoint after half of the events.
std::optional<Told> from_a_checkpoint(const Scene& scene, const Grouping& grouping) {
  Told whole;
  GroupedRun(scene, grouping).run(scene.duration, whole, 0.0);
  for (const Told::Checkpoint& c : whole.checkpoints) {
    if (2 * c.events < whole.events.size() || c.events == whole.events.size()) continue;
    GroupedRun again(scene, grouping);
    again.restore(c.state);
    Told told;
    again.run(scene.duration, told);
    return told;
  }
  return std::nullopt;
}

struct Count {
  std::uint64_t worlds = 0, collisions = 0, groupings = 0, wrong = 0;
  std::map<std::string, long> endings;
};

void examine(std::uint64_t seed, Count& count) {
  worlds::Taste taste;
  taste.hits = 30;
  const std::string text = worlds::random_world(seed, taste), name = "seed_" + std::to_string(seed) + ".toml";
  const auto scene_of = [&](const std::string& policy) {
    return parse_scene(text, name, {"solver.policy=" + policy, "solver.integrator=auto"});
  };
  const Grouping grouping = at_random(seed);
  const Scene scene = scene_of("body_clocks");
  outside::WatchOptions options;
  options.until = scene.duration;
  options.contact_tolerance = scene.solver.contact_tolerance;
  options.laws = false;
  outside::Watch watch(scene.world, options);
  GroupedRun reference(scene, grouping);
  Told told;
  reference.run(scene.duration, told, -1.0, &watch);
  ++count.worlds;
  count.collisions += told.summary.collisions;
  count.groupings += reference.groupings();
  ++count.endings[worlds::kind_of(told.summary.termination_text())];
  const auto blame = [&](const std::string& what) {
    ++count.wrong;
    testing::keep(name, text);
    ADD_FAILURE() << "seed " << seed << " (" << told.summary.termination_text() << "): " << what;
  };
  if (worlds::ended_by_watch(told.summary.why)) blame("ended by the watch");
  for (const std::string& f : watch.faults) blame("seen from outside: " + f);
  const auto compare = [&](const std::string& way, const Told& other) {
    if (const std::string what = worlds::difference(told, other); !what.empty()) blame(way + ": " + what);
  };
  for (const std::string& policy : exact_policies()) {
    const Scene by = scene_of(policy);
    compare(policy, killed(by, grouping, 1));
    compare(policy + ", killed", killed(by, grouping, 4));
    if (const auto again = from_a_checkpoint(by, grouping)) compare(policy + ", from a checkpoint", *again);
  }
}

// Joined and parted or not, bodies move the same, to the integrator's tolerance: two balls on a spring that
// swing and fall, and three that bounce, each in a lane of its own, so that no error is amplified.
TEST(Regroup, ThatDoesNotChangeThePhysicsKeepsTheTrajectories) {
  World world;
  world.gravity = {0.0, -9.81};
  testing::add(world, testing::site(make_segment({-20.0, 0.0}, {20.0, 0.0})));
  for (int k = 0; k < 5; ++k)
    testing::add(world, testing::body(make_disc(0.5), {3.0 * k, 2.0 + 0.37 * k}, {0.0, 0.1 * k}));
  SpringForce spring;
  spring.body_a = 0;
  spring.body_b = 1;
  spring.stiffness = 20.0;
  spring.rest_length = 3.0;
  world.forces.push_back(spring);
  for (const std::string& policy : exact_policies()) {
    Scene scene;
    scene.world = world;
    scene.solver.policy = policy;
    scene.solver.tolerance = 1e-11;
    scene.duration = 3.0;
    Told plain, grouped;
    GroupedRun never(scene, nullptr), often(scene, at_random(7));
    never.run(scene.duration, plain);
    often.run(scene.duration, grouped);
    EXPECT_GT(often.groupings(), 4U) << policy;
    ASSERT_EQ(grouped.events.size(), plain.events.size()) << policy;
    for (std::size_t k = 0; k < plain.events.size(); ++k)
      EXPECT_NEAR(grouped.events[k].contact.time, plain.events[k].contact.time, 1e-7) << policy;
    for (int k = 0; k < 5; ++k) {
      const BodyState a = never.states()[k], b = often.states()[k];
      EXPECT_LT((a.pose.position - b.pose.position).norm(), 1e-6) << policy << ", body " << k;
      EXPECT_LT((a.twist.velocity - b.twist.velocity).norm(), 1e-5) << policy << ", body " << k;
    }
  }
}

// A body with a thrust that has ended is driven by an integrator until it is parted from another, and flies
// freely then: so it does where it is restored, whoever was together there before.
TEST(Regroup, GroupsAreThoseOfTheSnapshotWhereverItIsRestored) {
  World world;
  for (int k = 0; k < 2; ++k)
    testing::add(world, testing::body(make_disc(0.5), {3.0 * k, 0.0}, {k == 0 ? 4.0 : 0.0, 0.0}));
  testing::add(world, testing::site(make_segment({9.0, -9.0}, {9.0, 9.0})));
  ThrustForce thrust;
  thrust.force = {0.1, 0.0};
  thrust.to = 0.2;
  world.forces.push_back(thrust);
  Scene scene;
  scene.world = world;
  scene.duration = 6.0;
  const Grouping grouping = [](const KernelView& view, const PairKey&) {
    const bool first = view.collisions() % 2 == 1;
    return std::optional(std::vector<std::vector<int>>(first ? 1 : 0, {0, 1}));
  };
  Told whole;
  GroupedRun reference(scene, grouping);
  reference.run(scene.duration, whole);
  ASSERT_GE(whole.events.size(), 3U);
  for (const double part : {0.1, 0.6, 1.2, 3.0, 5.0}) {
    GroupedRun first(scene, grouping), fresh(scene, grouping);
    Told told;
    first.run(part, told);
    for (GroupedRun* other : {&fresh, &reference}) {
      other->restore(first.snapshot());
      EXPECT_EQ(other->hash(), first.hash()) << "t = " << part;
      Told again;
      other->run(scene.duration, again);
      EXPECT_EQ(again.summary.state_hash, whole.summary.state_hash) << "t = " << part;
    }
  }
}

// BRINK_SEED moves the seeds, BRINK_WORLDS their number.
TEST(Regroup, AtRandomCollisionsGivesTheSameBitsInEveryWay) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1),
                      worlds = from_environment("BRINK_WORLDS", 40);
  Count count;
  for (std::uint64_t k = 0; k < worlds; ++k) {
    try {
      examine(first + k, count);
    } catch (const BadInput& e) {
      ++count.endings["refused"];
    }
  }
  std::cout << "seeds " << first << " .. " << first + worlds - 1 << ": " << count.collisions
            << " collisions, bodies grouped " << count.groupings << " times, " << count.wrong << " wrong\n";
  for (const auto& [what, n] : count.endings) std::cout << "  " << n << " x " << what << "\n";
  if (worlds >= 40) {
    EXPECT_GT(count.groupings, worlds);
  }
}

// Turned often, and on a wire as they joined: rounded to doubles there, they were on its other side.
TEST(Regroup, ABodyThatJoinsOthersInContactStaysOnItsSide) {
  Count count;
  for (const std::uint64_t seed : {36, 40}) examine(seed, count);
  EXPECT_GT(count.groupings, 0U);
}

}  // namespace
}  // namespace brink::regroup_test
