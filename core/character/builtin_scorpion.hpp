// The built-in scorpion: eight legs, two claws, a tail with a sting. What it has is said in builtin_character.hpp.
#pragma once

#include "core/character/builtin_clips.hpp"
#include "core/character/builtin_shape.hpp"

namespace pelt::builtin {

Shape DesignScorpion();
std::span<const ClipPlan> ScorpionClips();

}  // namespace pelt::builtin
