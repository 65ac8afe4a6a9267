#pragma once
/// The replay page: a run as one HTML file that plays it, without network. What it holds is in docs/replay.md.

#include <cstdint>
#include <filesystem>
#include <string>

namespace brink {

struct ReplayLimits {
  /// Frames times bodies; a run with more is thinned, and the page says so.
  std::int64_t frame_rows = 1'200'000;
  /// Likewise: of more the page has the first ones, of a run that goes on the last ones.
  std::int64_t events = 300'000;
  std::int64_t knots = 1'200'000;  ///< likewise
  std::filesystem::path
      trace;  ///< what `brink run --trace` wrote: lanes of what the scheduler did; empty: none
  std::int64_t marks = 300'000;  ///< of the trace, likewise
};

/// Writes the page of the run in `run_file`. Between two of a body's recorded states (frames, and its collisions
/// with the twist before and after) the page shows the cubic with their places and twists: exact for constant
/// accelerations, else off by the fourth order of their distance in time.
/// @throws IoError if the run cannot be read or the page not written.
void write_replay_page(const std::filesystem::path& run_file, const std::filesystem::path& page,
                       const ReplayLimits& limits = {});

/// The same as text. `live`: the page of a run that goes on; it asks for data again (live_server.h).
std::string replay_page_text(const std::filesystem::path& run_file, const ReplayLimits& limits, bool live);
/// What such a page asks for: {"about": ..., "numbers": ...} in JSON.
std::string replay_page_data(const std::filesystem::path& run_file, const ReplayLimits& limits, bool live);

}  // namespace brink
