// Which parts of a character are bare: eyes, noses, claws, what is worn, on which fur grows only where a setup names
// their material.
#pragma once

#include <string_view>

#include "core/character/character.hpp"

namespace pelt::gltf {

// Whether a material's, mesh's or node's name has a word for something bare: "Eyes_Black", "leftEye", "TONGUE.001",
// "shirt_buttons", but neither "eyebrows" nor "nosering" nor "whisker pads".
bool IsBareName(std::string_view name);

// Adds to what is bare by name what is unlit, where that is a small part of the surface and no extension says another
// look, and what is transparent as a whole. Of characters that would be bare as a whole nothing is: then it says nothing.
void SettleBare(Mesh* mesh);

}  // namespace pelt::gltf
