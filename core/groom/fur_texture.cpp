#include "core/groom/fur_texture.hpp"

#include <algorithm>

#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/random.hpp"

namespace pelt {

std::vector<uint8_t> MakeFurTexture(const LayerParams& params) {
  const FloatEnvironment guard;
  constexpr uint64_t kFurSeed = 0x667572;  // "fur"
  const uint32_t side = params.fur_texture_size;
  std::vector<uint8_t> texels(size_t(side) * side, 0);
  // What stands on a texel is above the skin.
  const uint32_t least = std::max(1u, uint32_t(255.0f * params.fur_min_length + 0.5f));
  const uint64_t hairs = uint64_t(double(params.fur_density) * double(texels.size()) + 0.5);
  Random random(MixSeed(params.fur_seed, kFurSeed));
  for (uint64_t i = 0; i < hairs; ++i) {
    uint8_t& texel = texels[random.Below(uint32_t(texels.size()))];
    texel = uint8_t(least + random.Below(256 - least));
  }
  return texels;
}

}  // namespace pelt
