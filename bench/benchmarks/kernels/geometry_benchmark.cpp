// Speed of the first half of the frame on one core: pose, palette, bounds, skin, anchors, roots,
// wind, the vertices of shells; and paint, by brushes that hold every strand.
//
// Prints the time per lane (joint, vertex or strand) as the counter `each`, with the digest of what
// was computed beside it: instruction sets must agree on the digest, regardless of their speed. 64
// chunks go round, about 2 MB, so blocks come from the second-level cache as they do in a frame.
//
// Skin has two costs: `realistic` lets a group of 16 vertices share 5 joints (what patches of the
// real characters do, with 4 influences a vertex), `worst` fills all weight rows of the chunk (8
// joints a group). `skin_positions_normals` leaves out tangents and motion: what other skinning
// libraries are compared with. Build with the flags of the widest instruction set to be measured.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/kernels/bound_layer.hpp"
#include "core/kernels/joint_palette.hpp"
#include "core/kernels/paint_strands.hpp"
#include "core/kernels/roots.hpp"
#include "core/kernels/sample_pose.hpp"
#include "core/kernels/select_fins.hpp"
#include "core/kernels/shell_force.hpp"
#include "core/kernels/skin.hpp"
#include "core/kernels/wind.hpp"

namespace pelt {
namespace {

constexpr uint32_t kChunks = 64;
constexpr uint32_t kJoints = 65;

// A 64-bit congruential generator: the same numbers everywhere.
struct Random {
  uint64_t state;
  uint32_t Next() {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return uint32_t(state >> 33);
  }
  float Between(float low, float high) {
    return low + (high - low) * (float(Next() >> 7) / 16777216.0f);
  }
};

uint64_t DigestOf(const void* bytes, size_t count, uint64_t seed = 1469598103934665603ull) {
  const auto* p = static_cast<const unsigned char*>(bytes);
  for (size_t i = 0; i < count; ++i) seed = (seed ^ p[i]) * 1099511628211ull;
  return seed;
}

struct Scene {
  PoseBlock pose{};
  SkeletonBlock skeleton{};
  LocalPoseBlock local{};
  PaletteBlock palette{};
  LayerBlock layer{};
  LayerJointBlock layer_joints{};
  BoundsBlock bounds{};
  MeshBlock mesh[kChunks]{};
  StrandBlock strands[kChunks]{};
  ChunkStateBlock state[kChunks]{};
  SkinnedBlock skinned[kChunks]{};
  RootBlock anchors[kChunks]{};
  RootBlock roots[kChunks]{};
  WindBlock wind[kChunks]{};
  ShellLayerBlock shell_layer{};
  RestBlock<4> vertex_rest[kChunks]{};
  ShellSkinBlock shell_skin[kChunks]{};
  ShellVertexBlock shell_vertices[kChunks]{};
  FinEdgeBlock fin_edges[kChunks]{};
  FinBlock fins[kChunks]{};
  PaintBlock paint[kChunks]{};
};

void FillPose(Scene& scene, Random& random) {
  scene.pose.joint_count = kJoints;
  for (uint32_t j = 0; j < kJointsPerCharacter; ++j) {
    for (int k = 0; k < 4; ++k) {
      for (int c = 0; c < 3; ++c) {
        scene.pose.translation_key[k][c][j] = random.Between(-0.1f, 0.1f);
        scene.pose.scale_key[k][c][j] = random.Between(0.9f, 1.1f);
      }
      for (int c = 0; c < 4; ++c)
        scene.pose.rotation_key[k][c][j] = (c == 3 ? 1.0f : 0.0f) + random.Between(-0.2f, 0.2f);
    }
    scene.pose.translation_weight[0][j] = scene.pose.rotation_weight[0][j] =
        scene.pose.scale_weight[0][j] = 0.25f;
    scene.pose.translation_weight[3][j] = scene.pose.rotation_weight[3][j] =
        scene.pose.scale_weight[3][j] = 0.75f;
    scene.skeleton.parent[j] = j == 0 ? -1 : int32_t(random.Next() % j);
    for (int i = 0; i < 12; ++i)
      scene.skeleton.inverse_bind[j][i] = (i % 5 == 0 ? 1.0f : 0.0f) + random.Between(-0.1f, 0.1f);
  }
  for (int i = 0; i < 12; ++i) scene.pose.root[i] = i % 5 == 0 ? 1.0f : 0.0f;
}

void FillMesh(MeshBlock& mesh, uint32_t rows_a_group, Random& random) {
  for (uint32_t v = 0; v < kVerticesPerChunk; ++v)
    for (int c = 0; c < 3; ++c) {
      mesh.position[c][v] = random.Between(-0.5f, 0.5f);
      mesh.normal[c][v] = random.Between(-1.0f, 1.0f);
      mesh.tangent[c][v] = random.Between(-1.0f, 1.0f);
    }
  mesh.vertex_count = kVerticesPerChunk;
  uint32_t row = 0;
  for (uint32_t g = 0; g < kVertexGroups; ++g) {
    mesh.group_first_row[g] = uint16_t(row);
    const uint32_t first_joint = random.Next() % (kJoints - rows_a_group);
    for (uint32_t r = 0; r < rows_a_group; ++r, ++row) {
      mesh.row_joint[row] = uint8_t(first_joint + r);
      // Four influences a vertex: four neighbouring rows of the group's.
      for (uint32_t lane = 0; lane < kLaneGroup; ++lane)
        mesh.weight[row][lane] = (r + lane) % rows_a_group < 4 ? 0.25f : 0.0f;
    }
  }
  mesh.group_first_row[kVertexGroups] = uint16_t(row);
}

void FillStrands(StrandBlock& strands, Random& random) {
  for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
    const float a = random.Between(0.0f, 0.5f), b = random.Between(0.0f, 0.5f);
    strands.bary[0][s] = a;
    strands.bary[1][s] = b;
    strands.bary[2][s] = 1.0f - a - b;
    for (int k = 0; k < 3; ++k) strands.vertex[k][s] = uint8_t(random.Next() % kVerticesPerChunk);
  }
}

// Of kernel K, each bound to one block.
template <class K>
typename K::Ports PortsOf(auto*... blocks) {
  const Binding bindings[] = {{blocks, nullptr, 1}...};
  return KernelTraits<K>::Bind(bindings);
}

std::unique_ptr<Scene> MakeScene(uint32_t rows_a_group) {
  auto scene = std::make_unique<Scene>();
  Random random{2024};
  FillPose(*scene, random);
  for (uint32_t c = 0; c < kChunks; ++c) {
    FillMesh(scene->mesh[c], rows_a_group, random);
    FillStrands(scene->strands[c], random);
    scene->state[c].live_strands = scene->state[c].first_new_strand = kStrandsPerChunk;
    scene->state[c].live_vertices = scene->state[c].first_new_vertex = kVerticesPerChunk;
    scene->state[c].live_chains = kVerticesPerChunk;
  }
  scene->layer.wind_response = 1.5f;
  scene->layer.length_max = 0.05f;
  scene->layer_joints.count = 12;
  for (uint32_t j = 0; j < 12; ++j) {
    scene->layer_joints.joint[j] = 3 * j;
    for (int c = 0; c < 3; ++c) {
      scene->layer_joints.low[c][j] = random.Between(-0.5f, 0.0f);
      scene->layer_joints.high[c][j] = random.Between(0.0f, 0.5f);
    }
  }
  // Every stage once, so that each has an earlier stage's values to work on.
  using V = ArrayVec<4>;
  SamplePose<V>::Run(PortsOf<SamplePose<V>>(&scene->pose, &scene->local));
  JointPalette<V>::Run(
      PortsOf<JointPalette<V>>(&scene->pose, &scene->skeleton, &scene->local, &scene->palette));
  for (uint32_t c = 0; c < kChunks; ++c) {
    Skin<V>::Run(
        PortsOf<Skin<V>>(&scene->palette, &scene->mesh[c], &scene->state[c], &scene->skinned[c]));
    Roots<V>::Run(PortsOf<Roots<V>>(&scene->state[c], &scene->strands[c], &scene->skinned[c],
                                    &scene->roots[c]));
  }
  return scene;
}

void Report(benchmark::State& state, double lanes_an_iteration, uint64_t digest) {
  state.counters["each"] =
      benchmark::Counter(lanes_an_iteration * double(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  char label[32];
  std::snprintf(label, sizeof label, "digest %016llx", static_cast<unsigned long long>(digest));
  state.SetLabel(label);
}

template <class V>
void BenchSamplePose(benchmark::State& state) {
  const auto scene = MakeScene(5);
  const auto ports = PortsOf<SamplePose<V>>(&scene->pose, &scene->local);
  for (auto _ : state) {
    SamplePose<V>::Run(ports);
    benchmark::ClobberMemory();
  }
  Report(state, kJoints, DigestOf(&scene->local, sizeof scene->local));
}

template <class V>
void BenchJointPalette(benchmark::State& state) {
  const auto scene = MakeScene(5);
  const auto ports =
      PortsOf<JointPalette<V>>(&scene->pose, &scene->skeleton, &scene->local, &scene->palette);
  for (auto _ : state) {
    JointPalette<V>::Run(ports);
    benchmark::ClobberMemory();
  }
  Report(state, kJoints, DigestOf(scene->palette.matrix, sizeof scene->palette.matrix));
}

template <class V>
void BenchBoundLayer(benchmark::State& state) {
  const auto scene = MakeScene(5);
  const auto ports =
      PortsOf<BoundLayer<V>>(&scene->palette, &scene->layer, &scene->layer_joints, &scene->bounds);
  for (auto _ : state) {
    BoundLayer<V>::Run(ports);
    benchmark::ClobberMemory();
  }
  Report(state, scene->layer_joints.count, DigestOf(&scene->bounds, sizeof scene->bounds));
}

template <class V>
void BenchSkin(benchmark::State& state) {
  const auto scene = MakeScene(uint32_t(state.range(0)));
  for (auto _ : state) {
    for (uint32_t c = 0; c < kChunks; ++c)
      Skin<V>::Run(
          PortsOf<Skin<V>>(&scene->palette, &scene->mesh[c], &scene->state[c], &scene->skinned[c]));
    benchmark::ClobberMemory();
  }
  Report(state, double(kChunks) * kVerticesPerChunk,
         DigestOf(scene->skinned, sizeof scene->skinned));
}

// Not always-inline: one call a chunk, as the frame makes.
template <class V>
__attribute__((noinline)) void SkinPositionsAndNormals(const PaletteBlock& palette,
                                                       const MeshBlock& mesh,
                                                       SkinnedBlock& skinned) {
  skin_detail::SkinChunk<V, false>(palette, mesh, kVerticesPerChunk, kVerticesPerChunk, skinned);
}

template <class V>
void BenchSkinPositionsNormals(benchmark::State& state) {
  const auto scene = MakeScene(uint32_t(state.range(0)));
  for (auto _ : state) {
    for (uint32_t c = 0; c < kChunks; ++c)
      SkinPositionsAndNormals<V>(scene->palette, scene->mesh[c], scene->skinned[c]);
    benchmark::ClobberMemory();
  }
  Report(state, double(kChunks) * kVerticesPerChunk,
         DigestOf(scene->skinned, sizeof scene->skinned));
}

template <class V>
void BenchAnchors(benchmark::State& state) {
  const auto scene = MakeScene(5);
  for (auto _ : state) {
    for (uint32_t c = 0; c < kChunks; ++c)
      Anchors<V>::Run(
          PortsOf<Anchors<V>>(&scene->state[c], &scene->skinned[c], &scene->anchors[c]));
    benchmark::ClobberMemory();
  }
  Report(state, double(kChunks) * kVerticesPerChunk,
         DigestOf(scene->anchors, sizeof scene->anchors));
}

template <class V>
void BenchRoots(benchmark::State& state) {
  const auto scene = MakeScene(5);
  for (auto _ : state) {
    for (uint32_t c = 0; c < kChunks; ++c)
      Roots<V>::Run(PortsOf<Roots<V>>(&scene->state[c], &scene->strands[c], &scene->skinned[c],
                                      &scene->roots[c]));
    benchmark::ClobberMemory();
  }
  Report(state, double(kChunks) * kStrandsPerChunk, DigestOf(scene->roots, sizeof scene->roots));
}

template <class V>
void BenchWind(benchmark::State& state) {
  const auto scene = MakeScene(5);
  const WindParams params = {{3.0f, 0.2f, -1.0f}, 1.5f, 2.0f, {17.3f, 200.1f, 3.7f}};
  for (auto _ : state) {
    for (uint32_t c = 0; c < kChunks; ++c)
      Wind<V, false>::Run(params, PortsOf<Wind<V, false>>(&scene->state[c], &scene->layer,
                                                          &scene->roots[c], &scene->wind[c]));
    benchmark::ClobberMemory();
  }
  Report(state, double(kChunks) * kStrandsPerChunk, DigestOf(scene->wind, sizeof scene->wind));
}

void FillShells(Scene& scene) {
  Random random{7};
  using V = ArrayVec<4>;
  scene.layer.flags = kLayerSimulate | kLayerWind;
  scene.layer.gravity[1] = -9.81f;
  scene.layer.link.stiffness = 0.5f;
  scene.layer.darken = 1.0f;
  scene.shell_layer.cone = 0.2f;
  for (uint32_t c = 0; c < kChunks; ++c) {
    Anchors<V>::Run(PortsOf<Anchors<V>>(&scene.state[c], &scene.skinned[c], &scene.anchors[c]));
    for (uint32_t v = 0; v < kVerticesPerChunk; ++v) {
      for (int axis = 0; axis < 3; ++axis) {
        scene.vertex_rest[c].offset[2][axis][v] = random.Between(-0.02f, 0.02f);
        scene.wind[c].acceleration[axis][v] = random.Between(-5.0f, 5.0f);
      }
      scene.vertex_rest[c].segment_length[v] = 0.01f;
      scene.vertex_rest[c].strength[v] = 1.0f;
      scene.shell_skin[c].base_colour[v] = random.Next();
      scene.shell_skin[c].tip_colour[v] = random.Next();
    }
  }
}

template <class V>
void BenchShellForce(benchmark::State& state) {
  const auto scene = MakeScene(5);
  FillShells(*scene);
  for (auto _ : state) {
    for (uint32_t c = 0; c < kChunks; ++c)
      ShellForce<V>::Run(PortsOf<ShellForce<V>>(
          &scene->layer, &scene->shell_layer, &scene->vertex_rest[c], &scene->shell_skin[c],
          &scene->anchors[c], &scene->wind[c], &scene->state[c], &scene->shell_vertices[c]));
    benchmark::ClobberMemory();
  }
  Report(state, double(kChunks) * kVerticesPerChunk,
         DigestOf(scene->shell_vertices, sizeof scene->shell_vertices));
}

// Three edges for two triangles, as on a closed skin.
template <class V>
void BenchSelectFins(benchmark::State& state) {
  const auto scene = MakeScene(5);
  FillShells(*scene);
  const SelectFinsParams params{{0.3f, 0.4f, 2.0f}};
  for (uint32_t c = 0; c < kChunks; ++c) {
    using R = ArrayVec<4>;
    ShellForce<R>::Run(PortsOf<ShellForce<R>>(
        &scene->layer, &scene->shell_layer, &scene->vertex_rest[c], &scene->shell_skin[c],
        &scene->anchors[c], &scene->wind[c], &scene->state[c], &scene->shell_vertices[c]));
    for (uint32_t t = 0; t < kStrandsPerChunk; ++t)
      scene->fin_edges[c].owned[t] = t % 2 ? 0xffff00u : 0x0000ffu;
  }
  for (auto _ : state) {
    for (uint32_t c = 0; c < kChunks; ++c)
      SelectFins<V>::Run(
          params, PortsOf<SelectFins<V>>(&scene->state[c], &scene->strands[c], &scene->fin_edges[c],
                                         &scene->shell_vertices[c], &scene->fins[c]));
    benchmark::ClobberMemory();
  }
  Report(state, double(kChunks) * kStrandsPerChunk, DigestOf(scene->fins, sizeof scene->fins));
}

template <class V>
void BenchPaint(benchmark::State& state) {
  const auto scene = MakeScene(5);
  std::vector<PaintBrush> brushes;
  for (uint32_t b = 0; b < uint32_t(state.range(0)); ++b)
    brushes.push_back({{0, 0, 0}, 5.0f, 0.1f, b % kPaintChannels, b % 2 ? -0.3f : 0.4f});
  const PaintStrandsParams params = MakePaintStrandsParams(brushes);
  for (auto _ : state) {
    for (uint32_t c = 0; c < kChunks; ++c)
      PaintStrands<V>::Run(params, PortsOf<PaintStrands<V>>(&scene->bounds, &scene->roots[c],
                                                            &scene->state[c], &scene->paint[c]));
    benchmark::ClobberMemory();
  }
  Report(state, double(kChunks) * kStrandsPerChunk, DigestOf(scene->paint, sizeof scene->paint));
}

template <class V>
void RegisterAll(const std::string& isa) {
  const auto add = [&](const char* name, void (*run)(benchmark::State&)) {
    return benchmark::RegisterBenchmark((std::string(name) + "/" + isa).c_str(), run);
  };
  add("sample_pose", BenchSamplePose<V>);
  add("joint_palette", BenchJointPalette<V>);
  add("bound_layer", BenchBoundLayer<V>);
  add("skin", BenchSkin<V>)->ArgName("joints_a_group")->Arg(4)->Arg(5)->Arg(6)->Arg(8);
  add("skin_positions_normals", BenchSkinPositionsNormals<V>)
      ->ArgName("joints_a_group")
      ->Arg(4)
      ->Arg(5)
      ->Arg(6)
      ->Arg(8);
  add("anchors", BenchAnchors<V>);
  add("roots", BenchRoots<V>);
  add("wind", BenchWind<V>);
  add("shell_force", BenchShellForce<V>);
  add("select_fins", BenchSelectFins<V>);
  add("paint_strands", BenchPaint<V>)->ArgName("brushes")->Arg(1)->Arg(4)->Arg(16);
}

const bool kRegistered = [] {
  RegisterAll<ArrayVec<4>>("reference");
#if defined(__SSE4_1__)
  RegisterAll<Vec<IsaSse4>>("sse4");
#endif
#if defined(__AVX2__)
  RegisterAll<Vec<IsaAvx2>>("avx2");
#endif
#if defined(__AVX512F__)
  RegisterAll<Vec<IsaAvx512>>("avx512");
#endif
  return true;
}();

}  // namespace
}  // namespace pelt
