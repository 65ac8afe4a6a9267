// The classic text data files that a scene names.
#include <fstream>
#include <sstream>

#include "brink/core/shapes/sample_file.h"
#include "brink/scenes/scene/build.h"

namespace brink {
namespace {

/// As text_file.cpp allows of a scene.
constexpr std::uintmax_t kLargestFile = 100'000'000;  // bytes

/// What the scene itself says goes before what its data file says.
template <class V>
void fill(Given<V>& key, const V& value, const Where& where) {
  if (!key.given) key = {value, where, true};
}

void fill_state(ThingTable& thing, const SampledBody& body, const Where& where, bool is_body) {
  fill(thing.position, body.position, where);
  // angle and angle_deg are one: either keeps the file's away.
  if (!thing.angle.given) fill(thing.angle_deg, body.rotation_degrees, where);
  if (!is_body) return;
  // A density gives the mass. A site has neither mass nor velocities.
  if (!thing.density.given) fill(thing.mass, body.mass, where);
  fill(thing.velocity, body.velocity, where);
  fill(thing.angular_velocity, body.omega, where);
}

std::optional<std::string> text_of(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) ||
      std::filesystem::file_size(path, error) > kLargestFile || error)
    return std::nullopt;
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in || in.bad()) return std::nullopt;
  return text.str();
}

void take(ThingTable& thing, ShapeSpec& spec, const std::filesystem::path& folder, bool is_body,
          FaultList& faults) {
  const std::filesystem::path path = folder / *spec.data_file;
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

void take_sample_files(FileTable& file, const std::filesystem::path& folder, FaultList& faults) {
  for (auto* things : {&file.bodies, &file.sites})
    for (ThingTable& thing : *things)
      for (ShapeSpec& spec : thing.shapes)
        if (spec.data_file) take(thing, spec, folder, things == &file.bodies, faults);
}

}  // namespace brink
