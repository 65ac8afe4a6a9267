/// brink list: what can be chosen, one line each.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "brink/core/base/error.h"
#include "brink/core/base/printable.h"
#include "brink/integrators/integrator.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/gallery.h"
#include "brink/scenes/program/terminal.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/run/options.h"

namespace brink {
namespace {

/// One line of a list: what is typed, and what it means.
struct Line {
  std::string name, text;
};
using Lines = std::vector<Line>;

/// What can be chosen by name, with the default marked from the struct that has it.
template <class Registry>
Lines from_registry(const Registry& registry, std::string_view chosen) {
  Lines lines;
  for (const auto& entry : registry) {
    // Marked where it stands, so that a list keeps the registry's order.
    const char* mark = entry.name == chosen ? " (default)" : "";
    lines.push_back({std::string(entry.name), fmt::format("{}{}", entry.summary, mark)});
  }
  return lines;
}

/// Every key of the scene file by its dotted path, with meaning, type and default, from the schemas that
/// read it.
Lines option_lines() {
  Lines lines;
  for (const OptionInfo& o : scene_options()) {
    lines.push_back({o.table.empty() ? o.key : o.table + "." + o.key,
                     fmt::format("{}; {} [{}]", o.meaning, o.type, o.default_value)});
  }
  return lines;
}

/// The kinds of [[forces]], each with its keys. A table of a force is one whose `kind` may be its own name.
Lines force_lines() {
  // A force has a key `kind` whose type lists all kinds, so its table's name is among them; `sampling`
  // has one, too, but is no kind of its own.
  const std::vector<OptionInfo> options = scene_options();
  Lines lines;
  for (const OptionInfo& kind : options) {
    if (kind.key != "kind" || kind.type.find(kind.table) == std::string::npos) continue;
    std::string keys;
    for (const OptionInfo& o : options) {
      if (o.table == kind.table && o.key != "kind") keys += (keys.empty() ? "" : ", ") + o.key;
    }
    lines.push_back({kind.table, keys});
  }
  return lines;
}

/// The gallery, each scene by the path that `brink run` takes from here.
Lines scene_lines() {
  Lines lines;
  for (const GalleryScene& scene : gallery_scenes())
    lines.push_back({printable(scene.path.string()), printable(scene.title)});
  return lines;
}

// A topic is found when it is asked for: the list of policies may have grown.
struct Topic {
  const char* name;
  Lines (*lines)();
};

// SolverOptions is the only home of the defaults.
const SolverOptions kDefaults;
const Topic kTopics[] = {
    {"policies", [] { return from_registry(policies(), kDefaults.policy); }},
    {"integrators", [] { return from_registry(integrators(), kDefaults.integrator); }},
    {"responses", [] { return from_registry(responses(), kDefaults.response); }},
    {"detectors", [] { return from_registry(detectors(), kDefaults.detector); }},
    {"orders", [] { return from_registry(orders(), kDefaults.order); }},
    {"forces", force_lines},
    {"scenes", scene_lines},
    {"options", option_lines},
};

/// Names in a column as wide as the longest of the topic.
void print(const Topic& topic) {
  const Lines lines = topic.lines();
  std::size_t width = 0;
  for (const Line& line : lines) width = std::max(width, line.name.size());
  for (const Line& line : lines) fmt::print("{:<{}}  {}\n", line.name, width, line.text);
}

}  // namespace

std::vector<std::string> list_topics() {
  std::vector<std::string> names;
  for (const Topic& t : kTopics) names.emplace_back(t.name);
  return names;
}

int list_command(const ListArguments& arguments) {
  for (const Topic& topic : kTopics) {
    if (!arguments.topic.empty() && arguments.topic != topic.name) continue;
    // Headings only where there are several topics: one alone can be read by programs line by line.
    if (arguments.topic.empty()) fmt::print("{}\n", paint(stdout, Paint::heading, topic.name));
    print(topic);
    if (arguments.topic.empty()) fmt::print("\n");
  }
  return kDone;
}

}  // namespace brink
