// The frame scheduler in every interleaving of small frames, over the source that ships; and
// schedulers and graphs that are wrong in one way each, which the same search must catch.
//
// Promised, and checked in each interleaving: an item runs exactly once per frame, and not before
// every item that its pass's waits are about is done, and what those wrote is visible to it; a
// frame's data is read only between its beginning and its end, also by a thread that slept through
// a frame; the frame ends.
#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "jobs/frame_scheduler.hpp"
#include "jobs/plan.hpp"
#include "tests/jobs/interleavings.hpp"

namespace pelt {
namespace {

using namespace testing;

// A frame: layers of so many chunks, and passes with their waits.
struct FrameCase {
  std::vector<uint32_t> chunks;
  std::vector<std::pair<Domain, std::vector<Wait>>> passes;
  std::vector<Wait> waits_of_end;
};
struct Case {
  std::vector<FrameCase> frames;
  uint32_t helpers = 1;
};
using Tamper = void (*)(FrameGraph&);

// A case with its graphs and, found without them, what each item waits for.
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

  SceneShape shape;
  Plan plan;
};

// What the frame's owner and the helpers share, besides the scheduler.
template <class Scheduler>
class Course {
 public:
  Course(const Case& c, Tamper tamper) : frame_(Model::NewCell()) {
    for (const FrameCase& frame : c.frames) {
      const FrameOrder& order = orders_.emplace_back(frame, tamper);
      auto& passes = cells_.emplace_back();
      for (uint32_t p = 0; p < order.plan.passes.size(); ++p) {
        auto& cells = passes.emplace_back();
        for (uint32_t i = 0; i < order.Items(p); ++i) cells.push_back(Model::NewCell());
      }
    }
  }

  void Own() {
    for (uint32_t f = 0; f < orders_.size(); ++f) {
      Model::Check(scheduler_.TakeForFrame(), "a finished scheduler refuses the next frame");
      Model::Write(frame_, f);
      scheduler_.Start(orders_[f].plan.graph, [] {});
      const size_t start = Model::LoopStart();
      const PullResult result = TryRun(0);
      if (result != PullResult::kIdle) Model::Repeat(start, result == PullResult::kNothingReady);
      for (const auto& pass : cells_[f])
        for (const uint32_t item : pass)
          Model::Check(Model::Read(item) == kDone, "a frame ended with an item that was not run");
      Model::Write(frame_, kNoFrame);  // the caller does with it what it likes
    }
  }
  void Help(uint32_t worker) {
    const size_t start = Model::LoopStart();
    Model::Repeat(start, TryRun(worker) != PullResult::kRan);
  }

 private:
  static constexpr uint64_t kNoFrame = 99;
  enum : uint64_t { kUntouched, kRunning, kDone };

  PullResult TryRun(uint32_t worker) {
    typename Scheduler::Claim claim;
    const PullResult result = scheduler_.TryClaim(worker, claim);
    if (result != PullResult::kRan) return result;
    const uint64_t f = Model::Read(frame_);
    if (f == kNoFrame) {
      Model::Check(false, "an item was claimed though no frame is open");
      return PullResult::kIdle;
    }
    const FrameGraph& graph = orders_[f].plan.graph;
    const FrameGraph::Word& word = graph.words[claim.word];
    const uint32_t item = graph.items[word.first + claim.bit];
    RunItem(f, word.pass, item);
    scheduler_.Finish(graph, graph.item_node[graph.pass_first[word.pass] + item], [] {});
    return result;
  }

  void RunItem(uint64_t f, uint32_t pass, uint32_t item) {
    for (const auto [before_pass, before] : orders_[f].WaitedFor(pass, item))
      Model::Check(Model::Read(cells_[f][before_pass][before]) == kDone,
                   "an item ran before one that it waits for was done");
    const uint32_t cell = cells_[f][pass][item];
    Model::Check(Model::Read(cell) == kUntouched, "an item ran twice");
    Model::Write(cell, kRunning);
    Model::Pause();
    Model::Write(cell, kDone);
  }

  Scheduler scheduler_{2, 64, 32};
  uint32_t frame_;
  std::vector<FrameOrder> orders_;
  std::vector<std::vector<std::vector<uint32_t>>> cells_;  // of frames, passes, items
};

template <template <class> class Atomic>
std::string Explore(const Case& c, uint64_t* states = nullptr, Tamper tamper = nullptr) {
  return Model::Explore(
      [&c, tamper] {
        auto course = std::make_shared<Course<FrameScheduler<Atomic>>>(c, tamper);
        std::vector<Model::Thread> threads{[course] { course->Own(); }};
        for (uint32_t h = 1; h <= c.helpers; ++h)
          threads.push_back([course, h] { course->Help(h); });
        return threads;
      },
      states);
}

constexpr Domain kScene = Domain::kScene, kLayer = Domain::kLayer, kChunk = Domain::kChunk;

// A pass that waits for all of the one before, as a barrier would.
const Case kBarrier{{{{2}, {{kChunk, {}}, {kChunk, {{0, kScene}}}}, {{1, kScene}}}}, 1};
// Chunks and their layers, each layer by itself.
const Case kLayers{{{{1, 1}, {{kChunk, {}}, {kLayer, {{0, kLayer}}}}, {{1, kScene}}}}, 1};
const Case kEachItem{{{{2}, {{kChunk, {}}, {kChunk, {{0, kChunk}}}}, {{1, kScene}}}}, 1};
const Case kThreeThreads{{{{1}, {{kChunk, {}}, {kLayer, {{0, kLayer}}}}, {{1, kScene}}}}, 2};
const Case kTwoFrames{{{{1}, {{kChunk, {}}, {kLayer, {{0, kLayer}}}}, {{1, kScene}}},
                       {{2}, {{kChunk, {}}}, {{0, kScene}}}},
                      1};
const Case kNothing{{{{}, {{kChunk, {}}, {kScene, {{0, kScene}}}}, {{1, kScene}}},
                     {{}, {}, {}},
                     {{0, 1}, {{kChunk, {}}, {kLayer, {{0, kLayer}}}}, {{0, kScene}, {1, kScene}}}},
                    1};

TEST(SchedulerModel, EveryInterleavingKeepsItsPromises) {
  const std::pair<const char*, const Case*> cases[] = {
      {"a pass after another", &kBarrier},
      {"layers by themselves", &kLayers},
      {"an item after itself", &kEachItem},
      {"three threads", &kThreeThreads},
      {"a helper that crosses from frame to frame", &kTwoFrames},
      {"empty passes, layers and frames", &kNothing}};
  for (const auto& [name, c] : cases) {
    uint64_t states = 0;
    EXPECT_EQ(Explore<ModelAtomic>(*c, &states), "") << name;
    std::printf("%-45s %8llu states\n", name, static_cast<unsigned long long>(states));
    EXPECT_GT(states, 100u) << name;
  }
}

// ---- What is wrong ------------------------------------------------------------------------------

enum class Flaw {
  kNone,
  kTakesInTwoSteps,  // a bit is looked at, and then taken
  kTakesRelaxed,     // what opened an item is not acquired by who takes it
  kOpensRelaxed,     // an item is opened without release
  kCountsRelaxed,    // what an item wrote is not released to what waits for it
  kStoresRelaxed,    // the end of a frame is not released
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
  };
};

const Case* const kAll[] = {&kBarrier, &kLayers, &kTwoFrames, &kThreeThreads};

// The first fault that any of the cases shows.
template <Flaw kFlaw>
std::string FaultOf() {
  for (const Case* c : kAll) {
    std::string fault = Explore<Flawed<kFlaw>::template Atomic>(*c);
    if (!fault.empty()) return fault;
  }
  return "";
}
std::string FaultOf(Tamper tamper) {
  for (const Case* c : kAll) {
    std::string fault = Explore<ModelAtomic>(*c, nullptr, tamper);
    if (!fault.empty()) return fault;
  }
  return "";
}

constexpr const char *kNeverEnds = "it never ends: every thread waits",
                     *kReadBesideWrite = "a race: a read beside a write",
                     *kTooEarly = "an item ran before one that it waits for was done",
                     *kNotRun = "a frame ended with an item that was not run";

TEST(SchedulerModel, CatchesEveryFlaw) {
  EXPECT_EQ(Explore<Flawed<Flaw::kNone>::Atomic>(kBarrier), "")
      << "without a flaw it is the scheduler that ships";
  EXPECT_EQ(FaultOf<Flaw::kTakesInTwoSteps>(), kReadBesideWrite);
  EXPECT_EQ(FaultOf<Flaw::kTakesRelaxed>(), kReadBesideWrite);
  EXPECT_EQ(FaultOf<Flaw::kOpensRelaxed>(), kReadBesideWrite);
  EXPECT_EQ(FaultOf<Flaw::kCountsRelaxed>(), kReadBesideWrite);
  EXPECT_EQ(FaultOf<Flaw::kStoresRelaxed>(), kReadBesideWrite);
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
            kReadBesideWrite)
      << "everything is opened at the beginning";
  const Case early_end{{{{2}, {{kChunk, {}}, {kChunk, {{0, kScene}}}}, {{0, kScene}}}}, 1};
  EXPECT_EQ(Explore<ModelAtomic>(early_end), kNotRun) << "an end that does not wait for all";
}

// The checker by itself: what it must find, and what it must not.
TEST(Interleavings, FindsARaceAndKnowsOrder) {
  const auto message = [](std::memory_order publish) {
    return Model::Explore([publish] {
      const uint32_t flag = Model::NewAtomic(0), cell = Model::NewCell();
      return std::vector<Model::Thread>{[=] {
                                          while (!Model::Load(flag, std::memory_order_acquire))
                                            Model::AwaitWrite();
                                          Model::Check(Model::Read(cell) == 7, "old");
                                        },
                                        [=] {
                                          Model::Write(cell, 7);
                                          Model::Store(flag, 1, publish);
                                        }};
    });
  };
  EXPECT_EQ(message(std::memory_order_release), "");
  EXPECT_EQ(message(std::memory_order_relaxed), "a race: a read beside a write");
}

TEST(Interleavings, FindsALostUpdateAndAWaitForNothing) {
  EXPECT_EQ(Model::Explore([] {
              const uint32_t a = Model::NewAtomic(0), done = Model::NewAtomic(0);
              const auto add = [=] {
                Model::Store(a, Model::Load(a, std::memory_order_relaxed) + 1,
                             std::memory_order_relaxed);
                Model::FetchModify(
                    done, [](uint64_t v) { return v + 1; }, std::memory_order_relaxed);
              };
              return std::vector<Model::Thread>{
                  [=] {
                    add();
                    while (Model::Load(done, std::memory_order_relaxed) != 2) Model::AwaitWrite();
                    Model::Check(Model::Load(a, std::memory_order_relaxed) == 2, "a lost update");
                  },
                  add};
            }),
            "a lost update");
  EXPECT_EQ(Model::Explore([] {
              const uint32_t a = Model::NewAtomic(0);
              return std::vector<Model::Thread>{[=] {
                while (!Model::Load(a, std::memory_order_relaxed)) Model::AwaitWrite();
              }};
            }),
            "it never ends: every thread waits");
}

}  // namespace
}  // namespace pelt
