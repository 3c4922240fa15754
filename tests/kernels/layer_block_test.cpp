#include "core/layer_block.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pelt::test {
namespace {

constexpr float kGravity[3] = {0.0f, -9.81f, 0.0f};

LayerBlock Fill(const LayerParams& params, Weather weather, const LayerBlock* last = nullptr,
                float dt = 1.0f / 60.0f) {
  return FillLayerBlock(params, weather, dt, kGravity, Air::kBlows, 100, 0.05f, true, last);
}

TEST(LayerBlock, ChainsOfNinePointsSwingAsThoseOfFive) {
  LayerParams five, nine;
  five.chain = nine.chain = ChainKind::kStrand;
  five.points = 5;
  nine.points = 9;
  EXPECT_EQ(LayerKind(nine), uint32_t(kLayerModal | kLayerNinePoints));
  EXPECT_EQ(StrandPointsOf(LayerKind(nine)), 9u);
  EXPECT_EQ(StrandPointsOf(LayerKind(five)), 5u);
  const RodMaterial rod = LayerRod(nine, {}, 0.1f, false);
  EXPECT_EQ(rod.points, 9u);
  EXPECT_EQ(rod.frequency_hz, LayerRod(five, {}, 0.1f, false).frequency_hz);
}

TEST(LayerBlock, DryAndCleanIsTheSetup) {
  LayerParams params;
  const LayerBlock b = Fill(params, {});
  EXPECT_EQ(b.flags, uint32_t(kLayerEnabled | kLayerVertexChains | kLayerBackFaceCull | kLayerWind |
                              kLayerBlows | kLayerSimulate | kLayerModal));
  EXPECT_EQ(b.gravity[1], -9.81f);
  EXPECT_EQ(b.scale, 1.0f);
  EXPECT_EQ(b.modal.shrink, 1.0f);
  EXPECT_EQ(b.motion_follow, 0.0f);
  EXPECT_EQ(b.modal.turn_follow, 0.0f);
  EXPECT_EQ(b.modal.fastest_felt, 0.0f);
  EXPECT_EQ(b.modal.friction, 0.0f);
  params.friction = 0.5f;
  EXPECT_EQ(Fill(params, {}).modal.friction, 0.5f);
  params.solver = Solver::kPbd;
  EXPECT_FLOAT_EQ(Fill(params, {}).link.velocity_keep, std::exp(-3.0f / 60.0f));
  EXPECT_EQ(Fill(params, {}).link.angular_middle, params.angular_hardness_middle);
  EXPECT_EQ(b.darken, 1.0f);
  EXPECT_EQ(b.dirt, 0.0f);
  EXPECT_EQ(b.clump, 0.0f);
  EXPECT_EQ(b.strand_count, 100u);
  EXPECT_EQ(b.length_max, 0.05f);
}

// Chains lose a substep's share of their depth in a soft skin; what is drawn off them is no deeper for it.
TEST(LayerBlock, WhatIsDrawnLeavesASoftSkinByTheSameShareAtEveryRate) {
  LayerParams params;
  params.surface_hardness = 0.5f;
  const auto at = [&](double push_ratio) {
    return FillLayerBlock(params, {}, 1.0f / 60.0f, kGravity, Air::kBlows, 100, 0.05f, true,
                          nullptr, 1.0f, push_ratio);
  };
  EXPECT_LT(at(0.1).surface_hardness, 0.2f);
  EXPECT_EQ(at(0.1).modal.drawn_hardness, 0.75f);
  EXPECT_EQ(at(2.0).modal.drawn_hardness, 0.75f);
  params.surface_hardness = 1.0f;
  EXPECT_EQ(at(0.1).modal.drawn_hardness, 1.0f);
}

TEST(LayerBlock, EveryKindHasItsFlag) {
  LayerParams params;
  params.enabled = false;
  params.chain = ChainKind::kStrand;
  params.points = 5;
  params.solver = Solver::kVerlet;
  params.output = Output::kRibbons;
  params.clump = 0.5f;
  params.backface_cull = false;
  params.wind_response = 0.0f;
  const LayerBlock b =
      FillLayerBlock(params, {}, 0.01f, kGravity, Air::kBlows, 1, 0.1f, false, nullptr);
  EXPECT_EQ(b.flags, uint32_t(kLayerFivePoints | kLayerVerlet | kLayerRibbons | kLayerClump));
}

TEST(LayerBlock, WetIsHeavierClumpedSofterDarker) {
  LayerParams params;
  params.solver = Solver::kPbd;
  const LayerBlock dry = Fill(params, {}), damp = Fill(params, {0.5f, 0.0f}),
                   wet = Fill(params, {1.0f, 0.0f});
  EXPECT_FLOAT_EQ(wet.gravity[1], -9.81f * params.wet_weight);
  EXPECT_FLOAT_EQ(wet.clump, params.wet_clump);
  EXPECT_FLOAT_EQ(wet.darken, params.wet_darken);
  EXPECT_FLOAT_EQ(wet.link.angular_end, params.angular_hardness_end * params.wet_hardness);
  EXPECT_FLOAT_EQ(wet.link.stiffness, params.stiffness * params.wet_hardness);
  EXPECT_TRUE(wet.flags & kLayerClump);
  EXPECT_LT(damp.darken, dry.darken);
  EXPECT_GT(damp.darken, wet.darken);
  EXPECT_EQ(Fill(params, {7.0f, 0.0f}).darken, wet.darken);
}

TEST(LayerBlock, ShorterFurHasFewerShells) {
  LayerParams params;
  params.shells = 20;
  EXPECT_EQ(FillShellLayer(params, 0.001f).most, 20u);
  params.shell_spacing = 0.002f;
  EXPECT_EQ(FillShellLayer(params, 0.2f).most, 20u);
  EXPECT_EQ(FillShellLayer(params, 0.0201f).most, 10u);
  EXPECT_EQ(FillShellLayer(params, 0.0005f).most, 1u);
}

TEST(LayerBlock, DirtClosesAShareOfWhatWaterLeaves) {
  LayerParams params;
  params.clump = 0.2f;
  params.wet_clump = params.dirt_clump = 0.5f;
  EXPECT_FLOAT_EQ(Fill(params, {0.0f, 1.0f}).clump, 0.6f);
  EXPECT_FLOAT_EQ(Fill(params, {1.0f, 0.0f}).clump, 0.6f);
  EXPECT_FLOAT_EQ(Fill(params, {1.0f, 1.0f}).clump, 0.8f);
  EXPECT_FLOAT_EQ(Fill(params, {1.0f, 0.5f}).clump, 0.7f);
  params.dirt_clump = 0.0f;
  EXPECT_EQ(Fill(params, {0.3f, 1.0f}).clump, Fill(params, {0.3f, 0.0f}).clump);
}

// Far from one half, where what is lost and what is left look alike.
TEST(LayerBlock, WetSharesAreWhatIsLeft) {
  LayerParams params;
  params.solver = Solver::kPbd;
  params.weight = 2.0f;
  params.clump = 0.5f;
  params.wet_weight = params.wet_clump = params.wet_hardness = params.wet_darken = 0.2f;
  const LayerBlock wet = Fill(params, {1.0f, 0.0f}), damp = Fill(params, {0.5f, 0.0f});
  EXPECT_FLOAT_EQ(wet.gravity[1], -9.81f * 2.0f * 0.2f) << "a factor on the weight";
  EXPECT_FLOAT_EQ(damp.gravity[1], -9.81f * 2.0f * 0.6f);
  EXPECT_FLOAT_EQ(wet.clump, 0.6f) << "a fifth of the way from 0.5 to 1";
  EXPECT_FLOAT_EQ(damp.clump, 0.55f);
  EXPECT_FLOAT_EQ(wet.darken, 0.2f) << "a fifth of the brightness is left";
  EXPECT_FLOAT_EQ(damp.darken, 0.6f);
  EXPECT_FLOAT_EQ(wet.link.angular_end, 0.2f * params.angular_hardness_end) << "and of hardness";
  EXPECT_FLOAT_EQ(wet.link.angular_middle, 0.2f * params.angular_hardness_middle);
  EXPECT_FLOAT_EQ(wet.link.stiffness, 0.2f * params.stiffness);
  const double dry_hz = LayerRod(params, {}, 0.1f, false).frequency_hz;
  EXPECT_NEAR(LayerRod(params, {1.0f, 0.0f}, 0.1f, false).frequency_hz, dry_hz * std::sqrt(0.2),
              1e-6);
}

// What holds a sag-free groom up was baked dry: with the water's weight it sags.
TEST(LayerBlock, ASagFreeGroomIsHeldAgainstItsDryWeight) {
  LayerParams params;
  params.sag_free = true;
  params.weight = 2.0f;
  params.wet_weight = 3.0f;
  const LayerBlock dry = Fill(params, {}), wet = Fill(params, {1.0f, 0.0f});
  EXPECT_FLOAT_EQ(dry.modal.rest_gravity, 9.81f * 2.0f);
  EXPECT_EQ(wet.modal.rest_gravity, dry.modal.rest_gravity);
  EXPECT_FLOAT_EQ(wet.gravity[1], -9.81f * 2.0f * 3.0f);
}

// Whose strands' looks have the weather, not the colours.
TEST(LayerBlock, APaintedLayerSaysWhatWetAndDirtyStrandsAre) {
  LayerParams params;
  params.lit = params.painted = true;
  const LayerBlock dry = Fill(params, {}), wet = Fill(params, {1.0f, 0.4f});
  EXPECT_EQ(dry.darken, params.wet_darken);
  EXPECT_EQ(wet.darken, params.wet_darken);
  EXPECT_EQ(wet.wetness, 1.0f);
  EXPECT_FLOAT_EQ(wet.dirt, 0.4f);
}

TEST(LayerBlock, DirtColourIsEncodedAsTheBytesAre) {
  LayerParams params;
  params.dirt_colour = {0.0f, 0.5f, 1.5f};
  const LayerBlock b = Fill(params, {0.0f, 0.4f});
  EXPECT_EQ(b.dirt_colour[0], 0.0f);
  EXPECT_EQ(b.dirt_colour[1], 0.5f);
  EXPECT_EQ(b.dirt_colour[2], 1.0f);
  EXPECT_FLOAT_EQ(b.dirt, 0.4f);
}

TEST(LayerBlock, ChangedComparesWithLastFrame) {
  LayerParams params;
  params.solver = Solver::kPbd;  // what of a modal layer depends on dt is in its table
  const LayerBlock first = Fill(params, {});
  EXPECT_EQ(first.changed, 1u);
  const LayerBlock second = Fill(params, {}, &first);
  EXPECT_EQ(second.changed, 0u);
  const LayerBlock third = Fill(params, {}, &second);
  EXPECT_EQ(third.changed, 0u);
  EXPECT_EQ(Fill(params, {0.01f, 0.0f}, &third).changed, 1u);
  EXPECT_EQ(Fill(params, {}, &third, 1.0f / 61.0f).changed, 1u);
  LayerBlock important = third;  // which LOD alone sees
  important.importance = 3.0f;
  EXPECT_EQ(Fill(params, {}, &important).changed, 0u);
  params.tip_width = 0.3f;
  EXPECT_EQ(Fill(params, {}, &third).changed, 1u);
}

}  // namespace
}  // namespace pelt::test
