/// brink regress: the scenes of a folder beside their stored answers.

// All scenes are read first, so that their faults are told at once and before anything is run. Then one after the other
// is run and its line printed; the table is written last, and only if all were run to their ends.
#include "brink/scenes/regress/regress.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <nlohmann/json.hpp>

#include "brink/core/base/error.h"
#include "brink/core/base/printable.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/stopping.h"
#include "brink/scenes/program/terminal.h"

namespace brink {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Counts = std::array<int, kVerdicts>;

/// Refuses what does not go together.
void check(const RegressArguments& arguments) {
  if (arguments.update && !arguments.overrides.empty())
    throw BadInput(
        "--update: given with --set, whose answers are not those of the scenes; allowed: one of the two");
  if (!arguments.reason) return;
  if (!arguments.update) throw BadInput("--reason: given without --update; allowed: with it");
  if (arguments.reason->find_first_of("\r\n") != std::string::npos)
    throw BadInput(fmt::format("--reason: \"{}\" given; allowed: one line", printable(*arguments.reason)));
}

/// Faults of many files, all told at once.
class AllFaults {
 public:
  /// Calls `read`, and keeps what is wrong with `file`.
  template <class Read>
  void gather(const fs::path& file, Read&& read) {
    try {
      read();
    } catch (const SceneFaults& e) {
      for (SceneFault fault : e.faults()) {
        if (fault.file.empty()) fault.file = file.string();
        faults_.push_back(std::move(fault));
      }
    } catch (const BadInput& e) {  // of a world that its options cannot run
      faults_.push_back({1, 1, printable(e.what()), file.string()});
    }
  }
  void throw_if_any() {
    if (!faults_.empty()) throw SceneFaults({}, std::move(faults_));
  }

 private:
  std::vector<SceneFault> faults_;
};

/// Shown while a scene is run, redrawn at most ten times a second; asks whether to go on.
class Following {
 public:
  Following(const Scene& scene, std::size_t number, std::size_t all, bool shown)
      : line_(shown),
        lead_(fmt::format("{} of {}: {}", number, all, printable(scene.path.stem().string()))),
        duration_(scene.duration) {
    line_.say(lead_);
  }
  bool operator()(double t, std::uint64_t collisions) {
    if (const auto now = Clock::now(); now >= next_) {
      line_.say(fmt::format("{}, t = {:.4g} of {:.4g} s, {} collisions", lead_, t, duration_, collisions));
      next_ = now + std::chrono::milliseconds(100);
    }
    return !stop_asked();
  }

 private:
  StatusLine line_;
  std::string lead_;
  double duration_;
  Clock::time_point next_ = Clock::now();
};

std::string words_of(const Answer& a) {
  return fmt::format("{} at t = {} s, {} collisions, {} J, {}", a.ended, a.end_time, a.collisions, a.energy,
                     a.hash);
}

/// "differs  letters: stored ..., met ...".
void print_line(const Comparison& c) {
  const bool good = c.verdict == Verdict::same || c.verdict == Verdict::not_comparable;
  fmt::print("{}  {}",
             paint(stdout, good ? Paint::good : Paint::bad, fmt::format("{:<7}", to_string(c.verdict))),
             printable(c.scene));
  switch (c.verdict) {
    case Verdict::same:
      break;
    case Verdict::differs:
      fmt::print(": stored {}; met {}", words_of(*c.stored), words_of(*c.met));
      break;
    case Verdict::unstored:
      fmt::print(": no stored answer; met {}", words_of(*c.met));
      break;
    case Verdict::gone:
      fmt::print(": stored {}; there is no such scene", words_of(*c.stored));
      break;
    case Verdict::not_comparable:
      fmt::print(" on this machine, whose solver is another one than where the answers were stored: met {}",
                 words_of(*c.met));
      break;
  }
  fmt::print("\n");
  // A run may take minutes: who reads through a pipe gets each line when it is known.
  std::fflush(stdout);
}

Counts counts_of(const std::vector<Comparison>& compared) {
  Counts counts{};
  for (const Comparison& c : compared) ++counts[static_cast<std::size_t>(c.verdict)];
  return counts;
}

int count(const Counts& counts, Verdict verdict) { return counts[static_cast<std::size_t>(verdict)]; }

std::string counts_line(const Counts& counts) {
  return fmt::format("{} same, {} differ, {} new, {} gone, {} not comparable on this machine",
                     count(counts, Verdict::same), count(counts, Verdict::differs),
                     count(counts, Verdict::unstored), count(counts, Verdict::gone),
                     count(counts, Verdict::not_comparable));
}

nlohmann::ordered_json json_of(const std::optional<Answer>& a) {
  if (!a) return nullptr;
  return {{"termination", a->ended},
          {"end_time", a->end_time},
          {"collisions", a->collisions},
          {"energy_final", a->energy},
          {"state_hash", a->hash}};
}

/// One line: counts, then every scene. Numbers are texts, as the table has them.
void print_json(const std::vector<Comparison>& compared, const Counts& counts, bool updated) {
  nlohmann::ordered_json scenes = nlohmann::ordered_json::array();
  for (const Comparison& c : compared)
    scenes.push_back({{"scene", c.scene},
                      {"result", to_string(c.verdict)},
                      {"stored", json_of(c.stored)},
                      {"met", json_of(c.met)}});
  const nlohmann::ordered_json all = {{"same", count(counts, Verdict::same)},
                                      {"differ", count(counts, Verdict::differs)},
                                      {"new", count(counts, Verdict::unstored)},
                                      {"gone", count(counts, Verdict::gone)},
                                      {"not_comparable", count(counts, Verdict::not_comparable)},
                                      {"updated", updated},
                                      {"scenes", std::move(scenes)}};
  fmt::print("{}\n", all.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

int stopped() {
  fmt::print(stderr, "brink: stopped before all scenes were run; nothing was written\n");
  return kEndedEarly;
}

}  // namespace

int regress_command(const RegressArguments& arguments) {
  check(arguments);
  stop_on_signals();
  const bool lines = !arguments.quiet && !arguments.json, shown = on_terminal(stderr) && !arguments.quiet;
  const fs::path folder = arguments.folder, table_file = answers_file(folder);
  const std::vector<fs::path> files = scenes_of(folder);
  AllFaults faults;
  AnswerTable table;
  faults.gather(table_file, [&] { table = read_answers(table_file); });
  if (files.empty() && table.answers.empty())
    faults.gather(folder,
                  [] { throw BadInput("no scenes; allowed: a folder that holds some, each NAME.toml"); });
  std::vector<Scene> scenes;
  for (const fs::path& file : files) {
    if (stop_asked()) return stopped();
    faults.gather(file, [&] { scenes.push_back(load_scene(file, arguments.overrides)); });
  }
  faults.throw_if_any();

  std::vector<Comparison> compared;
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    faults.gather(scenes[k].path, [&] {
      RunSummary met;
      {
        Following following(scenes[k], k + 1, scenes.size(), shown);
        met = run_for_answer(scenes[k], std::ref(following));
      }
      if (stop_asked()) return;
      compared.push_back(compare(files[k].stem().string(), met, table));
      if (lines) print_line(compared.back());
    });
    if (stop_asked()) return stopped();
  }
  faults.throw_if_any();
  for (const Comparison& c : gone_from(table, files)) {
    compared.push_back(c);
    if (lines) print_line(c);
  }

  if (arguments.update) write_answers(table_file, updated(table, compared, arguments.reason));
  const Counts counts = counts_of(compared);
  if (lines) fmt::print("{}\n", counts_line(counts));
  if (lines && arguments.update) fmt::print("{} written\n", printable(table_file.string()));
  if (arguments.json) print_json(compared, counts, arguments.update);
  const bool good =
      count(counts, Verdict::differs) + count(counts, Verdict::unstored) + count(counts, Verdict::gone) == 0;
  if (good || arguments.update) return kDone;
  // Without lines a bad result would be told by the exit status alone.
  if (!lines) fmt::print(stderr, "brink: {}\n", counts_line(counts));
  return kEndedEarly;
}

}  // namespace brink
