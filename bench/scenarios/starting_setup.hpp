// A fur setup to start from, for a character that has none: a layer for each of its materials that
// is not bare, long and dense enough for its size to cover the skin.
#pragma once

#include <string>
#include <vector>

#include "core/character/character.hpp"

namespace pelt {

// What a material has of the surface.
struct MaterialShare {
  uint32_t triangles = 0;
  double area_m2 = 0.0;
};
// Of each material of the mesh.
std::vector<MaterialShare> MeasureMaterials(const Mesh& mesh, const RestGeometry& rest);

// TOML, with the reason for each choice; `rest` is in metres by `unit_scale`. It bakes for this
// character, and no layer of it is bald. Throws Error where there is nothing to grow on.
std::string StartingSetup(const Character& character, const RestGeometry& rest, float unit_scale);

}  // namespace pelt
