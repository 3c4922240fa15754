#include "core/groom/layer_params.hpp"

#include <algorithm>

#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/strand_texture.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

template <class T>
bool IsInside(const T& value, double low, double high) {
  if constexpr (requires { value.begin(); }) {
    return std::all_of(value.begin(), value.end(),
                       [&](auto element) { return IsInside(element, low, high); });
  } else {
    // As floats, so that a bound that float rounds outward still admits the value it was read from.
    return float(value) >= float(low) && float(value) <= float(high);
  }
}

}  // namespace

std::optional<BadKey> FindBadCombination(const LayerParams& params) {
  if (params.points > 5 && params.points != 9) {
    return BadKey{"points", "4, 5 or 9"};
  }
  if (params.chain == ChainKind::kVertex && params.points != 4) {
    return BadKey{"points",
                  "chains at mesh vertices have 4 points; chain = \"strand\" has 4, 5 or 9"};
  }
  if (params.chain_share < 1.0f &&
      (params.chain != ChainKind::kVertex || params.output == Output::kShells)) {
    return BadKey{"chain_share",
                  "of chains at mesh vertices alone: chain = \"vertex\", and no shells"};
  }
  if (params.points == 9 && params.solver != Solver::kModal) {
    return BadKey{"points", "only solver = \"modal\" has chains of 9; the others have 4 or 5"};
  }
  if (params.chain == ChainKind::kVertex && params.solver == Solver::kVerlet) {
    return BadKey{"solver", "verlet needs a chain for each strand: chain = \"strand\""};
  }
  if (params.max_distance > 0.0f && params.max_distance < kLeastMaxDistance) {
    return BadKey{"max_distance", "0 (no limit) or at least 0.05; strength = 0 holds a strand"};
  }
  if (params.max_distance > 0.0f && params.solver != Solver::kModal) {
    return BadKey{"max_distance", "only solver = \"modal\" keeps it"};
  }
  if (params.sag_free && params.solver != Solver::kModal) {
    return BadKey{"sag_free", "only solver = \"modal\" holds a groom up"};
  }
  if (params.sag_free && params.output == Output::kShells) {
    return BadKey{"sag_free", "shells have no chains to hold up"};
  }
  if (params.sag_free && params.inertia_turn != 1.0f) {
    return BadKey{"sag_free", "what holds the groom up is felt whole: inertia_turn is not 1"};
  }
  if (params.friction > 0.0f && params.solver != Solver::kModal) {
    return BadKey{"friction", "only solver = \"modal\" has it"};
  }
  const bool damps_inertia = params.inertia != 1.0f || params.inertia_turn != 1.0f;
  if ((damps_inertia || params.inertia_speed > 0.0f) && params.solver != Solver::kModal) {
    const auto key = params.inertia != 1.0f        ? "inertia"
                     : params.inertia_turn != 1.0f ? "inertia_turn"
                                                   : "inertia_speed";
    return BadKey{key, "only solver = \"modal\" has it; motion_damping is that of the others"};
  }
  if (params.output == Output::kShells && params.chain != ChainKind::kVertex) {
    return BadKey{"output", "shells stand on mesh vertices: chain = \"vertex\""};
  }
  if (params.fins && params.output != Output::kShells) {
    return BadKey{"fins", "they stand between shells: output = \"shells\""};
  }
  if (params.traits && params.output == Output::kShells) {
    return BadKey{"traits", "shells have no chains of strands"};
  }
  if (params.traits && params.sag_free) {
    return BadKey{"sag_free", "its strands are held up by the layer's weight: they have no traits"};
  }
  if (params.painted && params.output == Output::kShells) {
    return BadKey{"painted", "shells have no strands to paint"};
  }
  if (params.painted && !params.lit) {
    return BadKey{"painted", "paint is in what lit layers are shaded with: lit = true"};
  }
  return std::nullopt;
}

std::string FindBadParam(const LayerParams& params) {
  std::string text;
  ForEachLayerParam([&](const auto& entry) {
    if (text.empty() && !IsInside(params.*entry.member, entry.low, entry.high))
      text = Format("{} is not between {} and {}", entry.key, entry.low, entry.high);
  });
  if (text.empty() && !IsInside(params.look.tint, 0, kMostTint))
    text = Format("look.tint is not between 0 and {}", kMostTint);
  if (text.empty() && !IsInside(params.look.strand_tint, 0, kMostTint))
    text = Format("look.strand_tint is not between 0 and {}", kMostTint);
  for (const LayerLookEntry& entry : kLayerLookEntries)
    if (text.empty() && !IsInside(params.look.*entry.member, entry.low, entry.high))
      text = Format("look.{} is not between {} and {}", entry.key, entry.low, entry.high);
  if (!text.empty()) return text;
  const auto bad = FindBadCombination(params);
  return bad ? Format("{}: {}", bad->key, bad->reason) : std::string();
}

std::string FindBadStrandTexture(const StrandTexture& texture, const LayerParams& params) {
  const uint64_t texels = uint64_t(texture.width) * texture.height;
  if (texture.strips < 1 || texture.strips > 256 || texture.width % texture.strips != 0)
    return Format("{} texels wide: no multiple of film_strips, {}", texture.width, texture.strips);
  if (texels == 0 || texels > kStrandTextureBytes / 4)
    return Format("{} x {} texels; at most {} are allowed", texture.width, texture.height,
                  kStrandTextureBytes / 4);
  if (texels * 4 != texture.rgba.size())
    return Format("{} bytes for {} x {} texels", texture.rgba.size(), texture.width,
                  texture.height);
  if (texture.channels > StrandChannels::kWeather) return "channels of no known meaning";
  if (params.output == Output::kShells) return "shells have no strands";
  if (texture.channels == StrandChannels::kWeather && !params.painted)
    return "strand_channels = \"weather\" goes by each strand's wetness and dirt, which only "
           "painted layers have: lit = true, painted = true";
  return {};
}

std::string FindBadParam(const LayerParams& params, const StrandTexture* texture) {
  std::string bad = FindBadParam(params);
  if (bad.empty() && texture) bad = FindBadStrandTexture(*texture, params);
  return bad;
}

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
