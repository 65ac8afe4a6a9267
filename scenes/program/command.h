#pragma once
/// The commands of `brink`. Each adds itself to the program; when chosen, it runs and sets the exit status.

#include <CLI/CLI.hpp>

namespace brink {

/// What `brink` exits with.
enum ExitStatus : int {
  kDone = 0,
  kEndedEarly = 1,  ///< the run file holds all up to there
  kBadInput = 2,    ///< bad usage or bad input
  kIoFailed = 3,    ///< could not read or write
};

void add_run_command(CLI::App& program, int& status);
void add_check_command(CLI::App& program, int& status);
void add_draw_command(CLI::App& program, int& status);
void add_list_command(CLI::App& program, int& status);
void add_bench_command(CLI::App& program, int& status);
void add_sweep_command(CLI::App& program, int& status);

}  // namespace brink
