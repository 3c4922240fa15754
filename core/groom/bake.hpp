// The bake: from a character and a fur setup to a groom, layer by layer.
//
//   growth -> scatter -> attributes -> vertex chains -> patches -> chunks
//
// Invariant: the groom depends on its inputs alone; the same bits come out on any machine and
// compiler. Needs -ffp-contract=off.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/character/character.hpp"
#include "core/groom/fur_setup.hpp"
#include "core/groom/groom.hpp"
#include "core/groom/scatter.hpp"

namespace pelt {

// Called on the caller's thread with the layer at work and the share of the bake that is done.
using BakeProgress = std::function<void(std::string_view layer, float share)>;

// What chain_share and chain_mesh leave of a layer's chains at mesh vertices; of other layers nothing.
struct LayerChains {
  uint32_t all = 0, simulated = 0;
  uint32_t of_mesh = 0;  // of all, those at the chain_mesh's vertices
  // From each vertex whose chain is not simulated to where the chains that it follows put it.
  double mean_m = 0.0, p95_m = 0.0;
};

// What max_strands left of a layer's density.
struct LayerDensity {
  std::string layer;
  ScatterDensity scatter;
  float longest_m = 0.0f;  // strand
  LayerChains chains = {};

  bool IsCut() const { return scatter.asked > 1.1 * double(scatter.grown); }
  // The density that was asked for would cover the skin, and what is left of it does not: strands
  // stand further apart than half their length.
  bool IsCutBald() const;
};
// A warning for each layer that is, and one more where all are.
std::vector<std::string> WarnOfBaldness(std::span<const LayerDensity> layers);

// `rest` is ComputeRestGeometry(character, unit_scale). `progress`, `stats`, `densities` and `notes` may be
// null; stats cost about as much again as the bake; notes get a sentence for uneven UVs below maps, and for each image
// of the character that is needed and cannot be read. Throws pelt::Error "path: layer 'x': key 'y':
// reason" for what the setup asks of a character that lacks it (texture coordinates, joints,
// materials) and for a layer that ends without a strand. A layer of a setup with a chain_mesh that says no chain_share
// gets the least that holds all chains of that.
Groom BakeGroom(const Character& character, const RestGeometry& rest, const FurSetup& setup,
                float unit_scale, const BakeProgress* progress = nullptr,
                ScatterStats* stats = nullptr, std::vector<LayerDensity>* densities = nullptr,
                std::vector<std::string>* notes = nullptr);

// A haircut for FrameInput::cut, of the groom's layers one after the other: what stands where the picture, laid over
// the skin's texture coordinates, is darker than half in this channel is cut off. Of a character without coordinates
// all strands stand at u = v = 0.
std::vector<uint8_t> CutByStencil(const Groom& groom, const ControlMap& stencil, int channel = 0);

}  // namespace pelt
