#include <algorithm>
#include <numeric>
#include <utility>

#include "platform_sim/core/issue_walk.hpp"
#include "platform_sim/core/listing.hpp"
#include "platform_sim/memory/xenon_memory.hpp"
#include "platform_sim/rows/row_work.hpp"

namespace pelt {
namespace {

// Enough that every loop reaches its steady state; the rest is leapt over.
constexpr uint64_t kTurns = 100'000;

std::vector<TripCount> Trips(const Listing& listing) {
  const ListingLabel* loop = listing.FindLabel("loop");
  return loop ? std::vector<TripCount>{{loop->index, kTurns}} : std::vector<TripCount>{};
}

// The loads of a turn, by their cycles from its first.
std::vector<Cycles> LoadCycles(const LoopTiming& loop, Program program) {
  std::vector<Cycles> cycles;
  for (const IssueSlot& slot : loop.slots) {
    const AddressOperand& address = program[slot.instruction].address;
    if (address.size_bytes > 0 && !address.is_store) cycles.push_back(slot.cycle);
  }
  return cycles;
}

}  // namespace

std::optional<IssueChart> TimeSpuListing(const std::string& text, const SpuRules& rules,
                                         const SpuParameters& spu, std::string& error) {
  const auto listing = TryReadListing(text, "row", SpuInstructionSet(), error);
  if (!listing) return std::nullopt;
  return TryTimeOnSpu(listing->program, Trips(*listing), rules, spu, error);
}

std::optional<IssueChart> TimePpeListing(const std::string& text, const PpeRules& rules,
                                         const PpeParameters& ppe, std::string& error) {
  const auto listing = TryReadListing(text, "row", PpeInstructionSet(), error);
  if (!listing) return std::nullopt;
  return TryTimeOnPpe(listing->program, Trips(*listing), rules, ppe, error);
}

std::optional<double> CyclesPerTurn(const IssueChart& chart, std::string& error) {
  if (chart.loops.size() == 1 && chart.loops[0].steady) return chart.loops[0].CyclesPerTurn();
  error = "the listing has no loop that reaches a steady state";
  return std::nullopt;
}

// The turns as the core has them go to the caches, once around and twice around; what the second
// time adds is a round that finds the caches as the first has left them.
std::optional<double> PpeCyclesPerTurn(const CellParameters& cell, const std::string& text,
                                       const std::vector<uint32_t>& lines, std::string& error) {
  const auto listing = TryReadListing(text, "row", PpeInstructionSet(), error);
  if (!listing) return std::nullopt;
  const auto chart =
      TryTimeOnPpe(listing->program, Trips(*listing), {.smt = true}, cell.ppe, error);
  const auto turn = chart ? CyclesPerTurn(*chart, error) : std::nullopt;
  if (!turn) return std::nullopt;
  const std::vector<Cycles> loads = LoadCycles(chart->loops[0], listing->program);
  const CacheMemoryParameters caches = PpeMemory(cell);
  const auto stall_of = [&](uint32_t rounds) -> std::optional<Cycles> {
    std::vector<MemoryAccess> trace;
    for (uint32_t r = 0; r < rounds; ++r)
      for (size_t i = 0; i < lines.size(); ++i)
        for (const Cycles load : loads) {
          MemoryAccess access;
          access.address = uint64_t{lines[i]} * caches.line_bytes;
          access.cycle = Cycles((double(r) * double(lines.size()) + double(i)) * *turn) + load;
          trace.push_back(access);
        }
    CacheMemoryRun run;
    if (!RunCacheMemory(caches, {{trace}}, run, error)) return std::nullopt;
    return run.threads[0].Stall();
  };
  const auto once = stall_of(1), twice = stall_of(2);
  if (!once || !twice) return std::nullopt;
  return *turn + double(*twice - *once) / double(lines.size());
}

std::vector<uint32_t> LinesInOrder(uint32_t count) {
  std::vector<uint32_t> lines(count);
  std::iota(lines.begin(), lines.end(), 0u);
  return lines;
}

std::vector<uint32_t> LinesInRandomCycle(uint32_t count) {
  std::vector<uint32_t> lines = LinesInOrder(count);
  uint64_t seed = 1;
  for (uint32_t i = count; i > 1; --i) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    std::swap(lines[i - 1], lines[(seed >> 33) % i]);
  }
  return lines;
}

std::optional<SpuRun> RunStream(const CellMemoryParameters& p, const StreamOfBlocks& stream,
                                std::string& error) {
  std::vector<SpuProgram::NextStep> programs;
  for (uint32_t s = 0; s < stream.spus; ++s) {
    StreamWork work;
    work.far = stream.far;
    work.get_address = uint64_t(s) << 24;
    work.put_address = (uint64_t(s) << 24) + (1 << 23);
    work.block_bytes = stream.block_bytes;
    work.block_count = stream.bytes_each / stream.block_bytes;
    work.buffers = stream.in_flight;
    work.get = stream.get;
    work.put = stream.put;
    programs.push_back(DoubleBuffer(work));
  }
  SpuRun run;
  if (!RunSpus(p, std::move(programs), run, error)) return std::nullopt;
  return run;
}

std::optional<SpuRun> RunLocalStoreReads(const CellMemoryParameters& p,
                                         const std::vector<int>& reads, uint32_t blocks,
                                         std::string& error) {
  std::vector<SpuProgram::NextStep> programs;
  for (const int far : reads) {
    StreamWork work;
    work.far = DmaFar::kLocalStore;
    work.far_spu = far < 0 ? 0 : uint32_t(far);
    work.block_count = far < 0 ? 0 : blocks;
    work.window_bytes = 128 * 1024;
    work.buffers = 8;
    programs.push_back(DoubleBuffer(work));
  }
  SpuRun run;
  if (!RunSpus(p, std::move(programs), run, error)) return std::nullopt;
  return run;
}

}  // namespace pelt
