// Scatter: where the strands of a layer stand. Density-driven, blue-noise and progressive: every
// prefix of the result covers the surface evenly, in proportion to the wanted density.
//
// Candidates are drawn at three times the density by systematic sampling over the area (one
// jittered low-discrepancy sequence through all triangles), thinned by the masks, and handed to
// sample elimination. Deterministic from the layer's seed, on any machine.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/groom/growth.hpp"
#include "core/groom/patches.hpp"

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

// What CutChunks needs of scattered points.
std::vector<PatchStrand> ListPatchStrands(const Mesh&, std::span<const ScatterPoint>);

// ---- How even a scatter is ----------------------------------------------------------------------

// Nearest-neighbour distances over the distance of the densest packing.
//
// Source: Lagae and Dutre, "A Comparison of Methods for Generating Poisson Disk Distributions"
// (2008): relative radius rho = r / r_max, r half the distance to the nearest neighbour, r_max =
// sqrt(1 / (2 sqrt(3) density)). 1 everywhere is the hexagonal packing; plain random points have
// mean 0.465 and least near 0; good blue noise has mean 0.75 and least 0.6 and more. The density is
// the one wanted at the strand, so maps do not count as unevenness; neighbours whose normals
// disagree (the other side of an ear) are not neighbours.

// Of the relative radius over a set of strands.
struct SpacingStats {
  double mean = 0.0, least = 0.0;
  double variation = 0.0;  // standard deviation over mean
  uint64_t count = 0;
};

struct PrefixStats {
  double share = 1.0;
  SpacingStats layer;          // the first strands of the layer's progressive order
  SpacingStats every_chunk;    // the first lanes of every chunk together: what LOD draws
  SpacingStats inside_chunks;  // the same, each chunk measured alone; least is the mean of leasts
  // As many strands by plain rejection sampling, in random order, cut into chunks alike.
  SpacingStats plain_every_chunk;
  SpacingStats plain_inside_chunks;
};

struct LayerScatterStats {
  std::string name;
  uint32_t strand_count = 0, chunk_count = 0, patch_count = 0;
  double strand_fill = 0.0;                  // mean share of a chunk in use
  double vertex_fill = 0.0, row_fill = 0.0;  // and of a patch
  double rows_per_group = 0.0;               // joints that 16 vertices need
  double chunks_per_vertex = 0.0;            // that use it
  std::array<PrefixStats, 4> prefix;         // 1/8, 1/4, 1/2, 1
};

struct ScatterStats {
  std::vector<LayerScatterStats> layers;
};

// Nearest-neighbour statistics of points whose wanted spacing is radius * scale.
SpacingStats MeasureSpacing(std::span<const ScatterPoint> points, float scale);

// The baseline: `count` points accepted one by one at random.
std::vector<ScatterPoint> ScatterByRejection(const Character&, const RestGeometry&, const Growth&,
                                             uint32_t count, uint64_t seed);

LayerScatterStats MeasureLayerScatter(const Character&, const RestGeometry&, const LayerSetup&,
                                      const Growth&, std::span<const ScatterPoint> points,
                                      std::span<const ChunkPart> chunks,
                                      std::span<const VertexPatch> patches);

}  // namespace pelt
