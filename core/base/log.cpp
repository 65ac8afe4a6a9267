#include "brink/core/base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>

#include <cstdlib>
#include <memory>

namespace brink {

spdlog::logger& log() {
  static const std::unique_ptr<spdlog::logger> logger = [] {
    auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>(spdlog::color_mode::automatic);
    // not entered in spdlog's registry: a program that uses spdlog itself keeps its own names and default
    auto made = std::make_unique<spdlog::logger>("brink", sink);
    const char* level = std::getenv("BRINK_LOG");
    // from_str() gives `off` for a name that it does not know
    made->set_level(level ? spdlog::level::from_str(level) : spdlog::level::warn);
    made->set_pattern("%^%l%$: %v");
    return made;
  }();
  return *logger;
}

}  // namespace brink
