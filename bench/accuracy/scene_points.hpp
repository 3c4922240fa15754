// The strands' points of a scene after a frame, as one row of numbers that can be compared between
// runs that were simulated differently.
//
// Idea: a run that skips something still shows a point for every strand, every frame. What was not
// simulated is carried: a strand that LOD dropped takes the secondary motion (point - rigid point)
// of the nearest strand of its chunk that lives, as a share of its length, as strands of a
// vertex-chain layer take that of their chains; a frame that was not simulated takes that of the
// frame before.
//
// Invariant: a row has the same layout for every run of a scene: chunk by chunk, point by point, x
// y z, lane by lane. It does not depend on how many strands live.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "jobs/scene.hpp"

namespace pelt::accuracy {

using ScenePoints = std::vector<float>;  // m, world

class ScenePointsLayout {
 public:
  // After a frame that `scene` ran without LOD: chunks of layers that do nothing are left out.
  explicit ScenePointsLayout(const FurScene& scene);

  size_t size() const { return size_; }
  uint64_t strands() const { return strands_; }
  // The free points of a chunk's strands in a row.
  struct Piece {
    uint32_t chunk, strands, free_points;
    size_t first;
    size_t PlaceOfTip(uint32_t axis, uint32_t lane) const {
      return first + size_t((free_points - 1) * 3 + axis) * strands + lane;
    }
  };
  std::span<const Piece> pieces() const { return pieces_; }

  // Points of all strands of `scene` after a frame. Those it dropped are carried by `rigid`, the
  // points of the same frame without simulation in the scene `rigid_scene`.
  void Read(const FurScene& scene, const FurScene& rigid_scene, const ScenePoints& rigid,
            ScenePoints& points) const;
  // The same of a scene in which every strand lives.
  void Read(const FurScene& scene, ScenePoints& points) const;

 private:
  static const float* PointsOf(const FurScene& scene, const Piece& piece);
  void Carry(const Piece& piece, uint32_t live, const FurScene& rigid_scene,
             const ScenePoints& rigid, ScenePoints& points) const;

  std::vector<Piece> pieces_;
  size_t size_ = 0;
  uint64_t strands_ = 0;
};

// Sums over the points of many frames, for RMS(x - reference) / RMS(reference - rigid).
struct ErrorSum {
  double off = 0.0, moved = 0.0;  // m^2
  uint64_t values = 0;

  void Add(const ScenePoints& points, const ScenePoints& reference, const ScenePoints& rigid);
  double Share() const;     // 1: 100 %
  double OffRms() const;    // m
  double MovedRms() const;  // m
};

}  // namespace pelt::accuracy
