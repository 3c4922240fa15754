#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/report/report_page.hpp"
#include "core/error.hpp"

namespace pelt {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using OpenFile = std::unique_ptr<std::FILE, CloseFile>;

OpenFile OpenTemporary() {
  OpenFile file(std::tmpfile());
  if (!file)
    throw Error("no temporary file for what a command prints: " +
                std::generic_category().message(errno));
  return file;
}

std::string ReadBack(const OpenFile& file) {
  std::rewind(file.get());
  return std::string(AsText(ReadToEnd(file.get(), kRunBytesLimit).OrThrow()));
}

// The shell's exit code; a signal as shells report it.
int RunInShell(const std::string& command, std::FILE* out, std::FILE* err) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, fileno(out), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, fileno(err), STDERR_FILENO);
  std::array<std::string, 3> words = {"sh", "-c", command};
  char* const arguments[] = {words[0].data(), words[1].data(), words[2].data(), nullptr};
  pid_t process = 0;
  const int failed = posix_spawn(&process, "/bin/sh", &files, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&files);
  if (failed) throw Error("the shell does not start: " + std::generic_category().message(failed));
  int status = 0;
  while (waitpid(process, &status, 0) < 0)
    if (errno != EINTR)
      throw Error("waiting for a command: " + std::generic_category().message(errno));
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string LastLine(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

MeasuredRun RunRound(const std::string& command, uint32_t round) {
  const std::string from = fmt::format("'{}', round {}", command, round + 1);
  const OpenFile out = OpenTemporary(), err = OpenTemporary();
  if (const int code = RunInShell(command, out.get(), err.get())) {
    const std::string said = LastLine(ReadBack(err));
    throw Error(fmt::format("{}: exit code {}{}{}", from, code, said.empty() ? "" : ": ", said));
  }
  return ReadMeasuredRun(from, ReadBack(out));
}

// The one that begins changes from round to round: what grows or shrinks meanwhile meets both.
void RunInTurns(uint32_t rounds, std::span<ComparedSide, 2> sides) {
  Progress progress("compare", 2 * rounds);
  for (uint32_t turn = 0; turn < 2 * rounds; ++turn) {
    ComparedSide& side = sides[(turn + turn / 2) % 2];
    progress.Show(turn, side.name);
    side.rounds.push_back(RunRound(side.name, turn / 2));
  }
}

}  // namespace

ExitCode Compare(const CompareArgs& args) {
  std::array<ComparedSide, 2> sides;
  if (args.commands.empty()) {
    sides = {ComparedSide{args.left, {ReadRunFile(args.left)}},
             ComparedSide{args.right, {ReadRunFile(args.right)}}};
  } else {
    sides = {ComparedSide{args.commands[0], {}}, ComparedSide{args.commands[1], {}}};
    RunInTurns(args.rounds, sides);
  }
  const ReportTree found = CompareRuns(sides[0], sides[1]);
  found.Print(args.json);
  const ExitCode exit_code = WhyUnsure(sides[0], sides[1]).empty() ? kDone : kNoAnswer;
  if (args.page.empty()) return exit_code;
  WriteOutput("page", args.page, ComparisonPage(sides[0], sides[1], found));
  if (!args.json) fmt::print("page of both {}\n", args.page.path());
  return exit_code;
}

}  // namespace pelt
