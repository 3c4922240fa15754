// State as bytes: what is put back gives the frames of the scene that it is of, and nothing else is
// taken.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>

#include "core/random.hpp"
#include "jobs/carried_state.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

using Bytes = std::vector<std::byte>;

Bytes Taken(const FurScene& scene) {
  Bytes bytes(scene.SnapshotBytes());
  EXPECT_EQ(scene.Snapshot(bytes), nullptr);
  return bytes;
}

struct Course {
  const char* name;
  std::function<Scenario()> make;
  SceneOptions options = {};
  SkipSettings skip = {};
  LodSettings lod = {};
};

std::vector<Course> Courses() {
  const auto everything = [] {
    Scenario scenario = EveryOutputScenario();
    scenario.actors.push_back(scenario.actors[0]);
    scenario.actors[1].teleport_frame = -1;
    scenario.spheres.push_back({{0.1f, 0.9f, 0.2f}, {0.2f, 0.3f, 0.0f}, 0.4, 0.15f});
    CapsuleCollider arm;
    arm.joint = 2;
    arm.to[1] = 0.2f;
    arm.radius = 0.05f;
    scenario.capsules.push_back(arm);
    scenario.weather_course = {0.8f, 0.5f, 3};
    SetModalFriction(scenario, 0.4f);
    return scenario;
  };
  LodSettings budget;
  budget.strand_budget = 500;
  LodSettings time_budget;
  time_budget.budget_us = 60;
  time_budget.worst_px = 1e5f;
  time_budget.costs = {200.0f, 5.0f, 50.0f, {20.0f, 10.0f, 40.0f, 80.0f, 160.0f}};
  const SceneOptions apart{.origins = true}, rated{.velocities = true},
      indexed{.vertex_order = VertexOrder::kIndexBuffer};
  const auto with = [everything](bool origins, bool velocities) {
    return [=] {
      Scenario scenario = everything();
      scenario.origins = origins;
      scenario.velocities = velocities;
      return scenario;
    };
  };
  return {{"tiny", [] { return TinyScenario(); }},
          {"everything", everything},
          {"index buffer", everything, indexed},
          {"origins", with(true, false), apart},
          {"velocities", with(false, true), rated},
          {"level of detail", everything, {}, {.lod = true}, budget},
          {"a budget of time", everything, {}, {.lod = true}, time_budget}};
}

constexpr uint32_t kUntil = 24;  // the teleport of frame 20 is in it

uint64_t RunAs(RunningScenario& running, uint32_t frame, const Course& course, Executor& executor) {
  running.Begin(frame, course.skip, course.lod);
  executor.Run(running.scene().CurrentFrame());
  return running.scene().DigestFrame();
}

// From every fourth frame: back there in the scene itself, and in one that is elsewhere.
TEST(Snapshot, GoesOnAsIfNothingHadBeen) {
  for (const Course& course : Courses()) {
    SCOPED_TRACE(course.name);
    Scenario scenario = course.make(), second = course.make();
    RunningScenario running(scenario, course.options), other(second, course.options);
    SerialExecutor serial;
    PermutedExecutor permuted(3);
    std::vector<Bytes> kept;
    std::vector<uint64_t> truth;
    for (uint32_t f = 0; f < kUntil; ++f) {
      kept.push_back(Taken(running.scene()));
      truth.push_back(RunAs(running, f, course, serial));
    }
    for (const uint32_t from : {0u, 1u, 7u, 19u, 21u}) {
      for (RunningScenario* scene : {&running, &other}) {
        ASSERT_EQ(scene->scene().Restore(kept[from]), nullptr);
        EXPECT_TRUE(scene->scene().Draws().empty());
        EXPECT_EQ(Taken(scene->scene()), kept[from]) << "put back and taken again";
        for (uint32_t f = from; f < std::min(from + 4, kUntil); ++f) {
          ASSERT_EQ(RunAs(*scene, f, course, permuted), truth[f])
              << "frame " << f << " from " << from;
        }
        EXPECT_FALSE(scene->scene().Draws().empty());
      }
    }
  }
}

// What sleeps is made again too, in a scene that never saw it move.
TEST(Snapshot, SleepersAreThereAtOnceAndSleepOn) {
  const Course rest{"at rest", [] { return RestingScenario(4); }};
  Scenario scenario = rest.make(), second = rest.make();
  RunningScenario running(scenario, {}), fresh(second, {});
  SerialExecutor serial;
  uint32_t f = 0;
  while (f < 400 && CountAsleep(running.scene()) < 3) RunAs(running, f++, rest, serial);
  ASSERT_GE(CountAsleep(running.scene()), 3u);
  ASSERT_EQ(fresh.scene().Restore(Taken(running.scene())), nullptr);
  for (const uint32_t end = f + 3; f < end; ++f)
    ASSERT_EQ(RunAs(running, f, rest, serial), RunAs(fresh, f, rest, serial)) << "frame " << f;
  EXPECT_EQ(CountAsleep(fresh.scene()), CountAsleep(running.scene()));
}

std::string_view FirstDifference(const RunningScenario& a, const RunningScenario& b) {
  for (uint32_t s = 0; s < kStreamCount; ++s)
    if (a.scene().DigestStream(Stream(s)) != b.scene().DigestStream(Stream(s)))
      return DescribeStream(Stream(s)).name;
  return "none";
}

// A pause makes what there is to draw, of the state alone; the frame after it is the same.
TEST(Snapshot, IsSeenInAPause) {
  for (const Course& course : Courses()) {
    SCOPED_TRACE(course.name);
    Scenario scenario = course.make(), second = course.make();
    RunningScenario running(scenario, course.options), other(second, course.options);
    SerialExecutor serial;
    for (uint32_t f = 0; f < 14; ++f) RunAs(other, f, course, serial);
    const auto pause = [&](RunningScenario& scene, uint32_t f) {
      FrameInput input = scene.Prepare(f, course.skip, course.lod);
      input.dt_s = 0.0;
      RunInput(scene.scene(), input);
      return scene.scene().DigestFrame();
    };
    for (uint32_t f = 0; f < 9; ++f) {
      const uint64_t truth = RunAs(running, f, course, serial);
      const Bytes kept = Taken(running.scene());
      ASSERT_EQ(other.scene().Restore(kept), nullptr);
      ASSERT_EQ(pause(other, f), truth)
          << "pause after frame " << f << ", stream " << FirstDifference(running, other);
      EXPECT_FALSE(other.scene().Draws().empty());
      ASSERT_EQ(pause(other, f), truth) << "second pause after frame " << f;
    }
    const uint64_t next = RunAs(running, 9, course, serial);
    EXPECT_EQ(RunAs(other, 9, course, serial), next);
  }
}

TEST(Snapshot, OfAnotherSceneOrDamagedIsRefusedAndNothingIsDone) {
  Scenario scenario = TinyScenario(), elsewhere = TinyScenario(), two = TinyScenario();
  Scenario elsewhere_on_skin = TinyScenario();
  for (auto& share : elsewhere.grooms[0].strands[0].bary) std::swap(share[0], share[1]);
  HaloBlock& halo = elsewhere_on_skin.grooms[0].halo[0];
  std::swap(halo.vertex[0], halo.vertex[1]);
  two.actors.push_back(two.actors[0]);
  RunningScenario running(scenario, {}), other_strands(elsewhere, {}), more(two, {}),
      other_corners(elsewhere_on_skin, {}), other_options(scenario, {.origins = true}),
      straight(scenario, {});
  SerialExecutor serial;
  const Course tiny{"tiny", {}};
  for (uint32_t f = 0; f < 3; ++f) RunAs(running, f, tiny, serial);
  for (uint32_t f = 0; f < 3; ++f) RunAs(straight, f, tiny, serial);
  const auto refused = [&](std::span<const std::byte> bytes, const char* reason) {
    const char* fault = running.scene().Restore(bytes);
    ASSERT_NE(fault, nullptr) << reason;
    EXPECT_NE(std::string(fault).find(reason), std::string::npos) << fault;
  };
  refused(Taken(other_strands.scene()), "other grooms");
  refused(Taken(other_corners.scene()), "other grooms");
  refused(Taken(more.scene()), "other grooms");
  refused(Taken(other_options.scene()), "other options");
  const Bytes good = Taken(straight.scene());
  refused({}, "no snapshot");
  refused(std::span(good).first(40), "no snapshot");
  refused(std::span(good).first(good.size() - 1), "was cut");
  const auto changed = [&](size_t at, int by) {
    Bytes bytes = good;
    bytes[at] = std::byte(int(bytes[at]) + by);
    return bytes;
  };
  refused(changed(0, 1), "no snapshot");
  refused(changed(8, 1), "version");
  refused(changed(12, 1), "strands per chunk");
  refused(changed(24, 1), "keeps state otherwise");
  Random random(4);
  for (int i = 0; i < 200; ++i)
    refused(changed(64 + random.Below(uint32_t(good.size()) - 64), 1 + int(random.Below(255))),
            "damaged");
  for (uint32_t f = 3; f < 6; ++f)
    ASSERT_EQ(RunAs(running, f, tiny, serial), RunAs(straight, f, tiny, serial)) << "frame " << f;
}

// Bytes that are not damaged by chance: a checksum that holds, over counts that no scene can have.
TEST(Snapshot, CountsThatKernelsWouldFollowAreLookedAt) {
  Scenario scenario = TinyScenario();
  RunningScenario running(scenario, {});
  SerialExecutor serial;
  const Course tiny{"tiny", {}};
  RunAs(running, 0, tiny, serial);
  FurScene& scene = running.scene();
  Bytes bytes(scene.SnapshotBytes());
  // Why a snapshot is refused in which the number has this value; empty where it is not.
  const auto fault_of = [&](ChunkStateBlock& state, uint32_t ChunkStateBlock::*member,
                            uint32_t value) -> std::string {
    const ChunkStateBlock before = state;
    state.*member = value;
    EXPECT_EQ(scene.Snapshot(bytes), nullptr);
    state = before;
    const char* fault = scene.Restore(bytes);
    return fault ? fault : "";
  };
  const char* const kImpossible = "no scene of these grooms";
  for (uint32_t ChunkStateBlock::*member :
       {&ChunkStateBlock::live_strands, &ChunkStateBlock::visible_strands,
        &ChunkStateBlock::first_place}) {
    const std::string fault = fault_of(*scene.memory().Of<&Streams::chunk_state>(2), member, 1000);
    EXPECT_NE(fault.find(kImpossible), std::string::npos) << fault;
  }
  for (uint32_t p = 0; p < scene.shape().patch_count; ++p) {
    auto& state = *scene.memory().Of<&Streams::patch_state>(p);
    const uint32_t vertices = scene.memory().Of<&Streams::mesh>(p)->vertex_count;
    const std::string fault = fault_of(state, &ChunkStateBlock::live_vertices, vertices + 1);
    EXPECT_NE(fault.find(kImpossible), std::string::npos) << p << ": " << fault;
    EXPECT_EQ(fault_of(state, &ChunkStateBlock::live_vertices, vertices), "") << p;
  }
}

// A snapshot is made of words.
TEST(Snapshot, WhatMayBeCarriedIsMadeOfWords) {
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    if (desc.role == Role::kInput && desc.kept != Kept::kState) continue;
    for (const RowDesc& row : desc.rows)
      EXPECT_TRUE(row.type == ElementType::kFloat || row.type == ElementType::kU32)
          << desc.name << ", " << row.name;
  }
}

// The rule that says what is carried, against what frames really change.
TEST(Snapshot, InputsThatFramesFillAreCarried) {
  for (const Course& course : Courses()) {
    SCOPED_TRACE(course.name);
    Scenario scenario = course.make(), second = course.make();
    RunningScenario running(scenario, course.options), fresh(second, course.options);
    SerialExecutor serial;
    for (uint32_t f = 0; f < 5; ++f) RunAs(running, f, course, serial);
    const FrameMemory &a = running.scene().memory(), &b = fresh.scene().memory();
    for (uint32_t s = 0; s < kStreamCount; ++s) {
      const StreamDesc& desc = DescribeStream(Stream(s));
      const size_t bytes = size_t(a.streams[s].block_count) * desc.block_bytes;
      if (desc.role != Role::kInput || bytes == 0) continue;
      const bool filled = std::memcmp(a.streams[s].base, b.streams[s].base, bytes) != 0;
      EXPECT_EQ(filled, desc.kept == Kept::kState) << desc.name;
    }
  }
}

TEST(Snapshot, IsOfThePlatformsThatSortInPiecesToo) {
  Scenario scenario = TinyScenario(), second = TinyScenario();
  RunningScenario whole(scenario, {}), in_pieces(second, {.piecewise_sort_chunks = 1});
  SerialExecutor serial;
  LocalStoreExecutor local(PlanOptions{}.local_store_data_bytes);
  const Course tiny{"tiny", {}};
  for (uint32_t f = 0; f < 5; ++f) RunAs(whole, f, tiny, serial);
  ASSERT_EQ(in_pieces.scene().Restore(Taken(whole.scene())), nullptr);
  for (uint32_t f = 5; f < 9; ++f)
    ASSERT_EQ(RunAs(whole, f, tiny, serial), RunAs(in_pieces, f, tiny, local)) << "frame " << f;
}

// What the README states: after a frame, as an engine takes them, and with the bytes in the cache.
TEST(Snapshot, BytesAndTimes) {
  for (const char* name : {"eyepet", "monster"}) {
    Scenario scenario = LoadScenario(name);
    RunningScenario running(scenario, {});
    FurScene& scene = running.scene();
    SerialExecutor serial;
    const Course course{name, {}};
    for (uint32_t f = 0; f < 4; ++f) RunAs(running, f, course, serial);
    Bytes bytes = Taken(scene), copy = bytes;
    const auto best = [&](bool after_a_frame, auto&& work) {
      double least = 1e9;
      for (uint32_t i = 0; i < 12; ++i) {
        if (after_a_frame) RunAs(running, 4 + i, course, serial);
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::milli> took =
            std::chrono::steady_clock::now() - start;
        least = std::min(least, took.count());
      }
      return least;
    };
    for (const bool after_a_frame : {true, false}) {
      const double snapshot = best(after_a_frame, [&] { scene.Snapshot(bytes); });
      const double restore = best(after_a_frame, [&] { scene.Restore(bytes); });
      const double plain =
          best(after_a_frame, [&] { std::memcpy(copy.data(), bytes.data(), bytes.size()); });
      std::printf(
          "%s, %s: %zu bytes, %.1f %% of the block; snapshot %.3f ms, restore %.3f ms, "
          "memcpy %.3f ms\n",
          name, after_a_frame ? "after a frame" : "again", bytes.size(),
          100.0 * double(bytes.size()) / double(scene.layout().total_bytes), snapshot, restore,
          plain);
    }
    EXPECT_LE(double(bytes.size()), 0.40 * double(scene.layout().total_bytes));
  }
}

}  // namespace
}  // namespace pelt::testing
