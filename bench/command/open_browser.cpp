#include "bench/command/open_browser.hpp"

#include <cstdlib>
#if !defined(_WIN32)
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>

extern char** environ;
#endif

namespace pelt {
namespace {

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

}  // namespace

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

}  // namespace pelt
