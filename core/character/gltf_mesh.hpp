// What ReadMesh (gltf_read.hpp) is made of: the triangles of a primitive, what moves its vertices, and which parts
// of a character are bare.
// Source: glTF 2.0, 3.7.2.1 (topology types), 3.7.3.1 (skinned mesh attributes).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/character/gltf_accessor.hpp"
#include "core/character/gltf_read.hpp"

namespace pelt::gltf {

// ---- Triangles: lists, strips and fans ----------------------------------------------------------

struct Triangles {
  std::vector<std::array<uint32_t, 3>> of;
  size_t corners = 0;                     // that were read
  size_t nowhere = 0;                     // left out: with a vertex that does not exist
  size_t unusable = 0;                    // left out: with a vertex that cannot be used
  size_t left_over = 0;                   // corners that made no whole triangle
  std::optional<uint32_t> first_nowhere;  // the first index of a vertex that does not exist
};

// Of a primitive with a vertex for each of `unusable`, which says whether it cannot be used. What a
// strip or fan turns back with, a triangle that names a vertex twice, is not among them. A fault
// where there are more than `limit`, or where what was left out leaves nothing.
Triangles ReadTriangles(const Document& document, const Primitive& primitive,
                        std::span<const uint8_t> unusable, uint64_t limit, const std::string& place,
                        Fault& fault);

// ---- What moves a primitive's vertices: its joints and weights, put right -----------------------

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

// ---- What is bare: eyes, noses, claws, what is worn, where fur grows only if a setup names it ----

// Whether a material's, mesh's or node's name has a word for something bare: "Eyes_Black", "leftEye", "TONGUE.001",
// "shirt_buttons", but neither "eyebrows" nor "nosering" nor "whisker pads".
bool IsBareName(std::string_view name);

// Adds to what is bare by name what is unlit, where that is a small part of the surface and no extension says another
// look, and what is transparent as a whole. Of characters that would be bare as a whole nothing is: then it says
// nothing.
void SettleBare(Mesh* mesh);

}  // namespace pelt::gltf
