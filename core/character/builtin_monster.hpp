// The built-in monster: where its joints and primitives lie, and how it moves. What it has is said in
// builtin_character.hpp.
#pragma once

#include "core/character/builtin_clips.hpp"
#include "core/character/builtin_shape.hpp"

namespace pelt::builtin {

namespace monster {

enum Material : uint8_t { kHead, kBrow, kBody, kArm, kLeg, kTail, kEye };
inline constexpr const char* kMaterialNames[] = {"head", "brow", "body", "arm",
                                                 "leg",  "tail", "eye"};

enum Joint : uint8_t {
  kRoot,
  kHips,
  kSpine,
  kChest,
  kNeck,
  kHeadJoint,
  kBrowL,
  kBrowR,
  kShoulderL,
  kElbowL,
  kHandL,
  kShoulderR,
  kElbowR,
  kHandR,
  kThighL,
  kShinL,
  kFootL,
  kThighR,
  kShinR,
  kFootR,
  kTail1,
  kTail2,
  kTail3,
  kTail4,
  kJointCount
};

}  // namespace monster

Shape DesignMonster(const BuiltinCharacterOptions& options);
std::span<const ClipPlan> MonsterClips();

}  // namespace pelt::builtin
