// Where two runs of the same frames part: stage, stream, item, row and lane, of any table of
// streams.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "jobs/frame.hpp"

namespace pelt {

// The first value that differs, in the order of the frame's stages.
struct Mismatch {
  static constexpr uint32_t kNoLayer = ~0u;

  uint32_t frame = 0;
  std::string stage, stream, row;
  Domain domain = Domain::kScene;
  uint32_t item = 0;                // of the scene, in the domain
  uint32_t layer_index = kNoLayer;  // of streams of layers, and of what is in them
  uint32_t place_in_layer = 0;      // of patches and chunks
  std::string layer = {};           // its name, where the caller knows one
  uint32_t component = 0, lane = 0;
  uint32_t expected = 0, found = 0;
  bool is_float = false;
  bool reproduced = true;  // false: seen once, and not again in lock-step: a race
};
// One line.
std::string DescribeMismatch(const Mismatch& mismatch);

// The first difference after a frame that both have run, of values, then, if `bookkeeping` is set,
// of the bookkeeping of what ran. Of the same streams and shape; `expected` has the plan whose
// stages are gone through. Who calls knows which frame it is.
std::optional<Mismatch> FindMismatch(const Frame& expected, const Frame& found,
                                     bool bookkeeping = false);

}  // namespace pelt
