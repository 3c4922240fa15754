// The options of pictures of a run.
#include <fmt/format.h>

#include "bench/command/command_options.hpp"
#include "bench/command/usage_error.hpp"
#include "bench/picture/light_steps.hpp"
#include "bench/picture/renderers.hpp"
#include "bench/shading/named_lights.hpp"

namespace pelt {
namespace {

std::string DescribeLights() {
  std::string text = "Light of the pictures.";
  for (const NamedLight& light : kNamedLights)
    text += fmt::format(" {}: {}.", light.name, light.text);
  return text;
}

std::vector<std::string> LightNames() {
  std::vector<std::string> names;
  for (const NamedLight& light : kNamedLights) names.emplace_back(light.name);
  return names;
}

}  // namespace

void AddPictures(CLI::App& app, PictureArgs& args) {
  AddOutputFile(app, "--picture", args.last, "PNG file for a picture of the last frame", ".png");
  AddOutputFolder(app, "--pictures", args.folder, "Folder for a picture of each frame");
  AddOutputFile(app, "--animation", args.animation, "Animated PNG of the frames", ".png");
  std::string steps = "PNG file for the last picture in steps:";
  for (const LightStep& step : LightSteps()) steps += fmt::format(" {};", step.text);
  steps.pop_back();
  AddOutputFile(app, "--steps", args.steps, steps.c_str(), ".png");
  app.add_option("--time", args.times_s,
                 "Pictures of the frames at these times alone: 0.5,1,2 in s")
      ->delimiter(',')
      ->check(InRange(0.0, 1e5));
  app.add_option("--picture-every", args.every, "Frames from one picture to the next")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--picture-width", args.width_px, "In pixels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  app.add_option("--picture-height", args.height_px, "In pixels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  auto* renderer = app.add_option("--renderer", args.renderer,
                                  "What draws: software, or OpenGL without a display (gl)")
                       ->check(OneOf(RendererNames()))
                       ->capture_default_str();
  app.add_flag(
         "--lighting-buffer", args.lighting_buffer,
         "With --renderer gl: hair is lit in a blurred buffer of half the size, as EyePet's was")
      ->needs(renderer);
  app.add_option("--relief", args.relief,
                 "Layers that the pictures show as relief on the skin instead of as hairs; 'all'")
      ->delimiter(',');
  app.add_option("--light", args.light, DescribeLights())->check(OneOf(LightNames()));
}

void CompletePictures(const CLI::App& app, const PictureArgs& args) {
  RefuseUnless(
      app, args.Any(),
      {"--time", "--picture-width", "--picture-height", "--light", "--renderer", "--relief"},
      "--picture, --pictures, --animation or --steps");
  RefuseUnless(app, !args.folder.empty() || !args.animation.empty(), {"--picture-every"},
               "--pictures or --animation");
  RefuseUnless(app, args.renderer == "gl", {"--lighting-buffer"}, "--renderer gl");
  RefuseBeside(app, "--time", {"--picture-every"});
  RefuseBeside(app, "--lights", {"--light"});
  // What is drawn lies relative to each character's own origin, and pictures know of one world.
  if (args.Any() && app.count("--origins"))
    throw UsageError("--origins: pictures cannot be made of characters with origins of their own");
}

}  // namespace pelt
