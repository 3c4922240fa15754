// What a kernel costs on a core, from one item's trace.
//
// The trace is put in the order its source was written in, regardless of which compiler built the kernels
// (trace.hpp). A few windows of it, spread over it, are lowered, put on registers and
// timed, as they are written and scheduled: the two ends of every price. What compilers and hands
// reached lies between (measured_kernels.hpp). A window begins and ends where the
// fewest values are alive, which is between two iterations of a loop. Each is taken twice, once
// twice as long: the difference is what further iterations cost once the pipeline is full, free of
// filling and draining it; what the short one costs beyond that is the fixed part.
//
//   trace  |--------[=====|=====]------------[=====|=====]------------[=====|=====]-------|
//                    short              cycles per operation = (long - short) / their operations
//                    long       .
//
// Invariant: depends on the trace and the core only. A trace that fits one window is taken whole.
// What breaks if windows are too short: the schedule has too few iterations to overlap, and a
// kernel whose steps wait for each other looks slower than it is.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "platform_sim/platforms/xenon.hpp"
#include "platform_sim/pricing/priced_core.hpp"
#include "platform_sim/pricing/trace.hpp"
#include "platform_sim/schedule/straight_code.hpp"

namespace pelt {

// What first-level caches add to a kernel's price, from the addresses that its recording touched.
//
// A frame brings an item's blocks into the second level while the item before it is worked on
// (frame/console_machine.cpp). From there a kernel brings each line into the first level by a dcbt,
// as early as two times the way takes: that is one more instruction on the load/store unit for each
// line, and what waiting is left where lines come faster than misses may be outstanding, or than
// the second level gives them. Without the dcbt the first load of every line waits: both are reported.
//
// Invariant: the trace runs at the pace of its scheduled code, evenly. Load-hit-stores are not in
// it: the core's issue model has counted them.

struct CacheCost {
  double lines_per_iteration = 0.0;                  // that come into the first level
  double wait_cycles_per_iteration = 0.0;            // with a dcbt for each line: what is added
  double unfetched_wait_cycles_per_iteration = 0.0;  // without
};

// One item of `iterations` iterations that takes `cycles_per_iteration` when every access hits the
// first level.
// `threads`: that do the same on one core at the same time, each on data of its own. Caches
// that cannot be are refused.
Result<CacheCost> PriceCaches(const Trace& trace, uint32_t iterations, double cycles_per_iteration,
                              uint32_t threads, const CacheMemoryParameters& caches);

// How much of a trace is code of its own: loops inside an iteration are in it once for every time round.
//
// Idea: operations of the same kinds, in the same order, so many of them that it is no chance, are the same code run
// again: a loop of the source over substeps or short steps of a strike, or a function that is called from two places.
// A local store holds it once.
//
// Invariant: code that comes again within kLongEnough operations counts each time. Loops as short as that are priced
// as written out, so that their rounds overlap.

// Fewer cannot be distinguished from chance, and gain more written out than their code is worth.
inline constexpr uint32_t kLongEnough = 256;

// The share of the operations [begin, end) that did not come before. Only what is up to `furthest` operations back
// counts: one iteration, because iterations are interleaved, and each has code of its own.
double ShareOfOwnCode(const Trace& trace, uint32_t begin, uint32_t end, uint32_t furthest);

struct PriceRules {
  LoweringRules lowering;
  uint32_t windows = 3;
  // Of the long one: two groups of as many strands as a kernel may work on at once (core/kernels/unrolled.hpp). More
  // overlap better and need more code and registers.
  uint32_t iterations = 8;
  uint32_t window_operations = 3000;
};

inline constexpr uint32_t kLoopIterations = 2;

// Cycles of code that is ordered one way.
struct CodePrice {
  double cycles_per_iteration = 0.0;
  double shared_cycles_per_iteration =
      0.0;                    // beside the other hardware thread; without one: the same
  double fixed_cycles = 0.0;  // the call, and filling and draining
};

struct KernelCost {
  uint64_t operations = 0;  // recorded on the item, needed or not
  uint32_t iterations = 0;  // of the item; four strands each
  double instructions_per_iteration = 0.0;
  // In the order of the source, one iteration after the other; and the best schedule that is found.
  CodePrice as_written, scheduled;
  // Of a core with caches (below), in the cycles above: as written nothing is fetched
  // ahead, in the scheduled code every line is.
  double lines_per_iteration = 0.0;
  double wait_cycles_per_iteration = 0.0, unfetched_wait_cycles_per_iteration = 0.0;
  double divides_per_iteration = 0.0, roots_per_iteration = 0.0;
  double dual_issue_rate = 0.0;     // scheduled
  std::string_view binding;         // BindingResource of the scheduled code
  double busiest_unit_share = 0.0;  // of the scheduled cycles in which the busiest unit works
  uint32_t most_live = 0, register_limit = 0;  // vectors
  uint32_t spill_stores = 0, spill_loads = 0;  // in the windows' scheduled code
  uint32_t window_iterations = 0;              // that were scheduled together
  // Of a loop over kLoopIterations iterations, which is what is interleaved, at the window's
  // density. Loops inside an iteration (solver iterations, points of a chain) are written out where they are short
  // and there once where they are long (below); filling and draining is left out.
  uint32_t code_bytes = 0;

  // Of `price`, spread over what was recorded.
  double PerOperation(double cycles_per_iteration) const {
    return operations ? cycles_per_iteration * iterations / double(operations) : 0.0;
  }
};

// A piece of a trace as scheduled, for a chart.
struct ScheduledWindow {
  StraightCode lowered;  // what `code` was made of
  FinishedCode code;
  std::vector<std::string_view> name;  // of each instruction of `code`
  IssueChart chart;
};

// `trace` is one item's, which has `iterations` iterations. Refused when code does not fit
// the core's registers.
Result<KernelCost> PriceTrace(const Trace& trace, uint32_t iterations, const PricedCore& core,
                              const PriceRules& rules);

// Prices of traces on one core by one set of rules, each found once: scenes that are priced after each other have
// most of their traces in common, and scheduling is all but a hundredth of a price. Known by 128 bits of each trace.
class KnownPrices {
 public:
  // As PriceTrace.
  Result<KernelCost> Find(const Trace& trace, uint32_t iterations, const PricedCore& core,
                          const PriceRules& rules);

 private:
  std::map<std::array<uint64_t, 2>, KernelCost> costs_;
};

// The first window of it, scheduled.
Result<ScheduledWindow> ScheduleWindow(const Trace& trace, uint32_t iterations,
                                       const PricedCore& core, const PriceRules& rules);

}  // namespace pelt
