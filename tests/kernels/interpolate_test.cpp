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
    FollowVertex(strands, lane, kVertices, random);
  }
  return s;
}

template <class W>
void RunDisplacements(Scene& s) {
  Poison(s.loads);
  RunOnBlocks<ChainDisplacements<W>>(nullptr, s.chains.layer, s.chains.state, s.chains.rest,
                                     s.chains.roots, s.chains.position, s.parents, s.loads);
}

template <class W>
void RunInterpolate(Scene& s, const auto& loads, PointBlock<4>& out) {
  Poison(out);
  RunOnBlocks<Interpolate<W>>(nullptr, s.chains.layer, s.strands.state, s.strands.strands,
                              s.strands.rest, s.strands.roots, loads, out);
}

// Of strands whose halo is the patch.
template <class W>
void RunKernels(Scene& s, PointBlock<4>& out) {
  RunDisplacements<W>(s);
  RunInterpolate<W>(s, s.loads, out);
}

std::vector<Double3> Reference(const Scene& s, uint32_t lane, const PointBlock<4>* controls) {
  const StrandBlock& strands = s.strands.strands;
  const Double3 root = At(s.strands.roots.position, lane);
  std::vector<Double3> p = GroomOf(s.strands.rest, s.strands.roots, lane);
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
  std::vector<Double3> out;
  for (int i = 0; i < 3; ++i) {
    const Double3 d = p[i] - (i == 0 ? root : p[i - 1]);
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
        const Double3 off =
            (At(s->chains.position.position[i], vertex) - groom[i]) * (1.0 / length);
        EXPECT_LT(Length(Of(part) - off), 1e-4 + 5e-7 / length)
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
  ExpectOnGroom(s->strands, *out);
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
  auto out = std::make_unique<PointBlock<4>>();
  MakeDegenerate(s->chains, s->strands);
  RunKernels<V>(*s, *out);
  ExpectFinite(s->strands, *out);
}

// The vertices of a halo lie anywhere in the layer's patches.
TEST(Interpolate, FollowsVerticesWhereverTheyLie) {
  auto wanted = std::make_unique<PointBlock<4>>(), got = std::make_unique<PointBlock<4>>();
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    auto s = MakeScene(seed, 0.5f);
    RunKernels<V>(*s, *wanted);
    Scattered<LoadBlock> patches(s->loads, kVertices, seed);
    ForEveryVector([&]<class W>(const char* name) {
      RunInterpolate<W>(*s, patches.Bind(), *got);
      EXPECT_EQ(std::memcmp(wanted.get(), got.get(), sizeof *got), 0) << name << " " << seed;
    });
  }
}

TEST(Interpolate, SameBitsOnEveryVector) {
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    auto s = MakeScene(seed, 0.5f);
    if (seed % 2) s->chains.layer.flags |= kLayerClump;
    ExpectSamePointsEverywhere(*s, seed, [&]<class W>(auto& out) { RunKernels<W>(*s, out); });
  }
}

}  // namespace
}  // namespace pelt::test
