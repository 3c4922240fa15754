// Simulation and fitting on one core: nanoseconds per strand, with the digest of what was computed
// beside it, and what the machine allows.
//
// 64 full chunks (8,192 strands) are stepped in turn, so that blocks come from L2 or L3 as in a
// frame. Gravity swings: no lane comes to rest. The digest is of the result after a fixed number of
// frames from the same start, so it must be the same for every instruction set and compiler.
//
// `limit_ns` is the larger of two times per strand: the bytes of the kernel's ports at the copy
// bandwidth measured over as many bytes in this run, and its vector operations (arithmetic,
// compares, selects, integer; counted by running the same source on a counting vector type) at the
// rate of independent multiplies and adds measured in this run. `share_of_limit` is limit over
// time: 1 could not be faster.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "core/kernels/fit_cubic.hpp"
#include "core/kernels/fit_ribbon.hpp"
#include "core/kernels/frame_table.hpp"
#include "core/kernels/interpolate.hpp"
#include "core/kernels/simulate_pbd.hpp"
#include "core/kernels/simulate_verlet.hpp"

namespace pelt {
namespace {

// ---- Counting -----------------------------------------------------------------------------------

uint64_t counted_operations = 0;

// Four lanes; every operation on lanes adds one. Loads, stores and shuffles are not counted.
struct CountVec {
  using Base = Vec<IsaSse4>;
  static constexpr int kLanes = 4;
  struct Mask {
    Base::Mask m;
    friend Mask operator&(Mask a, Mask b) { return ++counted_operations, Mask{a.m & b.m}; }
    friend Mask operator|(Mask a, Mask b) { return ++counted_operations, Mask{a.m | b.m}; }
    friend Mask operator!(Mask a) { return ++counted_operations, Mask{!a.m}; }
    friend bool Any(Mask a) { return ++counted_operations, Any(a.m); }
    friend bool AllSet(Mask a) { return ++counted_operations, AllSet(a.m); }
  };
  struct Int {
    Base::Int i;
    Int() = default;
    Int(int32_t scalar) : i(scalar) {}
    Int(Base::Int other) : i(other) {}
    static Int Load(const uint32_t* p) { return Base::Int::Load(p); }
    static Int LoadBytes(const uint8_t* p) { return Base::Int::LoadBytes(p); }
    static Int Iota(int32_t first) { return Base::Int::Iota(first); }
    friend Int operator+(Int a, Int b) { return ++counted_operations, Int(a.i + b.i); }
    friend Int operator-(Int a, Int b) { return ++counted_operations, Int(a.i - b.i); }
    friend Int operator&(Int a, Int b) { return ++counted_operations, Int(a.i & b.i); }
    friend Int operator|(Int a, Int b) { return ++counted_operations, Int(a.i | b.i); }
    friend Int operator^(Int a, Int b) { return ++counted_operations, Int(a.i ^ b.i); }
    friend Int operator<<(Int a, int n) { return ++counted_operations, Int(a.i << n); }
    friend Int operator>>(Int a, int n) { return ++counted_operations, Int(a.i >> n); }
    friend Mask operator==(Int a, Int b) { return ++counted_operations, Mask{a.i == b.i}; }
    friend Mask operator<(Int a, Int b) { return ++counted_operations, Mask{a.i < b.i}; }
  };
  Base v;
  CountVec() = default;
  CountVec(float scalar) : v(scalar) {}
  CountVec(Base other) : v(other) {}
  static CountVec Load(const float* p) { return Base::Load(p); }
  void Store(float* p) const { v.Store(p); }
  friend CountVec operator+(CountVec a, CountVec b) { return ++counted_operations, a.v + b.v; }
  friend CountVec operator-(CountVec a, CountVec b) { return ++counted_operations, a.v - b.v; }
  friend CountVec operator*(CountVec a, CountVec b) { return ++counted_operations, a.v * b.v; }
  friend CountVec operator/(CountVec a, CountVec b) { return ++counted_operations, a.v / b.v; }
  friend CountVec operator-(CountVec a) { return ++counted_operations, -a.v; }
  friend Mask operator<(CountVec a, CountVec b) { return ++counted_operations, Mask{a.v < b.v}; }
  friend Mask operator>(CountVec a, CountVec b) { return ++counted_operations, Mask{a.v > b.v}; }
  friend Mask operator<=(CountVec a, CountVec b) { return ++counted_operations, Mask{a.v <= b.v}; }
  friend Mask operator>=(CountVec a, CountVec b) { return ++counted_operations, Mask{a.v >= b.v}; }
  friend CountVec Select(Mask m, CountVec a, CountVec b) {
    return ++counted_operations, Select(m.m, a.v, b.v);
  }
  friend CountVec Min(CountVec a, CountVec b) { return ++counted_operations, Min(a.v, b.v); }
  friend CountVec Max(CountVec a, CountVec b) { return ++counted_operations, Max(a.v, b.v); }
  friend Int Bits(CountVec a) { return Bits(a.v); }
  friend CountVec FromBits(Int a) { return FromBits(a.i); }
  friend Int Truncate(CountVec a) { return ++counted_operations, Int(Truncate(a.v)); }
  friend CountVec ToFloat(Int a) { return ++counted_operations, CountVec(ToFloat(a.i)); }
};

// ---- The machine --------------------------------------------------------------------------------

double SecondsOf(auto work) {
  double best = 1e9;
  for (int i = 0; i < 30; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    best = std::min(best, time.count());
  }
  return best;
}

// Of reading or writing one byte, out of `bytes` in turn.
double SecondsPerByte(size_t bytes) {
  std::vector<std::byte> from(bytes), to(bytes);
  return SecondsOf([&] {
           std::memcpy(to.data(), from.data(), bytes);
           benchmark::DoNotOptimize(to.data());
         }) /
         double(2 * bytes);
}

constexpr int kRateIterations = 20000, kRateOperations = 16;

// Multiplies and adds on eight independent registers of `bytes`: as many as a core can start.
#define PELT_RATE_LOOP(name, bytes, flags)                                         \
  __attribute__((target(flags), noinline)) void name() {                           \
    typedef float Wide __attribute__((vector_size(bytes)));                        \
    const Wide k = Wide{} + 0.999f;                                                \
    Wide a = k, b = k, c = k, d = k, e = k, f = k, g = k, h = k;                   \
    for (int iteration = 0; iteration < kRateIterations; ++iteration) {            \
      a = a * k, b = b * k, c = c * k, d = d * k, e = e * k, f = f * k, g = g * k; \
      h = h * k, a = a + k, b = b + k, c = c + k, d = d + k, e = e + k, f = f + k; \
      g = g + k, h = h + k;                                                        \
    }                                                                              \
    Wide sum = a + b + c + d + e + f + g + h;                                      \
    benchmark::DoNotOptimize(&sum);                                                \
  }
PELT_RATE_LOOP(RunSse4Rate, 16, "sse4.1")
PELT_RATE_LOOP(RunAvx2Rate, 32, "avx2")
PELT_RATE_LOOP(RunAvx512Rate, 64, "avx512f")
#undef PELT_RATE_LOOP

// Of one operation on one lane.
double SecondsPerLaneOperation(Isa isa) {
  const double count = double(kRateIterations) * kRateOperations;
  switch (isa) {
    case Isa::kAvx512:
      return SecondsOf(RunAvx512Rate) / (count * 16);
    case Isa::kAvx2:
      return SecondsOf(RunAvx2Rate) / (count * 8);
    default:
      return SecondsOf(RunSse4Rate) / (count * 4);
  }
}

// ---- The scene ----------------------------------------------------------------------------------

constexpr uint32_t kChunks = 64;
constexpr uint32_t kDigestFrames = 30;

uint32_t NextRandom(uint32_t& state) {
  state = state * 1664525u + 1013904223u;
  return state >> 8;
}
float Uniform(uint32_t& state, float low, float high) {
  return low + (high - low) * (float(NextRandom(state)) * (1.0f / 16777216.0f));
}

template <uint32_t kPoints>
struct Chunk {
  ChunkStateBlock state;
  StrandBlock strands;
  RestBlock<kPoints> rest;
  RootBlock roots;
  WindBlock wind;
  LoadBlock loads;
  ChainParentBlock parents;
  PointBlock<kPoints> position, previous, strand_points;
  CurveBlock curves;
  RibbonBlock ribbons;
};

// Roots on a bumpy patch, strands of 2-4 cm that lean and curl a little.
template <uint32_t kPoints>
void FillChunk(uint32_t seed, Chunk<kPoints>& c) {
  std::memset(static_cast<void*>(&c), 0, sizeof c);
  uint32_t r = seed * 977u + 1u;
  c.state.flags = kChunkVisible | kChunkSkin | kChunkSimulate | kChunkFit | kChunkRestart;
  c.state.live_strands = c.state.live_vertices = kStrandsPerChunk;
  c.state.live_chains = c.state.whole_chains = kStrandsPerChunk;
  c.state.first_new_strand = c.state.first_new_chain = kStrandsPerChunk;
  c.strands.strand_count = c.strands.vertex_count = kStrandsPerChunk;
  c.strands.control_count = 16;
  c.strands.first_strand = seed * kStrandsPerChunk;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const float a = Uniform(r, -0.1f, 0.1f), b = Uniform(r, -0.1f, 0.1f);
    const float scale = 1.0f / __builtin_sqrtf(1.0f + a * a);
    c.roots.position[0][lane] = Uniform(r, -0.5f, 0.5f);
    c.roots.position[1][lane] = Uniform(r, 0.5f, 1.5f);
    c.roots.position[2][lane] = Uniform(r, -0.5f, 0.5f);
    c.roots.normal[1][lane] = scale;
    c.roots.normal[2][lane] = a * scale;
    c.roots.tangent[0][lane] = 1.0f;
    const float length = Uniform(r, 0.02f, 0.04f), segment = length / float(kPoints - 1);
    c.strands.length[lane] = length;
    c.strands.width[lane] = 0.0004f;
    c.strands.base_colour[lane] = 0xff303850u;
    c.strands.tip_colour[lane] = 0xff90a0c0u;
    for (int k = 0; k < 3; ++k) {
      c.strands.vertex[k][lane] = uint8_t(NextRandom(r) % kVerticesPerChunk);
      c.strands.bary[k][lane] = 1.0f / 3.0f;
    }
    c.strands.control[lane] = uint8_t(NextRandom(r) % 16);
    c.rest.segment_length[lane] = segment;
    c.rest.strength[lane] = 1.0f;
    float at[3] = {0, 0, 0};
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      const float d[3] = {0.6f + a * float(i), 0.1f + b * float(i), 0.8f};
      const float inverse = segment / __builtin_sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      for (int k = 0; k < 3; ++k) c.rest.offset[i][k][lane] = at[k] += d[k] * inverse;
    }
  }
}

LayerBlock MakeLayer(bool clump, uint32_t iterations) {
  LayerBlock layer{};
  layer.flags = kLayerEnabled | kLayerSimulate | (clump ? uint32_t(kLayerClump) : 0u);
  layer.gravity[1] = -9.81f;
  layer.link.velocity_keep = 0.95f;
  layer.link.segment_hardness = 1.0f;
  layer.link.angular_middle = 0.2f;
  layer.link.angular_end = 0.1f;
  layer.surface_hardness = 0.5f;
  layer.link.stiffness = 0.1f;
  layer.clump = 0.5f;
  layer.scale = 1.0f;
  layer.darken = 1.0f;
  layer.link.iterations = iterations;
  return layer;
}

uint64_t HashFloats(const void* values, size_t bytes, uint64_t hash) {
  for (size_t i = 0; i < bytes; i += 4) {
    uint32_t bits;
    std::memcpy(&bits, static_cast<const char*>(values) + i, 4);
    hash = (hash ^ bits) * 0x100000001b3ull;
  }
  return hash;
}

// What a port of the kernels here is bound to.
template <uint32_t kPoints>
void* FindBlock(const PortDesc& port, LayerBlock& layer, Chunk<kPoints>& c) {
  switch (uint32_t(port.stream)) {
    case uint32_t(StreamOf<&Streams::layers>):
      return &layer;
    case uint32_t(StreamOf<&Streams::chunk_state>):
    case uint32_t(StreamOf<&Streams::patch_state>):
      return &c.state;
    case uint32_t(StreamOf<&Streams::strands>):
      return &c.strands;
    case uint32_t(StreamOf<&Streams::vertex_rest>):
    case uint32_t(StreamOf<&Streams::strand_rest4>):
    case uint32_t(StreamOf<&Streams::strand_rest5>):
      return &c.rest;
    case uint32_t(StreamOf<&Streams::anchors>):
    case uint32_t(StreamOf<&Streams::roots>):
      return &c.roots;
    case uint32_t(StreamOf<&Streams::wind>):
    case uint32_t(StreamOf<&Streams::vertex_wind>):
      return &c.wind;
    case uint32_t(StreamOf<&Streams::vertex_loads>):
      return &c.loads;
    case uint32_t(StreamOf<&Streams::chain_parents>):
      return &c.parents;
    case uint32_t(StreamOf<&Streams::vertex_points>):
    case uint32_t(StreamOf<&Streams::strand_points5>):
      return &c.position;
    case uint32_t(StreamOf<&Streams::strand_points4>):
      return port.access == Access::kOut ? &c.strand_points : &c.position;
    case uint32_t(StreamOf<&Streams::vertex_previous>):
    case uint32_t(StreamOf<&Streams::strand_previous4>):
    case uint32_t(StreamOf<&Streams::strand_previous5>):
      return &c.previous;
    case uint32_t(StreamOf<&Streams::curves>):
      return &c.curves;
    case uint32_t(StreamOf<&Streams::ribbons>):
      return &c.ribbons;
    default:
      return nullptr;
  }
}

template <uint32_t kPoints>
struct Bench {
  LayerBlock layer;
  SimulateParams params{};
  std::vector<Chunk<kPoints>> chunks{kChunks};

  Bench(bool clump, uint32_t iterations) : layer(MakeLayer(clump, iterations)) {
    params.dt = 1.0f / 60.0f;
    params.rest_threshold = kRestThreshold;
    for (uint32_t i = 0; i < kChunks; ++i) FillChunk(i, chunks[i]);
  }
  void Run(const KernelDesc& kernel, Chunk<kPoints>& c) {
    Binding bindings[kMaxPorts];
    for (size_t i = 0; i < kernel.ports.size(); ++i)
      bindings[i] = {FindBlock(kernel.ports[i], layer, c), nullptr, 1};
    kernel.run(&params, bindings);
  }
  // Moves every root to and fro; the first frame starts the chains.
  void Shake(const KernelDesc& solver, uint32_t frames) {
    for (uint32_t frame = 0; frame < frames; ++frame)
      for (Chunk<kPoints>& c : chunks) {
        const float step = (frame / 8 % 2 ? -1.0f : 1.0f) * (frame ? 0.004f : 0.0f);
        for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
          c.roots.motion[0][lane] = step;
          c.roots.position[0][lane] += step;
        }
        Run(solver, c);
        c.state.flags &= ~uint32_t(kChunkRestart);
      }
  }
  uint64_t Digest() const {
    uint64_t hash = 0xcbf29ce484222325ull;
    for (const Chunk<kPoints>& c : chunks) {
      hash = HashFloats(&c.position, sizeof c.position, hash);
      hash = HashFloats(&c.strand_points, sizeof c.strand_points, hash);
      hash = HashFloats(&c.curves, sizeof c.curves, hash);
      hash = HashFloats(&c.ribbons, sizeof c.ribbons, hash);
    }
    return hash;
  }
  // Seconds per strand that the machine could not beat.
  double Limit(const KernelDesc& kernel, const KernelDesc& counting, Isa isa) {
    double bytes = 0.0;
    for (const PortDesc& port : kernel.ports)
      if (port.access != Access::kShared && port.stream != StreamOf<&Streams::wind> &&
          port.stream != StreamOf<&Streams::vertex_wind>)
        bytes += port.block_bytes * (port.access == Access::kGather  ? double(port.records)
                                     : port.access == Access::kInOut ? 2.0
                                                                     : 1.0);
    counted_operations = 0;
    for (Chunk<kPoints>& c : chunks) Run(counting, c);
    const double lane_operations = 4.0 * double(counted_operations) / kChunks;
    return std::max(bytes * SecondsPerByte(size_t(bytes) * kChunks / 2),
                    lane_operations * SecondsPerLaneOperation(isa)) /
           kStrandsPerChunk;
  }
  void Report(benchmark::State& run, uint64_t digest, double limit) {
    using benchmark::Counter;
    const double strands = double(run.iterations()) * kStrandsPerChunk;
    run.counters["a_strand"] = Counter(strands, Counter::kIsRate | Counter::kInvert);
    run.counters["limit_ns"] = limit * 1e9;
    run.counters["share_of_limit"] = Counter(strands * limit, Counter::kIsRate);
    char label[32];
    std::snprintf(label, sizeof label, "digest %016llx", (unsigned long long)digest);
    run.SetLabel(label);
  }
};

// ---- Benchmarks ---------------------------------------------------------------------------------

template <uint32_t kPoints>
void Simulate(benchmark::State& run, const char* which, KernelDesc counting, Isa isa,
              uint32_t iterations, bool clump) {
  const FrameTable* table = FindKernels(isa);
  if (!table) return run.SkipWithError("not on this processor");
  const KernelDesc& kernel = *table->Find(which);
  auto bench = std::make_unique<Bench<kPoints>>(clump, iterations);
  bench->Shake(kernel, kDigestFrames);
  const uint64_t digest = bench->Digest();
  uint32_t next = 0;
  for (auto _ : run) {
    bench->layer.gravity[0] = next / (8 * kChunks) % 2 ? 8.0f : -8.0f;
    bench->Run(kernel, bench->chunks[next++ % kChunks]);
    benchmark::ClobberMemory();
  }
  bench->Report(run, digest, bench->Limit(kernel, counting, isa));
}

template <uint32_t kPoints>
void Fit(benchmark::State& run, const char* which, KernelDesc counting, Isa isa, bool clump) {
  const FrameTable* table = FindKernels(isa);
  if (!table) return run.SkipWithError("not on this processor");
  const KernelDesc& kernel = *table->Find(which);
  auto bench = std::make_unique<Bench<kPoints>>(clump, 4);
  bench->Shake(*table->Find(kPoints == 4 ? "simulate_pbd_4" : "simulate_pbd_5"), 8);
  if (kPoints == 4)
    for (Chunk<kPoints>& c : bench->chunks) bench->Run(*table->Find("chain_displacements"), c);
  for (Chunk<kPoints>& c : bench->chunks) bench->Run(kernel, c);
  const uint64_t digest = bench->Digest();
  uint32_t next = 0;
  for (auto _ : run) {
    bench->Run(kernel, bench->chunks[next++ % kChunks]);
    benchmark::ClobberMemory();
  }
  bench->Report(run, digest, bench->Limit(kernel, counting, isa));
}

template <class K>
constexpr KernelDesc kCounting = MakeKernelDesc<K>();

const bool kRegistered = [] {
  using C = CountVec;
  for (const Isa isa : {Isa::kAvx2, Isa::kAvx512, Isa::kSse4, Isa::kReference}) {
    const auto add = [&](const char* name, auto run, auto... args) {
      benchmark::RegisterBenchmark((std::string(name) + "/" + std::string(IsaName(isa))).c_str(),
                                   run, args...);
    };
    const auto& vertex4 = kCounting<SimulatePbd<C, 4, true>>;
    add("pbd_vertex_4_points", Simulate<4>, "simulate_pbd_vertex", vertex4, isa, 4u, false);
    add("pbd_vertex_4_points_1_iteration", Simulate<4>, "simulate_pbd_vertex", vertex4, isa, 1u,
        false);
    const auto& pbd4 = kCounting<SimulatePbd<C, 4, false>>;
    add("pbd_4_points", Simulate<4>, "simulate_pbd_4", pbd4, isa, 4u, false);
    add("pbd_4_points_clump", Simulate<4>, "simulate_pbd_4", pbd4, isa, 4u, true);
    const auto& pbd5 = kCounting<SimulatePbd<C, 5, false>>;
    add("pbd_5_points", Simulate<5>, "simulate_pbd_5", pbd5, isa, 4u, false);
    const auto& verlet4 = kCounting<SimulateVerlet<C, 4>>;
    add("verlet_4_points", Simulate<4>, "simulate_verlet_4", verlet4, isa, 4u, false);
    const auto& verlet5 = kCounting<SimulateVerlet<C, 5>>;
    add("verlet_5_points", Simulate<5>, "simulate_verlet_5", verlet5, isa, 4u, false);
    add("verlet_5_points_clump", Simulate<5>, "simulate_verlet_5", verlet5, isa, 4u, true);
    const auto& interpolate = kCounting<Interpolate<C>>;
    add("interpolate", Fit<4>, "interpolate", interpolate, isa, false);
    add("interpolate_clump", Fit<4>, "interpolate", interpolate, isa, true);
    add("fit_cubic_4", Fit<4>, "fit_cubic_4", kCounting<FitCubic<C, 4>>, isa, false);
    add("fit_cubic_5", Fit<5>, "fit_cubic_5", kCounting<FitCubic<C, 5>>, isa, false);
    add("fit_ribbon_4", Fit<4>, "fit_ribbon_4", kCounting<FitRibbon<C, 4>>, isa, false);
    add("fit_ribbon_5", Fit<5>, "fit_ribbon_5", kCounting<FitRibbon<C, 5>>, isa, false);
  }
  return true;
}();

}  // namespace
}  // namespace pelt
