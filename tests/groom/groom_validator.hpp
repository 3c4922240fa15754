// What chunk.hpp promises of baked patches and chunks, checked one by one. Stricter than
// FindGroomFault, which asks only what kernels need to be safe.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/block_rows.hpp"
#include "core/character/character.hpp"
#include "core/groom/groom.hpp"

namespace pelt::test {

// Of all members that have a place for each of kLanes lanes.
template <size_t kLanes, class B>
void ExpectAllPadded(const B& block, uint32_t used) {
  ForEachMember<B>([&]<class M>(const BlockMember<B, M>& row) {
    constexpr size_t kRank = std::rank_v<M>;
    if constexpr (kRank > 0 && std::extent_v < M, kRank ? kRank - 1 : 0 > == kLanes) {
      SCOPED_TRACE(row.name);
      const auto* first =
          reinterpret_cast<const std::remove_all_extents_t<M>*>(&(block.*row.member));
      for (size_t at = 0; at < sizeof(M) / sizeof *first; ++at)
        if (at % kLanes >= used) {
          ASSERT_EQ(first[at], first[at / kLanes * kLanes + used - 1]);
        }
    }
  });
}

template <uint32_t kPoints>
void ExpectRest(const RestBlock<kPoints>& rest, uint32_t used) {
  for (uint32_t lane = 0; lane < used; ++lane) {
    ASSERT_GE(rest.strength[lane], 0.0f);
    ASSERT_LE(rest.strength[lane], 1.0f);
    double last[3] = {};
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      double square = 0.0;
      for (int axis = 0; axis < 3; ++axis) {
        const double step = rest.offset[i][axis][lane] - last[axis];
        square += step * step;
        last[axis] = rest.offset[i][axis][lane];
      }
      ASSERT_NEAR(std::sqrt(square), rest.segment_length[lane],
                  1e-5 * rest.segment_length[lane] + 1e-9);
    }
  }
  ExpectAllPadded<kStrandsPerChunk>(rest, used);
}

inline void ExpectMesh(const MeshBlock& mesh) {
  ASSERT_GT(mesh.vertex_count, 0u);
  ASSERT_LE(mesh.vertex_count, kVerticesPerChunk);
  ExpectAllPadded<kVerticesPerChunk>(mesh, mesh.vertex_count);
  const uint32_t groups = RoundUpToLaneGroups(mesh.vertex_count) / kLaneGroup;
  ASSERT_EQ(mesh.group_first_row[0], 0u);
  for (uint32_t g = 0; g < kVertexGroups; ++g) {
    const uint32_t first = mesh.group_first_row[g], last = mesh.group_first_row[g + 1];
    ASSERT_LE(first, last);
    ASSERT_LE(last, kInfluenceRows);
    if (g >= groups) {
      ASSERT_EQ(first, last);
    }
    for (uint32_t r = first; r < last; ++r) {
      if (r > first) {
        ASSERT_LT(mesh.row_joint[r - 1], mesh.row_joint[r]);
      }
      float most = 0.0f;  // no row without a use
      for (const float w : mesh.weight[r]) {
        ASSERT_GE(w, 0.0f);
        most = std::max(most, w);
      }
      ASSERT_GT(most, 0.0f);
    }
    for (uint32_t i = 0; i < kLaneGroup && g < groups; ++i) {
      const uint32_t lane = g * kLaneGroup + i;
      double sum = 0.0, nn = 0.0, tt = 0.0, nt = 0.0;
      for (uint32_t r = first; r < last; ++r) sum += mesh.weight[r][i];
      ASSERT_NEAR(sum, 1.0, 1e-5);
      for (int axis = 0; axis < 3; ++axis) {
        nn += double(mesh.normal[axis][lane]) * mesh.normal[axis][lane];
        tt += double(mesh.tangent[axis][lane]) * mesh.tangent[axis][lane];
        nt += double(mesh.normal[axis][lane]) * mesh.tangent[axis][lane];
      }
      ASSERT_NEAR(nn, 1.0, 1e-5);
      ASSERT_NEAR(tt, 1.0, 1e-5);
      ASSERT_NEAR(nt, 0.0, 1e-5);
    }
  }
  const uint32_t rows = mesh.group_first_row[kVertexGroups];
  for (uint32_t g = groups, last = mesh.vertex_count - 1u, i = last % kLaneGroup + 1;
       i < kLaneGroup; ++i) {
    for (uint32_t r = mesh.group_first_row[g - 1]; r < mesh.group_first_row[g]; ++r) {
      ASSERT_EQ(mesh.weight[r][i], mesh.weight[r][last % kLaneGroup]);
    }
  }
  for (uint32_t r = rows; r < kInfluenceRows; ++r) {
    for (const float w : mesh.weight[r]) ASSERT_EQ(w, 0.0f);
  }
}

inline void ExpectDown(const DownBlock& block, uint32_t used) {
  for (uint32_t lane = 0; lane < used; ++lane) {
    double square = 0.0;
    for (const auto& row : block.down) square += double(row[lane]) * double(row[lane]);
    ASSERT_NEAR(square, 1.0, 1e-5);
  }
  ExpectAllPadded<kStrandsPerChunk>(block, used);
}

// A vertex's weights as they are summed: joints in ascending order.
inline std::vector<std::pair<uint32_t, float>> WeightsOf(const MeshBlock& mesh, uint32_t lane) {
  std::vector<std::pair<uint32_t, float>> weights;
  const uint32_t g = lane / kLaneGroup;
  for (uint32_t r = mesh.group_first_row[g]; r < mesh.group_first_row[g + 1]; ++r) {
    const float w = mesh.weight[r][lane % kLaneGroup];
    if (w > 0.0f) weights.push_back({mesh.row_joint[r], w});
  }
  return weights;
}

// Where the vertex lies that is number `corner` of a chunk's halo.
struct PatchLane {
  uint32_t patch;  // of the groom
  uint32_t lane;
};
inline PatchLane FindCorner(const Groom& groom, const GroomLayer& layer, size_t chunk,
                            uint32_t corner) {
  const uint32_t place = groom.halo[chunk].vertex[corner];
  return {layer.first_patch + place / kVerticesPerChunk, place % kVerticesPerChunk};
}

inline void ExpectHalo(const Groom& groom, const GroomLayer& layer, size_t chunk) {
  const HaloBlock& halo = groom.halo.at(chunk);
  const StrandBlock& strands = groom.strands.at(chunk);
  ASSERT_GT(strands.vertex_count, 0u);
  ASSERT_LE(strands.vertex_count, kVerticesPerChunk);
  std::set<uint32_t> distinct;
  uint32_t joints[kJointsPerCharacter / 32] = {};
  for (uint32_t i = 0; i < kVerticesPerChunk; ++i) {
    if (i >= strands.vertex_count) {
      ASSERT_EQ(halo.vertex[i], ~0u);
      continue;
    }
    ASSERT_TRUE(distinct.insert(halo.vertex[i]).second);
    const auto [patch, lane] = FindCorner(groom, layer, chunk, i);
    ASSERT_LT(patch - layer.first_patch, layer.patch_count);
    ASSERT_LT(lane, groom.mesh.at(patch).vertex_count);
    for (const auto& [joint, weight] : WeightsOf(groom.mesh[patch], lane))
      joints[joint / 32] |= 1u << joint % 32;
  }
  for (uint32_t w = 0; w < kJointsPerCharacter / 32; ++w) {
    ASSERT_EQ(strands.joint_mask[w], joints[w]);
  }
  uint32_t used = 0;  // in the order of the first use
  for (uint32_t i = 0; i < strands.strand_count; ++i)
    for (const auto& corner : strands.vertex) {
      ASSERT_LE(corner[i], used);
      used += corner[i] == used;
    }
  ASSERT_EQ(used, strands.vertex_count);  // no vertex without a strand
}

inline void ExpectStrands(const StrandBlock& strands) {
  const uint32_t n = strands.strand_count;
  ASSERT_GT(n, 0u);
  ASSERT_LE(n, kStrandsPerChunk);
  for (uint32_t i = 0; i < n; ++i) {
    ASSERT_NEAR(strands.bary[0][i] + strands.bary[1][i] + strands.bary[2][i], 1.0f, 1e-6f);
    ASSERT_GT(strands.length[i], 0.0f);
    for (int k = 0; k < 3; ++k) {
      ASSERT_GE(strands.bary[k][i], 0.0f);
      ASSERT_LT(strands.vertex[k][i], strands.vertex_count);
    }
  }
  ASSERT_EQ(strands.control_count % kLaneGroup, 0u);
  ASSERT_LT(strands.control_count, n);
  for (uint32_t i = 0; i < n; ++i) {
    if (strands.control_count == 0 || i < strands.control_count) {
      ASSERT_EQ(strands.control[i], i);
    } else {
      ASSERT_LT(strands.control[i], strands.control_count);
    }
  }
  ExpectAllPadded<kStrandsPerChunk>(strands, n);
}

// Of each place of the layer's patches: how many chunks use the vertex there.
inline std::vector<uint32_t> CountUses(const Groom& groom, const GroomLayer& layer) {
  std::vector<uint32_t> uses(size_t(layer.patch_count) * kVerticesPerChunk, 0);
  for (uint32_t c = layer.first_chunk; c < layer.first_chunk + layer.chunk_count; ++c)
    for (uint32_t i = 0; i < groom.strands[c].vertex_count; ++i) ++uses.at(groom.halo[c].vertex[i]);
  return uses;
}

// Vertices that more than one chunk uses.
inline uint32_t CountShared(const Groom& groom, const GroomLayer& layer) {
  const std::vector<uint32_t> uses = CountUses(groom, layer);
  return uint32_t(std::ranges::count_if(uses, [](uint32_t chunks) { return chunks > 1; }));
}

inline void ExpectEveryVertexUsed(const Groom& groom, const GroomLayer& layer) {
  const std::vector<uint32_t> uses = CountUses(groom, layer);
  for (uint32_t p = 0; p < layer.patch_count; ++p)
    for (uint32_t v = 0; v < kVerticesPerChunk; ++v)
      ASSERT_EQ(uses[p * kVerticesPerChunk + v] > 0,
                v < groom.mesh[layer.first_patch + p].vertex_count);
}

// No vertex of the mesh lies in two patches: nowhere has the layer more vertices than the mesh has.
// Of layers that do not raise the skin. Returns how many there are.
inline size_t ExpectEachVertexOnce(const Groom& groom, const GroomLayer& layer, const Mesh& mesh) {
  using Place = std::array<uint32_t, 3>;
  const auto place_of = [](float x, float y, float z) {
    return Place{std::bit_cast<uint32_t>(x), std::bit_cast<uint32_t>(y),
                 std::bit_cast<uint32_t>(z)};
  };
  std::map<Place, uint32_t> left;
  for (const glm::vec3& p : mesh.position) ++left[place_of(p.x, p.y, p.z)];
  size_t count = 0;
  for (uint32_t p = layer.first_patch; p < layer.first_patch + layer.patch_count; ++p) {
    const auto& [x, y, z] = groom.mesh[p].position;
    for (uint32_t v = 0; v < groom.mesh[p].vertex_count; ++v, ++count) {
      uint32_t& here = left[place_of(x[v], y[v], z[v])];
      EXPECT_GT(here, 0u) << "patch " << p << ", vertex " << v;
      if (here > 0) --here;
    }
  }
  return count;
}

// Vertices at one place with one frame, the two sides of a seam, agree in weights and rest chain.
// Returns at how many places there is more than one.
inline uint32_t ExpectSeamsAgree(const Groom& groom, const GroomLayer& layer,
                                 size_t first_vertex_rest) {
  struct Seen {
    std::vector<std::pair<uint32_t, float>> weights;
    std::vector<uint32_t> rest;
    uint32_t times = 0;
  };
  std::map<std::array<uint32_t, 9>, Seen> seen;
  uint32_t shared = 0;
  for (uint32_t p = 0; p < layer.patch_count; ++p) {
    const MeshBlock& mesh = groom.mesh.at(layer.first_patch + p);
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
      std::array<uint32_t, 9> key;
      for (size_t axis = 0; axis < 3; ++axis) {
        key[axis] = std::bit_cast<uint32_t>(mesh.position[axis][v]);
        key[3 + axis] = std::bit_cast<uint32_t>(mesh.normal[axis][v]);
        key[6 + axis] = std::bit_cast<uint32_t>(mesh.tangent[axis][v]);
      }
      std::vector<uint32_t> rest;
      if (layer.params.chain == ChainKind::kVertex) {
        const RestBlock<4>& block = groom.vertex_rest.at(first_vertex_rest + p);
        for (int i = 0; i < 9; ++i) {
          rest.push_back(std::bit_cast<uint32_t>(block.offset[i / 3][i % 3][v]));
        }
        rest.push_back(std::bit_cast<uint32_t>(block.segment_length[v]));
        rest.push_back(std::bit_cast<uint32_t>(block.strength[v]));
      }
      Seen& entry = seen[key];
      if (entry.times++ == 0) {
        entry.weights = WeightsOf(mesh, v);
        entry.rest = rest;
        continue;
      }
      shared += entry.times == 2;
      EXPECT_EQ(entry.weights, WeightsOf(mesh, v));
      EXPECT_EQ(entry.rest, rest);
    }
  }
  return shared;
}

inline void ExpectLayerJoints(const Groom& groom, const GroomLayer& layer,
                              const LayerJointBlock& block) {
  std::array<bool, kJointsPerCharacter> used{};
  std::array<std::array<float, 3>, kJointsPerCharacter> low, high;
  for (uint32_t p = layer.first_patch; p < layer.first_patch + layer.patch_count; ++p) {
    const MeshBlock& mesh = groom.mesh.at(p);
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
      for (const auto& [joint, weight] : WeightsOf(mesh, v)) {
        for (size_t axis = 0; axis < 3; ++axis) {
          const float x = mesh.position[axis][v];
          low[joint][axis] = used[joint] ? std::min(low[joint][axis], x) : x;
          high[joint][axis] = used[joint] ? std::max(high[joint][axis], x) : x;
        }
        used[joint] = true;
      }
    }
  }
  ASSERT_EQ(block.count, uint32_t(std::count(used.begin(), used.end(), true)));
  for (uint32_t i = 0; i < block.count; ++i) {
    const uint32_t joint = block.joint[i];
    ASSERT_TRUE(used[joint]);
    if (i > 0) {
      ASSERT_LT(block.joint[i - 1], joint);
    }
    for (size_t axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(block.low[axis][i], low[joint][axis]);
      ASSERT_EQ(block.high[axis][i], high[joint][axis]);
    }
  }
}

// Everything above, of all layers.
inline void ExpectValidGroom(const Groom& groom) {
  size_t patch = 0, vertex_rest = 0, vertex_down = 0, vertex_traits = 0, shell_skin = 0;
  size_t chunk = 0, rest4 = 0, rest5 = 0, rest9 = 0, fin_edges = 0, strand_down = 0,
         strand_traits = 0;
  ASSERT_EQ(groom.layer_joints.size(), groom.layers.size());
  for (size_t l = 0; l < groom.layers.size(); ++l) {
    const GroomLayer& layer = groom.layers[l];
    const bool on_vertices = layer.params.chain == ChainKind::kVertex;
    SCOPED_TRACE(layer.name);
    ASSERT_EQ(layer.first_patch, patch);
    ASSERT_EQ(layer.first_chunk, chunk);
    ASSERT_GT(layer.patch_count, 0u);
    ASSERT_LE(patch + layer.patch_count, groom.mesh.size());
    ExpectSeamsAgree(groom, layer, vertex_rest);
    ExpectLayerJoints(groom, layer, groom.layer_joints[l]);
    for (uint32_t p = 0; p < layer.patch_count; ++p, ++patch) {
      SCOPED_TRACE("patch " + std::to_string(p));
      const MeshBlock& mesh = groom.mesh[patch];
      ExpectMesh(mesh);
      if (on_vertices) ExpectRest(groom.vertex_rest.at(vertex_rest++), mesh.vertex_count);
      if (on_vertices && layer.params.sag_free)
        ExpectDown(groom.vertex_down.at(vertex_down++), mesh.vertex_count);
      if (on_vertices && layer.params.traits)
        ExpectAllPadded<kVerticesPerChunk>(groom.vertex_traits.at(vertex_traits++),
                                           mesh.vertex_count);
      if (layer.params.output == Output::kShells)
        ExpectAllPadded<kVerticesPerChunk>(groom.shell_skin.at(shell_skin++), mesh.vertex_count);
    }
    uint32_t strands = 0;
    float longest = 0.0f;
    for (uint32_t c = 0; c < layer.chunk_count; ++c, ++chunk) {
      SCOPED_TRACE("chunk " + std::to_string(c));
      const StrandBlock& block = groom.strands.at(chunk);
      ASSERT_EQ(block.first_strand, c * kStrandsPerChunk);
      ExpectStrands(block);
      ExpectHalo(groom, layer, chunk);
      if (layer.params.output == Output::kShells) {
        fin_edges += layer.params.fins;
      } else if (layer.params.points == 5) {
        ExpectRest(groom.strand_rest5.at(rest5++), block.strand_count);
      } else if (layer.params.points == 9) {
        ExpectRest(groom.strand_rest9.at(rest9++), block.strand_count);
      } else {
        ExpectRest(groom.strand_rest4.at(rest4++), block.strand_count);
      }
      if (!on_vertices && layer.params.sag_free)
        ExpectDown(groom.strand_down.at(strand_down++), block.strand_count);
      if (layer.params.traits)
        ExpectAllPadded<kStrandsPerChunk>(groom.strand_traits.at(strand_traits++),
                                          block.strand_count);
      strands += block.strand_count;
      for (uint32_t i = 0; i < block.strand_count; ++i)
        longest = std::max(longest, block.length[i]);
    }
    ExpectEveryVertexUsed(groom, layer);
    ASSERT_EQ(layer.strand_count, strands);
    if (layer.params.output == Output::kShells) {
      ASSERT_GE(layer.length_max, 2.0f * longest);  // bent as far again
    } else {
      ASSERT_EQ(layer.length_max, longest);
    }
  }
  ASSERT_EQ(groom.mesh.size(), patch);
  ASSERT_EQ(groom.strands.size(), chunk);
  ASSERT_EQ(groom.halo.size(), chunk);
  ASSERT_EQ(groom.strand_uv.size(), chunk);
  ASSERT_EQ(groom.vertex_rest.size(), vertex_rest);
  ASSERT_EQ(groom.vertex_down.size(), vertex_down);
  ASSERT_EQ(groom.strand_rest4.size(), rest4);
  ASSERT_EQ(groom.strand_rest5.size(), rest5);
  ASSERT_EQ(groom.strand_rest9.size(), rest9);
  ASSERT_EQ(groom.shell_skin.size(), shell_skin);
  ASSERT_EQ(groom.fin_edges.size(), fin_edges);
  ASSERT_EQ(groom.strand_down.size(), strand_down);
  ASSERT_EQ(groom.vertex_traits.size(), vertex_traits);
  ASSERT_EQ(groom.strand_traits.size(), strand_traits);
}

}  // namespace pelt::test
