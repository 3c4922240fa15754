// The groom: the baked fur of one character. Blocks lie as the frame uses them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/chunk.hpp"
#include "core/groom/strand_texture.hpp"
#include "core/layer.hpp"

namespace pelt {

struct GroomLayer {
  std::string name;
  LayerParams params;
  uint32_t first_patch = 0;
  uint32_t patch_count = 0;
  uint32_t first_chunk = 0;
  uint32_t chunk_count = 0;
  uint32_t strand_count = 0;
  float length_max = 0.0f;                              // m
  std::shared_ptr<const StrandTexture> strand_texture;  // null: none
};

// Patches and chunks of a layer are contiguous; layers are in setup order. Patch p of the groom has
// mesh[p], of a vertex-chain layer vertex_rest, which has vertex_down where it is sag-free, and of shells
// shell_skin. Chunk c has strands[c], halo[c], strand_uv[c]; but for shells strand_rest4, of layers of 5
// and 9 points strand_rest5 and strand_rest9; with fins fin_edges; of a sag-free layer with a chain per
// strand strand_down; where strands have traits strand_traits, and the patches of vertex chains vertex_traits.
// Those arrays hold the patches or chunks that need them, in order.
struct Groom {
  float unit_scale = 1.0f;
  uint32_t joint_count = 0;
  SkeletonBlock skeleton{};
  std::vector<std::string> joint_names;
  std::vector<GroomLayer> layers;
  std::vector<LayerJointBlock> layer_joints;
  std::vector<MeshBlock> mesh;
  std::vector<StrandBlock> strands;
  std::vector<HaloBlock> halo;
  std::vector<StrandUvBlock> strand_uv;
  std::vector<RestBlock<4>> vertex_rest;
  std::vector<RestBlock<4>> strand_rest4;
  std::vector<RestBlock<5>> strand_rest5;
  std::vector<ShellSkinBlock> shell_skin;
  std::vector<FinEdgeBlock> fin_edges;
  std::vector<DownBlock> vertex_down;
  std::vector<DownBlock> strand_down;
  std::vector<RestBlock<9>> strand_rest9;
  std::vector<TraitBlock> vertex_traits;
  std::vector<TraitBlock> strand_traits;
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
