/// The command-line program `brink`.

#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <system_error>

#include "brink/core/base/error.h"
#include "brink/core/base/printable.h"
#include "brink/scenes/program/command.h"
#include "brink/scenes/program/terminal.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scenes/version.h"

namespace {

int fail(brink::ExitStatus status, const char* what) {
  fmt::print(stderr, "{} {}\n", brink::paint(stderr, brink::Paint::bad, "brink:"), brink::printable(what));
  return status;
}

/// What was printed must have got out: a full disk behind standard output is told.
int flushed(int status) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
  return fail(brink::kIoFailed, "standard output could not be written");
}

int run(CLI::App& program, int argc, char** argv, const int& status) {
  try {
    program.parse(argc, argv);
    return flushed(status);
  } catch (const CLI::ParseError& e) {
    return program.exit(e) == 0 ? flushed(brink::kDone) : brink::kBadInput;
  } catch (const brink::SceneFaults& e) {
    fmt::print(stderr, "{}\n", e.what());  // one line a fault, each with its place
    return brink::kBadInput;
  } catch (const brink::BadInput& e) {
    fmt::print(stderr, "{}\n", brink::printable(e.what()));
    return brink::kBadInput;
  } catch (const brink::IoError& e) {
    return fail(brink::kIoFailed, e.what());
  } catch (const std::system_error& e) {  // what fmt says of a stream that cannot be written
    return fail(brink::kIoFailed, e.what());
  } catch (const std::exception& e) {
    return fail(brink::kEndedEarly, e.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of file size is then an error of the write, which is told
  CLI::App program("Brink: many rigid bodies in the plane, exact to the contact time.", "brink");
  program.set_version_flag("--version", std::string(brink::version()));
  program.require_subcommand(1);
  program.footer(
      "Examples:\n"
      "  brink run scenes/gallery/newtons_cradle.toml\n"
      "  brink check my_scene.toml\n"
      "  brink draw my_scene.toml -o start.png\n"
      "  brink list options\n"
      "  brink bench bouncing_ball\n"
      "  brink sweep scenes/experiments/policies_and_orders.toml\n"
      "Exit status: 0 done, 1 ended early, 2 bad usage or input, 3 could not read or write.\n"
      "`brink COMMAND --help` says more.");
  int status = brink::kDone;
  brink::add_run_command(program, status);
  brink::add_check_command(program, status);
  brink::add_draw_command(program, status);
  brink::add_list_command(program, status);
  brink::add_bench_command(program, status);
  brink::add_sweep_command(program, status);
  return run(program, argc, argv, status);
}
