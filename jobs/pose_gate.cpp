#include "jobs/pose_gate.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/kernels/frame_table.hpp"
#include "jobs/input_check.hpp"
#include "jobs/origins.hpp"

namespace pelt {
namespace {

struct PoseRow {
  const char* what;
  const float (*lanes)[kJointsPerCharacter];
  size_t rows;
};
template <size_t kRows>
PoseRow RowsOf(const char* what, const float (&rows)[4][kRows][kJointsPerCharacter]) {
  return {what, rows[0], 4 * kRows};
}

template <size_t kRows>
PoseRow RowsOf(const char* what, const float (&rows)[kRows][kJointsPerCharacter]) {
  return {what, rows, kRows};
}

// The first row of which a value cannot be used, and its joint.
RefusedPose FindBadRow(std::span<const PoseRow> all, uint32_t joint_count, uint32_t character) {
  for (const PoseRow& row : all)
    for (size_t r = 0; r < row.rows; ++r) {
      if (AreUsable(row.lanes[r], joint_count)) continue;
      uint32_t joint = 0;
      while (AreUsable(row.lanes[r] + joint, 1)) ++joint;
      return {character, joint, row.what};
    }
  return {character, kNoJoint, nullptr};
}

// Any value that cannot be used; `what` null: none.
RefusedPose FindBadValue(const PoseBlock& pose, uint32_t character) {
  if (!AreUsable(pose.root, 12))
    return {character, kNoJoint, "its root placement is not finite, or beyond 1e6"};
  const PoseRow all[] = {
      RowsOf("its translation keys are not finite, or beyond 1e6", pose.translation_key),
      RowsOf("its rotation keys are not finite, or beyond 1e6", pose.rotation_key),
      RowsOf("its scale keys are not finite, or beyond 1e6", pose.scale_key),
      RowsOf("its translation weights are not finite, or beyond 1e6", pose.translation_weight),
      RowsOf("its rotation weights are not finite, or beyond 1e6", pose.rotation_weight),
      RowsOf("its scale weights are not finite, or beyond 1e6", pose.scale_weight)};
  return FindBadRow(all, pose.joint_count, character);
}

RefusedPose FindBadRate(const PoseRateBlock& rates, uint32_t joint_count, uint32_t character) {
  if (!AreUsable(rates.root, 12))
    return {character, kNoJoint, "its root placement's velocity is not finite, or beyond 1e6"};
  const PoseRow all[] = {RowsOf("its velocity is not finite, or beyond 1e6", rates.translation),
                         RowsOf("its spin is not finite, or beyond 1e6", rates.spin),
                         RowsOf("its scale's velocity is not finite, or beyond 1e6", rates.scale)};
  return FindBadRow(all, joint_count, character);
}

double Square(float a) { return double(a) * double(a); }

// A bound on where a matrix takes anything. NaN passes for too far.
PoseGate::Reach ReachOf(const float (&m)[12]) {
  double linear = 0.0, translation = 0.0;
  for (int i = 0; i < 12; ++i) (i % 4 == 3 ? translation : linear) += Square(m[i]);
  return {std::sqrt(linear), std::sqrt(translation)};
}
PoseGate::Reach operator*(const PoseGate::Reach& a, const PoseGate::Reach& b) {
  return {a.linear * b.linear, a.linear * b.translation + a.translation};
}
bool IsNear(const PoseGate::Reach& reach, double mesh_reach_m) {
  // Normals and tangents go through the linear part alone.
  return reach.linear * std::max(1.0, mesh_reach_m) + reach.translation <= kFarthest_m;
}

// Of one component of a joint's blended keys, regardless of their signs.
double LargestBlend(const float (&key)[4][3][kJointsPerCharacter],
                    const float (&weight)[4][kJointsPerCharacter], int component, uint32_t joint) {
  double sum = 0.0;
  for (int k = 0; k < 4; ++k)
    sum += std::abs(double(key[k][component][joint]) * double(weight[k][joint]));
  return sum;
}

// A rotation keeps lengths, so the largest scale is what a joint does to them.
PoseGate::Reach LocalReach(const PoseBlock& pose, uint32_t joint) {
  PoseGate::Reach reach{0.0, 0.0};
  for (int c = 0; c < 3; ++c) {
    reach.linear =
        std::max(reach.linear, LargestBlend(pose.scale_key, pose.scale_weight, c, joint));
    reach.translation += LargestBlend(pose.translation_key, pose.translation_weight, c, joint);
  }
  return reach;
}

// How fast a joint's own transform changes.
PoseGate::Reach LocalRate(const PoseBlock& pose, const PoseRateBlock& rates, uint32_t joint) {
  const auto size = [joint](const float(&rows)[3][kJointsPerCharacter]) {
    return std::sqrt(Square(rows[0][joint]) + Square(rows[1][joint]) + Square(rows[2][joint]));
  };
  const double turned = size(rates.spin) * LocalReach(pose, joint).linear;
  return {turned + size(rates.scale), size(rates.translation)};
}

// A bound on the derivative of a * b.
PoseGate::Reach RateOfProduct(const PoseGate::Reach& a, const PoseGate::Reach& a_rate,
                              const PoseGate::Reach& b, const PoseGate::Reach& b_rate) {
  const PoseGate::Reach carried = a_rate * b;
  return {carried.linear + a.linear * b_rate.linear,
          carried.translation + a.linear * b_rate.translation};
}

}  // namespace

std::string DescribeRefusedPose(const RefusedPose& refused) {
  if (refused.joint == kNoJoint)
    return Format("pose of character {}: {}", refused.character, refused.what);
  return Format("pose of character {}, joint {}: {}", refused.character, refused.joint,
                refused.what);
}

PoseGate::PoseGate(std::span<const Groom* const> grooms, const FrameTable& kernels)
    : sample_pose_(*kernels.Find("sample_pose")),
      joint_palette_(*kernels.Find("joint_palette")),
      holds_pose_(grooms.size(), 0),
      scratch_(std::make_unique<Scratch>()) {
  for (const Groom* groom : grooms) {
    double reach2 = 0.0;
    for (const MeshBlock& mesh : groom->mesh)
      for (uint32_t v = 0; v < mesh.vertex_count; ++v)
        reach2 = std::max(reach2, Square(mesh.position[0][v]) + Square(mesh.position[1][v]) +
                                      Square(mesh.position[2][v]));
    characters_.push_back(
        {groom->joint_count, groom->unit_scale, std::sqrt(reach2), uint32_t(inverse_bind_.size())});
    for (uint32_t j = 0; j < groom->joint_count; ++j)
      inverse_bind_.push_back(ReachOf(groom->skeleton.inverse_bind[j]));
  }
  refused_.reserve(grooms.size());
}

const PaletteBlock& PoseGate::RunKernels(const FrameMemory& memory, uint32_t character) const {
  PoseBlock* pose = memory.Of<&Streams::pose>(character);
  auto* skeleton = memory.Of<&Streams::skeleton>(character);
  LocalPoseBlock& local = scratch_->local;
  PaletteBlock& palette = scratch_->palette;
  // Neither kernel has parameters.
  const Binding sample_ports[] = {{pose, nullptr, 1}, {&local, nullptr, 1}};
  sample_pose_.run(nullptr, sample_ports);
  const Binding palette_ports[] = {
      {pose, nullptr, 1}, {skeleton, nullptr, 1}, {&local, nullptr, 1}, {&palette, nullptr, 1}};
  joint_palette_.run(nullptr, palette_ports);
  return palette;
}

const PaletteBlock& PoseGate::PaletteOf(const FrameMemory& memory, uint32_t character) const {
  if (holds_pose_[character]) return *memory.Of<&Streams::palette>(character);
  return RunKernels(memory, character);
}

// The first joint whose matrix takes the mesh too far.
uint32_t PoseGate::FindFarJoint(const FrameMemory& memory, uint32_t character) const {
  const PaletteBlock& palette = RunKernels(memory, character);
  for (uint32_t j = 0; j < characters_[character].joint_count; ++j)
    if (!IsNear(ReachOf(palette.matrix[j]), characters_[character].reach_m)) return j;
  return kNoJoint;
}

RefusedPose PoseGate::FindFault(const FrameMemory& memory, uint32_t character) const {
  const PoseBlock& pose = *memory.Of<&Streams::pose>(character);
  const CharacterLimits& limits = characters_[character];
  // The kernels walk the groom's skeleton by the pose's count.
  if (pose.joint_count != limits.joint_count)
    return {character, kNoJoint, "its joint count is not its groom's"};
  const RefusedPose bad = FindBadValue(pose, character);
  if (bad.what) return bad;

  const SkeletonBlock& skeleton = *memory.Of<&Streams::skeleton>(character);
  Reach world[kJointsPerCharacter];
  const Reach root = ReachOf(pose.root);
  bool all_near = true;
  for (uint32_t j = 0; j < pose.joint_count && all_near; ++j) {
    const int32_t parent = skeleton.parent[j];
    world[j] = (parent < 0 ? root : world[parent]) * LocalReach(pose, j);
    all_near = IsNear(world[j] * inverse_bind_[limits.first_joint + j], limits.reach_m);
  }
  if (all_near) return {character, kNoJoint, nullptr};
  const uint32_t far_joint = FindFarJoint(memory, character);
  if (far_joint == kNoJoint) return {character, kNoJoint, nullptr};
  return {character, far_joint, "with its parents' it takes the skin beyond 1e7 m"};
}

RefusedPose PoseGate::FindRateFault(const FrameMemory& memory, uint32_t character) const {
  const RefusedPose none = {character, kNoJoint, nullptr};
  const PoseRateBlock* rates = memory.Of<&Streams::pose_rates>(character);
  if (!rates || !rates->given) return none;
  const PoseBlock& pose = *memory.Of<&Streams::pose>(character);
  const RefusedPose bad = FindBadRate(*rates, pose.joint_count, character);
  if (bad.what) return bad;

  const SkeletonBlock& skeleton = *memory.Of<&Streams::skeleton>(character);
  const CharacterLimits& limits = characters_[character];
  Reach world[kJointsPerCharacter], rate[kJointsPerCharacter];
  const Reach root = ReachOf(pose.root), root_rate = ReachOf(rates->root);
  for (uint32_t j = 0; j < pose.joint_count; ++j) {
    const int32_t parent = skeleton.parent[j];
    const Reach local = LocalReach(pose, j);
    const Reach above = parent < 0 ? root : world[parent];
    world[j] = above * local;
    rate[j] = RateOfProduct(above, parent < 0 ? root_rate : rate[parent], local,
                            LocalRate(pose, *rates, j));
    if (!IsNear(rate[j] * inverse_bind_[limits.first_joint + j], limits.reach_m))
      return {character, j, "with its parents' its velocity moves the skin faster than 1e7 m/s"};
  }
  return none;
}

void PoseGate::Judge(const FrameMemory& memory, std::span<const double> origins) {
  refused_.clear();
  for (uint32_t c = 0; c < characters_.size(); ++c) {
    RefusedPose fault = FindFault(memory, c);
    if (!fault.what) fault = FindRateFault(memory, c);
    if (!fault.what && !origins.empty() && !IsOriginUsable(&origins[3 * c]))
      fault = {c, kNoJoint, "its origin is not finite, or beyond 1e7 m"};
    holds_pose_[c] = fault.what != nullptr;
    if (fault.what) {
      refused_.push_back(fault);
      Hold(memory, c);
    } else {
      Accept(memory, c);
    }
  }
}

// What joint_palette leaves when it is given the last pose again.
void PoseGate::Hold(const FrameMemory& memory, uint32_t character) {
  CharacterLimits& limits = characters_[character];
  auto& palette = *memory.Of<&Streams::palette>(character);
  std::fill(std::begin(palette.moved), std::end(palette.moved), 0u);
  palette.teleported = 0;
  const bool teleported = memory.Of<&Streams::pose>(character)->teleported != 0;
  limits.must_restart |= teleported || !limits.had_pose;
  if (limits.had_pose) return;
  for (auto& matrix : palette.matrix)
    for (int i = 0; i < 12; ++i) matrix[i] = i % 5 == 0 ? limits.unit_scale : 0.0f;
}

void PoseGate::Accept(const FrameMemory& memory, uint32_t character) {
  CharacterLimits& limits = characters_[character];
  limits.had_pose = true;
  if (!limits.must_restart) return;
  limits.must_restart = false;
  // What was not visible in the last frame starts from the groom.
  const SceneShape& shape = *memory.shape;
  for (uint32_t p = 0; p < shape.patch_count; ++p)
    if (shape.layer_character[shape.patch_layer[p]] == character)
      memory.Of<&Streams::patch_state>(p)->flags = 0;
  for (uint32_t c = 0; c < shape.chunk_count; ++c)
    if (shape.layer_character[shape.chunk_layer[c]] == character)
      memory.Of<&Streams::chunk_state>(c)->flags = 0;
}

void PoseGate::TakeUnitScales(std::span<const Groom* const> grooms) {
  for (size_t c = 0; c < grooms.size(); ++c) characters_[c].unit_scale = grooms[c]->unit_scale;
}

void PoseGate::CopyStateFrom(const PoseGate& other) {
  for (size_t c = 0; c < characters_.size(); ++c) {
    characters_[c].had_pose = other.characters_[c].had_pose;
    characters_[c].must_restart = other.characters_[c].must_restart;
    holds_pose_[c] = other.holds_pose_[c];  // in place: the scene's memory points here
  }
  refused_.assign(other.refused_.begin(), other.refused_.end());
}

uint64_t PoseGate::HeapBytes() const {
  return characters_.capacity() * sizeof(CharacterLimits) +
         inverse_bind_.capacity() * sizeof(Reach) + holds_pose_.capacity() +
         refused_.capacity() * sizeof(RefusedPose) + (scratch_ ? sizeof(Scratch) : 0);
}

}  // namespace pelt
