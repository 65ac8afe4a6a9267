/// brink export: a run's tables for other programs.

#include "brink/scenes/run_file/run_tables.h"

#include <fmt/format.h>

#include "brink/core/base/error.h"

#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/run_folder.h"

namespace brink {

int export_command(const ExportArguments& arguments) {
  const auto file = run_file_of(arguments.run);
  if (file.empty())
    throw BadInput(fmt::format("{}: not a run; allowed: a run folder or a run file", arguments.run));
  write_csv_tables(file, arguments.csv);
  return kDone;
}

}  // namespace brink
