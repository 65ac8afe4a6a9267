// What is told of contacts that lasted: their stretches, modes and forces against statics and Coulomb's law, and the
// same under every policy and after every resume.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "brink/scenes/run_file/run_moment.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/simulator/simulator.h"
#include "tests/support/lasting_worlds.h"

namespace brink::contact_stretches_test {
namespace {

constexpr double g = 9.81;

/// Keeps contacts; those after the last checkpoint, at the end of a run, apart.
class Stretches final : public Recorder {
 public:
  void contact_lasted(const LastedContact& c) override { lasting.push_back(c); }
  void checkpoint(double, const std::vector<std::byte>&) override {
    ended.insert(ended.end(), lasting.begin(), lasting.end());
    lasting.clear();
  }
  std::vector<LastedContact> all() const {
    std::vector<LastedContact> both = ended;
    both.insert(both.end(), lasting.begin(), lasting.end());
    return both;
  }
  std::vector<LastedContact> ended, lasting;
};

struct Ran {
  Stretches told;
  std::vector<BodyState> states;
  RunSummary summary;
};

Ran run(const World& world, SolverOptions options, double until) {
  Ran ran;
  options.persistent = true;
  Simulator simulator(world, options);
  RunOptions to;
  to.until = until;
  to.checkpoint_seconds = -1.0;
  ran.summary = simulator.run(to, &ran.told);
  ran.states = simulator.states();
  return ran;
}

const std::string kFloor = R"([world]
gravity = [0, -9.81]
[materials.default]
restitution = 0
friction = 0.5
[[sites]]
name = "floor"
box = { width = 100, height = 1 }
position = [0, -0.5]
)";

Ran run(const std::string& bodies, double until) {
  return run(parse_scene(kFloor + bodies, "test").world, {}, until);
}

double sum(const std::vector<LastedContact>& contacts, double LastedContact::*what) {
  double total = 0.0;
  for (const LastedContact& c : contacts) total += c.*what;
  return total;
}

std::vector<LastedContact> of_mode(const std::vector<LastedContact>& all, ContactMode mode) {
  std::vector<LastedContact> out;
  std::copy_if(all.begin(), all.end(), std::back_inserter(out),
               [&](const auto& c) { return c.mode == mode; });
  return out;
}

// 2 kg at 3 m/s on mu = 0.5: it comes down from 1 cm with the friction of the impact, v = 3 - mu sqrt(2 g 0.01),
// slides for v / (mu g) and rests. Friction pulls it back, against the normal turned by +90 degrees: to the right
// of it is forward, so the force is > 0.
TEST(ContactStretches, ABlockSlidesAndRests) {
  const Ran ran = run(R"([[bodies]]
box = { width = 1, height = 0.5 }
mass = 2
position = [0, 0.26]
velocity = [3, 0]
)",
                      2.0);
  const auto slid = of_mode(ran.told.all(), ContactMode::slip),
             rested = of_mode(ran.told.all(), ContactMode::rest);
  ASSERT_EQ(slid.size(), 2U);
  const double down = std::sqrt(2.0 * g * 0.01), begin = down / g, v = 3.0 - 0.5 * down;
  for (const LastedContact& c : slid) {
    EXPECT_NEAR(c.from, begin, 1e-6);
    EXPECT_NEAR(c.to, begin + v / (0.5 * g), 1e-4);
    EXPECT_EQ(c.other_site, 0);
    EXPECT_NEAR(c.tangential_force, 0.5 * c.normal_force, 1e-6);
  }
  EXPECT_NEAR(sum(slid, &LastedContact::normal_force), 2.0 * g, 1e-6);
  ASSERT_EQ(rested.size(), 2U);
  EXPECT_EQ(ran.told.lasting.size(), 2U);
  for (const LastedContact& c : rested) {
    EXPECT_EQ(c.to, 2.0);
    EXPECT_NEAR(c.normal_force, g, 1e-6);
    EXPECT_NEAR(c.tangential_force, 0.0, 1e-6);
    EXPECT_NEAR(c.point.y(), 0.0, 1e-9);
    EXPECT_NEAR(std::abs(c.point.x() - ran.states[0].pose.position.x()), 0.5, 1e-9);
    EXPECT_NEAR((c.normal - Vec2(0, 1)).norm(), 0.0, 1e-12);
  }
}

// A disc that spins on the floor slips until its rim keeps up, then rolls for ever: omega R / 3 = v.
TEST(ContactStretches, ASpinningDiscSlipsThenRolls) {
  const Ran ran = run(R"([[bodies]]
disc = { radius = 0.5 }
position = [0, 0.51]
angular_velocity = -6
)",
                      2.0);
  const auto all = ran.told.all();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].mode, ContactMode::slip);
  EXPECT_EQ(all[1].mode, ContactMode::roll);
  EXPECT_EQ(all[0].to, all[1].from);
  EXPECT_EQ(all[1].to, 2.0);
  EXPECT_NEAR(ran.states[0].twist.velocity.x(), 1.0, 1e-6);
  EXPECT_NEAR(all[0].tangential_force, -0.5 * g, 1e-6);  // it drives the disc forward
  EXPECT_NEAR(all[1].tangential_force, 0.0, 1e-6);
}

/// Force and torque of all contacts on each body.
std::vector<Eigen::Vector3d> loads(const World& world, const std::vector<BodyState>& states,
                                   const std::vector<LastedContact>& contacts) {
  std::vector<Eigen::Vector3d> load(world.bodies.size(), Eigen::Vector3d::Zero());
  const auto press = [&](int body, const Vec2& force, const Vec2& at) {
    const Vec2 arm = at - states[static_cast<std::size_t>(body)].pose.position;
    load[static_cast<std::size_t>(body)] +=
        Eigen::Vector3d(force.x(), force.y(), arm.x() * force.y() - arm.y() * force.x());
  };
  for (const LastedContact& c : contacts) {
    const Vec2 turned(-c.normal.y(), c.normal.x());
    const Vec2 force = c.normal_force * c.normal + c.tangential_force * turned;
    press(c.body, force, c.point);
    if (c.other_body >= 0) press(c.other_body, -force, c.point);
  }
  return load;
}

// What presses on a body at rest carries its weight and does not turn it; friction is within its cone.
TEST(ContactStretches, ForcesOfAPileAtRestBalance) {
  const Scene scene = parse_scene(R"([world]
gravity = [0, -9.81]
[materials.default]
restitution = 0
friction = 0.5
[[sites]]
polyline = [[-1.5, 9], [-1.5, 0], [1.5, 0], [1.5, 9]]
radius = 0.1
[[bodies]]
disc = { radius = 0.25 }
mass = 2
position = [0, 0.2]
pile = { count = 40, width = 2.2 }
)",
                                  "test");
  const Ran ran = run(scene.world, {}, 10.0);
  ASSERT_EQ(ran.summary.termination_text(), "reached_end");
  ASSERT_GT(ran.summary.resting, 30U);
  const std::vector<Eigen::Vector3d> load = loads(scene.world, ran.states, ran.told.lasting);
  std::set<int> moving;  // of those forces are means over the last step
  for (const LastedContact& c : ran.told.lasting) {
    if (c.mode != ContactMode::rest) moving.insert({c.body, c.other_body});
    EXPECT_LE(std::abs(c.tangential_force), 0.5 * c.normal_force * (1.0 + 1e-6) + 1e-6);
  }
  int checked = 0;
  for (std::size_t k = 0; k < load.size(); ++k) {
    if (moving.contains(static_cast<int>(k))) continue;
    ++checked;
    EXPECT_LE((load[k] - Eigen::Vector3d(0.0, 2.0 * g, 0.0)).norm(), 1e-5) << "body " << k;
  }
  EXPECT_GT(checked, 20);
}

/// The same numbers, bit for bit.
bool same(const LastedContact& a, const LastedContact& b) {
  return a.from == b.from && a.to == b.to && a.mode == b.mode && a.body == b.body &&
         a.other_body == b.other_body && a.other_site == b.other_site && a.sample == b.sample &&
         a.site == b.site && a.sample_on_body == b.sample_on_body && a.point == b.point &&
         a.normal == b.normal && a.normal_force == b.normal_force && a.tangential_force == b.tangential_force;
}

void expect_same(const std::vector<LastedContact>& a, const std::vector<LastedContact>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) ASSERT_TRUE(same(a[k], b[k])) << "row " << k;
}

constexpr std::uint64_t kWorlds = 8;

TEST(ContactStretches, OfOneContactDoNotOverlapInTime) {
  std::size_t rows = 0;
  for (std::uint64_t seed = 0; seed < kWorlds; ++seed) {
    const testing::LastingWorld w = testing::LastingWorldMaker(seed).make();
    std::map<std::tuple<int, int, int, bool, int, int>, double> until;
    const Ran ran = run(w.world, {}, w.duration);
    for (const LastedContact& c : ran.told.all()) {
      ++rows;
      EXPECT_LT(c.from, c.to);
      EXPECT_GT(c.normal_force, 0.0);
      EXPECT_NE(c.mode, ContactMode::none);
      double& before = until[{c.body, c.other_body, c.other_site, c.sample_on_body, c.sample, c.site}];
      EXPECT_GE(c.from, before) << "seed " << seed;
      before = c.to;
    }
  }
  EXPECT_GT(rows, 200U);
}

TEST(ContactStretches, AreTheSameUnderEveryPolicy) {
  for (std::uint64_t seed = 0; seed < kWorlds; ++seed) {
    SCOPED_TRACE(seed);
    const testing::LastingWorld w = testing::LastingWorldMaker(seed).make();
    SolverOptions options;
    const std::vector<LastedContact> reference = run(w.world, options, w.duration).told.all();
    for (const std::string& policy : exact_policies()) {
      if (policy == SolverOptions().policy) continue;  // the reference
      SCOPED_TRACE(policy);
      options.policy = policy;
      expect_same(reference, run(w.world, options, w.duration).told.all());
    }
  }
}

// What a run tells before its last checkpoint, and then one that goes on from there.
TEST(ContactStretches, AreTheSameAfterAResume) {
  constexpr std::uint64_t seed = 77;
  Random random(seed);
  for (std::uint64_t k = 0; k < kWorlds; ++k) {
    const testing::LastingWorld w = testing::LastingWorldMaker(k).make();
    const double stop = random.uniform(0.1, 0.9) * w.duration;
    SCOPED_TRACE("world " + std::to_string(k) + ", stopped at " + std::to_string(stop));
    SolverOptions options;
    options.persistent = true;
    Simulator first(w.world, options), second(w.world, options);
    RunOptions to;
    to.checkpoint_seconds = -1.0;
    Stretches before, after;
    to.until = stop;
    first.run(to, &before);
    second.restore(first.snapshot());
    to.until = w.duration;
    to.first_frame = false;
    second.run(to, &after);
    std::vector<LastedContact> both = before.ended;
    const std::vector<LastedContact> rest = after.all();
    both.insert(both.end(), rest.begin(), rest.end());
    expect_same(run(w.world, options, w.duration).told.all(), both);
  }
}

// What pictures draw: lines from the centres to the point between two discs, to the floor, to a wall's thickness.
TEST(ContactStretches, ArmsOfDrawnForcesReachTheContacts) {
  const Scene scene = parse_scene(kFloor + R"([[bodies]]
name = "low"
box = { width = 2, height = 1 }
position = [3, 0.5]
[[bodies]]
name = "high"
disc = { radius = 0.25 }
position = [3.5, 1.25]
)",
                                  "test");
  RunMoment moment{0.0, scene.world, {}, {scene.world.sites[0].pose}, {}};
  for (const Body& body : scene.world.bodies) moment.bodies.push_back(body.initial);
  LastedContact on_floor, between;
  on_floor.body = 0, on_floor.other_site = 0, on_floor.normal_force = 7.0;
  between.body = 0, between.other_body = 1, between.sample_on_body = false, between.normal_force = 3.0;
  on_floor.sample = between.sample = 0;
  const auto site_at = [](const Outline& outline, double y) {  // the horizontal side at that height
    for (std::size_t k = 0; k < outline.sites.size(); ++k)
      if (outline.sites[k].a.y() == y && outline.sites[k].b.y() == y) return static_cast<int>(k);
    return -1;
  };
  on_floor.site = site_at(*scene.world.sites[0].outline, 0.5);
  between.site = site_at(*scene.world.bodies[0].outline, 0.5);
  moment.contacts = {on_floor, between};
  const std::vector<DrawnForce> drawn = forces_of(moment);
  ASSERT_EQ(drawn.size(), 3U);
  EXPECT_EQ(drawn[0].body, 0);
  EXPECT_EQ(drawn[0].newtons, 7.0);
  EXPECT_NEAR(std::abs(drawn[0].arm.x()), 1.0, 1e-15);
  EXPECT_NEAR(drawn[0].arm.y(), -0.5, 1e-15);
  EXPECT_NEAR((drawn[1].arm - Vec2(0.5, 0.5)).norm(), 0.0, 1e-15);
  EXPECT_EQ(drawn[2].body, 1);
  EXPECT_NEAR((drawn[2].arm - Vec2(0.0, -0.25)).norm(), 0.0, 1e-15);
  moment.contacts[0].sample = 99;
  EXPECT_THROW(forces_of(moment), BadInput);
}

}  // namespace
}  // namespace brink::contact_stretches_test
