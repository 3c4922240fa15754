// Interpolate, and the displacements of the chains that its strands follow.
#include "core/kernels/interpolate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/kernels/chain_loads.hpp"
#include "tests/kernels/chain_scene.hpp"

namespace pelt::test {
namespace {

using V = Vec<IsaSse4>;

constexpr uint32_t kVertices = kVerticesPerChunk * 3 / 4;

struct Scene {
  ChainScene<4> chains, strands;  // lanes are vertices; lanes are strands
  ChainParentBlock parents;
  LoadBlock loads;
};

// Chains away from their groom by up to `swing` segments.
std::unique_ptr<Scene> MakeScene(uint32_t seed, float swing) {
  auto s = std::make_unique<Scene>();
  MakeOrderly(s->chains, seed);
  std::mt19937 random(seed);
  MakeOrderly(s->strands, seed + 1000, 1 + random() % kStrandsPerChunk);
  s->chains.layer.clump = 0.7f;
  s->chains.state.live_vertices = s->chains.state.live_chains = kVertices;
  s->chains.state.whole_chains = kVertices;
  StrandBlock& strands = s->strands.strands;
  strands.vertex_count = kVertices;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const auto groom = GroomOf(s->chains.rest, s->chains.roots, lane);
    for (uint32_t i = 0; i < 3; ++i) {
      const float size = swing * s->chains.rest.segment_length[lane] * float(i + 1);
      s->chains.position.position[i][0][lane] = float(groom[i].x) + Uniform(random, -size, size);
      s->chains.position.position[i][1][lane] = float(groom[i].y) + Uniform(random, -size, size);
      s->chains.position.position[i][2][lane] = float(groom[i].z) + Uniform(random, -size, size);
    }
    float a = Uniform(random, 0.0f, 1.0f), b = Uniform(random, 0.0f, 1.0f);
    if (a + b > 1.0f) a = 1.0f - a, b = 1.0f - b;
    const float bary[3] = {a, b, 1.0f - a - b};
    for (int k = 0; k < 3; ++k) {
      strands.bary[k][lane] = bary[k];
      strands.vertex[k][lane] = uint8_t(random() % kVertices);
    }
  }
  return s;
}

template <class W>
void RunDisplacements(Scene& s) {
  std::memset(static_cast<void*>(&s.loads), 0xff, sizeof s.loads);
  RunKernel<ChainDisplacements<W>>({{&s.chains.layer, nullptr, 1},
                                    {&s.chains.state, nullptr, 1},
                                    {&s.chains.rest, nullptr, 1},
                                    {&s.chains.roots, nullptr, 1},
                                    {&s.chains.position, nullptr, 1},
                                    {&s.parents, nullptr, 1},
                                    {&s.loads, nullptr, 1}});
}

template <class W>
void RunInterpolate(Scene& s, const Binding& loads, PointBlock<4>& out) {
  std::memset(static_cast<void*>(&out), 0xff, sizeof out);
  RunKernel<Interpolate<W>>({{&s.chains.layer, nullptr, 1},
                             {&s.strands.state, nullptr, 1},
                             {&s.strands.strands, nullptr, 1},
                             {&s.strands.rest, nullptr, 1},
                             {&s.strands.roots, nullptr, 1},
                             loads,
                             {&out, nullptr, 1}});
}

// Of strands whose halo is the patch.
template <class W>
void RunKernels(Scene& s, PointBlock<4>& out) {
  RunDisplacements<W>(s);
  RunInterpolate<W>(s, {&s.loads, nullptr, 1}, out);
}

std::vector<D3> Reference(const Scene& s, uint32_t lane, const PointBlock<4>* controls) {
  const StrandBlock& strands = s.strands.strands;
  const D3 root = At(s.strands.roots.position, lane);
  std::vector<D3> p = GroomOf(s.strands.rest, s.strands.roots, lane);
  const double length = s.strands.rest.segment_length[lane];
  for (int k = 0; k < 3; ++k) {
    const uint32_t vertex = strands.vertex[k][lane];
    const auto groom = GroomOf(s.chains.rest, s.chains.roots, vertex);
    const double scale = length / s.chains.rest.segment_length[vertex];
    for (int i = 0; i < 3; ++i)
      p[i] = p[i] + (At(s.chains.position.position[i], vertex) - groom[i]) *
                        (strands.bary[k][lane] * scale);
  }
  if (controls)
    for (int i = 0; i < 3; ++i)
      p[i] = p[i] + (At(controls->position[i], strands.control[lane]) - p[i]) *
                        (s.chains.layer.clump * (i + 1) / 3.0);
  std::vector<D3> out;
  for (int i = 0; i < 3; ++i) {
    const D3 d = p[i] - (i == 0 ? root : p[i - 1]);
    out.push_back((i == 0 ? root : out[i - 1]) + d * (length / Length(d)));
  }
  return out;
}

TEST(Interpolate, MatchesDoubleReference) {
  auto out = std::make_unique<PointBlock<4>>();
  for (uint32_t seed = 1; seed <= 40; ++seed) {
    auto s = MakeScene(seed, 0.4f);
    const bool clump = seed % 2;
    if (clump) s->chains.layer.flags |= kLayerClump;
    RunKernels<V>(*s, *out);
    for (uint32_t lane = 0; lane < s->strands.state.live_strands; ++lane) {
      const auto reference = Reference(*s, lane, clump && lane >= 16 ? out.get() : nullptr);
      for (int i = 0; i < 3; ++i)
        EXPECT_LT(Length(At(out->position[i], lane) - reference[i]),
                  2e-4 * s->strands.rest.segment_length[lane] + 5e-7)
            << "seed " << seed << " lane " << lane << " point " << i + 1;
    }
  }
}

// How far each point is from the groom, per metre of chain; of the vertices that live, in groups.
TEST(ChainDisplacements, AreTheDoubleReference) {
  for (const uint32_t live : {1u, 17u, kVertices}) {
    auto s = MakeScene(live, 0.4f);
    s->chains.state.live_vertices = s->chains.state.live_chains = live;
    s->chains.state.whole_chains = live;
    RunDisplacements<V>(*s);
    for (uint32_t vertex = 0; vertex < live; ++vertex) {
      const auto groom = GroomOf(s->chains.rest, s->chains.roots, vertex);
      const double length = s->chains.rest.segment_length[vertex];
      for (int i = 0; i < 3; ++i) {
        const float(&part)[4] = s->loads.vertex[vertex].part[i];
        const D3 off = (At(s->chains.position.position[i], vertex) - groom[i]) * (1.0 / length);
        EXPECT_LT(Length(D3{part[0], part[1], part[2]} - off), 1e-4 + 5e-7 / length)
            << "vertex " << vertex << " point " << i + 1;
        EXPECT_EQ(part[3], 0.0f);
      }
    }
    for (uint32_t vertex = RoundUpToLaneGroups(live); vertex < kVerticesPerChunk; ++vertex)
      EXPECT_TRUE(std::isnan(s->loads.vertex[vertex].part[0][0])) << "wrote a dead lane";
  }
}

TEST(Interpolate, ChainsOnTheirGroomLeaveStrandsOnTheirs) {
  auto s = MakeScene(5, 0.0f);
  auto out = std::make_unique<PointBlock<4>>();
  RunKernels<V>(*s, *out);
  for (uint32_t lane = 0; lane < s->strands.state.live_strands; ++lane) {
    const auto groom = GroomOf(s->strands.rest, s->strands.roots, lane);
    for (int i = 0; i < 3; ++i)
      EXPECT_LT(Length(At(out->position[i], lane) - groom[i]), 2e-6) << lane;
  }
}

TEST(Interpolate, SegmentsKeepTheirLength) {
  auto out = std::make_unique<PointBlock<4>>();
  for (uint32_t seed = 1; seed <= 10; ++seed) {
    auto s = MakeScene(seed, 1.5f);
    if (seed % 2) s->chains.layer.flags |= kLayerClump;
    RunKernels<V>(*s, *out);
    s->strands.position = *out;
    EXPECT_LT(StretchOf(s->strands).first, 1e-4);
  }
}

TEST(Interpolate, DegenerateStrandsStayFinite) {
  auto s = MakeScene(9, 0.0f);
  std::memset(static_cast<void*>(&s->strands.rest), 0, sizeof s->strands.rest);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    s->chains.rest.segment_length[lane] = 0.0f;
  auto out = std::make_unique<PointBlock<4>>();
  RunKernels<V>(*s, *out);
  for (uint32_t lane = 0; lane < s->strands.state.live_strands; ++lane)
    for (int i = 0; i < 3; ++i)
      EXPECT_TRUE(std::isfinite(Length(At(out->position[i], lane)))) << lane;
}

// The vertices of a halo lie anywhere in the layer's patches.
TEST(Interpolate, FollowsVerticesWhereverTheyLie) {
  constexpr uint32_t kPatches = 3, kPlaces = kPatches * kVerticesPerChunk;
  auto wanted = std::make_unique<PointBlock<4>>(), got = std::make_unique<PointBlock<4>>();
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    auto s = MakeScene(seed, 0.5f);
    RunKernels<V>(*s, *wanted);
    Blocks<LoadBlock> patches(kPatches);
    Blocks<HaloBlock> halo(1);
    for (uint32_t i = 0; i < kVertices; ++i) {
      const uint32_t place = (i * 101 + seed) % kPlaces;  // each another
      halo[0].vertex[i] = place;
      patches[place / kVerticesPerChunk].vertex[place % kVerticesPerChunk] = s->loads.vertex[i];
    }
    ForEveryVector([&]<class W>(const char* name) {
      RunInterpolate<W>(*s, patches.BindList(halo[0].vertex), *got);
      EXPECT_EQ(std::memcmp(wanted.get(), got.get(), sizeof *got), 0) << name << " " << seed;
    });
  }
}

TEST(Interpolate, SameBitsOnEveryVector) {
  auto loads = std::make_unique<LoadBlock>();
  auto wanted = std::make_unique<PointBlock<4>>(), got = std::make_unique<PointBlock<4>>();
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    auto s = MakeScene(seed, 0.5f);
    if (seed % 2) s->chains.layer.flags |= kLayerClump;
    RunKernels<V>(*s, *wanted);
    *loads = s->loads;
    ForEveryVector([&]<class W>(const char* name) {
      RunKernels<W>(*s, *got);
      EXPECT_EQ(std::memcmp(loads.get(), &s->loads, sizeof *loads), 0) << name << " " << seed;
      EXPECT_EQ(std::memcmp(wanted.get(), got.get(), sizeof *got), 0) << name << " " << seed;
    });
  }
}

}  // namespace
}  // namespace pelt::test
