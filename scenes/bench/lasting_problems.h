#pragma once
/// Problems with known answers in which contacts last, and the settings they are run under.

#include "brink/scenes/bench/run.h"

namespace brink::bench {

/// Sliding and rolling, each with a closed form.
std::vector<Problem> lasting_problems();

/// By modes over tolerances, and in steps of first order.
std::vector<Setting> lasting_settings();

}  // namespace brink::bench
