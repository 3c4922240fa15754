// A scene that goes on with other grooms is, once its fur starts afresh, a scene that was made of them:
// for all of a groom that may be replaced.
#include <gtest/gtest.h>

#include <bit>
#include <functional>

#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

constexpr uint32_t kBefore = 3, kAfter = 4;

// Every output and chain, with nothing that the past alone decides: paint, detail by size.
Scenario PlainScenario() {
  Scenario scenario = EveryOutputScenario();
  scenario.base.brush_count = 0;
  scenario.base.lod.fast_quality_px = 0.0f;
  scenario.actors[0].teleport_frame = -1;
  return scenario;
}

// Of what is seen: blocks of layers that are not drawn keep what was there.
uint64_t DigestDraws(const FurScene& scene) {
  Digest digest;
  for (const LayerDraw& draw : scene.Draws()) {
    digest.Add(draw.layer);
    digest.Add(draw.strand_count);
    for (const std::byte b : draw.vertices) digest.Add(uint32_t(b));
    for (const uint32_t strand : draw.order) {
      digest.Add(strand);
      if (!draw.looks.empty()) digest.Add(draw.looks[strand].normal ^ draw.looks[strand].uv);
    }
    for (const Shell& shell : draw.shells.shell) digest.Add(std::bit_cast<uint32_t>(shell.shadow));
    for (const float place : {draw.low[0], draw.high[1], draw.tip_width, draw.wet_darken})
      digest.Add(std::bit_cast<uint32_t>(place));
  }
  return digest.Value();
}

std::vector<uint64_t> Restarted(RunningScenario& running, Scenario& scenario) {
  std::vector<uint64_t> digests;
  for (uint32_t f = kBefore; f < kBefore + kAfter; ++f) {
    const FrameInput input = running.Prepare(f, scenario.base.skip, scenario.base.lod);
    running.scene().Pose(0).teleported = f == kBefore;
    RunInput(running, input);
    digests.push_back(DigestDraws(running.scene()));
  }
  return digests;
}

// Says whether the change was accepted; then both scenes must be the same.
bool TryChange(const std::string& what, const std::function<void(Groom&)>& change) {
  SCOPED_TRACE(what);
  Scenario scenario = PlainScenario(), changed = PlainScenario();
  change(changed.grooms[0]);
  RunningScenario running(scenario, {});
  for (uint32_t f = 0; f < kBefore; ++f) RunFrame(running, f);
  const char* why = nullptr;
  if (!running.scene().ReplaceGrooms(changed.ActorGrooms(), &why)) {
    EXPECT_NE(why, nullptr);
    return false;
  }
  EXPECT_TRUE(running.GoOnWith(changed));
  RunningScenario anew(changed, {});
  EXPECT_EQ(Restarted(running, changed), Restarted(anew, changed));
  return true;
}

TEST(ReplaceGrooms, EveryLayerParameter) {
  uint32_t accepted = 0;
  ForEachLayerParam([&](const auto& entry) {
    accepted += TryChange(std::string(entry.key), [&entry](Groom& groom) {
      for (GroomLayer& layer : groom.layers) {
        auto& value = layer.params.*entry.member;
        using T = std::remove_reference_t<decltype(value)>;
        const LayerParams before = layer.params;
        if constexpr (std::is_same_v<T, std::array<float, 3>>)
          value = {0.9f, 0.1f, 0.4f};
        else if constexpr (std::is_same_v<T, bool>)
          value = !value;
        else if constexpr (std::is_same_v<T, float>)
          value = float(value > 0.5 * (entry.low + entry.high) ? 0.5 * value : 0.5 * value + 0.3);
        else
          value = T(uint32_t(value) == uint32_t(entry.high) ? uint32_t(entry.low)
                                                            : uint32_t(value) + 1);
        if (!FindBadParam(layer.params).empty() || FindBadCombination(layer.params))
          layer.params = before;
      }
    });
  });
  EXPECT_GT(accepted, 30u);
}

// Among them those that are kept because they would never rest: their clocks go on.
TEST(ReplaceGrooms, TheSameOnesChangeNoBit) {
  Scenario scenario = RestingScenario(6);
  SetModalFriction(scenario, 0.4f);
  RunningScenario replaced(scenario, {}), plain(scenario, {});
  for (uint32_t f = 0; f < 150; ++f) {
    for (RunningScenario* running : {&replaced, &plain}) {
      FrameInput input = scenario.PrepareFrame(f, running->scene());
      input.ground[3] = -0.05f;
      RunInput(running->scene(), input);
    }
    ASSERT_EQ(replaced.scene().DigestFrame(), plain.scene().DigestFrame()) << "frame " << f;
    if (f % 7 < 6) continue;
    ASSERT_TRUE(replaced.scene().ReplaceGrooms(scenario.ActorGrooms()));
  }
}

// Those that got what they had go on as if they had not slept; those that changed are skinned
// again.
TEST(ReplaceGrooms, NoPatchAndNoChunkSleepsThroughIt) {
  Scenario scenario = RestingScenario(6);
  RunningScenario running(scenario, {});
  const FurScene& scene = running.scene();
  uint32_t f = 0;
  const auto run = [&] { RunFrame(running, f++); };
  const auto fall_asleep = [&] {
    for (uint32_t most = f + 2000; f < most;) {
      run();
      if (CountAsleep(scene) == scene.shape().chunk_count) return true;
    }
    return false;
  };
  ASSERT_TRUE(fall_asleep());
  ASSERT_EQ(CountPatches(scene, kChunkVisible, kChunkSimulate), scene.shape().patch_count);
  ASSERT_TRUE(running.scene().ReplaceGrooms(scenario.ActorGrooms()));
  run();
  EXPECT_EQ(CountPatches(scene, kChunkSimulate), scene.shape().patch_count);
  EXPECT_EQ(CountChunks(scene, kChunkSimulate), scene.shape().chunk_count);
  EXPECT_EQ(CountPatches(scene, kChunkSkin), 0u);
  EXPECT_EQ(CountChunks(scene, kChunkSkin), 0u);

  ASSERT_TRUE(fall_asleep());
  Scenario changed = scenario;
  for (float& strength : changed.grooms[0].vertex_rest[0].strength) strength *= 0.5f;
  ASSERT_EQ(changed.grooms[0].layers[0].params.chain, ChainKind::kVertex);
  ASSERT_TRUE(running.scene().ReplaceGrooms(changed.ActorGrooms()));
  run();
  EXPECT_EQ(CountPatches(scene, kChunkSimulate), scene.shape().patch_count);
  EXPECT_EQ(CountPatches(scene, kChunkSkin), 1u);
  EXPECT_NE(scene.memory().Of<&Streams::patch_state>(0)->flags & kChunkSkin, 0u);
  EXPECT_EQ(CountChunks(scene, kChunkSkin), 0u);
}

TEST(ReplaceGrooms, TheUnitScale) {
  EXPECT_TRUE(TryChange("unit_scale", [](Groom& groom) { groom.unit_scale *= 0.5f; }));
}

TEST(ReplaceGrooms, WhatStrandsWereGiven) {
  EXPECT_TRUE(TryChange("length, width and colour", [](Groom& groom) {
    for (StrandBlock& strands : groom.strands)
      for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
        strands.length[s] *= 1.2f;
        strands.width[s] *= 2.0f;
        strands.base_colour[s] ^= 0x1f1f1fu;
      }
    for (GroomLayer& layer : groom.layers) layer.length_max *= 1.2f;
  }));
  EXPECT_TRUE(TryChange("rest shapes", [](Groom& groom) {
    const auto longer = [](auto& blocks) {
      for (auto& rest : blocks) {
        for (auto& point : rest.offset)
          for (auto& axis : point)
            for (float& place : axis) place *= 1.3f;
        for (float& length : rest.segment_length) length *= 1.3f;
        for (float& strength : rest.strength) strength = 1.0f - 0.5f * strength;
      }
    };
    longer(groom.vertex_rest);
    longer(groom.strand_rest4);
    longer(groom.strand_rest5);
    longer(groom.strand_rest9);
  }));
  EXPECT_TRUE(TryChange("places on the texture", [](Groom& groom) {
    for (StrandUvBlock& block : groom.strand_uv)
      for (uint32_t& uv : block.uv) uv ^= 0x1234u;
    for (ShellSkinBlock& block : groom.shell_skin)
      for (uint32_t& colour : block.tip_colour) colour ^= 0x30303u;
  }));
}

}  // namespace
}  // namespace pelt::testing
