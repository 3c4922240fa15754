#include "bench/viewer/page_server.hpp"

#include <fmt/format.h>

#include <cctype>
#include <chrono>
#include <thread>

#include "core/error.hpp"
#if defined(PELT_HTTPLIB)
#include "bench/viewer/bounded_server.hpp"
#endif

namespace pelt {

std::string PageServer::address() const { return fmt::format("http://127.0.0.1:{}/", port_); }

#if defined(PELT_HTTPLIB)

namespace {

constexpr const char* kHost = "127.0.0.1";
constexpr const char* kHost6 = "::1";

// Else another site could point its own name at this machine's address, and its page would read what is here.
bool IsAskedByOwnName(const httplib::Request& request, uint16_t port) {
  std::string host = request.get_header_value("Host");
  for (char& c : host) c = char(std::tolower(uint8_t(c)));
  for (const char* name : {kHost, "localhost", "[::1]"})
    if (host == fmt::format("{}:{}", name, port) || (port == 80 && host == name)) return true;
  return false;
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

void SetUp(httplib::Server& server, const std::vector<ServedPath>& paths,
           const std::function<bool(const httplib::Request&)>& is_own) {
  // The library's own option lets two servers share a port.
  server.set_socket_options([]([[maybe_unused]] socket_t socket) {
#if !defined(_WIN32)
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
#endif
  });
  server.set_default_headers({{"Cache-Control", "no-store"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Accept-Ranges", "none"}});
  // Before a body is read, which may be packed a thousandfold.
  server.set_pre_routing_handler(
      [is_own](const httplib::Request& request, httplib::Response& response) {
        const bool gets = request.method == "GET" || request.method == "HEAD";
        if (gets && is_own(request)) return httplib::Server::HandlerResponse::Unhandled;
        response.status = gets ? 403 : 405;
        return httplib::Server::HandlerResponse::Handled;
      });
  for (const ServedPath& served : paths)
    server.Get(served.path, [served](const httplib::Request& request, httplib::Response& response) {
      Send(response, served.text(request.get_param_value("since")), served.type);
    });
}

}  // namespace

// One of its two addresses.
struct Listener {
  BoundedServer server;
  std::thread thread;

  void Start() {
    server.LetManyCome();
    thread = std::thread([this] { server.listen_after_bind(); });
    // Before it runs it cannot be stopped.
    while (!server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ~Listener() {
    if (!thread.joinable()) return;
    server.stop();
    server.EndConnections();
    thread.join();
  }
};

struct PageServer::State {
  Listener four, six;
};

std::string WhyNoServer() { return {}; }

PageServer::PageServer(uint16_t port, std::vector<ServedPath> paths)
    : state_(std::make_unique<State>()) {
  Listener &four = state_->four, &six = state_->six;
  const auto is_own = [this](const httplib::Request& request) {
    return IsAskedByOwnName(request, port_);
  };
  for (Listener* listener : {&four, &six}) SetUp(listener->server, paths, is_own);
  const int bound = port == 0                               ? four.server.bind_to_any_port(kHost)
                    : four.server.bind_to_port(kHost, port) ? port
                                                            : -1;
  if (bound < 0)
    throw Error(port == 0 ? fmt::format("no port of {} is free", kHost)
                          : fmt::format("port {} of {} is taken, or not for you to take: another "
                                        "--port, or none for a free one",
                                        port, kHost));
  port_ = uint16_t(bound);
  four.Start();
  // Not every machine has IPv6; address() is the IPv4 one.
  if (six.server.bind_to_port(kHost6, port_)) six.Start();
}

PageServer::~PageServer() = default;

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
