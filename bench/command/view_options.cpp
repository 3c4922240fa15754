// The options of `pelt view`.
#include <memory>
#include <set>

#include "bench/command/command_options.hpp"

namespace pelt {
namespace {

// The setup by itself: `pelt view --watch my_fur.toml`.
void AddSetupFile(CLI::App& app, std::string& setup) {
  CLI::Option* file = AddInputFileOrName(app, "file", setup, "The fur setup, as by --setup");
  for (const char* other : {"--scene", "--setup", "--groom"}) file->excludes(app.get_option(other));
}

// In place of all that says what a scene is, which a recording says itself.
void AddReplay(CLI::App& app, std::string& replay) {
  const std::set<const CLI::Option*> shared = {app.get_option("--out"), app.get_option("--open"),
                                               app.get_option("--port"), app.get_help_ptr()};
  auto* option = AddInputFile(app, "--replay", replay,
                              "A recording (.peltinput) instead of a scene: its recorded frames, "
                              "each digest compared with the recorded one");
  for (CLI::Option* other : app.get_options())
    if (other != option && !shared.contains(other)) option->excludes(other);
}

void CompleteView(CLI::App& app, ViewArgs& args) {
  if (args.replay.empty()) CompleteSource(app, args.request);
  const bool serves = args.open || args.watch;
  RefuseUnless(app, serves, {"--port"}, "--open or --watch");
  if (!serves || app.count("--out")) return;
  args.out = {};
  app.get_option("--out")->default_str("");
}

}  // namespace

Subcommand SetUpView(CLI::App& root) {
  const auto kept = std::make_shared<ViewArgs>();
  ViewArgs& args = *kept;
  auto* app = root.add_subcommand(
      "view", "Write one HTML file that runs the scene in a browser: the same code, the same bits");
  AddSource(*app, args.request);
  AddClip(*app, args.request);
  AddSetupFile(*app, args.request.setup);
  AddOutputFile(*app, "--out", args.out, "Page to write; needs nothing else to be shown");
  app->add_flag("--open", args.open,
                "Show it in the browser of this machine; Ctrl-C ends it. Writes no file but --out");
  app->add_flag("--watch", args.watch,
                "As --open; and when the setup, a map or the model is saved, the page takes it and "
                "goes on where it is");
  app->add_option("--port", args.port, "On this machine alone; a free one if not given")
      ->check(CLI::Range(1, 65535));
  app->add_option("--frames", args.frames,
                  "Frames whose digests go along, for the page to compare its own with")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app->add_flag("--consoles", args.consoles,
                "With a frame as both consoles would run it: what each unit does");
  AddReplay(*app, args.replay);
  app->footer(
      "Examples:\n"
      "  pelt view --scene monster --out monster.html\n"
      "  pelt view --scene tiny --consoles --out tiny.html\n"
      "  pelt view --character builtin --setup eyepet --out eyepet.html\n"
      "  pelt trace record --scene tiny --frames 20 --out bug.peltinput\n"
      "  pelt view --replay bug.peltinput --out bug.html\n"
      "To see it: pelt view --scene monster --open, or --replay bug.peltinput --open\n"
      "To work on a setup: pelt view --watch my_fur.toml --character my_animal.glb");
  return {app, [app, kept] { CompleteView(*app, *kept); }, [kept] { return ViewScene(*kept); }};
}

}  // namespace pelt
