#pragma once
/// The command line of `brink`: its commands, their options and help. The only place that knows the library which reads
/// it, whose headers cost as much as a command's own source.

namespace brink {

/// Runs the command that is asked for. Returns an ExitStatus (commands.h); what is wrong with the usage has been told.
/// @throws what the command throws
int run_command_line(int argc, char** argv);

}  // namespace brink
