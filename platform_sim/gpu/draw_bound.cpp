#include "platform_sim/gpu/draw_bound.hpp"

#include <algorithm>

namespace pelt {
namespace {

// `work` at `per_cycle`, ms; none where no rate is known.
double Milliseconds(double work, uint32_t per_cycle, const GpuNumbers& gpu) {
  return per_cycle ? work / (double(per_cycle) * double(gpu.clock_mhz) * 1e3) : 0.0;
}

double MemoryMs(double bytes, uint32_t mbytes_per_s) {
  return bytes / (double(mbytes_per_s) * 1e3);
}

}  // namespace

std::string_view GpuUnitName(GpuUnit unit) {
  constexpr std::string_view kNames[kGpuUnitCount] = {"vertices", "pixels", "setup", "blending",
                                                      "memory"};
  return kNames[size_t(unit)];
}

DrawBound BoundPass(const GpuNumbers& gpu, const DrawPass& pass) {
  DrawBound out;
  auto& [vertex, pixel, setup, blending, memory] = out.ms;
  vertex = Milliseconds(pass.vertex_instructions, gpu.vertex_instructions_per_cycle, gpu);
  pixel = Milliseconds(pass.pixel_instructions, gpu.pixel_instructions_per_cycle, gpu);
  if (gpu.shader_pools == 1) vertex = pixel = vertex + pixel;
  setup = Milliseconds(pass.triangles, gpu.triangles_per_cycle, gpu);
  blending = Milliseconds(pass.pixels, gpu.blended_pixels_per_cycle, gpu);
  memory = std::max(MemoryMs(pass.pixels * double(gpu.blended_pixel_bytes), gpu.pixel_mbytes_per_s),
                    MemoryMs(pass.vertex_bytes, gpu.vertex_mbytes_per_s));
  const auto most = std::ranges::max_element(out.ms);
  out.at_least_ms = *most;
  out.binds = GpuUnit(most - out.ms.begin());
  return out;
}

}  // namespace pelt
