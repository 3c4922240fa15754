#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/viewer/page_request.hpp"
#include "bench/viewer/page_server.hpp"
#include "bench/viewer/replay_viewer.hpp"
#include "bench/viewer/scene_watch.hpp"
#include "core/error.hpp"
#include "core/format.hpp"

#if !defined(_WIN32)
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>

extern char** environ;
#endif

namespace pelt {
namespace {

// `pelt view --open` and `--watch`: the page at an address of this machine, until a signal ends it.

// ---- Has this machine's user shown an address ----

#if !defined(_WIN32)
// On its own: what it prints is not ours, and Ctrl-C here does not end a browser that it began. No shell reads the
// address.
bool StartAlone(const char* program, const std::string& argument) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t how;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&how);
  for (const int stream : {0, 1, 2})
    posix_spawn_file_actions_addopen(&files, stream, "/dev/null", stream ? O_WRONLY : O_RDONLY, 0);
  // The server has this one ignored, which a program that is started keeps.
  sigset_t broken_pipe;
  sigemptyset(&broken_pipe);
  sigaddset(&broken_pipe, SIGPIPE);
  posix_spawnattr_setsigdefault(&how, &broken_pipe);
  posix_spawnattr_setflags(&how, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  std::string name = program, given = argument;
  char* words[] = {name.data(), given.data(), nullptr};
  pid_t process = 0;
  const bool started = posix_spawnp(&process, program, &files, &how, words, environ) == 0;
  posix_spawnattr_destroy(&how);
  posix_spawn_file_actions_destroy(&files);
  return started;
}

bool IsSet(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value;
}
#endif

// False: there is no desktop or no program for it here, or it could not be started.
bool OpenBrowser(const std::string& address) {
#if defined(_WIN32)
  return std::system(("start \"\" \"" + address + "\"").c_str()) == 0;
#elif defined(__APPLE__)
  return StartAlone("open", address);
#else
  const bool has_own = IsSet("BROWSER");
  // Without a desktop it would run a browser of the terminal, in this one.
  if ((has_own || IsSet("DISPLAY") || IsSet("WAYLAND_DISPLAY")) && StartAlone("xdg-open", address))
    return true;
  return has_own && StartAlone(std::getenv("BROWSER"), address);
#endif
}

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

// `content`: of the page that is asked for next. `watched`: with what changes in it; or null.
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

std::string CommandOf(const ScenarioRequest& request) {
  std::string command = "pelt run";
  for (const auto& [option, value] : RequestOptions(request))
    command +=
        value.empty() ? fmt::format(" --{}", option) : fmt::format(" --{} {}", option, value);
  return command + " --frames FRAMES";
}

std::string ModelConsoles(const ScenarioRequest& request) {
  Scenario scenario = LoadScenario(request);
  JsonText json;
  json.BeginArray();
  AddModelledConsoles(scenario, scenario.default_frames, scenario.base.skip, scenario.base.lod,
                      json);
  json.EndArray();
  return json.Compact();
}

// `held_against`: the digests that its frames are compared with.
void WritePage(const ViewArgs& args, const PageContent& content, const std::string& held_against) {
  if (args.out.empty()) return;
  const std::string page = MakePage(content);
  WriteOutput("page", args.out, page);
  fmt::print("page {}: {:.1f} MB; {}\n", args.out.path(), double(page.size()) * 1e-6, held_against);
}

// The page of a recording. What would not open there is reported here.
ExitCode ViewRecording(const ViewArgs& args) {
  const std::vector<std::byte> bytes = ReadFileBytes("input log", args.replay).OrThrow();
  ReplayViewer::Open(bytes, args.replay).OrThrow();
  if (args.open && !WhyNoServer().empty()) throw Error(WhyNoServer());
  // By its name alone: the page may go to another machine.
  PageContent content;
  content.recording = std::filesystem::path(args.replay).filename().string();
  content.files[content.recording] = bytes;
  WritePage(args, content,
            fmt::format("its frames are compared with the digests recorded in {}", args.replay));
  return args.open ? ServePage(
                         args.port, [&] { return content; }, nullptr)
                   : kDone;
}

}  // namespace

ExitCode ViewScene(const ViewArgs& args) {
  const bool serves = args.open || args.watch;
  if (!args.replay.empty()) return ViewRecording(args);
  if (EmbeddedModule().empty()) throw Error(WhyNoModule());
  if (serves && !WhyNoServer().empty()) throw Error(WhyNoServer());
  SceneWatch scene(args.request, args.frames);
  if (args.watch && scene.files().empty())
    throw Error(
        "nothing to watch: no file is part of it; `pelt show` writes a setup to start from");
  {
    Progress progress("run", args.frames);
    while (scene.StepDigest()) progress.Show(scene.digests().size());
  }
  const std::string command = CommandOf(args.request);
  if (args.consoles) scene.TakeConsoles(ModelConsoles(args.request));
  WritePage(
      args, scene.Content(command),
      fmt::format("its first {} frames are compared with this machine's digests", args.frames));
  if (!serves) return kDone;
  return ServePage(
      args.port, [&] { return scene.Content(command); }, args.watch ? &scene : nullptr);
}

}  // namespace pelt
