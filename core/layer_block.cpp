#include "core/layer_block.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/outputs.hpp"

namespace pelt {
namespace {

float Saturate(float a) { return a > 0.0f ? (a < 1.0f ? a : 1.0f) : 0.0f; }
float Mix(float from, float to, float share) { return from + (to - from) * share; }

// The share of its stiffness that the layer keeps in this weather.
float StiffnessLeft(const LayerParams& p, const Weather& weather) {
  return Mix(1.0f, Saturate(p.wet_hardness), Saturate(weather.wetness));
}

template <class T>
T InFrameOf(const T& value, InFrame) {
  return value;
}
float InFrameOf(float value, InFrame how) {
  return how == InFrame::kClamped ? Saturate(value) : value;
}

// A soft surface is a spring, so stiff that a point at rest in it loses the share `hardness` of its
// depth within 1/120 s. The share in this frame's substeps, by which strands sink as deep at every
// frame rate.
float ShareOfDepth(float hardness, double push_ratio) {
  if (!(push_ratio > 0.0 && hardness > 0.0f && hardness < 1.0f)) return hardness;
  const double pull = push_ratio * double(hardness);
  return float(pull / (1.0 - double(hardness) + pull));
}

// `changed` itself is not compared, nor what only says that lights changed, that brushes came, or
// what is known of the roots, or that still air is computed, nor what LOD alone sees.
bool Differ(const LayerBlock& a, const LayerBlock& b) {
  constexpr uint32_t kOfOthers =
      kLayerRelight | kLayerBrushed | kLayerRates | kLayerRatesGiven | kLayerWind;
  LayerBlock x = a, y = b;
  x.changed = y.changed = 0;
  x.frame_ratio = y.frame_ratio = 0.0f;
  x.importance = y.importance = 0.0f;
  x.flags &= ~kOfOthers, y.flags &= ~kOfOthers;
  return std::memcmp(&x, &y, sizeof x) != 0;
}

// Friction, and what moves a strand along with its root without its feeling it.
void SetModal(const LayerParams& params, float dt, const LayerBlock* last, LayerBlock& b) {
  b.modal.friction = params.friction;
  b.motion_follow = 1.0f - Saturate(params.inertia);
  b.modal.turn_follow = 1.0f - Saturate(params.inertia_turn);
  b.modal.fastest_felt = params.inertia_speed > 0.0f ? params.inertia_speed * dt : 0.0f;
  b.modal.shrink = last && last->scale > 0.0f ? last->scale / b.scale : 1.0f;
}

}  // namespace

uint32_t LayerKind(const LayerParams& p) {
  uint32_t kind = kOutputs[size_t(p.output)].flag;
  if (p.chain == ChainKind::kVertex) kind |= kLayerVertexChains;
  if (p.points == 5) kind |= kLayerFivePoints;
  if (p.points == 9) kind |= kLayerNinePoints;
  const bool solved = p.output != Output::kShells;  // shells are bent, without a state
  if (solved && p.solver == Solver::kVerlet) kind |= kLayerVerlet;
  if (solved && p.solver == Solver::kModal) kind |= kLayerModal;
  if (p.sag_free && (kind & kLayerModal)) kind |= kLayerSagFree;
  if (p.lit) kind |= kLayerLit;
  if (p.painted) kind |= kLayerPainted;
  if (p.fins) kind |= kLayerFins;
  if (p.traits) kind |= kLayerTraits;
  return kind;
}

uint32_t LeastChainLevel(const LayerParams& params) {
  uint32_t level = 0;
  for (float share = 0.5f; level + 1 < kChainLevels && share >= params.chain_share; share *= 0.5f)
    ++level;
  return level;
}

LayerBlock FillLayerBlock(const LayerParams& params, const Weather& weather, float dt,
                          const float gravity[3], Air air, uint32_t strand_count, float length_max,
                          bool any_strength, const LayerBlock* last, float scale, double push_ratio,
                          bool pushed) {
  const float wet = Saturate(weather.wetness);
  const float softer = StiffnessLeft(params, weather);
  const float dry_clump = Saturate(params.clump);

  LayerBlock b{};
  ForEachLayerParam([&](const auto& entry) {
    if (entry.frame) b.*entry.frame = InFrameOf(params.*entry.member, entry.how);
  });
  const double drag = params.velocity_damping > 0.0f ? double(params.velocity_damping) : 0.0;
  b.link = {.velocity_keep = float(exact::Exp(-drag * double(dt))),
            .segment_hardness = Saturate(params.segment_hardness),
            .angular_middle = Saturate(params.angular_hardness_middle) * softer,
            .angular_end = Saturate(params.angular_hardness_end) * softer,
            .stiffness = Saturate(params.stiffness) * softer,
            .iterations = params.iterations};
  // After 1/60 s.
  if (LayerKind(params) & kLayerModal)
    b.modal.drawn_hardness = b.surface_hardness * (2.0f - b.surface_hardness);
  b.surface_hardness = ShareOfDepth(b.surface_hardness, push_ratio);
  const float weight = params.weight * Mix(1.0f, params.wet_weight, wet);
  // Not -0, to which wind of no speed adds up to 0 where it is not skipped.
  for (int k = 0; k < 3; ++k) b.gravity[k] = weight * gravity[k] + 0.0f;
  if (LayerKind(params) & kLayerSagFree) {
    double square = 0.0;
    for (int k = 0; k < 3; ++k) square += double(gravity[k]) * double(gravity[k]);
    b.modal.rest_gravity = float(double(params.weight) * std::sqrt(square));
  }
  // Water closes a share of what is left to a full clump, and dirt one of what water leaves.
  b.clump = dry_clump + (1.0f - dry_clump) * Saturate(params.wet_clump) * wet;
  b.clump += (1.0f - b.clump) * Saturate(params.dirt_clump) * Saturate(weather.dirt);
  b.scale = scale;
  b.length_max = scale == 1.0f ? length_max : scale * length_max;
  // Painted layers' colours are left dry and clean: weather is in the strands' looks.
  b.darken =
      params.painted ? Saturate(params.wet_darken) : Mix(1.0f, Saturate(params.wet_darken), wet);
  for (int k = 0; k < 3; ++k) b.dirt_colour[k] = Saturate(params.dirt_colour[k]);
  b.dirt = Saturate(weather.dirt);
  if (params.lit) b.wetness = wet;
  b.importance = 1.0f;
  b.strand_count = strand_count;
  b.flags = LayerKind(params) | LeastChainLevel(params) << kLayerChainLevelShift;
  if (b.flags & kLayerModal) SetModal(params, dt, last, b);
  const auto set = [&](bool condition, uint32_t flag) { b.flags |= condition ? flag : 0u; };
  set(params.enabled, kLayerEnabled);
  set(b.clump > 0.0f, kLayerClump);
  set(params.backface_cull, kLayerBackFaceCull);
  set((air != Air::kLeftOut && params.wind_response != 0.0f) || pushed, kLayerWind);
  set(pushed, kLayerPushed);
  set(air == Air::kBlows && params.wind_response != 0.0f, kLayerBlows);
  set(any_strength, kLayerSimulate);
  constexpr uint32_t kAir = kLayerBlows | kLayerPushed;
  if (last && (b.flags & kLayerModal) && (last->flags & ~b.flags & kAir)) b.flags |= kLayerWindEnds;
  b.changed = !last || Differ(*last, b) ? 1u : 0u;
  return b;
}

ShellLayerBlock FillShellLayer(const LayerParams& params, float length_max) {
  ShellLayerBlock b{};
  b.most = params.shells;
  if (params.shell_spacing > 0.0f && length_max < params.shell_spacing * float(params.shells))
    b.most = std::max(1u, uint32_t(length_max / params.shell_spacing));
  b.shadow = params.fur_shadow;
  b.texture_repeat = params.fur_texture_repeat;
  b.cone = params.cone;
  b.cone_kind = uint32_t(params.cone_kind);
  return b;
}

template <uint32_t kPoints>
bool HasCurl(const RestBlock<kPoints>& rest) {
  const float straight = float(exact::Cos(double(kLeastCurl_degrees) * exact::kRadiansPerDegree));
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    if (!(rest.strength[lane] > 0.0f)) continue;
    float last[3] = {}, before[3] = {};  // link and point
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      float turn = 0.0f;
      for (int k = 0; k < 3; ++k) {
        const float link = rest.offset[i][k][lane] - before[k];
        before[k] = rest.offset[i][k][lane];
        turn += link * last[k];
        last[k] = link;
      }
      const float length = rest.segment_length[lane];
      if (i > 0 && turn < straight * length * length) return true;
    }
  }
  return false;
}

template bool HasCurl(const RestBlock<4>&);
template bool HasCurl(const RestBlock<5>&);
template bool HasCurl(const RestBlock<9>&);

RodMaterial LayerRod(const LayerParams& params, const Weather& weather, float length_max,
                     bool curled) {
  const uint32_t links = params.points - 1;
  const double dry =
      params.frequency_hz > 0.0f
          ? double(params.frequency_hz)
          // Those keys are of the originals' chains, which have 4 links at most.
          : FrequencyOfHardness(std::min(links, 4u), Saturate(params.angular_hardness_middle),
                                Saturate(params.angular_hardness_end), params.iterations);
  const double drag = params.velocity_damping > 0.0f ? double(params.velocity_damping) : 0.0;
  // Dry: while it rains the nodes must stay what they are.
  constexpr double kGravity = 9.81;
  const bool stiff =
      GammaOf(dry, double(length_max), kGravity * double(params.weight)) < kStiffGamma;
  return {params.points,
          dry * std::sqrt(double(StiffnessLeft(params, weather))),
          double(params.damping_ratio),
          drag,
          stiff,
          curled && params.curl_follows == CurlFollows::kParent};
}

}  // namespace pelt
