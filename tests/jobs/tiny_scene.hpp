// The scene `tiny` for tests of whole frames: every solver and chain in under a thousand
// strands. Baked once a program.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "bench/scenarios/scenarios.hpp"
#include "core/character/builtin_character.hpp"
#include "core/character/pose.hpp"
#include "core/groom/bake.hpp"
#include "jobs/frame.hpp"
#include "tests/run_frame.hpp"

namespace pelt::testing {

inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInf = std::numeric_limits<float>::infinity();

inline constexpr SkipSettings kNoSkips{
    .sleep = false, .unmoved = false, .sort = false, .cull = false, .wind = false, .light = false};

// A copy of the scenario that a test may change.
inline Scenario TinyScenario() {
  static const Scenario kBaked = LoadScenario("tiny");
  return kBaked;
}

// What every layer of a scenario is asked for.
inline std::vector<LayerParams*> LayersOf(Scenario& scenario) {
  std::vector<LayerParams*> layers;
  for (Groom& groom : scenario.grooms)
    for (GroomLayer& layer : groom.layers) layers.push_back(&layer.params);
  return layers;
}
// Another groom for the first actor.
inline Groom BakeForActor(const Scenario& scenario, const FurSetup& setup) {
  const Actor& actor = scenario.actors[0];
  const Character& character = scenario.characters[actor.character];
  return BakeGroom(character, ComputeRestGeometry(character, actor.unit_scale), setup,
                   actor.unit_scale);
}
// `tiny` with its modal layers sag-free.
inline Scenario SagFreeTiny() {
  static const Scenario kBaked = [] {
    Scenario scenario = TinyScenario();
    FurSetup setup = LoadSetup("tiny");
    for (LayerSetup& layer : setup.layers)
      layer.params.sag_free = layer.params.solver == Solver::kModal;
    scenario.grooms[scenario.actors[0].groom] = BakeForActor(scenario, setup);
    return scenario;
  }();
  return kBaked;
}

// `tiny`, and chains of 9 points, of strands that each have traits of their own.
inline Scenario TraitsTiny() {
  static const Scenario kBaked = [] {
    Scenario scenario = TinyScenario();
    FurSetup setup = LoadSetup("tiny");
    LayerSetup longer = setup.layers.back();
    longer.name = "modal9";
    longer.params.points = 9;
    setup.layers.push_back(longer);
    for (LayerSetup& layer : setup.layers) {
      for (Attribute* factor : {&layer.weight_scale, &layer.clump_scale, &layer.bounce_scale})
        factor->randomise = 0.5f;
      if (layer.params.solver == Solver::kModal) continue;
      layer.stiffness_scale.randomise = layer.damping_scale.randomise = 1.0f;
      layer.angle_limit = Attribute(40.0f);
      layer.angle_limit.randomise = 0.9f;
      layer.hardness_profile = {1.0f, 0.5f, 2.0f};
      layer.hardness_profile.resize(layer.params.points - 1, 0.25f);
    }
    scenario.grooms[scenario.actors[0].groom] = BakeForActor(scenario, setup);
    return scenario;
  }();
  return kBaked;
}

inline void SetModalFriction(Scenario& scenario, float friction) {
  for (LayerParams* layer : LayersOf(scenario))
    if (layer->solver == Solver::kModal) layer->friction = friction;
}

// One of each kind, near `tiny`.
inline Lighting TinyLighting() {
  Lighting lighting;
  lighting.light_count = 2;
  lighting.light[0] = {{1.0f, 1.5f, 0.5f}, 0.2f, {2.0f, 1.5f, 1.0f}, 6.0f};
  lighting.light[1] = {{-1.0f, 0.5f, 1.0f}, 0.0f, {0.2f, 0.3f, 0.8f}, 0.0f};
  lighting.sample_count = 2;
  lighting.sample[0] = {{0, 1, 0}, 4.0f, {0.4f, 0.5f, 0.7f}, {0.2f, 0.15f, 0.1f}, {0, 1, 0}};
  lighting.sample[1] = {{3, 1, 0}, 4.0f, {0.1f, 0.1f, 0.2f}, {0.1f, 0.1f, 0.1f}, {0, 1, 0}};
  for (float& colour : lighting.sun_rgb) colour = 1.5f;
  return lighting;
}

// Puts the layers of such a setup behind those of the first character.
inline void AddLayers(Scenario& scenario, const char* setup_text) {
  const Groom added = BakeForActor(scenario, ReadFurSetup(setup_text, "added", "."));
  Groom& groom = scenario.grooms[scenario.actors[0].groom];
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (GroomLayer layer : added.layers) {
    layer.first_patch += uint32_t(groom.mesh.size());
    layer.first_chunk += uint32_t(groom.strands.size());
    groom.layers.push_back(layer);
  }
  append(groom.layer_joints, added.layer_joints);
  append(groom.mesh, added.mesh);
  append(groom.strands, added.strands);
  append(groom.halo, added.halo);
  append(groom.strand_uv, added.strand_uv);
  append(groom.vertex_rest, added.vertex_rest);
  append(groom.strand_rest4, added.strand_rest4);
  append(groom.strand_rest5, added.strand_rest5);
  append(groom.shell_skin, added.shell_skin);
  append(groom.fin_edges, added.fin_edges);
  append(groom.vertex_down, added.vertex_down);
  append(groom.strand_down, added.strand_down);
  append(groom.strand_rest9, added.strand_rest9);
  append(groom.vertex_traits, added.vertex_traits);
  append(groom.strand_traits, added.strand_traits);
}

// A layer of shells on the character's head, behind the layers that there are.
inline void AddShells(Scenario& scenario) {
  AddLayers(scenario,
            "[[layer]]\n"
            "name = 'shells'\n"
            "output = 'shells'\n"
            "length = { value = 0.03, randomise = 0.3 }\n"
            "shells = 12\n"
            "fur_texture_size = 32\n"
            "fins = true\n"
            "mask.range = { low = [0.0, 0.5, 0.0], high = [1.0, 1.0, 1.0] }\n");
}

// Long hair of 8 links: as instances, and as ribbons that keep their groom.
inline void AddLongHair(Scenario& scenario) {
  AddLayers(scenario,
            "[[layer]]\n"
            "name = 'mane'\n"
            "chain = 'strand'\n"
            "points = 9\n"
            "density = 60_000\n"
            "max_strands = 150\n"
            "mask = { materials = ['head'] }\n"
            "length = { value = 0.12, randomise = 0.3 }\n"
            "curl = 300\n"
            "clump = 0.3\n"
            "clump_controls = 16\n"
            "[[layer]]\n"
            "name = 'tail'\n"
            "chain = 'strand'\n"
            "points = 9\n"
            "density = 60_000\n"
            "max_strands = 100\n"
            "mask = { materials = ['tail', 'arm'] }\n"
            "output = 'ribbons'\n"
            "length = 0.15\n"
            "sag_free = true\n");
}

// A sponge on the head, mud that reaches further, and what wipes some of it off.
inline std::vector<PaintBrush> TinyBrushes() {
  const auto brush = [](PaintChannel channel, float height, float radius, float amount) {
    return PaintBrush{{0.1f, height, 0.1f}, radius, 0.5f, uint32_t(channel), amount};
  };
  return {brush(PaintChannel::kWet, 1.0f, 0.3f, 0.05f), brush(PaintChannel::kMud, 0.5f, 0.5f, 0.1f),
          brush(PaintChannel::kMud, 0.6f, 0.2f, -0.04f)};
}

// `tiny` with every other layer lit, every other one of these painted; the scene itself has none, as
// its digests are kept.
inline Scenario LitScenario() {
  Scenario scenario = TinyScenario();
  scenario.base.lighting = TinyLighting();
  for (const PaintBrush& brush : TinyBrushes())
    scenario.base.brush[scenario.base.brush_count++] = brush;
  uint32_t layers = 0;
  for (LayerParams* layer : LayersOf(scenario)) {
    layer->painted = layers % 4 == 0;
    layer->lit = layers++ % 2 == 0;
  }
  return scenario;
}

// Besides, every other layer of ribbons as lines, long hair, and a lit layer of shells: layers of
// every output, and chains of every number of points.
inline Scenario EveryOutputScenario() {
  Scenario scenario = LitScenario();
  uint32_t ribbons = 0;
  for (LayerParams* layer : LayersOf(scenario))
    if (layer->output == Output::kRibbons && ribbons++ % 2 == 0) layer->output = Output::kLines;
  AddLongHair(scenario);
  AddShells(scenario);
  scenario.grooms[0].layers.back().params.lit = true;
  return scenario;
}

// `tiny` on its own course until `frame`, then at rest: no teleport, no wind, nothing moves.
inline Scenario RestingScenario(uint32_t frame) {
  Scenario scenario = TinyScenario();
  scenario.actors[0].teleport_frame = -1;
  scenario.rest_from_frame = frame;
  return scenario;
}

// A larger character, in its rest pose, with a layer on its vertices that takes several patches;
// nothing else acts on it.
inline Scenario PatchedScenario() {
  static const Scenario kBaked = [] {
    Scenario scenario = RestingScenario(0);
    scenario.weather_course = {};
    scenario.spheres.clear();
    scenario.base.use_ground = false;
    Actor& actor = scenario.actors[0];
    actor.clip = -1;
    scenario.characters[actor.character] = MakeBuiltinCharacter({});
    const FurSetup setup = ReadFurSetup(
        "[[layer]]\n"
        "name = 'patched'\n"
        "solver = 'modal'\n"
        "chain = 'vertex'\n"
        "density = 60_000\n"
        "max_strands = 4000\n"
        "length = 0.05\n",
        "patched", ".");
    scenario.grooms[actor.groom] = BakeForActor(scenario, setup);
    return scenario;
  }();
  return kBaked;
}

inline SceneOptions OptionsFor(Isa isa) { return {.isa = isa}; }

inline void ExpectNoFaults(const auto& local_store_executor) {
  for (const auto& f : local_store_executor.faults())
    ADD_FAILURE() << f.stage << ", item " << f.item << ": " << f.what;
}

// The digest of every frame.
inline std::vector<uint64_t> RunDigests(Scenario& scenario, const SceneOptions& options,
                                        Executor& executor, uint32_t frames,
                                        const SkipSettings& skip = {},
                                        const LodSettings& lod = {}) {
  RunningScenario running(scenario, options);
  std::vector<uint64_t> digests;
  for (uint32_t f = 0; f < frames; ++f) {
    running.Begin(f, skip, lod);
    executor.Run(running.scene().CurrentFrame());
    digests.push_back(running.scene().DigestFrame());
  }
  return digests;
}

inline std::vector<uint64_t> RunDigests(Scenario& scenario, const SceneOptions& options,
                                        uint32_t frames, const SkipSettings& skip = {},
                                        const LodSettings& lod = {}) {
  SerialExecutor serial;
  return RunDigests(scenario, options, serial, frames, skip, lod);
}

// Says in which frame two courses part.
inline void ExpectSameFrames(const std::vector<uint64_t>& expected,
                             const std::vector<uint64_t>& found, const std::string& what) {
  ASSERT_EQ(expected.size(), found.size()) << what;
  for (size_t f = 0; f < expected.size(); ++f)
    ASSERT_EQ(expected[f], found[f]) << what << ": frame " << f;
}

// Chunks of the scene whose flags have all of `set` and none of `clear`.
inline uint32_t CountChunks(const FurScene& scene, uint32_t set, uint32_t clear = 0) {
  uint32_t count = 0;
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    const uint32_t flags = scene.memory().Of<&Streams::chunk_state>(c)->flags;
    count += (flags & set) == set && (flags & clear) == 0;
  }
  return count;
}
// The same of patches.
inline uint32_t CountPatches(const FurScene& scene, uint32_t set, uint32_t clear = 0) {
  uint32_t count = 0;
  for (uint32_t p = 0; p < scene.shape().patch_count; ++p) {
    const uint32_t flags = scene.memory().Of<&Streams::patch_state>(p)->flags;
    count += (flags & set) == set && (flags & clear) == 0;
  }
  return count;
}
inline uint32_t CountAsleep(const FurScene& scene) {
  return CountChunks(scene, kChunkVisible, kChunkSimulate);
}

// No living point is farther than 10 m from the origin.
inline void ExpectPointsNear(const FurScene& scene) {
  const auto expect = [&](Stream stream, uint32_t points) {
    for (uint32_t i = 0; i < scene.shape().ItemCount(DescribeStream(stream).domain); ++i) {
      const float* p = scene.memory().As<float>(stream, i);
      for (uint32_t row = 0; p && row < 3 * (points - 1); ++row)
        for (uint32_t lane = 0; lane < scene.LiveLanes(stream, i); ++lane)
          ASSERT_LT(std::abs(p[row * kStrandsPerChunk + lane]), 10.0f)
              << DescribeStream(stream).name << " of item " << i << ", lane " << lane;
    }
  };
  expect(StreamOf<&Streams::vertex_points>, 4);
  expect(StreamOf<&Streams::strand_points4>, 4);
  expect(StreamOf<&Streams::strand_points5>, 5);
  expect(StreamOf<&Streams::strand_points9>, 9);
}

}  // namespace pelt::testing
