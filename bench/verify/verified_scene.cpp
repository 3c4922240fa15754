#include "bench/verify/verified_scene.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "bench/scenarios/made_scenes.hpp"

namespace pelt {
namespace {

constexpr float kDenormal = 1.0e-40f;

// Where a layer's blocks begin in the groom's arrays that not every layer has, and how many it has.
struct RareBlocks {
  size_t vertex = 0, shells = 0, vertex_down = 0, vertex_traits = 0;  // of patches
  size_t strand4 = 0, strand5 = 0, strand9 = 0, fins = 0, strand_down = 0,
         strand_traits = 0;  // of chunks
};

RareBlocks CountRare(const GroomLayer& layer) {
  const LayerParams& params = layer.params;
  const bool shells = params.output == Output::kShells,
             on_vertices = params.chain == ChainKind::kVertex;
  const auto patches = [&](bool has) { return has ? size_t(layer.patch_count) : 0; };
  const auto chunks = [&](bool has) { return has ? size_t(layer.chunk_count) : 0; };
  return {patches(on_vertices),
          patches(shells),
          patches(params.sag_free && on_vertices),
          patches(params.traits && on_vertices),
          chunks(!shells && params.points == 4),
          chunks(params.points == 5),
          chunks(params.points == 9),
          chunks(params.fins),
          chunks(params.sag_free && !on_vertices),
          chunks(params.traits)};
}

std::vector<RareBlocks> FindRare(const Groom& groom) {
  std::vector<RareBlocks> places;
  RareBlocks at;
  for (const GroomLayer& layer : groom.layers) {
    places.push_back(at);
    const RareBlocks own = CountRare(layer);
    at.vertex += own.vertex;
    at.shells += own.shells;
    at.vertex_down += own.vertex_down;
    at.strand4 += own.strand4;
    at.strand5 += own.strand5;
    at.strand9 += own.strand9;
    at.fins += own.fins;
    at.strand_down += own.strand_down;
    at.vertex_traits += own.vertex_traits;
    at.strand_traits += own.strand_traits;
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
  const std::vector<RareBlocks> rare = FindRare(from);
  for (const size_t l : layers) {
    GroomLayer layer = from.layers[l];
    const RareBlocks &first = rare[l], own = CountRare(layer);
    Append(groom.mesh, from.mesh, layer.first_patch, layer.patch_count);
    Append(groom.vertex_rest, from.vertex_rest, first.vertex, own.vertex);
    Append(groom.shell_skin, from.shell_skin, first.shells, own.shells);
    Append(groom.vertex_down, from.vertex_down, first.vertex_down, own.vertex_down);
    Append(groom.strands, from.strands, layer.first_chunk, layer.chunk_count);
    Append(groom.halo, from.halo, layer.first_chunk, layer.chunk_count);
    Append(groom.strand_uv, from.strand_uv, layer.first_chunk, layer.chunk_count);
    Append(groom.strand_rest4, from.strand_rest4, first.strand4, own.strand4);
    Append(groom.strand_rest5, from.strand_rest5, first.strand5, own.strand5);
    Append(groom.strand_rest9, from.strand_rest9, first.strand9, own.strand9);
    Append(groom.fin_edges, from.fin_edges, first.fins, own.fins);
    Append(groom.strand_down, from.strand_down, first.strand_down, own.strand_down);
    Append(groom.vertex_traits, from.vertex_traits, first.vertex_traits, own.vertex_traits);
    Append(groom.strand_traits, from.strand_traits, first.strand_traits, own.strand_traits);
    layer.first_patch = uint32_t(groom.mesh.size()) - layer.patch_count;
    layer.first_chunk = uint32_t(groom.strands.size()) - layer.chunk_count;
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
  verified.strand_writes = 1;
  return verified;
}

}  // namespace pelt
