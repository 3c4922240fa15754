#include "core/layer_block.hpp"

#include <cmath>
#include <cstring>

#include "core/exact_math.hpp"
#include "core/float_rules.hpp"

namespace pelt {
namespace {

float Saturate(float a) { return a > 0.0f ? (a < 1.0f ? a : 1.0f) : 0.0f; }
float Mix(float from, float to, float share) { return from + (to - from) * share; }

uint32_t FlagsOf(const LayerParams& p, float clump, bool wind_blows, bool any_strength) {
  uint32_t flags = 0;
  const auto set = [&](bool condition, uint32_t flag) { flags |= condition ? flag : 0u; };
  set(p.enabled, kLayerEnabled);
  set(p.chain == ChainKind::kVertex, kLayerVertexChains);
  set(p.points == 5, kLayerFivePoints);
  set(p.solver == Solver::kVerlet, kLayerVerlet);
  set(p.solver == Solver::kModal, kLayerModal);
  set(p.output == Output::kRibbons, kLayerRibbons);
  set(clump > 0.0f, kLayerClump);
  set(p.backface_cull, kLayerBackFaceCull);
  set(wind_blows && p.wind_response != 0.0f, kLayerWind);
  set(any_strength, kLayerSimulate);
  return flags;
}

// The share of its stiffness that the layer keeps in this weather.
float StiffnessLeft(const LayerParams& p, const Weather& weather) {
  return Mix(1.0f, Saturate(p.wet_hardness), Saturate(weather.wetness));
}

// `changed` itself is not compared.
bool Differ(const LayerBlock& a, const LayerBlock& b) {
  LayerBlock x = a, y = b;
  x.changed = y.changed = 0;
  return std::memcmp(&x, &y, sizeof x) != 0;
}

}  // namespace

LayerBlock FillLayerBlock(const LayerParams& params, const Weather& weather, float dt,
                          const float gravity[3], bool wind_blows, uint32_t strand_count,
                          float length_max, bool any_strength, const LayerBlock* last) {
  const float wet = Saturate(weather.wetness);
  const float softer = StiffnessLeft(params, weather);
  const float dry_clump = Saturate(params.clump);

  LayerBlock b{};
  const float weight = params.weight * Mix(1.0f, params.wet_weight, wet);
  for (int k = 0; k < 3; ++k) b.gravity[k] = weight * gravity[k];
  b.bounce = Saturate(params.bounce);
  b.velocity_keep = float(exact::Exp(
      -double(params.velocity_damping > 0 ? params.velocity_damping : 0.0f) * double(dt)));
  b.motion_follow = Saturate(params.motion_damping);
  b.segment_hardness = Saturate(params.segment_hardness);
  b.angular_middle = Saturate(params.angular_hardness_middle) * softer;
  b.angular_end = Saturate(params.angular_hardness_end) * softer;
  b.surface_hardness = Saturate(params.surface_hardness);
  b.stiffness = Saturate(params.stiffness) * softer;
  // Water closes a share of what is left to a full clump.
  b.clump = dry_clump + (1.0f - dry_clump) * Saturate(params.wet_clump) * wet;
  b.wind_response = params.wind_response;
  b.backface_tolerance = params.backface_tolerance;
  b.width = 1.0f;
  b.tip_width = params.tip_width;
  b.sort_bias = params.sort_bias;
  b.length_max = length_max;
  b.darken = Mix(1.0f, Saturate(params.wet_darken), wet);
  for (int k = 0; k < 3; ++k) b.dirt_colour[k] = Saturate(params.dirt_colour[k]);
  b.dirt = Saturate(weather.dirt);
  b.iterations = params.iterations;
  b.strand_count = strand_count;
  b.max_distance = params.max_distance;
  b.flags = FlagsOf(params, b.clump, wind_blows, any_strength);
  if (last && (b.flags & kLayerModal) && (last->flags & ~b.flags & kLayerWind))
    b.flags |= kLayerWindEnds;
  b.changed = !last || Differ(*last, b) ? 1u : 0u;
  return b;
}

RodMaterial LayerRod(const LayerParams& params, const Weather& weather) {
  const uint32_t links = params.points - 1;
  const double dry =
      params.frequency_hz > 0.0f
          ? double(params.frequency_hz)
          : FrequencyOfHardness(links, Saturate(params.angular_hardness_middle),
                                Saturate(params.angular_hardness_end), params.iterations);
  const double drag = params.velocity_damping > 0.0f ? double(params.velocity_damping) : 0.0;
  return {links, dry * std::sqrt(double(StiffnessLeft(params, weather))),
          double(params.damping_ratio), drag};
}

}  // namespace pelt
