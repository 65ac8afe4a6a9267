// The classic text data files that a scene names.
// They are read after all tables, as only then it is known what the scene itself says of each body, and
// before any shape is built. The format is in docs/scene-format.md.
#include <algorithm>

#include "brink/core/base/error.h"
#include "brink/core/shapes/sample_file.h"
#include "brink/scenes/files/text_file.h"
#include "brink/scenes/scene/build.h"

namespace brink {
namespace {

/// What the scene itself says goes before what its data file says.
template <class V>
void fill(Given<V>& key, const V& value, const Where& where) {
  if (!key.given) key = {value, where, true};
}

/// Where the body stands and how it moves, by the file, key by key where the scene leaves it open.
void fill_state(ThingTable& thing, const SampledBody& body, const Where& where, bool is_body) {
  // A scatter places its copies: the file's position would be one that nobody gave and that is not used.
  if (!thing.scatter.given) fill(thing.position, body.position, where);
  // angle and angle_deg are one: either keeps the file's away.
  if (!thing.angle.given) fill(thing.angle_deg, body.rotation_degrees, where);
  if (!is_body) return;
  // A density gives the mass. A site has neither mass nor velocities.
  if (!thing.density.given) fill(thing.mass, body.mass, where);
  fill(thing.velocity, body.velocity, where);
  fill(thing.angular_velocity, body.omega, where);
}

std::optional<std::string> text_of(const std::filesystem::path& path) {
  // A scene may come from anywhere: a pipe or a device that it names would be waited for.
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  try {
    return text_of_file(path);
  } catch (const IoError&) {
    return std::nullopt;
  }
}

/// One data file. After a fault in it the shape stays without `build`, which ShapeBuilder takes for
/// told.
void take(ThingTable& thing, ShapeSpec& spec, const std::filesystem::path& path, bool is_body,
          FaultList& faults) {
  const auto text = text_of(path);
  if (!text)
    return faults.add(spec.where,
                      "samples: the file cannot be read; given " + in_quotes(path.string()) +
                          ", allowed: a text file of at most 1e8 bytes, named relative to the scene");
  std::vector<SampleFileFault> found;
  const SampledBody body = read_sample_file(*text, found);
  for (const SampleFileFault& f : found) faults.add_elsewhere(path.string(), f.line, f.column, f.message);
  if (!found.empty()) return;
  fill_state(thing, body, spec.where, is_body);
  spec.samples = body.samples;
  // Equal samples make equal shapes: bodies from copies of one file share an outline.
  spec.parameters = points(1).write(body.samples);
  spec.build = [samples = body.samples](const ShapeContext&) { return shape_of_samples(samples); };
}

}  // namespace

void take_sample_files(FileTable& file, const std::filesystem::path& folder,
                       std::vector<std::filesystem::path>& files, FaultList& faults) {
  for (auto* things : {&file.bodies, &file.sites})
    for (ThingTable& thing : *things)
      for (ShapeSpec& spec : thing.shapes)
        if (spec.data_file) {
          const std::filesystem::path path = folder / *spec.data_file;
          // Bodies may share a file.
          if (std::find(files.begin(), files.end(), path) == files.end()) files.push_back(path);
          take(thing, spec, path, things == &file.bodies, faults);
        }
}

}  // namespace brink
