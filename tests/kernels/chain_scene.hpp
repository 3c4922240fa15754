// One chunk of chains for the solvers' tests: random or orderly scenes, and a slow, obvious
// reference of a step in double precision, one chain at a time, written from the equations and
// sharing no code with the kernels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include "core/kernels/simulate_pbd.hpp"
#include "core/kernels/simulate_verlet.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {

// ---- Scenes -------------------------------------------------------------------------------------

template <uint32_t kPoints>
struct ChainScene {
  LayerBlock layer;
  ChunkStateBlock state;
  RestBlock<kPoints> rest;
  RootBlock roots;
  WindBlock wind;
  StrandBlock strands;
  PointBlock<kPoints> position, previous;
  SimulateParams params;
};

inline void RandomUnit(std::mt19937& random, float (&out)[3]) {
  float length2;
  do {
    for (float& x : out) x = Uniform(random, -1.0f, 1.0f);
    length2 = out[0] * out[0] + out[1] * out[1] + out[2] * out[2];
  } while (length2 < 0.05f || length2 > 1.0f);
  for (float& x : out) x /= std::sqrt(length2);
}

template <uint32_t kPoints>
void SetRoot(ChainScene<kPoints>& s, uint32_t lane, const float (&position)[3],
             const float (&normal)[3], const float (&any)[3]) {
  const float along = any[0] * normal[0] + any[1] * normal[1] + any[2] * normal[2];
  float t[3], length2 = 0.0f;
  for (int k = 0; k < 3; ++k) t[k] = any[k] - normal[k] * along;
  for (float x : t) length2 += x * x;
  for (int k = 0; k < 3; ++k) {
    s.roots.position[k][lane] = position[k];
    s.roots.normal[k][lane] = normal[k];
    s.roots.tangent[k][lane] = t[k] / std::sqrt(length2);
    s.roots.motion[k][lane] = 0.0f;
  }
}

// A layer as an artist would set it; chains of 2-4 cm leaning over on a patch that faces up, at
// their groom. Lanes at and above `live` are padding.
template <uint32_t kPoints>
void MakeOrderly(ChainScene<kPoints>& s, uint32_t seed, uint32_t live = kStrandsPerChunk) {
  std::memset(static_cast<void*>(&s), 0, sizeof s);
  std::mt19937 random(seed);
  s.layer.flags = kLayerEnabled | kLayerSimulate;
  s.layer.gravity[1] = -9.81f;
  s.layer.link.velocity_keep = 0.951229f;  // 3 1/s at 60 Hz
  s.layer.scale = 1.0f;
  s.layer.link.segment_hardness = 1.0f;
  s.layer.link.angular_middle = 0.2f;
  s.layer.link.angular_end = 0.1f;
  s.layer.surface_hardness = 0.5f;
  s.layer.link.stiffness = 0.1f;
  s.layer.link.iterations = 4;
  s.params.dt = 1.0f / 60.0f;
  s.params.rest_threshold = kRestThreshold;
  s.state.live_strands = s.state.live_chains = live;
  s.state.first_new_strand = s.state.first_new_chain = live;
  s.strands.strand_count = live;
  s.strands.control_count = 16;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    float normal[3] = {Uniform(random, -0.5f, 0.5f), 1.0f, Uniform(random, -0.5f, 0.5f)}, any[3];
    const float size = std::sqrt(normal[0] * normal[0] + 1.0f + normal[2] * normal[2]);
    for (float& x : normal) x /= size;
    do RandomUnit(random, any);
    while (std::abs(any[1]) > 0.7f);
    SetRoot(
        s, lane,
        {Uniform(random, -0.5f, 0.5f), Uniform(random, 0.5f, 1.5f), Uniform(random, -0.5f, 0.5f)},
        normal, any);
    const float segment = Uniform(random, 0.02f, 0.04f) / float(kPoints - 1);
    const float lean = Uniform(random, 0.3f, 1.2f), curl = Uniform(random, -0.3f, 0.3f);
    s.rest.segment_length[lane] = segment;
    s.rest.strength[lane] = 1.0f;
    s.strands.control[lane] = uint8_t(random() % 16);
    float at[3] = {0.0f, 0.0f, 0.0f};
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      const float d[3] = {lean, curl * float(i), 1.0f};
      const float length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      for (int k = 0; k < 3; ++k) s.rest.offset[i][k][lane] = at[k] += d[k] * segment / length;
    }
  }
  s.state.flags = kChunkSimulate | kChunkRestart;
}

// Anything goes: chains in any direction, away from their groom and moving, roots that moved, hard
// and soft constraints and their edges, every feature on in some scenes.
template <uint32_t kPoints>
void MakeRandom(ChainScene<kPoints>& s, uint32_t seed) {
  std::mt19937 random(seed);
  MakeOrderly(s, seed, 1 + random() % kStrandsPerChunk);
  const auto edge = [&](float low, float high) {
    const uint32_t pick = random() % 4;
    return pick == 0 ? low : pick == 1 ? high : Uniform(random, low, high);
  };
  s.state.flags = kChunkSimulate;
  s.state.first_new_strand = s.state.first_new_chain =
      random() % 2 ? s.state.live_strands : random() % (s.state.live_strands + 1);
  for (float& g : s.layer.gravity) g = Uniform(random, -10.0f, 10.0f);
  s.layer.link.velocity_keep = edge(0.8f, 1.0f);
  s.layer.motion_follow = edge(0.0f, 1.0f);
  s.layer.link.segment_hardness = edge(0.0f, 1.0f);
  s.layer.link.angular_middle = edge(0.0f, 1.0f);
  s.layer.link.angular_end = edge(0.0f, 1.0f);
  s.layer.surface_hardness = edge(0.0f, 1.0f);
  s.layer.link.stiffness = edge(0.0f, 1.0f);
  s.layer.bounce = edge(0.0f, 1.0f);
  s.layer.clump = edge(0.0f, 1.0f);
  s.layer.link.iterations = random() % 7;
  if (random() % 2) s.layer.flags |= kLayerWind;
  if (random() % 2) s.layer.flags |= kLayerClump;
  s.params.rest_threshold = 0.0f;
  s.params.dt = 1.0f / Uniform(random, 15.0f, 240.0f);
  s.params.use_ground = random() % 2;
  s.params.ground[1] = 1.0f;
  s.params.ground[3] = Uniform(random, -1.0f, 1.0f);
  s.params.sphere_count = random() % 3;
  for (auto& sphere : s.params.sphere) {
    for (int k = 0; k < 3; ++k) sphere[k] = Uniform(random, -0.5f, 0.5f) + (k == 1 ? 1.0f : 0.0f);
    sphere[3] = Uniform(random, 0.05f, 0.3f);
  }
  s.params.capsule_count = random() % 3;
  for (CapsuleParams& capsule : s.params.capsule) {
    for (int k = 0; k < 3; ++k)
      capsule.from[k] = Uniform(random, -0.5f, 0.5f) + (k == 1 ? 1.0f : 0.0f);
    RandomUnit(random, capsule.axis);
    capsule.length = edge(0.0f, 0.5f);
    capsule.radius = Uniform(random, 0.05f, 0.3f);
  }
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    float normal[3], any[3], side;
    do {
      RandomUnit(random, normal);
      RandomUnit(random, any);
      side = normal[0] * any[0] + normal[1] * any[1] + normal[2] * any[2];
    } while (std::abs(side) > 0.9f);
    float root[3];
    for (int k = 0; k < 3; ++k) root[k] = s.roots.position[k][lane];
    SetRoot(s, lane, root, normal, any);
    s.rest.strength[lane] = edge(0.0f, 1.0f);
    const float size = s.rest.segment_length[lane];
    for (int k = 0; k < 3; ++k) {
      s.roots.motion[k][lane] = Uniform(random, -0.02f, 0.02f);
      s.wind.acceleration[k][lane] = Uniform(random, -20.0f, 20.0f);
      for (uint32_t i = 0; i + 1 < kPoints; ++i) {
        s.position.position[i][k][lane] =
            root[k] - s.roots.motion[k][lane] + Uniform(random, -1.0f, 1.0f) * size * float(i + 1);
        s.previous.position[i][k][lane] =
            s.position.position[i][k][lane] - Uniform(random, -0.5f, 0.5f) * size;
      }
    }
  }
}

// Strands that follow chains at the first `vertices` lanes of a patch.
inline void FollowVertex(StrandBlock& strands, uint32_t lane, uint32_t vertices,
                         std::mt19937& random) {
  float a = Uniform(random, 0.0f, 1.0f), b = Uniform(random, 0.0f, 1.0f);
  if (a + b > 1.0f) a = 1.0f - a, b = 1.0f - b;
  const float bary[3] = {a, b, 1.0f - a - b};
  for (int k = 0; k < 3; ++k) {
    strands.bary[k][lane] = bary[k];
    strands.vertex[k][lane] = uint8_t(random() % vertices);
  }
}

// One frame of kernel K. Blocks go through the same binding an executor uses.
template <class K, uint32_t kPoints>
void StepChains(ChainScene<kPoints>& s) {
  constexpr size_t kCount = KernelTraits<K>::kDescs.size();
  void* all[] = {&s.layer, &s.state,   &s.rest,     &s.roots,
                 &s.wind,  &s.strands, &s.position, &s.previous};
  Binding bindings[kCount];
  for (size_t i = 0, from = 0; i < kCount; ++i, ++from) {
    if (kCount == 7 && from == 5) ++from;  // vertex chains have no strands port
    bindings[i] = {all[from], nullptr, 1};
  }
  KernelTraits<K>::Run(&s.params, bindings);
  s.state.flags &= ~uint32_t(kChunkRestart);
}

// Moves every root and says so.
template <uint32_t kPoints>
void MoveRoots(ChainScene<kPoints>& s, float x, float y, float z) {
  const float step[3] = {x, y, z};
  for (int k = 0; k < 3; ++k)
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      const float before = s.roots.position[k][lane];
      s.roots.position[k][lane] = before + step[k];
      s.roots.motion[k][lane] = s.roots.position[k][lane] - before;
    }
}

// ---- The reference ------------------------------------------------------------------------------

enum class ReferenceSolver { kPbd, kVerlet };

struct ReferenceChain {
  std::vector<Double3> position, previous;
};

// The groom of a lane in the world: points 1 .. n.
template <uint32_t kPoints>
std::vector<Double3> GroomOf(const RestBlock<kPoints>& rest, const RootBlock& roots,
                             uint32_t lane) {
  const Double3 root = At(roots.position, lane), n = At(roots.normal, lane),
                t = At(roots.tangent, lane);
  const Double3 b = Cross(n, t);
  std::vector<Double3> points;
  for (uint32_t i = 0; i + 1 < kPoints; ++i) {
    const Double3 o = At(rest.offset[i], lane);
    points.push_back(root + t * o.x + b * o.y + n * o.z);
  }
  return points;
}

// One chain, one frame. `control` is the control strand's solved position, or null. Resting is not
// modelled (rest_threshold must be 0).
template <uint32_t kPoints>
ReferenceChain StepReference(const ChainScene<kPoints>& s, ReferenceSolver solver, uint32_t lane,
                             bool fresh, const std::vector<Double3>* control) {
  constexpr int n = int(kPoints) - 1;
  const LayerBlock& layer = s.layer;
  const Double3 root = At(s.roots.position, lane), normal = At(s.roots.normal, lane);
  const Double3 motion = At(s.roots.motion, lane);
  const double strength = s.rest.strength[lane];
  const std::vector<Double3> groom = GroomOf(s.rest, s.roots, lane);
  if (fresh || strength <= 0.0) return {groom, groom};
  const double length = s.rest.segment_length[lane], dt2 = double(s.params.dt) * s.params.dt;
  const double length2 = length * length;
  const Double3 carried = motion * layer.motion_follow, free_motion = motion - carried;
  Double3 acceleration = {layer.gravity[0], layer.gravity[1], layer.gravity[2]};
  if (layer.flags & kLayerWind) acceleration = acceleration + At(s.wind.acceleration, lane);

  std::vector<Double3> p(n), start(n), previous(n);
  for (int i = 0; i < n; ++i) {
    const Double3 old = At(s.position.position[i], lane);
    start[i] = old + carried;
    previous[i] = start[i];
    p[i] = start[i] + (old - At(s.previous.position[i], lane)) * layer.link.velocity_keep +
           acceleration * dt2;
    const double box = 2.0 * length * (i + 1);
    Double3 o = p[i] - root;
    o = {std::clamp(o.x, -box, box), std::clamp(o.y, -box, box), std::clamp(o.z, -box, box)};
    p[i] = root + o;
  }
  // Speeds into the planes, for the bounce.
  const Double3 ground = {s.params.ground[0], s.params.ground[1], s.params.ground[2]};
  const auto height = [&](Double3 a) { return Dot(ground, a) + s.params.ground[3]; };
  const double slow =
      2.0 * dt2 *
      (std::abs(layer.gravity[0]) + std::abs(layer.gravity[1]) + std::abs(layer.gravity[2]));
  std::vector<double> into_surface(n, 0.0), into_ground(n, 0.0);
  for (int i = 0; i < n; ++i) {
    const double a = Dot(free_motion - (p[i] - start[i]), normal);
    if (layer.surface_hardness > 0.0f && Dot(p[i] - root, normal) < 0 && a > slow)
      into_surface[i] = a;
    const double b = -Dot(p[i] - start[i], ground);
    if (s.params.use_ground && height(p[i]) < 0 && b > slow) into_ground[i] = b;
  }

  const auto shorten = [&](Double3 d) {  // what the length constraint adds to segment d
    const double d2 = Dot(d, d);
    return d * (((3.0 * length2 + d2) / (length2 + 3.0 * d2) - 1.0) * layer.link.segment_hardness);
  };
  for (uint32_t iteration = 0; iteration < layer.link.iterations; ++iteration) {
    if (solver == ReferenceSolver::kVerlet)
      for (int i = 0; i < n; ++i) p[i] = p[i] + (groom[i] - p[i]) * layer.link.stiffness;
    if (control)
      for (int i = 0; i < n; ++i)
        p[i] = p[i] + ((*control)[i] - p[i]) * (layer.clump * double(i + 1) / n);
    const auto share = [&](int i, Double3 change) {  // between the ends of segment i
      p[i] = p[i] + change * (i == 0 ? 1.0 : 0.75);
      if (i > 0) p[i - 1] = p[i - 1] - change * 0.25;
    };
    for (int i = 0; i < n && solver == ReferenceSolver::kPbd; ++i) {
      const Double3 d = p[i] - (i == 0 ? root : p[i - 1]);
      const Double3 wanted = groom[i] - (i == 0 ? root : groom[i - 1]);
      share(i, (wanted - d) * (i == n - 1 ? layer.link.angular_end : layer.link.angular_middle));
    }
    for (int i = 0; i < n; ++i) share(i, shorten(p[i] - (i == 0 ? root : p[i - 1])));
    for (int i = 0; i < n; ++i) {
      const double depth = std::min(0.0, Dot(p[i] - root, normal));
      p[i] = p[i] - normal * (depth * layer.surface_hardness);
    }
    // Out of what lies within `radius` of `core`, a function of the point.
    const auto push_out = [&](const auto& core, double radius) {
      if (Length(core(root) - root) >= 4.0 * length * n + radius) return;
      for (int i = 0; i < n; ++i) {
        const Double3 nearest = core(p[i]), d = p[i] - nearest;
        if (Length(d) < radius) p[i] = nearest + d * (radius / Length(d));
      }
    };
    for (uint32_t k = 0; k < s.params.sphere_count; ++k) {
      const float* sphere = s.params.sphere[k];
      push_out([&](Double3) { return Double3{sphere[0], sphere[1], sphere[2]}; }, sphere[3]);
    }
    for (uint32_t k = 0; k < s.params.capsule_count; ++k) {
      const CapsuleParams& c = s.params.capsule[k];
      const Double3 from = {c.from[0], c.from[1], c.from[2]},
                    axis = {c.axis[0], c.axis[1], c.axis[2]};
      push_out(
          [&](Double3 a) {
            return from + axis * std::clamp(Dot(a - from, axis), 0.0, double(c.length));
          },
          c.radius);
    }
    if (s.params.use_ground)
      for (int i = 0; i < n; ++i) p[i] = p[i] - ground * std::min(0.0, height(p[i]));
  }
  for (int i = 0; i < n; ++i) {
    p[i] = p[i] + (groom[i] - p[i]) * ((1.0 - strength) * (1.0 - strength));
    if (layer.bounce <= 0.0f) continue;
    const Double3 step = p[i] - previous[i];
    if (into_surface[i] > 0)
      previous[i] = previous[i] -
                    normal * (layer.bounce * (into_surface[i] - Dot(step - free_motion, normal)));
    if (into_ground[i] > 0)
      previous[i] = previous[i] - ground * (layer.bounce * (into_ground[i] - Dot(step, ground)));
  }
  return {p, previous};
}

// Largest difference of `after` (stepped by a kernel) from the reference's step of `before`, over
// live lanes, in segment lengths. Control strands' points are taken from `after`.
template <uint32_t kPoints>
double WorstDifference(const ChainScene<kPoints>& before, const ChainScene<kPoints>& after,
                       ReferenceSolver solver, bool vertex_chains) {
  const uint32_t live = vertex_chains ? before.state.live_chains : before.state.live_strands;
  const uint32_t first_new =
      vertex_chains ? before.state.first_new_chain : before.state.first_new_strand;
  double worst = 0.0;
  for (uint32_t lane = 0; lane < live; ++lane) {
    std::vector<Double3> control;
    const bool clump = !vertex_chains && (before.layer.flags & kLayerClump) &&
                       lane >= before.strands.control_count;
    for (uint32_t i = 0; clump && i + 1 < kPoints; ++i)
      control.push_back(At(after.position.position[i], before.strands.control[lane]));
    const ReferenceChain reference =
        StepReference(before, solver, lane, lane >= first_new, clump ? &control : nullptr);
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      const double size = before.rest.segment_length[lane];
      const Double3 a = At(after.position.position[i], lane) - reference.position[i];
      const Double3 b = At(after.previous.position[i], lane) - reference.previous[i];
      worst = std::max({worst, Length(a) / size, Length(b) / size});
      if (!std::isfinite(Length(a) + Length(b))) return INFINITY;
    }
  }
  return worst;
}

template <uint32_t kPoints>
void ExpectOnGroom(const ChainScene<kPoints>& s, const PointBlock<kPoints>& points) {
  for (uint32_t lane = 0; lane < s.state.live_strands; ++lane) {
    const auto groom = GroomOf(s.rest, s.roots, lane);
    for (uint32_t i = 0; i + 1 < kPoints; ++i)
      EXPECT_LT(Length(At(points.position[i], lane) - groom[i]), 2e-6) << lane;
  }
}

template <uint32_t kPoints>
void ExpectFinite(const ChainScene<kPoints>& s, const PointBlock<kPoints>& points) {
  for (uint32_t lane = 0; lane < s.state.live_strands; ++lane)
    for (uint32_t i = 0; i + 1 < kPoints; ++i)
      EXPECT_TRUE(std::isfinite(Length(At(points.position[i], lane)))) << lane;
}

// Strands and the chains that they follow without lengths.
inline void MakeDegenerate(ChainScene<4>& chains, ChainScene<4>& strands) {
  std::memset(static_cast<void*>(&strands.rest), 0, sizeof strands.rest);
  std::memset(chains.rest.segment_length, 0, sizeof chains.rest.segment_length);
}

// Points that `run` draws on each vector, and the loads that a scene has then.
template <class Scene, class Run>
void ExpectSamePointsEverywhere(Scene& s, uint32_t seed, Run run) {
  auto wanted = std::make_unique<PointBlock<4>>(), got = std::make_unique<PointBlock<4>>();
  run.template operator()<Vec<IsaSse4>>(*wanted);
  const auto loads = std::make_unique<LoadBlock>(s.loads);
  ForEveryVector([&]<class W>(const char* name) {
    run.template operator()<W>(*got);
    EXPECT_EQ(std::memcmp(loads.get(), &s.loads, sizeof *loads), 0) << name << " " << seed;
    EXPECT_EQ(std::memcmp(wanted.get(), got.get(), sizeof *got), 0) << name << " " << seed;
  });
}

// Same bits in every block a solver writes.
template <uint32_t kPoints>
bool SameChains(const ChainScene<kPoints>& a, const ChainScene<kPoints>& b) {
  return std::memcmp(&a.position, &b.position, sizeof a.position) == 0 &&
         std::memcmp(&a.previous, &b.previous, sizeof a.previous) == 0 &&
         a.state.state_changed == b.state.state_changed;
}

// Coordinates up to 1.5 m and segments of 5 mm and more: one step of a float is 2.4e-5 segments.
inline constexpr double kReferenceTolerance = 4e-4;  // segments

template <uint32_t kPoints>
auto NewScene() {
  return std::make_unique<ChainScene<kPoints>>();
}

template <class K, uint32_t kPoints>
double WorstOfRandom(ReferenceSolver solver, bool vertex_chains, uint32_t scenes) {
  auto before = NewScene<kPoints>(), after = NewScene<kPoints>();
  double worst = 0.0;
  for (uint32_t seed = 1; seed <= scenes; ++seed) {
    MakeRandom(*before, seed);
    *after = *before;
    StepChains<K>(*after);
    worst = std::max(worst, WorstDifference(*before, *after, solver, vertex_chains));
  }
  return worst;
}

// Kernel<V> is a solver.
template <template <class> class Kernel, uint32_t kPoints>
void ExpectSameStepsEverywhere() {
  auto start = NewScene<kPoints>(), wanted = NewScene<kPoints>(), got = NewScene<kPoints>();
  for (uint32_t seed = 1; seed <= 12; ++seed) {
    MakeRandom(*start, seed);
    start->params.rest_threshold = seed % 2 ? 0.3f : 0.0f;  // some chains rest in each group
    *wanted = *start;
    for (int frame = 0; frame < 3; ++frame) StepChains<Kernel<Vec<IsaSse4>>>(*wanted);
    const auto check = [&]<class W>(const char* name) {
      *got = *start;
      for (int frame = 0; frame < 3; ++frame) StepChains<Kernel<W>>(*got);
      EXPECT_TRUE(SameChains(*wanted, *got)) << name << " seed " << seed;
    };
    check.template operator()<ArrayVec<4>>("array of 4");
    if constexpr (kPoints == 5) check.template operator()<ArrayVec<8>>("array of 8");
#if defined(__AVX2__)
    check.template operator()<Vec<IsaAvx2>>("avx2");
#endif
#if defined(__AVX512F__)
    check.template operator()<Vec<IsaAvx512>>("avx512");
#endif
  }
}

// Largest share by which a segment of a live chain is off its length, and the mean.
template <uint32_t kPoints>
std::pair<double, double> StretchOf(const ChainScene<kPoints>& s) {
  double worst = 0.0, sum = 0.0;
  for (uint32_t lane = 0; lane < s.state.live_strands; ++lane) {
    Double3 last = At(s.roots.position, lane);
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      const Double3 p = At(s.position.position[i], lane);
      const double error = std::abs(Length(p - last) / s.rest.segment_length[lane] - 1.0);
      worst = std::max(worst, error);
      sum += error;
      last = p;
    }
  }
  return {worst, sum / (s.state.live_strands * (kPoints - 1))};
}

}  // namespace pelt::test
