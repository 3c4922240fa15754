#include "platform_sim/pricing/kernel_cost.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/random.hpp"
#include "platform_sim/memory/xenon_memory.hpp"
#include "platform_sim/pipeline/issue_walk.hpp"
#include "platform_sim/pricing/trace.hpp"
#include "platform_sim/schedule/schedule.hpp"

namespace pelt {

namespace {

using Accesses = std::vector<MemoryAccess>;

constexpr uint64_t kThreadSpace = uint64_t{1} << 32;  // threads share no line
constexpr uint32_t kFreeMilliBytesPerCycle = 1'000'000'000;

// Every line is in the second level: whoever misses the first waits for no longer way than that.
CacheMemoryParameters AllInSecondLevel(CacheMemoryParameters p) {
  p.l2_milli_bytes_per_cycle =
      std::max(p.l2_milli_bytes_per_cycle / p.cores, 1u);  // a core's share
  p.cores = 1;
  p.memory_cycles = p.l2_hit_cycles;
  p.bus_milli_bytes_per_cycle = p.memory_milli_bytes_per_cycle = kFreeMilliBytesPerCycle;
  p.gpu_permille = 0;
  return p;
}

Accesses AccessesOf(const Trace& trace, double cycles, uint64_t space) {
  Accesses out;
  const double pace = cycles / double(std::max<size_t>(trace.operations.size(), 1));
  for (size_t o = 0; o < trace.operations.size(); ++o) {
    const RecordedOperation& operation = trace.operations[o];
    if (!IsLoad(operation.kind) && !IsStore(operation.kind)) continue;
    MemoryAccess access;
    access.kind = IsStore(operation.kind) ? AccessKind::kStore : AccessKind::kLoad;
    access.bytes = operation.size_bytes;
    access.address = space + uint64_t(operation.address);
    access.cycle = Cycles(double(o) * pace);
    out.push_back(access);
  }
  return out;
}

// A dcbt ahead of the first load of each line.
Accesses WithPrefetches(const Accesses& accesses, const CacheMemoryParameters& p, uint64_t& lines) {
  std::unordered_set<uint64_t> seen;  // asked only, never walked
  Accesses out;
  for (const MemoryAccess& access : accesses) {
    const uint64_t line = access.address / p.line_bytes;
    if (access.kind != AccessKind::kLoad || !seen.insert(line).second) continue;
    MemoryAccess fetch;
    fetch.kind = AccessKind::kPrefetch;
    fetch.address = line * p.line_bytes;
    fetch.bytes = p.line_bytes;
    fetch.cycle = std::max<Cycles>(access.cycle - 2 * Cycles(p.l2_hit_cycles), 0);
    out.push_back(fetch);
  }
  lines = out.size();
  const auto fetches = Accesses::difference_type(out.size());
  out.insert(out.end(), accesses.begin(), accesses.end());
  std::inplace_merge(out.begin(), out.begin() + fetches, out.end(),
                     [](const auto& a, const auto& b) { return a.cycle < b.cycle; });
  return out;
}

Cycles Waits(const CacheMemoryRun& run) {
  Cycles most = 0;
  for (const ThreadMemoryTimes& thread : run.threads)
    most = std::max(most, thread.Stall() - thread.load_hit_store_stall);
  return most;
}

}  // namespace

Result<CacheCost> PriceCaches(const Trace& trace, uint32_t iterations, double cycles_per_iteration,
                              uint32_t threads, const CacheMemoryParameters& caches) {
  const CacheMemoryParameters p = AllInSecondLevel(caches);
  std::vector<Accesses> bare, fetched;
  uint64_t lines = 0;
  for (uint32_t t = 0; t < threads; ++t) {
    bare.push_back(AccessesOf(trace, cycles_per_iteration * iterations, t * kThreadSpace));
    fetched.push_back(WithPrefetches(bare.back(), p, lines));
  }
  CacheMemoryRun bare_run, fetched_run;
  std::string error;
  if (!RunCacheMemory(p, bare, bare_run, error) || !RunCacheMemory(p, fetched, fetched_run, error))
    return Failure{error};
  const double per_iteration = 1.0 / std::max(iterations, 1u);
  CacheCost cost;
  cost.lines_per_iteration = double(lines) * per_iteration;
  // Each dcbt takes a cycle of the unit that loads and stores.
  cost.wait_cycles_per_iteration = double(Waits(fetched_run) + Cycles(lines)) * per_iteration;
  cost.unfetched_wait_cycles_per_iteration = double(Waits(bare_run)) * per_iteration;
  return cost;
}

namespace {

constexpr uint64_t kFnvPrime = 0x100000001b3;

// Hashes of all runs of kLongEnough kinds, by where they begin.
std::vector<uint64_t> HashRuns(const std::vector<uint8_t>& kinds) {
  std::vector<uint64_t> hashes;
  uint64_t hash = 0, leaves = 1;
  for (uint32_t i = 0; i < kLongEnough; ++i) leaves *= kFnvPrime;
  for (size_t i = 0; i < kinds.size(); ++i) {
    hash = hash * kFnvPrime + kinds[i] + 1;
    if (i >= kLongEnough) hash -= leaves * (kinds[i - kLongEnough] + 1u);
    if (i + 1 >= kLongEnough) hashes.push_back(hash);
  }
  return hashes;
}

}  // namespace

double ShareOfOwnCode(const Trace& trace, uint32_t begin, uint32_t end, uint32_t furthest) {
  std::vector<uint8_t> kinds;
  for (uint32_t i = begin; i < end; ++i)
    if (const RecordedKind kind = trace.operations[i].kind; kind != RecordedKind::kSplat)
      kinds.push_back(uint8_t(kind));
  const std::vector<uint64_t> hashes = HashRuns(kinds);
  std::unordered_map<uint64_t, size_t> latest;
  size_t again = 0;
  for (size_t i = 0, entered = 0; i < hashes.size();) {
    for (; entered + kLongEnough <= i; ++entered) latest[hashes[entered]] = entered;
    const auto found = latest.find(hashes[i]);
    size_t length = 0;
    if (found != latest.end() && i - found->second <= furthest)
      while (i + length < kinds.size() && kinds[found->second + length] == kinds[i + length])
        ++length;
    if (length < kLongEnough) {
      ++i;
      continue;
    }
    again += length;
    i += length;
  }
  return kinds.empty() ? 1.0 : double(kinds.size() - again) / double(kinds.size());
}

namespace {

struct Window {
  uint32_t begin, middle, end;  // operations: short is [begin, middle)
  uint32_t iterations;          // of the long one
  bool whole = false;           // the trace is no longer
};

// How many values are alive between operation p - 1 and p, constants left out.
std::vector<uint32_t> CountLiveValues(const Trace& trace) {
  const auto count = uint32_t(trace.operations.size());
  std::vector<uint32_t> last_reader(trace.value_count, 0);
  for (uint32_t o = 0; o < count; ++o)
    for (uint32_t i = 0; i < trace.operations[o].operand_count; ++i)
      if (const uint32_t value = trace.operations[o].operand[i]; value != kNoValue)
        last_reader[value] = o;
  std::vector<int32_t> change(count + 2);
  for (uint32_t o = 0; o < count; ++o) {
    const RecordedOperation& operation = trace.operations[o];
    if (operation.kind == RecordedKind::kSplat) continue;
    for (uint32_t r = 0; r < operation.result_count; ++r) {
      const uint32_t last = last_reader[operation.result + r];
      if (last <= o) continue;
      ++change[o + 1];
      --change[last + 1];
    }
  }
  std::vector<uint32_t> alive(count + 1);
  int32_t now = 0;
  for (uint32_t p = 0; p <= count; ++p) alive[p] = uint32_t(now += change[p]);
  return alive;
}

std::vector<Window> PlaceWindows(const Trace& trace, uint32_t iterations, const PriceRules& rules) {
  const auto count = uint32_t(trace.operations.size());
  iterations = std::max(iterations, 1u);
  const uint32_t iteration = std::max(count / iterations, 1u);
  const uint32_t half_iterations = rules.iterations / 2;
  const uint32_t half = half_iterations * iteration;
  if (count < 3 * half) {
    const uint32_t end = std::min(count, 2 * rules.window_operations);
    const auto covered = uint32_t(std::lround(double(iterations) * end / std::max(count, 1u)));
    return {{0, 0, end, std::max(covered, 1u), true}};
  }
  const std::vector<uint32_t> alive = CountLiveValues(trace);
  // The place from p on, no more than an iteration away, where the fewest values are alive.
  const auto cut = [&](uint64_t p) {
    const auto first = alive.begin() + int64_t(std::min<uint64_t>(p, count));
    const auto last = alive.begin() + int64_t(std::min<uint64_t>(p + iteration, count + 1));
    return uint32_t(std::min_element(first, std::max(last, first + 1)) - alive.begin());
  };
  std::vector<Window> out;
  const uint64_t room = count - 2 * uint64_t(half);
  const uint32_t windows = half > rules.window_operations ? 1 : rules.windows;
  for (uint32_t w = 0; w < windows; ++w) {
    const uint32_t begin = cut(room * (2 * w + 1) / (2 * windows));
    const uint32_t middle = cut(uint64_t(begin) + half), end = cut(uint64_t(middle) + half);
    if (begin < middle && middle < end) out.push_back({begin, middle, end, 2 * half_iterations});
  }
  if (out.empty()) out.push_back({0, 0, std::min(count, 2 * half), 2 * half_iterations, true});
  return out;
}

uint32_t CountSeen(const Trace& trace, uint32_t begin, uint32_t end) {
  return uint32_t(
      std::count_if(trace.operations.begin() + begin, trace.operations.begin() + end,
                    [](const RecordedOperation& o) { return o.kind != RecordedKind::kSplat; }));
}
uint32_t CountSeen(const Trace& trace) {
  return CountSeen(trace, 0, uint32_t(trace.operations.size()));
}
uint64_t CountOf(const Trace& trace, RecordedKind kind) {
  return uint64_t(std::count_if(trace.operations.begin(), trace.operations.end(),
                                [&](const RecordedOperation& o) { return o.kind == kind; }));
}

// Cycles of code: alone on its core, and beside the other hardware thread.
struct CodeCycles {
  double alone = 0.0, shared = 0.0;
};

// One stretch of the trace, timed in every way.
struct Timed {
  double operations = 0.0, instructions = 0.0, bound = 0.0;
  double own_code = 1.0;  // share of it (RolledCode)
  CodeCycles as_written, scheduled;
  FinishedCode code;
  IssueChart chart;  // scheduled
};

Result<IssueChart> TimeCode(const Result<FinishedCode>& code, const PricedCore& core,
                            CodeCycles& cycles) {
  if (!code) return Failure{code.error()};
  auto chart = core.scheduling.time(code->program);
  if (!chart) return chart;
  cycles.alone = cycles.shared = double(chart->totals.cycles);
  if (!core.time_shared) return chart;
  const auto shared = core.time_shared(code->program);
  if (!shared) return shared;
  cycles.shared = double(shared->totals.cycles);
  return chart;
}

Result<Timed> TimeStretch(const Trace& trace, uint32_t begin, uint32_t end, uint32_t iterations,
                          const PricedCore& core, const PriceRules& rules) {
  const auto simple =
      SimplifyTrace(trace, begin, end, {.fuse_multiply_add = !rules.lowering.host_operations});
  const LoweredCode lowered = LowerTo(core, simple, iterations, rules.lowering);
  Timed out;
  out.operations = std::max(CountSeen(trace, begin, end), 1u);
  out.instructions = double(lowered.code.program.size());
  out.own_code = ShareOfOwnCode(trace, begin, end, uint32_t(out.operations / iterations));
  const auto in_order =
      TimeCode(AllocateInOrder(lowered.code, core.scheduling), core, out.as_written);
  if (!in_order) return Failure{in_order.error()};
  auto scheduled = ScheduleIterations(lowered.code, iterations, core.scheduling);
  auto chart = TimeCode(scheduled, core, out.scheduled);
  if (!chart) return Failure{chart.error()};
  out.bound = double(*std::ranges::max_element(chart->totals.pipe_cycles));
  out.code = *std::move(scheduled);
  out.chart = *std::move(chart);
  return out;
}

// Cycles of one operation once the pipeline is full: not below what the units can do, nor above
// what the long stretch took with filling and draining.
double SteadyRate(double short_cycles, double long_cycles, const Timed& small, const Timed& large) {
  const double most = long_cycles / large.operations;
  const double rate = (long_cycles - short_cycles) / (large.operations - small.operations);
  return std::clamp(rate, std::min(large.bound / large.operations, most), most);
}

// Of `window`, into `price`: `share` of it for every operation.
void AddPrice(const Timed& small, const Timed& large, CodeCycles Timed::*code, bool whole,
              double share, uint32_t windows, CodePrice& price) {
  const CodeCycles &less = small.*code, &more = large.*code;
  CodeCycles rate{more.alone / large.operations, more.shared / large.operations};
  if (!whole) {
    rate.alone = SteadyRate(less.alone, more.alone, small, large);
    // Two threads share the dispatch: neither is faster for it.
    rate.shared = std::max(rate.alone, SteadyRate(less.shared, more.shared, small, large));
    price.fixed_cycles += std::max(0.0, more.alone - rate.alone * large.operations) / windows;
  }
  price.cycles_per_iteration += rate.alone * share;
  price.shared_cycles_per_iteration += rate.shared * share;
}

void NoteWindow(const Timed& window, uint32_t iterations, const PricedCore& core, KernelCost& cost,
                IssueTotals& totals) {
  totals += window.chart.totals;
  cost.most_live = std::max(cost.most_live, window.code.most_live_vectors);
  cost.spill_stores += window.code.spill_stores;
  cost.spill_loads += window.code.spill_loads;
  const uint64_t bytes = window.code.program.size() * core.scheduling.instruction_bytes;
  const double of_loop =
      double(bytes) * std::min(iterations, kLoopIterations) / std::max(iterations, 1u);
  cost.code_bytes = std::max(cost.code_bytes, uint32_t(of_loop * window.own_code));
  cost.window_iterations = std::max(cost.window_iterations, iterations);
}

// Where one thread waits, the other has the core: two take as long as both need of it, or as one
// does with its waiting.
Result<> AddCaches(const Trace& trace, const PricedCore& core, KernelCost& cost) {
  const auto add = [&](CodePrice& price, double CacheCost::*wait, bool fetches) -> Result<> {
    const auto alone =
        PriceCaches(trace, cost.iterations, price.cycles_per_iteration, 1, *core.caches);
    if (!alone) return Failure{alone.error()};
    const auto both = PriceCaches(trace, cost.iterations, price.shared_cycles_per_iteration,
                                  core.caches->core.smt_threads, *core.caches);
    if (!both) return Failure{both.error()};
    price.shared_cycles_per_iteration =
        std::max(price.shared_cycles_per_iteration + (fetches ? both->lines_per_iteration : 0.0),
                 price.cycles_per_iteration + *both.*wait);
    price.cycles_per_iteration += *alone.*wait;
    cost.lines_per_iteration = alone->lines_per_iteration;
    if (!fetches) cost.unfetched_wait_cycles_per_iteration = *alone.*wait;
    if (fetches) cost.wait_cycles_per_iteration = *alone.*wait;
    return Done{};
  };
  auto added = add(cost.as_written, &CacheCost::unfetched_wait_cycles_per_iteration, false);
  return added ? add(cost.scheduled, &CacheCost::wait_cycles_per_iteration, true) : added;
}

}  // namespace

Result<KernelCost> PriceTrace(const Trace& recorded, uint32_t iterations, const PricedCore& core,
                              const PriceRules& rules) {
  KernelCost cost;
  cost.iterations = std::max(iterations, 1u);
  cost.register_limit = core.register_limit;
  cost.as_written.fixed_cycles = cost.scheduled.fixed_cycles = core.call_cycles;
  cost.operations = CountSeen(recorded);
  const Trace trace = InWrittenOrder(recorded);
  if (trace.operations.empty()) return cost;
  const std::vector<Window> windows = PlaceWindows(trace, cost.iterations, rules);
  const double operations_per_iteration = double(CountSeen(trace)) / cost.iterations;
  IssueTotals totals;
  IssueChart last;
  for (const Window& window : windows) {
    const auto large = TimeStretch(trace, window.begin, window.end, window.iterations, core, rules);
    if (!large) return Failure{large.error()};
    const auto small = window.whole ? large
                                    : TimeStretch(trace, window.begin, window.middle,
                                                  window.iterations / 2, core, rules);
    if (!small) return Failure{small.error()};
    const double share = operations_per_iteration / double(windows.size());
    cost.instructions_per_iteration += large->instructions / large->operations * share;
    const auto add = [&](CodeCycles Timed::*code, CodePrice& price) {
      AddPrice(*small, *large, code, window.whole, share, uint32_t(windows.size()), price);
    };
    add(&Timed::as_written, cost.as_written);
    add(&Timed::scheduled, cost.scheduled);
    NoteWindow(*large, window.iterations, core, cost, totals);
    last = large->chart;
  }
  if (core.caches)
    if (const auto added = AddCaches(trace, core, cost); !added) return Failure{added.error()};
  cost.divides_per_iteration = double(CountOf(trace, RecordedKind::kDivide)) / cost.iterations;
  cost.roots_per_iteration =
      double(CountOf(trace, RecordedKind::kReciprocalRoot)) / cost.iterations;
  cost.dual_issue_rate = totals.DualIssueRate();
  cost.binding = BindingResource(last, totals);
  cost.busiest_unit_share =
      double(*std::max_element(totals.pipe_cycles.begin(), totals.pipe_cycles.end())) /
      double(totals.cycles);
  return cost;
}

Result<KernelCost> KnownPrices::Find(const Trace& trace, uint32_t iterations,
                                     const PricedCore& core, const PriceRules& rules) {
  std::array<uint64_t, 2> key = {iterations, trace.value_count};
  const auto add = [&](uint32_t high, uint32_t low) {
    const uint64_t words = uint64_t(high) << 32 | low;
    for (uint64_t& half : key) half = MixSeed(half, words);
  };
  for (const RecordedOperation& op : trace.operations) {
    add(uint32_t(op.kind) << 24 | uint32_t(op.size_bytes) << 16 | uint32_t(op.operand_count) << 8 |
            op.result_count,
        op.result);
    add(op.operand[0], op.operand[1]);
    add(op.operand[2], op.operand[3]);
    add(uint32_t(op.address), op.bits ^ (op.is_side ? ~0u : 0u));
  }
  const auto known = costs_.find(key);
  if (known != costs_.end()) return known->second;
  const auto cost = PriceTrace(trace, iterations, core, rules);
  if (cost) costs_.emplace(key, *cost);
  return cost;
}

Result<ScheduledWindow> ScheduleWindow(const Trace& recorded, uint32_t iterations,
                                       const PricedCore& core, const PriceRules& rules) {
  const Trace trace = InWrittenOrder(recorded);
  const Window window = PlaceWindows(trace, iterations, rules).front();
  const auto simple = SimplifyTrace(trace, window.begin, window.end,
                                    {.fuse_multiply_add = !rules.lowering.host_operations});
  const LoweredCode lowered = LowerTo(core, simple, window.iterations, rules.lowering);
  ScheduledWindow out;
  auto code = ScheduleIterations(lowered.code, window.iterations, core.scheduling);
  if (!code) return Failure{code.error()};
  auto chart = core.scheduling.time(code->program);
  if (!chart) return Failure{chart.error()};
  for (const uint32_t origin : code->origin)
    out.name.push_back(origin == kSpillStore  ? "(spill)"
                       : origin == kSpillLoad ? "(reload)"
                       : origin == kPadding   ? "(padding)"
                                              : lowered.name[origin]);
  out.lowered = lowered.code;
  out.code = *std::move(code);
  out.chart = *std::move(chart);
  return out;
}

}  // namespace pelt
