// Broken run files: every mutant is read, drawn, gone on with and swept as if it were whole, or refused with
// an error that names the file. Nothing crashes, hangs, or reads past an end; a refused resume touches
// nothing; one that is not refused ends in the state of an undisturbed run.
//
// BRINK_FUZZ_COUNT, BRINK_FUZZ_SEED: how many mutants (default 100 of each kind), and which.
// BRINK_FUZZ_KEEP: a folder for the mutants with findings. BRINK_FUZZ_DIAGRAM=1: draw the cells too (opens an
// OpenGL context for each).
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>

#include "brink/core/base/random.h"
#include "brink/scenes/draw/draw.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/run_moment.h"
#include "brink/scenes/run_file/run_scene.h"
#include "brink/scenes/run_file/run_tables.h"
#include "brink/scenes/sweep/sweep.h"
#include "brink/scenes/view/replay_page.h"
#include "tests/fuzz/mutant_process.h"

namespace brink::run_file_mutation_test {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kSeconds = 10;  // for one mutant

// Arcs, a wire, a container, a site that moves by formulas, and a spring: every kind of JSON in the file.
constexpr const char* kScene = R"toml(
title = "mutants"
[world]
duration = 0.4
gravity = [0, -9.81]
seed = 5
[output]
frame_interval = 0.05
[[sites]]
name = "room"
disc = { radius = 3 }
inside_of = true
[[sites]]
name = "table"
segment = [[-2, -1], [2, -1]]
motion = { y = "0.1*sin(9*t)" }
[[bodies]]
name = "ball"
disc = { radius = 0.2 }
scatter = { count = 4, region = [[-1, 0], [1, 2]], speed = 2 }
[[bodies]]
name = "box"
box = { width = 0.4, height = 0.3, radius = 0.05 }
position = [0, -0.6]
[[forces]]
kind = "spring"
body = "box"
anchor = [0, 0]
stiffness = 5
)toml";

constexpr const char* kExperiment = R"toml(
title = "mutants"
scenes = "scene.toml"
policies = ["body_clocks", "global_backup"]
until = 0.1
)toml";

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void write_bytes(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

/// Everything in a folder, by name.
std::map<std::string, std::string> contents(const fs::path& dir) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::directory_iterator(dir))
    all[entry.path().filename().string()] = bytes_of(entry.path());
  return all;
}

/// A seeded source of mutations of a database.
class DatabaseMutator {
 public:
  explicit DatabaseMutator(std::uint64_t seed) : random_(seed) {}

  void mutate(const fs::path& file) {
    for (std::uint64_t n = 1 + random_.below(2); n > 0; --n) {
      try {
        random_.below(2) == 0 ? mutate_bytes(file) : mutate_rows(file);
      } catch (const SQLite::Exception&) {
        // broken already, or what SQLite itself refuses
      }
    }
  }

 private:
  template <class Things>
  auto pick(const Things& things) -> decltype(things[0]) {
    return things[random_.below(std::size(things))];
  }

  void mutate_bytes(const fs::path& file) {
    std::string bytes = bytes_of(file);
    if (bytes.empty()) return;
    constexpr std::size_t kPage = 4096;
    const auto page = [&] { return kPage * random_.below(1 + (bytes.size() - 1) / kPage); };
    const auto at = [&] { return random_.below(bytes.size()); };
    switch (random_.below(7)) {
      case 0:  // anywhere
      case 1:
        for (std::uint64_t n = 1 + random_.below(8); n > 0; --n)
          bytes[at()] = static_cast<char>(random_.below(256));
        break;
      case 2:  // in the header of the file or of a page
        bytes[std::min(page() + random_.below(100), bytes.size() - 1)] =
            static_cast<char>(random_.below(256));
        break;
      case 3:
        bytes.resize(at());
        break;
      case 4: {  // one page over another
        const std::size_t from = page(), to = page();
        bytes.replace(to, std::min(kPage, bytes.size() - to), bytes.substr(from, kPage));
        break;
      }
      case 5:
        bytes += std::string(1 + random_.below(9000), static_cast<char>(random_.below(256)));
        break;
      default:
        write_bytes(file.string() + pick(kBeside), bytes.substr(at(), 9000));
        return;
    }
    write_bytes(file, bytes);
  }
  static constexpr const char* kBeside[] = {"-wal", "-journal", "-shm"};

  static std::vector<std::string> column(SQLite::Database& db, const std::string& query) {
    std::vector<std::string> all;
    SQLite::Statement get(db, query);
    while (get.executeStep()) all.push_back(get.getColumn(0).getString());
    return all;
  }

  void mutate_rows(const fs::path& file) {
    SQLite::Database db(file.string(), SQLite::OPEN_READWRITE);
    db.exec("PRAGMA writable_schema = ON");
    const auto tables =
        column(db, "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite%'");
    if (tables.empty()) return;
    const std::string table = pick(tables), other = pick(tables);
    switch (random_.below(9)) {
      case 0:
        return db.exec(fmt::format("DELETE FROM {} WHERE rowid % {} = 0", table, 1 + random_.below(5))),
               void();
      case 1:
        return db.exec(fmt::format("DROP TABLE {}", table)), void();
      case 2:
        db.exec(fmt::format("ALTER TABLE {} RENAME TO elsewhere", table));
        db.exec(fmt::format("ALTER TABLE {} RENAME TO {}", other, table));
        return db.exec(fmt::format("ALTER TABLE elsewhere RENAME TO {}", other)), void();
      case 3:
        db.exec(fmt::format("ALTER TABLE {} RENAME TO elsewhere", table));
        return db.exec(fmt::format(
                   "CREATE VIEW {} AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
                   "SELECT i, elsewhere.* FROM n, elsewhere",
                   table)),
               void();
      default:
        return change_cell(db, table);
    }
  }

  void change_cell(SQLite::Database& db, const std::string& table) {
    static const char* const values[] = {"NULL",
                                         "''",
                                         "-1",
                                         "0",
                                         "1",
                                         "1e308",
                                         "9e999",
                                         "-9e999",
                                         "1e-308",
                                         "9223372036854775807",
                                         "'nan'",
                                         "'word'",
                                         "x'00ff'",
                                         "x''",
                                         "zeroblob(100000)",
                                         "'{}'",
                                         "'[1,2]'",
                                         "'reached_end'",
                                         "1e15",
                                         "char(10, 27, 8238)",
                                         "2147483648",
                                         "'1e999'",
                                         "'{\"world\":{\"periodic\":[\"a\"]}}'"};
    const auto columns = column(db, fmt::format("SELECT name FROM pragma_table_info('{}')", table));
    const auto rows = column(db, fmt::format("SELECT rowid FROM {}", table));
    if (rows.empty() || columns.empty()) return;
    const std::string name = pick(columns), row = pick(rows);
    if (random_.below(3) > 0)
      return db.exec(fmt::format("UPDATE OR REPLACE {} SET {} = {} WHERE rowid = {}", table, name,
                                 pick(values), row)),
             void();
    SQLite::Statement get(db, fmt::format("SELECT {} FROM {} WHERE rowid = {}", name, table, row));
    get.executeStep();
    const bool blob = get.getColumn(0).isBlob();
    std::string text = get.getColumn(0).getString();
    change_text(text);
    SQLite::Statement put(db,
                          fmt::format("UPDATE OR REPLACE {} SET {} = ? WHERE rowid = {}", table, name, row));
    blob ? put.bind(1, text.data(), static_cast<int>(text.size())) : put.bind(1, text);
    put.exec();
  }

  void change_text(std::string& text) {
    if (text.empty()) text = "x";
    static const char* const pieces[] = {"1e308", "-1",   "0",     "null",    "[",
                                         "{",     "true", "1e999", "\"arc\"", "\"t/0\""};
    const std::size_t digit = text.find_first_of("0123456789", random_.below(text.size()));
    switch (random_.below(4)) {
      case 0:
        text[random_.below(text.size())] = static_cast<char>(random_.below(256));
        break;
      case 1:
        text.resize(random_.below(text.size()));
        break;
      case 2:
        text.insert(random_.below(text.size()), pick(pieces));
        break;
      default:
        if (digit == std::string::npos) break;
        text.replace(digit, text.find_first_not_of("0123456789.", digit) - digit, pick(pieces));
    }
  }

  Random random_;
};

/// True if f went well, or was refused with an IoError that names `file` (or, where `other_scene`, a
/// BadInput).
template <class F>
bool fine(const fs::path& file, bool may_be_bad_input, F&& f) {
  try {
    f();
    return true;
  } catch (const IoError& e) {
    if (std::string(e.what()).find(file.parent_path().string()) != std::string::npos) return true;
    std::cerr << "an error without the file: " << e.what() << '\n';
  } catch (const BadInput& e) {
    if (may_be_bad_input) return true;
    std::cerr << "bad input: " << e.what() << '\n';
  }
  return false;
}

bool reads(const fs::path& file) {
  bool good = fine(file, false, [&] {
    const RunFile run(file);
    run.meta();
    run.events();
  });
  good &= fine(file, false, [&] { RunFile(file).checkpoint(); });
  good &= fine(file, false, [&] { RunFile(file).states_at(0.12); });
  good &= fine(file, false, [&] {
    const RunMoment moment = moment_of_run(file, std::nullopt);
    DrawOptions options;
    options.size = {64, 48};
    options.diagram = fuzz::asked("BRINK_FUZZ_DIAGRAM", 0) != 0;
    draw_scene(moment.world, moment.bodies, moment.sites, options);
  });
  good &= fine(file, false, [&] {
    const RunFile run(file);
    extent_of(run, run.world());
    trails_of(run, 0.12);
    contacts_before(run, 0.12);
    run.knots();
  });
  good &= fine(file, false, [&] { replay_page_text(file, {}, false); });
  good &= fine(file, false, [&] { write_csv_tables(file, file.parent_path() / "tables"); });
  good &= fine(file, true, [&] { scene_of_run(file); });
  return good;
}

bool goes_on(const Scene& scene, const fs::path& dir, std::uint64_t undisturbed) {
  const auto before = contents(dir);
  bool resumed = false, right = true;
  const bool good = fine(dir / "run.db", true, [&] {
    RunRequest request;
    request.dir = dir;
    request.resume = true;
    const RunReport report = run_scene(scene, request);
    resumed = true;
    right = report.finished_before || report.summary.state_hash == undisturbed;
  });
  if (!right) std::cerr << "another end than the undisturbed run\n";
  if (resumed) return good && right;
  const auto after = contents(dir);
  for (const auto& [name, bytes] : after)
    if (!name.ends_with("-shm") && (!before.contains(name) || before.at(name) != bytes)) {
      std::cerr << "refused, but " << name << " is not as it was\n";
      return false;
    }
  return good && after.contains("run.db");
}

class Mutants : public ::testing::Test {
 protected:
  Mutants() {
    std::string name = (fs::temp_directory_path() / "brink-mutants-XXXXXX").string();
    dir_ = ::mkdtemp(name.data());
    write_bytes(dir_ / "scene.toml", kScene);
    std::cout << "seed " << seed_ << '\n';
  }
  ~Mutants() override { fs::remove_all(dir_); }

  /// Runs the scene into DIR/name; to its end, or to the middle, off the frame clock.
  std::uint64_t run(const Scene& scene, const char* name, bool stopped) const {
    RunRequest request;
    request.dir = dir_ / name;
    if (stopped) request.until = 0.23;
    return run_scene(scene, request).summary.state_hash;
  }

  /// Tries `f(folder)` on mutants of `file`.
  template <class F>
  void try_mutants(const fs::path& file, F&& f) const {
    const fs::path at = dir_ / "mutant";
    std::uint64_t findings = 0;
    for (std::uint64_t k = 0; k < count_; ++k) {
      fs::remove_all(at);
      fs::create_directory(at);
      fs::copy_file(file, at / file.filename());
      // apart too: SQLite at work on a broken file, with its guards off
      fuzz::finding([&] { return DatabaseMutator(seed_ + k).mutate(at / file.filename()), true; }, kSeconds);
      const fs::path kept = dir_ / "kept";
      fs::remove_all(kept);
      fs::copy(at, kept);
      const std::string how = fuzz::finding([&] { return f(at); }, kSeconds);
      if (how.empty()) continue;
      ++findings;
      ADD_FAILURE() << "mutant " << k << " of seed " << seed_ << ": " << how;
      if (const char* keep = std::getenv("BRINK_FUZZ_KEEP"))
        fs::copy(kept, fs::path(keep) / fmt::format("{}-{}", file.stem().string(), k),
                 fs::copy_options::recursive);
    }
    std::cout << count_ << " mutants of " << file.filename().string() << ", " << findings << " findings\n";
  }

  const std::uint64_t count_ = fuzz::asked("BRINK_FUZZ_COUNT", 100);
  const std::uint64_t seed_ = fuzz::asked("BRINK_FUZZ_SEED", 20261122);
  fs::path dir_;
};

TEST_F(Mutants, OfARunFileAreReadAndDrawnOrRefused) {
  run(load_scene(dir_ / "scene.toml"), "whole", false);
  try_mutants(dir_ / "whole/run.db", [](const fs::path& at) { return reads(at / "run.db"); });
}

TEST_F(Mutants, OfAStoppedRunEndAsTheUndisturbedRunOrAreLeftAlone) {
  const Scene scene = load_scene(dir_ / "scene.toml");
  const std::uint64_t undisturbed = run(scene, "whole", false);
  run(scene, "stopped", true);
  ASSERT_EQ(RunFile(dir_ / "stopped/run.db").checkpoint()->t, 0.23);
  try_mutants(dir_ / "stopped/run.db", [&](const fs::path& at) { return goes_on(scene, at, undisturbed); });
}

TEST_F(Mutants, OfASweepGoOnOrAreRefused) {
  write_bytes(dir_ / "experiment.toml", kExperiment);
  const Experiment experiment = load_experiment(dir_ / "experiment.toml");
  SweepRequest request;
  request.jobs = 1;
  const auto sweep = [&](const fs::path& at) {
    return fine(at / "sweep.db", false, [&] {
      SweepStore store(at, experiment);
      run_sweep(experiment, store, request);
      store.results(experiment);
    });
  };
  fs::create_directory(dir_ / "whole");
  ASSERT_TRUE(sweep(dir_ / "whole"));
  try_mutants(dir_ / "whole/sweep.db", sweep);
}

}  // namespace
}  // namespace brink::run_file_mutation_test
