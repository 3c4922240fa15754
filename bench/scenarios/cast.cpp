// The cast and the stage.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <span>
#include <sstream>
#include <string_view>

#include "bench/scenarios/made_scenes.hpp"
#include "core/character/builtin_character.hpp"
#include "core/character/pose.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/setup_schema.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

// 13 characters of 10 layers and 4 of 9.
constexpr uint32_t kLayersOf(uint32_t member) { return member < 13 ? 10 : 9; }
constexpr double kStrandsPerMember = 6'200.0;
constexpr uint32_t kPerRow = 6;
// About 1,400 vertices per character: as many as a console of the time gave one of seventeen.
constexpr float kDetail = 0.55f;

// Turns an 0xAABBGGRR colour's hue by mixing its channels round: `turn` of 3 is the same again.
uint32_t TurnHue(uint32_t colour, double turn) {
  double rgb[3];
  for (int c = 0; c < 3; ++c) rgb[c] = double(colour >> (8 * c) & 255u);
  const int whole = int(turn);
  const double part = turn - whole;
  uint32_t out = colour & 0xff000000u;
  for (int c = 0; c < 3; ++c) {
    const double value = rgb[(c + whole) % 3] * (1.0 - part) + rgb[(c + whole + 1) % 3] * part;
    out |= uint32_t(value + 0.5) << (8 * c);
  }
  return out;
}

// As an artist would have written it: the fewest digits that are read as this value.
double Written(double value) {
  return std::strtod(fmt::format("{}", float(value)).c_str(), nullptr);
}
std::string Written(uint32_t colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour & 255, colour >> 8 & 255, colour >> 16 & 255);
}

// In place of the value alone, where more is said of the key.
template <class T>
void Put(toml::table& layer, std::string_view key, const T& value) {
  toml::table* more = layer[key].as_table();
  if (more) key = "value";
  (more ? *more : layer).insert_or_assign(key, value);
}

void PutLength(toml::table& layer, const Attribute& length, double by) {
  Put(layer, "length", Written(length.value * by));
  if (!length.range) return;
  const glm::vec2 range = *length.range * float(by);
  layer["length"].as_table()->insert_or_assign("range",
                                               toml::array{Written(range.x), Written(range.y)});
}

// A layer's two coats: a short, dense undercoat and the longer hair above it. `layer`: as it was written.
toml::table MakeCoat(const LayerSetup& from, toml::table layer, bool under, uint32_t member,
                     double strand_share, Random& random) {
  layer.insert_or_assign("name", fmt::format("{} {}", from.name, under ? "under" : "over"));
  layer.insert_or_assign("seed", int64_t(random.U64() >> 1));
  layer.insert_or_assign(
      "max_strands",
      int64_t(std::max(32u, uint32_t(from.max_strands * strand_share * (under ? 0.6 : 0.4)))));
  PutLength(layer, from.length, (under ? 0.6 : 1.1) * random.Uniform(0.75, 1.2));
  Put(layer, "elevation", Written(from.elevation.value * random.Uniform(0.8, 1.2)));
  Put(layer, "curl", Written(from.curl.value * random.Uniform(0.5, 1.5)));
  // Cards, as the originals had: each strand stands for some hairs, which its picture shows.
  layer.insert_or_assign("width", 0.012);
  layer.insert_or_assign("tip_width", 0.9);
  layer.insert_or_assign("film_strips", 8);
  layer.insert_or_assign("sort_bias", Written(from.params.sort_bias + (under ? 0.0f : 0.25f)));
  layer.insert_or_assign("weight", Written(from.params.weight * random.Uniform(0.8, 1.2)));
  const double turn = 3.0 * member / kCastCharacters;
  layer.insert_or_assign("base_colour", Written(TurnHue(from.base_colour, turn)));
  layer.insert_or_assign("tip_colour", Written(TurnHue(from.tip_colour, turn)));
  return layer;
}

// The monster's setup, as it is read and as it is written.
struct Monster {
  FurSetup setup;
  toml::table written;
};

std::string MakeMemberText(const Monster& monster, uint32_t member, uint64_t seed) {
  const std::vector<LayerSetup>& layers = monster.setup.layers;
  double strands = 0.0;
  for (const LayerSetup& layer : layers) strands += layer.max_strands;
  Random random(MixSeed(seed, member));
  const double share = kStrandsPerMember / strands * random.Uniform(0.9, 1.1);
  toml::array coats;
  for (uint32_t l = 0; l < kLayersOf(member); ++l) {
    const size_t from = l / 2 % layers.size();
    coats.push_back(MakeCoat(layers[from], *monster.written["layer"][from].as_table(), l % 2 == 0,
                             member, share, random));
  }
  std::ostringstream text;
  text << toml::table{{"defaults", *monster.written["defaults"].as_table()},
                      {"layer", std::move(coats)}}
       << '\n';
  return text.str();
}

// In rows of six, the last one's in its middle.
glm::vec3 PlaceInCast(uint32_t member) {
  const uint32_t row = member / kPerRow, column = member % kPerRow;
  const uint32_t in_row = std::min(kPerRow, kCastCharacters - row * kPerRow);
  return {(float(column) - 0.5f * float(in_row - 1)) * 1.3f, 0.0f, -1.4f * float(row)};
}

// Three before three, so that each is seen.
glm::vec3 PlaceOnStage(uint32_t member) {
  const uint32_t row = member / 3, column = member % 3;
  return {(float(column) - 1.0f) * 1.25f - (row ? 0.62f : 0.0f), 0.0f, 0.5f - 1.0f * float(row)};
}

// What the members of a scene are and do.
struct Company {
  uint32_t count;
  glm::vec3 (*place)(uint32_t member);
  std::span<const std::string_view> clips;  // in turn
};

int32_t FindClip(const Character& character, std::string_view name) {
  const auto clip = std::ranges::find(character.clips, name, &Clip::name);
  return int32_t(clip - character.clips.begin());
}

void AddMember(const Monster& monster, const Company& company, const ScenarioRequest& request,
               uint32_t m, Scenario& scenario) {
  Random random(MixSeed(request.seed ^ 0xca57, m));
  const float size = float(random.Uniform(0.7, 1.15));
  Character character = MakeBuiltinCharacter({.seed = m, .detail = kDetail});
  character.name = fmt::format("member {}", m);
  const std::string_view text = request.SetupText(m);
  const FurSetup setup =
      ReadFurSetup(text.empty() ? MakeMemberText(monster, m, request.seed) : text,
                   fmt::format("cast member {}", m), "");
  std::vector<std::string> notes;
  Actor actor{};
  actor.character = actor.groom = m;
  actor.clip = FindClip(character, company.clips[m % company.clips.size()]);
  actor.phase_s = random.Uniform(0.0, 2.0);
  actor.unit_scale = ChooseUnitScale(setup, character, notes);
  actor.placement = glm::scale(glm::translate(glm::mat4(1.0f), company.place(m)), glm::vec3(size));
  scenario.grooms.push_back(BakeGroom(character, ComputeRestGeometry(character, actor.unit_scale),
                                      setup, actor.unit_scale));
  scenario.setups.push_back(setup);
  scenario.characters.push_back(std::move(character));
  scenario.actors.push_back(actor);
}

Scenario MakeCompany(const Company& company, const ScenarioRequest& request,
                     const LoadProgress& progress) {
  Scenario scenario;
  const FurSetup of_monster = LoadSetup("monster");
  const Monster monster{of_monster, ParseToml(of_monster.text, "monster")};
  for (uint32_t m = 0; m < company.count; ++m) {
    if (progress) progress(m, company.count);
    AddMember(monster, company, request, m, scenario);
  }
  scenario.base.wind.velocity[0] = 1.2f;
  scenario.base.wind.gust_strength = 0.5f;
  scenario.base.wind.turbulence = 0.8f;
  return scenario;
}

}  // namespace

Scenario MakeCast(const ScenarioRequest& request, const LoadProgress& progress) {
  constexpr std::string_view kClips[] = {"walk", "idle", "shake"};
  Scenario scenario = MakeCompany({kCastCharacters, PlaceInCast, kClips}, request, progress);
  scenario.camera.target = {0.0f, 0.55f, -1.4f};
  scenario.camera.radius_m = 8.0;
  scenario.camera.height_m = 1.6;
  scenario.camera.start_rad = -0.2;
  scenario.camera.rate_rad_per_s = 0.05;
  return scenario;
}

Scenario MakeStage(const ScenarioRequest& request, const LoadProgress& progress) {
  constexpr std::string_view kClips[] = {"walk", "greet"};
  Scenario scenario = MakeCompany({kStageCharacters, PlaceOnStage, kClips}, request, progress);
  scenario.base.skip.lod = true;
  scenario.camera.target = {0.0f, 0.5f, 0.0f};
  scenario.camera.radius_m = 4.5;
  scenario.camera.height_m = 0.8;
  scenario.camera.start_rad = -0.15;
  scenario.camera.rate_rad_per_s = 0.03;
  scenario.camera.vertical_fov_rad = 0.55;
  return scenario;
}

}  // namespace pelt
