// What moves a primitive's vertices: its joints and weights, put right.
// Source: glTF 2.0, 3.7.3.1 (skinned mesh attributes).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/character/gltf_accessor.hpp"
#include "core/character/gltf_read.hpp"

namespace pelt::gltf {

// Vertices with something that was put right, to be said once.
struct WeightRepairs {
  size_t negative = 0, extra = 0, not_one = 0, unweighted = 0;  // weights, then vertices
  size_t bad_unused_joint = 0, bad_joint = 0;                   // joint indices
  size_t odd = 0;  // with weights that are no finite numbers
};

struct Influences {
  std::vector<std::array<uint32_t, 4>> joints;  // skeleton nodes
  std::vector<glm::vec4> weights;               // sum to 1, descending
  std::vector<uint8_t> lost;                    // to be taken from a neighbour
};

// Whether the primitive says what moves it.
bool HasInfluences(const Primitive& primitive);

// Of `count` vertices; none where there is a fault. Counts what was put right, notes what was left
// out.
Influences ReadInfluences(const Document& document, const Primitive& primitive,
                          const SkinBinding& binding, size_t count, const std::string& place,
                          WeightRepairs* repairs, std::vector<std::string>* notes, Fault& fault);

// The joints of `mesh`, in numbers of the whole skeleton, in those of the skeleton as it is finished
// with what the triangles use.
std::vector<std::array<uint8_t, 4>> NarrowJoints(const Document& document, const Mesh& mesh,
                                                 const std::vector<std::array<uint32_t, 4>>& joints,
                                                 SkeletonImport* skeleton,
                                                 std::vector<std::string>* notes);

// What was put right, with the `lost` of which some `borrowed` a neighbour's.
void NoteWeights(const WeightRepairs& repairs, size_t lost, size_t borrowed,
                 std::vector<std::string>* notes);

}  // namespace pelt::gltf
