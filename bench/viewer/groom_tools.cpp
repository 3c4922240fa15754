#include "bench/viewer/groom_tools.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/picture/png.hpp"
#include "bench/viewer/page_json.hpp"
#include "core/character/pose.hpp"
#include "core/exact_math.hpp"
#include "core/file_bytes.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/groom_file.hpp"
#include "core/groom/setup_schema.hpp"

namespace pelt {
namespace {

using Json = PageJson;

// An arrow is as long as this share of its reach, which is drawn in these bounds, m. A shorter drag is a tap.
constexpr float kArrowShare = 0.5f, kLeastReach = 0.01f, kMostReach = 1000.0f, kTap = 0.002f;
constexpr uint32_t kLeastSide = 64, kMostSide = 1024;
constexpr double kMostDabs = 64.0, kDabsARadius = 3.0;

// ---- Comb vectors

// The skin at a comb vector: where the setup has it and where the last frame has it.
struct SkinFrame {
  glm::vec3 rest, posed, normal;  // `normal`: of the rest pose
  glm::mat3 to_posed;             // directions
};

glm::mat3 AxesOf(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::vec3 across = glm::cross(b - a, c - a);
  return {b - a, c - a, across / std::sqrt(std::max(glm::length(across), 1e-12f))};
}

// By the vertex that the bake has it belong to, the nearest.
SkinFrame FindFrame(const Mesh& mesh, const RestGeometry& rest, const Body& body,
                    const glm::vec3& position) {
  uint32_t nearest = 0;
  float least = 1e30f;
  for (uint32_t v = 0; v < rest.position.size(); ++v) {
    const glm::vec3 away = rest.position[v] - position;
    if (glm::dot(away, away) >= least) continue;
    least = glm::dot(away, away);
    nearest = v;
  }
  SkinFrame frame{rest.position[nearest], body.position[nearest], rest.normal[nearest],
                  glm::mat3(1.0f)};
  for (const auto& [a, b, c] : mesh.triangles) {
    if (a != nearest && b != nearest && c != nearest) continue;
    const glm::mat3 axes = AxesOf(rest.position[a], rest.position[b], rest.position[c]);
    if (std::abs(glm::determinant(axes)) < 1e-15f) continue;
    frame.to_posed =
        AxesOf(body.position[a], body.position[b], body.position[c]) * glm::inverse(axes);
    break;
  }
  return frame;
}

// As it heads along the skin, and so many degrees above it; straight up where it heads nowhere.
glm::vec3 Lift(const glm::vec3& direction, const glm::vec3& normal, double lift) {
  const glm::vec3 along = direction - normal * glm::dot(direction, normal);
  const float length = glm::length(along);
  if (!(length > 1e-6f)) return normal;
  const double radians = lift * exact::kRadiansPerDegree;
  return along / length * float(exact::Cos(radians)) + normal * float(exact::Sin(radians));
}

Json ToJson(const glm::vec3& v) { return {v.x, v.y, v.z}; }
glm::vec3 VectorOf(const Json& json) {
  return {json.at(0).get<float>(), json.at(1).get<float>(), json.at(2).get<float>()};
}

Json DescribeComb(const Viewer& viewer, const SkinFrame& frame, const CombVector& comb) {
  const glm::vec3 direction = glm::normalize(comb.direction);
  const glm::vec3 root = frame.posed + frame.to_posed * (comb.position - frame.rest);
  const glm::vec3 tip = root + frame.to_posed * (direction * (kArrowShare * comb.reach));
  const glm::vec3 at = viewer.ShareOf(root), to = viewer.ShareOf(tip);
  const glm::vec3 eye = viewer.RayAt(0.5, 0.5).from;
  const float rise = std::clamp(glm::dot(direction, frame.normal), -1.0f, 1.0f);
  return {{"position", ToJson(comb.position)},
          {"direction", ToJson(direction)},
          {"reach", comb.reach},
          {"root", {at.x, at.y}},
          {"tip", {to.x, to.y}},
          {"ring", comb.reach / viewer.HeightAt(std::max(at.z, 1e-3f))},
          {"lift", std::asin(double(rise)) / exact::kRadiansPerDegree},
          {"faces", at.z > 0.0f && glm::dot(frame.to_posed * frame.normal, eye - root) > 0.0f}};
}

// ---- Maps

template <class T>
const MapChannel* FindMapIn(const T& object, std::string_view key) {
  for (const KeyEntry<T>& entry : Schema<T>())
    if (entry.info.key == key && entry.map) return entry.map(object);
  return nullptr;
}

const MapChannel* FindMap(const LayerSetup& layer, std::string_view key) {
  constexpr std::string_view kMask = "mask.";
  return key.starts_with(kMask) ? FindMapIn(layer.mask, key.substr(kMask.size()))
                                : FindMapIn(layer, key);
}

std::vector<uint8_t> TexelsOf(const MapChannel& map, uint32_t side, double empty) {
  constexpr std::array<Wrap, 2> kInside = {Wrap::kClamp, Wrap::kClamp};
  std::vector<uint8_t> texels(size_t(side) * side, uint8_t(255.0 * empty + 0.5));
  for (size_t i = 0; map.map && i < texels.size(); ++i) {
    const glm::vec2 uv = (glm::vec2(float(i % side), float(i / side)) + 0.5f) / float(side);
    texels[i] = uint8_t(255.0f * map.map->Sample(uv, map.channel, kInside) + 0.5f);
  }
  return texels;
}

}  // namespace

const LayerSetup* GroomTools::FindLayer(size_t setup, std::string_view layer) const {
  if (setup >= viewer_.setup_count()) return nullptr;
  const std::vector<LayerSetup>& layers = viewer_.scenario().setups[setup].layers;
  const auto found = std::ranges::find(layers, layer, &LayerSetup::name);
  return found == layers.end() ? nullptr : &*found;
}

const Actor* GroomTools::FindActor(size_t setup) const {
  const std::vector<Actor>& actors = viewer_.scenario().actors;
  const auto found = std::ranges::find(actors, setup, &Actor::groom);
  return found == actors.end() ? nullptr : &*found;
}

const RestGeometry& GroomTools::RestOf(const Actor& actor) {
  if (rest_of_ != &actor || rest_load_ != viewer_.loads()) {
    rest_ = ComputeRestGeometry(viewer_.scenario().characters[actor.character], actor.unit_scale);
    rest_of_ = &actor;
    rest_load_ = viewer_.loads();
  }
  return rest_;
}

std::string GroomTools::DescribeCombs(size_t setup, std::string_view layer) {
  Json combs = Json::array();
  const LayerSetup* of = FindLayer(setup, layer);
  const Actor* actor = FindActor(setup);
  if (!of || !actor) return combs.dump();
  const RestGeometry& rest = RestOf(*actor);
  const Body& body = viewer_.Bodies()[size_t(actor - viewer_.scenario().actors.data())];
  for (const CombVector& comb : of->comb)
    combs.push_back(
        DescribeComb(viewer_, FindFrame(body.character->mesh, rest, body, comb.position), comb));
  return combs.dump();
}

std::string GroomTools::MoveComb(size_t setup, std::string_view vector, CombPart part, double x,
                                 double y, double lift) {
  const Json json = Json::parse(vector);
  CombVector comb{VectorOf(json.at("position")), VectorOf(json.at("direction")),
                  json.at("reach").get<float>()};
  const PageRay ray = viewer_.RayAt(x, y);
  const Actor* actor = FindActor(setup);
  if (!actor) return "null";
  const RestGeometry& rest = RestOf(*actor);
  const Body& body = viewer_.Bodies()[size_t(actor - viewer_.scenario().actors.data())];
  const Mesh& mesh = body.character->mesh;
  if (part == CombPart::kRoot) {
    const auto hit = viewer_.FindHit(ray);
    if (!hit || viewer_.scenario().actors[hit->actor].groom != setup) return "null";
    comb.position = Interpolate(rest.position, mesh, hit->place);
  }
  const SkinFrame frame = FindFrame(mesh, rest, body, comb.position);
  if (part == CombPart::kTip) {
    // Where the pointer is as far away as the root.
    const glm::vec3 root = frame.posed + frame.to_posed * (comb.position - frame.rest);
    const glm::vec3 ahead = viewer_.RayAt(0.5, 0.5).along;
    const float far = glm::dot(root - ray.from, ahead) / glm::dot(ray.along, ahead);
    const glm::vec3 to = glm::inverse(frame.to_posed) * (ray.from + ray.along * far - root);
    const glm::vec3 along = to - frame.normal * glm::dot(to, frame.normal);
    if (!(glm::length(along) > kTap)) return DescribeComb(viewer_, frame, comb).dump();
    comb.reach = std::clamp(glm::length(along) / kArrowShare, kLeastReach, kMostReach);
    comb.direction = along;
  }
  comb.direction = Lift(comb.direction, frame.normal, lift);
  return DescribeComb(viewer_, frame, comb).dump();
}

std::string GroomTools::BeginMap(size_t setup, std::string_view layer, std::string_view key,
                                 uint32_t side, double empty) {
  painted_.reset();
  const LayerSetup* of = FindLayer(setup, layer);
  const Actor* actor = FindActor(setup);
  if (!of || !actor) return fmt::format("there is no layer '{}' to paint on", layer);
  const MapChannel* map = FindMap(*of, key);
  if (!map) return fmt::format("layer '{}': key '{}' takes no map", layer, key);
  if (map->map && map->channel == 3)
    return fmt::format(
        "layer '{}': key '{}' takes its map's alpha, which a grey one has not: leave "
        "`channel` out to paint",
        layer, key);
  if (side < kLeastSide || side > kMostSide)
    return fmt::format("a map of {} texels a side; {} to {} are painted", side, kLeastSide,
                       kMostSide);
  const Mesh& mesh = viewer_.scenario().characters[actor->character].mesh;
  if (mesh.uv.empty())
    return "the character has no texture coordinates, which maps need: mask.materials, joints, box "
           "and range do without";
  const RestGeometry& rest = RestOf(*actor);
  painted_.emplace(Painted{setup, rest.position, MapBrush(mesh, rest, side),
                           TexelsOf(*map, side, std::clamp(empty, 0.0, 1.0))});
  return {};
}

double GroomTools::PaintMap(const glm::dvec2& from, const glm::dvec2& to, double radius,
                            double hardness, double value) {
  if (!painted_ || !(radius > 0.0)) return 0.0;
  const auto find = [&](const glm::dvec2& at) {
    return viewer_.FindHit(viewer_.RayAt(at.x, at.y));
  };
  const auto first = find(from), last = find(to);
  int dabs = 1;
  if (first && last)
    dabs = int(std::clamp(
        std::ceil(kDabsARadius * double(glm::length(last->position - first->position)) / radius),
        1.0, kMostDabs));
  for (int i = 1; i <= dabs; ++i) {
    const auto hit = find(from + (to - from) * (double(i) / dabs));
    if (!hit || viewer_.scenario().actors[hit->actor].groom != painted_->setup) continue;
    const Mesh& mesh = viewer_.Bodies()[hit->actor].character->mesh;
    painted_->brush.Paint(painted_->texels, {Interpolate(painted_->rest, mesh, hit->place),
                                             float(radius), float(hardness), float(value)});
  }
  return last ? radius / viewer_.HeightAt(double(viewer_.ShareOf(last->position).z)) : 0.0;
}

std::string GroomTools::MapPng() const {
  if (!painted_) return {};
  const uint32_t side = painted_->brush.side();
  return std::string(AsText(EncodePng(painted_->texels, side, side, 1)));
}

void GroomTools::TakeMap(size_t setup, std::string_view layer, std::string_view key,
                         std::string_view name) {
  viewer_.ReplaceSetup(setup, ChangeLayerMap(viewer_.setup_text(setup), "setup", layer, key, name));
}

std::string GroomTools::PathOf(size_t setup, std::string_view name) const {
  return InFolder(FolderOf(viewer_.scenario().setups.at(setup).path), std::string(name));
}

std::string GroomTools::DescribeFiles(size_t setup) const {
  const FurSetup& of = viewer_.scenario().setups.at(setup);
  Json maps = Json::array();
  const std::string folder = PathOf(setup, "");
  for (const std::string& path : of.files_read)
    maps.push_back(
        {{"name", path.starts_with(folder) ? path.substr(folder.size()) : path}, {"path", path}});
  Json json = {{"file", StemOf(of.path) + ".toml"}, {"maps", maps}};
  if (const Actor* actor = FindActor(setup); actor && !of.layers.empty()) {
    const Character& character = viewer_.scenario().characters[actor->character];
    std::vector<std::string> notes;
    const float unit_scale = ChooseUnitScale(of, character, notes);
    const Groom groom =
        BakeGroom(character, ComputeRestGeometry(character, unit_scale), of, unit_scale);
    json["digest"] = fmt::format("{:016x}", HashGroomBytes(WriteGroom(groom).OrThrow()));
  }
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace pelt
