// What `pelt view --open` answers, and to whom.
#include "bench/viewer/page_server.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/error_from.hpp"

#if defined(__linux__)
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

namespace pelt {
namespace {

int Connect(const char* host, uint16_t port) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  inet_pton(AF_INET, host, &address.sin_addr);
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  if (connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0)
    return socket;
  close(socket);
  return -1;
}

// Sends all of it, unless the other side ends before; closes the socket. Everything that is answered, head and all.
std::string Exchange(int socket, const std::string& request) {
  if (socket < 0) return "no connection";
  for (size_t at = 0; at < request.size();) {
    const ssize_t sent = send(socket, request.data() + at, request.size() - at, MSG_NOSIGNAL);
    if (sent <= 0) break;
    at += size_t(sent);
  }
  std::string answer;
  char part[4096];
  for (ssize_t got; (got = recv(socket, part, sizeof(part), 0)) > 0;)
    answer.append(part, size_t(got));
  close(socket);
  return answer;
}
std::string Ask(uint16_t port, const std::string& method, const std::string& path,
                std::string host = {}, const std::string& more = {}) {
  if (host.empty()) host = "127.0.0.1:" + std::to_string(port);
  return Exchange(Connect("127.0.0.1", port),
                  method + " " + path + " HTTP/1.1\r\nHost: " + host +
                      "\r\nAccept-Encoding: gzip, br\r\nConnection: close\r\n"
                      "Content-Length: 0\r\n" +
                      more + "\r\n");
}
double SecondsSince(std::chrono::steady_clock::time_point from) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
}

// Connections that are there until the end of a test.
class OpenConnections {
 public:
  OpenConnections(uint16_t port, size_t count, const std::string& begin) {
    for (size_t i = 0; i < count; ++i) {
      sockets_.push_back(Connect("127.0.0.1", port));
      EXPECT_GE(sockets_.back(), 0);
      send(sockets_.back(), begin.data(), begin.size(), MSG_NOSIGNAL);
    }
  }
  ~OpenConnections() {
    for (const int socket : sockets_) close(socket);
  }
  const std::vector<int>& sockets() const { return sockets_; }

 private:
  std::vector<int> sockets_;
};
std::string StatusOf(const std::string& answer) { return answer.substr(0, 12); }
std::string BodyOf(const std::string& answer) { return answer.substr(answer.find("\r\n\r\n") + 4); }

class PageServerTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!WhyNoServer().empty()) GTEST_SKIP() << WhyNoServer();
    server_ = std::make_unique<PageServer>(0, Paths());
  }
  std::vector<ServedPath> Paths() {
    return {{"/", "text/html", [this](const std::string&) { return page_; }},
            {"/changes", "application/json",
             [](const std::string& since) { return "since <" + since + ">"; }}};
  }
  std::string page_ = std::string(300'000, 'x') + "end";
  std::unique_ptr<PageServer> server_;
};

TEST_F(PageServerTest, AnswersWithWhatItWasGivenUnpacked) {
  const std::string answer = Ask(server_->port(), "GET", "/");
  EXPECT_EQ(StatusOf(answer), "HTTP/1.1 200");
  EXPECT_TRUE(BodyOf(answer) == page_) << answer.substr(0, 300);
  EXPECT_NE(answer.find("no-store"), answer.npos);
  EXPECT_EQ(BodyOf(Ask(server_->port(), "GET", "/changes?since=17")), "since <17>");
  EXPECT_EQ(BodyOf(Ask(server_->port(), "GET", "/changes")), "since <>");
}

TEST_F(PageServerTest, HasNoOtherPathAndTakesNothing) {
  for (const char* path : {"/etc/passwd", "/../etc/passwd", "/changes/", "/index.html", "//"})
    EXPECT_EQ(StatusOf(Ask(server_->port(), "GET", path)), "HTTP/1.1 404") << path;
  for (const char* method : {"POST", "PUT", "DELETE"})
    EXPECT_EQ(StatusOf(Ask(server_->port(), method, "/")).substr(0, 10), "HTTP/1.1 4") << method;
}

TEST_F(PageServerTest, ListensToThisMachineAloneAndByItsOwnName) {
  EXPECT_EQ(server_->address(), "http://127.0.0.1:" + std::to_string(server_->port()) + "/");
  // An address of this machine that is another than the server's.
  const int other = Connect("127.0.0.2", server_->port());
  EXPECT_LT(other, 0) << "it listens to every address";
  if (other >= 0) close(other);
  EXPECT_EQ(StatusOf(Ask(server_->port(), "GET", "/", "evil.example")), "HTTP/1.1 403");
  EXPECT_EQ(
      StatusOf(Ask(server_->port(), "GET", "/", "localhost:" + std::to_string(server_->port()))),
      "HTTP/1.1 200");
}

TEST_F(PageServerTest, AnswersAtTheOtherAddressOfThisMachineToo) {
  sockaddr_in6 address = {};
  address.sin6_family = AF_INET6;
  address.sin6_addr = in6addr_loopback;
  const auto* at = reinterpret_cast<const sockaddr*>(&address);
  const int tried = ::socket(AF_INET6, SOCK_STREAM, 0);
  const bool there = tried >= 0 && bind(tried, at, sizeof(address)) == 0;
  close(tried);
  if (!there) GTEST_SKIP() << "no ::1 on this machine";
  address.sin6_port = htons(server_->port());
  const int socket = ::socket(AF_INET6, SOCK_STREAM, 0);
  ASSERT_EQ(connect(socket, at, sizeof(address)), 0);
  const std::string port = std::to_string(server_->port());
  const std::string begin = "GET /changes HTTP/1.1\r\nHost: [::1]:";
  EXPECT_EQ(StatusOf(Exchange(socket, begin + port + "\r\n\r\n")), "HTTP/1.1 200");
  for (const char* host : {"LocalHost:", "[::1]:"})
    EXPECT_EQ(StatusOf(Ask(server_->port(), "GET", "/changes", host + port)), "HTTP/1.1 200");
  for (const char* host : {"[::2]:", "::1:", "[::1].evil.example:", "localhost.evil.example:"})
    EXPECT_EQ(StatusOf(Ask(server_->port(), "GET", "/", host + port)), "HTTP/1.1 403") << host;
}

TEST_F(PageServerTest, ReadsNoMoreThanARequestHas) {
  const std::string line = "X-Line: " + std::string(1000, 'x') + "\r\n";
  const auto lines = [&](size_t count) {
    std::string text;
    for (size_t i = 0; i < count; ++i) text += line;
    return text;
  };
  EXPECT_EQ(StatusOf(Ask(server_->port(), "GET", "/changes", {}, lines(60))), "HTTP/1.1 200");
  const std::string begin =
      "GET /changes HTTP/1.1\r\nHost: localhost:" + std::to_string(server_->port()) + "\r\n";
  // Many lines; one line; lines without an end; one that never ends.
  for (const std::string& much :
       {begin + lines(16'000) + "\r\n", begin + "X: " + std::string(1 << 20, 'x') + "\r\n\r\n",
        begin + lines(2'000), std::string(1 << 20, 'G')}) {
    const auto from = std::chrono::steady_clock::now();
    const std::string answer = Exchange(Connect("127.0.0.1", server_->port()), much);
    EXPECT_NE(StatusOf(answer), "HTTP/1.1 200") << much.size();
    EXPECT_LT(SecondsSince(from), 3.0) << much.size();
  }
  // What is asked to be stored is not even read.
  EXPECT_EQ(StatusOf(Exchange(Connect("127.0.0.1", server_->port()),
                              "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: "
                              "1000000000\r\n\r\n")),
            "HTTP/1.1 405");
}

TEST_F(PageServerTest, RangesAreAnsweredWithAllOfIt) {
  std::string ranges = "Range: bytes=0-";
  for (int i = 0; i < 200; ++i) ranges += ",0-";
  for (const std::string& range : {ranges, std::string("Range: bytes=5-6")}) {
    const std::string answer = Ask(server_->port(), "GET", "/", {}, range + "\r\n");
    EXPECT_EQ(StatusOf(answer), "HTTP/1.1 200");
    EXPECT_TRUE(BodyOf(answer) == page_) << answer.size();
    EXPECT_NE(answer.find("Accept-Ranges: none"), answer.npos);
  }
}

// Who says nothing, a part, or takes no answer; more of them than there may be.
TEST_F(PageServerTest, NobodyHoldsUpAnotherOrTheEnd) {
  page_.assign(16 << 20, 'x');  // more than sockets hold
  const std::string part = "GET / HTTP/1.1\r\nHost: localhost:" + std::to_string(server_->port());
  for (const std::string& begin : {std::string(), part, part + "\r\n\r\n"}) {
    const OpenConnections open(server_->port(), begin.size() > part.size() ? 20 : 100, begin);
    const auto from = std::chrono::steady_clock::now();
    EXPECT_EQ(StatusOf(Ask(server_->port(), "GET", "/changes")), "HTTP/1.1 200");
    EXPECT_LT(SecondsSince(from), 2.0) << begin;
  }
  const OpenConnections silent(server_->port(), 20, {}),
      deaf(server_->port(), 5, part + "\r\n\r\n");
  const auto from = std::chrono::steady_clock::now();
  server_.reset();
  EXPECT_LT(SecondsSince(from), 3.0);
}

TEST_F(PageServerTest, ARequestHasItsTime) {
  const OpenConnections slow(server_->port(), 1, "GET / HTTP/1.1\r\n");
  const int socket = slow.sockets().front();
  const auto from = std::chrono::steady_clock::now();
  // A byte now and then.
  while (SecondsSince(from) < 15.0 && send(socket, "x", 1, MSG_NOSIGNAL) == 1)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_GT(SecondsSince(from), 4.0);
  EXPECT_LT(SecondsSince(from), 8.0);
}

TEST_F(PageServerTest, RefusesAPortThatIsTakenAndGivesItsOwnBack) {
  const uint16_t port = server_->port();
  const std::string error = test::ErrorFrom([&] { PageServer second(port, Paths()); });
  EXPECT_NE(error.find(std::to_string(port)), std::string::npos) << error;
  server_.reset();
  EXPECT_EQ(Ask(port, "GET", "/"), "no connection");
  PageServer again(port, Paths());
  EXPECT_EQ(again.port(), port);
}

TEST(PageServer, SaysHowToGetOneWhereThereIsNone) {
  if (WhyNoServer().empty()) return;
  EXPECT_NE(WhyNoServer().find("libcpp-httplib-dev"), std::string::npos);
  EXPECT_THROW(PageServer(0, {}), Error);
}

}  // namespace
}  // namespace pelt
#endif
