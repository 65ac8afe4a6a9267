// `brink view SCENE`, `brink run SCENE --watch`: a page that follows a run, served to this machine alone.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "brink/scenes/view/live_server.h"

namespace brink::live_view_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

// Balls that bounce for longer than anybody waits.
const char* const kScene = R"(
title = "for long"
[world]
duration = 1e6
gravity = [0, -9.0]
[output]
frame_interval = 100.0
[[sites]]
name = "room"
box = { width = 4.0, height = 3.0 }
inside_of = true
[[bodies]]
name = "ball"
disc = { radius = 0.2 }
position = [-1.0, 0.1]
velocity = [1.0, 0.3]
grid = { columns = 4, rows = 2, spacing = [0.6, 0.7] }
)";

void wait_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

bool begins(const std::string& text, const char* with) { return text.rfind(with, 0) == 0; }

int connected(int port) {
  const int s = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  ::inet_pton(AF_INET, "127.0.0.1", &to.sin_addr);
  return ::connect(s, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 ? s : -1;
}

/// The whole answer to a request; `host` and further header lines as given.
std::string answer_of(int port, const std::string& what, const std::string& host,
                      const std::string& headers) {
  const int s = connected(port);
  std::string answer;
  if (s >= 0) {
    const std::string text = what + " HTTP/1.1\r\nHost: " + host + "\r\n" + headers +
                             "Connection: close\r\nContent-Length: 0\r\n\r\n";
    (void)!::write(s, text.data(), text.size());
    char buffer[65536];
    for (ssize_t n; (n = ::read(s, buffer, sizeof buffer)) > 0;)
      answer.append(buffer, static_cast<std::size_t>(n));
  }
  ::close(s);
  return answer;
}

/// "view", or "watch".
class Live : public ::testing::TestWithParam<const char*> {
 protected:
  Live() {
    std::string name = (fs::temp_directory_path() / "brink-live-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    std::ofstream(folder_ / "long.toml") << kScene << std::flush;
    program_ = ::fork();
    if (program_ == 0) {
      fs::current_path(folder_);
      (void)!std::freopen("out.txt", "w", stdout);
      (void)!std::freopen("error.txt", "w", stderr);
      if (watches())
        ::execl(BRINK_BINARY_DIR "/bin/brink", "brink", "run", "long.toml", "--watch", nullptr);
      else
        ::execl(BRINK_BINARY_DIR "/bin/brink", "brink", "view", "long.toml", nullptr);
      ::_exit(127);
    }
    for (int k = 0; k < 500 && port_ == 0; ++k, wait_ms(20)) {
      std::ifstream in(folder_ / (watches() ? "error.txt" : "out.txt"));
      std::string address;
      if (std::getline(in, address) && !in.eof()) port_ = std::stoi(address.substr(address.rfind(':') + 1));
    }
  }
  static bool watches() { return std::string(GetParam()) == "watch"; }
  ~Live() override {
    ::kill(program_, SIGKILL);
    ::waitpid(program_, nullptr, 0);
    fs::remove_all(folder_);
  }

  std::string ask(const std::string& what, const std::string& host, const std::string& headers = "") const {
    return answer_of(port_, what, host, headers);
  }
  std::string own() const { return "127.0.0.1:" + std::to_string(port_); }
  std::string order(const std::string& what) const {
    return ask("POST /" + what, own(), "X-Brink: page\r\n");
  }

  /// What the page would get now; null while there is nothing yet.
  json about() const {
    const std::string answer = ask("GET /data", own());
    const auto body = answer.find("\r\n\r\n");
    if (!begins(answer, "HTTP/1.1 200")) return {};
    return json::parse(answer.substr(body + 4)).at("about");
  }
  json soon() const {
    json seen;
    for (int k = 0; k < 200 && seen.is_null(); ++k, wait_ms(50)) seen = about();
    return seen;
  }
  static long events_in(const json& about) {
    for (const json& a : about.at("arrays"))
      if (a[0] == "event_t") return a[2];
    return -1;
  }

  fs::path folder_;
  pid_t program_ = -1;
  int port_ = 0;
};

TEST_P(Live, ThePageFollowsPausesAndStepsTheRun) {
  ASSERT_GT(port_, 0);
  ASSERT_TRUE(begins(order("pause"), "HTTP/1.1 200"));
  wait_ms(500);
  const json paused = soon();
  ASSERT_FALSE(paused.is_null());
  EXPECT_TRUE(paused["live"]);
  const long before = events_in(paused);
  wait_ms(300);
  EXPECT_EQ(events_in(about()), before) << "it waits";
  for (int k = 1; k <= 3; ++k) {
    order("step");
    wait_ms(600);
    EXPECT_EQ(events_in(about()), before + k);
  }
  order("go");
  wait_ms(500);
  EXPECT_GT(events_in(about()), before + 3);
  EXPECT_THAT(ask("GET /", own()), HasSubstr("<canvas id=\"scene\""));
}

TEST_P(Live, NobodyElseIsServed) {
  ASSERT_GT(port_, 0);
  for (const char* what : {"GET /", "GET /data", "POST /pause"})
    EXPECT_TRUE(begins(ask(what, "evil.example", "X-Brink: page\r\n"), "HTTP/1.1 403")) << what;
  EXPECT_TRUE(begins(ask("POST /pause", own()), "HTTP/1.1 403")) << "another page may not ask";
  for (const char* what :
       {"GET /long.toml", "GET /../long.toml", "GET /runs/long-1/run.db", "GET /etc/passwd"})
    EXPECT_TRUE(begins(ask(what, own()), "HTTP/1.1 404")) << what;
}

TEST_P(Live, ASignalEndsItAlsoWhilePaused) {
  ASSERT_GT(port_, 0);
  order("pause");
  ASSERT_FALSE(soon().is_null());
  const auto begin = std::chrono::steady_clock::now();
  ::kill(program_, SIGINT);
  for (int k = 0; k < 300 && ::waitpid(program_, nullptr, WNOHANG) == 0; ++k) wait_ms(10);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(1500));
  EXPECT_TRUE(fs::exists(folder_ / "runs/long-1/run.db"));
}

// Packing what stays on this machine once took longer than making it.
TEST_P(Live, WhatIsServedIsNotPacked) {
  ASSERT_GT(port_, 0);
  ASSERT_FALSE(soon().is_null());
  const std::string answer = ask("GET /data", own(), "Accept-Encoding: gzip, deflate, br\r\n");
  EXPECT_TRUE(begins(answer, "HTTP/1.1 200"));
  EXPECT_THAT(answer.substr(0, answer.find("\r\n\r\n")), ::testing::Not(HasSubstr("Content-Encoding")));
  EXPECT_THAT(answer, HasSubstr("{\"about\":"));
}

// As browsers do: one that has been answered and stays, one that is kept at hand.
TEST_P(Live, ConnectionsThatStayOpenDoNotHoldIt) {
  ASSERT_GT(port_, 0);
  ASSERT_FALSE(soon().is_null());
  const int used = connected(port_), kept = connected(port_);
  const std::string text = "GET /data HTTP/1.1\r\nHost: " + own() + "\r\n\r\n";
  ASSERT_EQ(::write(used, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  wait_ms(300);
  const auto begin = std::chrono::steady_clock::now();
  ::kill(program_, SIGINT);
  for (int k = 0; k < 1000 && ::waitpid(program_, nullptr, WNOHANG) == 0; ++k) wait_ms(10);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(2500));
  ::close(used);
  ::close(kept);
}

TEST(LiveServer, ABrowserThatIsSoonerThanTheRunComesAgain) {
  const brink::LiveServer server(fs::temp_directory_path() / "brink-no-run-yet" / "run.db");
  const std::string address = server.address();
  const int port = std::stoi(address.substr(address.rfind(':') + 1));
  const std::string answer = answer_of(port, "GET /", "127.0.0.1:" + std::to_string(port), "");
  EXPECT_TRUE(begins(answer, "HTTP/1.1 503")) << answer;
  EXPECT_THAT(answer, HasSubstr("http-equiv=\"refresh\""));
}

INSTANTIATE_TEST_SUITE_P(Program, Live, ::testing::Values("view", "watch"),
                         [](const auto& of) { return std::string(of.param); });

}  // namespace
}  // namespace brink::live_view_test
