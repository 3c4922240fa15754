// Which parts of a character are bare: eyes, noses, claws, on which fur grows only where a setup names their material.
#pragma once

#include <string_view>

#include "core/character/character.hpp"

namespace pelt::gltf {

// Whether a material's, mesh's or node's name has a word for something bare: "Eyes_Black", "leftEye", "TONGUE.001", but
// neither "eyebrows" nor "nosering".
bool IsBareName(std::string_view name);

// Adds what is unlit to what is bare already, by name. Of characters that are unlit as a whole, or bare, nothing is: then
// neither says a thing.
void SettleBare(Mesh* mesh);

}  // namespace pelt::gltf
