/// An experiment file is read in stages, each of which takes for granted that those before found no fault:
///
///     TOML           syntax; then keys and types, by the schema (ExperimentTable)
///     axes           no option twice, not too many runs, the plot's axes and columns exist
///     scenes         each base scene with the settings, then with every value of every axis in turn
///     runs           the product of the axes, a key for each
///
/// All faults of a stage are told at once, each with its place in the experiment file, or in the scene.
/// Values stay TOML text from here to `brink run --set`: what a run of the sweep reads is what the command
/// that `--list` prints would read.
#include "brink/scenes/sweep/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "brink/core/base/hash.h"
#include "brink/core/base/printable.h"
#include "brink/core/world/world_hash.h"
#include "brink/scenes/files/text_file.h"
#include "brink/scenes/scene/tables.h"
#include "brink/scenes/sweep/results.h"
#include "brink/scenes/toml/schema.h"
#include "brink/scenes/version.h"

namespace brink {
namespace fs = std::filesystem;
namespace {

/// Its path. Its values are many, and tell nothing but which random numbers are drawn.
constexpr const char* kSeed = "world.seed";

/// One value of an axis, as people see it and as an override says it.
struct Value {
  std::string text;  ///< for people
  std::string toml;  ///< for an override
  Where where;
};
/// An axis with its values in the file's order; `path` is empty for the scenes alone.
struct Axis {
  std::string name, path;
  std::vector<Value> values;
  Where where;
};
/// One key of [set].
struct Setting {
  std::string path;
  Value value;
};
/// What [plot] says; plot_of() chooses what it leaves out.
struct PlotTable {
  Given<std::string> x, series;
  Given<std::vector<std::string>> y;
};
/// The file as it is read. The short names of axes (policies, orders, seeds) have places of their own, so
/// that all_axes() can put them in one order, whatever the file's is.
struct ExperimentTable {
  std::string title;
  Axis scenes{"scene", "", {}, {}};
  std::vector<Axis> policies, orders, seeds, axes;  ///< none or one; axes: any number
  std::vector<Setting> settings;
  Given<double> until;
  double seconds_limit = 0.0;
  PlotTable plot;
};

/// A value as TOML on one line that reads back as the same value: what --set and --list need.
std::string toml_text(const toml::node& node) {
  if (const auto* number = node.as_floating_point()) {
    const std::string text = number_text(number->get());
    // a float stays one: "2" would read back as an integer
    return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
  }
  if (const toml::array* array = node.as_array()) {
    std::string text;
    for (const toml::node& element : *array) text += (text.empty() ? "" : ", ") + toml_text(element);
    return "[" + text + "]";
  }
  if (const toml::table* table = node.as_table()) {
    std::string text;
    // A JSON string is a TOML basic string: the same escapes.
    for (const auto& [key, value] : *table)
      text += (text.empty() ? "" : ", ") + Json(std::string(key.str())).dump() + " = " + toml_text(value);
    return "{" + text + "}";
  }
  std::ostringstream out;
  // Whole numbers, flags, dates, strings inside of arrays: as toml++ writes them.
  node.visit([&](const auto& value) {
    if constexpr (toml::is_value<decltype(value)>) out << toml::default_formatter{value};
  });
  return out.str();
}

/// A string is shown without its quotes; as an override it keeps them, or "1" would become a number.
Value value_of(const toml::node& node, const TomlDocument& doc) {
  const auto* string = node.as_string();
  const std::string toml = string ? Json(string->get()).dump() : toml_text(node);
  return {string ? string->get() : toml, toml, doc.where(node)};
}

/// A fault in the words that all readers of TOML use: key, what is wrong, what was given, what is allowed.
void fault(TomlDocument& doc, const Where& where, const std::string& key, const std::string& wrong,
           const std::string& what_was_given, const std::string& allowed) {
  doc.faults().add(where, fault_text(key, wrong, what_was_given, allowed));
}

/// An array of one value or more, none twice; nothing after a fault.
std::vector<Value> values_of(const toml::node& node, TomlDocument& doc, const std::string& key) {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty()) {
    fault(doc, doc.where(node), key, array ? "no values" : "wrong type", given(node),
          "an array of one value or more");
    return {};
  }
  std::vector<Value> values;
  for (const toml::node& element : *array) {
    Value value = value_of(element, doc);
    // Compared as overrides: 1 and 1.0 are two values, as they would be two in the scene.
    if (std::any_of(values.begin(), values.end(), [&](const Value& v) { return v.toml == value.toml; }))
      fault(doc, value.where, key, "twice the same value", value.toml, "each value once");
    values.push_back(std::move(value));
  }
  return values;
}

/// Reads an array into a new axis of `member`. Without values there is no axis; why has been told as a
/// fault, and then nothing runs.
std::function<void(const toml::node&, TomlDocument&, ExperimentTable&)> axis_reader(
    std::vector<Axis> ExperimentTable::*member, const std::string& key, const std::string& name,
    const std::string& path) {
  return [=](const toml::node& node, TomlDocument& doc, ExperimentTable& out) {
    std::vector<Value> values = values_of(node, doc, key);
    if (!values.empty()) (out.*member).push_back({name, path, std::move(values), doc.where(node)});
  };
}

/// A count n stands for the seeds 1 to n; an array is an axis as any other.
void read_seeds(const toml::node& node, TomlDocument& doc, ExperimentTable& out) {
  if (!node.is_integer()) return axis_reader(&ExperimentTable::seeds, "seeds", "seed", kSeed)(node, doc, out);
  const std::int64_t count = node.as_integer()->get();
  // Beyond kMostSweepRuns check_count() would refuse all the same, but only after they have been made.
  if (count < 1 || count > static_cast<std::int64_t>(kMostSweepRuns))
    return fault(
        doc, doc.where(node), "seeds", "out of range", given(node),
        fmt::format("a count of 1 to {}, for the seeds 1, 2 ... , or an array of seeds", kMostSweepRuns));
  Axis axis{"seed", kSeed, {}, doc.where(node)};
  for (std::int64_t k = 1; k <= count; ++k)
    axis.values.push_back({std::to_string(k), std::to_string(k), doc.where(node)});
  out.seeds.push_back(std::move(axis));
}

/// Base scenes: `toml` is the path, `text` the file's stem, or the path where two have one stem.
void read_scenes(const toml::node& node, TomlDocument& doc, ExperimentTable& out) {
  out.scenes.where = doc.where(node);
  if (const auto* one = node.as_string())
    out.scenes.values = {value_of(*one, doc)};
  else
    out.scenes.values = values_of(node, doc, "scenes");
  // A set: two files of one name in different folders have one stem, and would be one value in every table.
  std::set<std::string> stems;
  for (Value& scene : out.scenes.values) {
    if (!scene.toml.starts_with('"'))
      fault(doc, scene.where, "scenes", "wrong type", scene.toml,
            "the path of a scene file, from the experiment's folder");
    // A path is no override: it needs no quotes.
    scene.toml = scene.text;
    stems.insert(fs::path(scene.toml).stem().string());
  }
  // By their stems while these tell them apart.
  if (stems.size() == out.scenes.values.size())
    for (Value& scene : out.scenes.values) scene.text = fs::path(scene.toml).stem().string();
}

/// Calls visit(path, node) for everything below `table` that `is_leaf`, in the order of names; tables on
/// the way are parts of a dotted path.
/// TOML itself reads `a.b = 1` and `[a]` with `b = 1` as the same tables.
template <class Leaf, class Visit>
void walk(const toml::table& table, const std::string& path, const Leaf& is_leaf, const Visit& visit) {
  for (const auto& [key, node] : table) {
    const std::string here = (path.empty() ? "" : path + ".") + std::string(key.str());
    if (const toml::table* inner = node.as_table(); inner != nullptr && !is_leaf(node))
      walk(*inner, here, is_leaf, visit);
    else
      visit(here, node);
  }
}

/// Before in the file.
bool earlier(const Where& a, const Where& b) {
  return std::tie(a.line, a.column) < std::tie(b.line, b.column);
}

// A scene's path may be given dotted (solver.step = [...]) or by tables ([axes.solver]): both
// are walked alike.
void read_axes(const toml::node& node, TomlDocument& doc, ExperimentTable& out) {
  const toml::table* table = node.as_table();
  if (table == nullptr)
    return fault(doc, doc.where(node), "axes", "wrong type", given(node),
                 "a table of dotted paths of the scene file, each with an array of values");
  walk(
      *table, "", [](const toml::node&) { return false; },
      [&](const std::string& path, const toml::node& values) {
        axis_reader(&ExperimentTable::axes, "axes." + path, path, path)(values, doc, out);
      });
  // A table's entries come in the order of their names; the file's order is that of their places.
  std::sort(out.axes.begin(), out.axes.end(),
            [](const Axis& a, const Axis& b) { return earlier(a.where, b.where); });
}

/// As read_axes(), but every leaf is one value.
void read_settings(const toml::node& node, TomlDocument& doc, ExperimentTable& out) {
  const toml::table* table = node.as_table();
  if (table == nullptr)
    return fault(doc, doc.where(node), "set", "wrong type", given(node),
                 "a table of dotted paths of the scene file, each with its value");
  walk(
      // An inline table is a value (disc = {radius = 1}), any other a part of the path.
      *table, "", [](const toml::node& inner) { return inner.as_table()->is_inline(); },
      [&](const std::string& path, const toml::node& value) {
        out.settings.push_back({path, value_of(value, doc)});
      });
  std::sort(out.settings.begin(), out.settings.end(),
            [](const Setting& a, const Setting& b) { return earlier(a.value.where, b.value.where); });
}

/// Made once: `brink list` and every experiment share it.
const Schema<PlotTable>& plot_schema() {
  static const Schema<PlotTable> schema =
      Schema<PlotTable>("plot")
          .optional("x", &PlotTable::x, text("axis"), "the first axis of numbers", "along the plot")
          .optional("series", &PlotTable::series, text("axis"), "the first other axis", "one line a value")
          .optional("y", &PlotTable::y, names(), "wall_seconds, energy_drift",
                    "columns of the table, one panel each");
  return schema;
}

/// The keys of an experiment file. Axes and settings are read by functions of their own, since their keys
/// are those of another file.
const Schema<ExperimentTable>& experiment_schema() {
  using T = ExperimentTable;
  static const Schema<T> schema =
      Schema<T>("experiment")
          .key("title", &T::title, text(), "what people call it")
          .custom("scenes", "path or array of paths", "needed", "base scenes, from the experiment's folder",
                  read_scenes)
          .custom("policies", "array of policies", "the scene's", "the axis solver.policy",
                  axis_reader(&T::policies, "policies", "policy", "solver.policy"))
          .custom("orders", "array of orders", "the scene's", "the axis solver.order",
                  axis_reader(&T::orders, "orders", "order", "solver.order"))
          .custom("seeds", "count, or array of seeds", "the scene's", "the axis world.seed", read_seeds)
          .custom("axes", "table of arrays", "none", "any other keys of the scene file, by dotted path",
                  read_axes)
          .custom("set", "table", "none", "keys of the scene file that are the same in every run",
                  read_settings)
          .optional("until", &T::until, number(duration_range()), "the scene's duration", "end of every run")
          .key("seconds_limit", &T::seconds_limit, number(not_negative("s")),
               "wall-clock time after which a run is stopped; 0: none")
          .custom("plot", "table", "", "what the plot shows",
                  [](const toml::node& node, TomlDocument& doc, T& out) {
                    plot_schema().read_node(node, doc, out.plot);
                  });
  return schema;
}

/// In the order of Experiment::axes: the last varies fastest, so seeds of one setting follow each other.
std::vector<Axis> all_axes(ExperimentTable& table) {
  std::vector<Axis> axes{table.scenes};
  for (auto* group : {&table.policies, &table.orders, &table.axes, &table.seeds})
    axes.insert(axes.end(), group->begin(), group->end());
  return axes;
}

/// Faults of axes and settings among themselves.
void check_paths(const std::vector<Axis>& axes, const ExperimentTable& table, TomlDocument& doc) {
  // The scene axis (0) has no path.
  for (std::size_t k = 1; k < axes.size(); ++k)
    for (std::size_t j = 1; j < k; ++j)
      if (axes[j].path == axes[k].path)
        fault(doc, axes[k].where, "axes", "twice the same option", axes[k].path, "each option on one axis");
  // A setting beside an axis of the same option would be overruled by it without a word: the later of two
  // overrides of a key holds.
  for (const Setting& s : table.settings)
    for (const Axis& axis : axes)
      if (axis.path == s.path)
        fault(doc, s.value.where, "set", "the option is on an axis too", s.path,
              "options that are not on an axis");
}

/// Refuses a product that memory and people would not stand.
void check_count(const std::vector<Axis>& axes, TomlDocument& doc) {
  // As a number that cannot overflow.
  double runs = 1.0;
  for (const Axis& axis : axes) runs *= static_cast<double>(axis.values.size());
  if (runs > static_cast<double>(kMostSweepRuns))
    fault(doc, {1, 1}, "experiment", "too many runs", number_text(runs),
          "at most " + std::to_string(kMostSweepRuns));
}

/// The same plot with what was left out chosen, or faults.
SweepPlot plot_of(const PlotTable& table, const std::vector<Axis>& axes, TomlDocument& doc) {
  // `useful`: axes that a plot is worth having along, numbers before words, in the file's order.
  std::vector<std::string> names, useful;
  for (const Axis& axis : axes) names.push_back(axis.name);
  // All values, or none: an axis of numbers and words is one of words.
  const auto numeric = [](const Axis& axis) {
    return std::all_of(axis.values.begin(), axis.values.end(),
                       [](const Value& v) { return as_number(v.text).has_value(); });
  };
  // Numbers first: the x axis is one if there is one. Axes of one value and the seed tell
  // nothing along a plot.
  for (const bool numbers : {true, false})
    for (const Axis& axis : axes)
      if (axis.values.size() > 1 && axis.path != kSeed && numeric(axis) == numbers)
        useful.push_back(axis.name);
  const auto chosen = [&](const Given<std::string>& asked, const char* key, const std::string& otherwise) {
    if (!asked.given) return otherwise;
    if (std::find(names.begin(), names.end(), asked.value) == names.end())
      fault(doc, asked.where, key, "not an axis of this experiment", in_quotes(asked.value), listed(names));
    return asked.value;
  };
  SweepPlot plot;
  plot.x = chosen(table.x, "plot.x", useful.empty() ? names.front() : useful.front());
  // The series is the next one of use: with x as series every line would be a point.
  std::erase(useful, plot.x);
  plot.series = chosen(table.series, "plot.series", useful.empty() ? "" : useful.front());
  plot.y = table.y.given ? table.y.value : std::vector<std::string>{"wall_seconds", "energy_drift"};
  for (const std::string& y : plot.y)
    if (std::find(sweep_columns().begin(), sweep_columns().end(), y) == sweep_columns().end())
      fault(doc, table.y.where, "plot.y", "not a column", in_quotes(y),
            "a column, the nearest is " + in_quotes(nearest_word(y, sweep_columns())));
  return plot;
}

/// As `brink run --set` takes it.
std::string override_text(const std::string& path, const Value& value) { return path + "=" + value.toml; }

/// Loads base scenes with one value of each axis after another; says of a fault in an override where the
/// experiment file asked for it.
class SceneTrial {
 public:
  /// What is read is added to `files`.
  SceneTrial(const fs::path& folder, const std::vector<Setting>& settings, std::set<fs::path>& files,
             TomlDocument& doc)
      : folder_(folder), settings_(settings), files_(files), doc_(doc) {
    for (const Setting& s : settings) common_.push_back(override_text(s.path, s.value));
  }

  /// The identity of the base scene with all settings, or nothing after a fault.
  std::optional<std::uint64_t> base(const Value& scene) {
    try {
      const Scene loaded = load_scene(folder_ / scene.toml, common_);
      files_.insert(loaded.files.begin(), loaded.files.end());
      StateHash hash;
      hash.add(world_hash(loaded.world));
      // Options and world: a title or a comment that is changed does not make a run another one.
      for (const char c : loaded.options_json) hash.add(static_cast<std::uint64_t>(c));
      return hash.value();
    } catch (const SceneFaults& faults) {
      const std::size_t before = doc_.faults().size();
      for (const Setting& s : settings_) tell(faults, s.path, s.value.where, "set." + s.path);
      tell_own(faults, (folder_ / scene.toml).string());
      // Faults of neither kind would be lost, and the experiment would look sound.
      if (doc_.faults().size() == before) throw;
    } catch (const IoError& e) {
      doc_.faults().add(scene.where, std::string("scenes: ") + e.what());
    }
    return std::nullopt;
  }

  /// Reads a seed alone, without the scene: there may be a million of them.
  void seed(const Axis& axis, const Value& value) {
    // An empty scene file with this one override: its key is read as in a whole scene.
    TomlDocument alone("", {override_text(axis.path, value)});
    FileTable file;
    file_schema().read(alone.root(), {1, 1}, alone, file);
    try {
      alone.faults().throw_if_any("");
    } catch (const SceneFaults& faults) {
      // What a scene needs beside its seed is missing here, and is not meant.
      tell(faults, axis.path, value.where, axis.name + " = " + value.toml);
    }
  }

  /// Tries one value alone, with every other axis as the scene has it.
  void value(const Value& scene, const Axis& axis, const Value& value) {
    std::vector<std::string> overrides = common_;
    overrides.push_back(override_text(axis.path, value));
    try {
      const Scene loaded = load_scene(folder_ / scene.toml, overrides);
      files_.insert(loaded.files.begin(), loaded.files.end());
    } catch (const SceneFaults& faults) {
      // what is wrong elsewhere may be right in combination with other axes: it is told of the run, if it
      // comes to it
      tell(faults, axis.path, value.where, axis.name + " = " + value.toml);
    }
  }

 private:
  /// Hands on those faults that the override of `path` has, with the place where the experiment asked for
  /// it.
  void tell(const SceneFaults& faults, const std::string& path, const Where& where, const std::string& what) {
    // As FaultList::add() begins the message of a fault in an override, made printable.
    const std::string mark = printable("--set " + path + ": ");
    for (const SceneFault& f : faults.faults())
      if (f.line == 0 && f.message.starts_with(mark))
        doc_.faults().add(where, what + ": " + f.message.substr(mark.size()));
  }

  /// The scene's own faults, with their places there: those that no override has.
  void tell_own(const SceneFaults& faults, const std::string& scene) {
    for (const SceneFault& f : faults.faults())
      if (f.line > 0)
        doc_.faults().add_elsewhere(f.file.empty() ? scene : f.file, f.line, f.column, f.message);
  }

  fs::path folder_;
  const std::vector<Setting>& settings_;
  std::set<fs::path>& files_;
  TomlDocument& doc_;
  std::vector<std::string> common_;
};

/// Every base scene's identity. Adds faults of values, and the files that are read.
std::vector<std::uint64_t> try_scenes(const std::vector<Axis>& axes, const ExperimentTable& table,
                                      const fs::path& folder, std::set<fs::path>& files, TomlDocument& doc) {
  SceneTrial trial(folder, table.settings, files, doc);
  std::vector<std::uint64_t> identities;
  for (const Axis& axis : axes)
    if (axis.path == kSeed)
      for (const Value& value : axis.values) trial.seed(axis, value);
  for (const Value& scene : axes.front().values) {
    // Of a base scene with faults nothing more is tried: each value would repeat them.
    const auto identity = trial.base(scene);
    if (!identity) continue;
    identities.push_back(*identity);
    for (std::size_t k = 1; k < axes.size(); ++k)
      if (axes[k].path != kSeed)
        for (const Value& value : axes[k].values) trial.value(scene, axes[k], value);
  }
  return identities;
}

/// What a run is known by in the database: content, options, ends and version. Titles and the names of axes
/// have no part in it: a run that two experiments ask for by the same settings and axes is made once.
std::string key_of(std::uint64_t identity, const SweepRun& run, const ExperimentTable& table) {
  StateHash hash;
  hash.add(identity);
  std::string text(version());
  for (const std::string& o : run.overrides) text += '\n' + o;
  for (const char c : text) hash.add(static_cast<std::uint64_t>(c));
  // -1 is no time that may be given.
  hash.add(table.until.given ? table.until.value : -1.0);
  hash.add(table.seconds_limit);
  return hash.text();
}

/// Every combination, the last axis varying fastest. @pre every axis has a value, and one identity a scene.
std::vector<SweepRun> product(const std::vector<Axis>& axes, const ExperimentTable& table,
                              const fs::path& folder, const std::vector<std::uint64_t>& identities) {
  std::vector<SweepRun> runs;
  std::vector<std::size_t> at(axes.size(), 0);
  for (;;) {
    SweepRun run;
    run.scene = folder / axes.front().values[at.front()].toml;
    // Settings first, then axes in their order: so `--list` prints them, and the key depends on this order.
    for (const Setting& s : table.settings) run.overrides.push_back(override_text(s.path, s.value));
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const Value& value = axes[k].values[at[k]];
      run.values.push_back(value.text);
      if (k > 0) run.overrides.push_back(override_text(axes[k].path, value));
    }
    run.key = key_of(identities[at.front()], run, table);
    runs.push_back(std::move(run));
    // An odometer over the axes: the last counts up, and at its end carries to the one before.
    std::size_t k = axes.size();
    while (k > 0 && ++at[k - 1] == axes[k - 1].values.size()) at[--k] = 0;
    if (k == 0) return runs;
  }
}

}  // namespace

std::optional<double> as_number(const std::string& value) {
  // A stream takes a leading number of "1e-3 s", too: all of the text must have been read.
  std::istringstream in(value);
  double x = 0.0;
  return (in >> x) && in.eof() ? std::optional(x) : std::nullopt;
}

Experiment load_experiment(const fs::path& file) {
  TomlDocument doc(text_of_file(file), {});
  // Syntax first, then keys, then axes, then scenes: each needs that those before are sound.
  const auto stop_on_faults = [&] { doc.faults().throw_if_any(file.string()); };
  stop_on_faults();
  ExperimentTable table;
  experiment_schema().read(doc.root(), {1, 1}, doc, table);
  // Asked of the root and not of the axis, which is empty after a fault in it, too.
  if (!doc.root().contains("scenes"))
    fault(doc, {1, 1}, "scenes", "missing", "nothing", "a scene file or an array of them");
  stop_on_faults();
  const std::vector<Axis> axes = all_axes(table);
  check_paths(axes, table, doc);
  check_count(axes, doc);
  Experiment experiment;
  experiment.plot = plot_of(table.plot, axes, doc);
  stop_on_faults();
  // Reads every base scene anew for each value of each axis, but for seeds.
  const auto identities = try_scenes(axes, table, file.parent_path(), experiment.files, doc);
  stop_on_faults();
  experiment.files.insert(file);
  experiment.path = file;
  experiment.title = table.title.empty() ? file.stem().string() : table.title;
  if (table.until.given) experiment.until = table.until.value;
  experiment.seconds_limit = table.seconds_limit;
  experiment.runs = product(axes, table, file.parent_path(), identities);
  for (const Axis& axis : axes) {
    SweepAxis& made = experiment.axes.emplace_back(SweepAxis{axis.name, axis.path, {}});
    for (const Value& v : axis.values) made.values.push_back(v.text);
  }
  return experiment;
}

std::vector<OptionInfo> experiment_options() {
  std::vector<OptionInfo> out;
  experiment_schema().list(out);
  plot_schema().list(out);
  return out;
}

}  // namespace brink
