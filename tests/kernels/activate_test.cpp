// Activate: the live prefix, the truth table of its decisions, and the promise that matters: a
// chunk that skips ends every frame with the bits of a chunk that does not.
#include "core/kernels/activate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/kernels/every_vector.hpp"

namespace pelt {
namespace {

using test::Blocks;

constexpr uint32_t kAllSwitches = kSwitchSleep | kSwitchSkipUnmoved | kSwitchSkipSort;

struct World {
  Blocks<PaletteBlock> palette{1, 0};
  Blocks<LayerBlock> layer{1, 0};
  Blocks<LodBlock> lod{1, 0};
  Blocks<StrandBlock> strands{1, 0};
  Blocks<ChunkStateBlock> state{1, 0};
  ActivateParams params{kAllSwitches, 0, 0, 0};

  explicit World(uint32_t strand_count = kStrandsPerChunk) {
    layer[0].flags = kLayerEnabled | kLayerSimulate;
    lod[0].visible = 1;
    lod[0].fraction = 1.0f;
    StrandBlock& s = strands[0];
    s.strand_count = strand_count;
    s.vertex_count = kVerticesPerChunk / 2;
    s.first_strand = 7 * kStrandsPerChunk;
    s.joint_mask[0] = 1u << 5;
    s.joint_mask[3] = 1u << 9;
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i)
      s.vertex_prefix[i] = uint8_t(std::min(2 + i / 2, s.vertex_count - 1));
  }
  template <class V = ArrayVec<4>>
  const ChunkStateBlock& Run() {
    test::RunKernel<Activate<V>>(
        params, {palette.Bind(), layer.Bind(), lod.Bind(), strands.Bind(), state.Bind()});
    return state[0];
  }
  // A chunk that came into view some frames ago and whose last step changed nothing.
  void Settle() {
    Run();
    state[0].state_changed = 1;
    Run();
    state[0].state_changed = 0;
  }
};

constexpr uint32_t kEverything =
    kChunkVisible | kChunkSkin | kChunkSimulate | kChunkFit | kChunkKeys;

TEST(Activate, LiveStrandsAreTheShareRoundedUp) {
  for (uint32_t count : {1u, 2u, 17u, 100u, kStrandsPerChunk}) {
    World w(count);
    for (int i = 0; i <= 1000; ++i) {
      w.lod[0].fraction = float(i) / 1000.0f;
      const uint32_t live = w.Run().live_strands;
      if (i == 0) {
        EXPECT_EQ(live, 0u);
        continue;
      }
      const float exact = w.lod[0].fraction * float(count);
      EXPECT_EQ(live, std::clamp(uint32_t(std::ceil(exact)), 1u, count));
      EXPECT_EQ(w.state[0].live_exact, exact);
    }
    EXPECT_EQ(w.state[0].live_strands, count);
    EXPECT_EQ(w.state[0].fade_count, 0.0f);
  }
}

TEST(Activate, LiveVerticesCoverEveryLaneAKernelTouches) {
  for (uint32_t count : {1u, 31u, kStrandsPerChunk}) {
    World w(count);
    for (int i = 1; i <= 100; ++i) {
      w.lod[0].fraction = float(i) / 100.0f;
      const ChunkStateBlock& s = w.Run();
      const uint32_t touched = std::min(RoundUpToLaneGroups(s.live_strands), kStrandsPerChunk);
      uint32_t needed = 0;
      for (uint32_t lane = 0; lane < std::min(touched, count); ++lane)
        needed = std::max(needed, uint32_t(w.strands[0].vertex_prefix[lane]) + 1);
      EXPECT_EQ(s.live_vertices, needed);
      EXPECT_LE(s.live_vertices, w.strands[0].vertex_count);
    }
  }
}

TEST(Activate, HiddenChunksDoNothingAndStartAfreshWhenSeenAgain) {
  World w;
  w.Settle();
  w.state[0].visible_strands = 50;
  for (int cause = 0; cause < 3; ++cause) {
    World hidden;
    hidden.Settle();
    hidden.state[0].visible_strands = 50;
    if (cause == 0) hidden.lod[0].visible = 0;
    if (cause == 1) hidden.layer[0].flags = kLayerSimulate;
    if (cause == 2) hidden.lod[0].fraction = 0.0f;
    const ChunkStateBlock& s = hidden.Run();
    EXPECT_EQ(s.flags, 0u);
    EXPECT_EQ(s.live_strands + s.live_vertices + s.visible_strands, 0u);
    EXPECT_EQ(s.keys_changed + s.records_changed + s.state_changed, 0u);
    EXPECT_EQ(s.first_place, 7 * kStrandsPerChunk);
    hidden.layer[0].flags |= kLayerEnabled;
    hidden.lod[0].visible = 1;
    hidden.lod[0].fraction = 1.0f;
    EXPECT_EQ(hidden.Run().flags, kEverything | kChunkRestart);
    EXPECT_EQ(hidden.state[0].first_new_strand, 0u);
    EXPECT_EQ(hidden.state[0].first_new_vertex, 0u);
  }
}

struct Event {
  const char* name;
  std::function<void(World&)> act;
  uint32_t flags;  // expected on a settled chunk, besides kChunkVisible
};

TEST(Activate, TruthTableOfASettledChunk) {
  constexpr uint32_t kKeys = kChunkKeys, kFit = kChunkFit | kKeys, kSim = kChunkSimulate | kFit,
                     kSkin = kChunkSkin | kSim;
  const Event kEvents[] = {
      {"nothing", [](World&) {}, 0},
      {"another character's joint moves", [](World& w) { w.palette[0].moved[1] = ~0u; }, 0},
      {"a joint of the chunk moves", [](World& w) { w.palette[0].moved[3] = 1u << 9; }, kSkin},
      {"it moved last frame", [](World& w) { w.state[0].moved = 1; }, kSkin},
      {"state changed last frame", [](World& w) { w.state[0].state_changed = 1; }, kSim},
      {"layer parameters change", [](World& w) { w.layer[0].changed = 1; }, kSim},
      {"wind blows", [](World& w) { w.layer[0].flags |= kLayerWind | kLayerBlows; }, kSim},
      {"still air is not left out", [](World& w) { w.layer[0].flags |= kLayerWind; }, kSim},
      {"dt, ground or spheres change", [](World& w) { w.params.frame_inputs_changed = 1; }, kSim},
      {"the view changes", [](World& w) { w.params.view_changed = 1; }, kKeys},
      {"teleport", [](World& w) { w.palette[0].teleported = 1; }, kSkin | kChunkRestart},
      {"first frame", [](World& w) { w.params.first_frame = 1; }, kSkin | kChunkRestart},
      {"fewer strands live", [](World& w) { w.lod[0].fraction = 0.5f; }, kSim},
      {"the fade begins", [](World& w) { w.lod[0].fade = 0.1f; }, kFit},
      {"wind over what is not simulated",
       [](World& w) { w.layer[0].flags = kLayerEnabled | kLayerWind; }, 0},
      {"dt changes over what is not simulated",
       [](World& w) {
         w.layer[0].flags = kLayerEnabled;
         w.params.frame_inputs_changed = 1;
       },
       0},
  };
  for (const Event& event : kEvents)
    for (uint32_t switches = 0; switches <= kAllSwitches; ++switches) {
      World w;
      w.Settle();
      w.params.switches = switches;
      event.act(w);
      uint32_t expected = event.flags;
      if (!(switches & kSwitchSkipUnmoved)) expected |= kChunkSkin;
      if (!(switches & kSwitchSleep)) expected |= kSim;
      if (!(switches & kSwitchSkipSort)) expected |= kKeys;
      // What simulate reads is as it was, whatever is run all the same.
      const std::string_view name = event.name;
      if (name == "state changed last frame" || name == "still air is not left out" ||
          (!(event.flags & kChunkSimulate) && !name.starts_with("dt changes")))
        expected |= kChunkSteady;
      const ChunkStateBlock& s = w.Run();
      EXPECT_EQ(s.flags, expected | kChunkVisible) << event.name << ", switches " << switches;
      EXPECT_EQ(s.records_changed, (s.flags & kChunkFit) ? 1u : 0u);
      EXPECT_EQ(s.state_changed + s.keys_changed, 0u);
    }
}

TEST(Activate, GrowthStartsOnlyTheNewLanes) {
  World w;
  w.lod[0].fraction = 0.5f;
  w.Settle();
  EXPECT_EQ(w.state[0].first_new_strand, w.state[0].live_strands);
  const uint32_t strands = w.state[0].live_strands, vertices = w.state[0].live_vertices;
  w.lod[0].fraction = 0.75f;
  w.Run();
  EXPECT_EQ(w.state[0].first_new_strand, strands);
  EXPECT_EQ(w.state[0].first_new_vertex, vertices);
  EXPECT_EQ(w.state[0].flags, kEverything);
  // The step after new lanes was not given the state it is compared with: no sleep, whatever it
  // reports.
  w.state[0].state_changed = 0;
  EXPECT_TRUE(w.Run().flags & kChunkSimulate);
  w.state[0].state_changed = 0;
  EXPECT_FALSE(w.Run().flags & kChunkSimulate);
}

TEST(Activate, ARestartedChunkDoesNotSleepOnItsFirstReport) {
  World w;
  w.Run();
  w.state[0].state_changed = 0;
  EXPECT_TRUE(w.Run().flags & kChunkSimulate);
}

// ---- Skipping changes nothing -------------------------------------------------------------------
//
// A chunk with made-up kernels that read and write what the real ones do, in whole numbers. Two
// copies live through the same scene, one with switches and one without; after every frame all that
// a frame leaves for others must agree.

struct Scene {  // what the caller and the character decide for a frame
  bool visible = true, teleported = false, view_changed = false, inputs_changed = false;
  bool joint_moved = false, layer_changed = false, wind = false, simulated = true;
  int pose = 0, view = 0, inputs = 0, parameter = 0, gust = 0;
  float fraction = 1.0f, fade = 0.0f;
};

struct ToyChunk {
  World world;
  int position[kVerticesPerChunk] = {}, motion[kVerticesPerChunk] = {};
  int root[kStrandsPerChunk] = {}, root_motion[kStrandsPerChunk] = {};
  int point[kStrandsPerChunk] = {}, previous[kStrandsPerChunk] = {};
  int record[kStrandsPerChunk] = {};
  uint32_t key[kStrandsPerChunk] = {};
  bool trust_any_report = false;  // a deliberately broken rule: see the last test
  bool reported_still = false;
  int slept = 0, skin_skipped = 0, fit_skipped = 0, keys_skipped = 0;

  ChunkStateBlock& state() { return world.state[0]; }

  void Skin(const Scene& scene) {
    for (uint32_t v = 0; v < state().live_vertices; ++v) {
      const int now = scene.pose * 100 + int(v);
      const bool is_new = (state().flags & kChunkRestart) || v >= state().first_new_vertex;
      motion[v] = is_new ? 0 : now - position[v];
      position[v] = now;
    }
    for (uint32_t s = 0; s < state().live_strands; ++s) {
      root[s] = position[world.strands[0].vertex_prefix[s]] * 3 + int(s);
      root_motion[s] = motion[world.strands[0].vertex_prefix[s]];
    }
  }

  // Comes to rest after some frames: a quarter of the way, with what is left of the speed.
  bool SimulateLane(const Scene& scene, uint32_t s) {
    const bool fresh = (state().flags & kChunkRestart) || s >= state().first_new_strand;
    const int goal = root[s] + scene.parameter + scene.inputs + (scene.wind ? scene.gust : 0);
    const int from = point[s], before = previous[s];
    if (fresh || !scene.simulated) {
      point[s] = previous[s] = root[s];
      // Overshoots in its first step, so that a chunk seen again may repeat old bits by chance.
      if (fresh && scene.simulated) point[s] = root[s] + (goal - root[s]) / 2;
    } else {
      const int speed = (from - before) / 2 + root_motion[s] / 4;
      point[s] = from + (goal - from) / 4 + speed;
      previous[s] = from;
    }
    return point[s] != from || previous[s] != before;
  }

  void Fit(const Scene& scene) {
    for (uint32_t s = 0; s < state().live_strands; ++s) {
      int alpha = 255;
      if (state().fade_count > 0.0f) {
        const float share = (state().live_exact - float(s)) / state().fade_count;
        alpha = int(255.0f * std::clamp(share, 0.0f, 1.0f));
      }
      record[s] = (point[s] * 7 + root[s] * 3 + scene.parameter) * 256 + alpha;
    }
  }

  void MakeKeys(const Scene& scene) {
    bool changed = (state().flags & kChunkRestart) != 0;
    for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
      const bool live = s < state().live_strands;
      const uint32_t now = live ? uint32_t(point[s] * scene.view + root[s]) : kCulledKey;
      changed |= now != key[s];
      key[s] = now;
    }
    state().keys_changed = changed;
  }

  void RunFrame(const Scene& scene, bool first) {
    world.lod[0].visible = scene.visible;
    world.lod[0].fraction = scene.fraction;
    world.lod[0].fade = scene.fade;
    world.palette[0].teleported = scene.teleported;
    world.palette[0].moved[0] = scene.joint_moved ? 1u << 5 : 0u;
    world.layer[0].flags =
        kLayerEnabled | (scene.wind ? kLayerWind : 0u) | (scene.simulated ? kLayerSimulate : 0u);
    world.layer[0].changed = scene.layer_changed;
    world.params.frame_inputs_changed = scene.inputs_changed;
    world.params.view_changed = scene.view_changed;
    world.params.first_frame = first;
    world.Run();
    if (!(state().flags & kChunkVisible)) return;
    bool simulate = (state().flags & kChunkSimulate) != 0;
    if (trust_any_report && reported_still && !(state().flags & (kChunkSkin | kChunkRestart)))
      simulate = false;
    skin_skipped += !(state().flags & kChunkSkin);
    slept += !simulate;
    fit_skipped += !(state().flags & kChunkFit);
    keys_skipped += !(state().flags & kChunkKeys);
    if (state().flags & kChunkSkin) Skin(scene);
    if (simulate) {
      bool changed = false;
      for (uint32_t s = 0; s < state().live_strands; ++s) changed |= SimulateLane(scene, s);
      state().state_changed = changed;
      reported_still = !changed;
    }
    if (state().flags & kChunkFit) Fit(scene);
    if (state().flags & kChunkKeys) MakeKeys(scene);
  }

  bool AgreesWith(ToyChunk& other) {
    if (state().live_strands != other.state().live_strands) return false;
    if (state().live_vertices != other.state().live_vertices) return false;
    const uint32_t strands = state().live_strands, vertices = state().live_vertices;
    return std::equal(position, position + vertices, other.position) &&
           std::equal(motion, motion + vertices, other.motion) &&
           std::equal(root_motion, root_motion + strands, other.root_motion) &&
           std::equal(point, point + strands, other.point) &&
           std::equal(previous, previous + strands, other.previous) &&
           std::equal(record, record + strands, other.record) &&
           (strands == 0 || std::equal(key, key + kStrandsPerChunk, other.key)) &&
           state().keys_changed == other.state().keys_changed;
  }
};

Scene NextScene(Scene s, std::mt19937& random) {
  const auto chance = [&](uint32_t one_in) { return random() % one_in == 0; };
  const Scene last = s;
  s.teleported = s.joint_moved = s.layer_changed = s.inputs_changed = s.view_changed = false;
  if (chance(2)) return s;  // still frames come in runs
  if (chance(40)) s.visible = !s.visible;
  if (chance(40)) s.pose += int(random() % 9) - 4;
  if (chance(60)) s.teleported = true;
  if (chance(60)) s.parameter = int(random() % 50);
  if (chance(60)) s.inputs = int(random() % 50);
  if (chance(80)) s.wind = !s.wind;
  if (chance(200)) s.simulated = !s.simulated;
  if (chance(40)) s.view = int(random() % 5);
  if (chance(50)) s.fraction = float(1 + random() % 8) / 8.0f;
  if (chance(50)) s.fade = chance(2) ? 0.0f : 0.125f;
  s.gust = int(random() % 30);
  s.joint_moved = s.pose != last.pose;
  s.layer_changed =
      s.parameter != last.parameter || s.wind != last.wind || s.simulated != last.simulated;
  s.inputs_changed = s.inputs != last.inputs;
  s.view_changed = s.view != last.view;
  return s;
}

TEST(Activate, SkippingLeavesTheBitsOfNotSkipping) {
  for (uint32_t switches = 1; switches <= kAllSwitches; ++switches) {
    ToyChunk skipping, working;
    skipping.world.params.switches = switches;
    working.world.params.switches = 0;
    std::mt19937 random(switches);
    Scene scene;
    for (int frame = 0; frame < 40000; ++frame) {
      skipping.RunFrame(scene, frame == 0);
      working.RunFrame(scene, frame == 0);
      ASSERT_TRUE(skipping.AgreesWith(working)) << "frame " << frame << ", switches " << switches;
      scene = NextScene(scene, random);
    }
    EXPECT_EQ(working.slept + working.skin_skipped + working.fit_skipped, 0);
    EXPECT_EQ(skipping.slept > 1000, (switches & kSwitchSleep) != 0);
    EXPECT_EQ(skipping.fit_skipped > 1000, (switches & kSwitchSleep) != 0);
    EXPECT_EQ(skipping.skin_skipped > 1000, (switches & kSwitchSkipUnmoved) != 0);
    if ((switches & kSwitchSleep) && (switches & kSwitchSkipSort)) {
      EXPECT_GT(skipping.keys_skipped, 1000);
    }
  }
}

// The test above must be able to fail: a chunk that sleeps on any report of "unchanged" is found.
TEST(Activate, SleepingOnAnyReportIsFound) {
  ToyChunk broken, working;
  broken.trust_any_report = true;
  working.world.params.switches = 0;
  std::mt19937 random(1);
  Scene scene;
  bool agree = true;
  for (int frame = 0; frame < 40000 && agree; ++frame) {
    broken.RunFrame(scene, frame == 0);
    working.RunFrame(scene, frame == 0);
    agree = broken.AgreesWith(working);
    scene = NextScene(scene, random);
  }
  EXPECT_FALSE(agree);
}

TEST(Activate, SameBitsOnEveryVector) {
  test::ForEveryVector([]<class V>(const char* name) {
    World world(100), reference(100);
    for (int i = 0; i < 50; ++i) {
      world.lod[0].fraction = reference.lod[0].fraction = float(i % 7) / 6.0f;
      world.Run<V>();
      reference.Run<ArrayVec<4>>();
      ASSERT_TRUE(world.state.SameBits(reference.state)) << name;
    }
  });
}

}  // namespace
}  // namespace pelt
