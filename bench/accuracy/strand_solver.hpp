// What is plugged into the yardstick: a solver that steps a batch of strands once per frame, from
// what a game knows: root positions, rest directions and wind at the frame's time, in float; and
// where its animation says so, how fast the body moves then.
//
// Invariants:
//  - Points come out relative to the root of the present frame, so float error is that of a strand,
//    not of its place in the world.
//  - A solver sees each frame's input once, when its time has come; before the first frame the body
//    stood still.
//  - Rows are padded to kBatchLanes with copies of strand 0: no solver needs a remainder loop.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "bench/accuracy/chain_problem.hpp"
#include "core/chunk.hpp"

namespace pelt::accuracy {

// Two groups of the widest vectors: solvers may work on two at once (core/kernels/unrolled.hpp).
inline constexpr uint32_t kBatchLanes = 2 * kLaneGroup;

// One frame's input, as rows of `lanes` floats: rest[link][axis] + lane and so on.
struct FrameRows {
  uint32_t lanes;                   // a multiple of kBatchLanes
  const float* position[3];         // of the root, m
  const float* motion[3];           // of the root since the last frame, m: difference of positions
  const float* rest[kMaxLinks][3];  // unit rest directions, world
  const float* wind[3];             // m/s
  const float* velocity[3];         // of the root, m/s: for solvers that take it
  const float* spin[3];             // of the body, rad/s, world
};

// Owns a frame's rows.
class FrameBuffer {
 public:
  FrameBuffer(int links, size_t strands);
  // The strands' roots in the pose; motion is 0 the first time.
  void Sample(const BodyPose& pose, std::span<const Strand> strands);
  // A pose for each strand.
  void Sample(std::span<const BodyPose> poses, std::span<const Strand> strands);
  void SetDirections(std::span<const std::array<Double3, kMaxLinks>> directions);
  const FrameRows& rows() const { return rows_; }
  size_t lanes() const { return rows_.lanes; }

 private:
  void SampleLane(const BodyPose& pose, const Strand& strand, size_t lane);
  float* Row(size_t index) { return values_.data() + index * rows_.lanes; }
  void Store(size_t row, size_t lane, Double3 v);

  int links_;
  size_t strands_;
  bool first_ = true;
  std::vector<float> values_;
  FrameRows rows_{};
};

class StrandSolver {
 public:
  virtual ~StrandSolver();
  // Strands at rest in the world with link directions `start` (rows as FrameRows::rest).
  virtual void Start(const FrameRows& frame, const float* const (*start)[3]) = 0;
  // Puts a frame's input into the solver's own form, if it has one. Not timed.
  virtual void Prepare(const FrameRows& frame);
  // The frame that ends at the input's time; Prepare(frame) was called.
  virtual void Step(const FrameRows& frame) = 0;
  // The length of the frames to come, s.
  virtual void SetFrameTime(double seconds) = 0;
  // Point i (0: the first free one) of all lanes, relative to the root, m: rows [axis].
  virtual void Points(int i, float* const (&rows)[3]) const = 0;
  // Their velocities as the solver keeps them, world, m/s.
  virtual void Velocities(int i, float* const (&rows)[3]) const = 0;
};

// A solver set up for strands of one material at a frame time.
struct SolverSetup {
  ChainMaterial material;
  double frame_seconds = 1.0 / 60.0;
  uint32_t lanes = kBatchLanes;
};
using SolverFactory = std::function<std::unique_ptr<StrandSolver>(const SolverSetup&)>;

}  // namespace pelt::accuracy
