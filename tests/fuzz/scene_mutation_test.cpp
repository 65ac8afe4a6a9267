// Broken scene files: every mutant of a corpus either reads, checks and runs for a moment, or is refused with
// at least one located fault. Nothing crashes, hangs or turns into NaN.
//
// BRINK_FUZZ_COUNT, BRINK_FUZZ_SEED: how many mutants (default 1000), and which. BRINK_FUZZ_SECONDS: a limit
// for each, in a process of its own; BRINK_FUZZ_KEEP: a folder for those with findings. By hand:
//   BRINK_FUZZ_COUNT=10000 BRINK_FUZZ_SECONDS=10 ./fuzz_scene_mutation_test --gtest_filter='*Run*'
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/simulator/simulator.h"
#include "tests/fuzz/mutant_process.h"

namespace brink::scene_mutation_test {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// One scene with every table of the format; small, so that a mutation is likely to matter.
constexpr const char* kEverything = R"toml(title = "everything"
[world]
duration = 0.05
gravity = [0.0, -9.81]
seed = 3
restitution_rule = "mean"
[solver]
policy = "global_backup"
order = "closing_speed"
integrator = "auto"
tolerance = 1e-8
step = 0.001
contact_tolerance = 1e-10
[field]
resolution = 64
curve_tolerance = 1e-3
[output]
frame_interval = 0.01
events = true
[materials.steel]
restitution = 0.9
friction = 0.1
tangential_restitution = 0.5
[[sites]]
name = "floor"
segment = [[-10, -1], [10, -1]]
radius = 0.01
material = "steel"
[[sites]]
name = "bowl"
bezier = [[-5, 3], [-2, 0], [2, 0], [5, 3]]
position = [0, -4]
[[sites]]
name = "room"
disc = { radius = 30 }
inside_of = true
[[sites]]
name = "table"
arc = { center = [0, -8], radius = 2, from_deg = 10, to_deg = 170 }
motion = { y = "0.1*sin(6*t)",
                     angle = "t/10"
}
[[bodies]]
name = "ball"
disc = { radius = 0.25 }
density = 2
scatter = { count = 5, region = [[-4, 5], [4, 9]], speed = 1, angular_speed = 2, random_angle = true }
material = "steel"
[[bodies]]
name = "box"
box = { width = 0.5, height = 0.4, radius = 0.05 }
grid = { columns = 2, rows = 2, spacing = [1.5, 1.5] }
position = [-8, 0.5]
velocity = [1, 0]
angle_deg = 30
[[bodies]]
name = "gear"
polygons = [{ vertices = [[0, 0], [2, 0], [2, 1], [0, 1]] }, { vertices = [[1, 0], [3, 0], [3, 2], [1, 2]] }]
mass = 3
inertia = 2
position = [10, 8]
centered = false
lock = ["x", "y"]
angular_velocity = 1.5
[[bodies]]
name = "leaf"
path = { d = "M0 0 C1 0 1 1 0 2 Z", scale = 0.5 }
position = [14, 10]
sampling = { kind = "boundary", spacing = 0.1 }
[[bodies]]
name = "ring"
chain = { vertices = [[0, 0], [1, 0], [0.5, 1]], closed = true, radius = 0.02 }
position = [-14, 10]
[[forces]]
kind = "spring"
body = "leaf"
anchor = [14, 12]
at = [0, 0.1]
stiffness = 20
damping = 0.1
rest_length = 1
[[forces]]
kind = "drag"
bodies = ["ball", "box[1]"]
linear = 0.1
quadratic = 0.01
[[forces]]
kind = "attract"
center = [0, 100]
strength = 2
power = -2
[[forces]]
kind = "thrust"
body = "ring"
force = [1, 2]
torque = 0.1
from = 0.01
to = 0.02
[[forces]]
kind = "formula"
bodies = ["ring"]
fx = "-x + sin(3*t)"
torque = "-omega"
)toml";

// A seeded source of mutations of a text.
class Mutator {
 public:
  Mutator(std::uint64_t seed, const std::vector<std::string>& corpus) : random_(seed), corpus_(corpus) {}

  std::string next() {
    std::string text = pick(corpus_);
    for (std::uint64_t n = 1 + random_.below(3); n > 0; --n) mutate(text);
    return text;
  }

 private:
  template <class Things>
  auto pick(const Things& things) -> decltype(things[0]) {
    return things[random_.below(std::size(things))];
  }

  void mutate(std::string& text) {
    if (text.empty()) text = "x";
    switch (random_.below(11)) {
      case 0:
        text[random_.below(text.size())] = static_cast<char>(random_.below(256));
        break;
      case 1:
        swap_tokens(text);
        break;
      case 2:
      case 3:
      case 4:
        replace_number(text);
        break;
      case 5:
        misspell_key(text);
        break;
      case 6:
        erase_line(text);
        break;
      case 7:
        repeat_lines(text);
        break;
      case 8:
        nest(text);
        break;
      case 9:
        text.resize(random_.below(text.size()));
        break;
      default:
        replace_value(text);
        break;
    }
  }

  // Start and length of a random run of characters from `set`, or length 0.
  std::pair<std::size_t, std::size_t> run_of(const std::string& text, const char* set) {
    const std::size_t start = text.find_first_of(set, random_.below(text.size()));
    if (start == std::string::npos) return {0, 0};
    const std::size_t end = text.find_first_not_of(set, start);
    return {start, (end == std::string::npos ? text.size() : end) - start};
  }

  void replace_number(std::string& text) {
    static const char* const numbers[] = {"nan",    "inf",
                                          "-inf",   "1e308",
                                          "-1e308", "1e-308",
                                          "-0.0",   "0",
                                          "-1",     "1e15",
                                          "-1e15",  "1e-12",
                                          "0x7fff", "9223372036854775807",
                                          "1e40",   "1000",
                                          "1e-40",  "1e999",
                                          "0.5",    "3.0000000000000001"};
    const auto [start, length] = run_of(text, "0123456789.");
    if (length > 0) text.replace(start, length, pick(numbers));
  }

  void replace_value(std::string& text) {
    static const char* const values[] = {"true",      "\"word\"",    "[]",      "{}",
                                         "[1, 2]",    "1979-05-27",  "'''a'''", "[[1]]",
                                         "{ a = 1 }", "\"\\u0000\"", "3",       "[[0,0],[0,0],[0,0]]"};
    const std::size_t equals = text.find('=', random_.below(text.size()));
    if (equals == std::string::npos) return;
    const std::size_t end = std::min(text.find('\n', equals), text.size());
    text.replace(equals + 1, end - equals - 1, pick(values));
  }

  void swap_tokens(std::string& text) {
    static const char* const word = "abcdefghijklmnopqrstuvwxyz_0123456789.";
    const auto a = run_of(text, word), b = run_of(text, word);
    const std::string first = text.substr(a.first, a.second), second = text.substr(b.first, b.second);
    if (a.first + a.second > b.first) return;  // overlapping, or the wrong way round
    text.replace(b.first, b.second, first);
    text.replace(a.first, a.second, second);
  }

  void misspell_key(std::string& text) {
    const auto [start, length] = run_of(text, "abcdefghijklmnopqrstuvwxyz_");
    if (length > 0) text[start + random_.below(length)] = static_cast<char>('a' + random_.below(26));
  }

  std::pair<std::size_t, std::size_t> line(const std::string& text) {
    const std::size_t at = random_.below(text.size());
    const std::size_t before = text.rfind('\n', at), after = text.find('\n', at + 1);
    const std::size_t start = before == std::string::npos ? 0 : before;
    return {start, (after == std::string::npos ? text.size() : after) - start};
  }

  void erase_line(std::string& text) {
    const auto [start, length] = line(text);
    text.erase(start, length);
  }

  void repeat_lines(std::string& text) {
    const auto [start, length] = line(text);
    text.insert(start, text.substr(start, length));
  }

  void nest(std::string& text) {
    static const char* const pieces[] = {"[", "{a=", "[[", "a.", "\"a\".", "{", "("};
    std::string deep;
    const std::string piece = pick(pieces);
    for (std::uint64_t n = 1 + random_.below(3000); n > 0; --n) deep += piece;
    text.insert(random_.below(text.size()), deep);
  }

  Random random_;
  const std::vector<std::string>& corpus_;
};

std::vector<std::string> corpus() {
  std::vector<std::string> out{kEverything, kEverything};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(BRINK_SOURCE_DIR "/scenes/gallery"))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());  // the same order everywhere
  for (const auto& file : files) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    if (text.str().size() < 6000) out.push_back(text.str());
  }
  return out;
}

bool finite(const BodyState& s) {
  return s.pose.position.allFinite() && std::isfinite(s.pose.angle) && s.twist.velocity.allFinite() &&
         std::isfinite(s.twist.omega);
}

// Runs an accepted scene for a few milliseconds.
void run_for_a_moment(const Scene& scene) {
  Simulator simulator(scene.world, scene.solver);
  const Clock::time_point start = Clock::now();
  RunOptions options;
  options.until = std::min(scene.duration, 0.01);
  options.checkpoint_seconds = -1.0;
  options.progress = [&](double, std::uint64_t) { return seconds_since(start) < 0.005; };
  if (!simulator.start_fault().empty()) return;  // bodies in each other: refused with a message
  simulator.run(options);
  for (const BodyState& state : simulator.states()) ASSERT_TRUE(finite(state));
}

/// How many mutants went which way, and how long the slowest took.
struct Tally {
  int accepted = 0, refused = 0;
  double slowest_reading = 0.0, slowest_running = 0.0;
};

void require_located(const SceneFaults& faults) {
  ASSERT_FALSE(faults.faults().empty());
  for (const SceneFault& fault : faults.faults()) {
    ASSERT_GE(fault.line, 1);
    ASSERT_GE(fault.column, 1);
    ASSERT_FALSE(fault.message.empty());
    ASSERT_EQ(fault.message.find_first_of("\n\x1b"), std::string::npos);
  }
}

void try_mutant(const std::string& text, bool running_too, Tally& tally) {
  const Clock::time_point reading = Clock::now();
  std::optional<Scene> scene;
  try {
    scene = parse_scene(text, "mutant.toml");
  } catch (const SceneFaults& faults) {
    ++tally.refused;
    require_located(faults);
  }
  tally.slowest_reading = std::max(tally.slowest_reading, seconds_since(reading));
  if (!scene) return;
  ++tally.accepted;
  ASSERT_NO_THROW(scene->world.check());
  if (!running_too) return;
  const Clock::time_point running = Clock::now();
  run_for_a_moment(*scene);
  tally.slowest_running = std::max(tally.slowest_running, seconds_since(running));
  ASSERT_FALSE(::testing::Test::HasFatalFailure());
  ASSERT_LT(seconds_since(running), 30.0);
}

/// By hand: each mutant in a process of its own, ended after so many seconds, so that one finding does not
/// hide the next. Mutants with findings are kept in the folder BRINK_FUZZ_KEEP.
void try_mutants_apart(Mutator& mutator, std::uint64_t seed, std::uint64_t count, unsigned seconds) {
  const char* keep = std::getenv("BRINK_FUZZ_KEEP");
  std::vector<std::string> findings;  // told at the end: a child would take them for its own
  for (std::uint64_t k = 0; k < count; ++k) {
    const std::string text = mutator.next();
    const std::string how = fuzz::finding(
        [&] {
          Tally tally;
          try_mutant(text, true, tally);
          return !::testing::Test::HasFailure();
        },
        seconds);
    if (how.empty()) continue;
    findings.push_back("mutant " + std::to_string(k) + ": " + how);
    if (keep != nullptr)
      std::ofstream(std::filesystem::path(keep) / ("mutant-" + std::to_string(k) + ".toml"), std::ios::binary)
          << text;
  }
  for (const std::string& f : findings) ADD_FAILURE() << f << ", seed " << seed;
  std::cout << count << " mutants, " << findings.size() << " findings\n";
}

// Reads mutants, and if `running_too` lets those accepted run for a moment.
void try_mutants(bool running_too) {
  const std::uint64_t seed = fuzz::asked("BRINK_FUZZ_SEED", 20261121);
  const std::uint64_t count = fuzz::asked("BRINK_FUZZ_COUNT", 1000);
  const auto seconds = static_cast<unsigned>(fuzz::asked("BRINK_FUZZ_SECONDS", 0));
  std::cout << "seed " << seed << '\n';
  const std::vector<std::string> texts = corpus();
  Mutator mutator(seed, texts);
  if (seconds > 0 && running_too) return try_mutants_apart(mutator, seed, count, seconds);
  Tally tally;
  const Clock::time_point start = Clock::now();
  for (std::uint64_t k = 0; k < count; ++k) {
    const std::string text = mutator.next();
    SCOPED_TRACE("mutant " + std::to_string(k) + " of seed " + std::to_string(seed) + ":\n" +
                 text.substr(0, 20000));
    try_mutant(text, running_too, tally);
    if (::testing::Test::HasFatalFailure()) return;
  }
  std::cout << tally.accepted << " accepted, " << tally.refused << " refused, " << seconds_since(start)
            << " s; slowest reading " << tally.slowest_reading << " s, slowest run " << tally.slowest_running
            << " s\n";
  EXPECT_GT(tally.accepted, static_cast<int>(count / 50));  // the mutator leaves some whole, and breaks some
  EXPECT_GT(tally.refused, static_cast<int>(count / 50));
}

TEST(SceneMutation, AThousandMutantsReadOrAreRefusedWithAPlace) { try_mutants(false); }

TEST(SceneMutation, AcceptedMutantsRunForAMoment) { try_mutants(true); }

}  // namespace
}  // namespace brink::scene_mutation_test
