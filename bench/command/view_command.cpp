#include <fmt/format.h>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/page/page_request.hpp"
#include "bench/page/page_text.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"

namespace pelt {
namespace {

// Everything that the request's files lead to, by the paths they have here: the page's module finds them by the same.
std::map<std::string, std::vector<std::byte>> ReadFilesOf(ScenarioRequest& request) {
  std::map<std::string, std::vector<std::byte>> files;
  const auto take = [&](const std::string& path) {
    if (!path.empty() && !IsBuiltInName(path)) files[path] = ReadFileBytes("file", path).OrThrow();
  };
  const CheckFilesReadHook before = request.check_files_read;
  request.check_files_read = [&, before](const std::vector<std::string>& led_to) {
    if (before) before(led_to);
    for (const std::string& path : led_to) take(path);
  };
  LoadScenario(request);
  request.check_files_read = before;
  if (request.scene.empty())
    for (const std::string* path : {&request.character, &request.setup, &request.groom})
      take(*path);
  take(request.lights);
  return files;
}

std::string CommandOf(const ScenarioRequest& request) {
  std::string command = "pelt run";
  for (const auto& [option, value] : RequestOptions(request))
    command += fmt::format(" --{} {}", option, value);
  return command + " --frames FRAMES";
}

}  // namespace

int View(const ViewArgs& args) {
  if (EmbeddedModule().empty()) throw Error(WhyNoModule());
  ScenarioRequest request = args.request;
  PageContent content;
  content.request = request;
  content.command = CommandOf(request);
  content.files = ReadFilesOf(request);
  {
    Progress progress("run", args.frames);
    content.digests = RunDigests(request, args.frames);
  }
  const std::string page = MakePage(content);
  WriteOutput("page", args.out, page);
  fmt::print("page {}: {:.1f} MB; its first {} frames are held against this machine's digests\n",
             args.out.path(), double(page.size()) * 1e-6, args.frames);
  return 0;
}

}  // namespace pelt
