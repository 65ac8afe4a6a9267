#pragma once
/// Many random worlds, and the tally of them.

#include <cstdlib>
#include <iostream>
#include <map>

#include "random_worlds.h"
#include "tests/support/seeded_worlds.h"
#include "world_runs.h"

namespace brink::worlds {

using testing::from_environment;

struct Tally {
  long worlds = 0, runs = 0, looks = 0, reached_end = 0, wrong = 0, refused = 0;
  std::uint64_t collisions = 0;
  std::map<std::string, long> endings;
};

inline std::ostream& operator<<(std::ostream& out, const Tally& t) {
  out << t.worlds << " worlds, " << t.runs << " runs, " << t.collisions << " collisions, " << t.looks
      << " looks from outside; " << t.reached_end << " reached the end, " << t.refused << " refused, "
      << t.wrong << " wrong\n";
  for (const auto& [what, count] : t.endings) out << "  " << count << " x " << what << "\n";
  return out;
}

/// The first words of an ending, without its numbers and names.
inline std::string kind_of(const std::string& ending) {
  std::string kind;
  for (const char c : ending.substr(0, 60)) {
    if (std::isdigit(static_cast<unsigned char>(c))) break;
    kind += c;
  }
  return kind;
}

/// True if the run was ended by the framework's own watch: honest, and a fault of its search all the same.
inline bool ended_by_watch(const std::string& ending) {
  return ending.find("this must not be") != std::string::npos;
}

/// Adds what `examine` finds in the world of a seed to the tally; on a fault its scene is kept.
template <class Examine>
bool count(std::uint64_t seed, const std::string& text, Tally& tally, const Examine& examine) {
  const std::string name = "seed_" + std::to_string(seed) + ".toml";
  ++tally.worlds;
  Verdict verdict;
  try {
    verdict = examine(name);
  } catch (const BadInput& e) {
    ++tally.refused;
    ++tally.endings["refused: " + kind_of(e.what())];
    return true;
  }
  tally.runs += verdict.runs;
  tally.looks += verdict.looks;
  tally.collisions += verdict.collisions;
  tally.reached_end += verdict.reached_end;
  ++tally.endings[kind_of(verdict.ending)];
  if (ended_by_watch(verdict.ending)) verdict.faults.push_back("ended by the watch");
  if (verdict.faults.empty()) return true;
  ++tally.wrong;
  std::cout << "seed " << seed << " (" << verdict.collisions << " collisions, " << verdict.ending << ")\n";
  for (const std::string& f : verdict.faults) std::cout << "  " << f << "\n";
  std::cout << std::flush;
  testing::keep(name, text);
  return false;
}

/// Examines the world of a seed.
inline bool examine_seed(std::uint64_t seed, const Taste& taste, Tally& tally) {
  const std::string text = random_world(seed, taste);
  return count(seed, text, tally, [&](const std::string& name) { return Examiner().examine(text, name); });
}

}  // namespace brink::worlds
