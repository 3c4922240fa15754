// A solver driven over poses, its points and velocities read back in double.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "bench/accuracy/strand_solver.hpp"

namespace pelt::accuracy {

using LinkDirections = std::array<Double3, kMaxLinks>;

class SolverRun {
 public:
  // Strands at rest with link directions `start` in `pose`.
  SolverRun(const SolverFactory& factory, const ChainMaterial& material, double frame_seconds,
            std::vector<Strand> strands, std::span<const LinkDirections> start,
            const BodyPose& pose);
  // False where the factory makes no solver for the material: nothing else may be called.
  bool valid() const { return solver_ != nullptr; }
  void SetFrameTime(double seconds) { solver_->SetFrameTime(seconds); }
  void Step(const BodyPose& pose);
  void Step(std::span<const BodyPose> poses);  // one for each strand
  // Point i (0: the first free one), relative to the root, m, and its velocity, world, m/s.
  Double3 Point(size_t strand, int i) const { return At(points_, strand, i); }
  Double3 Velocity(size_t strand, int i) const { return At(velocities_, strand, i); }
  size_t strands() const { return strands_.size(); }

 private:
  void StepFrame();
  Double3 At(const std::vector<float>& values, size_t strand, int i) const;

  std::vector<Strand> strands_;
  int links_;
  FrameBuffer frame_;
  std::unique_ptr<StrandSolver> solver_;
  std::vector<float> points_, velocities_;  // [point][axis][lane]
};

}  // namespace pelt::accuracy
