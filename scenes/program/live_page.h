#pragma once
/// A run of the program that shows itself: a progress bar, and a page that follows it.

#include <string>

#include "brink/scenes/run_file/run_scene.h"
#include "brink/scenes/view/live_server.h"

namespace brink {

/// run_scene() until Ctrl-C at most; `bar`: how far it has come is drawn on standard error.
RunReport run_shown(const Scene& scene, RunRequest& request, bool bar);

/// The page of one run, from before it begins until Ctrl-C.
class LivePage {
 public:
  /// The request's run is followed from now on. @pre its folder is known; @throws IoError where no port can be had.
  explicit LivePage(RunRequest& request);

  std::string address() const { return server_.address(); }
  /// The run has ended: the page stays, and so does this call, until Ctrl-C.
  void stay();

 private:
  LiveServer server_;
};

}  // namespace brink
