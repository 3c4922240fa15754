#include "bench/scenarios/cast.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "core/character/builtin_character.hpp"
#include "core/character/pose.hpp"
#include "core/groom/bake.hpp"
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

void Scale(Attribute& attribute, double by) {
  attribute.value = float(attribute.value * by);
  if (attribute.range) *attribute.range *= float(by);
}

// A layer's two coats: a short, dense undercoat and the longer hair above it.
LayerSetup MakeCoat(const LayerSetup& from, bool under, uint32_t member, double strand_share,
                    Random& random) {
  LayerSetup coat = from;
  coat.name = fmt::format("{} {}", from.name, under ? "under" : "over");
  coat.seed = random.U64() >> 1;
  coat.max_strands = std::max(32u, uint32_t(from.max_strands * strand_share * (under ? 0.6 : 0.4)));
  Scale(coat.length, (under ? 0.6 : 1.1) * random.Uniform(0.75, 1.2));
  coat.elevation.value = float(coat.elevation.value * random.Uniform(0.8, 1.2));
  coat.curl.value = float(coat.curl.value * random.Uniform(0.5, 1.5));
  coat.params.sort_bias += under ? 0.0f : 0.25f;
  coat.params.weight = float(coat.params.weight * random.Uniform(0.8, 1.2));
  const double turn = 3.0 * member / kCastCharacters;
  coat.base_colour = TurnHue(from.base_colour, turn);
  coat.tip_colour = TurnHue(from.tip_colour, turn);
  return coat;
}

FurSetup MakeMemberSetup(const FurSetup& monster, uint32_t member, uint64_t seed) {
  FurSetup setup;
  setup.path = fmt::format("cast member {}", member);
  double strands = 0.0;
  for (const LayerSetup& layer : monster.layers) strands += layer.max_strands;
  Random random(MixSeed(seed, member));
  const double share = kStrandsPerMember / strands * random.Uniform(0.9, 1.1);
  for (uint32_t l = 0; l < kLayersOf(member); ++l) {
    const LayerSetup& from = monster.layers[l / 2 % monster.layers.size()];
    setup.layers.push_back(MakeCoat(from, l % 2 == 0, member, share, random));
  }
  return setup;
}

glm::mat4 PlaceMember(uint32_t member, double size) {
  const uint32_t row = member / kPerRow, column = member % kPerRow;
  const uint32_t in_row = std::min(kPerRow, kCastCharacters - row * kPerRow);
  const glm::vec3 at((float(column) - 0.5f * float(in_row - 1)) * 1.3f, 0.0f, -1.4f * float(row));
  return glm::scale(glm::translate(glm::mat4(1.0f), at), glm::vec3(float(size)));
}

}  // namespace

Scenario MakeCast(const ScenarioRequest& request, const LoadProgress& progress) {
  const uint64_t seed = request.seed;
  Scenario scenario;
  const FurSetup monster = LoadSetup("monster");
  for (uint32_t m = 0; m < kCastCharacters; ++m) {
    if (progress) progress(m, kCastCharacters);
    Random random(MixSeed(seed ^ 0xca57, m));
    const double size = random.Uniform(0.7, 1.15);
    Character character = MakeBuiltinCharacter({.seed = m, .detail = kDetail});
    character.name = fmt::format("member {}", m);
    const FurSetup setup = MakeMemberSetup(monster, m, seed);
    std::vector<std::string> notes;
    Actor actor{};
    actor.character = actor.groom = m;
    actor.clip = character.clips.empty() ? -1 : int32_t(m % character.clips.size());
    actor.phase_s = random.Uniform(0.0, 2.0);
    actor.unit_scale = ChooseUnitScale(setup, character, notes);
    actor.placement = PlaceMember(m, size);
    scenario.grooms.push_back(BakeGroom(character, ComputeRestGeometry(character, actor.unit_scale),
                                        setup, actor.unit_scale));
    scenario.setups.push_back(setup);
    scenario.characters.push_back(std::move(character));
    scenario.actors.push_back(actor);
  }
  scenario.base.wind.velocity[0] = 1.2f;
  scenario.base.wind.gust_strength = 0.5f;
  scenario.base.wind.turbulence = 0.8f;
  scenario.camera.target = {0.0f, 0.55f, -1.4f};
  scenario.camera.radius_m = 8.0;
  scenario.camera.height_m = 1.6;
  scenario.camera.start_rad = -0.2;
  scenario.camera.rate_rad_per_s = 0.05;
  return scenario;
}

}  // namespace pelt
