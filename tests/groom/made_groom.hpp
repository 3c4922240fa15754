// A groom of every kind of chain, filled with seeded numbers that a frame can take.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <numeric>
#include <random>
#include <string>

#include "core/groom/groom.hpp"

namespace pelt::test {

inline float DrawFloat(std::mt19937& random, float low, float high) {
  return low + (high - low) * float(random() % 65536) / 65536.0f;
}

inline void FillMesh(MeshBlock& mesh, uint32_t vertices, uint32_t joints, std::mt19937& random) {
  mesh.vertex_count = uint16_t(vertices);
  for (uint32_t v = 0; v < kVerticesPerChunk; ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      mesh.position[axis][v] =
          v < vertices ? DrawFloat(random, -1.0f, 1.0f) : mesh.position[axis][vertices - 1];
      mesh.normal[axis][v] = axis == 2 ? 1.0f : 0.0f;
      mesh.tangent[axis][v] = axis == 0 ? 1.0f : 0.0f;
    }
  }
  uint32_t row = 0;
  for (uint32_t g = 0; g < kVertexGroups; ++g) {
    mesh.group_first_row[g] = uint16_t(row);
    if (g * kLaneGroup < vertices) {
      const uint8_t first = uint8_t(random() % (joints - 1));
      for (uint32_t lane = 0; lane < kLaneGroup; ++lane) {
        const float share = DrawFloat(random, 0.0f, 1.0f);
        mesh.weight[row][lane] = share;
        mesh.weight[row + 1][lane] = 1.0f - share;
      }
      mesh.row_joint[row] = first;
      mesh.row_joint[row + 1] = uint8_t(first + 1);
      row += 2;
    }
  }
  mesh.group_first_row[kVertexGroups] = uint16_t(row);
}

// The first chunk of a layer uses the vertices of its first patch; the second those of the last
// patch backwards, and some of the first one.
inline void FillHalo(HaloBlock& halo, uint32_t chunk, uint32_t patches) {
  std::fill(std::begin(halo.vertex), std::end(halo.vertex), ~0u);
  if (chunk == 0) {
    std::iota(halo.vertex, halo.vertex + 40, 0u);
  } else {
    for (uint32_t i = 0; i < 16; ++i) halo.vertex[i] = (patches - 1) * kVerticesPerChunk + 15 - i;
    for (uint32_t i = 16; i < 24; ++i) halo.vertex[i] = i;
  }
}

// `patches`: of the layer.
inline void FillStrands(StrandBlock& block, uint32_t strands, uint32_t vertices, uint32_t place,
                        const HaloBlock& halo, const MeshBlock* patches, std::mt19937& random) {
  block.strand_count = strands;
  block.vertex_count = vertices;
  block.control_count = strands >= kLaneGroup ? kLaneGroup : 0;
  block.first_strand = place * kStrandsPerChunk;
  for (uint32_t i = 0; i < kStrandsPerChunk; ++i) {
    const float u = DrawFloat(random, 0.0f, 0.5f), v = DrawFloat(random, 0.0f, 0.5f);
    block.bary[0][i] = u;
    block.bary[1][i] = v;
    block.bary[2][i] = 1.0f - u - v;
    block.length[i] = DrawFloat(random, 0.01f, 0.05f);
    block.width[i] = 0.001f;
    block.base_colour[i] = uint32_t(random());
    block.tip_colour[i] = uint32_t(random());
    for (int corner = 0; corner < 3; ++corner)
      block.vertex[corner][i] = uint8_t(random() % vertices);
    block.control[i] = uint8_t(block.control_count ? random() % block.control_count : 0);
    block.film_strip[i] = uint8_t(random());
  }
  for (uint32_t i = 0; i < vertices; ++i) {
    const MeshBlock& mesh = patches[halo.vertex[i] / kVerticesPerChunk];
    const uint32_t group = halo.vertex[i] % kVerticesPerChunk / kLaneGroup;
    for (uint32_t row = mesh.group_first_row[group]; row < mesh.group_first_row[group + 1]; ++row)
      block.joint_mask[mesh.row_joint[row] / 32] |= 1u << mesh.row_joint[row] % 32;
  }
}

inline void FillDown(DownBlock& block) {
  for (uint32_t i = 0; i < kStrandsPerChunk; ++i) block.down[i % 3][i] = i % 2 ? 1.0f : -1.0f;
}

inline void FillTraits(TraitBlock& block, std::mt19937& random) {
  for (auto& row : block.stiffness)
    for (float& value : row) value = DrawFloat(random, 0.0f, 2.0f);
  for (auto* row : {&block.drag, &block.clump, &block.weight, &block.bounce, &block.least_cosine})
    for (float& value : *row) value = DrawFloat(random, 0.0f, 1.0f);
}

template <class T>
void FillRest(T& rest, std::mt19937& random) {
  for (auto& point : rest.offset) {
    for (auto& axis : point) {
      for (float& value : axis) value = DrawFloat(random, -0.05f, 0.05f);
    }
  }
  for (float& value : rest.segment_length) value = DrawFloat(random, 0.001f, 0.02f);
  for (float& value : rest.strength) value = DrawFloat(random, 0.0f, 1.0f);
}

// Four layers: chains at vertices (2 patches, 2 chunks), chains of 4 points (1, 1), of 5 (1, 2) and
// of 9 (2, 2).
inline Groom MakeGroom() {
  std::mt19937 random(20);
  Groom groom;
  groom.unit_scale = 0.01f;
  groom.joint_count = 7;
  for (uint32_t j = 0; j < groom.joint_count; ++j) {
    groom.skeleton.parent[j] = int32_t(j) - 1;
    groom.joint_names.push_back("joint " + std::to_string(j));
    for (float& value : groom.skeleton.inverse_bind[j]) value = DrawFloat(random, -1.0f, 1.0f);
  }
  const uint32_t patches[] = {2, 1, 1, 2}, chunks[] = {2, 1, 2, 2};
  for (uint32_t l = 0; l < 4; ++l) {
    GroomLayer layer;
    layer.name = "layer " + std::to_string(l);
    layer.params.chain = l == 0 ? ChainKind::kVertex : ChainKind::kStrand;
    layer.params.points = l == 3 ? 9 : l == 2 ? 5 : 4;
    layer.params.solver = l == 2 ? Solver::kVerlet : l == 1 ? Solver::kPbd : Solver::kModal;
    layer.params.sag_free = l == 0 || l == 3;
    layer.params.traits = l == 1 || l == 2;
    layer.params.output = l == 0 ? Output::kInstances : Output::kRibbons;
    layer.params.sort_bias = float(l) - 1.0f;
    layer.first_patch = uint32_t(groom.mesh.size());
    layer.patch_count = patches[l];
    layer.first_chunk = uint32_t(groom.strands.size());
    layer.chunk_count = chunks[l];
    layer.length_max = 0.05f;
    LayerJointBlock joints{};
    joints.count = groom.joint_count;
    for (uint32_t j = 0; j < joints.count; ++j) {
      joints.joint[j] = j;
      for (int axis = 0; axis < 3; ++axis) {
        joints.low[axis][j] = -1.0f;
        joints.high[axis][j] = 1.0f;
      }
    }
    groom.layer_joints.push_back(joints);
    for (uint32_t p = 0; p < patches[l]; ++p) {
      FillMesh(groom.mesh.emplace_back(), p == 0 ? 40 : 16, groom.joint_count, random);
      if (l == 0) FillRest(groom.vertex_rest.emplace_back(), random);
      if (l == 0) FillDown(groom.vertex_down.emplace_back());
    }
    for (uint32_t c = 0; c < chunks[l]; ++c) {
      const uint32_t strands = c == 0 ? kStrandsPerChunk : 21;
      FillHalo(groom.halo.emplace_back(), c, patches[l]);
      FillStrands(groom.strands.emplace_back(), strands, c == 0 ? 40 : 24, c, groom.halo.back(),
                  &groom.mesh[layer.first_patch], random);
      for (uint32_t& uv : groom.strand_uv.emplace_back().uv) uv = uint32_t(random());
      if (l == 3) FillDown(groom.strand_down.emplace_back());
      if (layer.params.traits) FillTraits(groom.strand_traits.emplace_back(), random);
      if (l == 3) {
        FillRest(groom.strand_rest9.emplace_back(), random);
      } else if (l == 2) {
        FillRest(groom.strand_rest5.emplace_back(), random);
      } else {
        FillRest(groom.strand_rest4.emplace_back(), random);
      }
      layer.strand_count += strands;
    }
    groom.layers.push_back(layer);
  }
  StrandTexture texture{.width = 6, .height = 3, .strips = 2, .rgba = {}};
  for (uint8_t i = 0; i < 72; ++i) texture.rgba.push_back(uint8_t(3 * i));
  groom.layers[1].strand_texture = std::make_shared<const StrandTexture>(texture);
  return groom;
}

}  // namespace pelt::test
