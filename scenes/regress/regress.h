#pragma once
/// Whether the scenes of a folder still come to what they came to.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "brink/scenes/regress/answers.h"
#include "brink/scenes/scene/scene.h"

namespace brink {

/// What is said of a scene when its answers are compared.
enum class Verdict {
  same,
  differs,
  unstored,        ///< "new": there is no stored answer
  gone,            ///< there is a stored answer, and no scene
  not_comparable,  ///< it differs, and needs a solver that is another one than where the answers were stored
};
inline constexpr int kVerdicts = 5;

/// The word for people and programs.
const char* to_string(Verdict verdict);

struct Comparison {
  std::string scene;
  Verdict verdict = Verdict::same;
  std::optional<Answer> stored, met;
};

/// The scene files that stand in `folder` itself, by name. @throws IoError.
std::vector<std::filesystem::path> scenes_of(const std::filesystem::path& folder);

/// The table of `folder`: answers.csv in it.
std::filesystem::path answers_file(const std::filesystem::path& folder);

/// Runs a scene to its duration, and records nothing. `progress` may be empty; see RunOptions.
/// @throws SceneFaults for a scene that cannot start.
RunSummary run_for_answer(const Scene& scene,
                          const std::function<bool(double t, std::uint64_t collisions)>& progress = {});

/// What the run of `scene` came to beside what is stored.
Comparison compare(const std::string& scene, const RunSummary& met, const AnswerTable& stored);

/// What is stored of scenes that are not among `scenes`.
std::vector<Comparison> gone_from(const AnswerTable& stored,
                                  const std::vector<std::filesystem::path>& scenes);

/// The table that holds what was met. Reasons stay where answers do, and where nobody can compare; others get `reason`,
/// new scenes without one "first stored".
AnswerTable updated(const AnswerTable& stored, const std::vector<Comparison>& compared,
                    const std::optional<std::string>& reason);

}  // namespace brink
