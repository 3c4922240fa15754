// What `pelt view --open` answers, and to whom.
#include "bench/page/page_server.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"

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

// Everything that is answered, head and all.
std::string Ask(uint16_t port, const std::string& method, const std::string& path,
                std::string host = {}) {
  if (host.empty()) host = "127.0.0.1:" + std::to_string(port);
  const int socket = Connect("127.0.0.1", port);
  if (socket < 0) return "no connection";
  const std::string request =
      method + " " + path + " HTTP/1.1\r\nHost: " + host +
      "\r\nAccept-Encoding: gzip, br\r\nConnection: close\r\nContent-Length: 0\r\n\r\n";
  std::string answer;
  if (send(socket, request.data(), request.size(), MSG_NOSIGNAL) == ssize_t(request.size())) {
    char part[4096];
    for (ssize_t got; (got = recv(socket, part, sizeof(part), 0)) > 0;)
      answer.append(part, size_t(got));
  }
  close(socket);
  return answer;
}
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

TEST_F(PageServerTest, RefusesAPortThatIsTakenAndGivesItsOwnBack) {
  const uint16_t port = server_->port();
  try {
    PageServer second(port, Paths());
    ADD_FAILURE() << "two servers at one port";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(std::to_string(port)), std::string::npos);
  }
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
