#include "bench/accuracy/scene_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pelt::accuracy {
namespace {

uint32_t CountPoints(const FurScene& scene, uint32_t chunk) {
  return StrandPointsOf(scene.shape().layer_kind[scene.shape().chunk_layer[chunk]]);
}

float LengthOf(const FurScene& scene, uint32_t chunk, uint32_t lane) {
  return WithPoints(CountPoints(scene, chunk), [&]<uint32_t kPoints> {
    return scene.memory().Of<ChainStreams<kPoints, false>::kRest>(chunk)->segment_length[lane];
  });
}

uint32_t FindNearest(const RootBlock& roots, uint32_t lane, uint32_t live) {
  uint32_t nearest = 0;
  float least = std::numeric_limits<float>::infinity();
  for (uint32_t other = 0; other < live; ++other) {
    float distance2 = 0.0f;
    for (int k = 0; k < 3; ++k) {
      const float d = roots.position[k][lane] - roots.position[k][other];
      distance2 += d * d;
    }
    if (distance2 < least) {
      least = distance2;
      nearest = other;
    }
  }
  return nearest;
}

}  // namespace

ScenePointsLayout::ScenePointsLayout(const FurScene& scene) {
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    const uint32_t live = scene.memory().Of<&Streams::chunk_state>(c)->live_strands;
    const bool shells = scene.shape().layer_kind[scene.shape().chunk_layer[c]] & kLayerShells;
    if (live == 0 || shells) continue;  // nothing is simulated of shells
    const uint32_t free_points = CountPoints(scene, c) - 1;
    pieces_.push_back({c, live, free_points, size_});
    size_ += size_t(live) * free_points * 3;
    strands_ += live;
  }
}

const float* ScenePointsLayout::PointsOf(const FurScene& scene, const Piece& piece) {
  return WithPoints(piece.free_points + 1, [&]<uint32_t kPoints>() -> const float* {
    return scene.memory().Of<ChainStreams<kPoints, false>::kPosition>(piece.chunk)->position[0][0];
  });
}

void ScenePointsLayout::Read(const FurScene& scene, ScenePoints& points) const {
  points.resize(size_);
  for (const Piece& piece : pieces_) {
    const float* row = PointsOf(scene, piece);
    for (uint32_t r = 0; r < piece.free_points * 3; ++r)
      std::copy_n(row + size_t(r) * kStrandsPerChunk, piece.strands,
                  &points[piece.first + size_t(r) * piece.strands]);
  }
}

void ScenePointsLayout::Read(const FurScene& scene, const FurScene& rigid_scene,
                             const ScenePoints& rigid, ScenePoints& points) const {
  Read(scene, points);
  for (const Piece& piece : pieces_) {
    const uint32_t live = scene.memory().Of<&Streams::chunk_state>(piece.chunk)->live_strands;
    if (live < piece.strands) Carry(piece, live, rigid_scene, rigid, points);
  }
}

void ScenePointsLayout::Carry(const Piece& piece, uint32_t live, const FurScene& rigid_scene,
                              const ScenePoints& rigid, ScenePoints& points) const {
  const RootBlock& roots = *rigid_scene.memory().Of<&Streams::roots>(piece.chunk);
  for (uint32_t lane = live; lane < piece.strands; ++lane) {
    // None lives: the strand lies on its groom.
    const uint32_t by = live > 0 ? FindNearest(roots, lane, live) : lane;
    const float length = LengthOf(rigid_scene, piece.chunk, by);
    const float scale =
        live > 0 && length > 0.0f ? LengthOf(rigid_scene, piece.chunk, lane) / length : 0.0f;
    for (uint32_t r = 0; r < piece.free_points * 3; ++r) {
      const size_t row = piece.first + size_t(r) * piece.strands;
      points[row + lane] = rigid[row + lane] + scale * (points[row + by] - rigid[row + by]);
    }
  }
}

void ErrorSum::Add(const ScenePoints& points, const ScenePoints& reference,
                   const ScenePoints& rigid) {
  for (size_t i = 0; i < reference.size(); ++i) {
    const double a = double(points[i]) - double(reference[i]);
    const double b = double(reference[i]) - double(rigid[i]);
    off += a * a;
    moved += b * b;
  }
  values += reference.size();
}

double ErrorSum::Share() const { return std::sqrt(off / moved); }
double ErrorSum::OffRms() const { return std::sqrt(3.0 * off / double(values)); }
double ErrorSum::MovedRms() const { return std::sqrt(3.0 * moved / double(values)); }

}  // namespace pelt::accuracy
