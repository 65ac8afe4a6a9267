#pragma once
/// What long computations ask now and then, so that somebody who waits can stop them.

#include <functional>

namespace brink {

/// False: stop. Empty: go on.
using GoOn = std::function<bool()>;

}  // namespace brink
