// What a scene wants to know of a groom's patches, and follows from its blocks.
#pragma once

#include <bitset>
#include <vector>

#include "core/groom/chain_order.hpp"
#include "core/groom/groom.hpp"

namespace pelt {

using JointSet = std::bitset<kJointsPerCharacter>;

// The joints that move a vertex of the patch.
JointSet FindJoints(const MeshBlock&, uint32_t lane);

// Above which share of a layer's strands a kernel uses strand `place` of a chunk of `count`: lanes come
// in groups, and shares are products that are rounded.
double LiveFrom(uint32_t place, uint32_t count);

// Of the patch's vertices, in bind space.
std::vector<ChainPlace> ListChainPlaces(const MeshBlock&);

struct PatchIndex {
  std::vector<PatchBlock> patches;        // of the layer
  std::vector<ChainParentBlock> parents;  // of each of them
  std::vector<PatchListBlock> chunks;     // of each of its chunks
};

// The groom's blocks must agree with each other (FindGroomFault).
PatchIndex IndexPatches(const Groom&, const GroomLayer&);

}  // namespace pelt
