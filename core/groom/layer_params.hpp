// What the frame needs of a layer's setup: plain data, stored in the groom file field by field, and
// the bounds of every value.
//
// Apart from the fur setup it comes from, because an engine that only reads grooms needs neither
// TOML nor GLM. The setup's schema (setup_schema.cpp) takes its bounds from here, so a value that
// the setup may hold is one that the groom reader accepts, and no other.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/chunk.hpp"
#include "core/modal/modal_quality.hpp"

namespace pelt {

// Nearer the groom a strand cannot be held without straightening it.
inline constexpr float kLeastMaxDistance = 0.05f;

enum class Solver : uint8_t { kPbd, kVerlet, kModal };
enum class ChainKind : uint8_t { kVertex, kStrand };
enum class Output : uint8_t { kInstances, kRibbons };

struct LayerParams {
  bool enabled = true;
  float sort_bias = 0.0f;
  Solver solver = Solver::kModal;
  ChainKind chain = ChainKind::kVertex;
  uint32_t points = 4;  // 4 or 5; vertex chains have 4
  Output output = Output::kInstances;
  // Modal: the material, the same at every frame rate. The layer's drag is velocity_damping.
  float frequency_hz = 0.0f;  // first bending mode of a strand; 0: what the hardness keys amount to
  float damping_ratio = 0.05f;  // share of critical damping that bending gives that mode
  ModalQuality quality = ModalQuality::kDefault;
  // Modal: how far a point may get from its groomed place, a share of its distance along the
  // strand; 0: no limit.
  float max_distance = 0.0f;
  uint32_t iterations = 4;
  float weight = 1.0f;            // scale on gravity
  float bounce = 0.0f;            // share of the normal velocity a contact returns
  float velocity_damping = 3.0f;  // 1/s
  float motion_damping = 0.0f;    // 0 free inertia .. 1 follows the root's motion
  float segment_hardness = 1.0f;
  float angular_hardness_middle = 0.2f;
  float angular_hardness_end = 0.1f;
  float surface_hardness = 0.5f;
  float stiffness = 0.1f;  // verlet
  float clump = 0.0f;      // 0..1 at the tip
  float tip_width = 0.2f;  // tip width over root width
  bool backface_cull = true;
  float backface_tolerance = 0.2f;
  float wind_response = 1.0f;  // 1/s
  // How wetness and dirt (0..1, at run time) act on the layer. Soaked: the factor on the weight,
  // the share of the way from `clump` to 1, and the shares of hardness and brightness that are
  // left.
  float wet_weight = 1.5f, wet_clump = 0.6f, wet_hardness = 0.5f, wet_darken = 0.45f;
  std::array<float, 3> dirt_colour{0.25f, 0.18f, 0.10f};  // sRGB, 0..1
};

// Parts of `pelt bake --keys`.
enum class KeyGroup : uint8_t { kLayer, kGrowth, kLook, kMotion, kWeather };

// Inclusive bounds of the parameter that the setup calls `key`; of an enumeration, of its value.
struct ParamBounds {
  std::string_view key;
  double low, high;
};
// Null for a key that is not one of LayerParams with bounds.
const ParamBounds* FindParamBounds(std::string_view key);

// What no single key shows to be wrong.
struct BadKey {
  std::string_view key, reason;
};
std::optional<BadKey> FindBadCombination(const LayerParams& params);

// The reason why `params` holds a value the setup could not have held, or empty. For the groom
// file, which must not trust its input.
std::string FindBadParam(const LayerParams& params);

}  // namespace pelt
