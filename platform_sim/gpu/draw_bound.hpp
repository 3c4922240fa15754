// How long a graphics processor takes at least for what is drawn: of each of its units, were it busy all the time and
// nothing else in the way. A lower bound, and no verdict: nothing fits because of it.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "platform_sim/platforms/gpu.hpp"

namespace pelt {

// One pass over the drawn strands.
struct DrawPass {
  std::string name;
  double vertices = 0.0, vertex_instructions = 0.0;  // instructions of all of them
  double triangles = 0.0;
  double pixels = 0.0, pixel_instructions = 0.0;  // covered and blended; instructions of all
  double vertex_bytes = 0.0;                      // read
};

enum class GpuUnit : uint8_t { kVertexShaders, kPixelShaders, kSetup, kBlending, kMemory };
inline constexpr size_t kGpuUnitCount = 5;
std::string_view GpuUnitName(GpuUnit unit);  // "vertices"

struct DrawBound {
  std::array<double, kGpuUnitCount> ms{};  // of each unit alone; a shared pool's sum stands in both
  double at_least_ms = 0.0;
  GpuUnit binds = GpuUnit::kVertexShaders;
};

DrawBound BoundPass(const GpuNumbers& gpu, const DrawPass& pass);

}  // namespace pelt
