// A built-in character's body and how it moves.
//
// Body: an implicit surface made of ellipsoids and round cones blended together, turned into one closed
// mesh. Skin weights, materials and UVs all follow from the same primitives, so they fit each other by
// construction.
//
// Clips: rotations of its joints as functions of time, sampled into keys.
//
// Invariant: only IEEE arithmetic, exact:: functions and seeded numbers; the same options give the
// same bytes on every machine.
// Sources: surface nets after Gibson 1998; ellipsoid and round-cone distances are the usual closed
// forms (the ellipsoid's is a bound, exact to first order at the surface).
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
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

// ---- Clips --------------------------------------------------------------------------------------

inline constexpr size_t kMostJoints = 40;

// Turns about x (nod), y (turn) and z (tilt), radians, z first; and the carrier's shift, m.
struct Motion {
  std::array<glm::dvec3, kMostJoints> turn{};
  glm::dvec3 shift{0.0};
};

struct ClipPlan {
  const char* name;
  Motion (*motion)(double time_s);
  bool loops;         // its ends agree to the last bit
  double duration_s;  // with `steps` keys at equal times behind the first
  int steps;
  double held_s = 0.0;  // a last key here, if it is later
};

struct ShapeTrack {
  size_t joint;
  bool rotation;                  // else translation (local, m)
  std::vector<glm::vec4> values;  // in tangent, value, out tangent for each time
};

struct ShapeClip {
  std::string name;
  std::vector<float> time_s;
  std::vector<ShapeTrack> tracks;
};

std::vector<ShapeClip> MakeClips(const Shape& shape, std::span<const ClipPlan> plans);

// Of the bodies there are.
std::span<const ClipPlan> MonsterClips();
std::span<const ClipPlan> ScorpionClips();

// sin of so many turns.
double Wave(double turns);
// 0 to 1 as s goes from 0 to 1, at rest at both ends; constant outside.
double Ease(double s);

}  // namespace builtin
}  // namespace pelt
