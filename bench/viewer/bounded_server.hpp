// A cpp-httplib server that no program on this machine can stop by asking slowly, much or never.
//
// The library bounds a line of a request but not their number, waits five seconds for each byte, and has eight threads
// for all who do. Here a request has 64 KiB and kAskS seconds in all, an answer kAnswerS, each connection a thread of
// its own and one request; where kMostConnections are open, the oldest ends for a new one.
#pragma once

#include <httplib.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <vector>

namespace pelt {

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

}  // namespace pelt
