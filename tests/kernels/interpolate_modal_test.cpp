#include "core/kernels/interpolate_modal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/kernels/chain_loads.hpp"
#include "core/modal/modal_table.hpp"
#include "tests/kernels/chain_scene.hpp"

namespace pelt::test {
namespace {

using V = Vec<IsaSse4>;

constexpr uint32_t kVertices = kVerticesPerChunk * 3 / 4;
constexpr int N = 3;

struct Scene {
  ChainScene<4> chains, strands;  // lanes are vertices; lanes are strands
  ModalTableBlock table;
  ModalStateBlock<3> modal;
  ChainParentBlock parents;
  LoadBlock loads;
};

// Vectors at a chain's nodes.
struct Links {
  Double3 v[N];
};

Links RestOf(const ModalTableBlock& t, const ChainScene<4>& s, uint32_t lane) {
  const auto groom = GroomOf(s.rest, s.roots, lane);
  Links rest;
  for (int i = 0; i < N; ++i) {
    Double3 sum{};
    for (int j = 0; j < N; ++j) {
      const Double3 above = j == 0 ? At(s.roots.position, lane) : groom[size_t(j - 1)];
      sum = sum + (groom[size_t(j)] - above) * double(t.rest[i][j]);
    }
    rest.v[i] = Unit(sum);
  }
  return rest;
}

void SetChain(Scene& s, uint32_t lane, const Links& d, const double (&lambda)[N]) {
  for (int i = 0; i < N; ++i) {
    SetAt(s.modal.direction[i], lane, d.v[i]);
    s.modal.multiplier[i][lane] = float(lambda[i]);
  }
}

void SetFrequency(Scene& s, double hz) {
  constexpr double kFrame_s = 1.0 / 60.0;
  FillModalTable(MakeModalLayer(StrandMaterial(N + 1, hz, 0.05, 1.0)), ModalQuality::kFine,
                 {{kFrame_s, kFrame_s, kFrame_s}}, &s.table);
}

// Chains whose links lie up to `swing` off the groom, with multipliers up to `tension`.
std::unique_ptr<Scene> MakeScene(uint32_t seed, double swing, double tension) {
  auto s = std::make_unique<Scene>();
  Poison(s->modal);
  MakeOrderly(s->chains, seed);
  std::mt19937 random(seed);
  MakeOrderly(s->strands, seed + 1000, 1 + random() % kStrandsPerChunk);
  s->chains.layer.flags |= kLayerModal;
  s->chains.layer.surface_hardness = 0.0f;
  s->chains.layer.clump = 0.7f;
  s->chains.state = s->strands.state;
  s->chains.state.live_vertices = s->chains.state.live_chains = kVertices;
  s->chains.state.whole_chains = kVertices;
  SetFrequency(*s, double(Uniform(random, 1.0f, 5.0f)));
  for (uint32_t lane = 0; lane < kVerticesPerChunk; ++lane) {
    Links d = RestOf(s->table, s->chains, lane);
    double lambda[N];
    for (int i = 0; i < N; ++i) {
      const auto off = [&] { return Uniform(random, float(-swing), float(swing)); };
      d.v[i] = Unit(d.v[i] + Double3{off(), off(), off()});
      lambda[i] = Uniform(random, float(-tension), float(tension));
    }
    SetChain(*s, lane, d, lambda);
  }
  StrandBlock& strands = s->strands.strands;
  strands.vertex_count = kVertices;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    s->strands.rest.strength[lane] = lane % 5 == 0 ? Uniform(random, 0.0f, 1.0f) : 1.0f;
    FollowVertex(strands, lane, kVertices, random);
  }
  return s;
}

template <class W>
void RunKernels(Scene& s, PointBlock<4>& out) {
  Poison(out);
  Poison(s.loads);
  RunOnBlocks<ChainLoads<W>>(nullptr, s.chains.layer, s.table, s.chains.state, s.chains.rest,
                             s.chains.roots, s.modal, s.parents, s.loads);
  RunOnBlocks<InterpolateModal<W>>(&s.strands.params, s.chains.layer, s.table, s.chains.state,
                                   s.strands.strands, s.strands.rest, s.strands.roots, s.loads,
                                   out);
}

// ---- A reference: whole matrices, and elimination without an order to think about --------------

Links Times(const ModalTableBlock& t, const Links& u) {
  Links out{};
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) out.v[i] = out.v[i] + u.v[j] * double(t.stiffness[i][j]);
  return out;
}

Links Solve(double (&a)[N][N], Links b) {
  for (int i = 0; i < N; ++i)
    for (int r = 0; r < N; ++r) {
      if (r == i) continue;
      const double factor = a[r][i] / a[i][i];
      for (int c = 0; c < N; ++c) a[r][c] -= factor * a[i][c];
      b.v[r] = b.v[r] - b.v[i] * factor;
    }
  for (int i = 0; i < N; ++i) b.v[i] = b.v[i] * (1.0 / a[i][i]);
  return b;
}

double StretchOf(const Scene& s, int link, Double3 rest, double length) {
  if ((s.chains.layer.flags & kLayerSagFree) == 0) return 0.0;
  return std::max(Dot(rest, Of(s.chains.layer.gravity)), 0.0) / length * double(s.table.pull[link]);
}

// Directions under the blended loads of the chains' vertices.
Links Bent(const Scene& s, uint32_t lane) {
  const StrandBlock& strands = s.strands.strands;
  const double length = s.strands.rest.segment_length[lane];
  const Links rest = RestOf(s.table, s.strands, lane);
  Links push{};
  double a[N][N];
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) a[i][j] = double(s.table.stiffness[i][j]);
    a[i][i] += StretchOf(s, i, rest.v[i], length);
  }
  for (int k = 0; k < 3; ++k) {
    const uint32_t vertex = strands.vertex[k][lane];
    const double chain_length = s.chains.rest.segment_length[vertex];
    const double share = double(strands.bary[k][lane]) * chain_length / length;
    const Links chain_rest = RestOf(s.table, s.chains, vertex);
    Links d, u;
    for (int i = 0; i < N; ++i) {
      d.v[i] = At(s.modal.direction[i], vertex);
      u.v[i] = d.v[i] - chain_rest.v[i];
    }
    const Links force = Times(s.table, u);
    for (int i = 0; i < N; ++i) {
      const double stretch = StretchOf(s, i, chain_rest.v[i], chain_length);
      const double l = double(s.modal.multiplier[i][vertex]) + stretch;
      const Double3 load = force.v[i] + u.v[i] * stretch - d.v[i] * l;
      push.v[i] = push.v[i] + (load + rest.v[i] * l) * share;
      a[i][i] -= l * share;
    }
  }
  Links d = Solve(a, push);
  for (int i = 0; i < N; ++i) {
    d.v[i] = Unit(d.v[i] + rest.v[i]) - rest.v[i];
  }
  return d;
}

// Points, from the root, cut back to their parts.
std::vector<Double3> Drawn(const Scene& s, uint32_t lane) {
  const double length = s.strands.rest.segment_length[lane];
  const Links off = Bent(s, lane);
  const auto groom = GroomOf(s.strands.rest, s.strands.roots, lane);
  const Double3 root = At(s.strands.roots.position, lane);
  std::vector<Double3> out;
  Double3 last{}, shift{};
  for (int q = 0; q < N; ++q) {
    Double3 at = groom[size_t(q)] - root;
    for (int i = 0; i < N; ++i) at = at + off.v[i] * (length * double(s.table.place[2 * q + 1][i]));
    const Double3 part = at - last;
    last = at;
    if (Length(part) > length) shift = shift + part * (length / Length(part) - 1.0);
    at = at + shift;
    out.push_back(at);
  }
  const double strength = double(s.strands.rest.strength[lane]);
  for (int q = 0; q < N; ++q) {
    const Double3 still = groom[size_t(q)] - root;
    out[size_t(q)] = still + (out[size_t(q)] - still) * strength;
  }
  return out;
}

std::vector<Double3> Reference(const Scene& s, uint32_t lane, const PointBlock<4>* controls) {
  const Double3 root = At(s.strands.roots.position, lane);
  const std::vector<Double3> drawn = Drawn(s, lane);
  Double3 before{}, at{};
  std::vector<Double3> out;
  for (int i = 0; i < N; ++i) {
    const Double3 free = drawn[size_t(i)];
    Double3 to = free;
    if (controls) {
      const double share = double(s.chains.layer.clump) * (i + 1) / N;
      to = to + (At(controls->position[i], s.strands.strands.control[lane]) - root - to) * share;
      at = at + (to - at) * (Length(free - before) / Length(to - at));
    } else {
      at = to;
    }
    before = free;
    out.push_back(root + at);
  }
  return out;
}

TEST(InterpolateModal, MatchesDoubleReference) {
  auto out = std::make_unique<PointBlock<4>>();
  for (uint32_t seed = 1; seed <= 40; ++seed) {
    auto s = MakeScene(seed, 0.4, 1.0);
    const bool clump = seed % 2;
    if (clump) s->chains.layer.flags |= kLayerClump;
    if (seed % 3 == 0) s->chains.layer.flags |= kLayerSagFree;
    RunKernels<V>(*s, *out);
    for (uint32_t lane = 0; lane < s->strands.state.live_strands; ++lane) {
      const auto reference = Reference(*s, lane, clump && lane >= 16 ? out.get() : nullptr);
      for (int i = 0; i < N; ++i)
        EXPECT_LT(Length(At(out->position[i], lane) - reference[size_t(i)]),
                  2e-4 * double(s->strands.rest.segment_length[lane]) + 5e-7)
            << "seed " << seed << " lane " << lane << " point " << i + 1;
    }
  }
}

// Parents in the prefixes that bakes give them, three of different shares.
void SetParents(Scene& s, std::mt19937& random) {
  for (uint32_t level = kChainLevels - 1; level > 0; --level)
    for (uint32_t lane = CountChains(kVertices, level); lane < CountChains(kVertices, level - 1);
         ++lane) {
      s.parents.lanes[lane] = 0;
      float left = 1.0f;
      for (uint32_t k = 0; k < 3; ++k) {
        s.parents.lanes[lane] |= uint32_t(random() % CountChains(kVertices, level)) << 8 * k;
        s.parents.share[k][lane] = k == 2 ? left : left * Uniform(random, 0.2f, 0.6f);
        left -= s.parents.share[k][lane];
      }
    }
}

TEST(ChainLoads, ChainsLeftOutFollowTheirParents) {
  auto out = std::make_unique<PointBlock<4>>();
  for (uint32_t level = 0; level < kChainLevels; ++level)
    for (const float parent_share : {0.0f, 0.375f, 1.0f}) {
      if (level == kChainLevels - 1 && parent_share > 0.0f) continue;
      auto s = MakeScene(level + 7, 0.4, 1.0);
      std::mt19937 random(level);
      SetParents(*s, random);
      RunKernels<V>(*s, *out);
      const LoadBlock own = s->loads;  // of all chains
      ChunkStateBlock& state = s->chains.state;
      state.live_chains = CountChains(kVertices, level);
      state.parent_share = parent_share;
      state.whole_chains =
          parent_share > 0.0f ? CountChains(kVertices, level + 1) : state.live_chains;
      RunKernels<V>(*s, *out);
      for (uint32_t v = 0; v < kVertices; ++v)
        for (uint32_t i = 0; i < N; ++i)
          for (uint32_t c = 0; c < 4; ++c) {
            double expected = double(own.vertex[v].part[i][c]);
            if (v >= state.whole_chains) {
              double from_parents = 0.0;
              for (uint32_t k = 0; k < 3; ++k)
                from_parents +=
                    double(s->parents.share[k][v]) *
                    double(s->loads.vertex[s->parents.lanes[v] >> 8 * k & 0xffu].part[i][c]);
              const double share = v < state.live_chains ? double(parent_share) : 1.0;
              expected = expected * (1.0 - share) + from_parents * share;
            }
            ASSERT_NEAR(double(s->loads.vertex[v].part[i][c]), expected,
                        1e-5 * (1.0 + std::abs(expected)))
                << "level " << level << ", share " << parent_share << ", vertex " << v;
          }
    }
}

// Sag-free chains too, that start or have come to rest.
TEST(InterpolateModal, ChainsOnTheirGroomLeaveStrandsOnTheirs) {
  auto out = std::make_unique<PointBlock<4>>();
  auto s = MakeScene(5, 0.0, 0.0);
  RunKernels<V>(*s, *out);
  ExpectOnGroom(s->strands, *out);
  s->chains.layer.flags |= kLayerSagFree;
  RunKernels<V>(*s, *out);
  ExpectOnGroom(s->strands, *out);
  for (uint32_t lane = 0; lane < kVerticesPerChunk; ++lane) {
    const Links rest = RestOf(s->table, s->chains, lane);
    double lambda[N];
    for (int i = 0; i < N; ++i)
      lambda[i] = -StretchOf(*s, i, rest.v[i], s->chains.rest.segment_length[lane]);
    SetChain(*s, lane, rest, lambda);
  }
  RunKernels<V>(*s, *out);
  ExpectOnGroom(s->strands, *out);
}

// Pressed down hard, chains that are out of the skin leave no strand in it.
TEST(InterpolateModal, StrandsStayOutOfTheSkin) {
  auto out = std::make_unique<PointBlock<4>>();
  const auto deepest = [&](Scene& s) {
    RunKernels<V>(s, *out);
    double depth = 0.0;
    for (uint32_t lane = 0; lane < s.strands.state.live_strands; ++lane) {
      const Double3 root = At(s.strands.roots.position, lane), n = At(s.strands.roots.normal, lane);
      for (int i = 0; i < N; ++i) {
        const Double3 off = At(out->position[i], lane) - root;
        depth = std::max(depth, -Dot(off, n));
      }
    }
    return depth;
  };
  auto s = MakeScene(3, 1.5, 0.0);
  s->chains.state.flags = 0;
  const double length = 0.01;  // of a link, about
  EXPECT_GT(deepest(*s), 0.5 * length);
  s->chains.layer.surface_hardness = s->chains.layer.modal.drawn_hardness = 1.0f;
  EXPECT_LT(deepest(*s), 1e-4 * length);
  // What a substep would take is the chains'.
  s->chains.layer.surface_hardness = 0.01f;
  EXPECT_LT(deepest(*s), 1e-4 * length);
  s->chains.layer.flags |= kLayerClump;
  EXPECT_LT(deepest(*s), 1e-4 * length);
}

TEST(InterpolateModal, NoPartGetsLongerUnderAnyMultiplier) {
  auto out = std::make_unique<PointBlock<4>>();
  for (uint32_t seed = 1; seed <= 12; ++seed) {
    auto s = MakeScene(seed, 1.5, std::pow(10.0, double(seed)));
    if (seed % 2) s->chains.layer.flags |= kLayerClump;
    if (seed % 4 == 0) std::memset(s->table.stiffness, 0, sizeof s->table.stiffness);
    RunKernels<V>(*s, *out);
    s->strands.position = *out;
    for (uint32_t lane = 0; lane < s->strands.state.live_strands; ++lane)
      for (int i = 0; i < N; ++i) {
        const Double3 above =
            i == 0 ? At(s->strands.roots.position, lane) : At(out->position[i - 1], lane);
        EXPECT_LT(Length(At(out->position[i], lane) - above),
                  double(s->strands.rest.segment_length[lane]) * (1.0 + 1e-4) + 1e-6)
            << seed << ", lane " << lane;
      }
  }
}

TEST(InterpolateModal, DegenerateStrandsStayFinite) {
  auto s = MakeScene(9, 0.5, 100.0);
  auto out = std::make_unique<PointBlock<4>>();
  MakeDegenerate(s->chains, s->strands);
  RunKernels<V>(*s, *out);
  ExpectFinite(s->strands, *out);
}

TEST(InterpolateModal, SameBitsOnEveryVector) {
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    auto s = MakeScene(seed, 0.5, 100.0);
    if (seed % 2) s->chains.layer.flags |= kLayerClump;
    if (seed % 3 == 0) s->chains.layer.flags |= kLayerSagFree;
    s->chains.layer.surface_hardness = seed % 2 ? 0.5f : 0.0f;
    ExpectSamePointsEverywhere(*s, seed, [&]<class W>(auto& out) { RunKernels<W>(*s, out); });
  }
}

}  // namespace
}  // namespace pelt::test
