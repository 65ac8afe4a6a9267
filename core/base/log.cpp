#include "brink/core/base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>

#include <cstdlib>
#include <memory>
#include <string_view>

#include "brink/core/base/printable.h"

namespace brink {

namespace {

/// "warn" unless `name` is a level that spdlog knows; of any other name a warning is given.
/// @param name null for none.
void set_level(spdlog::logger& logger, const char* name) {
  logger.set_level(spdlog::level::warn);
  if (name == nullptr) return;
  const spdlog::level::level_enum level = spdlog::level::from_str(name);
  // from_str() gives `off` for a name that it does not know
  if (level != spdlog::level::off || std::string_view(name) == "off") return logger.set_level(level);
  logger.warn("BRINK_LOG is \"{}\"; allowed: trace, debug, info, warn, error, off; it is warn now",
              printable(name));
}

}  // namespace

spdlog::logger& log() {
  // The first call makes it, with the level that the environment has then.
  static const std::unique_ptr<spdlog::logger> logger = [] {
    auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>(spdlog::color_mode::automatic);
    // not entered in spdlog's registry: a program that uses spdlog itself keeps its own names and default
    auto made = std::make_unique<spdlog::logger>("brink", sink);
    made->set_pattern("%^%l%$: %v");
    set_level(*made, std::getenv("BRINK_LOG"));
    return made;
  }();
  return *logger;
}

}  // namespace brink
