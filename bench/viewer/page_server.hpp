// A server of a few texts to the browser of its own machine, and to no other machine or site: it listens on 127.0.0.1
// and ::1, answers GETs of the paths that it was given, and refuses those that a page of another name sends here.
//
//   PageServer server(0, {{"/", "text/html", [&](const std::string&) { return page; }}});
//   Print(server.address());       // until the server goes
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pelt {

// Empty, or why this program has no server and how to get one.
std::string WhyNoServer();

struct ServedPath {
  std::string path, type;
  // Of "?since=N" the N; called by several threads.
  std::function<std::string(const std::string& since)> text;
};

class PageServer {
 public:
  // Port 0: one that is free. Throws Error where the port is taken, or there is no server.
  PageServer(uint16_t port, std::vector<ServedPath> paths);
  // Answers what it was asked before, if that is taken within a second, and ends.
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  uint16_t port() const { return port_; }
  std::string address() const;  // http://127.0.0.1:PORT/

 private:
  struct State;
  uint16_t port_ = 0;
  std::unique_ptr<State> state_;
};

}  // namespace pelt
