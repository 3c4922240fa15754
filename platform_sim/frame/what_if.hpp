// Changes of how a frame moves and sorts its data that this code does not make, tried in the model:
// what a port that is bound by memory could gain by them.
//
// Idea: an item is executed as it is, so its bits stay, and what it then asks of the console is
// what it would ask with the change. All that is timed from there on, frames, ranges, limits, is of
// the changed work: the advice that names a change and a run with it are one thing.
//
//   resident palette   an SPU keeps a character's joint palette from item to item of a pass
//   live prefix        of rows, only the lanes that live are moved, not whole blocks
//   wider digits       layers that are sorted in pieces take three digits of 11 bits, not four of 8
//   fewer points       strands have the fewest points that kernels take: of the scene's grooms, so
//                      whoever makes the scene does it (core/groom/fewer_points.hpp), the bits are
//                      those of that scene, and the work of its frames is left as it is
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "jobs/frame.hpp"
#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/frame/item_work.hpp"

namespace pelt {

inline constexpr WhatIf kAllWhatIfs[] = {WhatIf::kResidentPalette, WhatIf::kLivePrefix,
                                         WhatIf::kWiderDigits, WhatIf::kFewerPoints};
std::string_view WhatIfName(WhatIf what_if);  // "resident-palette"
std::optional<WhatIf> ParseWhatIf(std::string_view name);
std::string_view DescribeWhatIf(WhatIf what_if);

class WorkChange {
 public:
  WorkChange(WhatIf what_if, const ConsoleMachine& machine);

  void BeginPass();
  // False: the pass has nothing to do then.
  bool KeepsPass(const Plan& plan, uint32_t pass) const;
  // Of what `unit` has just run, `work` as it is.
  void Apply(const Frame& frame, uint32_t unit, uint32_t pass, uint32_t item, ItemWork& work);

 private:
  void DropPalette(const Frame& frame, uint32_t unit, uint32_t pass, uint32_t item, ItemWork& work);
  void MoveLivePrefix(const Frame& frame, uint32_t pass, uint32_t item, ItemWork& work) const;
  void WidenDigits(const Frame& frame, ItemWork& work) const;
  // `bytes` that were moved whole become others, in `elements` pieces of `lines` lines.
  struct Pieces {
    uint64_t bytes;
    uint32_t elements, lines;
  };
  Pieces Whole(uint64_t bytes) const;
  void Replace(const Pieces& was, const Pieces& is, TransferShape& shape) const;

  const WhatIf what_if_;
  const uint32_t line_bytes_, largest_bytes_;
  const bool has_stores_;
  std::vector<uint32_t> palette_of_;  // the character whose palette a unit holds; kNoBlock: none
};

}  // namespace pelt
