#pragma once
/// `brink bench rest`: what contacts that last cost, and how exact they are.

#include <filesystem>

namespace brink::bench {

/// `repeats`: of each setting, at most. Prints error against run time of problems with closed forms (rest.csv, rest.png), then heaps that settle: time at
/// rest, processor time and deepest overlap, with Box2D and Chipmunk beside where Brink was built with them
/// (settling.csv). False if a run of Brink ended early.
bool run_rest(const std::filesystem::path& folder, int repeats);

}  // namespace brink::bench
