#include "bench/accuracy/strand_solver.hpp"

namespace pelt::accuracy {

// Position, motion, wind, velocity, spin, rest directions, in this order.
FrameBuffer::FrameBuffer(int links, size_t strands) : links_(links), strands_(strands) {
  rows_.lanes = uint32_t((strands + kBatchLanes - 1) / kBatchLanes * kBatchLanes);
  values_.resize(rows_.lanes * size_t(15 + 3 * links));
  for (int k = 0; k < 3; ++k) {
    rows_.position[k] = Row(size_t(k));
    rows_.motion[k] = Row(size_t(3 + k));
    rows_.wind[k] = Row(size_t(6 + k));
    rows_.velocity[k] = Row(size_t(9 + k));
    rows_.spin[k] = Row(size_t(12 + k));
    for (int i = 0; i < links; ++i) rows_.rest[i][k] = Row(size_t(15 + 3 * i + k));
  }
}

void FrameBuffer::Store(size_t row, size_t lane, Double3 v) {
  Row(row)[lane] = float(v.x);
  Row(row + 1)[lane] = float(v.y);
  Row(row + 2)[lane] = float(v.z);
}

void FrameBuffer::SampleLane(const BodyPose& pose, const Strand& strand, size_t lane) {
  float old[3];
  for (size_t k = 0; k < 3; ++k) old[k] = Row(k)[lane];
  Store(0, lane, pose.Place(strand.root));
  for (size_t k = 0; k < 3; ++k) Row(3 + k)[lane] = first_ ? 0.0f : Row(k)[lane] - old[k];
  Store(6, lane, pose.wind);
  Store(9, lane, pose.PlaceRate(strand.root));
  Store(12, lane, SpinOf(pose));
  for (int i = 0; i < links_; ++i)
    Store(size_t(15 + 3 * i), lane, pose.Turn(strand.rest[size_t(i)]));
}

void FrameBuffer::Sample(const BodyPose& pose, std::span<const Strand> strands) {
  for (size_t lane = 0; lane < rows_.lanes; ++lane)
    SampleLane(pose, strands[lane < strands_ ? lane : 0], lane);
  first_ = false;
}

void FrameBuffer::Sample(std::span<const BodyPose> poses, std::span<const Strand> strands) {
  for (size_t lane = 0; lane < rows_.lanes; ++lane) {
    const size_t strand = lane < strands_ ? lane : 0;
    SampleLane(poses[strand], strands[strand], lane);
  }
  first_ = false;
}

void FrameBuffer::SetDirections(std::span<const std::array<Double3, kMaxLinks>> directions) {
  for (size_t lane = 0; lane < rows_.lanes; ++lane)
    for (int i = 0; i < links_; ++i)
      Store(size_t(15 + 3 * i), lane, directions[lane < strands_ ? lane : 0][size_t(i)]);
}

StrandSolver::~StrandSolver() = default;
void StrandSolver::Prepare(const FrameRows&) {}

}  // namespace pelt::accuracy
