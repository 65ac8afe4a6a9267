/// brink film: a run as a film, picture by picture through ffmpeg.

// The run's times [s] go from --from to --to in steps of speed / fps. Each picture is drawn from the states
// at its time and handed on: no more than one is in memory.
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <utility>

#include "brink/core/base/printable.h"
#include "brink/scenes/draw/draw.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/run_folder.h"
#include "brink/scenes/program/stopping.h"
#include "brink/scenes/program/terminal.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/run_moment.h"
#include "brink/scenes/sweep/shell_word.h"
#include "brink/scheduler/kernel/site_motion.h"

namespace brink {
namespace {

namespace fs = std::filesystem;

/// A million pictures are four and a half hours at 60 a second. More is a slip in --speed, and would fill
/// the disk.
constexpr double kMostPictures = 1e6;

/// Looked for as the shell does, but not run: what runs meanwhile would take a Ctrl-C for itself.
bool has_ffmpeg() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((fs::path(folder.empty() ? "." : folder) / "ffmpeg").c_str(), X_OK) == 0) return true;
  return false;
}

/// Takes pictures one after another.
class Film {
 public:
  virtual ~Film() = default;
  /// @throws IoError. All pictures are of one size, the film's.
  virtual void add(const Picture& picture) = 0;
  // To be called after the last picture.
  virtual void finish() {}
  /// Nothing but whole files is left.
  virtual void abandon() {}
};

/// FILE-00001.png, FILE-00002.png ...: beside each other in the order of their names.
class PictureSequence final : public Film {
 public:
  /// `kept`: files that no picture is written over.
  PictureSequence(const fs::path& out, std::vector<fs::path> kept)
      : stem_(fs::path(out).replace_extension()), kept_(std::move(kept)) {}
  void add(const Picture& picture) override {
    const std::string name = fmt::format("{}-{:05}.png", stem_.string(), ++count_);
    refuse_overwriting(name, "-o", kept_);
    write_png(name, picture);
  }

 private:
  fs::path stem_;
  std::vector<fs::path> kept_;
  int count_ = 0;
};

/// Raw pixels into ffmpeg's standard input. What it complains of goes to standard error by itself.
class FfmpegFilm final : public Film {
 public:
  FfmpegFilm(const fs::path& out, PictureSize size, double fps) : out_(out) {
    const bool gif = out.extension() == ".gif";
    // A palette of the film's own colours; or what every player plays, which wants even sides: odd
    // ones are padded.
    const char* coding = gif ? "-vf 'split[a][b];[a]palettegen[p];[b][p]paletteuse'"
                             : "-vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' -c:v libx264 -crf 18 -pix_fmt yuv420p "
                               "-movflags +faststart";
    // A picture's pixels are 0xAARRGGBB: in the memory of a little-endian machine B, G, R, A. An
    // absolute path cannot be taken for an option of ffmpeg. On a full disk it would say that all is well, but for -xerror.
    const std::string command =
        fmt::format("ffmpeg -loglevel error -xerror -y -f rawvideo -pix_fmt bgra -s {}x{} -r {} -i - {} {}",
                    size.width, size.height, fps, coding, shell_word(fs::absolute(out).string()));
    std::signal(SIGPIPE, SIG_IGN);  // where ffmpeg gives up, writing fails, which is told
    pipe_ = ::popen(command.c_str(), "w");
    if (!pipe_) throw IoError("ffmpeg could not be started");
  }
  // After an exception: ffmpeg sees the end of its input and closes a shorter film.
  ~FfmpegFilm() override {
    if (pipe_) ::pclose(pipe_);
  }
  // A Ctrl-C has ended ffmpeg, too, wherever it was.
  void abandon() override {
    if (pipe_) ::pclose(std::exchange(pipe_, nullptr));
    std::error_code ignored;
    fs::remove(out_, ignored);
  }
  void add(const Picture& picture) override {
    if (std::fwrite(picture.pixels.data(), 4, picture.pixels.size(), pipe_) != picture.pixels.size())
      failed();
  }
  void finish() override {
    // ffmpeg's own exit status: it may fail after the last picture was taken.
    if (::pclose(std::exchange(pipe_, nullptr)) != 0) failed();
  }

 private:
  [[noreturn]] void failed() const {
    throw IoError(fmt::format("{}: ffmpeg could not write it (what it said is above)", out_.string()));
  }
  fs::path out_;
  std::FILE* pipe_ = nullptr;
};

/// By the extension of `out`; pictures, too, where there is no ffmpeg. @throws BadInput for another one.
std::unique_ptr<Film> film_into(const fs::path& out, PictureSize size, double fps,
                                const std::vector<fs::path>& kept) {
  const std::string kind = out.extension().string();
  if (kind == ".png") return std::make_unique<PictureSequence>(out, kept);
  if (kind != ".mp4" && kind != ".gif")
    throw BadInput(fmt::format("-o: {} given; allowed: FILE.mp4, FILE.gif, FILE.png", out.string()));
  if (has_ffmpeg()) return std::make_unique<FfmpegFilm>(out, size, fps);
  fmt::print(stderr,
             "brink: ffmpeg is not here (apt-get install ffmpeg): pictures {}-00001.png ... instead\n",
             printable(fs::path(out).replace_extension().string()));
  return std::make_unique<PictureSequence>(out, kept);
}

/// Where fixed sites are told to be at time t, by id. A film needs no motion of them, so none is made.
std::vector<Pose> site_poses(const World& world, double t) {
  std::vector<Pose> poses;
  for (const FixedSite& site : world.sites) poses.push_back(told_pose(site, t));
  return poses;
}

/// @throws BadInput naming the option, the number and what is allowed.
void require(bool good, const char* option, double given, const char* allowed) {
  if (!good) throw BadInput(fmt::format("{}: {} given; allowed: {}", option, given, allowed));
}

}  // namespace

int film_command(const FilmArguments& arguments) {
  stop_on_signals();
  const fs::path file = required_run_file(arguments.run);
  require(arguments.fps >= 1.0 && arguments.fps <= 1000.0, "--fps", arguments.fps, "1 .. 1000");
  require(arguments.speed >= 1e-9 && arguments.speed <= 1e9, "--speed", arguments.speed, "1e-9 .. 1e9");
  // Times are checked against what the file has: of a run that was killed the frames end before its
  // duration.
  RunFile run(file);
  run.hold();  // a run that goes on: all pictures are of one moment of its file
  refuse_overwriting(arguments.out, "-o", run.files());
  const auto [first, last] = run.time_range();
  const double from = arguments.from.value_or(first), to = arguments.to.value_or(last);
  const std::string range = fmt::format("{} .. {} s, --from before --to", first, last);
  require(from >= first && from <= last, "--from", from, range.c_str());
  // A run that has got no farther than its first frame is a film of one picture, but nobody asks for that.
  const bool whole = !arguments.from && !arguments.to;
  require((to > from || whole) && to <= last, "--to", to, range.c_str());
  // As many as begin within the time, the first included, and the last though roundings put it behind.
  // In double: what is refused below may be beyond any integer.
  const double intervals = (to - from) / arguments.speed * arguments.fps;
  const double pictures = std::floor(intervals * (1.0 + 1e-12)) + 1.0;
  if (!(pictures <= kMostPictures))
    throw BadInput(fmt::format(
        "the film would have {:.3g} pictures; allowed: {:.0g}. A shorter time or a higher --speed", pictures,
        kMostPictures));

  DrawOptions options;
  // "plain" is a word of films alone: layer scene without its diagram, which is faster.
  options.diagram = arguments.layer != "plain";
  try {
    options.layer = parse_layer(options.diagram ? arguments.layer : "scene");
  } catch (const BadInput& e) {
    throw BadInput(std::string(e.what()) + ", plain");
  }
  options.size = parse_size(arguments.size);
  options.field = run.field_options();
  const World world = run.world();
  // One camera for all pictures: the run's extent, not each picture's.
  options.view = extent_of(run, world);
  tell_unknown(run);
  // Last of all checks: from here on there is a file, or a process that writes one.
  const auto film = film_into(arguments.out, options.size, arguments.fps, run.files());
  ProgressBar bar(from, to, on_terminal(stderr));
  const auto add_picture = [&](double t) {
    // Between frames bodies are on the cubic of their recorded states; fixed sites are where they are told to be.
    RunMoment moment{t, world, run.states_at(t).states, site_poses(world, t), {}};
    options.time = t;
    if (options.layer.kind == DrawLayer::Kind::forces) {
      // Read for layer forces alone: nothing else of a picture asks for them.
      moment.contacts = run.contacts_at(t);
      options.forces = forces_of(moment);
    }
    film->add(draw_scene(world, moment.bodies, moment.sites, options));
    bar.show(t);
  };
  try {
    // By a product: the last picture is not off by the sum of all steps.
    for (double k = 0; k < pictures && !stop_asked(); ++k)
      add_picture(std::min(to, from + k * arguments.speed / arguments.fps));
    // Only now does ffmpeg write its last picture; whether it could is told by its exit status.
    if (!stop_asked()) {
      film->finish();
      return kDone;  // whole, whatever is asked from now on
    }
  } catch (const IoError&) {
    if (!stop_asked()) throw;  // a Ctrl-C has ended ffmpeg, too
  }
  film->abandon();
  fmt::print(stderr, "brink: stopped before the film was whole\n");
  return kEndedEarly;
}

}  // namespace brink
