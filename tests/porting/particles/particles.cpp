// Sparks that fall on the floor and are drawn to the middle of their fountain: streams and kernels
// of one's own, on what Pelt has below its fur. The plan is derived from the ports, a frame runs
// through an engine's door, the bits are proved not to depend on the executor, what would keep them
// from it is named, and an SPU is asked.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "pelt/core/kernel.hpp"
#include "pelt/core/simd.hpp"
#include "pelt/jobs/adapters/thread_pool_door.hpp"
#include "pelt/jobs/engine_door.hpp"
#include "pelt/jobs/verify/verify_frames.hpp"
#include "pelt/platform_sim/local_store.hpp"
#include "pelt/platform_sim/pricing/recording_vec.hpp"
#include "pelt/platform_sim/pricing/stage_costs.hpp"
#include "pelt/traces/digest.hpp"

using namespace pelt;

// What a chunk of sparks and a fountain (a layer of chunks) are made of.
constexpr uint32_t kSparks = 64;
PELT_BLOCK Motion { float position[3][kSparks], velocity[3][kSparks]; };
PELT_BLOCK Middle { float point[3]; };
PELT_BLOCK Alive { uint32_t count; };
template <>
constexpr auto pelt::kBlockMembers<Motion> =
    std::tuple{PELT_MEMBER(Motion, position), PELT_MEMBER(Motion, velocity)};
template <>
constexpr auto pelt::kBlockMembers<Middle> = std::tuple{PELT_MEMBER(Middle, point)};
template <>
constexpr auto pelt::kBlockMembers<Alive> = std::tuple{PELT_MEMBER(Alive, count)};

uint32_t CountAlive(const FrameMemory& memory, uint32_t chunk);

struct Sparks {
  static constexpr uint32_t kChunkLanes = kSparks;
  StreamRow<Alive> alive{"alive", Domain::kChunk, Role::kInput};
  StreamRow<Motion> motion{"motion", Domain::kChunk, Role::kValue, {&CountAlive, 4}};
  StreamRow<Middle> middle{"middle", Domain::kLayer, Role::kValue};
};

uint32_t CountAlive(const FrameMemory& memory, uint32_t chunk) {
  return memory.Of<&Sparks::alive>(chunk)->count;
}

struct Step {
  float seconds, gravity, pull;
};

template <class V>
struct Fall {
  static constexpr std::string_view kName = "fall";
  using Params = Step;
  struct Ports {
    In<&Sparks::alive> alive;
    Shared<&Sparks::middle> middle;  // of the last frame
    InOut<&Sparks::motion> motion;
  };
  static void Run(const Params& step, const Ports& ports) {
    Motion& m = *ports.motion;
    const V pull(step.pull), seconds(step.seconds), floor(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      const V middle(ports.middle->point[axis]), down(axis == 1 ? step.gravity : 0.0f);
      for (uint32_t i = 0; i < ports.alive->count; i += V::kLanes) {
        V place = V::Load(m.position[axis] + i), speed = V::Load(m.velocity[axis] + i);
        const V force = (middle - place) * pull;
        speed = speed + (force - down) * seconds;
        place = place + speed * seconds;
        if (axis == 1) {
          const auto below = place < floor;
          place = Select(below, -place, place);
          speed = Select(below, -speed, speed);
        }
        place.Store(m.position[axis] + i);
        speed.Store(m.velocity[axis] + i);
      }
    }
  }
};

template <class V>
struct FindMiddle {
  static constexpr std::string_view kName = "find_middle";
  struct Ports {
    All<&Sparks::alive> alive;  // of a fountain's chunks, all of them: a wait for these
    All<&Sparks::motion> motion;
    Out<&Sparks::middle> middle;
  };
  static void Run(const Ports& ports) {
    for (int axis = 0; axis < 3; ++axis) {
      V low(1e30f), high(-1e30f);  // the least and the greatest do not depend on any order
      for (uint32_t c = 0; c < ports.motion.count; ++c)
        for (uint32_t i = 0; i < ports.alive[c].count; i += V::kLanes) {
          low = Min(low, V::Load(ports.motion[c].position[axis] + i));
          high = Max(high, V::Load(ports.motion[c].position[axis] + i));
        }
      float least = low[0], most = high[0];
      for (int lane = 1; lane < V::kLanes; ++lane) {
        least = low[lane] < least ? low[lane] : least;
        most = high[lane] > most ? high[lane] : most;
      }
      ports.middle->point[axis] = 0.5f * (least + most);
    }
  }
};

template <class V>
std::vector<KernelDesc> Kernels() {
  return {MakeKernelDesc<Fall<V>>(), MakeKernelDesc<FindMiddle<V>>()};
}

class Fountains {
 public:
  Fountains() {
    for (const uint32_t chunks : {20u, 3u, 9u}) shape_.AddLayer(0, 0, chunks);
    const uint64_t bytes = CountBytes(TableOf<Sparks>(), shape_);
    bytes_.reset(static_cast<std::byte*>(std::aligned_alloc(kBlockAlignment, bytes)));
    std::memset(bytes_.get(), 0, bytes);
    memory_ = PlaceStreams(TableOf<Sparks>(), shape_, bytes_.get());
    for (uint32_t c = 0; c < shape_.chunk_count; ++c) {
      memory_.Of<&Sparks::alive>(c)->count = c % 4 == 3 ? 40 : kSparks;
      for (uint32_t i = 0; i < kSparks; ++i)
        for (uint32_t axis = 0; axis < 3; ++axis)
          memory_.Of<&Sparks::motion>(c)->position[axis][i] = float((c * 37 + i * (axis + 3)) % 29);
    }
    const std::vector<KernelDesc> kernels = Kernels<ArrayVec<4>>();
    plan_ =
        CompilePlan({{kernels[0], &step_, Domain::kChunk}, {kernels[1], nullptr, Domain::kLayer}},
                    shape_, {})
            .OrThrow();
  }

  Frame frame() const { return {&plan_, &memory_}; }
  uint64_t RunFrames(Executor& executor) {
    for (int f = 0; f < 100; ++f) executor.Run(frame());
    return DigestFrame(memory_);
  }

 private:
  struct Free {
    void operator()(void* p) const { std::free(p); }
  };
  SceneShape shape_;
  std::unique_ptr<std::byte, Free> bytes_;
  FrameMemory memory_;
  Step step_{1.0f / 60.0f, 9.81f, 0.4f};
  Plan plan_;
};

// Nanoseconds of a frame's kernels on one SPU, scheduled as well as that goes.
double PriceOnSpu() {
  const Fountains fountains;
  const Frame frame = fountains.frame();
  const PlatformParameters consoles;
  const PricedCore spu = MakePricedCore(CoreKind::kSpu, consoles);
  const StageCosts costs = PriceStages(frame, Kernels<RecordingVec>(), spu, {}).OrThrow();
  double cycles = 0.0;
  for (uint32_t s = 0; s < frame.plan->stages.size(); ++s) {
    const StageCosts::Stage::Price& price = costs.stages[s].scheduled;
    for (uint32_t i = 0; i < price.cycles_per_iteration.size(); ++i)
      cycles += price.fixed_cycles + price.cycles_per_iteration[i] * CountIterations(frame, s, i);
  }
  return 1e9 * cycles / double(costs.clock_hz);
}

int main() {
  ThreadPoolDoor engine(4);  // or an engine's own two functions: pelt/jobs/engine_door.hpp
  DoorExecutor door(engine.door());
  PermutedExecutor permuted(7);
  LocalStoreExecutor local_store(PlanOptions{}.local_store_data_bytes);
  Executor* const others[] = {&door, &permuted, &local_store};
  const auto make = [] {  // the same beginning every time
    const auto fountains = std::make_shared<Fountains>();
    return [fountains] { return fountains->frame(); };
  };
  const std::vector<Finding> findings = VerifyFrames(make, 100, others);
  for (const Finding& finding : findings) std::puts(DescribeFinding(finding).c_str());
  for (const LocalStoreFault& fault : local_store.faults())
    std::printf("%s %s\n", fault.stage.data(), fault.what.c_str());
  if (!findings.empty() || !local_store.faults().empty()) return 1;

  SerialExecutor serial;
  const uint64_t truth = Fountains().RunFrames(serial);
  std::printf("%zu passes, %.1f us on an SPU, digest %016llx\n",
              Fountains().frame().plan->passes.size(), 1e-3 * PriceOnSpu(),
              static_cast<unsigned long long>(truth));
}
