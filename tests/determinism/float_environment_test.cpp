// Engines set flush-to-zero and odd rounding on their threads. A frame run there gives the same
// bits, and hands the thread back as it was.
#include "core/float_environment.hpp"

#include <gtest/gtest.h>

#include <cfenv>
#include <cstring>
#include <functional>

#include "core/bind_pose.hpp"
#include "core/character/builtin_character.hpp"
#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/fur_setup.hpp"
#include "core/groom/groom_file.hpp"
#include "core/kernel.hpp"
#include "core/modal/modal_material.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/synthetic_scene.hpp"
#include "tests/jobs/tiny_scene.hpp"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace pelt::testing {
namespace {

// The worst an engine's thread may bring along, and back again on the way out.
class OddThread {
 public:
  explicit OddThread(int rounding = FE_UPWARD) {
    std::fegetenv(&saved_);
    std::fesetround(rounding);
#if defined(__SSE__)
    _mm_setcsr(_mm_getcsr() | 0x8040u);  // flush to zero, denormals are zero
#endif
  }
  ~OddThread() { std::fesetenv(&saved_); }
  static bool IsStillOdd() {
#if defined(__SSE__)
    if ((_mm_getcsr() & 0x8040u) != 0x8040u) return false;
#endif
    return std::fegetround() == FE_UPWARD;
  }

 private:
  std::fenv_t saved_;
};

float Opaque(float x) {
  volatile float v = x;
  return v;
}

// 1.666...: to nearest it is rounded down.
float FiveThirds() { return Opaque(5.0f) / Opaque(3.0f); }

// Denormals and roundings: what an odd thread would change.
struct Fragile {
  static constexpr std::string_view kName = "fragile";
  struct Params {
    float third;
  };
  struct Ports {
    In<&Toys::baked> baked;
    Out<&Toys::made> made;
  };
  static void Run(const Params& p, const Ports& ports) {
    for (uint32_t i = 0; i < kToyLanes; ++i) {
      const float x = ports.baked->a[0][i];
      ports.made->value[0][i] = x * p.third;
      ports.made->value[1][i] = x * 1e-30f * 1e-11f;
      ports.made->value[2][i] = x + p.third;
    }
  }
};

TEST(FloatEnvironment, OddThreadsReallyRoundAndFlushOtherwise) {
  const float plain = FiveThirds();
  const OddThread odd;
  EXPECT_TRUE(OddThread::IsStillOdd());
  EXPECT_NE(FiveThirds(), plain);
#if defined(__SSE__)
  EXPECT_EQ(Opaque(1e-30f) * Opaque(1e-11f), 0.0f);
#endif
}

TEST(FloatEnvironment, IsPlainInsideAndAsItWasOutside) {
  const float plain = FiveThirds();
  const OddThread odd;
  {
    const FloatEnvironment inside;
    EXPECT_EQ(FiveThirds(), plain);
    EXPECT_GT(Opaque(1e-30f) * Opaque(1e-11f), 0.0f);
  }
  EXPECT_TRUE(OddThread::IsStillOdd());
}

constexpr Fragile::Params kFragile{0.7f};

// One frame of a scene that was filled on an ordinary thread.
uint64_t RunFragile(Executor& executor, bool on_odd_thread) {
  SyntheticScene scene({{0, 0, 3}});
  const Plan plan =
      CompilePlan({MakeStage<Fragile>(Domain::kChunk, kFragile)}, scene.shape(), {}).OrThrow();
  if (on_odd_thread) {
    const OddThread odd;
    executor.Run({&plan, &scene.memory()});
    EXPECT_TRUE(OddThread::IsStillOdd());
  } else {
    executor.Run({&plan, &scene.memory()});
  }
  return scene.DigestOf({StreamOf<&Toys::made>});
}

TEST(FloatEnvironment, EveryExecutorProtectsItsKernels) {
  SerialExecutor serial;
  const uint64_t truth = RunFragile(serial, false);
  PermutedExecutor permuted(1);
  LocalStoreExecutor local(PlanOptions{}.local_store_data_bytes);
  EXPECT_EQ(RunFragile(serial, true), truth);
  EXPECT_EQ(RunFragile(permuted, true), truth);
  EXPECT_EQ(RunFragile(local, true), truth);
}

// Whichever worker it is: more than the machines have on which executors are tried.
TEST(FloatEnvironment, EveryWorkersItemsAreProtected) {
  SerialExecutor serial;
  const uint64_t truth = RunFragile(serial, false);
  SyntheticScene scene({{0, 0, 3}});
  const Plan plan =
      CompilePlan({MakeStage<Fragile>(Domain::kChunk, kFragile)}, scene.shape(), {}).OrThrow();
  const Frame frame{&plan, &scene.memory()};
  for (uint32_t worker = 0; worker < 256; ++worker) {
    for (uint32_t chunk = 0; chunk < 3; ++chunk) RunItem(frame, 0, chunk, worker);
    ASSERT_EQ(scene.DigestOf({StreamOf<&Toys::made>}), truth) << "worker " << worker;
  }
}

TEST(FloatEnvironment, UnprotectedTheKernelGivesOtherBits) {
  SerialExecutor serial;
  SyntheticScene scene({{0, 0, 3}});
  {
    const OddThread odd;
    for (uint32_t c = 0; c < 3; ++c) {
      const Binding bindings[] = {{scene.memory().Block(StreamOf<&Toys::baked>, c), nullptr, 1},
                                  {scene.memory().Block(StreamOf<&Toys::made>, c), nullptr, 1}};
      MakeKernelDesc<Fragile>().run(&kFragile, bindings);
    }
  }
  EXPECT_NE(scene.DigestOf({StreamOf<&Toys::made>}), RunFragile(serial, false));
}

// Parameters are worked out on the caller's thread: they are part of the bits too.
TEST(FloatEnvironment, WholeFrameIsTheSameOnAnOddThread) {
  SerialExecutor serial;
  Scenario scenario = TinyScenario();
  const auto truth = RunDigests(scenario, {}, serial, 12);
  RunningScenario running(scenario, {});
  for (uint32_t f = 0; f < truth.size(); ++f) {
    const FrameInput input = scenario.PrepareFrame(f, running.scene());
    const OddThread odd;
    ASSERT_EQ(running.scene().BeginFrame(input), nullptr);
    serial.Run(running.scene().CurrentFrame());
    EXPECT_TRUE(OddThread::IsStillOdd());
    ASSERT_EQ(running.scene().DigestFrame(), truth[f]) << "frame " << f;
  }
}

// ---- What computes outside a frame ----------------------------------------------------------------

class ByteDigest {
 public:
  template <class T>
  void Add(const T& value) {
    const auto* bytes = reinterpret_cast<const uint8_t*>(&value);
    for (size_t b = 0; b < sizeof(T); ++b) digest_.Add(bytes[b]);
  }
  template <class T>
  void AddAll(const std::vector<T>& values) {
    for (const T& value : values) Add(value);
  }
  uint64_t Value() const { return digest_.Value(); }

 private:
  Digest digest_;
};

struct PublicCall {
  const char* name;
  std::function<void(ByteDigest&)> call;
};

constexpr const char* kSetup =
    "crease_angle = 60\n"
    "[[layer]]\n"
    "name = 'fur'\n"
    "density = 3_000.7\n"
    "length = { value = 0.0333, randomise = 0.31 }\n"
    "max_strands = 200\n";

void AddGroom(const Groom& groom, ByteDigest& out) { out.AddAll(WriteGroom(groom).OrThrow()); }

// Every function of a public header that works out a value which ends up in a frame or a groom.
std::vector<PublicCall> PublicCalls(Scenario& scenario, FurScene& ran) {
  const Character& character = scenario.characters[0];
  const Groom& groom = scenario.grooms[0];
  const auto pose = [&character](ByteDigest& out, const Clip* clip, float turn) {
    const glm::mat4 root = PlaceCharacter(glm::mat4(turn), 0.0123f);
    out.Add(MakePose(character.skeleton, clip, 0.4321, true, root));
  };
  return {
      {"FillBindPose",
       [&groom](ByteDigest& out) {
         auto filled = std::make_unique<PoseBlock>();
         FillBindPose(groom, *filled);
         out.Add(*filled);
       }},
      {"PlaceInMesh",
       [&groom](ByteDigest& out) {
         double place[3];
         PlaceInMesh(groom.skeleton, 3, {0.1f, 0.2f, 0.3f}, place);
         out.Add(place);
       }},
      {"FillPose", [&, pose](ByteDigest& out) { pose(out, &character.clips[0], 0.77f); }},
      {"FillPoseRates",
       [&character](ByteDigest& out) {
         auto rates = std::make_unique<PoseRateBlock>();
         FillPoseRates(&character.clips[0], 0.4321, true, 1.1, glm::mat4(0.3f), rates.get());
         out.Add(*rates);
       }},
      {"ComputeRestGeometry",
       [&character](ByteDigest& out) {
         const RestGeometry rest = ComputeRestGeometry(character, 0.0123f);
         out.AddAll(rest.position);
         out.AddAll(rest.normal);
         out.AddAll(rest.tangent);
       }},
      {"DefaultUnitScale",
       [&character](ByteDigest& out) { out.Add(DefaultUnitScale(character).metres_per_unit); }},
      {"MakeBuiltinCharacterGlb", [](ByteDigest& out) { out.AddAll(MakeBuiltinCharacterGlb({})); }},
      {"ImportGltf",
       [glb = MakeBuiltinCharacterGlb({})](ByteDigest& out) {
         const Character read = ImportGltf(glb, "builtin");
         out.AddAll(read.mesh.position);
         out.AddAll(read.mesh.normal);
         out.AddAll(read.mesh.tangent);
         for (const Clip& clip : read.clips)
           for (const Track& track : clip.tracks) out.AddAll(track.value);
       }},
      {"ReadFurSetup and BakeGroom",
       [&character](ByteDigest& out) {
         AddGroom(BakeGroom(character, ComputeRestGeometry(character, 0.01f),
                            ReadFurSetup(kSetup, "setup", "."), 0.01f),
                  out);
       }},
      {"ReadLights and MakeLighting",
       [](ByteDigest& out) {
         const Lighting lighting = MakeLighting(ReadLights(
             "[lights.sun]\ndirection = [0.3, 0.9, 0.1]\ncolour = [1.1, 0.7, 0.3]\n", "l"));
         out.Add(lighting.sun_direction);
         out.Add(lighting.sun_rgb);
       }},
      {"MakeFurTexture", [](ByteDigest& out) { out.AddAll(MakeFurTexture({})); }},
      {"modal materials",
       [](ByteDigest& out) {
         out.Add(StrandMaterial(4, 3.7, 0.05, 2.9).stiffness);
         out.Add(StrandMaterial(9, 3.7, 0.05, 2.9).rest);
         out.Add(GammaOf(3.7, 0.05, 9.81));
         out.Add(FrequencyOfHardness(3, 0.2, 0.1, 4));
         out.Add(RodFrequency(1.0e-9, 3.0e-5, 0.07));
       }},
      {"MakeView",
       [](ByteDigest& out) {
         Camera camera;
         camera.eye[0] = 0.37f;
         out.Add(MakeView(camera).planes);
       }},
      {"CopyCurves",
       [&ran](ByteDigest& out) {
         for (uint32_t l = 0; l < ran.shape().layer_count; ++l) {
           std::vector<StrandCurve> curves(size_t(ran.shape().LayerChunks(l)) * kStrandsPerChunk);
           curves.resize(ran.CopyCurves(l, curves));
           out.AddAll(curves);
         }
       }},
      {"Create, ReplaceGrooms and a first frame",
       [&scenario](ByteDigest& out) {
         const std::vector<const Groom*> grooms = scenario.ActorGrooms();
         const auto made = FurScene::Create(grooms).OrThrow();
         EXPECT_TRUE(made->ReplaceGrooms(grooms));
         for (uint32_t c = 0; c < grooms.size(); ++c) FillBindPose(*grooms[c], made->Pose(c));
         EXPECT_EQ(made->BeginFrame({}), nullptr);
         SerialExecutor().Run(made->CurrentFrame());
         out.Add(made->DigestFrame());
       }},
  };
}

TEST(FloatEnvironment, EveryPublicFunctionProtectsWhatItComputes) {
  Scenario scenario = TinyScenario();
  RunningScenario running(scenario, {});
  for (uint32_t f = 0; f < 3; ++f) RunFrame(running, f);
  for (const PublicCall& call : PublicCalls(scenario, running.scene())) {
    ByteDigest plain;
    call.call(plain);
    for (const int rounding : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      ByteDigest odd_bytes;
      {
        const OddThread odd(rounding);
        call.call(odd_bytes);
      }
      EXPECT_EQ(odd_bytes.Value(), plain.Value()) << call.name << ", rounding mode " << rounding;
    }
  }
}

}  // namespace
}  // namespace pelt::testing
