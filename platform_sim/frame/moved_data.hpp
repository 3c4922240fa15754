// What of an item's blocks is moved. Plans give stages whole blocks, and that is how an item is executed, so its bits
// stay; a console's programmer moves less of them:
//
//   live prefix        of rows, only the lanes that live
//   resident palette   a unit with a store keeps what items of a character read of it (its joints' matrices) from
//                      item to item, until it runs another pass
//
// All that is timed from there on is of what is moved.
#pragma once

#include <cstdint>
#include <vector>

#include "jobs/frame.hpp"
#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/frame/item_work.hpp"

namespace pelt {

// `bytes`, in `elements` pieces of a list and `lines` lines.
struct MovedPieces {
  uint64_t bytes;
  uint32_t elements, lines;
};

class MovedData {
 public:
  explicit MovedData(const ConsoleMachine& machine);

  void BeginFrame();
  // Of what `unit` has just run, `work` with whole blocks.
  void Apply(const Frame& frame, uint32_t unit, uint32_t pass, uint32_t item, ItemWork& work);

 private:
  void DropResident(const Frame& frame, uint32_t unit, Domain domain, uint32_t item,
                    ItemWork& work);
  void MoveLivePrefix(const Frame& frame, Domain domain, uint32_t item, ItemWork& work) const;
  // Of a block that is moved as it lies.
  MovedPieces Whole(uint64_t bytes) const;
  // `shape` moves `is` in place of `was`.
  void Replace(const MovedPieces& was, const MovedPieces& is, TransferShape& shape) const;

  const uint32_t line_bytes_, largest_bytes_;
  const bool has_stores_;
  struct Held {
    uint32_t pass = kNoBlock;
    std::vector<uint32_t> character;  // [stream]; kNoBlock: none's
  };
  std::vector<Held> held_;  // [unit]
};

}  // namespace pelt
