// Activate: of patches, of chunks whose strands have chains of their own, of chunks that follow the
// chains at vertices. The live prefixes and the truth tables of the decisions.
#include "core/kernels/activate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/kernels/activate_worlds.hpp"

namespace pelt::test {
namespace {

// ---- What lives ---------------------------------------------------------------------------------

template <class W>
void ExpectTheShareRoundedUp() {
  for (uint32_t count : {1u, 2u, 17u, 100u, kStrandsPerChunk}) {
    W w(count);
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
      EXPECT_EQ(w.state[0].live_vertices, 0u) << "those are the patches'";
    }
    EXPECT_EQ(w.state[0].live_strands, count);
    EXPECT_EQ(w.state[0].fade_count, 0.0f);
  }
}

TEST(Activate, LiveStrandsAreTheShareRoundedUp) {
  ExpectTheShareRoundedUp<ChunkWorld>();
  ExpectTheShareRoundedUp<FollowerWorld>();
}

TEST(Activate, LiveVerticesAreTheGroupsInUse) {
  for (const uint32_t count : {1u, 17u, kVerticesPerChunk - 20, kVerticesPerChunk}) {
    PatchWorld w(count);
    for (uint32_t g = 0; g < kVertexGroups; ++g)
      w.patch[0].live_from[g] = float(g) / float(kVertexGroups);
    for (int i = 0; i <= 256; ++i) {  // every bound is one of these: there it is not yet in use
      w.lod[0].fraction = float(i) / 256.0f;
      uint32_t groups = 0;
      for (const float from : w.patch[0].live_from) groups += w.lod[0].fraction > from;
      EXPECT_EQ(w.Run().live_vertices, std::min(groups * kLaneGroup, count)) << i;
      EXPECT_EQ(w.state[0].live_strands, 0u);
    }
    EXPECT_EQ(w.state[0].live_vertices, count);
  }
  // Seen, and nothing of it is in use.
  PatchWorld unused;
  for (float& from : unused.patch[0].live_from) from = 0.5f;
  unused.lod[0].fraction = 0.25f;
  EXPECT_EQ(unused.Run().live_vertices, 0u);
  EXPECT_TRUE(unused.state[0].flags & kChunkVisible);
}

template <class W>
void ExpectAfreshWhenSeenAgain() {
  for (int cause = 0; cause < 3; ++cause) {
    W hidden;
    Settle(hidden);
    if (!kIsPatch<W>) hidden.state[0].visible_strands = 50;
    if (cause == 0) hidden.lod[0].visible = 0;
    if (cause == 1) hidden.layer[0].flags = kLayerSimulate;
    if (cause == 2) hidden.lod[0].fraction = 0.0f;
    const ChunkStateBlock& s = hidden.Run();
    EXPECT_EQ(s.flags, 0u);
    EXPECT_EQ(s.live_strands + s.live_vertices + s.visible_strands, 0u);
    EXPECT_EQ(s.keys_changed + s.records_changed + s.state_changed, 0u);
    EXPECT_EQ(s.first_place, kIsPatch<W> ? 0u : 7 * kStrandsPerChunk);
    hidden.layer[0].flags |= kLayerEnabled;
    hidden.lod[0].visible = 1;
    hidden.lod[0].fraction = 1.0f;
    EXPECT_EQ(hidden.Run().flags, kEverything | kChunkRestart);
    EXPECT_EQ(hidden.state[0].first_new_strand, 0u);
    EXPECT_EQ(hidden.state[0].first_new_vertex, 0u);
  }
}

TEST(Activate, WhatIsHiddenDoesNothingAndStartsAfreshWhenSeenAgain) {
  ExpectAfreshWhenSeenAgain<PatchWorld>();
  ExpectAfreshWhenSeenAgain<ChunkWorld>();
  ExpectAfreshWhenSeenAgain<FollowerWorld>();
}

// The step after new lanes was not given the state it is compared with: no sleep, regardless
// of what it reports.
template <class W>
void ExpectOneStepMoreAfterGrowth(W& w) {
  EXPECT_EQ(w.state[0].flags, kEverything);
  w.state[0].state_changed = 0;
  EXPECT_TRUE(w.Run().flags & kChunkSimulate);
  w.state[0].state_changed = 0;
  EXPECT_FALSE(w.Run().flags & kChunkSimulate);
}

template <class W>
void ExpectOnlyNewStrandsStart() {
  W w;
  w.lod[0].fraction = 0.5f;
  Settle(w);
  EXPECT_EQ(w.state[0].first_new_strand, w.state[0].live_strands);
  const uint32_t strands = w.state[0].live_strands;
  w.lod[0].fraction = 0.75f;
  w.Run();
  EXPECT_EQ(w.state[0].first_new_strand, strands);
  EXPECT_GT(w.state[0].live_strands, strands);
  ExpectOneStepMoreAfterGrowth(w);
}

TEST(Activate, GrowthStartsOnlyTheNewLanes) {
  ExpectOnlyNewStrandsStart<ChunkWorld>();
  ExpectOnlyNewStrandsStart<FollowerWorld>();
  PatchWorld w;
  w.lod[0].fraction = 0.5f;
  Settle(w);
  EXPECT_EQ(w.state[0].first_new_vertex, w.state[0].live_vertices);
  const uint32_t vertices = w.state[0].live_vertices;
  w.lod[0].fraction = 0.75f;
  w.Run();
  EXPECT_EQ(w.state[0].first_new_vertex, vertices);
  EXPECT_GT(w.state[0].live_vertices, vertices);
  ExpectOneStepMoreAfterGrowth(w);
}

// Of a patch of 100 that lives whole: half are kept, then a quarter.
TEST(Activate, ChainsThinByTheirLevel) {
  if (kVerticesPerChunk < 100) GTEST_SKIP() << "a patch of 100 chains";
  PatchWorld w(100);
  Settle(w);
  const ChunkStateBlock& s = w.state[0];
  EXPECT_EQ(s.live_chains, 100u);
  EXPECT_EQ(s.whole_chains, 100u);
  const auto expect = [&](uint32_t live, uint32_t first_new, uint32_t whole, bool simulates) {
    w.Run();
    EXPECT_EQ(s.live_vertices, 100u);
    EXPECT_EQ(s.live_chains, live);
    EXPECT_EQ(s.first_new_chain, first_new);
    EXPECT_EQ(s.whole_chains, whole);
    EXPECT_EQ((s.flags & kChunkSimulate) != 0, simulates);
    EXPECT_EQ((s.flags & kChunkSkin) != 0, first_new < live) << "anchors of chains that come";
    w.state[0].state_changed = 0;
  };
  w.lod[0].parent_share = 0.25f;
  expect(100, 100, 64, true);
  expect(100, 100, 64, false);  // nothing moves
  w.lod[0].parent_share = 0.5f;
  expect(100, 100, 64, true);
  w.lod[0].chain_level = 1;
  w.lod[0].parent_share = 0.0f;
  expect(64, 64, 64, true);
  expect(64, 64, 64, false);
  w.lod[0].parent_share = 0.5f;
  expect(64, 64, 32, true);
  w.lod[0].chain_level = 0;
  w.lod[0].parent_share = 1.0f;
  expect(100, 64, 64, true);
  expect(100, 100, 64, true);  // its first step was not given what it is compared with
  expect(100, 100, 64, false);
  // Of a patch that does not live whole, those that do.
  w.lod[0].chain_level = 0;
  w.lod[0].parent_share = 0.0f;
  w.lod[0].fraction = 0.5f;
  w.Run();
  EXPECT_EQ(s.live_vertices, 64u);
  EXPECT_EQ(s.live_chains, 64u);
}

template <class W>
void ExpectNoSleepOnTheFirstReport() {
  W w;
  w.Run();
  w.state[0].state_changed = 0;
  EXPECT_TRUE(w.Run().flags & kChunkSimulate);
}

TEST(Activate, WhatRestartedDoesNotSleepOnItsFirstReport) {
  ExpectNoSleepOnTheFirstReport<PatchWorld>();
  ExpectNoSleepOnTheFirstReport<ChunkWorld>();
  ExpectNoSleepOnTheFirstReport<FollowerWorld>();
}

// No kernel reads keys of shells, triangles of the skin. Of other strands sort_key decides what is visible.
TEST(Activate, AllLivingStrandsOfShellsAreVisible) {
  FollowerWorld shells(100), others(100);
  shells.layer[0].flags |= kLayerShells;
  for (const float fraction : {1.0f, 0.3f, 0.3f, 0.3f, 0.8f}) {
    shells.lod[0].fraction = fraction;
    shells.Run();
    EXPECT_EQ(shells.state[0].live_strands, uint32_t(std::ceil(fraction * 100.0f)));
    EXPECT_EQ(shells.state[0].visible_strands, shells.state[0].live_strands);
  }
  shells.lod[0].visible = 0;
  EXPECT_EQ(shells.Run().visible_strands, 0u);
  Settle(others);
  others.state[0].visible_strands = 50;
  EXPECT_EQ(others.Run().visible_strands, 50u);
  others.params.first_frame = 1;
  EXPECT_EQ(others.Run().visible_strands, 0u);
}

// ---- The truth tables ---------------------------------------------------------------------------

constexpr uint32_t kKeys = kChunkKeys, kFit = kChunkFit | kKeys, kSim = kChunkSimulate | kFit,
                   kSkin = kChunkSkin | kSim;

template <class W>
struct Event {
  const char* name;
  std::function<void(W&)> act;
  // Expected of what has settled, besides kChunkVisible. kChunkSteady: what simulate reads is as it
  // was, even if stages run all the same.
  uint32_t flags;
};

// Those that mean the same to all.
template <class W>
std::vector<Event<W>> SharedEvents() {
  return {
      {"nothing", [](W&) {}, kChunkSteady},
      {"another's joint moves", [](W& w) { w.palette[0].moved[1] = ~0u; }, kChunkSteady},
      {"a joint of its own moves", [](W& w) { w.palette[0].moved[3] = 1u << 9; }, kSkin},
      {"it moved last frame", [](W& w) { w.state[0].moved = 1; }, kSkin},
      {"state changed last frame", [](W& w) { w.state[0].state_changed = 1; }, kSim | kChunkSteady},
      {"layer parameters change", [](W& w) { w.layer[0].changed = 1; }, kSim},
      {"wind blows", [](W& w) { w.layer[0].flags |= kLayerWind | kLayerBlows; }, kSim},
      {"a force volume stands in it", [](W& w) { w.layer[0].flags |= kLayerWind | kLayerPushed; },
       kChunkSteady},
      {"and wind blows", [](W& w) { w.layer[0].flags |= kLayerWind | kLayerPushed | kLayerBlows; },
       kSim},
      {"still air is not left out", [](W& w) { w.layer[0].flags |= kLayerWind; },
       kSim | kChunkSteady},
      {"dt, ground or spheres change", [](W& w) { w.params.frame_inputs_changed = 1; }, kSim},
      {"the view changes", [](W& w) { w.params.view_changed = 1; }, kKeys | kChunkSteady},
      {"teleport", [](W& w) { w.palette[0].teleported = 1; }, kSkin | kChunkRestart},
      {"first frame", [](W& w) { w.params.first_frame = 1; }, kSkin | kChunkRestart},
      {"less of it lives", [](W& w) { w.lod[0].fraction = 0.5f; }, kSim},
      {"wind over what is not simulated",
       [](W& w) { w.layer[0].flags = kLayerEnabled | kLayerWind; }, kChunkSteady},
      {"dt changes over what is not simulated",
       [](W& w) {
         w.layer[0].flags = kLayerEnabled;
         w.params.frame_inputs_changed = 1;
       },
       0},
  };
}

template <class W>
void ExpectTable(const std::vector<Event<W>>& events) {
  for (const Event<W>& event : events)
    for (uint32_t switches = 0; switches <= kAllSwitches; ++switches) {
      W w;
      Settle(w);
      w.params.switches = switches;
      event.act(w);
      uint32_t expected = event.flags | kChunkVisible;
      if (!(switches & kSwitchSkipUnmoved)) expected |= kChunkSkin;
      if (!(switches & kSwitchSleep)) expected |= kSim;
      if (!(switches & kSwitchSkipSort)) expected |= kKeys;
      const ChunkStateBlock& s = w.Run();
      EXPECT_EQ(s.flags, expected) << event.name << ", switches " << switches;
      EXPECT_EQ(s.records_changed, !kIsPatch<W> && (s.flags & kChunkFit) ? 1u : 0u) << event.name;
      EXPECT_EQ(s.state_changed + s.keys_changed, 0u) << event.name;
    }
}

TEST(Activate, TruthTableOfASettledPatch) {
  auto events = SharedEvents<PatchWorld>();
  events.push_back({"fewer strands live, of the same vertices",
                    [](PatchWorld& w) { w.lod[0].fraction = 0.9f; }, kChunkSteady});
  events.push_back({"the fade begins", [](PatchWorld& w) { w.lod[0].fade = 0.1f; }, kChunkSteady});
  ExpectTable(events);
}

template <class W>
std::vector<Event<W>> ChunkEvents() {
  auto events = SharedEvents<W>();
  events.push_back({"the fade begins", [](W& w) { w.lod[0].fade = 0.1f; }, kFit | kChunkSteady});
  return events;
}

TEST(Activate, TruthTableOfASettledChunk) { ExpectTable(ChunkEvents<ChunkWorld>()); }

template <class W>
void ExpectFollowersTable() {
  auto events = ChunkEvents<W>();
  for (const uint32_t patch : {2u, 5u, 9u}) {
    events.push_back({"a patch of its list is simulated",
                      [patch](W& w) { w.patches[patch].flags = kEverything; },
                      kSim | kChunkSteady});
    events.push_back({"and of a layer that is not",
                      [patch](W& w) {
                        w.layer[0].flags = kLayerEnabled;
                        w.patches[patch].flags = kEverything;
                      },
                      kSim | kChunkSteady});
    events.push_back({"a patch of its list does all but that",
                      [patch](W& w) { w.patches[patch].flags = kEverything & ~kChunkSimulate; },
                      kChunkSteady});
  }
  events.push_back({"all others are simulated",
                    [](W& w) {
                      for (uint32_t p = 0; p < w.patches.size(); ++p)
                        if (p != 2 && p != 5 && p != 9) w.patches[p].flags = kEverything;
                    },
                    kChunkSteady});
  ExpectTable(events);
}

TEST(Activate, TruthTableOfASettledChunkThatFollows) { ExpectFollowersTable<FollowerWorld>(); }
TEST(Activate, TruthTableOfASettledChunkThatFollowsInALocalStore) {
  ExpectFollowersTable<FetchedWorld>();
}

template <class W>
void ExpectNoSleepWithMoreThanAreListed() {
  W w;
  for (ChunkStateBlock& patch : w.patches) patch.flags = kChunkVisible;
  for (uint32_t i = 0; i < kListedPatches; ++i) w.list[0].patch[i] = i;
  Settle(w);
  EXPECT_FALSE(w.Run().flags & kChunkSimulate) << "as many as are listed";
  w.patches[kListedPatches - 1].flags |= kChunkSimulate;
  EXPECT_TRUE(w.Run().flags & kChunkSimulate) << "the last of them";
  w.patches[kListedPatches - 1].flags = kChunkVisible;
  EXPECT_FALSE(w.Run().flags & kChunkSimulate);
  w.list[0].patch[kListedPatches] = kListedPatches;
  for (int frame = 0; frame < 3; ++frame)
    EXPECT_TRUE(w.Run().flags & kChunkSimulate) << "some are not listed";
}

TEST(Activate, WhoFollowsMorePatchesThanAreListedNeverSleeps) {
  ExpectNoSleepWithMoreThanAreListed<FollowerWorld>();
  ExpectNoSleepWithMoreThanAreListed<FetchedWorld>();
}

template <class W>
void ExpectSameOnEveryVector() {
  ForEveryVector([]<class V>(const char* name) {
    W world(100), reference(100);
    for (int i = 0; i < 50; ++i) {
      world.lod[0].fraction = reference.lod[0].fraction = float(i % 7) / 6.0f;
      world.template Run<V>();
      reference.template Run<ArrayVec<4>>();
      ASSERT_TRUE(world.state.SameBits(reference.state)) << name;
    }
  });
}

TEST(Activate, SameBitsOnEveryVector) {
  ExpectSameOnEveryVector<PatchWorld>();
  ExpectSameOnEveryVector<ChunkWorld>();
  ExpectSameOnEveryVector<FollowerWorld>();
}

}  // namespace
}  // namespace pelt::test
