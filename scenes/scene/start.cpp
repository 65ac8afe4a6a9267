#include "brink/scenes/scene/start.h"

#include "brink/core/base/printable.h"

namespace brink {

void require_start(const Scene& scene, const Simulator& simulator) {
  const std::string why = simulator.start_fault();
  if (why.empty()) return;
  const int deepest = simulator.overlaps().front().body;
  const ScenePlace place = scene.body_places.at(static_cast<std::size_t>(deepest));
  throw SceneFaults(scene.path, {{place.line, place.column, printable(why), {}}});
}

}  // namespace brink
