#include "brink/scenes/program/live_page.h"

#include <chrono>
#include <thread>

#include "brink/scenes/program/stopping.h"
#include "brink/scenes/program/terminal.h"

namespace brink {

RunReport run_shown(const Scene& scene, RunRequest& request, bool bar) {
  ProgressBar progress(0.0, request.until.value_or(scene.duration), bar);
  request.progress = [&progress](double t, std::uint64_t collisions) {
    if (stop_asked()) progress.stopping();
    progress.show(t, collisions);
    return !stop_asked();
  };
  return run_scene(scene, request);
}

LivePage::LivePage(RunRequest& request) : server_(request.dir / "run.db") {
  request.happened = [this](const Event&) { server_.event_happened(); };
  request.waits = [this] { return server_.paused() && !stop_asked(); };
}

void LivePage::stay() {
  server_.run_ended();
  while (!stop_asked()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

}  // namespace brink
