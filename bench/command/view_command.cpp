#include <fmt/format.h>

#include <filesystem>

#include "bench/command/commands.hpp"
#include "bench/command/modelled_consoles.hpp"
#include "bench/command/progress.hpp"
#include "bench/command/view_serving.hpp"
#include "bench/page/page_request.hpp"
#include "bench/page/page_server.hpp"
#include "bench/page/replay_viewer.hpp"
#include "core/error.hpp"

namespace pelt {
namespace {

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

// The page of a recording. What would not open there is told here.
ExitCode ViewRecording(const ViewArgs& args) {
  const std::vector<std::byte> bytes = ReadFileBytes("input log", args.replay).OrThrow();
  ReplayViewer::Open(bytes, args.replay).OrThrow();
  if (args.open && !WhyNoServer().empty()) throw Error(WhyNoServer());
  // By its name alone: the page may go to another machine.
  PageContent content;
  content.recording = std::filesystem::path(args.replay).filename().string();
  content.files[content.recording] = bytes;
  WritePage(args, content,
            fmt::format("its frames are held against the digests recorded in {}", args.replay));
  return args.open ? ServePage(
                         args.port, [&] { return content; }, nullptr)
                   : kDone;
}

}  // namespace

ExitCode View(const ViewArgs& args) {
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
      fmt::format("its first {} frames are held against this machine's digests", args.frames));
  if (!serves) return kDone;
  return ServePage(
      args.port, [&] { return scene.Content(command); }, args.watch ? &scene : nullptr);
}

}  // namespace pelt
