#include <fmt/format.h>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/command/view_serving.hpp"
#include "bench/page/page_request.hpp"
#include "bench/page/page_server.hpp"
#include "core/error.hpp"

namespace pelt {
namespace {

std::string CommandOf(const ScenarioRequest& request) {
  std::string command = "pelt run";
  for (const auto& [option, value] : RequestOptions(request))
    command += fmt::format(" --{} {}", option, value);
  return command + " --frames FRAMES";
}

}  // namespace

int View(const ViewArgs& args) {
  const bool serves = args.open || args.watch;
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
  if (!args.out.empty()) {
    const std::string page = MakePage(scene.Content(command));
    WriteOutput("page", args.out, page);
    fmt::print("page {}: {:.1f} MB; its first {} frames are held against this machine's digests\n",
               args.out.path(), double(page.size()) * 1e-6, args.frames);
  }
  return serves ? ServePage(args, command, scene) : 0;
}

}  // namespace pelt
