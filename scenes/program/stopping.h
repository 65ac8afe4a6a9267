#pragma once
/// Ctrl-C, and `kill`: what runs stops at the next chance, and leaves whole files.

namespace brink {

/// From now on the first SIGINT or SIGTERM asks to stop at the next chance; a second one ends the program at once.
void stop_on_signals();
bool stop_asked();

}  // namespace brink
