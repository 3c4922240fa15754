// How much hair the layers of a body have where their maps let all of it grow, found from the hair that stands there.
#pragma once

#include <span>
#include <vector>

#include "bench/picture/body.hpp"
#include "bench/picture/skin_fur.hpp"

namespace pelt {

// A third of the area of the triangles round each vertex.
std::vector<float> AreasRoundVertices(const Mesh& mesh, const std::vector<glm::vec3>& position);

// Fills mapped and unmapped of a posed body. `growth` as PoseBody has it.
void MapFur(const SkinFur& fur, std::span<const SharedGrowth> growth, Body& body);

}  // namespace pelt
