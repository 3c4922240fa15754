// Frames over a table of streams that is not fur's, with faults planted in its kernels: each is named
// by kind, stage and stream, and bits that differ by item, row and lane.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>

#include "jobs/adapters/thread_pool_door.hpp"
#include "jobs/engine_door.hpp"
#include "jobs/verify/guarded_executor.hpp"
#include "jobs/verify/verify_frames.hpp"
#include "tests/jobs/synthetic_scene.hpp"

namespace pelt::testing {
namespace {

enum class ToyFault { kNone, kStatic, kReadsNext, kWritesNext, kReadsOut, kOrder };
ToyFault planted;
std::atomic<uint32_t> runs{0};

// Keys from what was baked, and from the last frame's.
struct MakeKeys {
  static constexpr std::string_view kName = "make_keys";
  struct Ports {
    In<&Toys::baked> baked;
    InOut<&Toys::keys> keys;
  };
  static void Run(const Ports& ports) {
    KeyBlock& keys = *ports.keys;
    for (uint32_t i = 0; i < kToyLanes; ++i)
      keys.key[i] = 5 * keys.key[i] + uint32_t(int32_t(1000.0f * ports.baked->a[0][i]));
    KeyBlock* volatile next = &keys + 1;
    if (planted == ToyFault::kStatic) keys.key[7] += runs++;
    if (planted == ToyFault::kReadsNext) keys.key[7] += next->key[3];
    if (planted == ToyFault::kWritesNext) next->key[3] = keys.key[7];
  }
};

struct Sum {
  static constexpr std::string_view kName = "sum";
  struct Ports {
    All<&Toys::keys> keys;
    Out<&Toys::box> box;
  };
  static void Run(const Ports& ports) {
    uint32_t sum = planted == ToyFault::kReadsOut ? ports.box->word : 0;
    for (uint32_t c = 0; c < ports.keys.count; ++c)
      for (const uint32_t key : ports.keys[c].key) sum += key;
    // What a pointer to main memory would let it see: how many ran before it.
    ports.box->word = planted == ToyFault::kOrder ? sum + runs++ % 3 : sum;
  }
};

class ToyFrames {
 public:
  ToyFrames() : scene_({{0, 0, 3}, {0, 0, 2}, {0, 0, 4}}) {
    runs = 0;
    plan_ = CompilePlan({MakeStage<MakeKeys>(Domain::kChunk), MakeStage<Sum>(Domain::kLayer)},
                        scene_.shape(), {})
                .OrThrow();
  }
  Frame frame() { return {&plan_, &scene_.memory()}; }

 private:
  SyntheticScene scene_;
  Plan plan_;
};

std::vector<Finding> Verified(ToyFault fault) {
  planted = fault;
  PermutedExecutor permuted(0);
  ThreadPoolDoor pool(3);
  DoorExecutor door(pool.door());
  Executor* const executors[] = {&permuted, &door};
  return VerifyFrames(
      [] {
        const auto frames = std::make_shared<ToyFrames>();
        return [frames] { return frames->frame(); };
      },
      9, executors);
}

// Whether one of them is of this kind, and its text has both.
bool Names(const std::vector<Finding>& findings, FindingKind kind, std::string_view stage,
           std::string_view stream, std::string_view text) {
  for (const Finding& f : findings)
    if (f.kind == kind && f.stage == stage && f.stream == stream &&
        f.text.find(text) != std::string::npos)
      return true;
  for (const Finding& f : findings) ADD_FAILURE() << DescribeFinding(f);
  return false;
}

TEST(VerifyFrames, WhatHasNoFaultHasNoFinding) {
  for (const Finding& f : Verified(ToyFault::kNone)) ADD_FAILURE() << DescribeFinding(f);
}

TEST(VerifyFrames, FaultsOfOwnKernelsAreNamed) {
  if (!GuardedExecutor::IsAvailable()) GTEST_SKIP() << "no pages to close";
  EXPECT_TRUE(Names(Verified(ToyFault::kStatic), FindingKind::kHiddenState, "make_keys", "keys",
                    "item 0: run twice"));
  EXPECT_TRUE(Names(Verified(ToyFault::kReadsNext), FindingKind::kUndeclaredRead, "make_keys",
                    "keys", "byte 12 of item 1 of stream 'keys'"));
  EXPECT_TRUE(Names(Verified(ToyFault::kWritesNext), FindingKind::kUndeclaredWrite, "make_keys",
                    "keys", "byte 12 of item 1 of stream 'keys'"));
  EXPECT_TRUE(Names(Verified(ToyFault::kReadsOut), FindingKind::kReadsOut, "sum", "box",
                    "reads stream 'box', which it declares Out"));
}

// Without closed pages too: which value it is, where the order of items is another.
TEST(VerifyFrames, WhatDependsOnTheOrderIsLocated) {
  EXPECT_TRUE(Names(Verified(ToyFault::kOrder), FindingKind::kOrder, "sum", "box",
                    "executors[0]: frame 0, stage sum, stream box, layer 0, row "
                    "word[0], lane 0: expected"));
  EXPECT_TRUE(
      Names(Verified(ToyFault::kReadsNext), FindingKind::kOrder, "make_keys", "keys",
            "executors[0]: frame 0, stage make_keys, stream keys, layer 0, chunk 0 (item 0), "
            "row key[0], lane 7: expected"));
}

}  // namespace
}  // namespace pelt::testing
