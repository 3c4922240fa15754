// A stage: a kernel, what its items are, and when it runs on one.
#pragma once

#include <array>
#include <cstdint>

#include "core/frame_memory.hpp"
#include "core/kernel_desc.hpp"

namespace pelt {

// Whether a stage runs on an item that has its streams; asked just before it would.
struct Condition {
  bool (*holds)(const FrameMemory&, const ItemPlace&) = nullptr;  // null: always
  Domain domain = Domain::kScene;  // whose item it looks at: the stage's own or a coarser one's
  std::array<Stream, 2> reads = {Stream::kNone, Stream::kNone};  // what it looks at
};
// What a frame as a whole may leave out.
enum class FrameGate : uint8_t {
  kNotPaused,   // in every frame but a paused one (FrameMemory::paused)
  kAlsoPaused,  // there too
  kFollows,     // also in a pause before which state was put back (FrameMemory::restored): what
                // follows from state alone is made again
  kNotHeld,     // not on an item that is held (FrameMemory::held), nor in a pause
};
struct Gate {
  Condition when = {};
  FrameGate frame = FrameGate::kNotPaused;
};

struct Stage {
  KernelDesc kernel;
  const void* params;  // of the first character's items: see ParamsOf
  Domain domain;
  Gate gate = {};
  KindMask kinds = {};  // in the table: besides what its streams demand; in a plan: all of it
};

// The parameters of the item at `place`.
inline const void* ParamsOf(const Stage& stage, const FrameMemory& memory, const ItemPlace& place) {
  if (!stage.params || memory.params_step == 0) return stage.params;
  return static_cast<const std::byte*>(stage.params) +
         memory.params_step * place.first[size_t(Domain::kCharacter)];
}

}  // namespace pelt
