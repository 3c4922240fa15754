// The bake: from a character and a fur setup to a groom, layer by layer.
//
//   growth -> scatter -> attributes -> vertex chains -> patches -> chunks
//
// Invariant: the groom depends on its inputs alone; the same bits come out on any machine and
// compiler. Needs -ffp-contract=off.
#pragma once

#include <functional>
#include <string_view>

#include "core/character/character.hpp"
#include "core/groom/fur_setup.hpp"
#include "core/groom/groom.hpp"
#include "core/groom/scatter_stats.hpp"

namespace pelt {

// Called on the caller's thread with the layer at work and the share of the bake that is done.
using BakeProgress = std::function<void(std::string_view layer, float share)>;

// `rest` is ComputeRestGeometry(character, unit_scale). `progress` and `stats` may be null; stats
// cost about as much again as the bake.
// Throws pelt::Error "path: layer 'x': key 'y': reason" for what the setup asks of a character that
// lacks it (texture coordinates, joints, materials) and for a layer that ends without a strand.
Groom BakeGroom(const Character& character, const RestGeometry& rest, const FurSetup& setup,
                float unit_scale, const BakeProgress* progress = nullptr,
                ScatterStats* stats = nullptr);

}  // namespace pelt
