// A character as imported: skinned mesh, skeleton, clips. Offline data; the frame sees only the
// blocks that are made from it. Everything here is in the file's own units; `unit_scale` turns them
// into metres.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

namespace pelt {

// How an image goes on beyond its edges.
enum class Wrap : uint8_t { kRepeat, kMirror, kClamp };

// What a material says of its look.
struct MaterialLook {
  bool stated = false;      // its base colour
  bool unlit = false;       // KHR_materials_unlit
  bool other_look = false;  // an extension says more of it: unlit is for those who do not know that
  bool bare = false;        // an eye, a nose or the like: fur grows there only if a setup names it
  glm::vec3 base_colour{1.0f};  // linear
  int32_t image = -1;           // of Character::images, multiplied with it; -1: none
  uint32_t uv_set = 0;          // TEXCOORD_n that images, and Mesh::uv, are laid by
  std::array<Wrap, 2> wrap{};   // of images, and of maps over them, along u and v
  // There is no skin where alpha, times that of the image, lies below the cut-off.
  float alpha = 1.0f, alpha_cutoff = 0.0f;
  int32_t alpha_image = -1;

  bool IsCut() const { return alpha_cutoff > 0.0f; }
  bool IsTransparent() const { return alpha < alpha_cutoff; }  // as a whole
};

// Triangles of all skinned primitives, welded, in mesh (bind) space. Arrays over vertices have
// equal length.
struct Mesh {
  std::vector<glm::vec3> position;
  std::vector<glm::vec3> normal;  // unit
  std::vector<glm::vec4>
      tangent;  // unit, w = handedness (+1, -1); any direction across the normal without UVs
  // Places in the material's image, as it is laid, and moved (KHR_texture_transform), by the
  // material: maps lie where the image lies. By the first set without one. Empty when the file has
  // none.
  std::vector<glm::vec2> uv;
  uint32_t uv_sets = 0;                        // that some primitive of the file has
  std::vector<std::array<uint8_t, 4>> joints;  // skeleton nodes; weight 0 where unused
  std::vector<glm::vec4> weights;              // sum to 1, descending
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint16_t> triangle_material;
  std::vector<std::string> materials;
  std::vector<MaterialLook> looks;                      // of the materials
  std::vector<std::array<glm::vec4, 3>> corner_colour;  // of the triangles, linear, and alpha;
                                                        // empty when the file has none
};

struct JointPose {
  glm::vec3 translation{0.0f};
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 scale{1.0f};
};

// Skin joints and all their ancestors, parents first. At most kJointsPerCharacter.
struct Skeleton {
  std::vector<std::string> name;
  std::vector<int32_t> parent;          // -1 for a root
  std::vector<JointPose> rest;          // local
  std::vector<glm::mat4> inverse_bind;  // identity for nodes that are not skin joints
};

enum class Interpolation : uint8_t { kStep, kLinear, kCubicSpline };
enum class Channel : uint8_t { kTranslation, kRotation, kScale };

struct Track {
  uint32_t joint;
  Channel channel;
  Interpolation interpolation;
  std::vector<float> time_s;  // strictly ascending
  std::vector<glm::vec4>
      value;  // xyz or quaternion xyzw; cubic: in tangent, value, out tangent for each time
};

struct Clip {
  std::string name;
  float duration_s = 0.0f;
  std::vector<Track> tracks;
};

struct Character {
  std::string name;
  Mesh mesh;
  Skeleton skeleton;
  std::vector<Clip> clips;
  std::vector<std::string>
      notes;  // repairs and guesses made on import, one sentence each, to be shown
  std::vector<std::string> files_read;         // besides the file itself: its buffers and images
  std::vector<std::vector<std::byte>> images;  // that materials use, encoded as in the file
};

// The mesh in its rest pose, in metres and world axes (y up): what grooming measures on.
struct RestGeometry {
  std::vector<glm::vec3> position;  // m
  std::vector<glm::vec3> normal;    // unit
  std::vector<glm::vec3> tangent;   // unit, orthogonal to the normal
};

}  // namespace pelt
