// What the artist's attributes make of one strand: length, width, colours, strength, and the rest
// shape that its chain is built from.
//
// An attribute is value * map * (1 + randomise * u), clamped to its range; u belongs to (layer
// seed, attribute, strand), so changing one attribute moves no other.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "core/character/character.hpp"
#include "core/groom/flow_map.hpp"
#include "core/groom/fur_setup.hpp"
#include "core/groom/growth.hpp"
#include "core/groom/scatter.hpp"
#include "core/groom/surface_colour.hpp"

namespace pelt {

// Which way the fur lies: comb vectors; outside their reach a flow map, a vector, a joint's direction, or azimuth
// and elevation in tangent space.
//
// A comb vector weighs (1 - (distance / reach)^2)^2, less where its own surface faces another way
// than the strand's, so that a vector on one side of an arm does not comb the other. Vectors give
// the direction as drawn; a joint gives only the heading along the surface, and the layer's
// elevation raises it. The two are blended by how much of the vectors' weight is left.

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

  // Unit direction in the root frame of the strand there. Angles in degrees. `said`: unit, in place of joint and
  // angles; null: none.
  glm::dvec3 Direction(const glm::vec3& position, const RootFrame& frame, double azimuth,
                       double elevation, const glm::dvec3* said = nullptr) const;

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

// Strands shorter than this (a length map gone black) would have no direction; m.
inline constexpr float kShortestStrand = 1e-4f;

// The rest pose stands upright.
inline const glm::dvec3 kRestDown{0.0, -1.0, 0.0};

struct RestShape {
  glm::dvec3 offset[kMostStrandPoints - 1];  // of points 1.. from the root, in its root frame, m
};

struct GroomedStrand {
  SurfacePoint place;
  glm::vec3 position;  // of the root: rest pose, m
  RootFrame frame;     // rest pose
  RestShape rest;
  float length;    // m
  float strength;  // 0..1
  StrandTraits traits;
  float stored[kStrandAttributes.size()];  // of those that a StrandBlock stores
  uint32_t base_colour, tip_colour;
  uint8_t film_strip;
};

// A strand of `length` with `points` points and equal segments that leaves the root along the unit
// `direction` (root frame) and bends by `curl` radians per metre, towards the surface where it is
// positive, in a plane that turns by `twist` radians per metre about the strand. At a share t of its length it bends
// by so much times profile.x + profile.y t + profile.z t^2.
RestShape MakeRestShape(const glm::dvec3& direction, double length, double curl, double twist,
                        uint32_t points, const glm::dvec3& profile = {1.0, 0.0, 0.0});

// A strand of `length` with `points` points and equal segments that go the way of those through
// `places`. A segment that is nothing there goes on as the one before it, the first one along
// `first`, which is unit.
RestShape MakeEqualSegments(const RestShape& places, double length, uint32_t points,
                            const glm::dvec3& first);

// How a strand lies as a whole.
struct StrandLie {
  glm::dvec3 normal;   // of the skin; unit, rest pose
  glm::dvec3 towards;  // the tip, from the root; unit, rest pose, above the skin
  double length;       // m, along the strand
};

// Whether it does not say all colours itself.
bool TakesSurfaceColour(const LayerSetup&);

class AttributeMaker {
 public:
  // `surface` is the character's; made here if it is null and needed.
  AttributeMaker(const Character&, const RestGeometry&, const FurSetup&, const LayerSetup&,
                 std::shared_ptr<const SurfaceColour> surface = nullptr);

  // `strand` is the place in the layer's progressive order.
  GroomedStrand Groom(const ScatterPoint&, uint32_t strand) const;
  // How a strand there would lie if nothing of it was drawn at random.
  StrandLie MeanLie(const SurfacePoint&) const;
  // How far the skin is raised along its normal at a mesh vertex, m.
  float LiftVertex(uint32_t vertex) const;
  const LayerSetup& layer() const { return layer_; }

 private:
  const Mesh& mesh_;
  const RestGeometry& rest_;
  const LayerSetup& layer_;
  Comb comb_;
  PaintedFlow flow_;
  std::shared_ptr<const SurfaceColour> surface_;  // if the layer takes colours from it
  std::vector<std::array<Wrap, 2>> vertex_wrap_;  // of the material there, if LiftVertex needs it

  struct Shaped {
    RestShape rest;
    double length;  // m
  };
  // Of a strand there, of the unit direction; value(&LayerSetup::curl) is an attribute's value.
  template <class Value>
  Shaped Shape(const SurfacePoint& at, const glm::dvec3& direction, const Value& value) const;
  // As comb and attributes have it, without what is drawn at random; in the root frame.
  template <class Value>
  glm::dvec3 CombedDirection(const SurfacePoint& at, const glm::vec3& position,
                             const RootFrame& frame, const Value& value) const;
  // The colour that the setup says, or the surface's at the root, this much darker in linear light.
  uint32_t ColourAt(const SurfacePoint& place, uint32_t said, float darker) const;
};

}  // namespace pelt
