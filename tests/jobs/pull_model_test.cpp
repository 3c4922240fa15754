// The pull scheduler in every interleaving of small frames, over the source that ships; and
// schedulers that are wrong in one way each, which the same search must catch.
//
// Promised, and checked in each interleaving: an item runs exactly once per frame, and not before
// every item of the pass before is done, and what those wrote is visible to it; a frame's data is
// read only between its beginning and its end, also by a thread that slept through a frame; the
// frame ends.
#include <gtest/gtest.h>

#include <memory>

#include "jobs/pull_scheduler.hpp"
#include "tests/jobs/interleavings.hpp"

namespace pelt {
namespace {

using namespace testing;

using FrameItems = std::vector<uint32_t>;  // items of each pass

struct Case {
  std::vector<FrameItems> frames;
  uint32_t helpers = 1;
};

// What the frame's owner and the helpers share, besides the scheduler.
template <class Scheduler>
class Course {
 public:
  explicit Course(const Case& c) : case_(c), frame_(Model::NewCell()) {
    for (const FrameItems& frame : c.frames) {
      auto& passes = items_.emplace_back();
      for (const uint32_t count : frame) {
        auto& cells = passes.emplace_back();
        for (uint32_t i = 0; i < count; ++i) cells.push_back(Model::NewCell());
      }
    }
  }

  void Own() {
    for (uint32_t f = 0; f < case_.frames.size(); ++f) {
      Model::Check(scheduler_.TakeForFrame(), "a finished scheduler refuses the next frame");
      Model::Write(frame_, f);
      scheduler_.Open(Passes{*this});
      const size_t start = Model::LoopStart();
      const PullResult result = TryRun();
      if (result != PullResult::kIdle) Model::Repeat(start, result == PullResult::kNothingReady);
      for (const auto& pass : items_[f])
        for (const uint32_t item : pass)
          Model::Check(Model::Read(item) == kDone, "a frame ended with an item that was not run");
      Model::Write(frame_, kNoFrame);  // the caller does with it what it likes
    }
  }
  void Help() {
    const size_t start = Model::LoopStart();
    Model::Repeat(start, TryRun() != PullResult::kRan);
  }

 private:
  static constexpr uint64_t kNoFrame = 99;
  enum : uint64_t { kUntouched, kRunning, kDone };

  struct Passes {
    Course& course;
    uint64_t Frame() const { return Model::Read(course.frame_); }
    uint32_t Count() const {
      const uint64_t f = Frame();
      return f == kNoFrame ? 0 : uint32_t(course.items_[f].size());
    }
    uint32_t Items(uint32_t pass) const {
      const uint64_t f = Frame();
      return f == kNoFrame || pass >= course.items_[f].size()
                 ? 0
                 : uint32_t(course.items_[f][pass].size());
    }
    void OnBegin(uint32_t) const {}
    void OnEnd(uint32_t) const {}
  };

  PullResult TryRun() {
    typename Scheduler::Item item;
    const Passes passes{*this};
    const PullResult result = scheduler_.TryClaim(item, passes);
    if (result != PullResult::kRan) return result;
    const uint64_t f = passes.Frame();
    Model::Check(f != kNoFrame, "an item was claimed though no frame is open");
    const uint32_t count = passes.Items(item.pass);
    if (f == kNoFrame || item.unclaimed == 0 || item.unclaimed > count) {
      Model::Check(false, "an item was claimed that the frame does not have");
      return PullResult::kIdle;
    }
    RunItem(f, item.pass, count - item.unclaimed);
    scheduler_.Finish(item.pass, passes);
    return result;
  }

  void RunItem(uint64_t f, uint32_t pass, uint32_t i) {
    const auto& passes = items_[f];
    if (pass > 0)
      for (const uint32_t before : passes[pass - 1])
        Model::Check(Model::Read(before) == kDone, "an item ran before the pass before was done");
    const uint32_t cell = passes[pass][i];
    Model::Check(Model::Read(cell) == kUntouched, "an item ran twice");
    Model::Write(cell, kRunning);
    Model::Pause();
    Model::Write(cell, kDone);
  }

  const Case& case_;
  Scheduler scheduler_;
  uint32_t frame_;
  std::vector<std::vector<std::vector<uint32_t>>> items_;  // cells: frame, pass, item
};

template <class Scheduler>
std::string Explore(const Case& c, uint64_t* states = nullptr) {
  return Model::Explore(
      [&c] {
        auto course = std::make_shared<Course<Scheduler>>(c);
        std::vector<Model::Thread> threads{[course] { course->Own(); }};
        for (uint32_t h = 0; h < c.helpers; ++h) threads.push_back([course] { course->Help(); });
        return threads;
      },
      states);
}

// The source that ships.
struct Shipped : PullScheduler<ModelAtomic> {
  template <class Passes>
  PullResult TryClaim(Item& item, const Passes&) {
    return PullScheduler::TryClaim(item);
  }
};

const Case kTwoByTwo{{{2, 2}}, 1};
const Case kThreeThreads{{{2, 1}}, 2};
const Case kTwoFrames{{{1, 2}, {2}}, 1};
const Case kEmptyPasses{{{0, 2, 0, 0, 1, 0}, {0}, {}, {1}}, 1};
const Case kThreeThreadsTwoFrames{{{2}, {1}}, 2};

TEST(PullModel, EveryInterleavingKeepsItsPromises) {
  const std::pair<const char*, const Case*> cases[] = {
      {"two threads, two passes of two items", &kTwoByTwo},
      {"three threads", &kThreeThreads},
      {"a helper that crosses from frame to frame", &kTwoFrames},
      {"empty passes and frames", &kEmptyPasses},
      {"two helpers that cross from frame to frame", &kThreeThreadsTwoFrames}};
  for (const auto& [name, c] : cases) {
    uint64_t states = 0;
    EXPECT_EQ(Explore<Shipped>(*c, &states), "") << name;
    std::printf("%-45s %8llu states\n", name, static_cast<unsigned long long>(states));
    EXPECT_GT(states, 100u) << name;
  }
}

// ---- Schedulers that are wrong ------------------------------------------------------------------

enum class Flaw {
  kNone,
  kCountsAfterOpening,  // the count of unfinished items is set when the ticket is out already
  kClaimsInTwoSteps,    // load and store instead of compare-exchange
  kSubtractsBlindly,    // takes one without looking whether there is one
  kReadsBeforeClaim,    // looks at the frame to decide whether to claim
  kOpensRelaxed,        // the ticket is published without release
  kFinishesRelaxed,     // what an item wrote is not released to the next pass
  kOpensWhenClaimed,    // the next pass opens when the last item is claimed, not when it is done
  kStopsAtEmptyPass,    // opens passes of no items, which nobody will finish
  kIdleTooEarly,        // says that the frame is over when its last item is claimed
};

template <Flaw kFlaw>
class FlawedScheduler {
 public:
  using Item = PullScheduler<ModelAtomic>::Item;

  bool TakeForFrame() {
    uint64_t idle = kIdle;
    return ticket_.compare_exchange_strong(idle, kTaken, std::memory_order_acq_rel,
                                           std::memory_order_acquire);
  }
  template <class Passes>
  void Open(const Passes& passes) {
    OpenFrom(0, passes);
  }

  template <class Passes>
  PullResult TryClaim(Item& item, const Passes& passes) {
    if (kFlaw == Flaw::kReadsBeforeClaim && passes.Count() == 0) return PullResult::kNothingReady;
    uint64_t ticket = ticket_.load(std::memory_order_acquire);
    if (kFlaw == Flaw::kSubtractsBlindly && ticket != kIdle && ticket != kTaken)
      ticket = ticket_.fetch_sub(1, std::memory_order_acquire);
    while (uint32_t(ticket) != 0) {
      const bool claimed =
          kFlaw == Flaw::kSubtractsBlindly ||
          (kFlaw == Flaw::kClaimsInTwoSteps ? Overwrite(ticket - 1) : Exchange(ticket, ticket - 1));
      if (!claimed) continue;
      item = {uint32_t(ticket >> 32), uint32_t(ticket)};
      if (kFlaw == Flaw::kOpensWhenClaimed && item.unclaimed == 1) OpenFrom(item.pass + 1, passes);
      if (kFlaw == Flaw::kIdleTooEarly && item.unclaimed == 1 && item.pass + 1 == passes.Count())
        ticket_.store(kIdle, std::memory_order_release);
      return PullResult::kRan;
    }
    return ticket == kIdle ? PullResult::kIdle : PullResult::kNothingReady;
  }

  template <class Passes>
  void Finish(uint32_t pass, const Passes& passes) {
    const auto order =
        kFlaw == Flaw::kFinishesRelaxed ? std::memory_order_relaxed : std::memory_order_acq_rel;
    if (unfinished_.fetch_sub(1, order) != 1) return;
    if (kFlaw != Flaw::kOpensWhenClaimed) OpenFrom(pass + 1, passes);
  }

 private:
  static constexpr uint64_t kIdle = uint64_t{0xffffffffu} << 32;
  static constexpr uint64_t kTaken = uint64_t{0xfffffffeu} << 32;

  bool Exchange(uint64_t& ticket, uint64_t to) {
    return ticket_.compare_exchange_weak(ticket, to, std::memory_order_acquire,
                                         std::memory_order_acquire);
  }
  bool Overwrite(uint64_t to) {
    ticket_.store(to, std::memory_order_release);
    return true;
  }
  template <class Passes>
  void OpenFrom(uint32_t pass, const Passes& passes) {
    const auto order =
        kFlaw == Flaw::kOpensRelaxed ? std::memory_order_relaxed : std::memory_order_release;
    for (; pass < passes.Count(); ++pass) {
      const uint32_t items = passes.Items(pass);
      if (items == 0 && kFlaw != Flaw::kStopsAtEmptyPass) continue;
      const uint64_t ticket = uint64_t(pass) << 32 | items;
      if (kFlaw == Flaw::kCountsAfterOpening) ticket_.store(ticket, order);
      unfinished_.store(items, std::memory_order_relaxed);
      if (kFlaw != Flaw::kCountsAfterOpening) ticket_.store(ticket, order);
      return;
    }
    ticket_.store(kIdle, order);
  }

  ModelAtomic<uint64_t> ticket_{kIdle};
  ModelAtomic<uint32_t> unfinished_{0};
};

// The first fault that any of the cases shows.
template <Flaw kFlaw>
std::string FaultOf() {
  for (const Case* c : {&kTwoByTwo, &kTwoFrames, &kEmptyPasses, &kThreeThreads}) {
    std::string fault = Explore<FlawedScheduler<kFlaw>>(*c);
    if (!fault.empty()) return fault;
  }
  return "";
}

TEST(PullModel, CatchesEveryFlaw) {
  constexpr const char *kNeverEnds = "it never ends: every thread waits",
                       *kReadBesideWrite = "a race: a read beside a write",
                       *kWriteBesideRead = "a race: a write beside a read";
  EXPECT_EQ(FaultOf<Flaw::kNone>(), "") << "without a flaw it is the scheduler that ships";
  EXPECT_EQ(FaultOf<Flaw::kCountsAfterOpening>(), kNeverEnds);
  EXPECT_EQ(FaultOf<Flaw::kClaimsInTwoSteps>(), kReadBesideWrite);
  EXPECT_EQ(FaultOf<Flaw::kSubtractsBlindly>(), kReadBesideWrite);
  EXPECT_EQ(FaultOf<Flaw::kReadsBeforeClaim>(), kWriteBesideRead);
  EXPECT_EQ(FaultOf<Flaw::kOpensRelaxed>(), kReadBesideWrite);
  EXPECT_EQ(FaultOf<Flaw::kFinishesRelaxed>(), kReadBesideWrite);
  EXPECT_EQ(FaultOf<Flaw::kOpensWhenClaimed>(), kReadBesideWrite);
  EXPECT_EQ(FaultOf<Flaw::kStopsAtEmptyPass>(), kNeverEnds);
  EXPECT_EQ(FaultOf<Flaw::kIdleTooEarly>(), kReadBesideWrite);
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
                Model::FetchAdd(done, 1, std::memory_order_relaxed);
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
