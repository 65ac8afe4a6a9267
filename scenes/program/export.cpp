/// brink export: a run's tables for other programs.

#include <filesystem>
#include <string>
#include <vector>

#include "brink/core/base/error.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/run_folder.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/run_hdf5.h"
#include "brink/scenes/run_file/run_tables.h"
#include "brink/scenes/run_file/run_vtk.h"

namespace brink {
namespace {

namespace fs = std::filesystem;

/// Refuses a folder in which one of the files would be written over what the run was made of.
void refuse_in(const std::string& folder, const std::string& option, const std::vector<std::string>& names,
               const std::vector<fs::path>& kept) {
  if (folder.empty()) return;
  for (const std::string& name : names) refuse_overwriting(fs::path(folder) / name, option, kept);
}

}  // namespace

int export_command(const ExportArguments& arguments) {
  // What is missing is told before anything is read: a folder of results is made only for a run that there
  // is.
  const fs::path file = required_run_file(arguments.run);
  // A command that does nothing would look as if it had worked.
  if (arguments.csv.empty() && arguments.hdf5.empty() && arguments.vtk.empty())
    throw BadInput("nothing to write; allowed: --csv DIR, --hdf5 DIR, --vtk DIR");
  const std::vector<fs::path> kept = RunFile(file).files();
  refuse_in(arguments.csv, "--csv",
            {"bodies.csv", "sites.csv", "frames.csv", "events.csv", "contacts.csv", "knots.csv"}, kept);
  refuse_in(arguments.hdf5, "--hdf5", {"run.h5"}, kept);
  // Of the frames, which are many, the first.
  refuse_in(arguments.vtk, "--vtk", {"run.pvd", "events.vtp", "frame_000000.vtp"}, kept);
  // Before a folder is made.
  if (!arguments.hdf5.empty()) require_hdf5();
  if (!arguments.vtk.empty()) require_vtk();
  // Each kind is written for itself: what was written before one fails stays.
  if (!arguments.csv.empty()) write_csv_tables(file, arguments.csv);
  if (!arguments.hdf5.empty()) write_hdf5(file, made_folder(arguments.hdf5) / "run.h5");
  if (!arguments.vtk.empty()) write_vtk(file, made_folder(arguments.vtk));
  return kDone;
}

}  // namespace brink
