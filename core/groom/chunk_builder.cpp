#include "core/groom/chunk_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/groom/growth.hpp"

namespace pelt {
namespace {

constexpr uint32_t kNoSlot = 0xffffffffu;
constexpr uint32_t kChainPoints = 4;
// A strand on the far edge of a triangle still counts a little, so that every used vertex has a
// mean.
constexpr float kLeastWeight = 1e-3f;

// Of a vertex and its seam duplicates.
struct Sum {
  double weight = 0.0, length = 0.0, strength = 0.0;
  double traits[kStrandAttributes.size()] = {};
  RestShape offset{};  // rest pose, world axes
};

}  // namespace

std::vector<uint32_t> FindSeamDuplicates(const Mesh& mesh) {
  const uint32_t count = uint32_t(mesh.position.size());
  std::vector<uint32_t> order(count), duplicates(count);
  for (uint32_t v = 0; v < count; ++v) order[v] = v;
  auto key = [&](uint32_t v) {
    const glm::vec3 &p = mesh.position[v], &n = mesh.normal[v];
    return std::array<float, 6>{p.x, p.y, p.z, n.x, n.y, n.z};
  };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const auto ka = key(a), kb = key(b);
    return ka != kb ? ka < kb : a < b;
  });
  for (uint32_t i = 0; i < count; ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    duplicates[order[i]] = same ? duplicates[order[i - 1]] : order[i];
  }
  return duplicates;
}

VertexChains::VertexChains(const Mesh& mesh, const RestGeometry& rest,
                           std::span<const uint32_t> duplicates, const AttributeMaker& maker,
                           std::span<const GroomedStrand> strands)
    : slot_(mesh.position.size(), kNoSlot) {
  std::vector<Sum> sums(mesh.position.size());  // at the lowest duplicate
  std::vector<uint32_t> used;
  for (const GroomedStrand& strand : strands) {
    glm::dvec3 world[kChainPoints - 1];
    for (uint32_t i = 0; i + 1 < kChainPoints; ++i) {
      world[i] = strand.frame.FromFrame(strand.rest.offset[i]);
    }
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t v = mesh.triangles[strand.place.triangle][size_t(corner)];
      if (slot_[v] == kNoSlot) {
        slot_[v] = uint32_t(used.size());
        used.push_back(v);
      }
      Sum& sum = sums[duplicates[v]];
      const double weight = std::max(strand.place.bary[corner], kLeastWeight);
      sum.weight += weight;
      sum.length += weight * double(strand.length);
      sum.strength += weight * double(strand.strength);
      for (size_t i = 0; i < kStrandAttributes.size(); ++i)
        if (const auto trait = kStrandAttributes[i].trait)
          sum.traits[i] += weight * double(strand.traits.*trait);
      for (uint32_t i = 0; i + 1 < kChainPoints; ++i) sum.offset.offset[i] += world[i] * weight;
    }
  }
  chains_.resize(used.size());
  for (size_t i = 0; i < used.size(); ++i) {
    const uint32_t v = used[i];
    const Sum& sum = sums[duplicates[v]];
    const RootFrame frame = MakeRootFrame(glm::dvec3(rest.normal[v]), glm::dvec3(rest.tangent[v]));
    RestShape mean{};
    for (uint32_t k = 0; k + 1 < kChainPoints; ++k) {
      mean.offset[k] = frame.ToFrame(sum.offset.offset[k] / sum.weight);
    }
    const double length = sum.length / sum.weight;
    chains_[i].rest =  // Strands above and below may cancel.
        MakeEqualSegments(mean, length, kChainPoints, glm::dvec3(0.0, 0.0, 1.0));
    chains_[i].length = float(length);
    // Strands take what a chain does by their own length (kernels/interpolate.hpp).
    if (const double segment = double(maker.layer().segment_length); segment > 0.0) {
      const double own = segment * double(kChainPoints - 1);
      for (uint32_t k = 0; k + 1 < kChainPoints; ++k) chains_[i].rest.offset[k] *= own / length;
      chains_[i].length = float(own);
    }
    chains_[i].strength = float(std::min(sum.strength / sum.weight, 1.0));
    for (size_t k = 0; k < kStrandAttributes.size(); ++k)
      if (const auto trait = kStrandAttributes[k].trait)
        chains_[i].traits.*trait = float(sum.traits[k] / sum.weight);
    chains_[i].down = frame.ToFrame(kRestDown);
    chains_[i].lift = maker.LiftVertex(duplicates[v]);
  }
}

namespace {

// Lane of the data that a lane of a block holds: unused lanes copy the last used one.
uint32_t SourceLane(uint32_t lane, uint32_t used) { return std::min(lane, used - 1); }

void SetLane(float (&rows)[3][kVerticesPerChunk], uint32_t lane, const glm::vec3& v) {
  for (int axis = 0; axis < 3; ++axis) rows[axis][lane] = v[axis];
}

float WeightOf(const Mesh& mesh, uint32_t vertex, uint8_t joint) {
  float sum = 0.0f;
  for (int i = 0; i < 4; ++i) {
    if (mesh.joints[vertex][size_t(i)] == joint) sum += mesh.weights[vertex][i];
  }
  return sum;
}

glm::vec3 LiftedPosition(const LayerBake& bake, uint32_t vertex) {
  const float lift = bake.vertices[vertex].lift;
  if (lift == 0.0f) return bake.mesh.position[vertex];
  return bake.mesh.position[vertex] + bake.mesh.normal[vertex] * (lift / bake.metres_per_mesh_unit);
}

void FillMesh(const LayerBake& bake, const VertexPatch& patch, MeshBlock& block) {
  const uint32_t count = uint32_t(patch.vertices.size());
  for (uint32_t lane = 0; lane < kVerticesPerChunk; ++lane) {
    const uint32_t v = patch.vertices[SourceLane(lane, count)];
    const RootFrame frame =
        MakeRootFrame(glm::dvec3(bake.mesh.normal[v]), glm::dvec3(glm::vec3(bake.mesh.tangent[v])));
    SetLane(block.position, lane, LiftedPosition(bake, v));
    SetLane(block.normal, lane, glm::vec3(frame.normal));
    SetLane(block.tangent, lane, glm::vec3(frame.tangent));
  }
  uint32_t row = 0;
  for (uint32_t g = 0; g < patch.groups.size(); ++g) {
    block.group_first_row[g] = uint16_t(row);
    for (const uint8_t joint : patch.groups[g].joints) {
      for (uint32_t i = 0; i < kLaneGroup; ++i) {
        const uint32_t lane = SourceLane(g * kLaneGroup + i, count);
        block.weight[row][i] = WeightOf(bake.mesh, patch.vertices[lane], joint);
      }
      block.row_joint[row++] = joint;
    }
  }
  for (size_t g = patch.groups.size(); g <= kVertexGroups; ++g) {
    block.group_first_row[g] = uint16_t(row);
  }
  block.vertex_count = uint16_t(count);
}

// Nearest of the first `control_count` strands whose surface faces the same way, or failing that
// nearest.
uint32_t FindControl(const LayerBake& bake, const ChunkPart& chunk, uint32_t lane,
                     uint32_t control_count) {
  const GroomedStrand& strand = bake.strands[chunk.strands[lane]];
  uint32_t best = 0;
  float least = 0.0f;
  bool facing = false;
  for (uint32_t c = 0; c < control_count; ++c) {
    const GroomedStrand& control = bake.strands[chunk.strands[c]];
    const glm::vec3 apart = control.position - strand.position;
    const float square = glm::dot(apart, apart);
    const bool same_side = glm::dot(control.frame.normal, strand.frame.normal) > 0.0;
    if (c == 0 || (same_side && !facing) || (same_side == facing && square < least)) {
      best = c;
      least = square;
      facing = same_side;
    }
  }
  return best;
}

uint32_t CountControls(const LayerSetup& layer, uint32_t strand_count) {
  const bool clumps =
      layer.params.clump > 0.0f || layer.params.wet_clump > 0.0f || layer.params.dirt_clump > 0.0f;
  if (!clumps || layer.clump_controls == 0) return 0;
  const uint32_t wanted = RoundUpToLaneGroups(layer.clump_controls);
  return std::min(wanted, (strand_count - 1) / kLaneGroup * kLaneGroup);
}

// Where each mesh vertex of a chunk lies in its halo. One array for all chunks: stale entries
// are never read.
class LocalVertices {
 public:
  explicit LocalVertices(size_t mesh_vertex_count) : local_(mesh_vertex_count, 0) {}
  void Load(const ChunkPart& chunk) {
    for (uint32_t i = 0; i < chunk.vertices.size(); ++i) local_[chunk.vertices[i]] = uint8_t(i);
  }
  uint8_t operator[](uint32_t mesh_vertex) const { return local_[mesh_vertex]; }

 private:
  std::vector<uint8_t> local_;
};

// Where each mesh vertex lies in its layer.
std::vector<uint32_t> FindPlaces(const LayerBake& bake, std::span<const VertexPatch> patches) {
  std::vector<uint32_t> place(bake.mesh.position.size(), ~0u);
  for (uint32_t p = 0; p < patches.size(); ++p)
    for (uint32_t i = 0; i < patches[p].vertices.size(); ++i)
      place[patches[p].vertices[i]] = p * kVerticesPerChunk + i;
  return place;
}

void FillHalo(const ChunkPart& chunk, std::span<const uint32_t> place, HaloBlock& block) {
  std::fill(std::begin(block.vertex), std::end(block.vertex), ~0u);
  for (size_t i = 0; i < chunk.vertices.size(); ++i) block.vertex[i] = place[chunk.vertices[i]];
}

void FillStrands(const LayerBake& bake, const ChunkPart& chunk, const LocalVertices& local,
                 uint32_t place, StrandBlock& block) {
  const uint32_t count = uint32_t(chunk.strands.size());
  const uint32_t controls = CountControls(bake.layer, count);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const uint32_t source = SourceLane(lane, count);
    const GroomedStrand& strand = bake.strands[chunk.strands[source]];
    const auto& corners = bake.mesh.triangles[strand.place.triangle];
    for (int i = 0; i < 3; ++i) {
      block.bary[i][lane] = strand.place.bary[i];
      block.vertex[i][lane] = local[corners[size_t(i)]];
    }
    block.length[lane] = strand.length;
    for (size_t i = 0; i < kStrandAttributes.size(); ++i)
      if (const auto stored = kStrandAttributes[i].stored) (block.*stored)[lane] = strand.stored[i];
    block.base_colour[lane] = strand.base_colour;
    block.tip_colour[lane] = strand.tip_colour;
    block.film_strip[lane] = strand.film_strip;
    const bool alone = controls == 0 || source < controls;
    block.control[lane] = uint8_t(alone ? source : FindControl(bake, chunk, source, controls));
  }
  for (const uint32_t v : chunk.vertices)
    for (int i = 0; i < 4; ++i) {
      const uint8_t joint = bake.mesh.joints[v][size_t(i)];
      if (bake.mesh.weights[v][i] > 0.0f) block.joint_mask[joint / 32] |= 1u << joint % 32;
    }
  block.strand_count = count;
  block.vertex_count = uint32_t(chunk.vertices.size());
  block.control_count = controls;
  block.first_strand = place * kStrandsPerChunk;
}

// Repeated beyond 0 to 1; 0 of what interpolation made infinite.
uint32_t PackUnit(float value) {
  const float part = value - std::floor(value);
  return part >= 0.0f && part <= 1.0f ? uint32_t(part * 65535.0f + 0.5f) : 0u;
}

void FillStrandUv(const LayerBake& bake, const ChunkPart& chunk, StrandUvBlock& block) {
  if (bake.mesh.uv.empty()) return;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const uint32_t source = SourceLane(lane, uint32_t(chunk.strands.size()));
    const SurfacePoint& place = bake.strands[chunk.strands[source]].place;
    const glm::vec2 uv = Interpolate(bake.mesh.uv, bake.mesh, place);
    block.uv[lane] = PackUnit(uv.x) | PackUnit(uv.y) << 16;
  }
}

template <uint32_t kPoints>
void SetRestLane(RestBlock<kPoints>& block, uint32_t lane, const RestShape& shape, float length,
                 float strength) {
  for (uint32_t i = 0; i + 1 < kPoints; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      block.offset[i][axis][lane] = float(shape.offset[i][axis]);
    }
  }
  block.segment_length[lane] = length / float(kPoints - 1);
  block.strength[lane] = strength;
}

template <uint32_t kPoints>
void FillStrandRest(const LayerBake& bake, const ChunkPart& chunk, RestBlock<kPoints>& block) {
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const uint32_t source = SourceLane(lane, uint32_t(chunk.strands.size()));
    const GroomedStrand& strand = bake.strands[chunk.strands[source]];
    SetRestLane(block, lane, strand.rest, strand.length, strand.strength);
  }
}

void FillVertexRest(const LayerBake& bake, const VertexPatch& patch, RestBlock<4>& block) {
  for (uint32_t lane = 0; lane < kVerticesPerChunk; ++lane) {
    const uint32_t source = SourceLane(lane, uint32_t(patch.vertices.size()));
    const VertexChain& chain = bake.vertices[patch.vertices[source]];
    SetRestLane(block, lane, chain.rest, chain.length, chain.strength);
  }
}

void SetDown(const glm::dvec3& down, uint32_t lane, DownBlock& block) {
  for (int axis = 0; axis < 3; ++axis) block.down[axis][lane] = float(down[axis]);
}

void FillVertexDown(const LayerBake& bake, const VertexPatch& patch, DownBlock& block) {
  for (uint32_t lane = 0; lane < kVerticesPerChunk; ++lane) {
    const uint32_t source = SourceLane(lane, uint32_t(patch.vertices.size()));
    SetDown(bake.vertices[patch.vertices[source]].down, lane, block);
  }
}

void FillStrandDown(const LayerBake& bake, const ChunkPart& chunk, DownBlock& block) {
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const uint32_t source = SourceLane(lane, uint32_t(chunk.strands.size()));
    SetDown(bake.strands[chunk.strands[source]].frame.ToFrame(kRestDown), lane, block);
  }
}

void SetTraits(const LayerSetup& layer, const StrandTraits& traits, uint32_t lane,
               TraitBlock& block) {
  const std::vector<float>& profile = layer.hardness_profile;
  for (uint32_t i = 0; i < kTraitLinks; ++i)
    block.stiffness[i][lane] = traits.stiffness * (i < profile.size() ? profile[i] : 1.0f);
  block.drag[lane] = (traits.damping - 1.0f) * layer.params.velocity_damping;
  block.clump[lane] = traits.clump;
  block.weight[lane] = traits.weight;
  block.bounce[lane] = traits.bounce;
  const double limit = double(traits.angle_limit) * exact::kRadiansPerDegree;
  block.least_cosine[lane] = traits.angle_limit < 180.0f ? float(exact::Cos(limit)) : -2.0f;
}

void FillVertexTraits(const LayerBake& bake, const VertexPatch& patch, TraitBlock& block) {
  for (uint32_t lane = 0; lane < kVerticesPerChunk; ++lane) {
    const uint32_t source = SourceLane(lane, uint32_t(patch.vertices.size()));
    SetTraits(bake.layer, bake.vertices[patch.vertices[source]].traits, lane, block);
  }
}

void FillStrandTraits(const LayerBake& bake, const ChunkPart& chunk, TraitBlock& block) {
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const uint32_t source = SourceLane(lane, uint32_t(chunk.strands.size()));
    SetTraits(bake.layer, bake.strands[chunk.strands[source]].traits, lane, block);
  }
}

void FillShellSkin(const LayerBake& bake, const VertexPatch& patch, ShellSkinBlock& block) {
  for (uint32_t lane = 0; lane < kVerticesPerChunk; ++lane) {
    const uint32_t v = patch.vertices[SourceLane(lane, uint32_t(patch.vertices.size()))];
    for (int axis = 0; axis < 2; ++axis) block.uv[lane][axis] = bake.mesh.uv[v][axis];
    const ShellColours colours = (*bake.shells)[v];
    block.base_colour[lane] = colours.base;
    block.tip_colour[lane] = colours.tip;
  }
}

// Unused lanes own no edge: a copy would own another's.
void FillFinEdges(const LayerBake& bake, const ChunkPart& chunk, FinEdgeBlock& block) {
  for (size_t lane = 0; lane < chunk.strands.size(); ++lane)
    block.owned[lane] = bake.fin_edges[chunk.strands[lane]];
}

// How far from the skin the layer may be found.
float FindReach(const LayerBake& bake, std::span<const VertexPatch> patches) {
  float reach = 0.0f;
  for (const GroomedStrand& strand : bake.strands) reach = std::max(reach, strand.length);
  if (!bake.shells && !(bake.layer.segment_length > 0.0f)) return reach;
  for (const VertexPatch& patch : patches)
    for (const uint32_t v : patch.vertices) reach = std::max(reach, bake.vertices[v].length);
  // Groom and force of shells, each as long as the fur (kernels/shell_force.hpp), and rounding.
  return bake.shells ? 2.001f * reach : reach;
}

// Bind-space boxes of the vertices that each joint moves.
class JointBoxes {
 public:
  void Add(const LayerBake& bake, uint32_t vertex) {
    const glm::vec3 position = LiftedPosition(bake, vertex);
    for (int i = 0; i < 4; ++i) {
      if (!(bake.mesh.weights[vertex][i] > 0.0f)) continue;
      Box& box = boxes_[bake.mesh.joints[vertex][size_t(i)]];
      box.low = box.used ? glm::min(box.low, position) : position;
      box.high = box.used ? glm::max(box.high, position) : position;
      box.used = true;
    }
  }
  LayerJointBlock Make() const {
    LayerJointBlock block{};
    for (uint32_t joint = 0; joint < kJointsPerCharacter; ++joint) {
      if (!boxes_[joint].used) continue;
      block.joint[block.count] = joint;
      for (int axis = 0; axis < 3; ++axis) {
        block.low[axis][block.count] = boxes_[joint].low[axis];
        block.high[axis][block.count] = boxes_[joint].high[axis];
      }
      ++block.count;
    }
    return block;
  }

 private:
  struct Box {
    glm::vec3 low{0.0f}, high{0.0f};
    bool used = false;
  };
  Box boxes_[kJointsPerCharacter];
};

void AppendPatch(const LayerBake& bake, const VertexPatch& patch, Groom& groom) {
  FillMesh(bake, patch, groom.mesh.emplace_back());
  if (bake.layer.params.chain == ChainKind::kVertex) {
    FillVertexRest(bake, patch, groom.vertex_rest.emplace_back());
    if (bake.layer.params.sag_free) FillVertexDown(bake, patch, groom.vertex_down.emplace_back());
    if (HasTraits(bake.layer)) FillVertexTraits(bake, patch, groom.vertex_traits.emplace_back());
  }
  if (bake.shells) FillShellSkin(bake, patch, groom.shell_skin.emplace_back());
}

void AppendChunk(const LayerBake& bake, const ChunkPart& chunk, const LocalVertices& local,
                 std::span<const uint32_t> places, uint32_t number, Groom& groom) {
  const LayerParams& params = bake.layer.params;
  FillStrands(bake, chunk, local, number, groom.strands.emplace_back());
  FillHalo(chunk, places, groom.halo.emplace_back());
  FillStrandUv(bake, chunk, groom.strand_uv.emplace_back());
  if (params.fins) FillFinEdges(bake, chunk, groom.fin_edges.emplace_back());
  if (bake.shells) return;
  WithPoints(params.points, [&]<uint32_t kPoints> {
    FillStrandRest(bake, chunk, StrandRestOf<kPoints>(groom).emplace_back());
  });
  if (params.sag_free && params.chain != ChainKind::kVertex)
    FillStrandDown(bake, chunk, groom.strand_down.emplace_back());
  if (HasTraits(bake.layer)) FillStrandTraits(bake, chunk, groom.strand_traits.emplace_back());
}

}  // namespace

void AppendLayer(const LayerBake& bake, std::span<const ChunkPart> chunks,
                 std::span<const VertexPatch> patches, Groom& groom) {
  GroomLayer layer;
  layer.name = bake.layer.name;
  layer.params = bake.layer.params;
  layer.params.traits = HasTraits(bake.layer);
  layer.first_patch = uint32_t(groom.mesh.size());
  layer.patch_count = uint32_t(patches.size());
  layer.first_chunk = uint32_t(groom.strands.size());
  layer.chunk_count = uint32_t(chunks.size());
  layer.strand_count = uint32_t(bake.strands.size());
  layer.length_max = FindReach(bake, patches);
  if (bake.layer.strand_texture)
    layer.strand_texture = std::make_shared<const StrandTexture>(StrandTextureOf(bake.layer));
  JointBoxes boxes;
  groom.mesh.reserve(groom.mesh.size() + patches.size());
  for (const VertexPatch& patch : patches) {
    AppendPatch(bake, patch, groom);
    for (const uint32_t v : patch.vertices) boxes.Add(bake, v);
  }
  const std::vector<uint32_t> places = FindPlaces(bake, patches);
  LocalVertices local(bake.mesh.position.size());
  groom.strands.reserve(groom.strands.size() + chunks.size());
  groom.strand_uv.reserve(groom.strand_uv.size() + chunks.size());
  for (uint32_t number = 0; number < chunks.size(); ++number) {
    local.Load(chunks[number]);
    AppendChunk(bake, chunks[number], local, places, number, groom);
  }
  groom.layer_joints.push_back(boxes.Make());
  groom.layers.push_back(std::move(layer));
}

}  // namespace pelt
