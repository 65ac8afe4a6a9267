// What is seen of a run between its frames is what happened: states read from the run file, and those that the replay page
// shows in a real browser, beside a simulation to the same times.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "brink/core/base/limits.h"
#include "brink/core/base/printable.h"
#include "brink/core/base/random.h"
#include "brink/core/shapes/distance.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/run_scene.h"
#include "brink/scenes/view/replay_page.h"
#include "brink/scheduler/simulator/simulator.h"
#include "tests/support/browser.h"

namespace brink::replay_page_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

// Frames are rare; between two of them most bodies bounce several times.
const char* const kScene = R"(
title = "a </script> box & a piston"
[world]
duration = 3.0
gravity = [0.5, -9.0]
[output]
frame_interval = 0.5
[materials.default]
restitution = 0.9
[[sites]]
name = "room"
box = { width = 4.0, height = 3.0 }
inside_of = true
position = [0, 1.5]
[[sites]]
name = "piston"
segment = [[-0.5, 0], [0.5, 0]]
position = [0, 0.2]
motion = { velocity = [0, 0.3] }
[[bodies]]
name = "ball"
disc = { radius = 0.2 }
position = [-1.0, 1.5]
velocity = [1.0, 0]
angular_velocity = 3.0
grid = { columns = 3, rows = 2, spacing = [0.8, 0.7] }
[[bodies]]
name = "plate"
box = { width = 0.5, height = 0.2 }
position = [1.4, 2.5]
angle_deg = 30
angular_velocity = -4.0
)";

class Replayed : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / fmt::format("brink-replay-{}", ::getpid());
    scene_ = parse_scene(kScene, "replayed.toml");
    RunRequest request;
    request.dir = folder_;
    ASSERT_TRUE(run_scene(scene_, request).summary.sound());
    Random random(5);
    for (int k = 0; k < 1000; ++k) times_.push_back(scene_.duration * random.uniform());
    std::sort(times_.begin(), times_.end());
    Simulator simulator(scene_.world, scene_.solver);
    RunOptions options;
    options.checkpoint_seconds = -1.0;
    for (const double t : times_) {
      options.until = t;
      simulator.run(options);
      states_.push_back(simulator.states());
    }
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static fs::path run_file() { return folder_ / "run.db"; }

  static double difference(const BodyState& a, const BodyState& b) {
    return std::max({(a.pose.position - b.pose.position).norm(), std::abs(a.pose.angle - b.pose.angle),
                     (a.twist.velocity - b.twist.velocity).norm(), std::abs(a.twist.omega - b.twist.omega)});
  }

  static inline fs::path folder_;
  static inline Scene scene_;
  static inline std::vector<double> times_;
  static inline std::vector<std::vector<BodyState>> states_;
};

TEST_F(Replayed, TheRunFileKnowsEveryStateBetweenItsFrames) {
  const RunFile run(run_file());
  double worst = 0.0;
  for (std::size_t k = 0; k < times_.size(); ++k) {
    const auto seen = run.states_at(times_[k]).states;
    for (std::size_t b = 0; b < seen.size(); ++b) worst = std::max(worst, difference(seen[b], states_[k][b]));
  }
  std::printf("%zu events, %lld frames; largest difference at 1000 times %.1e\n", run.events().size(),
              static_cast<long long>(run.frame_count()), worst);
  EXPECT_GT(run.events().size(), 50U);
  EXPECT_LT(worst, 1e-11);
}

TEST_F(Replayed, EventsTellTwistsBeforeAndAfterOfBothOwners) {
  const auto bodies = RunFile(run_file()).bodies();
  int seen = 0;
  for (const Event& e : RunFile(run_file()).events()) {
    if (e.kind != EventKind::collision) continue;
    ASSERT_TRUE(e.body.known);
    ASSERT_EQ(e.other.known, e.contact.other_body >= 0);
    const Vec2 impulse = e.impulse_n * e.contact.normal + e.impulse_t * perp(e.contact.normal);
    const auto gained = [&](int k, const EventSide& s) {
      return Vec2(bodies[k].mass * (s.after.twist.velocity - s.before.velocity));
    };
    EXPECT_LT((gained(e.contact.body, e.body) - impulse).norm(), 1e-12 * (1.0 + impulse.norm()));
    if (e.other.known) {
      EXPECT_LT((gained(e.contact.other_body, e.other) + impulse).norm(), 1e-12 * (1.0 + impulse.norm()));
    }
    ++seen;
  }
  EXPECT_GT(seen, 50);
}

// What the tables of a run that goes on say is of one moment: another frame, written meanwhile, is not seen.
TEST_F(Replayed, WhatIsReadOfARunThatGoesOnIsOfOneMoment) {
  const fs::path folder = folder_ / "going";
  RunFileRecorder recorder(folder, scene_, RunFileRecorder::Open::fresh);
  const auto states = states_.front();
  const auto frame = [&](double t) {
    recorder.frame(t, states);
    recorder.checkpoint(t, {});  // commits
  };
  frame(0.0);
  RunFile held(folder / "run.db"), other(folder / "run.db");
  held.hold();
  frame(0.5);
  EXPECT_EQ(held.frame_count(), 1);
  EXPECT_EQ(other.frame_count(), 2);
  int seen = 0;
  held.each_frame(1, [&](const RunFile::Frame&) { ++seen; });
  EXPECT_EQ(seen, 1);
}

TEST_F(Replayed, PicturesOfARunAreDrawnByItsOwnFieldOptions) {
  const fs::path folder = folder_ / "field";
  const Scene scene = parse_scene(kScene, "field.toml", {"field.primitives=mesh", "field.mesh_error=0.4"});
  RunRequest request;
  request.dir = folder;
  request.until = 0.1;
  run_scene(scene, request);
  const FieldOptions field = RunFile(folder / "run.db").field_options();
  EXPECT_EQ(field.primitives, "mesh");
  EXPECT_EQ(field.mesh_error, 0.4);
  EXPECT_EQ(RunFile(run_file()).field_options().primitives, "exact");
}

/// A fact of the page's table.
std::string fact_of(const json& data, const std::string& name) {
  for (const json& fact : data["about"]["facts"])
    if (fact[0] == name) return fact[1];
  return {};
}

// A body driven by an integrator between rare frames, with attraction: what the page says it is off by, and its energy.
TEST(Replay, SaysHowFarItIsOffBetweenFramesAndCountsAttraction) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("brink-off-{}", ::getpid());
  const Scene scene = parse_scene(R"(
[world]
duration = 4.0
[output]
frame_interval = 0.1
[[bodies]]
name = "moon"
disc = { radius = 0.1 }
mass = 2.0
position = [1.0, 0.0]
velocity = [0.0, 1.1]
[[forces]]
kind = "attract"
center = [0.0, 0.0]
strength = 1.0
power = -2.0
)",
                                  "moon.toml");
  RunRequest request;
  request.dir = folder;
  const RunSummary summary = run_scene(scene, request).summary;
  const RunFile run(folder / "run.db");
  Simulator simulator(scene.world, scene.solver);
  RunOptions options;
  options.checkpoint_seconds = -1.0;
  double worst = 0.0;
  for (int k = 1; k < 400; ++k) {
    options.until = 0.01 * k;
    simulator.run(options);
    const BodyState seen = run.states_at(options.until).states[0], is = simulator.states()[0];
    worst = std::max(worst, (seen.pose.position - is.pose.position).norm());
  }
  const json data = json::parse(replay_page_data(folder / "run.db", {}, false));
  fs::remove_all(folder);
  const std::string words = fact_of(data, "between frames");
  double told = 0.0;
  ASSERT_EQ(std::sscanf(words.c_str(), "places to about %lg m", &told), 1) << words;
  std::printf("off by %.2e m, told: %s\n", worst, words.c_str());
  EXPECT_GT(told, 0.5 * worst);
  EXPECT_LT(told, 3.0 * worst);
  const json& energies = data["about"]["curves"][0]["names"];
  EXPECT_EQ(energies, json({"kinetic", "of attraction", "sum"}));
  EXPECT_LT(summary.energy_final, 0.0);  // bound: kinetic energy alone would be above zero
}

// ---- the page

using testing::has_browser;
using testing::in_browser;
using testing::text_of;

TEST_F(Replayed, ThePageIsOneFileThatNeedsNoOther) {
  const fs::path page = folder_ / "alone.html";
  write_replay_page(run_file(), page);
  const std::string text = text_of(page);
  for (const char* of_others : {"<script src", "<link", "<img", "@import", "url(http"})
    EXPECT_THAT(text, Not(HasSubstr(of_others)));
  EXPECT_THAT(text, Not(HasSubstr("a </script> box"))) << "text of a scene is data";
}

TEST_F(Replayed, ThePageShowsTheStatesOfTheRun) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const fs::path page = folder_ / "page.html";
  write_replay_page(run_file(), page);
  const json answer =
      in_browser(page, "const b = window.brink, times = " + json(times_).dump() +
                           "; return {states: times.map(t => b.state(t)), events: b.events, duration: "
                           "b.duration, title: document.title};");
  ASSERT_FALSE(answer.contains("error")) << answer.dump();
  EXPECT_EQ(answer["title"], scene_.world.title);
  EXPECT_EQ(answer["duration"], scene_.duration);
  double worst = 0.0;
  for (std::size_t k = 0; k < times_.size(); ++k)
    for (std::size_t b = 0; b < states_[k].size(); ++b) {
      const json& s = answer["states"][k][b];
      EXPECT_EQ(s["name"], scene_.world.bodies[b].name);
      const auto number = [&s](const char* name) { return s[name].get<double>(); };
      BodyState seen;
      seen.pose = {Vec2(number("x"), number("y")), number("angle")};
      seen.twist = {Vec2(number("vx"), number("vy")), number("omega")};
      worst = std::max(worst, difference(seen, states_[k][b]));
    }
  std::printf("largest difference between page and simulation at 1000 times: %.1e\n", worst);
  EXPECT_LT(worst, 1e-9);
  const auto events = RunFile(run_file()).events();
  ASSERT_EQ(answer["events"].size(), events.size());
  for (std::size_t k = 0; k < events.size(); ++k) {
    EXPECT_EQ(answer["events"][k]["t"], events[k].contact.time);
    EXPECT_EQ(answer["events"][k]["kind"], to_string(events[k].kind));
  }
}

// Title and names are shown as the program shows them; programs get names as they are.
TEST(Replay, WhatTurnsTheReadingDirectionIsShownAsAnEscape) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  std::string name = (fs::temp_directory_path() / "brink-shown-XXXXXX").string();
  const fs::path folder = ::mkdtemp(name.data());
  const Scene scene = parse_scene(
      "title = \"run \\u202egnp.exe\\nof two\"\n[world]\nduration = 0.2\n"
      "[[bodies]]\nname = \"a\\u2066b\"\ndisc.radius = 0.5\nvelocity = [10, 0]\n"
      "[[bodies]]\nname = \"c\\u0007d\"\ndisc.radius = 0.5\nposition = [2, 0]\n",
      "shown");
  RunRequest request;
  request.dir = folder;
  run_scene(scene, request);
  write_replay_page(folder / "run.db", folder / "page.html");
  const json answer =
      in_browser(folder / "page.html",
                 "const b = window.brink, on = id => document.getElementById(id); b.seek(b.duration); "
                 "b.player.showEvents();"
                 "return {title: document.title, head: on('title').textContent, who: on('who').textContent,"
                 " events: on('events').textContent, names: b.state(0).map(s => s.name)};");
  fs::remove_all(folder);
  ASSERT_FALSE(answer.contains("error")) << answer.dump();
  EXPECT_EQ(answer["title"], printable(scene.world.title));
  EXPECT_EQ(answer["head"], "run \\u202egnp.exe\\nof two");
  EXPECT_THAT(answer["who"], HasSubstr("a\\u2066bc\\x07d"));
  EXPECT_THAT(answer["events"], HasSubstr("c\\x07d"));
  for (int k = 0; k < 2; ++k) EXPECT_EQ(answer["names"][k], scene.world.bodies[k].name);
}

TEST_F(Replayed, ThePageStepsFromEventToEventAndPlays) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const fs::path page = folder_ / "steps.html";
  write_replay_page(run_file(), page);
  const json answer = in_browser(page,
                                 "const b = window.brink, on = [], back = []; b.seek(0);"
                                 "for (let k = 0; k < 10; ++k) { b.step(1); on.push(b.time()); }"
                                 "for (let k = 0; k < 9; ++k) { b.step(-1); back.push(b.time()); }"
                                 "b.seek(-5); const low = b.time(); b.seek(1e9); const high = b.time();"
                                 "b.seek(NaN); b.seek(undefined); const still = b.time();"
                                 "b.play(); const playing = b.player.playing; b.pause();"
                                 "return {on, back, low, high, still, playing, paused: !b.player.playing};");
  ASSERT_FALSE(answer.contains("error")) << answer.dump();
  std::vector<double> times;
  for (const Event& e : RunFile(run_file()).events())
    if (times.empty() || e.contact.time != times.back()) times.push_back(e.contact.time);
  for (int k = 0; k < 10; ++k) EXPECT_EQ(answer["on"][k], times[k]);
  for (int k = 0; k < 9; ++k) EXPECT_EQ(answer["back"][k], times[8 - k]);
  EXPECT_EQ(answer["low"], 0.0);
  EXPECT_EQ(answer["high"], scene_.duration);
  EXPECT_EQ(answer["still"], scene_.duration) << "what is no number leads nowhere";
  EXPECT_TRUE(answer["playing"] && answer["paused"]);
}

TEST_F(Replayed, ALongRunIsThinnedAndThePageSaysSo) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const fs::path page = folder_ / "thin.html";
  ReplayLimits few;
  few.frame_rows = 20;
  few.events = 5;
  write_replay_page(run_file(), page, few);
  const json answer = in_browser(
      page,
      "return {notice: document.getElementById('notice').textContent, events: window.brink.events.length};");
  ASSERT_FALSE(answer.contains("error")) << answer.dump();
  EXPECT_THAT(answer["notice"].get<std::string>(), HasSubstr("every 3. frame"));
  EXPECT_THAT(answer["notice"].get<std::string>(), HasSubstr("the first 5 events"));
  EXPECT_EQ(answer["events"], 5);
}

// Every kind of site: points, segments and arcs, with and without thickness, open and closed, corners both ways.
const char* const kCells = R"(
[world]
duration = 0.01
[[sites]]
name = "wire"
polyline = [[-2.6, -1.9], [-2.7, 0.4], [-2.0, 1.8]]
[[sites]]
name = "thick"
segment = [[-1.5, -1.8], [0.8, -1.6]]
radius = 0.1
[[sites]]
name = "arc"
arc = { center = [2.0, -1.0], radius = 0.8, from_deg = -40, to_deg = 210 }
[[bodies]]
name = "bracket"
polygon = { vertices = [[0, 0], [1.2, 0], [1.2, 0.4], [0.4, 0.4], [0.4, 1.1], [0, 1.1]] }
position = [-1.2, 0.3]
angle_deg = 25
[[bodies]]
name = "rounded"
box = { width = 0.7, height = 0.5, radius = 0.12 }
position = [0.6, 1.2]
angle_deg = -35
[[bodies]]
name = "frame"
path = { d = "M0 0 C0.6 -0.4 1.2 0.3 1.0 0.9 S0.1 1.1 0 0 Z M0.4 0.3 H0.8 V0.7 H0.4 Z" }
position = [1.6, 0.5]
[[bodies]]
name = "disc"
disc = { radius = 0.15 }
position = [0.2, -0.6]
grid = { columns = 2, rows = 1, spacing = [0.6, 0.5] }
[[bodies]]
name = "capsule"
capsule = { length = 0.8, radius = 0.1 }
position = [-0.4, -1.0]
angle_deg = 70
[[bodies]]
name = "loose"
chain = { vertices = [[0, 0], [0.5, 0.1], [0.3, 0.5]], closed = false, radius = 0.05 }
position = [-1.9, -0.8]
)";

// A crowd of many kinds: outlines that do not hold their centre of mass, wires, and one that is larger than all others.
const char* const kCrowd = R"(
[world]
duration = 0.01
seed = 4
[[sites]]
name = "room"
box = { width = 8.0, height = 6.0 }
inside_of = true
[[sites]]
name = "wire"
polyline = [[-3.9, -1.0], [-3.0, 0.4], [-3.2, 1.8]]
[[bodies]]
name = "horseshoe"
polygon = { vertices = [[-1, -0.8], [1, -0.8], [1, 0.8], [0.8, 0.8], [0.8, -0.6], [-0.8, -0.6], [-0.8, 0.8], [-1, 0.8]] }
position = [1.5, 1.0]
angle_deg = 20
[[bodies]]
name = "disc"
disc = { radius = 0.06 }
scatter = { count = 120, region = [[-2.7, -2.8], [0.2, 2.8]] }
[[bodies]]
name = "box"
box = { width = 0.3, height = 0.1, radius = 0.02 }
scatter = { count = 60, region = [[-2.7, -2.8], [0.2, 2.8]] }
[[bodies]]
name = "triangle"
polygon = { vertices = [[0, 0], [0.3, 0], [0.1, 0.2]] }
scatter = { count = 40, region = [[-2.7, -2.8], [0.2, 2.8]] }
[[bodies]]
name = "bow"
chain = { vertices = [[0, 0], [0.3, 0.1], [0.4, 0.4]], closed = false, radius = 0.01 }
scatter = { count = 20, region = [[-2.7, -2.8], [0.2, 2.8]] }
)";

/// Of 3000 pixels of each of some views of a scene: how many are in the cell of somebody farther than another, and by how much a
/// distance is off, in hundredths of a pixel.
std::pair<int, double> cells_beside_distances(const char* text) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("brink-cells-{}", ::getpid());
  const Scene scene = parse_scene(text, "cells.toml");
  RunRequest request;
  request.dir = folder;
  run_scene(scene, request);
  write_replay_page(folder / "run.db", folder / "cells.html");
  const json answer = in_browser(folder / "cells.html", R"(
    const p = window.brink.player.picture, seen = [];
    p.resize({getBoundingClientRect: () => ({width: 800, height: 600})});
    p.layers.cells = true;
    for (const [x, y, closer] of [[0, 0, 1], [-1, 0.5, 4], [1.5, 0.9, 3], [-1.2, -1.0, 0.4]]) {
      p.fit();
      Object.assign(p.view, closer === 1 ? {} : {x, y, scale: closer * p.view.scale});
      p.draw(0);
      for (let k = 0; k < 3000; ++k) {
        const column = (k * 331) % 800, row = (k * 197) % 600, cell = p.cells.at(column, row);
        const [x, y] = p.toWorld(column + 0.5, 600 - row - 0.5);
        seen.push([x, y, 1 / p.view.scale, cell ? cell.owner : -1, cell ? cell.distance : 0]);
      }
    }
    const [x0, y0, x1, y1] = p.about.extent;
    const within = ([x, y]) => !p.closed || (x > x0 && x < x1 && y > y0 && y < y1);
    return {seen: seen.filter(within)};)");
  fs::remove_all(folder);
  EXPECT_FALSE(answer.contains("error")) << answer.dump();
  if (answer.contains("error")) return {-1, kForever};
  std::vector<std::pair<const Outline*, Frame>> owners;  // sites first, as the page counts
  for (const FixedSite& s : scene.world.sites) owners.emplace_back(s.outline.get(), Frame(s.pose));
  for (const Body& b : scene.world.bodies) owners.emplace_back(b.outline.get(), Frame(b.initial.pose));
  int of_others = 0;
  double off = 0.0;
  for (const json& s : answer["seen"]) {
    std::vector<std::pair<double, int>> by_distance;
    for (std::size_t k = 0; k < owners.size(); ++k) {
      double nearest = kForever;  // from outside: to any site, less its thickness
      const Vec2 q = owners[k].second.to_local(Vec2(s[0], s[1]));
      for (const Site& site : owners[k].first->sites)
        nearest = std::min(nearest, nearest_on(site, q).distance - site.radius);
      by_distance.emplace_back(nearest, static_cast<int>(k));
    }
    std::sort(by_distance.begin(), by_distance.end());
    const double distance = by_distance[0].first, hundredth = 0.01 * s[2].get<double>();
    off = std::max(off, std::abs(s[4].get<double>() - distance) / hundredth);
    of_others += by_distance[1].first - distance > 6.0 * hundredth && s[3] != by_distance[0].second;
  }
  std::printf("%zu pixels: %d in the cell of another, distances off by %.2g hundredths of a pixel\n",
              answer["seen"].size(), of_others, off);
  return {of_others, off};
}

TEST(Replay, CellsOfThePageBelongToWhomTheyAreNearest) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  for (const char* text : {kCells, kCrowd}) {
    const auto [of_others, off] = cells_beside_distances(text);
    EXPECT_EQ(of_others, 0);
    EXPECT_LT(off, 6.0);  // rasterisers keep corners to sixteenths of a pixel
  }
}

// Bodies that have left the box that repeats itself: what is said of them stands at the images that are seen.
/// What the page of a scene's run says, all in a folder of its own.
json told_by_the_page_of(const std::string& scene, const std::string& script) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("brink-page-{}", ::getpid());
  RunRequest request;
  request.dir = folder;
  EXPECT_TRUE(run_scene(parse_scene(scene, "page.toml"), request).summary.sound());
  write_replay_page(folder / "run.db", folder / "page.html");
  json answer = in_browser(folder / "page.html", script);
  fs::remove_all(folder);
  return answer;
}

TEST(Replay, MarksOfAPlaneThatRepeatsItselfAreAtImagesThatAreSeen) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const json answer = told_by_the_page_of(R"(
[world]
duration = 20.0
periodic = [3.0, 2.0]
[output]
frame_interval = 0.5
[materials.default]
restitution = 1.0
[[bodies]]
name = "slow"
disc = { radius = 0.2 }
position = [1.0, 1.0]
velocity = [1.0, 0.3]
[[bodies]]
name = "fast"
disc = { radius = 0.2 }
position = [2.2, 1.0]
velocity = [2.0, 0.3]
[[forces]]
kind = "spring"
bodies = ["slow", "fast"]
stiffness = 0.01
rest_length = 1.0
)",
                                          R"(
    const b = window.brink, player = b.player, p = player.picture, marks = {};
    p.resize({getBoundingClientRect: () => ({width: 600, height: 400})});
    p.fit();
    const e = b.events.find(e => e.t > 5), t = e.t, [x, y] = p.motions.body(0, t);
    for (const layer of Object.keys(p.layers)) p.layers[layer] = layer === 'images';
    const inks = () => {
      const pixels = p.ctx.getImageData(0, 0, 600, 400).data;
      let count = 0;
      for (let k = 3; k < pixels.length; k += 4) count += pixels[k] > 0;
      return count;
    };
    p.flash = 1e-9;
    p.draw(t);
    const empty = inks();    // the box and the ruler
    for (const layer of ['contacts', 'velocities', 'trails', 'names', 'springs']) {
      p.layers[layer] = true;
      p.draw(t);
      marks[layer] = inks() - empty;
      p.layers[layer] = false;
    }
    const [u, v] = p.seenAt(x, y, 0)[0], [px, py] = p.toWorld(u, v);
    b.select('slow');
    document.getElementById('follow').checked = true;
    player.t = t;
    player.show(0);
    return {marks, from: [x, y], image: [(px - x) / 3, (py - y) / 2], at: [px, py], follows: [p.view.x, p.view.y]};)");
  ASSERT_FALSE(answer.contains("error")) << answer.dump();
  EXPECT_GT(answer["from"][0].get<double>(), 3.0) << "it has left the box";
  for (const auto& [layer, count] : answer["marks"].items()) EXPECT_GT(count.get<int>(), 20) << layer;
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(answer["image"][k].get<double>(), std::round(answer["image"][k].get<double>()), 1e-9);
    EXPECT_GE(answer["follows"][k].get<double>(), 0.0);
    EXPECT_LE(answer["follows"][k].get<double>(), k == 0 ? 3.0 : 2.0);
  }
}

// A scene of more collisions in a moment than can be told apart: those that are marked are the last.
TEST_F(Replayed, TheLastCollisionsAreMarked) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const fs::path page = folder_ / "marks.html";
  write_replay_page(run_file(), page);
  const json answer = in_browser(page, R"(
    const p = window.brink.player.picture, n = 400, one = value => new Float64Array(n).fill(value), rounds = [];
    p.n = {...p.n, event_t: Float64Array.from({length: n}, (_, k) => 1 + 1e-3 * k), event_px: Float64Array.from({length: n}, (_, k) => k * 1e-4),
           event_py: one(1), event_nx: one(1), event_ny: one(0), event_in: one(1)};
    p.t = 2;
    p.flash = 1;
    const round = p.round;
    p.round = function (x, y, r, ink) { rounds.push(p.toWorld(x, y)[0]); round.call(p, x, y, r, ink); };
    p.drawContacts();
    return rounds;)");
  ASSERT_FALSE(answer.contains("error")) << answer.dump();
  ASSERT_EQ(answer.size(), 100U);
  EXPECT_NEAR(answer.front().get<double>(), 300e-4, 1e-9);
  EXPECT_NEAR(answer.back().get<double>(), 399e-4, 1e-9) << "later ones over earlier ones";
}

// Sites that move by formulas are where those say, however rare frames are.
TEST(Replay, SitesMoveByTheirFormulas) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const fs::path folder = fs::temp_directory_path() / fmt::format("brink-replay-sites-{}", ::getpid());
  for (const char* interval : {"0", "0.5"}) {
    const Scene scene = parse_scene(fmt::format(R"x(
[world]
duration = 3
[output]
frame_interval = {}
[[sites]]
name = "still"
disc = {{ radius = 0.2 }}
position = [5, 2]
[[sites]]
name = "wobbles"
disc = {{ radius = 0.2 }}
position = [1, 2]
motion = {{ x = "0.3*cos(20*t)-0.3", y = "abs(sin(5*t))" }}
[[sites]]
name = "turns"
box = {{ width = 1, height = 0.2 }}
motion = {{ angular_velocity = 2 }}
[[bodies]]
disc = {{ radius = 0.1 }}
position = [-9, 0]
)x",
                                                interval),
                                    "sites.toml");
    RunRequest request;
    request.dir = folder;
    ASSERT_TRUE(run_scene(scene, request).summary.sound());
    write_replay_page(folder / "run.db", folder / "page.html");
    const json answer = in_browser(folder / "page.html",
                                   "return Array.from({length: 200}, (_, k) => 3 * (k * 0.618034 % 1))"
                                   ".map(t => [t, window.brink.sites(t)]);");
    ASSERT_FALSE(answer.contains("error")) << answer.dump();
    ASSERT_EQ(answer.size(), 200U);
    for (const json& at : answer) {
      const double t = at[0].get<double>();
      const json &wobbles = at[1][1], &turns = at[1][2];
      EXPECT_EQ(wobbles["name"], "wobbles");
      EXPECT_NEAR(wobbles["x"].get<double>(), 1.0 + 0.3 * std::cos(20 * t) - 0.3, 1e-7) << t;
      EXPECT_NEAR(wobbles["y"].get<double>(), 2.0 + std::abs(std::sin(5 * t)), 1e-7) << t;
      EXPECT_NEAR(turns["angle"].get<double>(), 2 * t, 1e-12) << t;
    }
  }
  fs::remove_all(folder);
}

// By pointers as fingers make them: one moves the scene, two zoom, a touch selects.
TEST_F(Replayed, FingersMoveZoomAndSelect) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const fs::path page = folder_ / "fingers.html";
  write_replay_page(run_file(), page);
  const json answer = in_browser(page, R"(
    const player = window.brink.player, p = player.picture, {canvas} = p, box = canvas.getBoundingClientRect();
    canvas.setPointerCapture = () => {};    // of pointers that no screen has
    const finger = (kind, id, x, y) => canvas.dispatchEvent(new PointerEvent('pointer' + kind,
      {pointerId: id, pointerType: 'touch', clientX: box.left + x, clientY: box.top + y, bubbles: true}));
    p.draw(1);
    const {x, y, scale} = p.view, [bx, by] = p.toPixels(p.poses[2][0], p.poses[2][1]);
    finger('down', 1, bx / p.ratio, by / p.ratio);
    finger('up', 1, bx / p.ratio, by / p.ratio);
    const selected = p.selected;
    finger('down', 1, 100, 100);
    for (let k = 1; k <= 10; ++k) finger('move', 1, 100 + 4 * k, 100 - 2 * k);
    finger('up', 1, 140, 80);
    const moved = [(p.view.x - x) * scale / p.ratio, (p.view.y - y) * scale / p.ratio];
    finger('down', 1, 100, 100);
    finger('down', 2, 200, 100);
    for (let k = 1; k <= 10; ++k) { finger('move', 1, 100 - 5 * k, 100); finger('move', 2, 200 + 5 * k, 100); }
    finger('up', 1, 50, 100);
    finger('up', 2, 250, 100);
    return {selected, moved, zoomed: p.view.scale / scale, still: p.selected};)");
  ASSERT_FALSE(answer.contains("error")) << answer.dump();
  EXPECT_EQ(answer["selected"], 2);
  EXPECT_EQ(answer["still"], 2) << "moving and zooming select nobody";
  EXPECT_NEAR(answer["moved"][0].get<double>(), -40.0, 1e-9);
  EXPECT_NEAR(answer["moved"][1].get<double>(), -20.0, 1e-9);
  EXPECT_NEAR(answer["zoomed"].get<double>(), 2.0, 1e-9);
}

// Behind a floor a stone that stands on it is as near as the floor: the cell there is the floor's, to every pixel.
TEST(Replay, BehindAFloorIsNoCellOfWhatStandsOnIt) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const json answer = told_by_the_page_of(R"(
[world]
duration = 0.1
gravity = [0.0, -9.81]
[[sites]]
segment = [[-2, 0], [24, 0]]
[[bodies]]
name = "stone"
box = { width = 0.8, height = 0.2, radius = 0.05 }
position = [11.1727, 0.15]
)",
                                          R"(
    const p = window.brink.player.picture, owners = {};
    p.resize({getBoundingClientRect: () => ({width: 981, height: 560})});
    Object.assign(p.view, {x: 11, y: 0.15, scale: 35.5});
    p.draw(0.05);
    for (let row = 5; row < 270; row += 5)
      for (let column = 440; column < 540; ++column) {
        const {owner} = p.cells.at(column, row);
        owners[owner] = (owners[owner] || 0) + 1;
      }
    return {owners, above: p.cells.at(496, 300).owner};)");
  ASSERT_FALSE(answer.contains("error")) << answer.dump();
  EXPECT_EQ(answer["owners"], json({{"0", 5300}}));
  EXPECT_EQ(answer["above"], 1);
}

// Without a graphics card discs are drawn by the pixel. The truth is from many places in each pixel; the browser's own ellipses are held
// against it beside.
TEST(Replay, DiscsByThePixelAreWhereTheyAre) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  std::string scene = "[world]\nduration = 0.1\n";
  for (int k = 0; k < 12; ++k)  // of 1.2 to 53 pixels; some reach over the picture's edges
    scene +=
        fmt::format("[[bodies]]\ndisc = {{ radius = {} }}\nposition = [{}, {}]\nangle = {}\n",
                    0.012 * std::pow(1.41, k), -1.9 + 0.33 * k + 0.02 * k * k, k % 2 ? 0.7 : -0.6, 0.7 * k);
  const json answer = told_by_the_page_of(scene, R"(
    const p = window.brink.player.picture, views = [];
    p.resize({getBoundingClientRect: () => ({width: 600, height: 200})});
    Object.assign(p.view, {x: 0.5, y: 0.1, scale: 100.3});
    p.layers.cells = false;
    const {discs} = p;
    p.draw(0.05);
    for (const ink of p.inks) ink.spoke = false;
    for (const by of [discs, null]) {
      p.discs = by;
      p.draw(0.05);
      views.push(p.ctx.getImageData(0, 0, 600, 170).data);    // above the ruler
    }
    const parts = 10, rgb = ink => [1, 3, 5].map(k => parseInt(ink.slice(k, k + 2), 16)), half = 0.6;    // of a rim
    const all = p.about.bodies.map((body, k) => ({at: p.toPixels(p.poses[k][0], p.poses[k][1]), fill: rgb(body.fill), line: rgb(body.line),
      r: p.about.shapes[body.shape].bounding_radius * p.view.scale}));
    const off = [0, 0], sum = [0, 0];
    let drawn = 0;
    for (let row = 0; row < 170; ++row)
      for (let column = 0; column < 600; ++column) {
        const near = all.filter(d => Math.hypot(d.at[0] - column - 0.5, d.at[1] - row - 0.5) < d.r + half + 2), k = 4 * (600 * row + column);
        const truth = [0, 0, 0];
        for (let i = 0; i < parts * parts; ++i) {
          let color = [255, 255, 255];    // over white, so that a colour that is not seen counts for nothing
          for (const d of near) {
            const away = Math.hypot(d.at[0] - column - (i % parts + 0.5) / parts, d.at[1] - row - (Math.floor(i / parts) + 0.5) / parts);
            if (away < d.r + half) color = away < d.r - half ? d.fill : d.line;
          }
          color.forEach((x, c) => { truth[c] += x / (parts * parts); });
        }
        if (near.length === 0 && views[0][k + 3] === 0) continue;
        ++drawn;
        views.forEach((v, by) => {
          const wrong = Math.max(...truth.map((x, c) => Math.abs(255 + (v[k + c] - 255) * v[k + 3] / 255 - x)));
          off[by] = Math.max(off[by], wrong);
          sum[by] += wrong;
        });
      }
    return {by: !!discs, off, mean: sum.map(x => x / drawn), drawn};)");
  ASSERT_FALSE(answer.contains("error")) << answer.dump();
  EXPECT_TRUE(answer["by"].get<bool>()) << "the test's browser has no graphics card";
  std::printf(
      "%s pixels, of 255: by the pixel off by at most %.0f, %.2f on the mean; the browser's ellipses %.0f, "
      "%.2f\n",
      answer["drawn"].dump().c_str(), answer["off"][0].get<double>(), answer["mean"][0].get<double>(),
      answer["off"][1].get<double>(), answer["mean"][1].get<double>());
  EXPECT_GT(answer["drawn"], 5000);
  EXPECT_LT(answer["off"][0].get<double>(), 20.0);
  EXPECT_LT(answer["mean"][0].get<double>(), 1.0);
}

// A touch on a lane goes to its nearest event; of a body that only the trace tells of, to the time itself.
TEST(Replay, ATouchOnALaneLeadsToItsEventOrItsTime) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const fs::path folder = fs::temp_directory_path() / fmt::format("brink-lanes-{}", ::getpid());
  const Scene scene = parse_scene(R"(
[world]
duration = 4.0
[materials.default]
restitution = 1.0
[[sites]]
segment = [[1.0, -1.0], [1.0, 1.0]]
[[bodies]]
name = "meets"
disc = { radius = 0.2 }
velocity = [0.4, 0.0]
[[bodies]]
name = "alone"
disc = { radius = 0.2 }
position = [-5.0, 0.0]
velocity = [-1.0, 0.0]
)",
                                  "lanes.toml");
  RunRequest request;
  request.dir = folder;
  request.trace = folder.string() + ".json";  // the folder is made by the run
  ASSERT_TRUE(run_scene(scene, request).summary.sound());
  ReplayLimits options;
  options.trace = request.trace;
  write_replay_page(folder / "run.db", folder / "lanes.html", options);
  const json answer = in_browser(folder / "lanes.html", R"(
    const player = window.brink.player, p = player.picture, canvas = document.getElementById('lanes');
    const box = canvas.getBoundingClientRect(), rows = player.lanes.length, seen = [];
    for (let row = 0; row < rows; ++row) {
      const x = box.left + 70 + 0.75 * (box.width - 70), y = box.top + (row + 0.5) * box.height / rows;
      canvas.dispatchEvent(new MouseEvent('click', {clientX: x, clientY: y, bubbles: true}));
      seen.push([player.lanes[row], p.selected, player.t]);
    }
    return seen;)");
  fs::remove_all(folder);
  fs::remove(request.trace);
  ASSERT_TRUE(answer.is_array()) << answer.dump();
  ASSERT_EQ(answer.size(), 2U) << answer.dump();
  EXPECT_EQ(answer[0][1], 0);
  EXPECT_NEAR(answer[0][2].get<double>(), 2.0, 1e-9) << "its one collision";
  EXPECT_EQ(answer[1][1], 1);
  EXPECT_NEAR(answer[1][2].get<double>(), 3.0, 0.05) << "where the finger was";
}

// Frames of 16 ms that are late, then in time: coarser, and finer again; a finer picture that was too much is not tried as soon.
TEST_F(Replayed, CellsAreCoarserWhereFramesAreLateAndFineWhereNothingMoves) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const fs::path page = folder_ / "pace.html";
  write_replay_page(run_file(), page);
  const json answer = in_browser(page, R"(
    const pace = new Pace(false, 16), levels = [];
    let now = 1000;
    const frames = (count, length, drawing = 2) => {
      for (let k = 0; k < count; ++k) { pace.moved(now += length); pace.drew(drawing); }
      levels.push(pace.level);
    };
    frames(5, 60);    // too few to tell
    frames(200, 60);
    frames(27, 16);    // 4 of them with late ones before
    frames(1, 16);    // finer after 24
    frames(8, 60);    // which was too much
    frames(24, 16);
    frames(8, 60);    // again
    frames(300, 16);    // no third time
    pace.forget();
    frames(25, 16);    // but after it stood still
    frames(95, 16, 8);    // no time to spare
    frames(1, 33);    // a late one
    const begins = new Pace(true).level;
    const still = [pace.still(now + 100), pace.still(now + 200)], coarse = pace.detail.paint;
    pace.forget();
    const p = window.brink.player;
    p.pace.level = DETAILS.length - 1;
    p.playing = true;
    p.pace.moved(1); p.show(1);
    const playing = p.picture.cells.canvas.width / p.picture.canvas.width;
    p.playing = false;
    p.stale = false;
    p.tick(1000);
    return {levels, begins, still, coarse, playing, paused: p.picture.cells.canvas.width / p.picture.canvas.width,
            works: p.picture.cells.works};)");
  ASSERT_FALSE(answer.contains("error")) << answer.dump();
  EXPECT_EQ(answer["levels"], json({0, 6, 6, 5, 6, 5, 6, 6, 5, 5, 6})) << answer.dump();
  EXPECT_EQ(answer["begins"], 4) << "without a graphics card";
  EXPECT_EQ(answer["still"], json({false, true}));
  ASSERT_TRUE(answer["works"]);
  EXPECT_LT(answer["playing"], 0.4);
  EXPECT_EQ(answer["paused"], 1.0);
}

// The same picture from a ninth of the pixels. Cells get pure hues: lines of white on them leave the hue as it is.
TEST_F(Replayed, ACoarserPictureHasItsBordersWhereTheyAre) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const fs::path page = folder_ / "coarse.html";
  write_replay_page(run_file(), page);
  const json answer = in_browser(page, R"(
    const p = window.brink.player.picture, {cells} = p, {gl} = cells, views = [];
    p.resize({getBoundingClientRect: () => ({width: 900, height: 600})});
    p.layers.cells = true;
    p.fit();
    p.draw(1.3);
    cells.setColors([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [0, 1, 1], [1, 0, 1], [1, .5, 0], [0, 1, .5], [.5, 0, 1]]);
    for (const mesh of [1, 3]) {
      p.detail = {paint: 1, mesh};
      p.draw(1.3);
      const pixels = new Uint8Array(4 * 900 * 600);
      gl.readPixels(0, 0, 900, 600, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      views.push(pixels);
    }
    const hue = (view, k) => {
      const c = [view[k], view[k + 1], view[k + 2]], least = Math.min(...c), pure = c.map(x => x - least), l = Math.hypot(...pure);
      return l > 30 ? pure.map(x => x / l) : null;
    };
    let differ = 0, of = 0;
    const hues = new Set();
    for (let k = 0; k < views[0].length; k += 4) {
      const a = hue(views[0], k), b = hue(views[1], k);
      if (!a || !b) continue;
      ++of;
      hues.add(a.map(x => Math.round(4 * x)).join());
      differ += a[0] * b[0] + a[1] * b[1] + a[2] * b[2] < 0.97;
    }
    return {differ, of, hues: hues.size, size: [cells.size, cells.canvas.width], owners: p.about.sites.length + p.about.bodies.length};)");
  ASSERT_FALSE(answer.contains("error")) << answer.dump();
  EXPECT_EQ(answer["size"], json({{300, 200}, 900}));
  EXPECT_EQ(answer["owners"], 9);
  EXPECT_GE(answer["hues"], 8) << "cells can be told apart";
  std::printf("pixels in the cell of another: %s of %s\n", answer["differ"].dump().c_str(),
              answer["of"].dump().c_str());
  EXPECT_GT(answer["of"], 300000);
  EXPECT_LT(answer["differ"].get<double>(), 1.2e-3 * answer["of"].get<double>());
}

}  // namespace
}  // namespace brink::replay_page_test
