#include "bench/page/page_server.hpp"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "core/error.hpp"
#if defined(PELT_HTTPLIB)
#include <httplib.h>
#endif

namespace pelt {

std::string PageServer::address() const { return fmt::format("http://127.0.0.1:{}/", port_); }

#if defined(PELT_HTTPLIB)

namespace {

constexpr const char* kHost = "127.0.0.1";

// A name that somebody else's page had changed to this machine's address would be asked for what is here.
bool IsAskedByOwnName(const httplib::Request& request, uint16_t port) {
  const std::string host = request.get_header_value("Host");
  return host == fmt::format("{}:{}", kHost, port) || host == fmt::format("localhost:{}", port);
}

// From a provider of known length it is sent as it is: a text the library would pack, by Brotli at its slowest, for a
// way that does not leave the machine.
void Send(httplib::Response& response, std::string text, const std::string& type) {
  const auto kept = std::make_shared<const std::string>(std::move(text));
  response.set_content_provider(kept->size(), type.c_str(),
                                [kept](size_t at, size_t size, httplib::DataSink& sink) {
                                  return sink.write(kept->data() + at, size);
                                });
}

}  // namespace

struct PageServer::State {
  httplib::Server server;
  std::thread thread;
};

std::string WhyNoServer() { return {}; }

PageServer::PageServer(uint16_t port, std::vector<ServedPath> paths)
    : state_(std::make_unique<State>()) {
  httplib::Server& server = state_->server;
  // The library's own option lets two servers share a port.
  server.set_socket_options([]([[maybe_unused]] socket_t socket) {
#if !defined(_WIN32)
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
#endif
  });
  server.set_keep_alive_timeout(1);  // seconds, which the end waits for
  server.set_default_headers(
      {{"Cache-Control", "no-store"}, {"X-Content-Type-Options", "nosniff"}});
  server.set_pre_routing_handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        if (IsAskedByOwnName(request, port_)) return httplib::Server::HandlerResponse::Unhandled;
        response.status = 403;
        return httplib::Server::HandlerResponse::Handled;
      });
  for (ServedPath& served : paths)
    server.Get(served.path, [served](const httplib::Request& request, httplib::Response& response) {
      Send(response, served.text(request.get_param_value("since")), served.type);
    });
  const int bound = port == 0                          ? server.bind_to_any_port(kHost)
                    : server.bind_to_port(kHost, port) ? port
                                                       : -1;
  if (bound < 0)
    throw Error(port == 0 ? fmt::format("no port of {} is free", kHost)
                          : fmt::format("port {} of {} is taken, or not for you to take: another "
                                        "--port, or none for a free one",
                                        port, kHost));
  port_ = uint16_t(bound);
  state_->thread = std::thread([&server] { server.listen_after_bind(); });
  // Before it runs it cannot be stopped.
  while (!server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

PageServer::~PageServer() {
  state_->server.stop();
  state_->thread.join();
}

#else

struct PageServer::State {};

std::string WhyNoServer() {
  return "this program was built without a server, which --open and --watch need: install "
         "cpp-httplib (Debian: apt-get install libcpp-httplib-dev) and configure the build anew; "
         "--out writes a page to open yourself";
}

PageServer::PageServer(uint16_t, std::vector<ServedPath>) { throw Error(WhyNoServer()); }
PageServer::~PageServer() = default;

#endif

}  // namespace pelt
