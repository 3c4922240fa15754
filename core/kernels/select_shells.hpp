// How many shells a layer is drawn with, and what each of them is: the four numbers of an instance.
//
//   count = min(most, floor(40 m / d)),  d from the eye to the layer's box, over its importance
//
// so 40 shells up to a metre, 8 at five, 1 at forty, and none beyond (select_lod then leaves the
// whole layer out). Shell i of n stands at h = (i + 1) / n, lets light down by k + (1 - k) h, and is
// drawn where the texture is above i / n: the hairs that reach into the gap below it, so that the
// last shell, at h = 1, has its share of them.
//
// Invariant: the count is found without a root, and where the importance is 1 without a rounding, so that a
// table of whole metres is met exactly; what lies behind it in the table is zero.
#pragma once

#include <string_view>

#include "core/box_distance.hpp"
#include "core/kernel.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"

namespace pelt {

inline constexpr float kShellReach_m = 40.0f;  // the farthest that there is a shell

// The most n, up to `most`, for which n d <= kShellReach_m.
PELT_INLINE uint32_t CountShells(float squared_distance, uint32_t most) {
  uint32_t count = 0;
  while (count < most &&
         float((count + 1) * (count + 1)) * squared_distance <= kShellReach_m * kShellReach_m)
    ++count;
  return count;
}

// As far as the layer's importance has it, squared.
PELT_INLINE float ShellDistance2(const float (&eye)[3], const LayerBlock& layer,
                                 const BoundsBlock& box) {
  return SquaredDistance(eye, box) / (layer.importance * layer.importance);
}

struct SelectShellsParams {
  float eye[3];  // m
  uint32_t all;  // not 0: as many as there may be, at any distance
};

template <class V>
struct SelectShells {
  static constexpr std::string_view kName = "select_shells";
  using Params = SelectShellsParams;
  struct Ports {
    In<&Streams::layers> params;
    In<&Streams::lod> lod;
    In<&Streams::bounds> bounds;
    In<&Streams::shell_layers> layer;
    Out<&Streams::shell_lod> shells;
  };

  // From where the last shell is alone until it goes, this falls to 0.
  static PELT_INLINE float FadeAt(float squared_distance) {
    constexpr float kAlone = 0.5f * kShellReach_m;
    if (squared_distance <= kAlone * kAlone) return 1.0f;
    const float left = kShellReach_m / Sqrt(V(squared_distance))[0] - 1.0f;
    return left > 0.0f ? left : 0.0f;
  }

  static void Run(const Params& p, const Ports& ports) {
    const ShellLayerBlock& layer = *ports.layer;
    ShellLodBlock& out = *ports.shells;
    const bool any = p.all == 0 && ports.lod->visible != 0;
    const float squared = any ? ShellDistance2(p.eye, *ports.params, *ports.bounds) : 0.0f;
    const uint32_t count = ports.lod->visible != 0 ? CountShells(squared, layer.most) : 0;
    const float fade = count != 0 ? FadeAt(squared) : 0.0f;
    for (uint32_t i = 0; i < kMaxShells; ++i) {
      Shell& shell = out.shell[i];
      const bool drawn = i < count;
      shell.height = drawn ? float(i + 1) / float(count) : 0.0f;
      shell.shadow = drawn ? layer.shadow + (1.0f - layer.shadow) * shell.height : 0.0f;
      shell.threshold = drawn ? float(i) / float(count) : 0.0f;
      shell.fade = drawn ? fade : 0.0f;
    }
    out.count = count;
    out.texture_repeat = layer.texture_repeat;
    for (uint32_t& word : out.pad) word = 0;
  }
};

}  // namespace pelt
