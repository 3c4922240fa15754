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

// How relief is drawn.
void AddRelief(CLI::App& app, PictureArgs& args) {
  CLI::Option* relief = app.get_option("--relief");
  app.add_flag("--relief-rim", args.relief_rim,
               "Relief keeps its layers' fins, which are its outline; of shells with fins = true")
      ->needs(relief);
  app.add_option("--relief-steps", args.relief_steps,
                 "Steps of relief along the hairs and across them: the least and the most, 2,16")
      ->delimiter(',')
      ->expected(2)
      ->allow_extra_args(false)
      ->check(InRange(1.0, 256.0))
      ->needs(relief);
  app.add_option(
         "--relief-frames", args.relief_frames,
         "Each picture is the mean of so many with jittered steps of relief; 0: one without")
      ->check(CLI::Range(0, 256))
      ->needs(relief);
  app.add_option("--relief-wind", args.relief_wind_s,
                 "How far gusts push the tips of relief for each m/s of wind, in m")
      ->check(InRange(0.0, 1.0))
      ->needs(relief);
  app.add_flag("--relief-shows-steps", args.relief_shows_steps,
               "Relief in false colours: blue no step, green half of the most, red all")
      ->needs(relief);
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
  AddRelief(app, args);
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
  if (args.relief_steps[0] > args.relief_steps[1])
    throw UsageError(fmt::format("--relief-steps: the least, {}, is above the most, {}",
                                 args.relief_steps[0], args.relief_steps[1]));
  RefuseBeside(app, "--time", {"--picture-every"});
  RefuseBeside(app, "--lights", {"--light"});
  // What is drawn lies relative to each character's own origin, and pictures know of one world.
  if (args.Any() && app.count("--origins"))
    throw UsageError("--origins: pictures cannot be made of characters with origins of their own");
}

}  // namespace pelt
