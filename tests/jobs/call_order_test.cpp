// Calls in the wrong order: each is refused with a text, by every executor and on every thread, and
// what comes after it has the bits of a scene that was never misused.
#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "jobs/adapters/pull_pool.hpp"
#include "jobs/adapters/thread_pool_door.hpp"
#include "jobs/engine_door.hpp"
#include "jobs/tbb_executor.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

constexpr uint32_t kFrames = 3;

std::string RunError(Executor& executor, const Frame& frame) {
  const char* fault = executor.Run(frame);
  return fault ? fault : "";
}

// Misuses the scene before, while and after each frame runs, on another thread where it says so.
class MisusingExecutor final : public Executor {
 public:
  MisusingExecutor(FurScene& scene, const FrameInput& input, Executor& inner)
      : scene_(scene), input_(input), inner_(inner) {}
  std::string begin_error, run_error;

 private:
  void RunPasses(const Frame& frame) override {
    std::thread([&] {
      begin_error = BeginError(scene_, input_);
      SerialExecutor serial;
      run_error = RunError(serial, scene_.CurrentFrame());
    }).join();
    inner_.Run(frame);
  }

  FurScene& scene_;
  const FrameInput& input_;
  Executor& inner_;
};

TEST(CallOrder, IsHeldByEveryExecutor) {
  Scenario scenario = TinyScenario();
  SerialExecutor serial;
  const std::vector<uint64_t> truth = RunDigests(scenario, OptionsFor(BestIsa()), serial, kFrames);

  PermutedExecutor permuted(1);
  TbbExecutor tbb(2);
  ThreadPoolDoor threads(2);
  DoorExecutor door(threads.door());
  PullPool pull(2);
  PullExecutor bare_pull;
  const std::pair<const char*, Executor*> executors[] = {
      {"serial", &serial}, {"permuted", &permuted}, {"oneTBB", &tbb},
      {"door", &door},     {"pull pool", &pull},    {"pull", &bare_pull}};
  for (const auto& [name, executor] : executors) {
    SCOPED_TRACE(name);
    RunningScenario running(scenario, OptionsFor(BestIsa()));
    FurScene& scene = running.scene();
    EXPECT_NE(RunError(*executor, scene.CurrentFrame()).find("no frame was begun"),
              std::string::npos);
    for (uint32_t f = 0; f < kFrames; ++f) {
      const FrameInput input = scenario.PrepareFrame(f, scene);
      ASSERT_EQ(BeginError(scene, input), "");
      FrameInput other = input;
      other.dt_s = 0.5;
      EXPECT_NE(BeginError(scene, other).find("before the frame it began was run"),
                std::string::npos);
      MisusingExecutor misusing(scene, other, *executor);
      ASSERT_EQ(RunError(misusing, scene.CurrentFrame()), "");
      EXPECT_NE(misusing.begin_error.find("while the scene's frame is running"), std::string::npos)
          << misusing.begin_error;
      EXPECT_NE(misusing.run_error.find("running already"), std::string::npos);
      EXPECT_NE(RunError(*executor, scene.CurrentFrame()).find("run already"), std::string::npos);
      EXPECT_EQ(scene.DigestFrame(), truth[f]) << "frame " << f;
    }
  }
}

// What else must have the scene to itself, while a frame is begun or runs: refused with the text.
void ExpectRefusedOf(FurScene& scene, FurScene& other, std::span<const Groom* const> grooms,
                     const std::string& reason) {
  const char* why = nullptr;
  const auto refused = [&](bool done) {
    EXPECT_FALSE(done);
    ASSERT_NE(why, nullptr);
    EXPECT_NE(std::string(why).find(reason), std::string::npos) << why;
    why = nullptr;
  };
  refused(scene.ReplaceGrooms(grooms, &why));
  refused(scene.CopyStateFrom(other, &why));
  refused(other.CopyStateFrom(scene, &why));
  std::vector<std::byte> bytes(scene.SnapshotBytes());
  refused(!(why = scene.Snapshot(bytes)));
  ASSERT_EQ(other.Snapshot(bytes), nullptr);
  refused(!(why = scene.Restore(bytes)));
}

// The same from within the running frame, where an engine's finish would call it.
class ChangingExecutor final : public Executor {
 public:
  explicit ChangingExecutor(std::function<void()> change) : change_(std::move(change)) {}

 private:
  void RunPasses(const Frame& frame) override {
    change_();
    SerialExecutor().Run(frame);
    change_();
  }
  std::function<void()> change_;
};

TEST(CallOrder, WhatChangesASceneComesBetweenFrames) {
  Scenario scenario = TinyScenario();
  const std::vector<uint64_t> truth = RunDigests(scenario, OptionsFor(BestIsa()), kFrames);
  RunningScenario running(scenario, OptionsFor(BestIsa())), other(scenario, OptionsFor(BestIsa()));
  FurScene& scene = running.scene();
  const std::vector<const Groom*> grooms = scenario.ActorGrooms();
  const auto refused = [&](const char* reason) {
    ExpectRefusedOf(scene, other.scene(), grooms, reason);
  };
  for (uint32_t f = 0; f < kFrames; ++f) {
    running.Begin(f);
    refused("begun and was not run");
    ChangingExecutor changing([&] { refused("is running"); });
    ASSERT_EQ(RunError(changing, scene.CurrentFrame()), "");
    EXPECT_EQ(scene.DigestFrame(), truth[f]) << "frame " << f;
  }
  std::vector<std::byte> bytes(scene.SnapshotBytes());
  EXPECT_EQ(scene.Snapshot(bytes), nullptr);
  EXPECT_EQ(scene.Restore(bytes), nullptr);
  EXPECT_TRUE(scene.CopyStateFrom(scene));
  EXPECT_TRUE(other.scene().CopyStateFrom(scene));
  EXPECT_TRUE(scene.ReplaceGrooms(grooms));
}

// The pull interface without Run: a frame is in flight from Begin until the last TryRun of any thread.
TEST(CallOrder, IsHeldWhilePullersWork) {
  Scenario scenario = TinyScenario();
  SerialExecutor serial;
  const std::vector<uint64_t> truth = RunDigests(scenario, OptionsFor(BestIsa()), serial, kFrames);
  RunningScenario running(scenario, OptionsFor(BestIsa()));
  FurScene& scene = running.scene();
  PullExecutor pull, second;
  const char* why = nullptr;
  EXPECT_FALSE(pull.Begin(scene.CurrentFrame(), &why));
  EXPECT_NE(std::string(why).find("no frame was begun"), std::string::npos);
  for (uint32_t f = 0; f < kFrames; ++f) {
    const FrameInput input = scenario.PrepareFrame(f, scene);
    ASSERT_EQ(BeginError(scene, input), "");
    ASSERT_TRUE(pull.Begin(scene.CurrentFrame(), &why));
    EXPECT_EQ(why, nullptr);
    for (int i = 0; i < 5; ++i) ASSERT_EQ(pull.TryRun(), PullResult::kRan);
    EXPECT_NE(BeginError(scene, input).find("is running"), std::string::npos);
    EXPECT_FALSE(second.Begin(scene.CurrentFrame(), &why));
    EXPECT_NE(std::string(why).find("running already"), std::string::npos);
    EXPECT_NE(RunError(serial, scene.CurrentFrame()).find("running already"), std::string::npos);
    while (pull.TryRun() != PullResult::kIdle) {
    }
    EXPECT_EQ(scene.DigestFrame(), truth[f]) << "frame " << f;
  }
}

// An executor that is busy with another scene's frame gives this one back, still begun.
TEST(CallOrder, AFrameThatABusyExecutorRefusedCanStillBeRun) {
  Scenario scenario = TinyScenario();
  RunningScenario first(scenario, OptionsFor(BestIsa())), second(scenario, OptionsFor(BestIsa()));
  first.Begin(0);
  second.Begin(0);
  PullExecutor pull;
  const char* why = nullptr;
  ASSERT_TRUE(pull.Begin(first.scene().CurrentFrame()));
  EXPECT_FALSE(pull.Begin(second.scene().CurrentFrame(), &why));
  EXPECT_NE(std::string(why).find("another frame is open"), std::string::npos);
  SerialExecutor serial;
  EXPECT_EQ(RunError(serial, second.scene().CurrentFrame()), "");
  while (pull.TryRun() != PullResult::kIdle) {
  }
  EXPECT_EQ(first.scene().DigestFrame(), second.scene().DigestFrame());
}

// Input that is refused begins no frame: there is nothing to run, and the next one may be begun.
TEST(CallOrder, AFrameWhoseInputWasRefusedCannotBeRun) {
  Scenario scenario = TinyScenario();
  SerialExecutor serial;
  const uint64_t truth = RunDigests(scenario, OptionsFor(BestIsa()), serial, 1)[0];
  RunningScenario running(scenario, OptionsFor(BestIsa()));
  FurScene& scene = running.scene();
  FrameInput input = scenario.PrepareFrame(0, scene);
  input.dt_s = -1.0;
  EXPECT_NE(BeginError(scene, input).find("dt_s"), std::string::npos);
  EXPECT_NE(RunError(serial, scene.CurrentFrame()).find("no frame was begun"), std::string::npos);
  running.Begin(0);
  EXPECT_EQ(RunError(serial, scene.CurrentFrame()), "");
  EXPECT_EQ(scene.DigestFrame(), truth);
}

// Many threads, one frame: one of them runs it, all others get an error.
TEST(CallOrder, OneOfManyThreadsRunsTheFrame) {
  Scenario scenario = TinyScenario();
  const uint64_t truth = RunDigests(scenario, OptionsFor(BestIsa()), 1)[0];
  RunningScenario running(scenario, OptionsFor(BestIsa()));
  running.Begin(0);
  std::atomic<uint32_t> ran{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&] {
      SerialExecutor own;
      if (!own.Run(running.scene().CurrentFrame())) ++ran;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(ran.load(), 1u);
  EXPECT_EQ(running.scene().DigestFrame(), truth);
}

}  // namespace
}  // namespace pelt::testing
