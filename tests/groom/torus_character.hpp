// A small character for groom tests: a torus of two materials along a ring of joints, made with
// exact:: functions so that its bits are the same everywhere.
//
// Materials: "front" (z > 0) and "back". Joints: "root", then "ring_0" .. "ring_7" around it, each
// the child of the one before; a vertex follows the two that are nearest. Radii 0.3 m and 0.1 m,
// lying in the x-z plane.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/character/character.hpp"
#include "core/character/pose.hpp"
#include "core/exact_math.hpp"
#include "core/groom/attributes.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/fur_setup.hpp"
#include "core/groom/scatter.hpp"

namespace pelt::test {

inline constexpr uint32_t kRingJoints = 8;

struct TorusOptions {
  uint32_t around = 48, across = 16;
  bool uvs = true;
  float scale = 1.0f;  // file units: the unit scale that makes metres of it is its inverse
};

inline glm::vec3 TorusPoint(double u, double v, double tube) {
  const double ring = 0.3 + tube * exact::Cos(2 * exact::kPi * v);
  return {float(ring * exact::Cos(2 * exact::kPi * u)),
          float(tube * exact::Sin(2 * exact::kPi * v)),
          float(ring * exact::Sin(2 * exact::kPi * u))};
}

inline void AddTorusVertex(Mesh& mesh, const TorusOptions& options, uint32_t i, uint32_t j) {
  const double u = double(i) / options.around, v = double(j) / options.across;
  // The two sides of a seam lie on each other bit for bit.
  const double ring = double(i % options.around) / options.around;
  const double tube = double(j % options.across) / options.across;
  const glm::vec3 p = TorusPoint(ring, tube, 0.1), centre = TorusPoint(ring, tube, 0.0);
  mesh.position.push_back(p * options.scale);
  mesh.normal.push_back(glm::normalize(p - centre));
  mesh.tangent.push_back({float(-exact::Sin(2 * exact::kPi * ring)), 0.0f,
                          float(exact::Cos(2 * exact::kPi * ring)), 1.0f});
  if (options.uvs) mesh.uv.push_back({float(u), float(v)});
  const double at = ring * kRingJoints;
  const uint32_t joint = uint32_t(at) % kRingJoints;
  const float next = float(at - exact::Floor(at));
  const uint8_t first = uint8_t(1 + joint), second = uint8_t(1 + (joint + 1) % kRingJoints);
  if (next < 0.5f) {
    mesh.joints.push_back({first, second, 0, 0});
    mesh.weights.push_back({1.0f - next, next, 0.0f, 0.0f});
  } else {
    mesh.joints.push_back({second, first, 0, 0});
    mesh.weights.push_back({next, 1.0f - next, 0.0f, 0.0f});
  }
}

inline Character MakeTorus(const TorusOptions& options = {}) {
  Character character;
  character.name = "torus";
  Mesh& mesh = character.mesh;
  // A seam in both directions, so that texture coordinates do not wrap inside a triangle.
  for (uint32_t i = 0; i <= options.around; ++i) {
    for (uint32_t j = 0; j <= options.across; ++j) AddTorusVertex(mesh, options, i, j);
  }
  mesh.materials = {"front", "back"};
  const uint32_t row = options.across + 1;
  for (uint32_t i = 0; i < options.around; ++i) {
    for (uint32_t j = 0; j < options.across; ++j) {
      const uint32_t a = i * row + j, b = a + row;
      mesh.triangles.push_back({a, a + 1, b});
      mesh.triangles.push_back({b, a + 1, b + 1});
      const uint16_t material = i < options.around / 2 ? 0 : 1;
      mesh.triangle_material.insert(mesh.triangle_material.end(), {material, material});
    }
  }
  Skeleton& skeleton = character.skeleton;
  for (uint32_t j = 0; j <= kRingJoints; ++j) {
    skeleton.name.push_back(j == 0 ? "root" : "ring_" + std::to_string(j - 1));
    skeleton.parent.push_back(int32_t(j) - 1);
    const glm::vec3 place = j == 0
                                ? glm::vec3(0.0f)
                                : TorusPoint(double(j - 1) / kRingJoints, 0.0, 0.0) * options.scale;
    const glm::vec3 before =
        j < 2 ? glm::vec3(0.0f) : TorusPoint(double(j - 2) / kRingJoints, 0.0, 0.0) * options.scale;
    JointPose pose;
    pose.translation = place - before;
    skeleton.rest.push_back(pose);
    glm::mat4 inverse(1.0f);
    inverse[3] = glm::vec4(-place, 1.0f);
    skeleton.inverse_bind.push_back(inverse);
  }
  return character;
}

inline Groom BakeTorus(const std::vector<LayerSetup>& layers, const TorusOptions& options = {}) {
  const Character character = MakeTorus(options);
  const float unit = 1.0f / options.scale;
  FurSetup setup;
  setup.path = "torus.toml";
  setup.layers = layers;
  return BakeGroom(character, ComputeRestGeometry(character, unit), setup, unit);
}

inline Groom BakeTorus(const LayerSetup& layer, const TorusOptions& options = {}) {
  return BakeTorus(std::vector{layer}, options);
}

inline double DegreesBetween(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / M_PI;
}

// Area of the rest pose, m^2.
inline double AreaOf(const Character& character, const RestGeometry& rest) {
  double area = 0.0;
  for (const auto& v : character.mesh.triangles) {
    const glm::dvec3 a = rest.position[v[0]], b = rest.position[v[1]], c = rest.position[v[2]];
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return area;
}

// A torus with a layer: strands stand where Scatter() put them and are made as the layer is now.
struct CoatedTorus {
  Character character = MakeTorus();
  RestGeometry rest = ComputeRestGeometry(character, 1.0f);
  FurSetup setup;
  LayerSetup layer;
  std::vector<ScatterPoint> points;

  void Scatter() {
    points = ScatterLayer(character, rest, setup, layer, Growth(character, rest, setup, layer));
  }
  AttributeMaker Maker() const { return AttributeMaker(character, rest, setup, layer); }
  std::vector<GroomedStrand> Groom() const {
    const AttributeMaker maker = Maker();
    std::vector<GroomedStrand> strands;
    for (uint32_t i = 0; i < points.size(); ++i) strands.push_back(maker.Groom(points[i], i));
    return strands;
  }
};

// A 64 x 64 picture whose four channels are functions of the place.
template <class F>
MapChannel MakeMap(F value, int channel = 0) {
  auto map = std::make_shared<ControlMap>();
  map->width = map->height = 64;
  map->rgba.resize(64 * 64 * 4);
  for (uint32_t y = 0; y < 64; ++y) {
    for (uint32_t x = 0; x < 64; ++x) {
      for (uint32_t c = 0; c < 4; ++c) {
        map->rgba[(y * 64 + x) * 4 + c] =
            uint8_t(255.0f * value((float(x) + 0.5f) / 64, (float(y) + 0.5f) / 64) + 0.5f);
      }
    }
  }
  return {map, channel};
}

}  // namespace pelt::test
