#include "bench/command/view_serving.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <chrono>
#include <csignal>
#include <mutex>
#include <thread>

#include "bench/command/open_browser.hpp"
#include "bench/page/page_server.hpp"
#include "core/printable.hpp"

namespace pelt {
namespace {

using namespace std::chrono_literals;

constexpr auto kLookEvery = 150ms;

volatile std::sig_atomic_t end_asked = 0;
extern "C" void AskForEnd(int) { end_asked = 1; }

void PrintLine(const std::string& text) {
  fmt::print("{}\n", Printable(text));
  std::fflush(stdout);
}

uint32_t VersionOf(const std::string& text) {
  uint32_t version = 0;
  std::from_chars(text.data(), text.data() + text.size(), version);
  return version;
}

void PrintNews(const SceneWatch& scene) {
  if (!scene.error().empty())
    PrintLine(scene.error());
  else
    PrintLine(fmt::format("taken: {}", scene.changed().empty()
                                           ? "as it was before"
                                           : fmt::format("{}", fmt::join(scene.changed(), ", "))));
}

// Looks at the files now and then; in between it takes the digests of what changed, a frame at a time, so that what is
// saved meanwhile waits for no run.
void WatchUntilEnd(SceneWatch& scene, std::mutex& guard) {
  auto looked = std::chrono::steady_clock::now();
  while (!end_asked) {
    bool runs = false;
    {
      const std::lock_guard lock(guard);
      if (const auto now = std::chrono::steady_clock::now(); now - looked >= kLookEvery) {
        looked = now;
        if (scene.Look()) PrintNews(scene);
      }
      runs = scene.StepDigest();
    }
    // Even then the page's questions get their turn.
    std::this_thread::sleep_for(runs ? 1ms : kLookEvery / 3);
  }
}

}  // namespace

ExitCode ServePage(uint16_t port, const std::function<PageContent()>& content,
                   SceneWatch* watched) {
  std::mutex guard;  // the server's threads read what this one changes
  const auto page = [&](const std::string&) {
    const std::lock_guard lock(guard);
    PageContent shown = content();
    if (watched) shown.watched_from = watched->version();
    return MakePage(shown);
  };
  const auto changes = [&](const std::string& since) {
    const std::lock_guard lock(guard);
    return watched->ChangesSince(VersionOf(since));
  };
  std::vector<ServedPath> paths = {{"/", "text/html; charset=utf-8", page}};
  if (watched) paths.push_back({"/changes", "application/json", changes});
  end_asked = 0;
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, AskForEnd);
  const PageServer server(port, std::move(paths));
  PrintLine(fmt::format("page at {} (Ctrl-C ends it)", server.address()));
  if (!OpenBrowser(server.address()))
    PrintLine("no browser to open here: open that address in one");
  if (watched)
    WatchUntilEnd(*watched, guard);
  else
    while (!end_asked) std::this_thread::sleep_for(kLookEvery);
  return kDone;
}

}  // namespace pelt
