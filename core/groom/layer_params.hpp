// What the frame needs of a layer's setup: plain data, and an entry that says everything about each
// member: its key in the setup, unit, bounds, meaning, and where it goes in the frame.
//
// The setup's schema (setup_schema.cpp), the groom file, the check of its values and the frame's
// layer block go through the entries, in the order of the members, which is that of the file. So a
// value that the setup may hold is one that the groom reader accepts, and no other.
//
// Apart from the fur setup it comes from, because an engine that only reads grooms needs neither
// TOML nor GLM.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "core/groom/layer_look.hpp"
#include "core/layer.hpp"
#include "core/modal/modal_quality.hpp"
#include "core/outputs.hpp"
#include "core/reflect.hpp"

namespace pelt {

// Nearer the groom a strand cannot be held without straightening it.
inline constexpr float kLeastMaxDistance = 0.05f;

enum class Solver : uint8_t { kPbd, kVerlet, kModal };
enum class ChainKind : uint8_t { kVertex, kStrand };
// What carries a strand's rest curl from joint to joint (core/kernels/modal_curl.hpp).
enum class CurlFollows : uint8_t { kRoot, kParent };
enum class Output : uint8_t { kInstances, kRibbons, kLines, kShells };

struct LayerParams {
  bool enabled = true;
  float sort_bias = 0.0f;
  float sort_place = 0.75f;   // along the strand, root 0 to tip 1: of the depth that orders strands
  float shadow_share = 1.0f;  // of the strands that are drawn: what shadow passes draw, the wider
  Solver solver = Solver::kModal;
  ChainKind chain = ChainKind::kVertex;
  // Vertex chains: share of them that is simulated, rounded up to a half, a quarter or an eighth; the others
  // follow three of those.
  float chain_share = 1.0f;
  uint32_t points = 4;  // 4, 5 or 9; vertex chains have 4
  Output output = Output::kInstances;
  // Modal: the material, the same at every frame rate. The layer's drag is velocity_damping.
  float frequency_hz = 0.0f;  // first bending mode of a strand; 0: what the hardness keys amount to
  float damping_ratio = 0.05f;  // share of critical damping that bending gives that mode
  ModalQuality quality = ModalQuality::kFast;
  // Modal: how far a point may get from its groomed place, a share of its distance along the
  // strand; 0: no limit.
  float max_distance = 0.0f;
  CurlFollows curl_follows = CurlFollows::kParent;
  bool sag_free = false;  // modal: the groomed shape is where strands rest under gravity, dry
  // Modal: the shares of the root's motion and turns that a strand feels, and the fastest motion of a
  // root that it feels, m/s; 0: any.
  float inertia = 1.0f, inertia_turn = 1.0f;
  float inertia_speed = 0.0f;
  uint32_t iterations = 4;
  float weight = 1.0f;    // scale on gravity
  float bounce = 0.0f;    // share of the normal velocity a contact returns
  float friction = 0.0f;  // modal: share of a contact's normal force that holds strands back (mu)
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
  float dirt_clump = 0.0f;  // dirty: as wet_clump, of what water leaves
  std::array<float, 3> dirt_colour{0.25f, 0.18f, 0.10f};  // sRGB, 0..1
  bool lit = false;      // the frame says what light reaches the layer
  bool painted = false;  // brushes put mud, snow, water and dust on strands; lit layers alone
  // Of shells (core/chunk.hpp); and the texture they are cut from (MakeFurTexture).
  uint32_t shells = kMaxShells;  // up close
  float shell_spacing = 0.0f;    // m; 0: as many for any length
  ConeKind cone_kind = ConeKind::kExact;
  float cone = 0.2f;                // least cosine between force and normal; -1: no cone
  float fur_shadow = 0.3f;          // light left at the skin
  float fur_density = 0.5f;         // hairs drawn for each texel, at random
  float fur_min_length = 0.2f;      // of the longest hair
  uint32_t fur_texture_size = 256;  // texels a side
  float fur_texture_repeat = 4.0f;  // along 0..1 of the skin's coordinates
  uint32_t fur_seed = 1;
  bool fins = false;
  bool traits = false;  // strands have a TraitBlock: where a key gives them traits, or room is kept
  LayerLook look;       // its entries are those of layer_look.hpp
};

// How a parameter gets into the frame's LayerBlock; what takes more than that is worked out in
// layer_block.cpp.
enum class InFrame : uint8_t { kAsItIs, kClamped };

// Parts of `pelt bake --keys`.
enum class KeyGroup : uint8_t { kLayer, kGrowth, kLook, kMotion, kWeather };

template <class T>
struct LayerParamEntry {
  T LayerParams::*member;
  std::string_view key, unit;
  double low, high;       // inclusive; of an enumeration, of its value
  std::string_view text;  // for people
  KeyGroup group;
  std::span<const std::string_view> words = {};  // of an enumeration, in value order
  T LayerBlock::*frame = nullptr;                // null: see layer_block.cpp
  InFrame how = InFrame::kAsItIs;
  std::span<const std::string_view> in_file = {};  // names of an array's elements; else the key
};

namespace layer_params_detail {

using P = LayerParams;
using B = LayerBlock;
using Text = std::string_view;
using enum InFrame;
using enum KeyGroup;

inline constexpr Text kSolverWords[] = {"pbd", "verlet", "modal"};
inline constexpr Text kQualityWords[] = {"fast", "fine", "best"};
inline constexpr Text kChainWords[] = {"vertex", "strand"};
inline constexpr Text kCurlWords[] = {"root", "parent"};
inline constexpr Text kConeWords[] = {"exact", "published"};
inline constexpr Text kDirtFields[] = {"dirt_red", "dirt_green", "dirt_blue"};

template <class T>
constexpr LayerParamEntry<T> Entry(T P::*member, KeyGroup group, Text key, Text unit, double low,
                                   double high, Text text, T B::*frame = nullptr,
                                   InFrame how = kAsItIs) {
  return {member, key, unit, low, high, text, group, {}, frame, how};
}
template <class T>
constexpr LayerParamEntry<T> WordEntry(T P::*member, KeyGroup group, Text key,
                                       std::span<const Text> words, Text text) {
  return {member, key, "", 0, double(words.size() - 1), text, group, words};
}
constexpr LayerParamEntry<bool> SwitchEntry(bool P::*member, KeyGroup group, Text key, Text text) {
  return {member, key, "", 0, 1, text, group};
}

// Bounds are there to catch slips and to keep hostile files from asking for absurd amounts of work;
// they are far outside what looks good.
// clang-format off
inline constexpr auto kEntries = std::tuple{
    SwitchEntry(&P::enabled, kLayer, "enabled", "baked but not run when false"),
    Entry(&P::sort_bias, kLayer, "sort_bias", "", -1000, 1000, "layers are drawn in ascending bias",
        &B::sort_bias),
    Entry(&P::sort_place, kLayer, "sort_place", "", 0, 1,
        "place along the strand, from root to tip, whose depth orders it among others", &B::sort_place),
    Entry(&P::shadow_share, kLook, "shadow_share", "", 0.01, 1,
        "share of the strands that are drawn into shadow maps, as much wider as they are fewer"),
    WordEntry(&P::solver, kLayer, "solver", kSolverWords, "how chains are simulated"),
    WordEntry(&P::chain, kLayer, "chain", kChainWords,
        "chains at mesh vertices, or one for each strand"),
    Entry(&P::chain_share, kLayer, "chain_share", "", 0.125, 1,
        "vertex: share of its chains that is simulated, by halves; the others follow them"),
    Entry(&P::points, kLayer, "points", "", 4, 9,
        "points per chain, the fixed one too: 4, 5 or 9; vertex: 4, strand: 5 if unset"),
    WordEntry(&P::output, kLayer, "output", kOutputNames, "what vertex generation writes"),
    Entry(&P::frequency_hz, kMotion, "frequency", "Hz", 0, 2000,
        "modal: first bending mode; 0: worked out from the hardness"),
    Entry(&P::damping_ratio, kMotion, "damping_ratio", "", 0, 10,
        "modal: of that mode, over critical damping"),
    WordEntry(&P::quality, kMotion, "quality", kQualityWords, "modal: cheapest to most exact"),
    Entry(&P::max_distance, kMotion, "max_distance", "", 0, 2,
        "modal: of a point from the groom, over its distance along the strand; 0: no limit",
        &B::max_distance),
    WordEntry(&P::curl_follows, kMotion, "curl_follows", kCurlWords,
        "modal: what a joint's rest bend turns with, the link above it or the root (cheaper)"),
    SwitchEntry(&P::sag_free, kMotion, "sag_free",
        "modal: the groomed shape is where strands rest under gravity, not before it"),
    Entry(&P::inertia, kMotion, "inertia", "", 0, 1,
        "modal: share of the root's motion that a strand feels; 0: it is carried along"),
    Entry(&P::inertia_turn, kMotion, "inertia_turn", "", 0, 1,
        "modal: share of the root's turns that a strand feels; 0: it turns with them"),
    Entry(&P::inertia_speed, kMotion, "inertia_speed", "m/s", 0, 1000,
        "modal: fastest motion of its root that a strand feels; 0: any"),
    Entry(&P::iterations, kMotion, "iterations", "", 1, 32, "pbd, verlet: of the solver, a frame"),
    Entry(&P::weight, kMotion, "weight", "", -10, 10, "scale on gravity"),
    Entry(&P::bounce, kMotion, "bounce", "", 0, 1, "speed kept by a contact", &B::bounce, kClamped),
    Entry(&P::friction, kMotion, "friction", "", 0, 2,
        "modal: coefficient of friction on spheres, capsules and the ground"),
    Entry(&P::velocity_damping, kMotion, "velocity_damping", "1/s", 0, 1000,
        "drag: how fast speed dies away"),
    Entry(&P::motion_damping, kMotion, "motion_damping", "", 0, 1,
        "pbd, verlet: 0: free inertia, 1: moves with the root", &B::motion_follow, kClamped),
    Entry(&P::segment_hardness, kMotion, "segment_hardness", "", 0, 1,
        "pbd, verlet: length error removed per iteration"),
    Entry(&P::angular_hardness_middle, kMotion, "angular_hardness_middle", "", 0, 1,
        "bend removed per iteration; inner joints"),
    Entry(&P::angular_hardness_end, kMotion, "angular_hardness_end", "", 0, 1,
        "bend removed per iteration; last joint"),
    Entry(&P::surface_hardness, kMotion, "surface_hardness", "", 0, 1,
        "depth under the skin removed per iteration or substep", &B::surface_hardness, kClamped),
    Entry(&P::stiffness, kMotion, "stiffness", "", 0, 1, "verlet: way to the groom per iteration; "
        "shells: share of the pull that does not bend them"),
    Entry(&P::clump, kMotion, "clump", "", 0, 1, "way to the control strand, at the tip"),
    Entry(&P::tip_width, kLook, "tip_width", "", 0, 4, "width at the tip over that at the root",
        &B::tip_width),
    SwitchEntry(&P::backface_cull, kMotion, "backface_cull", "leave out strands that face away"),
    Entry(&P::backface_tolerance, kMotion, "backface_tolerance", "", 0, 1,
        "how far a strand may face away and still be drawn", &B::backface_tolerance),
    Entry(&P::wind_response, kMotion, "wind_response", "1/s", 0, 1000,
        "acceleration for each m/s of wind", &B::wind_response),
    Entry(&P::wet_weight, kWeather, "wet_weight", "", 0, 10, "soaked: factor on weight"),
    Entry(&P::wet_clump, kWeather, "wet_clump", "", 0, 1,
        "soaked: share of the way from clump to 1"),
    Entry(&P::wet_hardness, kWeather, "wet_hardness", "", 0, 1,
        "soaked: share of the hardness that is left"),
    Entry(&P::wet_darken, kWeather, "wet_darken", "", 0, 1,
        "soaked: share of the brightness that is left"),
    Entry(&P::dirt_clump, kWeather, "dirt_clump", "", 0, 1,
        "dirty: share of the way from the clump, wet or dry, to 1"),
    LayerParamEntry<std::array<float, 3>>{.member = &P::dirt_colour, .key = "dirt_colour",
        .unit = "", .low = 0, .high = 1, .text = "mixed into the colours when dirty",
        .group = kWeather, .in_file = kDirtFields},
    SwitchEntry(&P::lit, kLook, "lit",
        "gather the scene's lights for it, for the renderer to shade with"),
    SwitchEntry(&P::painted, kWeather, "painted",
        "lit: brushes and weather act on each strand's look"),
    Entry(&P::shells, kLook, "shells", "", 1, kMaxShells,
        "shells: how many up close; at d metres at most 40 / d"),
    Entry(&P::shell_spacing, kLook, "shell_spacing", "m", 0, 1,
        "shells: no nearer to each other than this, so that shorter fur has fewer; 0: any"),
    WordEntry(&P::cone_kind, kMotion, "cone_kind", kConeWords,
        "shells: how the force is kept in its cone; published: as in the original"),
    Entry(&P::cone, kMotion, "cone", "", -1, 1,
        "shells: least cosine between the force and the skin's normal; -1: no cone"),
    Entry(&P::fur_shadow, kLook, "fur_shadow", "", 0, 1,
        "shells: share of the light left at the skin"),
    Entry(&P::fur_density, kLook, "fur_density", "", 0, 8,
        "shells: hairs thrown on the texture, for each texel; 1 - exp(-density) of them have one"),
    Entry(&P::fur_min_length, kLook, "fur_min_length", "", 0, 1,
        "shells: of the shortest hair, over the longest"),
    Entry(&P::fur_texture_size, kLook, "fur_texture_size", "texels", 1, 2048,
        "shells: side of the texture"),
    Entry(&P::fur_texture_repeat, kLook, "fur_texture_repeat", "", 0.01, 1000,
        "shells: of the texture, along 0 to 1 of the skin's coordinates"),
    Entry(&P::fur_seed, kLook, "fur_seed", "", 0, 1e6, "shells: of the texture's random numbers"),
    SwitchEntry(&P::fins, kLook, "fins",
        "shells: edges of the skin that are seen from the side are drawn out along the fur"),
    SwitchEntry(&P::traits, kMotion, "traits",
        "room for what strands have of their own, which *_scale, angle_limit, hardness_profile set"),
};
// clang-format on
static_assert(std::tuple_size_v<decltype(kEntries)> + 1 == kMemberCount<LayerParams>,
              "a parameter without an entry is neither stored nor checked");

}  // namespace layer_params_detail

inline constexpr const auto& kLayerParamEntries = layer_params_detail::kEntries;

// Calls visit(entry) for each entry, in their order.
constexpr void ForEachLayerParam(auto&& visit) {
  std::apply([&](const auto&... entry) { (visit(entry), ...); }, kLayerParamEntries);
}

// The entry of a member.
template <class T>
constexpr const LayerParamEntry<T>& LayerParamEntryOf(T LayerParams::*member) {
  const LayerParamEntry<T>* found = nullptr;
  ForEachLayerParam([&](const auto& entry) {
    if constexpr (std::is_same_v<decltype(entry), const LayerParamEntry<T>&>)
      if (entry.member == member) found = &entry;
  });
  return *found;
}

// What no single key shows to be wrong.
struct BadKey {
  std::string_view key, reason;
};
std::optional<BadKey> FindBadCombination(const LayerParams& params);

// The reason why `params` holds a value the setup could not have held, or empty. For the groom
// file, which must not trust its input.
std::string FindBadParam(const LayerParams& params);

// The texture that shells are cut from: how far the hair of each texel reaches, of 255; 0 where
// there is none. Rows of fur_texture_size texels each, from v = 0 up. It repeats in both directions.
//
// Hairs are thrown at random places with replacement, so of a density of d a texel 1 - exp(-d) of the
// texels have one, and the last that fell on a texel is the one that stands there.
//
// Invariant: of four numbers alone (size, density, least length, seed), the same on every machine,
// so a groom holds those and not the texels.
std::vector<uint8_t> MakeFurTexture(const LayerParams& params);

}  // namespace pelt
