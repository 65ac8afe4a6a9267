#pragma once
/// The scheduler's timeline as a file in the Chrome trace format (JSON), which ui.perfetto.dev and
/// chrome://tracing open. Format: "Trace Event Format", Google, 2016.
///
/// A lane a body (pid 1, tid = body). Along the lane runs wall-clock time since the file was opened
/// [microseconds]; the simulated times are arguments of each entry. Passes and searches of one body are
/// slices with their duration; advances, backups, rollbacks, collisions, and passes of all bodies at once are
/// instants. The track "simulated time" shows how far the body last moved has come [s].

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "brink/core/world/world.h"
#include "brink/scheduler/run/trace.h"

namespace brink {

class TraceFile final : public TraceSink {
 public:
  /// @throws IoError if the file cannot be written.
  TraceFile(const std::filesystem::path& file, const World& world);

  void mark(const TraceMark& mark) override;
  /// Ends the JSON. A file that was never finished is read by the viewers all the same.
  /// @throws IoError if something could not be written.
  void finish();

 private:
  void name_lane(int body);

  std::filesystem::path file_;
  std::ofstream out_;
  std::vector<std::string> owners_;  ///< names as JSON: bodies first, then sites
  double shown_time_ = -1.0;         ///< the last value of the track "simulated time" [s]
  std::chrono::steady_clock::time_point begin_;
};

/// What a trace tells, in its order; wall-clock times are left out. @throws IoError if the file cannot be read, is no
/// trace, or tells of a body beyond `bodies`, or of a time that is none. Cost: reads the whole file.
std::vector<TraceMark> read_trace(const std::filesystem::path& file, int bodies);

}  // namespace brink
