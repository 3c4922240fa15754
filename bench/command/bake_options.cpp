// The options of `pelt bake`.
#include <memory>

#include "bench/command/command_options.hpp"

namespace pelt {

Subcommand SetUpBake(CLI::App& root) {
  const auto kept = std::make_shared<BakeArgs>();
  BakeArgs& args = *kept;
  auto* app = root.add_subcommand("bake", "Grow the fur of a character into a groom file");
  AddInputFileOrName(*app, "--character", args.character,
                     "A .glb or .gltf file, or 'builtin', 'scorpion'")
      ->capture_default_str();
  AddInputFileOrName(*app, "--setup", args.setup,
                     "A fur setup: a .toml file, or the name of a built-in one")
      ->capture_default_str();
  AddOutputFile(*app, "--out", args.out, "Groom file to write");
  auto* flow = AddOutputFile(*app, "--flow-map", args.flow_map,
                             "PNG file for which way a layer's fur lies, over the UVs", ".png");
  app->add_option("--flow-layer", args.flow_layer, "With --flow-map: the first layer if not given")
      ->needs(flow);
  AddOutputFile(*app, "--skin-map", args.skin_map,
                "PNG file for how much light fur leaves on the skin, over the UVs", ".png");
  AddOutputFile(*app, "--stencil-map", args.stencil_map,
                "PNG file for where fur grows, over the UVs: the densest layer, 0 is bald", ".png");
  app->add_option("--flow-side", args.flow_side, "Of flow, skin and stencil map, in texels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  AddOutputFile(*app, "--height-field", args.height_field,
                "PNG file for a tile of hairs as heights, for relief", ".png");
  auto* strip = AddOutputFile(*app, "--strip", args.strip,
                              "PNG file for a strand_texture, of --strip-from; no groom", ".png");
  strip->needs(AddInputFile(*app, "--strip-from", args.strip_from,
                            "A photograph with alpha: hairs side by side, roots on top")
                   ->needs(strip));
  app->add_option("--strips", args.strips, "Silhouettes to cut it into")
      ->needs(strip)
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  args.check_files_read = [app](const std::vector<std::string>& files) {
    CheckFilesRead(*app, files);
  };
  app->add_option("--seed", args.seed, "Another groom from the same setup")->capture_default_str();
  app->add_flag("--stats", args.stats, "How even every prefix of the scatter is");
  app->add_flag("--keys", args.keys, "Explain the keys of a fur setup");
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt bake --character builtin --setup monster --out monster.groom\n"
      "  pelt bake --setup eyepet --stats\n"
      "  pelt bake --setup monster --flow-map flow.png --flow-layer body --height-field hairs.png\n"
      "  pelt bake --setup monster --skin-map skin.png --stencil-map stencil.png --flow-side 256\n"
      "  pelt bake --strip-from photo.png --strips 8 --strip hair.png\n"
      "  pelt bake --setup tiny --json\n"
      "  pelt bake --keys");
  const auto complete = [app] {
    RefuseAllBut(*app, "--keys", {});
    RefuseAllBut(*app, "--strip", {"--strip-from", "--strips"});
    const bool has_map =
        app->count("--flow-map") || app->count("--skin-map") || app->count("--stencil-map");
    RefuseUnless(*app, has_map, {"--flow-side"}, "--flow-map, --skin-map or --stencil-map");
  };
  return {app, complete, [kept] { return Bake(*kept); }};
}

Subcommand SetUpShow(CLI::App& root) {
  const auto kept = std::make_shared<ShowCharacterArgs>();
  ShowCharacterArgs& args = *kept;
  auto* app = root.add_subcommand(
      "show",
      "What a character has: materials, joints, clips, colours, UVs; and a setup to start from");
  AddInputFileOrName(*app, "character", args.character,
                     "A .glb or .gltf file, or 'builtin', 'scorpion'")
      ->required();
  AddOutputFile(*app, "--out", args.out, "Setup file to write, instead of printing it", ".toml");
  AddOutputFile(*app, "--uv-template", args.uv_template,
                "PNG file for its UV layout as lines, to paint a map on", ".png");
  args.check_files_read = [app](const std::vector<std::string>& files) {
    CheckFilesRead(*app, files);
  };
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt show builtin\n"
      "  pelt show scorpion --out my_fur.toml\n"
      "  pelt show scorpion --uv-template my_map.png\n"
      "  pelt show scorpion --json\n"
      "And then: pelt run --character scorpion --setup ./my_fur.toml --picture my_fur.png");
  return {app, [] {}, [kept] { return ShowCharacter(*kept); }};
}

}  // namespace pelt
