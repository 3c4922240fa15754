// The three steps that turn a document into a character: skeleton, mesh, clips. Each checks all it
// uses and throws Error with file, place and reason, or repairs and says so in `notes`.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "core/character/character.hpp"
#include "core/character/gltf_document.hpp"

namespace pelt::gltf {

// Caps against files that name the same data again and again; far above any character.
inline constexpr uint64_t kMaxVertices = 1u << 22;
inline constexpr uint64_t kMaxTriangles = 1u << 22;
inline constexpr uint64_t kMaxKeys = 1u << 22;

// A skin as the skeleton sees it.
struct SkinBinding {
  int skin = -1;
  std::vector<uint8_t> joint;  // skin joint -> skeleton node
  // Into the bind space that the skeleton's inverse bind matrices start from; identity for the
  // first skin.
  glm::dmat4 to_bind{1.0};
};

// A skinned mesh to import.
struct MeshUse {
  int mesh = -1;
  int binding = -1;  // into bindings
  int node = -1;     // that has it
};

struct SkeletonImport {
  Skeleton skeleton;
  std::vector<int> joint_of_node;  // node -> skeleton node, -1 for none
  std::vector<SkinBinding> bindings;
  std::vector<MeshUse> uses;
};

SkeletonImport ReadSkeleton(const Document& document, std::vector<std::string>* notes);
Mesh ReadMesh(const Document& document, const SkeletonImport& skeleton,
              std::vector<std::string>* notes);
std::vector<Clip> ReadClips(const Document& document, const SkeletonImport& skeleton,
                            std::vector<std::string>* notes);

// "mesh 0 'fox'", or "mesh 0" without a name.
std::string Place(const char* kind, size_t index, const std::string& name);

}  // namespace pelt::gltf
