#include "bench/viewer/bounded_server.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <future>
#include <list>

namespace pelt {
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

}  // namespace pelt
