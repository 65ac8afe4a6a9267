#include "brink/scenes/regress/regress.h"

#include <algorithm>
#include <set>

#include "brink/core/base/error.h"
#include "brink/core/base/printable.h"
#include "brink/integrators/solver_probe.h"
#include "brink/scenes/scene/start.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink {
namespace fs = std::filesystem;

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::same:
      return "same";
    case Verdict::differs:
      return "differs";
    case Verdict::unstored:
      return "new";
    case Verdict::gone:
      return "gone";
    case Verdict::not_comparable:
      return "not comparable";
  }
  return "";
}

std::vector<fs::path> scenes_of(const fs::path& folder) {
  std::error_code error, ignored;
  std::vector<fs::path> scenes;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == ".toml" && entry->is_regular_file(ignored))
      scenes.push_back(entry->path());
  if (error) throw IoError(folder.string() + ": cannot be read: " + error.message());
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

fs::path answers_file(const fs::path& folder) { return folder / "answers.csv"; }

RunSummary run_for_answer(const Scene& scene, const std::function<bool(double, std::uint64_t)>& progress) {
  Simulator simulator(scene.world, scene.solver);
  require_start(scene, simulator);
  RunOptions options;
  options.until = scene.duration;
  options.checkpoint_seconds = -1.0;
  options.progress = progress;
  return simulator.run(options);
}

Comparison compare(const std::string& scene, const RunSummary& met, const AnswerTable& stored) {
  Comparison c{scene, Verdict::unstored, {}, answer_of(met)};
  const auto found = stored.answers.find(scene);
  if (found == stored.answers.end()) return c;
  c.stored = found->second;
  const bool other_solver = is_by_solver(met) && stored.probe != solver_probe();
  c.verdict = c.stored->same_as(*c.met) ? Verdict::same
              : other_solver            ? Verdict::not_comparable
                                        : Verdict::differs;
  return c;
}

std::vector<Comparison> gone_from(const AnswerTable& stored, const std::vector<fs::path>& scenes) {
  std::set<std::string> there;
  for (const fs::path& file : scenes) there.insert(file.stem().string());
  std::vector<Comparison> gone;
  for (const auto& [scene, answer] : stored.answers)
    if (!there.contains(scene)) gone.push_back({scene, Verdict::gone, answer, {}});
  return gone;
}

AnswerTable updated(const AnswerTable& stored, const std::vector<Comparison>& compared,
                    const std::optional<std::string>& reason) {
  AnswerTable table{solver_probe(), {}};
  for (const Comparison& c : compared) {
    if (!c.met) continue;
    Answer answer = *c.met;
    if (c.verdict == Verdict::unstored)
      answer.reason = reason.value_or("first stored");
    else if (c.verdict == Verdict::differs)
      answer.reason = reason.value_or("no reason given");
    else
      answer.reason = stored.answers.at(c.scene).reason;
    table.answers.emplace(c.scene, answer);
  }
  return table;
}

}  // namespace brink
