// A layer of patches and chunks: its live vertices are those that its kernels need, and the promise
// that matters: a layer that skips ends every frame with the bits of a layer that does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <random>
#include <vector>

#include "core/kernels/activate.hpp"
#include "tests/kernels/activate_worlds.hpp"

namespace pelt::test {
namespace {

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

}  // namespace
}  // namespace pelt::test
