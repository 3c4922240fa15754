// Activate: of patches, of chunks whose strands have chains of their own, of chunks that follow the
// chains at vertices. The live prefixes, the truth tables of the decisions, and the promise that
// matters: a layer that skips ends every frame with the bits of a layer that does not.
#include "core/kernels/activate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <vector>

#include "tests/kernels/every_vector.hpp"

namespace pelt {
namespace {

using test::Blocks;

constexpr uint32_t kAllSwitches = kSwitchSleep | kSwitchSkipUnmoved | kSwitchSkipSort;

// ---- One item and what it reads -----------------------------------------------------------------

struct World {
  Blocks<PaletteBlock> palette{1, 0};
  Blocks<LayerBlock> layer{1, 0};
  Blocks<LodBlock> lod{1, 0};
  Blocks<ChunkStateBlock> state{1, 0};
  ActivateParams params{kAllSwitches, 0, 0, 0};

  World() {
    layer[0].flags = kLayerEnabled | kLayerSimulate;
    lod[0].visible = 1;
    lod[0].fraction = 1.0f;
  }
};

constexpr uint32_t kJoints[] = {5, 3 * 32 + 9};

void AddJoint(uint32_t joint, uint32_t (&mask)[kJointsPerCharacter / 32]) {
  mask[joint / 32] |= 1u << joint % 32;
}

// Its first half is in use from the first strand on.
struct PatchWorld : World {
  Blocks<PatchBlock> patch{1, 0};

  explicit PatchWorld(uint32_t vertex_count = kVerticesPerChunk) {
    patch[0].vertex_count = vertex_count;
    for (const uint32_t joint : kJoints) AddJoint(joint, patch[0].joint_mask);
    for (uint32_t g = 0; g < kVertexGroups; ++g)
      patch[0].live_from[g] = g < kVertexGroups / 2 ? 0.0f : 0.6f;
  }
  template <class V = ArrayVec<4>>
  const ChunkStateBlock& Run() {
    test::RunKernel<ActivatePatch<V>>(
        params, {palette.Bind(), layer.Bind(), lod.Bind(), patch.Bind(), state.Bind()});
    return state[0];
  }
};

// Strands with chains of their own.
struct ChunkWorld : World {
  Blocks<StrandBlock> strands{1, 0};

  explicit ChunkWorld(uint32_t strand_count = kStrandsPerChunk) {
    strands[0].strand_count = strand_count;
    strands[0].vertex_count = kVerticesPerChunk / 2;
    strands[0].first_strand = 7 * kStrandsPerChunk;
    for (const uint32_t joint : kJoints) AddJoint(joint, strands[0].joint_mask);
  }
  template <class V = ArrayVec<4>>
  const ChunkStateBlock& Run() {
    test::RunKernel<Activate<V>>(
        params, {palette.Bind(), layer.Bind(), lod.Bind(), strands.Bind(), state.Bind()});
    return state[0];
  }
};

constexpr uint32_t kEverything =
    kChunkVisible | kChunkSkin | kChunkSimulate | kChunkFit | kChunkKeys;

// Strands that follow chains at the vertices of the layer's patches 2, 5 and 9, which sleep; those
// beside them do not. kFetched: the listed states lie as a local store has them, one behind the
// other, and behind them what was not fetched.
template <bool kFetched>
struct FollowerWorldOf : ChunkWorld {
  Blocks<PatchListBlock> list{1};
  Blocks<ChunkStateBlock> patches{kListedPatches + 9, 0};

  explicit FollowerWorldOf(uint32_t strand_count = kStrandsPerChunk) : ChunkWorld(strand_count) {
    constexpr uint32_t kListed[] = {2, 5, 9};
    std::copy(std::begin(kListed), std::end(kListed), list[0].patch);
    for (const uint32_t beside : {1, 3, 10}) patches[beside].flags = kEverything;
  }
  template <class V = ArrayVec<4>>
  const ChunkStateBlock& Run() {
    Blocks<ChunkStateBlock> fetched(kFetched ? std::size(list[0].patch) : 0);
    Binding states = patches.BindList(list[0].patch);
    if (kFetched) {
      for (uint32_t i = 0; i < fetched.size(); ++i)
        if (list[0].patch[i] < patches.size()) fetched[i] = patches[list[0].patch[i]];
      states = fetched.Bind();
    }
    test::RunKernel<ActivateFollowers<V>>(
        params, {palette.Bind(), layer.Bind(), lod.Bind(), strands.Bind(), list.Bind(), states,
                 state.Bind()});
    return state[0];
  }
};
using FollowerWorld = FollowerWorldOf<false>;
using FetchedWorld = FollowerWorldOf<true>;

// Came into view some frames ago, and its last step changed nothing.
template <class W>
void Settle(W& w) {
  w.Run();
  w.state[0].state_changed = 1;
  w.Run();
  w.state[0].state_changed = 0;
}

template <class W>
constexpr bool kIsPatch = std::is_same_v<W, PatchWorld>;

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

// ---- A layer ------------------------------------------------------------------------------------
//
// Two chunks and three patches, the one in the middle of both. As in a groom, vertices that few
// strands need lie behind.

constexpr uint32_t kToyPatches = 3, kToyChunks = 2;
constexpr uint32_t kToyVertices = kVerticesPerChunk * 3 / 8;  // of a patch
constexpr uint32_t kToyStrands[kToyChunks] = {kStrandsPerChunk / 2, kStrandsPerChunk * 5 / 16};

uint32_t ToyJoint(uint32_t patch, uint32_t lane) {
  return (patch + lane / kLaneGroup % 2) / 2;  // of kJoints: the patch in the middle has both
}

struct ToyGroom {
  Blocks<PatchBlock> patches{kToyPatches, 0};
  Blocks<StrandBlock> strands{kToyChunks, 0};
  Blocks<HaloBlock> halo{kToyChunks};
  Blocks<PatchListBlock> lists{kToyChunks};
};

// Above which share of living strands a kernel uses strand `place` of `count`; shares are products
// that are rounded.
double LiveFrom(uint32_t place, uint32_t count) {
  return double(place / kLaneGroup * kLaneGroup) / double(count) * (1.0 - 1.0e-6);
}

void AddChunk(ToyGroom& groom, uint32_t c, std::mt19937& random, std::vector<double>& live_from) {
  StrandBlock& strands = groom.strands[c];
  strands.strand_count = kToyStrands[c];
  std::map<uint32_t, uint32_t> places;  // in the halo, by the place in the layer
  for (uint32_t s = 0; s < strands.strand_count; ++s)
    for (auto& corner : strands.vertex) {
      const uint32_t patch = c + random() % 2;
      const uint32_t used =
          1 + kToyVertices * (s / kLaneGroup + 1) / (strands.strand_count / kLaneGroup + 1);
      const uint32_t vertex = patch * kVerticesPerChunk + random() % std::min(used, kToyVertices);
      const uint32_t place = places.emplace(vertex, strands.vertex_count).first->second;
      if (place == strands.vertex_count) groom.halo[c].vertex[strands.vertex_count++] = vertex;
      corner[s] = uint8_t(place);
      live_from[vertex] = std::min(live_from[vertex], LiveFrom(s, strands.strand_count));
      AddJoint(kJoints[ToyJoint(patch, vertex % kVerticesPerChunk)], strands.joint_mask);
    }
  groom.lists[c].patch[0] = c;
  groom.lists[c].patch[1] = c + 1;
}

ToyGroom MakeToyGroom(uint32_t seed) {
  ToyGroom groom;
  std::mt19937 random(seed);
  std::vector<double> live_from(kToyPatches * kVerticesPerChunk, 1.0);
  for (uint32_t c = 0; c < kToyChunks; ++c) AddChunk(groom, c, random, live_from);
  for (uint32_t p = 0; p < kToyPatches; ++p) {
    groom.patches[p].vertex_count = kToyVertices;
    for (uint32_t lane = 0; lane < kToyVertices; ++lane)
      AddJoint(kJoints[ToyJoint(p, lane)], groom.patches[p].joint_mask);
    double from = 1.0;
    for (uint32_t lane = kVerticesPerChunk; lane-- > 0;) {
      from = std::min(from, live_from[p * kVerticesPerChunk + lane]);
      groom.patches[p].live_from[lane / kLaneGroup] = float(from);
    }
  }
  return groom;
}

TEST(Activate, LiveVerticesCoverEveryLaneAKernelTouches) {
  for (uint32_t seed = 1; seed <= 5; ++seed) {
    const ToyGroom groom = MakeToyGroom(seed);
    PatchWorld patch[kToyPatches];
    ChunkWorld chunk[kToyChunks];
    for (uint32_t p = 0; p < kToyPatches; ++p) patch[p].patch[0] = groom.patches[p];
    for (uint32_t c = 0; c < kToyChunks; ++c) chunk[c].strands[0] = groom.strands[c];
    // Vertices of a patch up to the last that a lane in use needs, in whole groups.
    const auto needed = [&](uint32_t p, float fraction) {
      uint32_t most = 0;
      for (uint32_t c = 0; c < kToyChunks; ++c) {
        chunk[c].lod[0].fraction = fraction;
        const uint32_t touched = RoundUpToLaneGroups(chunk[c].Run().live_strands);
        for (uint32_t s = 0; s < std::min(touched, kToyStrands[c]); ++s)
          for (const auto& corner : groom.strands[c].vertex) {
            const uint32_t vertex = groom.halo[c].vertex[corner[s]];
            if (vertex / kVerticesPerChunk == p)
              most = std::max(most, vertex % kVerticesPerChunk + 1);
          }
      }
      return std::min(RoundUpToLaneGroups(most), kToyVertices);
    };
    for (int i = 1; i <= 400; ++i) {
      const float fraction = float(i) / 400.0f;
      for (uint32_t p = 0; p < kToyPatches; ++p) {
        patch[p].lod[0].fraction = fraction;
        const uint32_t live = patch[p].Run().live_vertices;
        EXPECT_GE(live, needed(p, fraction)) << seed << ", patch " << p << " at " << fraction;
        EXPECT_LE(live, needed(p, std::min(1.0f, fraction * 1.00001f))) << "and no group more";
      }
    }
  }
}

// ---- Skipping changes nothing -------------------------------------------------------------------
//
// The layer with made-up kernels that read and write what the real ones do, in whole numbers: its
// strands have chains of their own, or follow those at the vertices. Two copies live through the
// same scene, one with switches and one without; after every frame all that a frame leaves for
// others must agree.

struct Scene {  // what the caller and the character decide for a frame
  bool visible = true, teleported = false, view_changed = false, inputs_changed = false;
  bool joint_moved[2] = {}, layer_changed = false, wind = false, simulated = true;
  int pose[2] = {}, view = 0, inputs = 0, parameter = 0, gust = 0;
  float fraction = 1.0f, fade = 0.0f;
};

struct ToyChain {
  int point = 0, previous = 0;
  friend bool operator==(const ToyChain&, const ToyChain&) = default;

  // Comes to rest after some frames: a quarter of the way, with what is left of the speed. Says
  // whether something changed.
  bool Step(const Scene& scene, bool fresh, int root, int motion) {
    const int goal = root + scene.parameter + scene.inputs + (scene.wind ? scene.gust : 0);
    const ToyChain from = *this;
    if (fresh || !scene.simulated) {
      point = previous = root;
      // Overshoots in its first step, so that what is seen again may repeat old bits by chance.
      if (fresh && scene.simulated) point = root + (goal - root) / 2;
    } else {
      point = from.point + (goal - from.point) / 4 + (from.point - from.previous) / 2 + motion / 4;
      previous = from.point;
    }
    return *this != from;
  }
};

struct ToyPatch {
  PatchWorld world;
  uint32_t number = 0;  // in the layer
  int position[kVerticesPerChunk] = {}, motion[kVerticesPerChunk] = {};
  ToyChain chain[kVerticesPerChunk];
  int load[kVerticesPerChunk] = {};

  ChunkStateBlock& state() { return world.state[0]; }
  bool IsNew(uint32_t v) {
    return (state().flags & kChunkRestart) || v >= state().first_new_vertex;
  }
  void Skin(const Scene& scene) {
    for (uint32_t v = 0; v < state().live_vertices; ++v) {
      const int now = scene.pose[ToyJoint(number, v)] * 100 + int(v);
      motion[v] = IsNew(v) ? 0 : now - position[v];
      position[v] = now;
    }
  }
  void Simulate(const Scene& scene) {
    bool changed = false;
    for (uint32_t v = 0; v < state().live_vertices; ++v) {
      changed |= chain[v].Step(scene, IsNew(v), position[v], motion[v]);
      load[v] = chain[v].point - position[v];
    }
    state().state_changed = changed;
  }
  bool AgreesWith(ToyPatch& other) {
    const uint32_t live = state().live_vertices;
    return live == other.state().live_vertices &&
           std::equal(position, position + live, other.position) &&
           std::equal(motion, motion + live, other.motion) &&
           std::equal(chain, chain + live, other.chain) &&
           std::equal(load, load + live, other.load);
  }
};

struct ToyChunk {
  FollowerWorld world;
  const HaloBlock* halo = nullptr;
  int root[kStrandsPerChunk] = {}, root_motion[kStrandsPerChunk] = {};
  ToyChain chain[kStrandsPerChunk];
  int record[kStrandsPerChunk] = {};
  uint32_t key[kStrandsPerChunk] = {};
  bool reported_still = false;

  ChunkStateBlock& state() { return world.state[0]; }

  // Calls visit(patch, lane) for each of a strand's vertices.
  template <class Visit>
  void ForEachVertex(uint32_t strand, ToyPatch (&patches)[kToyPatches], Visit visit) {
    for (const auto& corner : world.strands[0].vertex) {
      const uint32_t vertex = halo->vertex[corner[strand]];
      visit(patches[vertex / kVerticesPerChunk], vertex % kVerticesPerChunk);
    }
  }
  // Says whether all vertices in use live.
  bool PlaceRoots(ToyPatch (&patches)[kToyPatches]) {
    bool all_live = true;
    for (uint32_t s = 0; s < state().live_strands; ++s) {
      root[s] = int(s);
      root_motion[s] = 0;
      ForEachVertex(s, patches, [&](ToyPatch& patch, uint32_t lane) {
        all_live &= lane < patch.state().live_vertices;
        root[s] += patch.position[lane];
        root_motion[s] += patch.motion[lane];
      });
    }
    return all_live;
  }
  void Simulate(const Scene& scene) {
    bool changed = false;
    for (uint32_t s = 0; s < state().live_strands; ++s) {
      const bool fresh = (state().flags & kChunkRestart) || s >= state().first_new_strand;
      changed |= chain[s].Step(scene, fresh, root[s], root_motion[s]);
    }
    state().state_changed = changed;
    reported_still = !changed;
  }
  void Follow(ToyPatch (&patches)[kToyPatches]) {
    for (uint32_t s = 0; s < state().live_strands; ++s) {
      chain[s].point = root[s];
      ForEachVertex(s, patches,
                    [&](ToyPatch& patch, uint32_t lane) { chain[s].point += patch.load[lane]; });
    }
  }
  void Fit(const Scene& scene) {
    for (uint32_t s = 0; s < state().live_strands; ++s) {
      int alpha = 255;
      if (state().fade_count > 0.0f) {
        const float share = (state().live_exact - float(s)) / state().fade_count;
        alpha = int(255.0f * std::clamp(share, 0.0f, 1.0f));
      }
      record[s] = (chain[s].point * 7 + root[s] * 3 + scene.parameter) * 256 + alpha;
    }
  }
  void MakeKeys(const Scene& scene) {
    bool changed = (state().flags & kChunkRestart) != 0;
    for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
      const bool live = s < state().live_strands;
      const uint32_t now = live ? uint32_t(chain[s].point * scene.view + root[s]) : kCulledKey;
      changed |= now != key[s];
      key[s] = now;
    }
    state().keys_changed = changed;
  }
  bool AgreesWith(ToyChunk& other) {
    const uint32_t live = state().live_strands;
    return live == other.state().live_strands && std::equal(root, root + live, other.root) &&
           std::equal(root_motion, root_motion + live, other.root_motion) &&
           std::equal(chain, chain + live, other.chain) &&
           std::equal(record, record + live, other.record) &&
           (live == 0 || std::equal(key, key + kStrandsPerChunk, other.key)) &&
           state().keys_changed == other.state().keys_changed;
  }
};

class ToyLayer {
 public:
  ToyLayer(bool follows, uint32_t switches) : follows_(follows), switches_(switches) {
    for (uint32_t p = 0; p < kToyPatches; ++p) {
      patches_[p].number = p;
      patches_[p].world.patch[0] = groom_.patches[p];
    }
    for (uint32_t c = 0; c < kToyChunks; ++c) {
      chunks_[c].world.strands[0] = groom_.strands[c];
      chunks_[c].world.list[0] = groom_.lists[c];
      chunks_[c].halo = &groom_.halo[c];
    }
  }
  // Deliberately broken rules: see the last tests.
  bool trust_any_report = false, sleep_through_patches = false;
  bool all_in_use_live = true;
  // Items.
  int slept = 0, skin_skipped = 0, roots_skipped = 0, fit_skipped = 0, keys_skipped = 0;

  void RunFrame(const Scene& scene, bool first) {
    for (ToyPatch& patch : patches_) RunPatch(scene, first, patch);
    for (ToyChunk& chunk : chunks_) RunChunk(scene, first, chunk);
  }
  bool AgreesWith(ToyLayer& other) {
    bool agree = true;
    for (uint32_t p = 0; p < kToyPatches; ++p) agree &= patches_[p].AgreesWith(other.patches_[p]);
    for (uint32_t c = 0; c < kToyChunks; ++c) agree &= chunks_[c].AgreesWith(other.chunks_[c]);
    return agree;
  }

 private:
  void Set(const Scene& scene, bool first, World& world) const {
    world.lod[0].visible = scene.visible;
    world.lod[0].fraction = scene.fraction;
    world.lod[0].fade = scene.fade;
    world.palette[0].teleported = scene.teleported;
    std::fill(std::begin(world.palette[0].moved), std::end(world.palette[0].moved), 0u);
    for (int j = 0; j < 2; ++j)
      if (scene.joint_moved[j]) AddJoint(kJoints[j], world.palette[0].moved);
    world.layer[0].flags =
        kLayerEnabled | (scene.wind ? kLayerWind : 0u) | (scene.simulated ? kLayerSimulate : 0u);
    world.layer[0].changed = scene.layer_changed;
    world.params = {switches_, scene.inputs_changed, scene.view_changed, first};
  }
  void RunPatch(const Scene& scene, bool first, ToyPatch& patch) {
    Set(scene, first, patch.world);
    const uint32_t flags = patch.world.Run().flags;
    if (!(flags & kChunkVisible)) return;
    skin_skipped += !(flags & kChunkSkin);
    if (flags & kChunkSkin) patch.Skin(scene);
    if (!follows_) return;  // no strand follows chains at vertices
    slept += !(flags & kChunkSimulate);
    if (flags & kChunkSimulate) patch.Simulate(scene);
  }
  void RunChunk(const Scene& scene, bool first, ToyChunk& chunk) {
    Set(scene, first, chunk.world);
    for (uint32_t p = 0; p < kToyPatches; ++p) chunk.world.patches[p] = patches_[p].state();
    const bool looks = follows_ && !sleep_through_patches;
    const uint32_t flags = (looks ? chunk.world.Run() : chunk.world.ChunkWorld::Run()).flags;
    if (!(flags & kChunkVisible)) return;
    bool simulate = (flags & kChunkSimulate) != 0;
    if (trust_any_report && chunk.reported_still && !(flags & (kChunkSkin | kChunkRestart)))
      simulate = false;
    roots_skipped += !(flags & kChunkSkin);
    fit_skipped += !(flags & kChunkFit);
    keys_skipped += !(flags & kChunkKeys);
    if (flags & kChunkSkin) all_in_use_live &= chunk.PlaceRoots(patches_);
    if (!follows_) {
      slept += !simulate;
      if (simulate) chunk.Simulate(scene);
    }
    if (flags & kChunkFit) {
      if (follows_) chunk.Follow(patches_);
      chunk.Fit(scene);
    }
    if (flags & kChunkKeys) chunk.MakeKeys(scene);
  }

  const bool follows_;
  const uint32_t switches_;
  const ToyGroom groom_ = MakeToyGroom(1);
  ToyPatch patches_[kToyPatches];
  ToyChunk chunks_[kToyChunks];
};

Scene NextScene(Scene s, std::mt19937& random) {
  const auto chance = [&](uint32_t one_in) { return random() % one_in == 0; };
  const Scene last = s;
  s.teleported = s.layer_changed = s.inputs_changed = s.view_changed = false;
  s.joint_moved[0] = s.joint_moved[1] = false;
  if (chance(2)) return s;  // still frames come in runs
  if (chance(40)) s.visible = !s.visible;
  for (int& pose : s.pose)
    if (chance(60)) pose += int(random() % 9) - 4;
  if (chance(60)) s.teleported = true;
  if (chance(60)) s.parameter = int(random() % 50);
  if (chance(60)) s.inputs = int(random() % 50);
  if (chance(80)) s.wind = !s.wind;
  if (chance(200)) s.simulated = !s.simulated;
  if (chance(40)) s.view = int(random() % 5);
  if (chance(50)) s.fraction = float(1 + random() % 8) / 8.0f;
  if (chance(50)) s.fade = chance(2) ? 0.0f : 0.125f;
  s.gust = int(random() % 30);
  for (int j = 0; j < 2; ++j) s.joint_moved[j] = s.pose[j] != last.pose[j];
  s.layer_changed =
      s.parameter != last.parameter || s.wind != last.wind || s.simulated != last.simulated;
  s.inputs_changed = s.inputs != last.inputs;
  s.view_changed = s.view != last.view;
  return s;
}

constexpr int kToyFrames = 10000;

// The first frame after which the two do not agree; kToyFrames if they always do.
int FindDifference(ToyLayer& a, ToyLayer& b, uint32_t seed) {
  std::mt19937 random(seed);
  Scene scene;
  for (int frame = 0; frame < kToyFrames; ++frame) {
    a.RunFrame(scene, frame == 0);
    b.RunFrame(scene, frame == 0);
    if (!a.AgreesWith(b)) return frame;
    scene = NextScene(scene, random);
  }
  return kToyFrames;
}

void ExpectTheBitsOfNotSkipping(bool follows) {
  for (uint32_t switches = 1; switches <= kAllSwitches; ++switches) {
    ToyLayer skipping(follows, switches), working(follows, 0);
    ASSERT_EQ(FindDifference(skipping, working, switches), kToyFrames) << "switches " << switches;
    EXPECT_TRUE(skipping.all_in_use_live && working.all_in_use_live);
    EXPECT_EQ(working.slept + working.skin_skipped + working.roots_skipped + working.fit_skipped,
              0);
    const bool sleeps = (switches & kSwitchSleep) != 0,
               skips_unmoved = (switches & kSwitchSkipUnmoved) != 0;
    EXPECT_EQ(skipping.slept > 250, sleeps);
    EXPECT_EQ(skipping.fit_skipped > 250, sleeps);
    EXPECT_EQ(skipping.skin_skipped > 250, skips_unmoved);
    EXPECT_EQ(skipping.roots_skipped > 250, skips_unmoved);
    if (sleeps && (switches & kSwitchSkipSort)) {
      EXPECT_GT(skipping.keys_skipped, 250);
    }
  }
}

TEST(Activate, SkippingLeavesTheBitsOfNotSkipping) { ExpectTheBitsOfNotSkipping(false); }
TEST(Activate, SkippingLeavesTheBitsOfNotSkippingWhereStrandsFollow) {
  ExpectTheBitsOfNotSkipping(true);
}

// The tests above must be able to fail: a chunk that sleeps on any report of "unchanged" is found.
TEST(Activate, SleepingOnAnyReportIsFound) {
  ToyLayer broken(false, kAllSwitches), working(false, 0);
  broken.trust_any_report = true;
  EXPECT_LT(FindDifference(broken, working, 1), kToyFrames);
}

// And one that does not look at the patches it follows.
TEST(Activate, SleepingThroughAPatchThatIsAwakeIsFound) {
  ToyLayer broken(true, kAllSwitches), working(true, 0);
  broken.sleep_through_patches = true;
  EXPECT_LT(FindDifference(broken, working, 1), kToyFrames);
}

template <class W>
void ExpectSameOnEveryVector() {
  test::ForEveryVector([]<class V>(const char* name) {
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
}  // namespace pelt
