#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <utility>

#include "core/format.hpp"
#include "platform_sim/memory/xenon_memory.hpp"
#include "platform_sim/pipeline/issue_walk.hpp"
#include "platform_sim/pipeline/listing.hpp"
#include "platform_sim/rows/row_work.hpp"

namespace pelt {
namespace {

// Enough that every loop reaches its steady state; the rest is leapt over.
constexpr uint64_t kIterations = 100'000;

std::vector<TripCount> Trips(const Listing& listing) {
  const ListingLabel* loop = listing.FindLabel("loop");
  return loop ? std::vector<TripCount>{{loop->index, kIterations}} : std::vector<TripCount>{};
}

bool IsLoad(const AddressOperand& address) { return address.size_bytes > 0 && !address.is_store; }
// dcbt: an address, and nothing moved to a register.
bool IsPrefetch(const AddressOperand& address) {
  return address.size_bytes == 0 && address.index != kNoRegister;
}

// What `iterations` iterations of the loop touch, at the core's own pace.
std::vector<MemoryAccess> TouchedBy(const LoopTiming& loop, Program program, const PpeWalk& walk,
                                    uint64_t iterations, uint32_t line_bytes) {
  std::vector<MemoryAccess> trace;
  size_t load = 0, prefetch = 0;
  for (uint64_t iteration = 0; iteration < iterations; ++iteration)
    for (const IssueSlot& slot : loop.slots) {
      const AddressOperand& address = program[slot.instruction].address;
      MemoryAccess access;
      access.cycle = Cycles(double(iteration) * loop.CyclesPerIteration()) + slot.cycle;
      if (IsLoad(address)) {
        access.address = uint64_t{walk.loads[load++ % walk.loads.size()]} * line_bytes;
      } else if (IsPrefetch(address) && !walk.prefetches.empty()) {
        access.kind = AccessKind::kPrefetch;
        access.address =
            uint64_t{walk.prefetches[prefetch++ % walk.prefetches.size()]} * line_bytes;
      } else {
        continue;
      }
      trace.push_back(access);
    }
  return trace;
}

// A row has one text for all that can go wrong with it.
template <class T>
std::optional<T> Take(Result<T> result, std::string& error) {
  if (result) return *std::move(result);
  error = result.error();
  return std::nullopt;
}

std::optional<SpuRun> RunPrograms(const CellMemoryParameters& p,
                                  std::vector<SpuProgram::NextStep> programs, std::string& error) {
  SpuRun run;
  if (!RunSpus(p, std::move(programs), run, error)) return std::nullopt;
  return run;
}

}  // namespace

std::optional<IssueChart> TimeSpuListing(const std::string& text, const SpuRules& rules,
                                         const SpuParameters& spu, std::string& error) {
  const auto listing = Take(ReadListing(text, "row", SpuInstructionSet()), error);
  if (!listing) return std::nullopt;
  return Take(TimeOnSpu(listing->program, Trips(*listing), rules, spu), error);
}

std::optional<IssueChart> TimePpeListing(const std::string& text, const PpeRules& rules,
                                         const PpeParameters& ppe, std::string& error) {
  const auto listing = Take(ReadListing(text, "row", PpeInstructionSet()), error);
  if (!listing) return std::nullopt;
  return Take(TimeOnPpe(listing->program, Trips(*listing), rules, ppe), error);
}

std::optional<double> CyclesPerIteration(const IssueChart& chart, std::string& error) {
  if (chart.loops.size() == 1 && chart.loops[0].steady) return chart.loops[0].CyclesPerIteration();
  error = "the listing has no loop that reaches a steady state";
  return std::nullopt;
}

std::optional<PpePairTiming> TimePpePair(const std::string& first, const std::string& second,
                                         const PpeParameters& ppe, std::string& error) {
  const auto read = [&](const std::string& text) {
    return Take(ReadListing(text, "row", PpeInstructionSet()), error);
  };
  const auto a = read(first), b = a ? read(second) : std::nullopt;
  if (!b) return std::nullopt;
  return Take(TimePpePair({a->program, b->program}, ppe), error);
}

// The iterations as the core has them go to the caches, once around and twice around; what the
// second time adds is a round that finds the caches as the first has left them.
std::optional<double> PpeCyclesPerIteration(const CellParameters& cell, const std::string& text,
                                            const PpeWalk& walk, std::string& error) {
  const auto listing = Take(ReadListing(text, "row", PpeInstructionSet()), error);
  if (!listing) return std::nullopt;
  const auto chart = Take(TimeOnPpe(listing->program, Trips(*listing), {}, cell.ppe), error);
  const auto iteration = chart ? CyclesPerIteration(*chart, error) : std::nullopt;
  if (!iteration) return std::nullopt;
  const LoopTiming& loop = chart->loops[0];
  const auto loads_per_iteration =
      uint64_t(std::ranges::count_if(loop.slots, [&](const IssueSlot& slot) {
        return IsLoad(listing->program[slot.instruction].address);
      }));
  const uint64_t iterations = walk.loads.size() / loads_per_iteration;
  const CacheMemoryParameters caches = PpeMemory(cell);
  const auto stall_of = [&](uint64_t rounds) -> std::optional<Cycles> {
    const auto trace =
        TouchedBy(loop, listing->program, walk, rounds * iterations, caches.line_bytes);
    CacheMemoryRun run;
    if (!RunCacheMemory(caches, {{trace}}, run, error)) return std::nullopt;
    return run.threads[0].Stall();
  };
  const auto once = stall_of(1), twice = stall_of(2);
  if (!once || !twice) return std::nullopt;
  return *iteration + double(*twice - *once) / double(iterations);
}

PpeWalk WalkInOrder(uint32_t lines, uint32_t loads_of_a_line, uint32_t lines_ahead) {
  PpeWalk walk;
  for (uint32_t line = 0; line < lines; ++line) {
    walk.loads.insert(walk.loads.end(), loads_of_a_line, line);
    if (lines_ahead > 0) walk.prefetches.push_back((line + lines_ahead) % lines);
  }
  return walk;
}

PpeWalk WalkAtRandom(uint32_t elements, uint32_t elements_of_a_line) {
  PpeWalk walk;
  walk.loads.resize(elements);
  std::iota(walk.loads.begin(), walk.loads.end(), 0u);
  uint64_t seed = 1;
  for (uint32_t i = elements; i > 1; --i) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    std::swap(walk.loads[i - 1], walk.loads[(seed >> 33) % i]);
  }
  for (uint32_t& element : walk.loads) element /= elements_of_a_line;
  return walk;
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
  return RunPrograms(p, std::move(programs), error);
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
  return RunPrograms(p, std::move(programs), error);
}

namespace {

constexpr int64_t kPicoseconds = 1000;  // of a nanosecond

// When the jobs an SPE has end, first to last; only as many as it may have are kept.
struct Spe {
  std::deque<int64_t> ends;

  int64_t FreePlace(size_t places) const { return ends.size() < places ? 0 : ends.front(); }
  int64_t Free() const { return ends.empty() ? 0 : ends.back(); }
};

}  // namespace

bool RunJobs(const DispatchParameters& p, uint32_t spe_count, uint64_t jobs, double job_ns,
             JobRun& run, std::string& error) {
  constexpr double kLongestJobNs = 1e9;
  if (!(job_ns >= 0.0 && job_ns <= kLongestJobNs)) {
    error = Format("jobs of {} ns; expected 0 to {}", job_ns, kLongestJobNs);
    return false;
  }
  if (spe_count == 0 || jobs == 0 || p.jobs_ahead == 0) {
    error = Format("{} jobs on {} SPEs that may have {}: none may be zero", jobs, spe_count,
                   p.jobs_ahead);
    return false;
  }
  run = {};
  std::vector<Spe> spes(spe_count);
  const int64_t work =
      std::llround(job_ns * double(kPicoseconds)) + int64_t(p.spe_job_ns) * kPicoseconds;
  const int64_t dispatch = int64_t(p.ppe_job_ns) * kPicoseconds;
  int64_t ppe = 0;
  for (uint64_t job = 0; job < jobs; ++job) {
    Spe& spe = *std::min_element(spes.begin(), spes.end(), [&](const Spe& a, const Spe& b) {
      const int64_t place_a = std::max(ppe, a.FreePlace(p.jobs_ahead));
      const int64_t place_b = std::max(ppe, b.FreePlace(p.jobs_ahead));
      return place_a != place_b ? place_a < place_b : a.Free() < b.Free();
    });
    ppe = std::max(ppe, spe.FreePlace(p.jobs_ahead)) + dispatch;
    if (spe.ends.size() == p.jobs_ahead) spe.ends.pop_front();
    spe.ends.push_back(std::max(ppe, spe.Free()) + work);
    run.ppe_busy_ps += dispatch;
    run.spe_busy_ps += work;
    run.finish_ps = std::max(run.finish_ps, spe.ends.back());
  }
  return true;
}

}  // namespace pelt
