/// Two threads meet here: the one that runs asks paused() and tells of events, the server's own answers the
/// page. They share two atomics, and the run file, which SQLite lets one write while another reads.
///
/// What the run is to do is one of three states:
///
///     on              /go; the run goes
///     to_next_event   /step; the run goes, and the next event makes it paused
///     paused          /pause; the run waits
#include "brink/scenes/view/live_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

#include "brink/core/base/error.h"
#include "brink/scenes/view/replay_page.h"

namespace brink {

namespace {

/// Of a run that goes on a page asks twice a second: little enough to be made in that time.
ReplayLimits limits_of(bool ended) {
  ReplayLimits limits;
  if (!ended) {
    limits.frame_rows = 100'000;
    limits.events = 20'000;
  }
  return limits;
}

constexpr std::string_view kBeginning =
    "<!DOCTYPE html><title>Brink</title><meta http-equiv=\"refresh\" content=\"0.3\">The run begins ...";

}  // namespace

struct LiveServer::Impl {
  enum class Going { on, to_next_event, paused };

  std::filesystem::path run_file;
  httplib::Server server;
  std::thread thread;
  int port = 0;
  std::atomic<Going> going{Going::on};
  std::atomic<bool> ended{false};
  std::mutex reading;  // one reader of the run file at a time

  explicit Impl(std::filesystem::path file) : run_file(std::move(file)) {
    // Before any route is looked at: nothing is answered to others, not even that a path does not exist.
    server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      return answers(request, response);
    });
    // A connection is for one request, and none waits for long: who ends the server waits for all of them.
    server.set_keep_alive_max_count(1);
    server.set_keep_alive_timeout(1);
    server.set_read_timeout(1);
    // On two cores the library would have a single thread, held by a connection that a browser keeps at hand.
    server.new_task_queue = [] { return new httplib::ThreadPool(8); };
    // The page comes with the data of the moment: it shows something before it asks for more.
    server.Get("/", [this](const httplib::Request&, httplib::Response& response) {
      reply(response, "text/html; charset=utf-8",
            [&] { return replay_page_text(run_file, limits_of(ended), true); });
      // A browser that is sooner than the run's first frame comes again by itself.
      if (response.status == 503) response.set_content(std::string(kBeginning), "text/html; charset=utf-8");
    });
    // Browsers ask for one.
    server.Get("/favicon.ico",
               [](const httplib::Request&, httplib::Response& response) { response.status = 204; });
    // Of a run that has ended the data say so, and the page stops asking.
    server.Get("/data", [this](const httplib::Request&, httplib::Response& response) {
      reply(response, "application/json",
            [&] { return replay_page_data(run_file, limits_of(ended), !ended); });
    });
    // Orders are POST: a link or an image of another page makes a GET, and its forms lack the page's header
    // (answers()).
    const auto ask = [this](const char* path, Going how) {
      server.Post(path, [this, how](const httplib::Request&, httplib::Response& response) {
        going = how;
        response.set_content("{}", "application/json");
      });
    };
    ask("/pause", Going::paused);
    ask("/go", Going::on);
    ask("/step", Going::to_next_event);
    // Bound before the thread starts: the address is known when the constructor returns.
    port = server.bind_to_any_port("127.0.0.1");
    if (port <= 0) throw IoError("no port of 127.0.0.1 can be had");
    thread = std::thread([this] { server.listen_after_bind(); });
  }
  ~Impl() {
    // Ends listen_after_bind().
    server.stop();
    thread.join();
  }

  /// Pages of other hosts may neither read nor ask: the host must be this one, and what asks must say so in a header that
  /// only the own page can set.
  httplib::Server::HandlerResponse answers(const httplib::Request& request,
                                           httplib::Response& response) const {
    // A page of another site may come here under a name of its own that resolves to 127.0.0.1 (DNS
    // rebinding): Host is then that name. And its scripts cannot set X-Brink without a preflight (CORS),
    // which is refused.
    const std::string host = request.get_header_value("Host");
    const bool own = host == fmt::format("127.0.0.1:{}", port) || host == fmt::format("localhost:{}", port);
    const bool asks = request.method != "GET";
    if (own && (!asks || request.get_header_value("X-Brink") == "page"))
      return httplib::Server::HandlerResponse::Unhandled;
    response.status = 403;
    return httplib::Server::HandlerResponse::Handled;
  }

  /// Answers with what `text` makes. It reads the run file, so one request at a time; what goes wrong is
  /// told with status 503, and the page asks again.
  template <class Text>
  void reply(httplib::Response& response, const char* kind, Text&& text) {
    const std::lock_guard lock(reading);
    try {
      // Of known length, piece by piece: a text given as a whole the library would pack by Brotli at its highest, which
      // takes seconds for what stays on this machine.
      const auto whole = std::make_shared<const std::string>(text());
      response.set_content_provider(whole->size(), kind,
                                    [whole](std::size_t from, std::size_t length, httplib::DataSink& sink) {
                                      return sink.write(whole->data() + from, length);
                                    });
    } catch (const std::exception& e) {  // nothing is there yet
      response.status = 503;
      response.set_content(e.what(), "text/plain; charset=utf-8");
    }
  }
};

LiveServer::LiveServer(std::filesystem::path run_file) : impl_(std::make_unique<Impl>(std::move(run_file))) {}
LiveServer::~LiveServer() = default;

std::string LiveServer::address() const { return fmt::format("http://127.0.0.1:{}/", impl_->port); }
bool LiveServer::paused() const { return impl_->going == Impl::Going::paused; }
void LiveServer::event_happened() {
  // Only from to_next_event: a page that has asked to go on, or to pause, meanwhile is not overruled.
  auto until_now = Impl::Going::to_next_event;
  impl_->going.compare_exchange_strong(until_now, Impl::Going::paused);
}
void LiveServer::run_ended() { impl_->ended = true; }

}  // namespace brink
