// PeltFrame of jobs/pelt.h and FrameInput, one made of the other.
#include "jobs/c_frame.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <type_traits>

#include "core/float_rules.hpp"
#include "core/kernels/wind.hpp"

namespace {

using pelt::IrradianceSample, pelt::c_frame::Copy;

static_assert(PELT_FREE == pelt::CapsuleCollider::kFree);
static_assert(PELT_MUD == int(pelt::PaintChannel::kMud));
static_assert(PELT_SNOW == int(pelt::PaintChannel::kSnow));
static_assert(PELT_WET == int(pelt::PaintChannel::kWet));
static_assert(PELT_DUST == int(pelt::PaintChannel::kDust));
static_assert(PELT_DUST + 1 == pelt::kPaintChannels);
static_assert(PELT_FREE == pelt::ForceVolume::kFree);
static_assert(PELT_PUBLISHED_WIND == int(pelt::WindKind::kPublished));
static_assert(PELT_FORCE_BOX == int(pelt::ForceShape::kBox));
static_assert(PELT_FORCE_PULL == int(pelt::ForceKind::kPull));

struct SkipBit {
  uint32_t bit;
  bool pelt::SkipSettings::*member;
};
constexpr SkipBit kSkips[] = {
    {PELT_SLEEP, &pelt::SkipSettings::sleep}, {PELT_UNMOVED, &pelt::SkipSettings::unmoved},
    {PELT_SORT, &pelt::SkipSettings::sort},   {PELT_CULL, &pelt::SkipSettings::cull},
    {PELT_WIND, &pelt::SkipSettings::wind},   {PELT_LOD, &pelt::SkipSettings::lod},
    {PELT_LIGHT, &pelt::SkipSettings::light}};

// A member is the same in C and C++, to be copied with its struct: its type, and where it stands in C, from kAt on.
#define PELT_SAME(member)                              \
  (offsetof(C, member) - kAt == offsetof(D, member) && \
   std::is_same_v<decltype(C::member), decltype(D::member)>)

static_assert([]<class C = PeltLight, class D = pelt::SphereLight, size_t kAt = 0>() {
  return PELT_SAME(position) && PELT_SAME(radius) && PELT_SAME(rgb) && PELT_SAME(range);
}());
static_assert([]<class C = PeltIrradianceSample, class D = IrradianceSample, size_t kAt = 0>() {
  return PELT_SAME(position) && PELT_SAME(falloff) && PELT_SAME(sky) && PELT_SAME(ground) &&
         PELT_SAME(up);
}());
static_assert([]<class C = PeltBrush, class D = pelt::PaintBrush, size_t kAt = 0>() {
  return PELT_SAME(centre) && PELT_SAME(radius) && PELT_SAME(hardness) && PELT_SAME(channel) &&
         PELT_SAME(amount);
}());
static_assert([]<class C = PeltStrandWrite, class D = pelt::StrandWrite, size_t kAt = 0>() {
  return PELT_SAME(layer) && PELT_SAME(strand) && PELT_SAME(base_colour) && PELT_SAME(tip_colour) &&
         PELT_SAME(width) && PELT_SAME(film_strip) && sizeof(C) == sizeof(D);
}());
static_assert([]<class C = PeltForce, class D = pelt::ForceVolume, size_t kAt = 0>() {
  return PELT_SAME(centre) && PELT_SAME(half) && PELT_SAME(shape) && PELT_SAME(kind) &&
         PELT_SAME(direction) && PELT_SAME(strength) && PELT_SAME(hardness) &&
         PELT_SAME(character) && PELT_SAME(joint);
}());
static_assert([]<class C = PeltCapsule, class D = pelt::CapsuleCollider, size_t kAt = 0>() {
  return PELT_SAME(from) && PELT_SAME(to) && PELT_SAME(radius) && PELT_SAME(character) &&
         PELT_SAME(joint) && PELT_SAME(from_velocity) && PELT_SAME(to_velocity);
}());

// Where the runs of PeltFrame begin that are structs in C++.
constexpr size_t kCamera = offsetof(PeltFrame, eye), kWind = offsetof(PeltFrame, wind_velocity),
                 kLod = offsetof(PeltFrame, full_detail_px), kCosts = offsetof(PeltFrame, chunk_ns);
static_assert([]<class C = PeltFrame, class D = pelt::Camera, size_t kAt = kCamera>() {
  return PELT_SAME(eye) && PELT_SAME(target) && PELT_SAME(up) && PELT_SAME(vertical_fov_rad) &&
         PELT_SAME(viewport_width_px) && PELT_SAME(viewport_height_px) && PELT_SAME(near_m) &&
         PELT_SAME(far_m) && offsetof(C, gravity) - kAt == sizeof(D);
}());
static_assert([]<class C = PeltFrame, class D = pelt::WindSetup, size_t kAt = kWind>() {
  return PELT_SAME(gust_strength) && PELT_SAME(gust_period_s) && PELT_SAME(turbulence) &&
         PELT_SAME(turbulence_scale_m) && offsetof(C, wind_kind) - kAt == offsetof(D, kind) &&
         offsetof(C, use_ground) - kAt == sizeof(D);
}());
static_assert([]<class C = PeltFrame, class D = pelt::LodSettings, size_t kAt = kLod>() {
  return PELT_SAME(full_detail_px) && PELT_SAME(min_fraction) && PELT_SAME(hysteresis) &&
         PELT_SAME(fade_share) && PELT_SAME(least_chains) && PELT_SAME(strand_budget) &&
         PELT_SAME(fast_quality_px) && PELT_SAME(budget_us) && PELT_SAME(worst_px) &&
         kCosts - kAt == offsetof(D, costs) && offsetof(C, skip) - kAt == sizeof(D);
}());
static_assert([]<class C = PeltFrame, class D = pelt::FurCosts, size_t kAt = kCosts>() {
  return PELT_SAME(chunk_ns) && PELT_SAME(vertex_ns) && PELT_SAME(strand_ns) && PELT_SAME(node_ns);
}());
#undef PELT_SAME

template <class Part>
void CopyRun(const PeltFrame& from, size_t first, Part& to) {
  std::memcpy(&to, reinterpret_cast<const std::byte*>(&from) + first, sizeof to);
}
template <class Part>
void CopyRun(const Part& from, PeltFrame& to, size_t first) {
  std::memcpy(reinterpret_cast<std::byte*>(&to) + first, &from, sizeof from);
}

}  // namespace

const char* pelt::c_frame::Translate(const PeltFrame& from, const SceneShape& shape,
                                     std::vector<Weather>& weather, FrameInput& to) {
  to.dt_s = from.dt_s;
  to.time_s = from.time_s;
  CopyRun(from, kCamera, to.camera);
  std::copy_n(from.origin, 3, to.origin);
  Copy(from.gravity, to.gravity);
  CopyRun(from, kWind, to.wind);
  to.use_ground = from.use_ground != 0;
  Copy(from.ground, to.ground);
  Copy(from.ground_velocity, to.ground_velocity);
  const char* fault = nullptr;
  const auto take = [&fault](const auto array, uint32_t count, auto& room, uint32_t& room_count,
                             const char* too_many, const char* null) {
    static_assert(sizeof *array == sizeof *room);
    if (fault) return;
    if (count > std::size(room))
      fault = too_many;
    else if (count != 0 && !array)
      fault = null;
    else if (count != 0)
      std::memcpy(static_cast<void*>(room), array, count * sizeof *array);
    room_count = count;
  };
  take(from.spheres, from.sphere_count, to.sphere, to.sphere_count,
       "more spheres than a scene holds", "the spheres are null");
  take(from.capsules, from.capsule_count, to.capsule, to.capsule_count,
       "more capsules than a scene holds", "the capsules are null");
  Lighting& lighting = to.lighting;
  take(from.lights, from.light_count, lighting.light, lighting.light_count,
       "more lights than a scene holds", "the lights are null");
  take(from.irradiance_samples, from.irradiance_sample_count, lighting.sample,
       lighting.sample_count, "more irradiance samples than a scene holds",
       "the irradiance samples are null");
  take(from.brushes, from.brush_count, to.brush, to.brush_count, "more brushes than a scene holds",
       "the brushes are null");
  take(from.forces, from.force_count, to.force, to.force_count,
       "more force volumes than a scene holds", "the force volumes are null");
  if (fault) return fault;
  if (from.sphere_velocities)
    for (uint32_t s = 0; s < from.sphere_count; ++s)
      Copy(from.sphere_velocities[s], to.sphere_velocity[s]);
  Copy(from.sun_direction, lighting.sun_direction);
  Copy(from.sun_rgb, lighting.sun_rgb);
  Copy(from.rim_direction, lighting.rim_direction);
  Copy(from.rim_rgb, lighting.rim_rgb);
  lighting.rim_exponent = from.rim_exponent;
  if (from.weather) {
    for (size_t c = 0; c < weather.size(); ++c)
      weather[c] = {from.weather[c][0], from.weather[c][1]};
    to.weather = weather;
  }
  if (from.importance) to.importance = {from.importance, shape.layer_count};
  if (from.cut) to.cut = {from.cut, size_t(pelt::kStrandsPerChunk) * shape.chunk_count};
  if (from.strand_write_count != 0 && !from.strand_writes) return "the strand writes are null";
  to.strands = {reinterpret_cast<const StrandWrite*>(from.strand_writes), from.strand_write_count};
  CopyRun(from, kLod, to.lod);
  for (const SkipBit& skip : kSkips) to.skip.*skip.member = (from.skip & skip.bit) != 0;
  return nullptr;
}

void pelt_default_frame(PeltFrame* frame) {
  if (!frame) return;
  *frame = {};
  const pelt::FrameInput in;
  frame->dt_s = in.dt_s;
  CopyRun(in.camera, *frame, kCamera);
  Copy(in.gravity, frame->gravity);
  CopyRun(in.wind, *frame, kWind);
  Copy(in.ground, frame->ground);
  Copy(in.lighting.sun_direction, frame->sun_direction);
  Copy(in.lighting.rim_direction, frame->rim_direction);
  frame->rim_exponent = in.lighting.rim_exponent;
  CopyRun(in.lod, *frame, kLod);
  for (const SkipBit& skip : kSkips)
    if (in.skip.*skip.member) frame->skip |= skip.bit;
}

void pelt_wind_waves(const PeltFrame* frame, const double origin[3], PeltWindWaves* waves) {
  if (!waves) return;
  *waves = {};
  if (!frame || frame->wind_kind != PELT_PUBLISHED_WIND) return;
  pelt::WindSetup setup;
  CopyRun(*frame, kWind, setup);
  double from[3] = {};
  if (origin) std::copy_n(origin, 3, from);
  const pelt::WindParams wind = pelt::MakeWindParams(setup, frame->time_s, from);
  Copy(wind.direction_speed, waves->mean);
  std::memcpy(waves->along_x, &wind.sine[0], sizeof waves->along_x);
  std::memcpy(waves->along_z, &wind.sine[1], sizeof waves->along_z);
}
