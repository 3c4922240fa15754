// The frame scheduler and the frame's phase on a simulated weak memory, over the sources that ship:
// Relacy runs small frames in random schedules, where a load may see any value that the C++ memory
// model allows, also an old one. Then schedulers and graphs that are wrong in one way each, which the
// same search must catch.
//
// Promised, and checked in each schedule: an item runs exactly once per frame, and not before every
// item that its pass's waits are about is done, and what those wrote is visible to it; a frame's data
// is read only between its beginning and its end, also by a thread that slept through a frame; the
// frame ends; of several threads that begin a frame one does, and the next sees what it wrote.
#include <gtest/gtest.h>

#include <cstdlib>
#include <deque>
#include <ostream>

#include "jobs/frame.hpp"
#include "jobs/frame_scheduler.hpp"
#include "jobs/plan.hpp"

// Not relacy.hpp: it defines `new`, `assert` and the memory orders as macros.
// clang-format off
#include <relacy/base.hpp>
#include <relacy/context.hpp>
#include <relacy/context_base_impl.hpp>
#include <relacy/backoff.hpp>
#include <relacy/atomic_fence.hpp>
#include <relacy/atomic.hpp>
#include <relacy/var.hpp>
#include <relacy/thread_local.hpp>
#include <relacy/test_suite.hpp>
#include <relacy/dyn_thread.hpp>
#include <relacy/stdlib/mutex.hpp>
#include <relacy/stdlib/condition_variable.hpp>
#include <relacy/stdlib/semaphore.hpp>
#include <relacy/stdlib/event.hpp>
#include <relacy/stdlib/windows.hpp>
#include <relacy/stdlib/pthread.hpp>
// clang-format on

// Not anonymous: the schedulers made of its types are declared in headers.
namespace pelt::model {

constexpr uint32_t kMostThreads = 3;
// Schedules of each search.
uint32_t Schedules() {
  const char* asked = std::getenv("PELT_SCHEDULES");
  return asked ? uint32_t(std::atoi(asked)) : 5000;
}

// A frame: layers of so many chunks, and passes with their waits.
struct FrameCase {
  std::vector<uint32_t> chunks;
  std::vector<std::pair<Domain, std::vector<Wait>>> passes;
  std::vector<Wait> waits_of_end;
};
struct Case {
  std::vector<FrameCase> frames;
  uint32_t threads = 2;
};
using Tamper = void (*)(FrameGraph&);

// A frame with its graph and, found without that, what each item waits for.
struct FrameOrder {
  struct Item {
    uint32_t pass, item;
  };
  FrameOrder(const FrameCase& c, Tamper tamper) {
    for (const uint32_t chunks : c.chunks) shape.AddLayer(0, 0, chunks);
    for (const auto& [domain, waits] : c.passes)
      plan.passes.push_back({0, 1, domain, {}, 0, 0, 0, false, waits});
    plan.waits_of_end = c.waits_of_end;
    plan.graph = BuildGraph(plan, shape);
    if (tamper) tamper(plan.graph);
  }
  uint32_t Items(uint32_t pass) const { return shape.ItemCount(plan.passes[pass].domain); }
  uint32_t ItemCount() const { return uint32_t(plan.graph.items.size()); }
  uint32_t UnitOf(uint32_t pass, uint32_t item, Domain unit) const {
    const Domain domain = plan.passes[pass].domain;
    if (unit == Domain::kScene) return 0;
    return unit == domain ? item : shape.LayerOf(domain, item);
  }
  std::vector<Item> WaitedFor(uint32_t pass, uint32_t item) const {
    std::vector<Item> items;
    for (const Wait& wait : plan.passes[pass].waits)
      for (uint32_t i = 0; i < Items(wait.pass); ++i)
        if (UnitOf(wait.pass, i, wait.within) == UnitOf(pass, item, wait.within))
          items.push_back({wait.pass, i});
    return items;
  }
  // Numbers the items of all passes.
  uint32_t At(uint32_t pass, uint32_t item) const { return plan.graph.pass_first[pass] + item; }

  SceneShape shape;
  Plan plan;
};

// Stands in for std::atomic.
template <class T>
class ModelAtomic {
 public:
  explicit ModelAtomic(T value = {}) { value_.store(value, rl::mo_relaxed, $); }
  T load(std::memory_order order) const { return value_.load(Of(order), $); }
  void store(T value, std::memory_order order) { value_.store(value, Of(order), $); }
  T fetch_sub(T value, std::memory_order order) { return value_($).fetch_sub(value, Of(order)); }
  T fetch_and(T value, std::memory_order order) { return value_($).fetch_and(value, Of(order)); }
  T fetch_or(T value, std::memory_order order) { return value_($).fetch_or(value, Of(order)); }
  bool compare_exchange_strong(T& expected, T desired, std::memory_order success,
                               std::memory_order failure) {
    return value_($).compare_exchange_strong(expected, desired, Of(success), Of(failure));
  }
  bool compare_exchange_strong(T& expected, T desired,
                               std::memory_order order = std::memory_order_seq_cst) {
    return compare_exchange_strong(expected, desired, order, order);
  }

 private:
  static rl::memory_order Of(std::memory_order order) {
    switch (order) {
      case std::memory_order_relaxed:
        return rl::mo_relaxed;
      case std::memory_order_acquire:
        return rl::mo_acquire;
      case std::memory_order_release:
        return rl::mo_release;
      case std::memory_order_acq_rel:
        return rl::mo_acq_rel;
      default:
        return rl::mo_seq_cst;
    }
  }
  rl::atomic<T> value_;
};
using Cell = rl::var<uint32_t>;

// What a schedule runs, and the first broken promise of the search.
const std::deque<FrameOrder>* current_orders = nullptr;
uint32_t current_threads = 0;
const char* fault = "";

void Check(bool holds, const char* otherwise) {
  if (holds) return;
  fault = otherwise;
  RL_ASSERT(!"a promise was broken");
}

// Thread 0 owns the frames, the others help until it says that there will be none.
template <template <class> class Atomic>
struct Frames : rl::test_suite<Frames<Atomic>, kMostThreads> {
  using Scheduler = FrameScheduler<Atomic>;
  enum : uint32_t { kUntouched, kRunning, kDone, kNoFrame = 99 };

  void before() {
    frame($) = uint32_t(kNoFrame);
    for (const FrameOrder& order : *current_orders)
      for (auto* c = &cells.emplace_back(order.ItemCount()); Cell & cell : *c)
        cell($) = uint32_t(kUntouched);
  }
  void thread(unsigned index) {
    if (index == 0) {
      Own();
      over.store(1, std::memory_order_release);
    } else if (index < current_threads) {
      while (!over.load(std::memory_order_acquire))
        if (TryRun(index) != PullResult::kRan) rl::yield(1, $);
    }
  }

  void Own() {
    for (uint32_t f = 0; f < current_orders->size(); ++f) {
      Check(scheduler.TakeForFrame(), "a finished scheduler refuses the next frame");
      frame($) = f;
      scheduler.Start((*current_orders)[f].plan.graph, [] {});
      while (!scheduler.IsIdle())
        if (TryRun(0) != PullResult::kRan) rl::yield(1, $);
      for (Cell& cell : cells[f])
        Check(cell($) == uint32_t(kDone), "a frame ended with an item that was not run");
      frame($) = uint32_t(kNoFrame);  // the caller does with it what it likes
    }
  }
  PullResult TryRun(uint32_t worker) {
    typename Scheduler::Claim claim;
    const PullResult result = scheduler.TryClaim(worker, claim);
    if (result != PullResult::kRan) return result;
    const uint32_t f = frame($);
    Check(f != kNoFrame, "an item was claimed though no frame is open");
    const FrameOrder& order = (*current_orders)[f];
    const FrameGraph& graph = order.plan.graph;
    const FrameGraph::Word& word = graph.words[claim.word];
    RunItem(f, order, word.pass, graph.items[word.first + claim.bit]);
    scheduler.Finish(graph, graph.item_node[graph.AtItem(claim.word, claim.bit)], [] {});
    return result;
  }
  void RunItem(uint32_t f, const FrameOrder& order, uint32_t pass, uint32_t item) {
    for (const auto [before_pass, before] : order.WaitedFor(pass, item))
      Check(cells[f][order.At(before_pass, before)]($) == uint32_t(kDone),
            "an item ran before one that it waits for was done");
    Cell& cell = cells[f][order.At(pass, item)];
    Check(cell($) == uint32_t(kUntouched), "an item ran twice");
    cell($) = uint32_t(kRunning);
    cell($) = uint32_t(kDone);
  }

  Scheduler scheduler{2, 1, 1};  // a larger frame moves to larger memory
  Atomic<uint32_t> over;
  Cell frame;
  std::deque<std::deque<Cell>> cells;  // of frames, items
};

// Threads that each want a frame of their own, and one that changes the scene between two.
template <template <class> class Atomic>
struct Phases : rl::test_suite<Phases<Atomic>, kMostThreads> {
  void before() { scene($) = 0u; }
  void thread(unsigned index) {
    if (index == 0) {
      while (phase.StartChange()) rl::yield(1, $);
      scene($) = scene($) + 1;
      phase.EndFilling(false);
      return;
    }
    while (phase.StartFilling()) rl::yield(1, $);
    const uint32_t seen = scene($);
    phase.EndFilling(true);
    Check(phase.StartFilling(), "a frame was begun twice");
    Check(!phase.StartRun(), "a frame that was begun may not run");
    scene($) = seen + 1;
    phase.EndRun();
  }
  void after() { Check(scene($) == kMostThreads, "a frame did not see what another wrote"); }

  FramePhaseOf<Atomic> phase;
  Cell scene;
};

// The first broken promise in so many schedules, or an empty text.
template <class Suite>
std::string Search() {
  std::ostream silent(nullptr);
  rl::test_params params;
  params.iteration_count = Schedules();
  params.execution_depth_limit = 20000;
  params.output_stream = params.progress_stream = &silent;
  rl::simulate<Suite>(params);
  if (params.test_result == rl::test_result_success) return "";
  return params.test_result == rl::test_result_user_assert_failed
             ? fault
             : rl::test_result_str(params.test_result);
}
template <template <class> class Atomic>
std::string Search(const Case& c, Tamper tamper = nullptr) {
  std::deque<FrameOrder> orders;
  for (const FrameCase& frame : c.frames) orders.emplace_back(frame, tamper);
  current_orders = &orders;
  current_threads = c.threads;
  return Search<Frames<Atomic>>();
}

constexpr Domain kScene = Domain::kScene, kLayer = Domain::kLayer, kChunk = Domain::kChunk;

// A pass that waits for all of the one before, as a barrier would.
const Case kBarrier{{{{2}, {{kChunk, {}}, {kChunk, {{0, kScene}}}}, {{1, kScene}}}}, 3};
// Chunks and their layers, each layer by itself.
const Case kLayers{{{{1, 1}, {{kChunk, {}}, {kLayer, {{0, kLayer}}}}, {{1, kScene}}}}, 3};
const Case kEachItem{{{{2}, {{kChunk, {}}, {kChunk, {{0, kChunk}}}}, {{1, kScene}}}}, 2};
const Case kTwoFrames{{{{1}, {{kChunk, {}}, {kLayer, {{0, kLayer}}}}, {{1, kScene}}},
                       {{2}, {{kChunk, {}}}, {{0, kScene}}}},
                      2};
const Case kNothing{{{{}, {{kChunk, {}}, {kScene, {{0, kScene}}}}, {{1, kScene}}},
                     {{}, {}, {}},
                     {{0, 1}, {{kChunk, {}}, {kLayer, {{0, kLayer}}}}, {{0, kScene}, {1, kScene}}}},
                    3};

TEST(SchedulerModel, KeepsItsPromisesInEverySchedule) {
  const std::pair<const char*, const Case*> cases[] = {
      {"a pass after another", &kBarrier},
      {"layers by themselves", &kLayers},
      {"an item after itself", &kEachItem},
      {"a helper that crosses from frame to frame", &kTwoFrames},
      {"empty passes, layers and frames", &kNothing}};
  for (const auto& [name, c] : cases) EXPECT_EQ(Search<ModelAtomic>(*c), "") << name;
}
TEST(PhaseModel, OneThreadAtATime) { EXPECT_EQ(Search<Phases<ModelAtomic>>(), ""); }

// ---- What is wrong ------------------------------------------------------------------------------

enum class Flaw {
  kNone,
  kTakesInTwoSteps,  // a bit is looked at, and then taken
  kTakesRelaxed,     // what opened an item is not acquired by who takes it
  kOpensRelaxed,     // an item is opened without release
  kCountsRelaxed,    // what an item wrote is not released to what waits for it
  kStoresRelaxed,    // the end of a frame is not released
  kBeginsRelaxed,    // the end of the frame before is not acquired
};

template <Flaw kFlaw>
struct Flawed {
  template <class T>
  struct Atomic : ModelAtomic<T> {
    using Base = ModelAtomic<T>;
    using Base::Base;
    static std::memory_order Order(Flaw relaxed, std::memory_order order) {
      return kFlaw == relaxed ? std::memory_order_relaxed : order;
    }
    void store(T value, std::memory_order order) {
      Base::store(value, Order(Flaw::kStoresRelaxed, order));
    }
    T fetch_sub(T value, std::memory_order order) {
      return Base::fetch_sub(value, Order(Flaw::kCountsRelaxed, order));
    }
    T fetch_or(T value, std::memory_order order) {
      return Base::fetch_or(value, Order(Flaw::kOpensRelaxed, order));
    }
    T fetch_and(T value, std::memory_order order) {
      if (kFlaw != Flaw::kTakesInTwoSteps)
        return Base::fetch_and(value, Order(Flaw::kTakesRelaxed, order));
      const T before = Base::load(order);
      Base::store(before & value, std::memory_order_release);
      return before;
    }
    template <class... Orders>
    bool compare_exchange_strong(T& expected, T desired, std::memory_order order,
                                 Orders... orders) {
      return Base::compare_exchange_strong(expected, desired, Order(Flaw::kBeginsRelaxed, order),
                                           Order(Flaw::kBeginsRelaxed, orders)...);
    }
  };
};

const Case* const kAll[] = {&kBarrier, &kLayers, &kTwoFrames};

// The first fault that any of the cases shows.
template <template <class> class Atomic = ModelAtomic>
std::string FaultOf(Tamper tamper = nullptr) {
  for (const Case* c : kAll)
    if (std::string found = Search<Atomic>(*c, tamper); !found.empty()) return found;
  return "";
}

constexpr const char *kRace = "DATA RACE", *kNeverEnds = "LIVELOCK",
                     *kNotVisible = "ACCESS TO FREED MEMORY",  // or not yet made, to its reader
                         *kTooEarly = "an item ran before one that it waits for was done";

TEST(SchedulerModel, CatchesEveryFlaw) {
  EXPECT_EQ(FaultOf<Flawed<Flaw::kNone>::Atomic>(), "") << "without a flaw it is what ships";
  EXPECT_EQ(FaultOf<Flawed<Flaw::kTakesInTwoSteps>::Atomic>(), kRace);
  EXPECT_EQ(FaultOf<Flawed<Flaw::kTakesRelaxed>::Atomic>(), kRace);
  EXPECT_EQ(FaultOf<Flawed<Flaw::kOpensRelaxed>::Atomic>(), kRace);
  EXPECT_EQ(FaultOf<Flawed<Flaw::kCountsRelaxed>::Atomic>(), kRace);
  EXPECT_EQ(FaultOf<Flawed<Flaw::kStoresRelaxed>::Atomic>(), kNotVisible);
}
TEST(PhaseModel, CatchesEveryFlaw) {
  EXPECT_EQ(Search<Phases<Flawed<Flaw::kStoresRelaxed>::Atomic>>(), kRace);
  EXPECT_EQ(Search<Phases<Flawed<Flaw::kBeginsRelaxed>::Atomic>>(), kRace);
}

// The node that the first item of the first pass counts for.
FrameGraph::Node& FirstEnd(FrameGraph& graph) { return graph.nodes[graph.item_node[0]]; }

TEST(SchedulerModel, CatchesEveryWrongGraph) {
  EXPECT_EQ(FaultOf([](FrameGraph& graph) {
              if (!graph.items.empty() && FirstEnd(graph).waits_for > 1)
                --FirstEnd(graph).waits_for;
            }),
            kTooEarly)
      << "a count one short";
  EXPECT_EQ(FaultOf([](FrameGraph& graph) {
              if (!graph.items.empty()) ++FirstEnd(graph).waits_for;
            }),
            kNeverEnds)
      << "a count one too many";
  EXPECT_EQ(FaultOf([](FrameGraph& graph) {
              for (FrameGraph::Open& open : graph.opens) open.bits &= open.bits - 1;
            }),
            kNeverEnds)
      << "items that are never opened";
  EXPECT_EQ(FaultOf([](FrameGraph& graph) {  // the first node has all opens, the others none
              for (FrameGraph::Node& node : graph.nodes)
                node.first_open = uint32_t(graph.opens.size());
              graph.nodes.front().first_open = 0;
            }),
            kRace)
      << "everything is opened at the beginning";
  const Case early_end{{{{2}, {{kChunk, {}}, {kChunk, {{0, kScene}}}}, {{0, kScene}}}}, 2};
  EXPECT_EQ(Search<ModelAtomic>(early_end), kRace) << "an end that does not wait for all";
}

}  // namespace pelt::model
