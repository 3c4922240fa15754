// Running the measured rows' work: listings through the cores and caches, transfers through the
// Cell's memory, jobs through its queue. Nothing here knows what was measured.
//
// Invariant: a row's work is the same on every platform that it is run on; what changes is how long the
// models say it takes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform_sim/memory/spu_program.hpp"
#include "platform_sim/pipeline/issue_chart.hpp"
#include "platform_sim/pipeline/ppe_core.hpp"
#include "platform_sim/pipeline/spu_core.hpp"
#include "platform_sim/platforms/platform.hpp"
#include "platform_sim/rows/row_listings.hpp"

namespace pelt {

// ---- running them ----------------------------------------------------------------------------

// Nothing, and why in `error`, when the listing or the core cannot be.
std::optional<IssueChart> TimeSpuListing(const std::string& text, const SpuRules& rules,
                                         const SpuParameters& spu, std::string& error);
std::optional<IssueChart> TimePpeListing(const std::string& text, const PpeRules& rules,
                                         const PpeParameters& ppe, std::string& error);
// Of the chart's only loop, at its steady state; nothing if it has none.
std::optional<double> CyclesPerIteration(const IssueChart& chart, std::string& error);

// Two loops, one on each of the PPE's threads.
std::optional<PpePairTiming> TimePpePair(const std::string& first, const std::string& second,
                                         const PpeParameters& ppe, std::string& error);

// The lines (of 128 bytes) that a loop's loads and its dcbts are in, one after another as they run,
// around and around.
struct PpeWalk {
  std::vector<uint32_t> loads, prefetches;
};
PpeWalk WalkInOrder(uint32_t lines, uint32_t loads_of_a_line, uint32_t lines_ahead = 0);
// Once around all elements of an array, in an order without a pattern.
PpeWalk WalkAtRandom(uint32_t elements, uint32_t elements_of_a_line);

// A PPE loop that walks through memory, alone on its core: what its core takes and what its caches
// add.
std::optional<double> PpeCyclesPerIteration(const CellParameters& cell, const std::string& listing,
                                            const PpeWalk& walk, std::string& error);

// ---- DMA -------------------------------------------------------------------------------------

// `spus` SPUs that each move `bytes_each` in blocks, `in_flight` at one time.
struct StreamOfBlocks {
  uint32_t spus = 6, block_bytes = 16384, in_flight = 2;
  bool get = true, put = false;
  uint32_t bytes_each = 1 << 17;
  DmaFar far = DmaFar::kMemory;
};
std::optional<SpuRun> RunStream(const CellMemoryParameters& p, const StreamOfBlocks& stream,
                                std::string& error);
// SPU s reads the local store of reads[s]; -1: it does nothing.
std::optional<SpuRun> RunLocalStoreReads(const CellMemoryParameters& p,
                                         const std::vector<int>& reads, uint32_t blocks,
                                         std::string& error);

// ---- jobs -----------------------------------------------------------------------------------
//
// A queue of jobs on some SPEs: who waits for whom.
//
// The PPE dispatches serially; an SPE that has fewer jobs than it may have gets the next one, the
// emptiest SPE first. With long jobs the SPEs are the limit, with short ones the PPE is, however
// many SPEs there are: that floor is row J4.
//
// Not modelled: contention on the queue's lock, the jobs' data (see memory/cell_memory.hpp).

struct JobRun {
  int64_t finish_ps = 0;
  int64_t ppe_busy_ps = 0;
  int64_t spe_busy_ps = 0;  // of all of them

  double MicrosecondsPerJob(uint64_t jobs) const { return double(finish_ps) / 1e6 / double(jobs); }
};

// `jobs` equal jobs of `job_ns` on `spe_count` SPEs, `job_ns` as it really takes: an availability
// is the caller's to apply. False, and why in `error`, for none of either.
bool RunJobs(const DispatchParameters& p, uint32_t spe_count, uint64_t jobs, double job_ns,
             JobRun& run, std::string& error);

}  // namespace pelt
