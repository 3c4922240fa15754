#include "bench/picture/relief_coat.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/shading/shading.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/groom/height_field.hpp"
#include "core/groom/nearest_word.hpp"

namespace pelt {
namespace {

constexpr uint32_t kFlowSide = 256;
constexpr float kHairSpacing = 0.0035f;  // m, between the tile's dots
static_assert(kReliefTileDots == float(kHairTileDots));

// How often the tile goes along each sheet: whole times, so that it meets itself where the texture repeats.
std::vector<glm::vec2> Repeats(const Mesh& mesh, const RestGeometry& rest, const FlowMap& flow) {
  const TextureAxes axes = FindTextureAxes(mesh, rest.position);
  std::vector<glm::vec2> sum(flow.sheets, glm::vec2(0.0f));
  std::vector<float> count(flow.sheets, 0.0f);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (flow.sheet[t] == FlowMap::kNoSheet) continue;
    for (const uint32_t corner : mesh.triangles[t]) {
      sum[flow.sheet[t]] += glm::vec2(glm::length(axes.u[corner]), glm::length(axes.v[corner]));
      count[flow.sheet[t]] += 1.0f;
    }
  }
  for (size_t s = 0; s < sum.size(); ++s)
    sum[s] = glm::max(
        glm::round(sum[s] / std::max(count[s], 1.0f) / (kHairSpacing * float(kHairTileDots))),
        glm::vec2(1.0f));
  return sum;
}

ControlMap Sheet(const FlowMap& flow, uint32_t number) {
  const size_t bytes = size_t(flow.side) * flow.side * 4;
  const auto first = flow.rgba.begin() + ptrdiff_t(bytes * number);
  return {flow.side, flow.side, {first, first + ptrdiff_t(bytes)}};
}

ControlMap MakeTile() {
  ControlMap tile{kHairTileSide, kHairTileSide, {}};
  for (const uint8_t height : MakeHairTile())
    tile.rgba.insert(tile.rgba.end(), {height, height, height, 255});
  return tile;
}

bool HasSetup(const Scenario& scenario, const Actor& actor) {
  return actor.groom < scenario.setups.size() && !scenario.setups[actor.groom].layers.empty();
}

bool IsNamed(std::span<const std::string> names, std::string_view layer) {
  return std::ranges::any_of(
      names, [&](const std::string& name) { return name == layer || name == "all"; });
}

}  // namespace

TextureAxes FindTextureAxes(const Mesh& mesh, const std::vector<glm::vec3>& position) {
  TextureAxes axes{std::vector<glm::vec3>(position.size(), glm::vec3(0.0f)),
                   std::vector<glm::vec3>(position.size(), glm::vec3(0.0f))};
  if (mesh.uv.empty()) return axes;
  std::vector<float> weight(position.size(), 0.0f);
  for (const auto& corner : mesh.triangles) {
    const glm::vec3 a = position[corner[1]] - position[corner[0]],
                    b = position[corner[2]] - position[corner[0]];
    const glm::vec2 ta = mesh.uv[corner[1]] - mesh.uv[corner[0]],
                    tb = mesh.uv[corner[2]] - mesh.uv[corner[0]];
    const float det = ta.x * tb.y - ta.y * tb.x;
    if (std::abs(det) < 1e-12f) continue;
    const float area = glm::length(glm::cross(a, b));
    for (const uint32_t v : corner) {
      axes.u[v] += (a * tb.y - b * ta.y) * (area / det);
      axes.v[v] += (b * ta.x - a * tb.x) * (area / det);
      weight[v] += area;
    }
  }
  for (size_t v = 0; v < position.size(); ++v) {
    axes.u[v] /= std::max(weight[v], 1e-20f);
    axes.v[v] /= std::max(weight[v], 1e-20f);
  }
  return axes;
}

ReliefCoat::ReliefCoat(const Character& character, const FurSetup& setup, float unit_scale,
                       std::span<const std::string> names)
    : mesh_(character.mesh), tile_(MakeTile()) {
  const RestGeometry rest = ComputeRestGeometry(character, unit_scale);
  for (const LayerSetup& layer : setup.layers) {
    if (!layer.params.enabled || !IsNamed(names, layer.name)) continue;
    const FlowMap flow = MakeFlowMap(character, rest, setup, layer, kFlowSide);
    Layer& made =
        layers_.emplace_back(Layer{layer.params.look, flow.sheet, {}, {}, flow.longest_m});
    for (uint32_t s = 0; s < flow.sheets; ++s) made.flow.push_back(Sheet(flow, s));
    made.repeat = Repeats(mesh_, rest, flow);
  }
}

bool ReliefCoat::Covers(uint32_t triangle) const {
  return std::ranges::any_of(
      layers_, [&](const Layer& layer) { return layer.sheet[triangle] != FlowMap::kNoSheet; });
}

glm::vec3 ReliefCoat::Shade(const Body& body, const SurfacePoint& at,
                            std::span<const PictureLook> looks, const ReliefShow& show,
                            const glm::vec3& eye, float sun_share, const glm::vec3& skin,
                            ReliefCount& count) const {
  const glm::vec3 to_eye = glm::normalize(eye - Interpolate(body.position, mesh_, at));
  glm::vec3 colour = skin;
  for (size_t i = 0; i < layers_.size(); ++i) {
    if (layers_[i].sheet[at.triangle] == FlowMap::kNoSheet) continue;
    const glm::vec4 shaded =
        ShadeLayer(layers_[i], body, at, looks[i], show, to_eye, sun_share, colour);
    if (shaded.w < 0.0f) continue;
    colour = glm::vec3(shaded);
    count.steps += double(shaded.w);
    ++count.places;
  }
  return colour;
}

glm::vec4 ReliefCoat::ShadeLayer(const Layer& layer, const Body& body, const SurfacePoint& at,
                                 const PictureLook& look, const ReliefShow& show,
                                 const glm::vec3& to_eye, float sun_share,
                                 const glm::vec3& below) const {
  const uint16_t sheet = layer.sheet[at.triangle];
  const glm::vec2 uv = Interpolate(mesh_.uv, mesh_, at);
  glm::vec4 texel;
  for (int c = 0; c < 4; ++c) texel[c] = layer.flow[sheet].Sample(uv, c);
  if (texel.a <= 0.0f) return {below, -1.0f};
  const ReliefPoint point{.colour = Interpolate(body.fur, mesh_, at),
                          .tip_colour = Interpolate(body.fur_tip, mesh_, at),
                          .normal = glm::normalize(Interpolate(body.normal, mesh_, at)),
                          .axis_u = Interpolate(body.axes.u, mesh_, at),
                          .axis_v = Interpolate(body.axes.v, mesh_, at),
                          .uv = uv,
                          .repeat = layer.repeat[sheet],
                          .flow = texel,
                          .longest = layer.longest_m,
                          .floor_light = look.depth_floor,
                          .sun_share = sun_share,
                          .to_eye = to_eye};
  const auto height = [&](const glm::vec2& place) { return tile_.Sample(place, 0); };
  const glm::vec4 shaded = ShadeRelief(height, look.light, look.hair, show.march, point);
  const glm::vec3 colour =
      show.shows_steps ? ReliefStepColour(shaded.w, show.march.most) : glm::vec3(shaded);
  return {glm::mix(below, colour, texel.a), shaded.w};
}

void CheckRelief(const Scenario& scenario, std::span<const std::string> names, bool rim) {
  if (names.empty()) return;
  std::vector<std::string> known;
  bool has_fins = false;
  for (const Actor& actor : scenario.actors) {
    if (!HasSetup(scenario, actor))
      throw Error("picture: relief is made from a fur setup, and a groom file has none");
    if (const Character& character = scenario.characters[actor.character];
        character.mesh.uv.empty())
      throw Error(
          fmt::format("picture: relief needs texture coordinates, which {} lacks", character.name));
    for (const LayerSetup& layer : scenario.setups[actor.groom].layers) {
      has_fins |= layer.params.fins && IsNamed(names, layer.name);
      if (std::ranges::find(known, layer.name) == known.end()) known.push_back(layer.name);
    }
  }
  for (const std::string& name : names)
    if (name != "all" && std::ranges::find(known, name) == known.end())
      throw Error(fmt::format("picture: no layer '{}' to draw as relief; there are: {}{}", name,
                              fmt::join(known, ", "), DidYouMean(name, known)));
  if (rim && !has_fins)
    throw Error(fmt::format("picture: no rim: none of '{}' has fins, of shells with fins = true",
                            fmt::join(names, ",")));
}

bool CanBeRelief(const Scenario& scenario) {
  return std::ranges::all_of(scenario.actors, [&](const Actor& actor) {
    return HasSetup(scenario, actor) && !scenario.characters[actor.character].mesh.uv.empty();
  });
}

std::vector<std::shared_ptr<const ReliefCoat>> MakeReliefCoats(const Scenario& scenario,
                                                               std::span<const std::string> names) {
  CheckRelief(scenario, names);
  std::vector<std::shared_ptr<const ReliefCoat>> coats(scenario.actors.size());
  for (size_t a = 0; a < coats.size() && !names.empty(); ++a) {
    const Actor& actor = scenario.actors[a];
    const auto same = std::ranges::find_if(scenario.actors, [&](const Actor& other) {
      return other.character == actor.character && other.groom == actor.groom &&
             other.unit_scale == actor.unit_scale;
    });
    coats[a] = coats[size_t(same - scenario.actors.begin())];
    if (!coats[a])
      coats[a] =
          std::make_shared<const ReliefCoat>(scenario.characters[actor.character],
                                             scenario.setups[actor.groom], actor.unit_scale, names);
  }
  return coats;
}

namespace {
// What leaves a layer its fins, with this fade, and nothing of its shells: no hair is longer than the longest.
std::span<const Shell> NoShell(float fade) {
  static const auto kOfFade = [] {
    std::array<Shell, 256> made;
    for (size_t i = 0; i < made.size(); ++i)
      made[i] = {.height = 1.0f, .shadow = 1.0f, .threshold = 1.0f, .fade = float(i) / 255.0f};
    return made;
  }();
  return {&kOfFade[size_t(fade * 255.0f + 0.5f)], 1};
}
}  // namespace

void RemoveRelief(const Scenario& scenario, const FurScene& scene,
                  std::span<const std::string> names, bool rim,
                  std::vector<std::vector<Hair>>& layers, std::span<LayerDraw> draws) {
  if (names.empty()) return;
  for (size_t d = 0; d < draws.size(); ++d) {
    const std::string_view name = scene.LayerName(draws[d].layer);
    const Actor& actor = scenario.actors[scene.shape().layer_character[draws[d].layer]];
    const bool is_known = std::ranges::any_of(
        scenario.setups[actor.groom].layers, [&](const auto& layer) { return layer.name == name; });
    if (!is_known || !IsNamed(names, name)) continue;
    layers[d].clear();
    std::span<const Shell>& shells = draws[d].shells.shell;
    const bool has_rim = rim && !shells.empty() && !draws[d].shells.fins.empty();
    shells = has_rim ? NoShell(shells.back().fade) : std::span<const Shell>();
  }
}

}  // namespace pelt
