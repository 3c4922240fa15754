// The fields of a frame's input in the order of the input log: one list for writing, reading and
// comparing. A field added to FrameInput is added here, for the versions from which on logs have
// it, and kInputLogVersion goes up.
//
// An archive is called with each field's name and the field: double, float, uint32_t, bool, or an
// array of floats. Spheres (as many as sphere_count says), capsules, lights, irradiance samples,
// brushes, force volumes and weather follow; each user lists them after checking the count. Colliders' velocities, and
// lists about layers and strands, stand apart, at a recording's end.
#pragma once

#include "core/frame_input.hpp"
#include "traces/input_log.hpp"

namespace pelt {

void ListInputFields(auto&& archive, auto& in, uint32_t version = kInputLogVersion) {
  archive("dt_s", in.dt_s);
  archive("time_s", in.time_s);
  archive("camera.eye", in.camera.eye);
  archive("camera.target", in.camera.target);
  archive("camera.up", in.camera.up);
  archive("camera.vertical_fov_rad", in.camera.vertical_fov_rad);
  archive("camera.viewport_width_px", in.camera.viewport_width_px);
  archive("camera.viewport_height_px", in.camera.viewport_height_px);
  archive("camera.near_m", in.camera.near_m);
  archive("camera.far_m", in.camera.far_m);
  archive("wind.velocity", in.wind.velocity);
  archive("wind.gust_strength", in.wind.gust_strength);
  archive("wind.gust_period_s", in.wind.gust_period_s);
  archive("wind.turbulence", in.wind.turbulence);
  archive("wind.turbulence_scale_m", in.wind.turbulence_scale_m);
  archive("gravity", in.gravity);
  archive("use_ground", in.use_ground);
  archive("ground", in.ground);
  archive("lod.full_detail_px", in.lod.full_detail_px);
  archive("lod.min_fraction", in.lod.min_fraction);
  archive("lod.hysteresis", in.lod.hysteresis);
  archive("lod.fade_share", in.lod.fade_share);
  archive("lod.strand_budget", in.lod.strand_budget);
  archive("skip.sleep", in.skip.sleep);
  archive("skip.unmoved", in.skip.unmoved);
  archive("skip.sort", in.skip.sort);
  archive("skip.cull", in.skip.cull);
  archive("skip.wind", in.skip.wind);
  archive("skip.lod", in.skip.lod);
  if (version >= 3) {
    archive("skip.light", in.skip.light);
    archive("sun.direction", in.lighting.sun_direction);
    archive("sun.rgb", in.lighting.sun_rgb);
    archive("rim.direction", in.lighting.rim_direction);
    archive("rim.rgb", in.lighting.rim_rgb);
    archive("rim.exponent", in.lighting.rim_exponent);
  }
  if (version >= 6) archive("lod.fast_quality_px", in.lod.fast_quality_px);
  if (version >= 8) archive("lod.least_chains", in.lod.least_chains);
  if (version >= 9) {
    archive("lod.budget_us", in.lod.budget_us);
    archive("lod.worst_px", in.lod.worst_px);
    archive("lod.costs.chunk_ns", in.lod.costs.chunk_ns);
    archive("lod.costs.vertex_ns", in.lod.costs.vertex_ns);
    archive("lod.costs.strand_ns", in.lod.costs.strand_ns);
    archive("lod.costs.node_ns", in.lod.costs.node_ns);
  }
  if (version >= 10) archive("wind.kind", in.wind.kind);
  // The counts are last.
  archive("sphere_count", in.sphere_count);
  if (version >= 2) archive("capsule_count", in.capsule_count);
  if (version >= 3) archive("light_count", in.lighting.light_count);
  if (version >= 3) archive("irradiance_sample_count", in.lighting.sample_count);
  if (version >= 4) archive("brush_count", in.brush_count);
  if (version >= 10) archive("force_count", in.force_count);
}

// One capsule. `archive` is called with "from", "to" and so on.
void ListCapsuleFields(auto&& archive, auto& capsule) {
  archive("from", capsule.from);
  archive("to", capsule.to);
  archive("radius", capsule.radius);
  archive("character", capsule.character);
  archive("joint", capsule.joint);
}

void ListLightFields(auto&& archive, auto& light) {
  archive("position", light.position);
  archive("radius", light.radius);
  archive("rgb", light.rgb);
  archive("range", light.range);
}

void ListIrradianceFields(auto&& archive, auto& sample) {
  archive("position", sample.position);
  archive("falloff", sample.falloff);
  archive("sky", sample.sky);
  archive("ground", sample.ground);
  archive("up", sample.up);
}

void ListBrushFields(auto&& archive, auto& brush) {
  archive("centre", brush.centre);
  archive("radius", brush.radius);
  archive("hardness", brush.hardness);
  archive("channel", brush.channel);
  archive("amount", brush.amount);
}

void ListForceFields(auto&& archive, auto& force) {
  archive("centre", force.centre);
  archive("half", force.half);
  archive("shape", force.shape);
  archive("kind", force.kind);
  archive("direction", force.direction);
  archive("strength", force.strength);
  archive("hardness", force.hardness);
  archive("character", force.character);
  archive("joint", force.joint);
}

// All of whom there may be more than one, as many as the counts say. `archive` is called with a
// name, its number and the field: ("capsule", 2, "radius", value); of a sphere without the field.
void ListCountedFields(auto&& archive, auto& in) {
  for (uint32_t s = 0; s < in.sphere_count; ++s) archive("sphere", s, "", in.sphere[s]);
  const auto each = [&](const char* what, uint32_t i) {
    return [&archive, what, i](const char* field, auto& value) { archive(what, i, field, value); };
  };
  for (uint32_t c = 0; c < in.capsule_count; ++c)
    ListCapsuleFields(each("capsule", c), in.capsule[c]);
  auto& lighting = in.lighting;
  for (uint32_t l = 0; l < lighting.light_count; ++l)
    ListLightFields(each("light", l), lighting.light[l]);
  for (uint32_t s = 0; s < lighting.sample_count; ++s)
    ListIrradianceFields(each("irradiance sample", s), lighting.sample[s]);
  for (uint32_t b = 0; b < in.brush_count; ++b) ListBrushFields(each("brush", b), in.brush[b]);
  for (uint32_t f = 0; f < in.force_count; ++f)
    ListForceFields(each("force volume", f), in.force[f]);
}

// Velocities of the colliders, `archive` called as above. A recording has them only for frames in
// which something moves.
void ListColliderVelocities(auto&& archive, auto& in) {
  archive("ground", 0u, "velocity", in.ground_velocity);
  for (uint32_t s = 0; s < in.sphere_count; ++s)
    archive("sphere", s, "velocity", in.sphere_velocity[s]);
  for (uint32_t c = 0; c < in.capsule_count; ++c) {
    archive("capsule", c, "from_velocity", in.capsule[c].from_velocity);
    archive("capsule", c, "to_velocity", in.capsule[c].to_velocity);
  }
}

// One strand that is written.
void ListStrandFields(auto&& archive, auto& strand) {
  archive("layer", strand.layer);
  archive("strand", strand.strand);
  archive("base_colour", strand.base_colour);
  archive("tip_colour", strand.tip_colour);
  archive("width", strand.width);
  archive("film_strip", strand.film_strip);
}

// Lists about layers and strands, of an input or of an InputLogLists. `list` is called with the name and the list;
// ListElement calls `archive` with the fields of an element of any of them.
void ListLayerLists(auto&& list, auto& in) {
  list("importance", in.importance);
  list("cut", in.cut);
  list("strands", in.strands);
}
void ListElement(auto&& archive, auto& element) {
  if constexpr (requires { element.film_strip; })
    ListStrandFields(archive, element);
  else
    archive("", element);
}

}  // namespace pelt
