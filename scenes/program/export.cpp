/// brink export: a run's tables for other programs.

#include <fmt/format.h>

#include <filesystem>

#include "brink/core/base/error.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/run_folder.h"
#include "brink/scenes/run_file/run_hdf5.h"
#include "brink/scenes/run_file/run_tables.h"

namespace brink {

int export_command(const ExportArguments& arguments) {
  namespace fs = std::filesystem;
  const fs::path file = run_file_of(arguments.run);
  if (file.empty())
    throw BadInput(fmt::format("{}: not a run; allowed: a run folder or a run file", arguments.run));
  if (arguments.csv.empty() && arguments.hdf5.empty())
    throw BadInput("nothing to write; allowed: --csv DIR, --hdf5 DIR");
  if (!arguments.csv.empty()) write_csv_tables(file, arguments.csv);
  if (!arguments.hdf5.empty()) {
    std::error_code error;
    fs::create_directories(arguments.hdf5, error);
    if (error) throw IoError(fmt::format("{}: cannot be made: {}", arguments.hdf5, error.message()));
    write_hdf5(file, fs::path(arguments.hdf5) / "run.h5");
  }
  return kDone;
}

}  // namespace brink
