// A groom whose strands have as few points as a kernel takes: what a bake with `points` at its
// least would give, made from the baked groom, so that it can be tried where there is no setup.
//
// A strand keeps its root, length, look and strength; its points are laid anew, in equal segments,
// along where they were. Invariant: what comes out passes FindGroomFault when what went in did.
#pragma once

#include <cstdint>

#include "core/groom/groom.hpp"

namespace pelt {

// The least that `points` may be.
uint32_t FewestPoints();

// Whether some strand has more.
bool HasMorePoints(const Groom& groom);

Groom ResampleToFewestPoints(const Groom& groom);

}  // namespace pelt
