// In builds without bench/shading, bench/picture and bench/viewer: what needs them says so.
#include "bench/command/command_options.hpp"
#include "core/error.hpp"

namespace pelt {

// ---- Commands ---------------------------------------------------------------------------------

// Of PictureShots, which has none of them here.
class PictureMaps {};
class PictureRenderer {};
struct AnimationFrame {};

void RequirePictures() {
  throw Error("this pelt was built without bench/picture: -DPELT_PICTURES=ON");
}

void WritePng(std::string_view, const OutputPath&, std::span<const uint8_t>, uint32_t, uint32_t,
              uint32_t) {
  RequirePictures();
}

std::vector<uint8_t> DrawSkinMap(const Character&, const FurSetup&, const Groom&, uint32_t,
                                 std::vector<std::string>&) {
  RequirePictures();
  return {};
}

PictureShots::PictureShots(const PictureArgs& args, Scenario& scenario, FurScene& scene, uint32_t,
                           VertexOrder order)
    : args_(args), scenario_(scenario), scene_(scene), order_(order) {
  if (args_.Any()) RequirePictures();
}
PictureShots::PictureShots(PictureShots&&) noexcept = default;
PictureShots::~PictureShots() = default;
void PictureShots::Take(uint32_t) {}
void PictureShots::Finish() {}
void PictureShots::AddTo(ReportTree&) const {}

// ---- Their options ----------------------------------------------------------------------------

namespace {
constexpr const char* kWithoutPictures = "Left out of this build: -DPELT_PICTURES=ON";
}

void AddPictures(CLI::App& app, PictureArgs&) {
  for (const char* option :
       {"--picture", "--pictures", "--animation", "--steps", "--time", "--picture-every",
        "--picture-width", "--picture-height", "--renderer", "--lighting-buffer", "--relief",
        "--relief-rim", "--relief-steps", "--relief-frames", "--relief-wind",
        "--relief-shows-steps", "--light"}) {
    const auto refuse = [](const CLI::results_t&) {
      RequirePictures();
      return false;
    };
    app.add_option(option, CLI::callback_t(refuse), kWithoutPictures)->expected(0, 1);
  }
}

void CompletePictures(const CLI::App&, const PictureArgs&) {}

Subcommand SetUpView(CLI::App& root) {
  CLI::App* app = root.add_subcommand("view", kWithoutPictures);
  app->allow_extras();
  return {app, [] {},
          [] {
            RequirePictures();
            return kNoAnswer;
          }};
}

}  // namespace pelt
