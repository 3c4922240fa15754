// Scatter: where the strands of a layer stand. Density-driven, blue-noise and progressive: every
// prefix of the result covers the surface evenly, in proportion to the wanted density.
//
// Candidates are drawn at three times the density by systematic sampling over the area (one
// jittered low-discrepancy sequence through all triangles), thinned by the masks, and handed to
// sample elimination. Deterministic from the layer's seed, on any machine.
#pragma once

#include <cstdint>
#include <vector>

#include "core/groom/growth.hpp"

namespace pelt {

struct ScatterPoint {
  SurfacePoint place;
  glm::vec3 position;  // rest pose, m
  glm::vec3 normal;    // unit
  float radius;        // DensestPackingRadius of the density that the layer reaches here, m
};

// What became of a layer's density.
struct ScatterDensity {
  double asked = 0.0;      // strands that the density alone would grow, about
  uint32_t grown = 0;      // what max_strands left of them
  float spacing_m = 0.0f;  // between the strands that were grown, the median
};

// Most strands of a layer: beyond it the density is a slip.
inline constexpr uint32_t kMostStrandsOfLayer = 1u << 22;

// Strands of the layer in progressive order. max_strands (0: no limit) lowers the density
// everywhere alike. Throws pelt::Error when no strand is left, naming what removed them, or when
// there are more than kMostStrandsOfLayer.
std::vector<ScatterPoint> ScatterLayer(const Character&, const RestGeometry&, const FurSetup&,
                                       const LayerSetup&, const Growth&,
                                       ScatterDensity* density = nullptr);

// Unit normal at a place of the surface.
glm::vec3 InterpolateNormal(const Mesh&, const RestGeometry&, const SurfacePoint&);

}  // namespace pelt
