// A frame allocates nothing. Calls to malloc, and so to operator new, are counted for the whole
// program: by standing in for glibc's, or, where a sanitizer has taken its place, by the
// sanitizer's hooks.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

#include "jobs/adapters/pull_pool.hpp"
#include "jobs/adapters/thread_pool_door.hpp"
#include "jobs/tbb_executor.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/tiny_scene.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PELT_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PELT_SANITIZED 1
#endif
#endif
#if defined(PELT_SANITIZED)
#include <sanitizer/allocator_interface.h>
#endif

namespace {
std::atomic<uint64_t> g_allocations{0}, g_frees{0};
}  // namespace

#if defined(PELT_SANITIZED)
namespace {
void CountMalloc(const volatile void*, size_t) { ++g_allocations; }
void CountFree(const volatile void*) { ++g_frees; }
[[maybe_unused]] const int g_hooked =
    __sanitizer_install_malloc_and_free_hooks(CountMalloc, CountFree);
}  // namespace
#elif defined(__GLIBC__)
extern "C" {
void* __libc_malloc(size_t bytes);
void* __libc_calloc(size_t count, size_t bytes);
void* __libc_realloc(void* p, size_t bytes);
void* __libc_memalign(size_t alignment, size_t bytes);
void __libc_free(void* p);

void* malloc(size_t bytes) {
  ++g_allocations;
  return __libc_malloc(bytes);
}
void* calloc(size_t count, size_t bytes) {
  ++g_allocations;
  return __libc_calloc(count, bytes);
}
void* realloc(void* p, size_t bytes) {
  ++g_allocations;
  return __libc_realloc(p, bytes);
}
void* aligned_alloc(size_t alignment, size_t bytes) {
  ++g_allocations;
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** out, size_t alignment, size_t bytes) {
  ++g_allocations;
  *out = __libc_memalign(alignment, bytes);
  return *out ? 0 : 12;
}
void free(void* p) {
  if (p) ++g_frees;
  __libc_free(p);
}
}
#endif

namespace pelt::testing {
namespace {

uint64_t Calls() { return g_allocations + g_frees; }

// Fails where neither way of counting is there.
TEST(NoAllocation, TheCounterCounts) {
  const uint64_t before = Calls();
  auto* p = new int(1);
  asm volatile("" : : "r"(p) : "memory");
  delete p;
  EXPECT_EQ(Calls(), before + 2);
}

// Calls to the allocator in frames [warm_up, warm_up + 12): preparing poses, BeginFrame and Run.
// The course passes wetting, a teleport, a refused frame,
// a refused pose, a pause, and goes back to a snapshot.
uint64_t CallsInFrames(Executor& executor, const SceneOptions& options, uint32_t warm_up) {
  Scenario scenario = TinyScenario();
  RunningScenario running(scenario, options);
  FurScene& scene = running.scene();
  std::vector<std::byte> bytes(scene.SnapshotBytes());
  uint64_t calls = 0;
  for (uint32_t f = 0; f < warm_up + 22; ++f) {
    const uint64_t before = Calls();
    if (f == warm_up + 11 && scene.Snapshot(bytes)) return ~0ull;
    if (f == warm_up + 14 && scene.Restore(bytes)) return ~0ull;
    FrameInput input = scenario.PrepareFrame(f, scene);
    if (f == warm_up + 5) {
      input.dt_s = -1.0;
      if (scene.BeginFrame(input) == nullptr) return ~0ull;
      input.dt_s = scenario.dt_s;
    }
    if (f == warm_up + 7) scene.Pose(0).root[3] = std::numeric_limits<float>::quiet_NaN();
    if (f == warm_up + 9) input.dt_s = 0.0;
    if (scene.BeginFrame(input) != nullptr) return ~0ull;
    if (scene.RefusedPoses().empty() != (f != warm_up + 7)) return ~0ull;
    executor.Run(scene.CurrentFrame());
    const uint64_t digest = scene.DigestFrame();
    asm volatile("" : : "r"(digest));
    if (f >= warm_up) calls += Calls() - before;
  }
  return calls;
}

TEST(NoAllocation, SerialFrame) {
  SerialExecutor serial;
  EXPECT_EQ(CallsInFrames(serial, {}, 1), 0u);
  SceneOptions pieces;
  pieces.piecewise_sort_chunks = 1;
  EXPECT_EQ(CallsInFrames(serial, pieces, 1), 0u);
}

TEST(NoAllocation, PermutedFrameAfterItsFirst) {
  PermutedExecutor permuted(1);
  EXPECT_EQ(CallsInFrames(permuted, {}, 1), 0u);
}

TEST(NoAllocation, LocalStoreFrame) {
  LocalStoreExecutor local(PlanOptions{}.local_store_data_bytes);
  EXPECT_EQ(CallsInFrames(local, {}, 1), 0u);
}

TEST(NoAllocation, PullFrame) {
  PullPool pool(3);
  ASSERT_EQ(pool.ObservedWorkers(), 3u) << "a thread allocates when it starts";
  EXPECT_EQ(CallsInFrames(pool, {}, 1), 0u);
}

TEST(NoAllocation, DoorFrame) {
  ThreadPoolDoor pool(3);
  ASSERT_EQ(pool.ObservedWorkers(), 3u) << "a thread allocates when it starts";
  DoorExecutor executor(pool.door());
  EXPECT_EQ(CallsInFrames(executor, {}, 1), 0u);
  EXPECT_GT(executor.TasksEnqueued(), 0u);
}

// oneTBB keeps pools of its own and grows them when it likes; once they are warm the calls must be
// few, and none of them Pelt's: the same frames run serially make none.
TEST(NoAllocation, OneTbbFrameOnceItsPoolsAreWarm) {
  TbbExecutor tbb(3);
  const uint64_t calls = CallsInFrames(tbb, {}, 40);
  RecordProperty("allocator_calls_in_22_frames", int(calls));
  std::printf("oneTBB: %llu allocator calls in 22 frames\n",
              static_cast<unsigned long long>(calls));
  EXPECT_LT(calls, 22u) << "less than one per frame";
}

}  // namespace
}  // namespace pelt::testing
