#include "brink/scenes/program/live_page.h"

#include <chrono>
#include <thread>

#include "brink/scenes/program/stopping.h"
#include "brink/scenes/program/terminal.h"

namespace brink {

RunReport run_shown(const Scene& scene, RunRequest& request, bool bar) {
  // The bar counts from 0 also where a run is resumed: how much of the whole is done.
  ProgressBar progress(0.0, request.until.value_or(scene.duration), bar);
  request.progress = [&progress](double t, std::uint64_t collisions) {
    // The bar says so at once; the run ends at this call's return.
    if (stop_asked()) progress.stopping();
    progress.show(t, collisions);
    // False ends the run at its next chance, with a checkpoint to go on from.
    return !stop_asked();
  };
  return run_scene(scene, request);
}

// The request holds functions that refer to this page: it must be there as long as the run is.
LivePage::LivePage(RunRequest& request) : server_(request.dir / "run.db") {
  // Called from the thread that runs; the page's orders come by the server's.
  request.happened = [this](const Event&) { server_.event_happened(); };
  // A run that waits for the page must hear Ctrl-C.
  request.waits = [this] { return server_.paused() && !stop_asked(); };
}

void LivePage::stay() {
  // From now on the data say that they are whole, and the page stops asking.
  server_.run_ended();
  // A run that has ended by itself leaves its page up.
  while (!stop_asked()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

}  // namespace brink
