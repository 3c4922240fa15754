// The built-in monster's body: an implicit surface made of ellipsoids and round cones blended
// together, turned into one closed mesh. Skin weights, materials and UVs all follow from the same
// primitives, so they fit each other by construction.
//
// Invariant: only IEEE arithmetic, exact:: functions and seeded numbers; the same options give the
// same bytes on every machine.
// Sources: surface nets after Gibson 1998; ellipsoid and round-cone distances are the usual closed
// forms (the ellipsoid's is a bound, exact to first order at the surface).
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace pelt {

struct BuiltinCharacterOptions {
  uint64_t seed = 0;    // 0: the standard monster; others vary the proportions
  float detail = 1.0f;  // 0.25 .. 4: vertices grow with its square; 1 is about 4,000
  bool tiny = false;    // at most 200 vertices, for tests
};

namespace builtin {

enum Material : uint8_t { kHead, kBrow, kBody, kArm, kLeg, kTail, kEye, kMaterialCount };
inline constexpr const char* kMaterialNames[kMaterialCount] = {"head", "brow", "body", "arm",
                                                               "leg",  "tail", "eye"};

enum Joint : uint8_t {
  kRoot,
  kHips,
  kSpine,
  kChest,
  kNeck,
  kHeadJoint,
  kBrowL,
  kBrowR,
  kShoulderL,
  kElbowL,
  kHandL,
  kShoulderR,
  kElbowR,
  kHandR,
  kThighL,
  kShinL,
  kFootL,
  kThighR,
  kShinR,
  kFootR,
  kTail1,
  kTail2,
  kTail3,
  kTail4,
  kJointCount
};

struct JointPlace {
  const char* name;
  int parent;
  glm::dvec3 position;  // world, m; all rest rotations are the identity
};

// One ellipsoid (radius_b < 0: `b` holds its three radii) or round cone from a to b.
struct Primitive {
  glm::dvec3 a, b;
  double radius_a, radius_b;
  Joint joint;
  Material material;
  uint8_t chart;
  double blend;            // width over which it melts into the rest, m
  glm::dvec3 centre{0.0};  // of a sphere around it
  double bound = 0.0;      // its radius, m
};

// Cylindrical UVs about an axis: u the angle from `front`, v along the axis.
struct Chart {
  glm::dvec3 origin, axis, front;
  double length;  // of v's unit, m
};

// y up, facing +z, its left at +x, feet on y = 0.
struct Shape {
  std::array<JointPlace, kJointCount> joints;
  std::vector<Primitive> primitives;
  std::vector<Chart> charts;
};

struct ShapeMesh {
  std::vector<glm::vec3> position, normal;
  std::vector<glm::vec4> tangent;
  std::vector<glm::vec2> uv;
  std::vector<std::array<uint8_t, 4>> joints;
  std::vector<glm::vec4> weights;
  std::vector<std::array<uint32_t, 3>> triangles[kMaterialCount];
};

Shape DesignShape(const BuiltinCharacterOptions& options);
ShapeMesh MeshShape(const Shape& shape, const BuiltinCharacterOptions& options);

}  // namespace builtin
}  // namespace pelt
