// Whether a clip goes on where it ends when it loops. One that walks away from where it began does
// not: there the engine teleports the character, or its fur is torn along.
#pragma once

#include "core/character/character.hpp"

namespace pelt {

// Whether some of the mesh lies elsewhere at the clip's end than at its beginning, by more than a
// fiftieth of the rest pose's extent and four times what anything moves in a sixtieth of a second
// within the clip: a last key that was left out is no jump.
bool JumpsWhereItLoops(const Character& character, const Clip& clip);

}  // namespace pelt
