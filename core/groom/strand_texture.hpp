// The artist's texture of a layer's strands: a film strip of silhouettes, of which each strand shows one. No kernel
// reads it; it goes from the setup's `strand_texture` by way of the groom to LayerDraw::strand_texture.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/groom/layer_params.hpp"

namespace pelt {

// What its channels are, each linear, of 255.
enum class StrandChannels : uint8_t {
  kLook,  // r extra tint, g extra highlights, b shadow, a coverage; 0, 0, 0 is as without the texture
  kWeather,  // coverage, of a dry and clean strand in r, a wet one in g, a dirty one in b
};

struct StrandTexture {
  uint32_t width = 0, height = 0;  // texels; rows from root to tip
  uint32_t strips =
      1;  // silhouettes, equally wide, side by side; StrandBlock::film_strip is one of them
  StrandChannels channels = StrandChannels::kLook;
  std::vector<uint8_t> rgba;
  bool operator==(const StrandTexture&) const = default;
};

inline constexpr uint64_t kStrandTextureBytes = 16u << 20;  // at most

// The reason why a layer of these parameters cannot have it, or empty.
std::string FindBadStrandTexture(const StrandTexture& texture, const LayerParams& params);
// FindBadParam, and that of the layer's texture, if it has one. For the groom file.
std::string FindBadParam(const LayerParams& params, const StrandTexture* texture);

}  // namespace pelt
