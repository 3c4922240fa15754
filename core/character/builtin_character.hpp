// The built-in characters, made in code: mesh, skeleton and clips, written as a .glb so that they
// enter by the same door as any character.
//
// The furry monster. Parts are materials: head, brow, body, arm, leg, tail, eye (grow nothing on the last). 24 joints
// (root, hips, spine, chest, neck, head, brow_l/r, shoulder/elbow/hand_l/r, thigh/shin/foot_l/r,
// tail_1..4). About 1.2 m tall, y up, facing +z, feet on the ground. Clips:
//   walk   1 s, loops
//   idle   settles for 0.5 s, then holds still, bit for bit, up to 60 s and (not looped) for ever
//   shake  1.6 s, loops; a wet dog's shake of head and trunk, then rest
//   greet  2 s, loops; waves with an arm above its head, and nods
// All are cubic splines.
//
// The scorpion. Parts: head, body, tail, sting, claw, leg, eye. 34 joints (root, body, head,
// abdomen, tail_1..5, sting, arm/elbow/claw/finger_l/r, thigh/shin_l1..4 and _r1..4). About 1.2 m
// long. Clips: walk (1 s, loops), idle (as above), strike (1.5 s, loops; of the tail).
#pragma once

#include <cstddef>
#include <vector>

#include "core/character/builtin_shape.hpp"
#include "core/character/character.hpp"

namespace pelt {

// The same options give the same bytes on every machine.
std::vector<std::byte> MakeBuiltinCharacterGlb(const BuiltinCharacterOptions& options);

// MakeBuiltinCharacterGlb through ImportGltf; the character is called "builtin", or "scorpion".
Character MakeBuiltinCharacter(const BuiltinCharacterOptions& options);

}  // namespace pelt
