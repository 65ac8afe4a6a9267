#pragma once
// Trying what may crash or never end, in a process of its own.
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

namespace brink::fuzz {

/// Calls f() in a child, which is ended after so many seconds of the processor (ten times as many of the
/// clock: a busy machine is no finding). Empty if f came back with true; else how it went. What f prints goes
/// to the standard error of the test.
template <class F>
std::string finding(F&& f, unsigned seconds) {
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) return "no process could be started";
  if (child == 0) {
    ::signal(SIGALRM, SIG_DFL);
    ::alarm(10 * seconds);
    const rlimit limit{seconds, seconds + 1};
    ::setrlimit(RLIMIT_CPU, &limit);
    bool good = false;
    try {
      good = f();
    } catch (const std::exception& e) {
      std::fprintf(stderr, "left by an exception: %s\n", e.what());
    }
    std::fflush(nullptr);
    ::_exit(good ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGALRM || WTERMSIG(status) == SIGXCPU))
    return "no end in " + std::to_string(seconds) + " s";
  if (WIFSIGNALED(status)) return "signal " + std::to_string(WTERMSIG(status));
  return WEXITSTATUS(status) == 0 ? "" : "exit " + std::to_string(WEXITSTATUS(status));
}

/// A number from the environment.
inline std::uint64_t asked(const char* variable, std::uint64_t otherwise) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::strtoull(text, nullptr, 10) : otherwise;
}

}  // namespace brink::fuzz
