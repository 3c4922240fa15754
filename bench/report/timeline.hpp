// Recorded frames, kept and turned into what viewers and reports show.
//
// A frame's profile (jobs/frame_recording.hpp) is overwritten by the next frame. RecordFrame copies
// what ran out of it, between frames, where nothing is timed.
//
// Invariant: a record holds every item on which a stage ran, by pass, worker and time; and every
// stage that ran on it, of 0 ticks when stages were not timed in that frame.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/report/machine_use.hpp"
#include "jobs/scene.hpp"
#include "traces/chrome_trace.hpp"

namespace pelt {

// Readings of jobs/tick_clock.hpp on the caller's thread.
struct FrameTicks {
  uint64_t begin = 0;
  uint64_t prepared = 0;  // poses and parameters are filled
  uint64_t end = 0;
};

struct FrameRecord {
  struct StageRun : Slice {
    uint32_t stage;
  };
  struct Item : ItemSlice {
    uint32_t pass, item;
    uint32_t first_run, run_count;  // in `runs`
  };
  uint32_t frame = 0;
  FrameTicks ticks;
  std::vector<Slice> passes;
  std::vector<Item> items;
  std::vector<StageRun> runs;
  uint32_t live_strands = 0, drawn_strands = 0;
  CoreWait wait;  // left to whoever read it
};

// To be called after the frame and before the next.
FrameRecord RecordFrame(const FurScene& scene, const FrameProfile& profile, uint32_t frame,
                        const FrameTicks& ticks);

// One of these per stream that a pass reads and an earlier pass of the frame writes.
struct PassDependency {
  uint32_t producer, consumer;  // passes
  Stream stream;
};
// By consumer, then producer. `ran` says which passes ran at all in the frame: a stream comes from
// the last pass before the consumer that did and writes it.
std::vector<PassDependency> FindDependencies(const Plan& plan, const std::vector<bool>& ran);

// "pass 2: activate and 9 more"
std::string PassName(const Plan& plan, uint32_t pass);
// "chunk 3 of layer 7 brows"
std::string ItemName(const FurScene& scene, Domain domain, uint32_t item);
// "worker 0 (caller)"
std::string WorkerName(uint32_t worker);

// A track for each worker; frames on the caller's, passes over items over stages on all: a worker's
// items of one pass that follow each other are one slice of the pass. An arrow for each pair of passes
// that a stream connects, to the item that started first from the one that was done last before it;
// counters of strands and of bytes moved. Frames must be in the order they ran.
Timeline BuildTimeline(const FurScene& scene, std::span<const FrameRecord> frames, uint32_t workers,
                       double ns_per_tick);

// Where in a frame others had a core: the system counts how long threads waited for one, not when.
//
// An item that took far longer than in other frames of the run, in a frame in which threads waited,
// stood still meanwhile. No more is taken for that than threads waited in all.

struct PreemptedItem {
  uint32_t at;          // in FrameRecord::items
  uint64_t over_ticks;  // more than it usually takes
};
// `others`: frames of the same run to compare it with; `record` may be one of them.
std::vector<PreemptedItem> FindPreempted(const FrameRecord& record,
                                         std::span<const FrameRecord> others, double ms_per_tick);

}  // namespace pelt
