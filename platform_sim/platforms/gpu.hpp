// The numbers of both consoles' graphics processors that bound a drawn frame from below: what they can do at most.
// What keeps them from it (a texture that is waited for, a state that changes) is not here, so no frame is faster than
// what follows from these, and most are slower.
#pragma once

#include <cstdint>
#include <string_view>

#include "platform_sim/platforms/number.hpp"

namespace pelt {

// An instruction is one on four lanes with a scalar one beside it. As they are here, a Xenos's.
struct GpuNumbers {
  static constexpr std::string_view kXenos = "Beyond3D 2005, as quoted";

  Number<uint32_t> clock_mhz = {500, "GPU clock", "MHz", kXenos, Sureness::kSecondHand};
  // 1: vertices and pixels share them.
  Number<uint32_t> shader_pools = {1, "GPU shader pools", "pools", kXenos, Sureness::kSecondHand};
  Number<uint32_t> vertex_instructions_per_cycle = {48, "GPU vertex instructions", "1/cycle",
                                                    kXenos, Sureness::kSecondHand};
  Number<uint32_t> pixel_instructions_per_cycle = {48, "GPU pixel instructions", "1/cycle", kXenos,
                                                   Sureness::kSecondHand};
  // 0: no number is known, and none binds.
  Number<uint32_t> triangles_per_cycle = {1, "GPU triangles set up", "1/cycle", kXenos,
                                          Sureness::kSecondHand};
  Number<uint32_t> blended_pixels_per_cycle = {8, "GPU blended pixels", "1/cycle", kXenos,
                                               Sureness::kSecondHand};
  Number<uint32_t> blended_pixel_bytes = {0, "memory moved for a blended pixel", "B",
                                          "eDRAM of 256 GB/s holds the frame",
                                          Sureness::kSecondHand};
  Number<uint32_t> pixel_mbytes_per_s = {22400, "rate of the memory of pixels", "MB/s",
                                         "22.4 GB/s, Microsoft"};
  Number<uint32_t> vertex_mbytes_per_s = {22400, "rate of the memory of vertices", "MB/s",
                                          "22.4 GB/s, Microsoft"};
};

struct GpuParameters : GpuNumbers {
  std::string_view name = "Xenos";
};

// Vertices and pixels apart, pixels in GDDR3, vertices in XDR.
inline constexpr std::string_view kRsxTalks = "widely repeated";
inline constexpr GpuParameters kRsx = {
    {.clock_mhz = {500, "GPU clock", "MHz", "500 or 550: sources disagree", Sureness::kLead},
     .shader_pools = {2, "GPU shader pools", "pools", kRsxTalks, Sureness::kLead},
     .vertex_instructions_per_cycle = {8, "GPU vertex instructions", "1/cycle", kRsxTalks,
                                       Sureness::kLead},
     .pixel_instructions_per_cycle = {24, "GPU pixel instructions", "1/cycle", kRsxTalks,
                                      Sureness::kLead},
     .triangles_per_cycle = {0, "GPU triangles set up", "1/cycle", "nothing is known",
                             Sureness::kLead},
     .blended_pixels_per_cycle = {8, "GPU blended pixels", "1/cycle", kRsxTalks, Sureness::kLead},
     .blended_pixel_bytes = {12, "memory moved for a blended pixel", "B",
                             "colour read and written, depth read", Sureness::kSecondHand},
     .pixel_mbytes_per_s = {20800, "rate of the memory of pixels", "MB/s", "20.8 GB/s GDDR3",
                            Sureness::kSecondHand},
     .vertex_mbytes_per_s = {25600, "rate of the memory of vertices", "MB/s",
                             "25.6 GB/s XDR, cellmark"}},
    "RSX"};

// What our shaders take, in instructions; of one kind of strand's vertex, and of a pixel.
struct ShaderNumbers {
  static constexpr std::string_view kTrial = "counted by hand on the shaders' text";

  Number<uint32_t> curve_vertex = {100, "strand vertex on its curve", "instructions", kTrial,
                                   Sureness::kLead};
  Number<uint32_t> curve_shadow_vertex = {45, "the same in the shadow map", "instructions", kTrial,
                                          Sureness::kLead};
  Number<uint32_t> made_vertex = {30, "strand vertex that a CPU made", "instructions", kTrial,
                                  Sureness::kLead};
  Number<uint32_t> pixel = {10, "hair pixel", "instructions", kTrial, Sureness::kLead};
};

}  // namespace pelt
