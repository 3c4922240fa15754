// The fields of a frame's input in the order of the input log: one list for writing, reading and
// comparing. A field added to FrameInput is added here, for the versions from which on logs have
// it, and kInputLogVersion goes up.
//
// An archive is called with each field's name and the field: double, float, uint32_t, bool, or an
// array of floats. Spheres (as many as sphere_count says), capsules and weather follow; each user
// lists them after checking the count.
#pragma once

#include "core/frame_input.hpp"
#include "traces/input_log.hpp"

namespace pelt {

void ListInputFields(auto&& archive, auto& in, uint32_t version = kInputLogVersion) {
  archive("dt_s", in.dt_s);
  archive("time_s", in.time_s);
  archive("camera.position", in.camera.position);
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
  archive("sphere_count", in.sphere_count);
  if (version >= 2) archive("capsule_count", in.capsule_count);
}

// One capsule. `archive` is called with "from", "to" and so on.
void ListCapsuleFields(auto&& archive, auto& capsule) {
  archive("from", capsule.from);
  archive("to", capsule.to);
  archive("radius", capsule.radius);
  archive("character", capsule.character);
  archive("joint", capsule.joint);
}

}  // namespace pelt
