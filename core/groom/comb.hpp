// Which way the fur lies: comb vectors, a joint's direction outside their reach, or azimuth and
// elevation in tangent space.
//
// A comb vector weighs (1 - (distance / reach)^2)^2, less where its own surface faces another way
// than the strand's, so that a vector on one side of an arm does not comb the other. Vectors give
// the direction as drawn; a joint gives only the heading along the surface, and the layer's
// elevation raises it. The two are blended by how much of the vectors' weight is left.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "core/character/character.hpp"
#include "core/groom/fur_setup.hpp"

namespace pelt {

// Orthonormal axes of a strand's root or of a mesh vertex: what rest shapes are given in.
struct RootFrame {
  glm::dvec3 tangent, bitangent, normal;  // bitangent = normal x tangent

  glm::dvec3 ToFrame(const glm::dvec3& v) const {
    return {glm::dot(v, tangent), glm::dot(v, bitangent), glm::dot(v, normal)};
  }
  glm::dvec3 FromFrame(const glm::dvec3& v) const {
    return tangent * v.x + bitangent * v.y + normal * v.z;
  }
};

// The tangent is made orthogonal to the normal; where it cannot be, another is chosen.
RootFrame MakeRootFrame(const glm::dvec3& normal, const glm::dvec3& tangent);

class Comb {
 public:
  // Throws pelt::Error when comb_joint is unknown.
  Comb(const Character&, const RestGeometry&, const FurSetup&, const LayerSetup&);

  // Unit direction in the root frame of the strand there. Angles in degrees.
  glm::dvec3 Direction(const glm::vec3& position, const RootFrame& frame, double azimuth,
                       double elevation) const;

 private:
  struct Vector {
    glm::dvec3 position, direction, normal;
    double reach;
  };
  std::vector<Vector> vectors_;
  double normal_weight_;
  bool has_joint_ = false;
  glm::dvec3 joint_direction_{0.0};  // rest pose, unit
};

}  // namespace pelt
