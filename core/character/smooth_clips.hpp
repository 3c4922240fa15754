// Linear tracks made cubic: fur feels each corner that a linear track has at its keys as a blow.
//
// Files hold motions sampled at 24 to 60 keys a second, and what moved between the keys was smooth. So a track whose
// keys are that dense goes through the same keys on cubics (glTF's CUBICSPLINE); the slope at a key is that of the
// parabola through it and its neighbours. Where a track holds still from key to key it still does, to the last bit.
//
// Left as they are: scales, steps, keys that are few (an animator's own, meant as they stand), and rotations of more
// than a quarter turn from key to key.
#pragma once

#include "core/character/character.hpp"

namespace pelt {

inline constexpr double kSmoothedKeysPerSecond = 10.0;  // more than these are sampled motion

// Of all of its clips; its notes say how many tracks, and how far they lead off the lines.
void SmoothClips(Character& character);

}  // namespace pelt
