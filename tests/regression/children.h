#pragma once
/// Runs that may hang, crash or fill the memory, each in a process of its own, with limits on both.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace brink::regression {

/// How a child ended.
struct Ended {
  int status = -1;      ///< exit status; -1: by a signal
  int signal = 0;       ///< which
  std::string output;   ///< what it printed, both streams
  double seconds = 0;   ///< how long it took
  double stopping = 0;  ///< of that, since it was asked to stop
};

struct Limits {
  double seconds = 120;            ///< then it is killed: a generous guard against hanging, not a bound
  double ask_after = 0;            ///< SIGTERM then; 0: never
  std::size_t memory = 4UL << 30;  ///< address space [bytes]
};

/// Forks, limits the child, and runs `body` in it; its return value is the exit status.
inline Ended in_child(const Limits& limits, const std::function<int()>& body) {
  using Clock = std::chrono::steady_clock;
  int ends[2];
  if (pipe(ends) != 0) return {};
  const auto begin = Clock::now();
  const auto since = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], 1);
    dup2(ends[1], 2);
    close(ends[0]);
    close(ends[1]);
    const rlimit memory{limits.memory, limits.memory}, core{0, 0};
    setrlimit(RLIMIT_AS, &memory);
    setrlimit(RLIMIT_CORE, &core);
    const int status = body();
    std::fflush(nullptr);
    _exit(status);
  }
  close(ends[1]);
  Ended ended;
  std::thread reader([&] {
    char buffer[4096];
    for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;)
      ended.output.append(buffer, static_cast<std::size_t>(n));
  });
  int status = 0;
  double asked = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (limits.ask_after > 0 && asked == 0 && since() > limits.ask_after) {
      asked = since();
      kill(child, SIGTERM);
    }
    if (since() > limits.seconds) kill(child, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  reader.join();
  close(ends[0]);
  ended.seconds = since();
  if (asked > 0) ended.stopping = ended.seconds - asked;
  if (WIFEXITED(status)) ended.status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) ended.signal = WTERMSIG(status);
  return ended;
}

/// The same for a program.
inline Ended run_program(const Limits& limits, std::vector<std::string> words) {
  return in_child(limits, [&] {
    std::vector<char*> arguments;
    for (std::string& w : words) arguments.push_back(w.data());
    arguments.push_back(nullptr);
    execvp(arguments[0], arguments.data());
    return 127;
  });
}

}  // namespace brink::regression
