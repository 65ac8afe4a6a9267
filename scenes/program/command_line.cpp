/// Each command is added by a function of its own: a struct of arguments (commands.h), an option for each
/// of its members, and a callback that calls the command. What help and messages say stands here and
/// nowhere else.
///
/// Only what the library can tell of a word alone is checked here (counts, topics). Whatever needs a scene,
/// a run or another option is the command's own business, which says what is allowed in its own words.
#include "brink/scenes/program/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "brink/core/base/error.h"
#include "brink/core/base/printable.h"
#include "brink/core/fields/gl_context.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/toml/faults.h"
#include "brink/scenes/version.h"

namespace brink {

namespace {

// Arguments are shared with the callback, which CLI11 calls while it parses; the command runs in it.
void add_run(CLI::App& program, int& status) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = program.add_subcommand("run", "Simulate a scene and write a run file");
  command->add_option("SCENE", arguments->scene, "Scene file (TOML), or a run to make again")->required();
  command->add_option("--out", arguments->out, "Folder for run.db; default runs/<scene>-<n>")
      ->type_name("DIR");
  // One value each time: `--set A=1 SCENE` must not take the scene for a second override.
  command->add_option("--set", arguments->overrides, "Override a key of the scene; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  command->add_option("--until", arguments->until, "Run up to this time [s] instead of the scene's duration")
      ->type_name("T");
  command
      ->add_option("--threads", arguments->threads,
                   "Threads that work for the run, with the same bits whatever their number (1)")
      ->type_name("N");
  command->add_flag(
      "--resume", arguments->resume,
      "Go on with the run file that is there, with the same bits; needs the same scene and options");
  command
      ->add_option("--trace", arguments->trace,
                   "Write what the scheduler does, as a Chrome trace (opens in ui.perfetto.dev)")
      ->type_name("FILE");
  command->add_flag(
      "--watch", arguments->watch,
      "Serve a page that follows the run, as brink view SCENE does; its address comes first, and "
      "it stays until Ctrl-C");
  command->add_flag("--profile", arguments->profile,
                    "Where the time went, by stages; --json and the run file have it always");
  command->add_flag("--quiet", arguments->quiet, "No progress bar and no summary");
  command->add_flag("--json", arguments->json, "The summary as one JSON object on the last line");
  command->footer(
      "A run file that is already in the folder is kept as run-1.db, run-2.db ... unless --resume goes on "
      "with it.\n"
      "Ctrl-C stops at the next chance and leaves a whole run file, which --resume can go on with.\n"
      "Examples:\n"
      "  brink run scenes/gallery/newtons_cradle.toml\n"
      "  brink run my_scene.toml --out runs/a --set solver.policy=global_backup --set bodies.0.mass=2\n"
      "  brink run my_scene.toml --out runs/a --until 60 --resume\n"
      "  brink run my_scene.toml --json | tail -n 1");
  command->callback([arguments, &status] { status = run_command(*arguments); });
}

/// Everything but running: faults of the scene, the plan, and overlaps at the start, however deep.
void add_check(CLI::App& program, int& status) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = program.add_subcommand("check", "Validate a scene and print the plan; runs nothing");
  command->add_option("SCENE", arguments->scene, "Scene file (TOML)")->required();
  command->add_option("--set", arguments->overrides, "Override a key of the scene; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  command->footer(
      "Every fault is one line, FILE:LINE:COLUMN: what is wrong, what was given, what is allowed.\n"
      "Examples:\n"
      "  brink check my_scene.toml\n"
      "  brink check my_scene.toml --set solver.integrator=erk");
  command->callback([arguments, &status] { status = check_command(*arguments); });
}

/// --layer, --size and --view are taken as words: draw.h reads them, and names what is allowed.
void add_draw(CLI::App& program, int& status) {
  auto arguments = std::make_shared<DrawArguments>();
  CLI::App* command = program.add_subcommand("draw", "A picture of a scene or a run (PNG, SVG, PDF)");
  command->add_option("SUBJECT", arguments->subject, "Scene file, run folder or run file")->required();
  command->add_option("-o,--output", arguments->out, "Picture to write")
      ->type_name("FILE.png|.svg|.pdf")
      ->required();
  command->add_option("--at", arguments->at, "Time [s]; default: the start of a scene, the end of a run")
      ->type_name("T");
  command->add_option("--layer", arguments->layer, "scene, color, depth, forces or pass:BODY")
      ->type_name("LAYER");
  command->add_option("--size", arguments->size, "Pixels")->type_name("WxH")->capture_default_str();
  command
      ->add_option("--view", arguments->view,
                   "What is seen [m]; default: all of a scene, or of the whole run")
      ->type_name("X0,Y0,X1,Y1");
  command->add_flag("--plain", arguments->plain, "For papers: no cells beneath, no caption");
  command->add_flag("--axes", arguments->axes, "Coordinates along the rims");
  command->add_flag("--names", arguments->names, "Names of bodies");
  command->add_flag("--trails", arguments->trails, "Where bodies of a run have been up to then");
  command->add_flag("--velocities", arguments->velocities, "Velocities, that of the fastest 60 pixels long");
  command->add_flag("--contacts", arguments->contacts,
                    "Collisions of a run since the frame before, with their impulses");
  command->add_option("--set", arguments->overrides, "Override a key of the scene; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  command->footer(
      "A scene is simulated up to T. A run is read; between its frames it is followed from collision to "
      "collision.\n"
      "Examples:\n"
      "  brink draw scenes/gallery/newtons_cradle.toml -o start.png\n"
      "  brink draw runs/newtons_cradle-1 --at 1.5 -o later.png\n"
      "  brink draw my_scene.toml --layer depth --size 800x600 -o depth.png\n"
      "  brink draw my_scene.toml --layer pass:ball -o pass.png\n"
      "  brink draw runs/pile-1 --at 3 --layer forces -o chains.png\n"
      "Layer forces: lines from centres to the contacts that last, as wide as their normal force is large.");
  command->callback([arguments, &status] { status = draw_command(*arguments); });
}

/// Two commands in one, by the subject: a run becomes a file, a scene without -o a page that is served.
void add_view(CLI::App& program, int& status) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command = program.add_subcommand("view", "A replay page: one HTML file that plays a run");
  command->add_option("SUBJECT", arguments->subject, "Run folder, run file, or scene file")->required();
  command->add_option("-o,--output", arguments->out, "Page to write; default replay.html beside the run file")
      ->type_name("FILE.html");
  command->add_flag("--open", arguments->open, "Open it in the browser");
  command
      ->add_option("--trace", arguments->trace,
                   "Of a run: what brink run --trace wrote, shown as a lane a body under the events")
      ->type_name("FILE");
  command->add_option("--set", arguments->overrides, "Override a key of the scene; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  command->footer(
      "The page needs no network and no server: open it by double click, mail it, keep it.\n"
      "Of a scene without -o the page is live: served on 127.0.0.1 to this machine alone, it follows the run "
      "as\n"
      "it goes into runs/<scene>-<n>, pauses it, and lets it go on to its next event, until Ctrl-C.\n"
      "Examples:\n"
      "  brink view runs/newtons_cradle-1 --open\n"
      "  brink view runs/pile-1/run.db -o pile.html\n"
      "  brink view scenes/gallery/dominoes.toml");
  command->callback([arguments, &status] { status = view_command(*arguments); });
}

/// By default a second of the film is a second of the run, drawn without cells.
void add_film(CLI::App& program, int& status) {
  auto arguments = std::make_shared<FilmArguments>();
  CLI::App* command = program.add_subcommand("film", "A film of a run, through ffmpeg");
  command->add_option("RUN", arguments->run, "Run folder or run file")->required();
  command
      ->add_option("-o,--output", arguments->out,
                   "Film to write; FILE.png: a picture a frame, FILE-00001.png ...")
      ->type_name("FILE.mp4|.gif|.png")
      ->required();
  command->add_option("--fps", arguments->fps, "Pictures a second")->type_name("N")->capture_default_str();
  command->add_option("--speed", arguments->speed, "Seconds of the run in a second of the film")
      ->type_name("X")
      ->capture_default_str();
  command->add_option("--from", arguments->from, "First time [s]; default: the start")->type_name("T");
  command->add_option("--to", arguments->to, "Last time [s]; default: the end")->type_name("T");
  command
      ->add_option("--layer", arguments->layer,
                   "plain, or a layer of brink draw (with cells it takes longer)")
      ->type_name("LAYER")
      ->capture_default_str();
  command->add_option("--size", arguments->size, "Pixels")->type_name("WxH")->capture_default_str();
  command->footer(
      "The camera stands still and sees the whole run. Without ffmpeg (apt-get install ffmpeg) there are "
      "pictures.\n"
      "Examples:\n"
      "  brink film runs/newtons_cradle-1 -o cradle.mp4\n"
      "  brink film runs/dominoes-1 -o slow.gif --fps 25 --speed 0.2 --from 1 --to 2 --size 640x360\n"
      "  brink film runs/letters-1 -o letters.mp4 --layer scene");
  command->callback([arguments, &status] { status = film_command(*arguments); });
}

/// Three kinds of output in any combination; the command asks for one at least.
void add_export(CLI::App& program, int& status) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = program.add_subcommand("export", "A run's tables for other programs");
  command->add_option("RUN", arguments->run, "Run folder or run file")->required();
  command
      ->add_option("--csv", arguments->csv,
                   "Write bodies.csv, sites.csv, frames.csv, events.csv, contacts.csv there")
      ->type_name("DIR");
  command
      ->add_option("--hdf5", arguments->hdf5,
                   "Write run.h5 there: bodies, frames, events, contacts, with units")
      ->type_name("DIR");
  command
      ->add_option("--vtk", arguments->vtk,
                   "Write run.pvd there for ParaView: bodies and sites at every frame, and events")
      ->type_name("DIR");
  command->footer(
      "Names of columns end with their units.\n"
      "Examples:\n"
      "  brink export runs/newtons_cradle-1 --csv cradle\n"
      "  brink export runs/newtons_cradle-1 --hdf5 cradle --vtk cradle");
  command->callback([arguments, &status] { status = export_command(*arguments); });
}

void add_list(CLI::App& program, int& status) {
  auto arguments = std::make_shared<ListArguments>();
  CLI::App* command = program.add_subcommand("list", "What can be chosen, one line each, defaults shown");
  // Checked here, so that a wrong topic is told with those that there are.
  command->add_option("TOPIC", arguments->topic, "What to list; everything if left out")
      ->check(CLI::IsMember(list_topics()));
  command->footer("Examples:\n  brink list policies\n  brink list options | grep solver");
  command->callback([arguments, &status] { status = list_command(*arguments); });
}

/// Problems are named by bare words; the command checks them against its own list.
void add_bench(CLI::App& program, int& status) {
  auto arguments = std::make_shared<BenchArguments>();
  CLI::App* command =
      program.add_subcommand("bench", "Error against run time on problems with known answers");
  command->add_option("NAME", arguments->names, "Problems to run; all if left out");
  command->add_flag("--list", arguments->list, "List the problems; runs nothing");
  command->add_option("--out", arguments->out, "Folder for bench.csv and bench.png; default runs/bench-<n>")
      ->type_name("DIR");
  command->add_option("--repeats", arguments->repeats, "Most repeats of a run; the median time is given")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->footer(
      "Times are of the simulation alone. A run is repeated until a second has gone by at most; repeats must "
      "give\n"
      "the same bits. Ends with 1 if an exact run ends early or repeats differ.\n"
      "Examples:\n"
      "  brink bench\n"
      "  brink bench bouncing_ball two_boxes --out runs/mine\n"
      "  brink bench rest\n"
      "  brink bench classic");
  command->callback([arguments, &status] { status = bench_command(*arguments); });
}

/// One experiment, one folder: the folder is what makes a sweep resumable, so it is the same without --out
/// each time.
void add_sweep(CLI::App& program, int& status) {
  auto arguments = std::make_shared<SweepArguments>();
  CLI::App* command = program.add_subcommand("sweep", "Many runs over options, on all cores; resumable");
  command->add_option("EXPERIMENT", arguments->experiment, "Experiment file (TOML); see docs/sweep.md")
      ->required();
  command
      ->add_option("--out", arguments->out,
                   "Folder for sweep.db, sweep.csv and sweep.png; default runs/<experiment>")
      ->type_name("DIR");
  command->add_option("--jobs", arguments->jobs, "Runs at the same time; 0: one a core")
      ->type_name("N")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--list", arguments->dry, "Print every run as a `brink run` command; runs nothing");
  command->add_flag("--quiet", arguments->quiet, "No progress and no table");
  command->footer(
      "The same command again goes on where a sweep was stopped or killed; runs that are done are not made "
      "again.\n"
      "Several processes may share one folder: each run is made once.\n"
      "Wall seconds are clean with --jobs 1.\n"
      "Examples:\n"
      "  brink sweep scenes/experiments/policies_and_orders.toml\n"
      "  brink sweep my_experiment.toml --out runs/a --jobs 1");
  command->callback([arguments, &status] { status = sweep_command(*arguments); });
}

/// What is stored is a table of the folder's own, so there is nothing to name but the folder.
void add_regress(CLI::App& program, int& status) {
  auto arguments = std::make_shared<RegressArguments>();
  CLI::App* command = program.add_subcommand("regress", "Run scenes and compare with their stored answers");
  command->add_option("DIR", arguments->folder, "Folder of scenes (TOML) and of answers.csv")->required();
  command->add_flag("--update", arguments->update, "Store what is met: write answers.csv anew");
  command->add_option("--reason", arguments->reason, "With --update: why answers have changed")
      ->type_name("TEXT");
  command->add_option("--set", arguments->overrides, "Override a key of every scene; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  command->add_flag("--quiet", arguments->quiet, "No progress and no lines");
  command->add_flag("--json", arguments->json, "The comparison as one JSON object on the last line");
  command->footer(
      "Every scene in the folder is run to its duration. Exit status: 0 all are the same, 1 one differs, is "
      "new or is "
      "gone.\n"
      "Answers by a solver (SUNDIALS) that is another one than where they were stored are not compared.\n"
      "Ctrl-C stops, and writes nothing.\n"
      "Examples:\n"
      "  brink regress scenes/gallery\n"
      "  brink regress scenes/gallery --set solver.policy=timewarp\n"
      "  brink regress my_scenes --update --reason \"heavier discs\"");
  command->callback([arguments, &status] { status = regress_command(*arguments); });
}

/// What to say of a command or an option that there is not, with the nearest that there is, and of `--option=` without a
/// value; empty: all are known.
std::string misspelt(const CLI::App& program, const std::vector<std::string>& words) {
  // A bare word first is a command; --help and --version are left to the library.
  if (words.empty() || words[0].starts_with('-')) return {};
  std::vector<std::string> commands;
  // An empty filter gives all commands that there are, not those that were parsed.
  for (const CLI::App* c : program.get_subcommands({})) commands.push_back(c->get_name());
  if (std::find(commands.begin(), commands.end(), words[0]) == commands.end())
    return fmt::format("{}: no such command; the nearest is \"{}\". `brink --help` lists all",
                       printable(words[0]), nearest_word(words[0], commands));
  std::vector<std::string> known;
  // Long names alone: short options are few, and nothing is near them.
  for (const CLI::Option* o : program.get_subcommand(words[0])->get_options())
    for (const std::string& name : o->get_lnames()) known.push_back("--" + name);
  // The command itself is passed over, as all that does not begin with two dashes; a value that does is
  // taken for an option.
  for (const std::string& word : words) {
    // "--set=A=1" is the option --set; what follows the first '=' is its value.
    const std::string option = word.substr(0, word.find('='));
    // After "--" everything is a value.
    if (option == "--") break;
    // The library would take the next word for the value.
    if (option.starts_with("--") && word == option + '=')
      return fmt::format("{}: is empty; allowed: a value", printable(option));
    if (!option.starts_with("--") || std::find(known.begin(), known.end(), option) != known.end()) continue;
    return fmt::format("{}: brink {} has no such option; the nearest is {}. `brink {} --help` lists all",
                       printable(option), words[0], nearest_word(option, known), words[0]);
  }
  return {};
}

/// An empty word, as of a variable that is not set, would be taken as if the option were not there.
void refuse_empty_words(CLI::App& program) {
  const CLI::Validator filled(
      [](std::string& word) { return word.empty() ? "is empty; allowed: a value" : ""; }, std::string());
  for (CLI::App* command : program.get_subcommands({}))
    for (CLI::Option* option : command->get_options())
      if (option->get_items_expected_max() > 0) option->check(filled);
}

/// The GL that fields are drawn by. Cost: a context.
std::string gl_that_opens() {
  try {
    return open_gl_context()->description();
  } catch (const IoError& none) {
    return fmt::format("none ({})", none.what());
  }
}

}  // namespace

int run_command_line(int argc, char** argv) {
  CLI::App program("Brink: many rigid bodies in the plane, exact to the contact time.", "brink");
  program.set_version_flag("--version", [] { return version_details(gl_that_opens()); });
  // Exactly one command: with none the library says that one is needed.
  program.require_subcommand(1);
  program.footer(
      "Examples:\n"
      "  brink run scenes/gallery/newtons_cradle.toml\n"
      "  brink check my_scene.toml\n"
      "  brink draw my_scene.toml -o start.png\n"
      "  brink view runs/newtons_cradle-1 --open\n"
      "  brink list options\n"
      "  brink bench bouncing_ball\n"
      "  brink sweep scenes/experiments/policies_and_orders.toml\n"
      "  brink regress scenes/gallery\n"
      "Exit status: 0 done, 1 ended early, 2 bad usage or input, 3 could not read or write.\n"
      "`brink COMMAND --help` says more.");
  // Written by the one callback that runs. What the command throws goes through the library to main().
  int status = kDone;
  add_run(program, status);
  add_check(program, status);
  add_draw(program, status);
  add_view(program, status);
  add_film(program, status);
  add_export(program, status);
  add_list(program, status);
  add_bench(program, status);
  add_sweep(program, status);
  add_regress(program, status);
  refuse_empty_words(program);
  if (const std::string words = misspelt(program, {argv + 1, argv + argc}); !words.empty()) {
    fmt::print(stderr, "{}\n", words);
    return kBadInput;
  }
  // Before the library, whose message for an unknown word does not name the nearest.
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {  // help is one, too
    // The library's own numbers are above 100; ours are those of the contract.
    return program.exit(e) == 0 ? kDone : kBadInput;
  }
  return status;
}

}  // namespace brink
