// The steps that turn a document into a character: which nodes there are, skeleton, mesh, clips.
// Each checks all it uses. What other readers of glTF drop or repair is dropped or repaired, and
// `notes` say so; what leaves no character to read is an Error with file, place and reason.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "core/character/character.hpp"
#include "core/character/gltf_document.hpp"
#include "core/error.hpp"

namespace pelt::gltf {

// How much of a kind there may be: what a file names again and again is bounded by its bytes.
inline uint64_t LimitOf(const Document& document) {
  return std::min<uint64_t>(1u << 22, (1u << 16) + document.file_bytes);
}

// Which nodes there are: with one parent each, and no way up that never ends.
struct NodeTree {
  std::vector<int> parent;     // -1 for a root
  std::vector<uint8_t> shown;  // in the scene that was chosen, and no stand-in for another
};

// A skin as the skeleton sees it.
struct SkinBinding {
  int skin = -1;
  std::vector<int> joint;  // skin joint -> skeleton node, -1 for none
  // Into the bind space that the skeleton's inverse bind matrices start from; identity for the
  // first skin.
  glm::dmat4 to_bind{1.0};
};

// A skinned mesh to import.
struct MeshUse {
  int mesh = -1;
  int binding = -1;  // into bindings
  int node = -1;     // that has it
  // What primitives without joints hang on, and from the mesh into its bind space; -1: nothing.
  int holder = -1;
  glm::dmat4 to_holder{1.0};
};

struct SkeletonImport {
  Skeleton skeleton;
  std::vector<int> joint_of_node;  // node -> skeleton node, -1 for none
  std::vector<SkinBinding> bindings;
  std::vector<MeshUse> uses;
};

// How a node rests in its parent.
JointPose RestOf(const Document& document, size_t node, std::vector<std::string>* notes);
NodeTree ReadTree(const Document& document, std::vector<std::string>* notes);
// With all joints, however many, under the names that the file has.
SkeletonImport ReadSkeleton(const Document& document, std::vector<std::string>* notes);
// Gives each joint a name of its own. Of more joints than a character holds, those that are `used`
// and what these hang on stay, in their order; throws Error where these are too many. Returns the
// number that each joint has now, -1 for those that went.
std::vector<int> FinishSkeleton(const Document& document, const std::vector<uint8_t>& used,
                                SkeletonImport* skeleton, std::vector<std::string>* notes);
// Finishes the skeleton once it is known which joints are used.
Mesh ReadMesh(const Document& document, SkeletonImport* skeleton, std::vector<std::string>* notes);
std::vector<Clip> ReadClips(const Document& document, const SkeletonImport& skeleton,
                            std::vector<std::string>* notes);

// "mesh 0 'fox'", or "mesh 0" without a name.
std::string Place(const char* kind, size_t index, const std::string& name);

// Names that are empty become "<kind> <number>"; of those that are the same the later ones get a
// number behind, and a note.
void MakeNamesUnique(const std::string& kind, std::vector<std::string*> names,
                     std::vector<std::string>* notes);

}  // namespace pelt::gltf
