// A stage: a kernel, what its items are, and when it runs on one.
#pragma once

#include <cstdint>

#include "core/kernel.hpp"

namespace pelt {

// When a stage runs on an item that has its streams; evaluated just before it would run.
enum class LayerGate : uint8_t {
  kAlways,
  kKeysChanged,  // LayerSortBlock::keys_changed
  kRedraw,       // the piece holds drawn strands, and keys or records of the layer changed
};
// What a frame as a whole may leave out.
enum class FrameGate : uint8_t {
  kNotPaused,   // in every frame but a paused one (FrameMemory::paused)
  kAlsoPaused,  // there too
  kNewPose,     // a character's stage: not for one that holds its last pose, nor in a pause
};
struct Gate {
  uint32_t chunk_flags = 0;  // all of these ChunkFlag bits
  // All of these LayerFlag bits, of those that may change from frame to frame.
  uint32_t layer_flags = 0;
  LayerGate layer = LayerGate::kAlways;
  FrameGate frame = FrameGate::kNotPaused;
};

struct Stage {
  KernelDesc kernel;
  const void* params;
  Domain domain;
  Gate gate = {};
  KindMask kinds = {};  // in the table: besides what its streams demand; in a plan: all of it
};

}  // namespace pelt
