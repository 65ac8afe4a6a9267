#pragma once
/// The one door to spdlog. Messages go to standard error, coloured on a terminal only; level from BRINK_LOG
/// (trace, debug, info, warn, error, off), "warn" when unset or, with a warning that says so, unknown.

#include <spdlog/logger.h>

namespace brink {

/// The program's logger, made at the first call. Thread-safe.
spdlog::logger& log();

}  // namespace brink
