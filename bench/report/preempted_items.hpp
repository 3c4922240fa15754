// Where in a frame others had a core: the system counts how long threads waited for one, not when.
//
// An item that took far longer than in other frames of the run, in a frame in which threads waited,
// stood still meanwhile. No more is taken for that than threads waited in all.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/report/timeline.hpp"

namespace pelt {

struct PreemptedItem {
  uint32_t at;          // in FrameRecord::items
  uint64_t over_ticks;  // more than it usually takes
};
// `others`: frames of the same run to hold it against; `record` may be one of them.
std::vector<PreemptedItem> FindPreempted(const FrameRecord& record,
                                         std::span<const FrameRecord> others, double ms_per_tick);

}  // namespace pelt
