// The groom: the baked fur of one character. Blocks lie as the frame uses them.
#pragma once

#include <string>
#include <vector>

#include "core/chunk.hpp"
#include "core/groom/layer_params.hpp"

namespace pelt {

struct GroomLayer {
  std::string name;
  LayerParams params;
  uint32_t first_chunk = 0;
  uint32_t chunk_count = 0;
  uint32_t strand_count = 0;
  float length_max = 0.0f;  // m
};

// Chunks of a layer are contiguous; layers are in setup order. Chunk c of the groom has mesh[c],
// strands[c], strand_uv[c]; a chunk of a vertex-chain layer has vertex_rest and strand_rest4, of a
// 4-point strand-chain layer strand_rest4, of a 5-point one strand_rest5, of a 9-point one
// strand_rest9; a chunk of shells has vertex_rest and shell_skin alone, and with fins fin_edges; a
// chunk of a sag-free layer has rest_down. Those arrays hold the chunks that need them, in chunk
// order.
struct Groom {
  float unit_scale = 1.0f;
  uint32_t joint_count = 0;
  SkeletonBlock skeleton{};
  std::vector<std::string> joint_names;
  std::vector<GroomLayer> layers;
  std::vector<LayerJointBlock> layer_joints;
  std::vector<MeshBlock> mesh;
  std::vector<StrandBlock> strands;
  std::vector<StrandUvBlock> strand_uv;
  std::vector<RestBlock<4>> vertex_rest;
  std::vector<RestBlock<4>> strand_rest4;
  std::vector<RestBlock<5>> strand_rest5;
  std::vector<ShellSkinBlock> shell_skin;
  std::vector<FinEdgeBlock> fin_edges;
  std::vector<DownBlock> rest_down;
  std::vector<RestBlock<9>> strand_rest9;
};

// The rest shapes of strands of so many points.
template <uint32_t kPoints, class AnyGroom>
auto& StrandRestOf(AnyGroom& groom) {
  if constexpr (kPoints == 9)
    return groom.strand_rest9;
  else if constexpr (kPoints == 5)
    return groom.strand_rest5;
  else
    return groom.strand_rest4;
}

}  // namespace pelt
