#include "bench/accuracy/solver_run.hpp"

namespace pelt::accuracy {

SolverRun::SolverRun(const SolverFactory& factory, const ChainMaterial& material,
                     double frame_seconds, std::vector<Strand> strands,
                     std::span<const LinkDirections> start, const BodyPose& pose)
    : strands_(std::move(strands)), links_(material.links), frame_(links_, strands_.size()) {
  solver_ = factory({material, frame_seconds, uint32_t(frame_.lanes())});
  if (!solver_) return;
  points_.resize(size_t(links_) * 3 * frame_.lanes());
  velocities_.resize(points_.size());
  FrameBuffer directions(links_, strands_.size());
  directions.SetDirections(start);
  frame_.Sample(pose, strands_);
  solver_->Start(frame_.rows(), directions.rows().rest);
}

void SolverRun::Step(const BodyPose& pose) {
  frame_.Sample(pose, strands_);
  StepFrame();
}

void SolverRun::Step(std::span<const BodyPose> poses) {
  frame_.Sample(poses, strands_);
  StepFrame();
}

void SolverRun::StepFrame() {
  solver_->Prepare(frame_.rows());
  solver_->Step(frame_.rows());
  const size_t lanes = frame_.lanes();
  for (int i = 0; i < links_; ++i) {
    const size_t first = size_t(3 * i) * lanes;
    float* const points[3] = {&points_[first], &points_[first + lanes],
                              &points_[first + 2 * lanes]};
    solver_->Points(i, points);
    float* const velocities[3] = {&velocities_[first], &velocities_[first + lanes],
                                  &velocities_[first + 2 * lanes]};
    solver_->Velocities(i, velocities);
  }
}

Double3 SolverRun::At(const std::vector<float>& values, size_t strand, int i) const {
  const size_t lanes = frame_.lanes(), first = size_t(3 * i) * lanes + strand;
  return {values[first], values[first + lanes], values[first + 2 * lanes]};
}

}  // namespace pelt::accuracy
