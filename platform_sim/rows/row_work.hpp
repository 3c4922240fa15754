// Running the measured rows' work: listings through the cores and caches, transfers through the
// Cell's memory. Nothing here knows what was measured.
//
// Invariant: a row's work is the same whatever platform it is run on; what changes is how long the
// models say it takes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform_sim/core/issue_chart.hpp"
#include "platform_sim/core/ppe_core.hpp"
#include "platform_sim/core/spu_core.hpp"
#include "platform_sim/memory/spu_program.hpp"
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
std::optional<double> CyclesPerTurn(const IssueChart& chart, std::string& error);

// A PPE loop whose turns walk through memory: what its core takes and what its caches add. `lines`:
// the line (of 128 bytes) that turn t's loads are in, repeated round after round.
std::optional<double> PpeCyclesPerTurn(const CellParameters& cell, const std::string& listing,
                                       const std::vector<uint32_t>& lines, std::string& error);
// `count` lines, one after the other; or once around in an order without a pattern.
std::vector<uint32_t> LinesInOrder(uint32_t count);
std::vector<uint32_t> LinesInRandomCycle(uint32_t count);

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

}  // namespace pelt
