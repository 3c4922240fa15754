// Which chains of a patch go first when they thin, and whom those then follow.
//
// Of the vertices that the first strands use, then of the others, the farthest first: each chain is the
// farthest from all before it, by place and facing, so that every prefix lies as evenly on the patch as so
// few can. A right angle counts as a third of the patch's width: the two sides of an ear are no
// neighbours.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/chunk.hpp"

namespace pelt {

struct ChainPlace {
  float position[3];  // rest pose, m
  float normal[3];    // unit
  uint32_t use = 0;   // places of less use are left out first: 0 is of the most
};

// Of each place its level: how many times chains may be halved (CountChains) before it goes; the
// coarsest, kChainLevels - 1, for those that stay.
std::vector<uint32_t> FindChainLevels(std::span<const ChainPlace> places);

// Of places in the order of their levels, the coarsest first: the three nearest in the prefix that each
// follows, by the inverse square of how far they are. (Blends that find the place again, by least
// squares, took 2 % off the error that thinning adds.)
ChainParentBlock FindChainParents(std::span<const ChainPlace> places);

// Of each place behind the first `simulated`, how far it is from where those that it follows put it, m: as far as
// the blend of their motion may be off.
std::vector<double> MeasureFollowing(std::span<const ChainPlace> places, uint32_t simulated);

}  // namespace pelt
