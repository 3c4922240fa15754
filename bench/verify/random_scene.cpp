#include "bench/verify/random_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/verify/random_course.hpp"
#include "core/character/builtin_character.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/groom/bake.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

// Now and then at a bound or anywhere between; else what it usually is, or about that.
double DrawNumber(Random& random, double low, double high, double usual) {
  const uint32_t how = random.Below(32);
  if (how == 0) return low;
  if (how == 1) return high;
  if (how < 4) return random.Uniform(low, high);
  if (how < 18) return usual;
  // What is 0 when unsaid is drawn on all scales below its bound.
  double value = usual != 0.0 ? usual * 4.0 : high;
  value *= random.Uniform(0.5, 1.0) / double(1u << random.Below(usual != 0.0 ? 5 : 12));
  if (low < 0.0 && random.Below(2)) value = -value;
  return std::clamp(value, low, high);
}

template <class T>
void DrawParam(Random& random, const LayerParamRow<T>& row, T& value) {
  if constexpr (std::is_same_v<T, float>) {
    value = float(DrawNumber(random, row.low, row.high, double(value)));
  } else if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>) {
    value = T(random.Below(uint32_t(row.high) + 1));
  } else if constexpr (std::is_same_v<T, uint32_t>) {
    value = uint32_t(DrawNumber(random, row.low, row.high, double(value)));
  } else {
    for (auto& element : value)
      element = float(DrawNumber(random, row.low, row.high, double(element)));
  }
}

void SetUsual(LayerParams& params, std::string_view key) {
  ForEachLayerParam([&](const auto& row) {
    if (row.key == key) params.*row.member = LayerParams{}.*row.member;
  });
}

// What does not go together is unsaid again, key by key.
LayerParams DrawParams(Random& random) {
  constexpr uint32_t kPoints[] = {4, 5, 9};
  LayerParams params;
  ForEachLayerParam([&](const auto& row) { DrawParam(random, row, params.*row.member); });
  params.points = kPoints[random.Below(3)];
  params.max_distance =
      std::max(params.max_distance, params.max_distance > 0.0f ? kLeastMaxDistance : 0.0f);
  while (const auto bad = FindBadCombination(params)) SetUsual(params, bad->key);
  return params;
}

Attribute DrawAttribute(Random& random, const StrandAttribute& row, const Attribute& usual) {
  Attribute drawn(float(DrawNumber(random, row.low, row.high, double(usual.value))));
  if (random.Below(2)) drawn.randomise = float(random.Uniform());
  if (random.Below(4) == 0) {
    const float ends[] = {float(DrawNumber(random, row.low, row.high, double(usual.value))),
                          float(DrawNumber(random, row.low, row.high, double(usual.value)))};
    drawn.range = glm::vec2(std::min(ends[0], ends[1]), std::max(ends[0], ends[1]));
  }
  return drawn;
}

glm::vec3 DrawVector(Random& random, float low, float high) {
  glm::vec3 v;
  for (int c = 0; c < 3; ++c) v[c] = float(random.Uniform(low, high));
  return v;
}

template <class T>
const T& DrawOne(Random& random, const std::vector<T>& from) {
  return from[random.Below(uint32_t(from.size()))];
}

LayerSetup DrawLayer(Random& random, const Character& character, std::string name) {
  LayerSetup layer;
  layer.name = std::move(name);
  layer.seed = random.U64();
  layer.params = DrawParams(random);
  for (const StrandAttribute& row : kStrandAttributes)
    layer.*row.member = DrawAttribute(random, row, layer.*row.member);
  layer.max_strands = 1 + random.Below(200);
  layer.density = 1.0e4f * float(1u << random.Below(6));
  layer.clump_controls = 16u << random.Below(3);
  layer.film_strip_count = 1 + random.Below(4);
  layer.base_colour = random.U32();
  layer.tip_colour = random.U32();
  for (uint32_t i = random.Below(3); i > 0; --i)
    layer.comb.push_back({DrawVector(random, -0.5f, 1.0f), DrawVector(random, -1.0f, 1.0f),
                          float(random.Uniform(0.05, 0.5))});
  layer.comb_normal_weight = float(random.Uniform());
  if (random.Below(4) == 0) layer.comb_joint = DrawOne(random, character.skeleton.name);
  if (random.Below(2)) layer.mask.materials = {DrawOne(random, character.mesh.materials)};
  return layer;
}

// Both of them take a while to make, so they are made once.
const Character& SmallCharacter(BuiltinBody body) {
  static const Character kMonster = MakeBuiltinCharacter({.tiny = true});
  static const Character kScorpion =
      MakeBuiltinCharacter({.body = BuiltinBody::kScorpion, .tiny = true});
  return body == BuiltinBody::kMonster ? kMonster : kScorpion;
}

// Throws Error where a layer comes out without a strand.
void AddActor(Random& random, Scenario& scenario) {
  const Character& character = SmallCharacter(BuiltinBody(random.Below(4) == 0));
  FurSetup setup;
  setup.path = "drawn";
  const uint32_t layers = 1 + random.Below(4);
  for (uint32_t l = 0; l < layers; ++l)
    setup.layers.push_back(
        DrawLayer(random, character, fmt::format("{}.{}", scenario.actors.size(), l)));
  setup.layers[0].params.enabled = true;
  constexpr float kSizes[] = {1.0f, 1.0f, 1.0f, 0.25f, 3.0f};
  Actor actor{};
  actor.character = uint32_t(scenario.characters.size());
  actor.groom = uint32_t(scenario.grooms.size());
  actor.clip = int32_t(random.Below(uint32_t(character.clips.size()) + 1)) - 1;
  actor.phase_s = random.Uniform();
  actor.weather_share = float(random.Uniform());
  const float size = kSizes[random.Below(5)];
  for (int c = 0; c < 3; ++c) actor.placement[c][c] = size;
  actor.placement[3] = glm::vec4(DrawVector(random, -0.3f, 0.3f), 1.0f);
  if (random.Below(3) == 0) {
    actor.teleport_frame = int32_t(random.Below(50));
    actor.teleport_by = DrawVector(random, -1.0f, 1.0f);
  }
  scenario.grooms.push_back(
      BakeGroom(character, ComputeRestGeometry(character, 1.0f), setup, 1.0f));
  scenario.characters.push_back(character);
  scenario.actors.push_back(actor);
}

RandomScene DrawFrom(Random random) {
  RandomScene drawn;
  Scenario& scenario = drawn.scenario;
  scenario.name = "drawn";
  for (uint32_t c = 1 + random.Below(2); c > 0; --c) AddActor(random, scenario);
  scenario.velocities = random.Below(2);
  scenario.origins = random.Below(3) == 0;
  if (scenario.origins && random.Below(2)) scenario.place = glm::dvec3(1.0e4, 0.0, -5.0e3);
  drawn.skip.cull = random.Below(4) == 0;
  drawn.skip.lod = random.Below(3) == 0;
  drawn.lod.strand_budget = random.Below(2) ? uint32_t(scenario.StrandCount() / 2) : 0;
  drawn.lod.fast_quality_px = float(random.Below(3));
  drawn.lod.budget_us = 50 * random.Below(4);
  drawn.lod.costs = {400.0f, 5.0f, 100.0f, {20.0f, 10.0f, 40.0f, 80.0f, 160.0f}};
  drawn.lod.least_chains = 0.5f * float(random.Below(3));
  DrawCourse(random, scenario);
  size_t layers = 0;
  for (const Groom& groom : scenario.grooms) layers += groom.layers.size();
  drawn.text =
      fmt::format("{} layers, {} strands{}{}", layers, scenario.StrandCount(),
                  scenario.velocities ? ", velocities" : "", scenario.origins ? ", origins" : "");
  return drawn;
}

template <class T>
std::string ShowValue(const LayerParamRow<T>& row, const T& value) {
  if constexpr (std::is_enum_v<T>)
    return fmt::format("\"{}\"", row.words[size_t(value)]);
  else if constexpr (std::is_class_v<T>)
    return fmt::format("[{}, {}, {}]", value[0], value[1], value[2]);
  else
    return fmt::format("{}", value);
}

}  // namespace

RandomScene DrawScene(uint64_t seed) {
  for (uint64_t attempt = 0;; ++attempt) try {
      return DrawFrom(Random(MixSeed(seed, attempt)));
    } catch (const Error&) {  // a layer without a strand: the next
      if (attempt == 1000) throw;
    }
}

std::string DescribeDrawn(const LayerParams& params) {
  std::string text;
  const LayerParams usual;
  ForEachLayerParam([&](const auto& row) {
    if (params.*row.member == usual.*row.member) return;
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", row.key,
                        ShowValue(row, params.*row.member));
  });
  return text;
}

}  // namespace pelt
