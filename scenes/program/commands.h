#pragma once
/// The commands of `brink`, each a file of its own: what it is asked for, and what it ends with. How the command line
/// spells that is command_line.h's business.

#include <optional>
#include <string>
#include <vector>

namespace brink {

/// What `brink` exits with.
enum ExitStatus : int {
  kDone = 0,
  kEndedEarly = 1,  ///< the run file holds all up to there
  kBadInput = 2,    ///< bad usage or bad input
  kIoFailed = 3,    ///< could not read or write
};

struct RunArguments {
  std::string scene, out, trace;
  std::vector<std::string> overrides;
  std::optional<double> until;
  int threads = 1;
  bool resume = false, quiet = false, json = false, watch = false, profile = false;
};

struct CheckArguments {
  std::string scene;
  std::vector<std::string> overrides;
};

struct DrawArguments {
  std::string subject, out, layer = "scene", size = "1200x900", view;
  bool plain = false, axes = false, names = false, trails = false, velocities = false, contacts = false;
  std::optional<double> at;
  std::vector<std::string> overrides;
};

struct ViewArguments {
  std::string subject, out, trace;
  std::vector<std::string> overrides;
  bool open = false;
};

struct FilmArguments {
  std::string run, out, layer = "plain", size = "1280x720";
  double fps = 60.0, speed = 1.0;
  std::optional<double> from, to;
};

struct ExportArguments {
  std::string run, csv, hdf5, vtk;
};

struct ListArguments {
  std::string topic;  ///< empty: every one
};

struct BenchArguments {
  std::vector<std::string> names;
  std::string out;
  int repeats = 5;
  bool list = false;
};

struct SweepArguments {
  std::string experiment, out;
  int jobs = 0;
  bool quiet = false, dry = false;
};

struct RegressArguments {
  std::string folder;
  std::vector<std::string> overrides;
  std::optional<std::string> reason;
  bool update = false, quiet = false, json = false;
};

/// Each returns an ExitStatus. @throws BadInput, SceneFaults (a BadInput), IoError
int run_command(const RunArguments& arguments);
int check_command(const CheckArguments& arguments);
int draw_command(const DrawArguments& arguments);
int view_command(const ViewArguments& arguments);
int film_command(const FilmArguments& arguments);
int export_command(const ExportArguments& arguments);
int list_command(const ListArguments& arguments);
int bench_command(const BenchArguments& arguments);
int sweep_command(const SweepArguments& arguments);
int regress_command(const RegressArguments& arguments);
/// What `brink list` can be asked for.
std::vector<std::string> list_topics();

}  // namespace brink
