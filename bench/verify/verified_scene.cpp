#include "bench/verify/verified_scene.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "bench/scenarios/everything.hpp"

namespace pelt {
namespace {

constexpr float kDenormal = 1.0e-40f;

// Where a layer's rest blocks begin in the groom's arrays.
struct RestPlace {
  size_t vertex = 0, strand4 = 0, strand5 = 0, shells = 0, fins = 0, downs = 0, strand9 = 0;
};

// What one chunk of the layer has in each.
RestPlace RestOf(const LayerParams& params) {
  if (params.output == Output::kShells) return {1, 0, 0, 1, params.fins ? size_t(1) : 0};
  RestPlace one{0, 1, 0};
  if (params.points == 5) one = {0, 0, 1};
  if (params.points == 9) one = {.strand9 = 1};
  if (params.chain == ChainKind::kVertex) one.vertex = 1;
  one.downs = params.sag_free ? 1 : 0;
  return one;
}

std::vector<RestPlace> FindRest(const Groom& groom) {
  std::vector<RestPlace> places;
  RestPlace at;
  for (const GroomLayer& layer : groom.layers) {
    places.push_back(at);
    const RestPlace one = RestOf(layer.params);
    at.vertex += layer.chunk_count * one.vertex;
    at.strand4 += layer.chunk_count * one.strand4;
    at.strand5 += layer.chunk_count * one.strand5;
    at.shells += layer.chunk_count * one.shells;
    at.fins += layer.chunk_count * one.fins;
    at.downs += layer.chunk_count * one.downs;
    at.strand9 += layer.chunk_count * one.strand9;
  }
  return places;
}

template <class T>
void Append(std::vector<T>& to, const std::vector<T>& from, size_t first, size_t count) {
  to.insert(to.end(), from.begin() + ptrdiff_t(first), from.begin() + ptrdiff_t(first + count));
}

// A groom of some of another's layers.
Groom TakeLayers(const Groom& from, const std::vector<size_t>& layers) {
  Groom groom;
  groom.unit_scale = from.unit_scale;
  groom.joint_count = from.joint_count;
  groom.skeleton = from.skeleton;
  groom.joint_names = from.joint_names;
  const std::vector<RestPlace> rest = FindRest(from);
  for (const size_t l : layers) {
    GroomLayer layer = from.layers[l];
    const uint32_t chunks = layer.chunk_count;
    Append(groom.mesh, from.mesh, layer.first_chunk, chunks);
    Append(groom.strands, from.strands, layer.first_chunk, chunks);
    Append(groom.strand_uv, from.strand_uv, layer.first_chunk, chunks);
    const RestPlace one = RestOf(layer.params);
    Append(groom.vertex_rest, from.vertex_rest, rest[l].vertex, chunks * one.vertex);
    Append(groom.strand_rest4, from.strand_rest4, rest[l].strand4, chunks * one.strand4);
    Append(groom.strand_rest5, from.strand_rest5, rest[l].strand5, chunks * one.strand5);
    Append(groom.shell_skin, from.shell_skin, rest[l].shells, chunks * one.shells);
    Append(groom.fin_edges, from.fin_edges, rest[l].fins, chunks * one.fins);
    Append(groom.rest_down, from.rest_down, rest[l].downs, chunks * one.downs);
    Append(groom.strand_rest9, from.strand_rest9, rest[l].strand9, chunks * one.strand9);
    layer.first_chunk = uint32_t(groom.mesh.size()) - chunks;
    groom.layers.push_back(layer);
    groom.layer_joints.push_back(from.layer_joints[l]);
  }
  return groom;
}

// The other character's layers from the last to the first, every second of them.
Groom MakeNeighbour(const Groom& groom) {
  std::vector<size_t> layers;
  const size_t step = groom.layers.size() > 2 ? 2 : 1;
  for (size_t l = groom.layers.size(); l > 0; l -= std::min(l, step)) layers.push_back(l - 1);
  Groom neighbour = TakeLayers(groom, layers);
  for (GroomLayer& layer : neighbour.layers) {
    layer.name += " (neighbour)";
    layer.params.weight *= 0.8f;  // less: more could be more than a groom may have
  }
  // Moved inside its joints, so that the layers' boxes, which are kept by joint, still hold it.
  for (uint32_t j = 0; j < neighbour.joint_count; ++j)
    neighbour.skeleton.inverse_bind[j][3] += 0.01f;
  return neighbour;
}

// Whether a clip moves the joint, so that where it rests is not seen.
bool IsPlaced(const Character& character, uint32_t joint) {
  for (const Clip& clip : character.clips)
    for (const Track& track : clip.tracks)
      if (track.joint == joint && track.channel == Channel::kTranslation) return true;
  return false;
}

void AddDenormals(Groom& groom, Character& character) {
  constexpr uint32_t kEvery = 7;
  for (StrandBlock& strands : groom.strands)
    for (uint32_t i = 0; i < kStrandsPerChunk; i += kEvery) strands.width[i] = kDenormal;
  for (uint32_t j = 0; j < character.skeleton.rest.size(); ++j) {
    if (IsPlaced(character, j)) continue;
    for (int axis = 0; axis < 3; ++axis)
      if (float& at = character.skeleton.rest[j].translation[axis]; at == 0.0f) at = kDenormal;
  }
}

// Turned about the upright axis by the angle whose cosine is 0.8: the same bits everywhere.
glm::mat4 TurnAndMove(const glm::mat4& placement, const glm::vec3& by) {
  glm::mat4 turn(1.0f);
  turn[0] = {0.8f, 0.0f, -0.6f, 0.0f};
  turn[2] = {0.6f, 0.0f, 0.8f, 0.0f};
  glm::mat4 moved = placement * turn;
  moved[3] += glm::vec4(by, 0.0f);
  return moved;
}

// Painted layers are painted: a little in each frame, some of it wiped off again, where the camera looks.
void AddBrushes(Scenario& scenario) {
  const auto is_painted = [](const GroomLayer& layer) { return layer.params.painted; };
  if (std::ranges::none_of(scenario.grooms, [&](const Groom& groom) {
        return std::ranges::any_of(groom.layers, is_painted);
      }))
    return;
  FrameInput& base = scenario.base;
  const auto add = [&](PaintChannel channel, float share_of_distance, float amount) {
    PaintBrush& brush = base.brush[base.brush_count++];
    for (int k = 0; k < 3; ++k) brush.centre[k] = scenario.camera.target[k];
    brush.radius = share_of_distance * float(scenario.camera.radius_m);
    brush.hardness = 0.3f;
    brush.channel = uint32_t(channel);
    brush.amount = amount;
  };
  add(PaintChannel::kWet, 0.15f, 0.05f);
  add(PaintChannel::kMud, 0.3f, 0.1f);
  add(PaintChannel::kMud, 0.1f, -0.04f);
}

}  // namespace

bool HasRoomForEverything(const Scenario& scenario) {
  const double radius_m = scenario.camera.radius_m;
  return radius_m > 1.0 && radius_m < 10.0;
}

Scenario WithEverything(const Scenario& verified) {
  Scenario whole = verified;
  if (HasRoomForEverything(verified))
    AddEverything(whole, {-0.3f * float(whole.camera.radius_m), 0.0f, 0.2f});
  return whole;
}

Scenario MakeVerifiedScene(const Scenario& scenario) {
  Scenario verified = scenario;
  if (verified.actors.size() == 1) {
    Actor actor = verified.actors[0];
    verified.grooms.push_back(MakeNeighbour(verified.grooms[actor.groom]));
    actor.groom = uint32_t(verified.grooms.size()) - 1;
    actor.phase_s += 0.37;
    actor.weather_share = 0.6f;
    actor.teleport_frame = -1;
    const float aside = 0.3f * float(verified.camera.radius_m);
    actor.placement = TurnAndMove(actor.placement, {aside, 0.0f, -0.3f * aside});
    verified.actors.push_back(actor);
  } else {
    // A groom and a character of its own, if others share them.
    Actor& last = verified.actors.back();
    verified.grooms.push_back(verified.grooms[last.groom]);
    last.groom = uint32_t(verified.grooms.size()) - 1;
  }
  Actor& last = verified.actors.back();
  verified.characters.push_back(verified.characters[last.character]);
  last.character = uint32_t(verified.characters.size()) - 1;
  AddDenormals(verified.grooms[last.groom], verified.characters[last.character]);
  AddBrushes(verified);
  return verified;
}

}  // namespace pelt
