#include "bench/viewer/page_server.hpp"

#include <fmt/format.h>

#include "core/error.hpp"
#if defined(PELT_HTTPLIB)
#include <httplib.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <future>
#include <list>
#include <mutex>
#include <thread>
#endif

namespace pelt {

std::string PageServer::address() const { return fmt::format("http://127.0.0.1:{}/", port_); }

#if defined(PELT_HTTPLIB)

// A cpp-httplib server that no program on this machine can stop by asking slowly, much or never.
//
// The library bounds a line of a request but not their number, waits five seconds for each byte, and has eight threads
// for all who do. Here a request has 64 KiB and kAskS seconds in all, an answer kAnswerS, each connection a thread of
// its own and one request; where kMostConnections are open, the oldest ends for a new one.
class BoundedServer : public httplib::Server {
 public:
  static constexpr size_t kRequestBytes = 64 << 10;
  static constexpr std::chrono::seconds kAskS{5}, kAnswerS{30};
  static constexpr size_t kMostConnections = 64;

  BoundedServer();
  // Once it is bound: of more than five that come at once the library has the others try again a second later.
  void LetManyCome() { ::listen(svr_sock_, SOMAXCONN); }
  // After stop(): those who have not asked are not waited for, those who have get kEndS to take their answer.
  void EndConnections();

 private:
  static constexpr std::chrono::seconds kEndS{1};

  bool process_and_close_socket(socket_t socket) override;
  template <class Stream>
  void Answer(Stream& stream);

  std::mutex guard_;
  std::condition_variable closed_;
  std::vector<socket_t> open_;  // the oldest first
};

namespace {

using Clock = std::chrono::steady_clock;

// What later versions of the library ask for is here too; so nothing says that it overrides.
class BoundedStream : public httplib::Stream {
 public:
  explicit BoundedStream(socket_t socket) : socket_(socket) {}

  bool is_readable() const { return at_ < end_; }
  bool is_writable() const { return Wait(POLLOUT, answered_by_); }
  bool wait_readable() const { return is_readable() || Wait(POLLIN, asked_by_); }
  bool wait_writable() const { return is_writable(); }
  time_t duration() const { return 0; }

  // The library reads byte by byte.
  ssize_t read(char* to, size_t size) {
    if (at_ == end_ && !Fill()) return -1;
    size = std::min(size, end_ - at_);
    std::copy_n(buffer_.data() + at_, size, to);
    at_ += size;
    return ssize_t(size);
  }
  ssize_t write(const char* from, size_t size) {
    while (is_writable()) {
      // Without waiting: a reader that takes a byte now and then would keep it in one call.
      const ssize_t sent = send(socket_, from, size, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent >= 0 || errno != EAGAIN) return sent;
    }
    return -1;
  }

  void get_remote_ip_and_port(std::string&, int&) const {}
  void get_local_ip_and_port(std::string&, int&) const {}
  socket_t socket() const { return socket_; }

 private:
  bool Wait(short event, Clock::time_point until) const {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
    pollfd polled = {socket_, event, 0};
    return left.count() > 0 && poll(&polled, 1, int(left.count())) > 0;
  }
  bool Fill() {
    const size_t size = std::min(buffer_.size(), bytes_left_);
    if (size == 0 || !Wait(POLLIN, asked_by_)) return false;
    const ssize_t got = recv(socket_, buffer_.data(), size, 0);
    if (got <= 0) return false;
    at_ = 0;
    end_ = size_t(got);
    bytes_left_ -= end_;
    return true;
  }

  socket_t socket_;
  Clock::time_point asked_by_ = Clock::now() + BoundedServer::kAskS;
  Clock::time_point answered_by_ = asked_by_ + BoundedServer::kAnswerS;
  size_t bytes_left_ = BoundedServer::kRequestBytes;
  std::array<char, 4096> buffer_;
  size_t at_ = 0, end_ = 0;
};

class ThreadEach : public httplib::TaskQueue {
 public:
  using Taken = decltype(std::declval<httplib::TaskQueue&>().enqueue({}));  // void, later bool
  Taken enqueue(std::function<void()> task) override {
    tasks_.remove_if([](const std::future<void>& task) {
      return task.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    });
    // Ends soon: more than half of them are no longer open.
    if (tasks_.size() >= 2 * BoundedServer::kMostConnections) tasks_.pop_front();
    tasks_.push_back(std::async(std::launch::async, std::move(task)));
    return Taken(true);
  }
  void shutdown() override { tasks_.clear(); }

 private:
  std::list<std::future<void>> tasks_;  // each waits for its end where it goes
};

}  // namespace

BoundedServer::BoundedServer() {
  new_task_queue = [] { return new ThreadEach; };
}

void BoundedServer::EndConnections() {
  std::unique_lock lock(guard_);
  for (const socket_t socket : open_) ::shutdown(socket, SHUT_RD);
  closed_.wait_for(lock, kEndS, [this] { return open_.empty(); });
  for (const socket_t socket : open_) ::shutdown(socket, SHUT_RDWR);
}

template <class Stream>
void BoundedServer::Answer(Stream& stream) {
  bool closed = false;
  // A part for each of a thousand ranges that overlap: nothing here is worth a part of it.
  const auto whole = [](httplib::Request& request) { request.ranges.clear(); };
  if constexpr (requires { this->process_request(stream, true, closed, whole); })
    this->process_request(stream, true, closed, whole);
  else  // from version 0.17 on
    this->process_request(stream, {}, 0, {}, 0, true, closed, whole);
}

bool BoundedServer::process_and_close_socket(socket_t socket) {
  {
    const std::lock_guard lock(guard_);
    // It closes itself, when it finds that nothing more comes.
    if (open_.size() >= kMostConnections) {
      ::shutdown(open_.front(), SHUT_RDWR);
      open_.erase(open_.begin());
    }
    open_.push_back(socket);
  }
  BoundedStream stream(socket);
  Answer(stream);
  ::shutdown(socket, SHUT_RDWR);
  const std::lock_guard lock(guard_);  // no thread ends another connection of the same number
  std::erase(open_, socket);
  ::close(socket);
  closed_.notify_all();
  return true;
}

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
