// How much of a stack an item takes, from the entry of an engine's task or of TryRun: jobs/README.md
// states it, as fibres have little. Measured on a stack that was painted before.
#include <gtest/gtest.h>

#if defined(__linux__)

#include <pthread.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <string>

#include "core/kernels/frame_table.hpp"
#include "jobs/engine_door.hpp"
#include "jobs/pull_executor.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::testing {
namespace {

constexpr size_t kStackBytes = 4u << 20;
constexpr unsigned char kPaintByte = 0xA5;

// A stack whose bytes are known until they are written to.
class PaintedStack {
 public:
  PaintedStack()
      : bytes_(static_cast<unsigned char*>(mmap(nullptr, kStackBytes, PROT_READ | PROT_WRITE,
                                                MAP_PRIVATE | MAP_ANONYMOUS, -1, 0))) {}
  ~PaintedStack() { munmap(bytes_, kStackBytes); }
  PaintedStack(const PaintedStack&) = delete;
  PaintedStack& operator=(const PaintedStack&) = delete;

  // Runs task() on it; returns how deep it went below the caller's frame.
  size_t DepthOf(const std::function<void()>& task) {
    std::memset(bytes_, kPaintByte, kStackBytes);
    Call call{&task, nullptr};
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstack(&attributes, bytes_, kStackBytes);
    pthread_t thread;
    const int error = pthread_create(&thread, &attributes, &Run, &call);
    EXPECT_EQ(error, 0);
    if (error == 0) pthread_join(thread, nullptr);
    pthread_attr_destroy(&attributes);
    const unsigned char* lowest =
        std::find_if(bytes_, bytes_ + kStackBytes, [](unsigned char b) { return b != kPaintByte; });
    return size_t(call.top - lowest);
  }

 private:
  struct Call {
    const std::function<void()>* task;
    const unsigned char* top;
  };
  static void* Run(void* context) {
    auto& call = *static_cast<Call*>(context);
    call.top = static_cast<const unsigned char*>(__builtin_frame_address(0));
    (*call.task)();
    return nullptr;
  }
  unsigned char* bytes_;
};

// All that takes stack: friction, ground that roots lie in, a soft skin, limits, something fast.
Scenario Everything(bool long_hair, ModalQuality quality) {
  Scenario scenario = TinyScenario();
  if (long_hair) AddLongHair(scenario);
  for (LayerParams* layer : LayersOf(scenario))
    if (layer->solver == Solver::kModal) {
      layer->quality = quality;
      layer->friction = 0.4f;
      layer->max_distance = 0.5f;
    }
  scenario.base.ground[3] = -0.05f;
  return scenario;
}

// An engine that has one worker beside the caller, on a painted stack.
struct PaintedDoor {
  PaintedStack& stack;
  size_t deepest = 0;

  EngineDoor door() {
    const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
      auto& self = *static_cast<PaintedDoor*>(user);
      self.deepest = std::max(self.deepest, self.stack.DepthOf([&] { task(context); }));
      return user;
    };
    return {enqueue, [](void*, void*) {}, this, 2};
  }
};

size_t DeepestOf(bool long_hair, Isa isa, bool by_door) {
  PaintedStack stack;
  PaintedDoor painted{stack};
  size_t deepest = 0;
  for (const ModalQuality quality : {ModalQuality::kFast, ModalQuality::kBest}) {
    Scenario scenario = Everything(long_hair, quality);
    RunningScenario running(scenario, OptionsFor(isa));
    PullExecutor pull;
    DoorExecutor door(painted.door());
    for (uint32_t frame = 0; frame < 8; ++frame) {
      FrameInput input = scenario.PrepareFrame(frame, running.scene());
      // A ball through the fur.
      input.sphere_count = 1;
      const float ball[4] = {-1.0f + 0.25f * float(frame), 0.8f, 0.2f, 0.3f};
      std::copy_n(ball, 4, input.sphere[0]);
      input.sphere_velocity[0][0] = 15.0f;
      EXPECT_EQ(BeginError(running.scene(), input), "");
      if (by_door) {
        door.Run(running.scene().CurrentFrame());
        continue;
      }
      EXPECT_TRUE(pull.Begin(running.scene().CurrentFrame()));
      const auto work = [&] {
        while (pull.TryRun() != PullResult::kIdle) {
        }
      };
      deepest = std::max(deepest, stack.DepthOf(work));
    }
  }
  return std::max(deepest, painted.deepest);
}

TEST(Stack, AnItemTakesNoMoreThanIsPromised) {
  for (const Isa isa : kAllIsas) {
    if (!FindKernels(isa)) continue;
    for (const bool by_door : {false, true})
      for (const bool long_hair : {false, true}) {
        const size_t deepest = DeepestOf(long_hair, isa, by_door);
        std::printf("%s, %s, %s: %zu bytes\n", std::string(IsaName(isa)).c_str(),
                    by_door ? "a door's task" : "TryRun", long_hair ? "9 points" : "4 and 5 points",
                    deepest);
#if defined(NDEBUG) && !defined(PELT_SANITIZED)
        const size_t promised = long_hair ? 56 : 48;  // jobs/README.md
        EXPECT_LE(deepest, promised << 10) << IsaName(isa);
#endif
      }
  }
}

}  // namespace
}  // namespace pelt::testing

#endif
