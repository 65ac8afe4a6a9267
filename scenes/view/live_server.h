#pragma once
/// The replay page of a run that goes on, served on this machine alone.

#include <filesystem>
#include <memory>
#include <string>

namespace brink {

/// Serves the page and the run's data on 127.0.0.1, and nothing else: no file, no other host's requests. The page may ask
/// the run to pause, to go on, and to go on up to its next event. The one door to cpp-httplib.
class LiveServer {
 public:
  /// `run_file`: what the run writes. A port that the system chooses. @throws IoError if none can be had.
  explicit LiveServer(std::filesystem::path run_file);
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  std::string address() const;  ///< "http://127.0.0.1:PORT/"

  // -- for the thread that runs --
  /// True while the run is to wait.
  bool paused() const;
  /// An event has happened: a run that was to go on up to the next one waits from now on.
  void event_happened();
  /// The run has ended: its page stays, and the data are whole.
  void run_ended();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace brink
