// A built-in character's body: an implicit surface made of ellipsoids and round cones blended
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

enum class BuiltinBody : uint8_t { kMonster, kScorpion };

struct BuiltinCharacterOptions {
  BuiltinBody body = BuiltinBody::kMonster;
  uint64_t seed = 0;    // 0: the standard one; others vary a monster's proportions
  float detail = 1.0f;  // 0.25 .. 4: vertices grow with its square; 1 is about 4,000
  bool tiny = false;    // at most 200 vertices, for tests
};

namespace builtin {

struct JointPlace {
  const char* name;
  int parent;
  glm::dvec3 position;  // world, m; all rest rotations are the identity
};

// One ellipsoid (radius_b < 0: `b` holds its three radii) or round cone from a to b.
struct Primitive {
  glm::dvec3 a, b;
  double radius_a, radius_b;
  uint8_t joint, material, chart;
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
  const char* name;
  double cell_m;                   // of the grid it is meshed on, at detail 1
  std::vector<JointPlace> joints;  // parents before children
  uint8_t carrier;                 // the joint that a clip also shifts
  std::vector<const char*> materials;
  std::vector<Primitive> primitives;
  std::vector<Chart> charts;
};

Primitive MakeEllipsoid(const glm::dvec3& centre, const glm::dvec3& radii, uint8_t joint,
                        uint8_t material, uint8_t chart, double blend);
Primitive MakeCone(const glm::dvec3& a, const glm::dvec3& b, double radius_a, double radius_b,
                   uint8_t joint, uint8_t material, uint8_t chart, double blend);
// From `from`, v = 0, to `to`, v = 1.
Chart MakeChart(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& front);
inline glm::dvec3 Mirror(const glm::dvec3& p) { return {-p.x, p.y, p.z}; }

struct ShapeMesh {
  std::vector<glm::vec3> position, normal;
  std::vector<glm::vec4> tangent;
  std::vector<glm::vec2> uv;
  std::vector<std::array<uint8_t, 4>> joints;
  std::vector<glm::vec4> weights;
  std::vector<std::vector<std::array<uint32_t, 3>>> triangles;  // of each material
};

ShapeMesh MeshShape(const Shape& shape, const BuiltinCharacterOptions& options);

// The bodies there are. What each has is said in builtin_character.hpp.
Shape DesignMonster(const BuiltinCharacterOptions& options);
Shape DesignScorpion();

}  // namespace builtin
}  // namespace pelt
