// PeltFrame of jobs/pelt.h and FrameInput, one made of the other.
#include "jobs/c_frame.hpp"

#include <algorithm>
#include <iterator>

#include "core/float_rules.hpp"

namespace {

using pelt::c_frame::Copy;

static_assert(PELT_FREE == pelt::CapsuleCollider::kFree);
static_assert(PELT_MUD == int(pelt::PaintChannel::kMud));
static_assert(PELT_SNOW == int(pelt::PaintChannel::kSnow));
static_assert(PELT_WET == int(pelt::PaintChannel::kWet));
static_assert(PELT_DUST == int(pelt::PaintChannel::kDust));
static_assert(PELT_DUST + 1 == pelt::kPaintChannels);

struct SkipBit {
  uint32_t bit;
  bool pelt::SkipSettings::*member;
};
constexpr SkipBit kSkips[] = {
    {PELT_SLEEP, &pelt::SkipSettings::sleep}, {PELT_UNMOVED, &pelt::SkipSettings::unmoved},
    {PELT_SORT, &pelt::SkipSettings::sort},   {PELT_CULL, &pelt::SkipSettings::cull},
    {PELT_WIND, &pelt::SkipSettings::wind},   {PELT_LOD, &pelt::SkipSettings::lod},
    {PELT_LIGHT, &pelt::SkipSettings::light}};

const char* TranslateLighting(const PeltFrame& from, pelt::Lighting& to) {
  if (from.light_count > std::size(to.light)) return "more lights than a scene holds";
  if (from.light_count != 0 && !from.lights) return "the lights are null";
  if (from.irradiance_sample_count > std::size(to.sample))
    return "more irradiance samples than a scene holds";
  if (from.irradiance_sample_count != 0 && !from.irradiance_samples)
    return "the irradiance samples are null";
  to.light_count = from.light_count;
  to.sample_count = from.irradiance_sample_count;
  for (uint32_t l = 0; l < to.light_count; ++l) {
    const PeltLight& light = from.lights[l];
    Copy(light.position, to.light[l].position);
    to.light[l].radius = light.radius;
    Copy(light.rgb, to.light[l].rgb);
    to.light[l].range = light.range;
  }
  for (uint32_t s = 0; s < to.sample_count; ++s) {
    const PeltIrradianceSample& sample = from.irradiance_samples[s];
    Copy(sample.position, to.sample[s].position);
    to.sample[s].falloff = sample.falloff;
    Copy(sample.sky, to.sample[s].sky);
    Copy(sample.ground, to.sample[s].ground);
    Copy(sample.up, to.sample[s].up);
  }
  Copy(from.sun_direction, to.sun_direction);
  Copy(from.sun_rgb, to.sun_rgb);
  Copy(from.rim_direction, to.rim_direction);
  Copy(from.rim_rgb, to.rim_rgb);
  to.rim_exponent = from.rim_exponent;
  return nullptr;
}

const char* TranslateBrushes(const PeltFrame& from, pelt::FrameInput& to) {
  if (from.brush_count > std::size(to.brush)) return "more brushes than a scene holds";
  if (from.brush_count != 0 && !from.brushes) return "the brushes are null";
  to.brush_count = from.brush_count;
  for (uint32_t b = 0; b < to.brush_count; ++b) {
    const PeltBrush& brush = from.brushes[b];
    Copy(brush.centre, to.brush[b].centre);
    to.brush[b].radius = brush.radius;
    to.brush[b].hardness = brush.hardness;
    to.brush[b].channel = brush.channel;
    to.brush[b].amount = brush.amount;
  }
  return nullptr;
}

}  // namespace

const char* pelt::c_frame::Translate(const PeltFrame& from, std::vector<Weather>& weather,
                                     FrameInput& to) {
  to.dt_s = from.dt_s;
  to.time_s = from.time_s;
  Copy(from.eye, to.camera.eye);
  Copy(from.target, to.camera.target);
  Copy(from.up, to.camera.up);
  to.camera.vertical_fov_rad = from.vertical_fov_rad;
  to.camera.viewport_width_px = from.viewport_width_px;
  to.camera.viewport_height_px = from.viewport_height_px;
  to.camera.near_m = from.near_m;
  to.camera.far_m = from.far_m;
  std::copy_n(from.origin, 3, to.origin);
  Copy(from.gravity, to.gravity);
  Copy(from.wind_velocity, to.wind.velocity);
  to.wind.gust_strength = from.gust_strength;
  to.wind.gust_period_s = from.gust_period_s;
  to.wind.turbulence = from.turbulence;
  to.wind.turbulence_scale_m = from.turbulence_scale_m;
  to.use_ground = from.use_ground != 0;
  Copy(from.ground, to.ground);
  if (from.sphere_count > std::size(to.sphere)) return "more spheres than a scene holds";
  if (from.sphere_count != 0 && !from.spheres) return "the spheres are null";
  to.sphere_count = from.sphere_count;
  for (uint32_t s = 0; s < from.sphere_count; ++s) Copy(from.spheres[s], to.sphere[s]);
  if (from.sphere_velocities)
    for (uint32_t s = 0; s < from.sphere_count; ++s)
      Copy(from.sphere_velocities[s], to.sphere_velocity[s]);
  Copy(from.ground_velocity, to.ground_velocity);
  if (from.capsule_count > std::size(to.capsule)) return "more capsules than a scene holds";
  if (from.capsule_count != 0 && !from.capsules) return "the capsules are null";
  to.capsule_count = from.capsule_count;
  for (uint32_t c = 0; c < from.capsule_count; ++c) {
    const PeltCapsule& capsule = from.capsules[c];
    Copy(capsule.from, to.capsule[c].from);
    Copy(capsule.to, to.capsule[c].to);
    Copy(capsule.from_velocity, to.capsule[c].from_velocity);
    Copy(capsule.to_velocity, to.capsule[c].to_velocity);
    to.capsule[c].radius = capsule.radius;
    to.capsule[c].character = capsule.character;
    to.capsule[c].joint = capsule.joint;
  }
  if (const char* fault = TranslateLighting(from, to.lighting)) return fault;
  if (const char* fault = TranslateBrushes(from, to)) return fault;
  if (from.weather) {
    for (size_t c = 0; c < weather.size(); ++c)
      weather[c] = {from.weather[c][0], from.weather[c][1]};
    to.weather = weather;
  }
  to.lod = {from.full_detail_px,  from.min_fraction,
            from.hysteresis,      from.fade_share,
            from.least_chains,    from.strand_budget,
            from.fast_quality_px, from.budget_us,
            from.worst_px,        {from.chunk_ns, from.vertex_ns, from.strand_ns, {}}};
  Copy(from.node_ns, to.lod.costs.node_ns);
  for (const SkipBit& skip : kSkips) to.skip.*skip.member = (from.skip & skip.bit) != 0;
  return nullptr;
}

void pelt_default_frame(PeltFrame* frame) {
  if (!frame) return;
  *frame = {};
  const pelt::FrameInput in;
  frame->dt_s = in.dt_s;
  Copy(in.camera.eye, frame->eye);
  Copy(in.camera.target, frame->target);
  Copy(in.camera.up, frame->up);
  frame->vertical_fov_rad = in.camera.vertical_fov_rad;
  frame->viewport_width_px = in.camera.viewport_width_px;
  frame->viewport_height_px = in.camera.viewport_height_px;
  frame->near_m = in.camera.near_m;
  frame->far_m = in.camera.far_m;
  Copy(in.gravity, frame->gravity);
  frame->gust_period_s = in.wind.gust_period_s;
  frame->turbulence_scale_m = in.wind.turbulence_scale_m;
  Copy(in.ground, frame->ground);
  Copy(in.lighting.sun_direction, frame->sun_direction);
  Copy(in.lighting.rim_direction, frame->rim_direction);
  frame->rim_exponent = in.lighting.rim_exponent;
  frame->full_detail_px = in.lod.full_detail_px;
  frame->min_fraction = in.lod.min_fraction;
  frame->hysteresis = in.lod.hysteresis;
  frame->fade_share = in.lod.fade_share;
  frame->least_chains = in.lod.least_chains;
  frame->fast_quality_px = in.lod.fast_quality_px;
  frame->worst_px = in.lod.worst_px;
  for (const SkipBit& skip : kSkips)
    if (in.skip.*skip.member) frame->skip |= skip.bit;
}
