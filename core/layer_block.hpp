// A layer's parameters for one frame: what the artist set, bent by the weather, turned into shares
// for this frame's step.
//
// Wetness and dirt act here and nowhere else, so they can change while it runs: no chain is reset,
// the next step simply has other numbers. Everything a kernel would need a transcendental function
// for is worked out here, once per layer and frame, with exact maths: the block is frame input, and
// the same setup gives the same bits on every machine.
#pragma once

#include <cstdint>

#include "core/chunk.hpp"
#include "core/frame_input.hpp"
#include "core/groom/layer_params.hpp"
#include "core/layer.hpp"
#include "core/modal/modal_course.hpp"

namespace pelt {

// The layer's kind: its flags that are fixed when the scene is made (kLayerKindFlags).
uint32_t LayerKind(const LayerParams& params);

// The finest of LodBlock::chain_level that the layer's share of its chains allows.
uint32_t LeastChainLevel(const LayerParams& params);

// Still air is left out of a frame, or computed all the same.
enum class Air : uint8_t { kLeftOut, kStill, kBlows };

// The block of a layer for a step of `dt` seconds.
//  gravity       m/s^2, world; the layer's weight is applied here
//  air           of the scene; the layer may still not respond
//  strand_count, length_max (m)  of the layer
//  any_strength  some strand of the layer has simulation strength
//  last          last frame's block of this layer, or null; decides `changed`. May be the block
//                that the result is assigned to
//  scale         of the character over that of its groom
//  push_ratio    of the modal solver in this frame (modal_table.hpp); 0: another solver, or none
//  pushed        a force volume may reach the layer
LayerBlock FillLayerBlock(const LayerParams& params, const Weather& weather, float dt,
                          const float gravity[3], Air air, uint32_t strand_count, float length_max,
                          bool any_strength, const LayerBlock* last, float scale = 1.0f,
                          double push_ratio = 0.0, bool pushed = false);

// Of a layer with output = "shells".
ShellLayerBlock FillShellLayer(const LayerParams& params, float length_max);

// A joint that rests bent by less than this turns with the root regardless of the setup. By how much
// of the secondary motion the two models differ (calibrated chains, dangly / soft / medium / stiff,
// per cent): at 2 degrees a joint 1 / 2 / 2 / 1, which is what the default quality gets wrong besides;
// at 3 degrees 1 / 4 / 4 / 2, at 5 2 / 13 / 8 / 6, at 10 5 / 26 / 22 / 19, at 20 12 / 55 / 47 / 44.
inline constexpr float kLeastCurl_degrees = 2.0f;

// Some chain with simulation strength has a joint that rests bent by more. Where all lie straight, a
// curl that turns with the strand (kernels/modal_curl.hpp) and one that follows the root are the same,
// and the latter costs less.
template <uint32_t kPoints>
bool HasCurl(const RestBlock<kPoints>& rest);

// What the strands of a layer with the modal solver are made of. Wetness takes stiffness. `curled`:
// some of them rest bent (HasCurl); where none does, both models of a curl are one, and the dear one
// is left out.
RodMaterial LayerRod(const LayerParams& params, const Weather& weather, float length_max,
                     bool curled);

}  // namespace pelt
