#include "brink/scenes/run_file/trace_file.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "brink/core/base/error.h"
#include "brink/scenes/files/written_file.h"

namespace brink {
namespace {

/// The text in quotes, escaped; bytes that are no UTF-8 are replaced, where dump() would throw.
std::string json_text(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// What takes a body to another simulated time.
/// A collision does not: it changes how bodies move at a time that they have come to.
bool moves_a_body(TraceKind kind) {
  return kind == TraceKind::advance || kind == TraceKind::back_up || kind == TraceKind::roll_back;
}

}  // namespace

/// Names are made JSON once here: marks come by the hundred thousand. `owners_` is indexed by the ids
/// of marks, bodies first and sites behind them (TraceMark::other).
TraceFile::TraceFile(const std::filesystem::path& file, const World& world)
    : file_(file), out_(file), begin_(std::chrono::steady_clock::now()) {
  if (!out_) throw IoError(fmt::format("{}: cannot be written", file.string()));
  // The array form of the format. Each entry begins with its comma, so after any of them only the
  // bracket is missing, which viewers do not need.
  out_ << "[\n"
       << R"({"ph":"M","name":"process_name","pid":1,"args":{"name":)" << json_text(world.title) << "}}";
  for (const Body& b : world.bodies) owners_.push_back(json_text(b.name));
  for (std::size_t k = 0; k < world.bodies.size(); ++k) name_lane(static_cast<int>(k));
  for (const FixedSite& s : world.sites) owners_.push_back(json_text(s.name));
}

// Metadata entries (ph "M"): the lane's name, and its place in the order of ids.
void TraceFile::name_lane(int body) {
  out_ << fmt::format(
      ",\n"
      R"({{"ph":"M","name":"thread_name","pid":1,"tid":{0},"args":{{"name":{1}}}}})"
      ",\n"
      R"({{"ph":"M","name":"thread_sort_index","pid":1,"tid":{0},"args":{{"sort_index":{0}}}}})",
      body, owners_[static_cast<std::size_t>(body)]);
}

/// One entry, and for what moves a body one more of the track "simulated time". Times of the format are
/// in microseconds of the wall clock. Some 150 bytes; the stream buffers them.
void TraceFile::mark(const TraceMark& m) {
  const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  std::string arguments = fmt::format(R"("from":{},"to":{})", m.from, m.to);
  if (m.other >= 0) arguments += fmt::format(R"(,"other":{})", owners_[static_cast<std::size_t>(m.other)]);
  // Marks come at the ends of what they tell: a slice (ph "X") begins earlier. What is not
  // measured is an instant.
  const std::string how = m.seconds > 0.0 ? fmt::format(R"("ph":"X","dur":{:.3f})", 1e6 * m.seconds)
                                          : std::string(R"("ph":"i","s":"t")");
  out_ << fmt::format(
      ",\n"
      R"({{"name":"{}",{},"ts":{:.3f},"pid":1,"tid":{},"args":{{{}}}}})",
      to_string(m.kind), how, 1e6 * (now - m.seconds), m.body, arguments);
  // Passes and searches move nobody. The counter (ph "C") needs no entry where its value stays.
  if (!moves_a_body(m.kind) || m.to == shown_time_) return;
  shown_time_ = m.to;
  out_ << fmt::format(
      ",\n"
      R"({{"name":"simulated time","ph":"C","ts":{:.3f},"pid":1,"args":{{"s":{}}}}})",
      1e6 * now, m.to);
}

void TraceFile::finish() {
  out_ << "\n]\n";
  out_.close();
  // A stream keeps its first error: whatever was lost on the way is told here.
  if (!out_) throw_not_written(file_);
}

/// Other entries than the scheduler's marks are passed over, so that traces which other programs have
/// added to are read, too.
std::vector<TraceMark> read_trace(const std::filesystem::path& file, int bodies) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw IoError(fmt::format("{}: cannot be read", file.string()));
  // Parsed without exceptions: what is no JSON is a discarded value.
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto parsed = [](const std::string& json) { return nlohmann::json::parse(json, nullptr, false); };
  nlohmann::json all = parsed(text);
  if (all.is_discarded()) all = parsed(text + "]");  // of a run that was killed
  if (!all.is_array()) throw IoError(fmt::format("{}: is not a trace of brink run --trace", file.string()));
  std::vector<TraceMark> marks;
  // A key that is missing, or is no number, is `otherwise`.
  const auto number = [](const nlohmann::json& of, const char* key, double otherwise) {
    return of.contains(key) && of[key].is_number() ? of[key].get<double>() : otherwise;
  };
  for (const nlohmann::json& event : all) {
    // Metadata and counters have no simulated times: by their names they are none of the kinds below.
    if (!event.is_object() || !event.contains("args") || !event["args"].is_object()) continue;
    if (!event.contains("name") || !event["name"].is_string()) continue;
    const std::string name = event["name"];
    // By the words of to_string(), with which mark() writes.
    for (const TraceKind kind : {TraceKind::advance, TraceKind::back_up, TraceKind::roll_back,
                                 TraceKind::pass, TraceKind::search, TraceKind::collision}) {
      if (name != to_string(kind)) continue;
      TraceMark mark;
      mark.kind = kind;
      const double body = number(event, "tid", -1.0);
      // Compared as doubles: a number beyond int must not be cast.
      mark.body = body >= 0.0 && body < bodies ? static_cast<int>(body) : -1;
      mark.from = number(event["args"], "from", std::nan(""));
      mark.to = number(event["args"], "to", std::nan(""));
      if (mark.body < 0 || !std::isfinite(mark.from) || !std::isfinite(mark.to))
        throw IoError(fmt::format("{}: a {} of body {} over [{}, {}] s is not of this run", file.string(),
                                  name, body, mark.from, mark.to));
      marks.push_back(mark);
    }
  }
  return marks;
}

}  // namespace brink
