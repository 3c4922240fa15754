// Nanoseconds a key of the layer sort, whole and in pieces, and what the machine allows.
//
// Keys are the depths of a fur layer seen from about 3 m: shuffled, a third facing away. The digest
// beside each figure is of the order the benchmark produced: figures with different digests are not
// comparable. `limit_ns` is what the sort's bytes would take at the copy bandwidth measured in the
// same run; `over_limit` is the ratio to it.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>
#include <vector>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/frame_table.hpp"

namespace pelt {
namespace {

template <class T>
class Blocks {
 public:
  explicit Blocks(size_t count) : storage_(count * sizeof(T) + kBlockAlignment) {
    const size_t at = reinterpret_cast<uintptr_t>(storage_.data()) % kBlockAlignment;
    data_ = storage_.data() + (kBlockAlignment - at) % kBlockAlignment;
    count_ = uint32_t(count);
  }
  T* data() { return reinterpret_cast<T*>(data_); }
  Binding Bind() { return {data_, nullptr, count_}; }
  Binding Bind(uint32_t block) { return {data_ + block * sizeof(T), nullptr, 1}; }

 private:
  std::vector<std::byte> storage_;
  std::byte* data_;
  uint32_t count_;
};

uint32_t NextRandom(uint32_t& state) {
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return state;
}

struct Layer {
  uint32_t chunks;
  Blocks<SortKeyBlock> keys;
  Blocks<ChunkStateBlock> state;
  Blocks<SortPairBlock> a, b;
  Blocks<DigitBlock> digits;
  Blocks<OrderBlock> words, order;
  uint32_t visible = 0;

  explicit Layer(uint32_t strands)
      : chunks((strands + kStrandsPerChunk - 1) / kStrandsPerChunk),
        keys(chunks),
        state(chunks),
        a(chunks),
        b(chunks),
        digits(chunks),
        words(chunks),
        order(chunks) {
    uint32_t random = 2463534242u;
    for (uint32_t i = 0; i < chunks * kStrandsPerChunk; ++i) {
      const float depth = 2.9f + 0.4f * (float(NextRandom(random) >> 8) * 0x1p-24f);
      uint32_t bits;
      std::memcpy(&bits, &depth, sizeof bits);
      const bool drawn = i < strands && NextRandom(random) % 3 != 0;
      keys.data()->key[i] = drawn ? bits ^ 0x7fffffffu : kCulledKey;
      visible += drawn;
    }
    for (uint32_t c = 0; c < chunks; ++c) state.data()[c].first_place = c * kStrandsPerChunk;
  }

  uint64_t Digest() {
    uint64_t hash = 0xcbf29ce484222325u;
    for (uint32_t i = 0; i < visible; ++i) hash = (hash ^ order.data()->strand[i]) * 0x100000001b3u;
    return hash;
  }
};

// Seconds a byte of copying `bytes`, the best of a few tries.
double CopySecondsPerByte(size_t bytes) {
  std::vector<std::byte> from(bytes), to(bytes);
  double best = 1e9;
  for (int i = 0; i < 30; ++i) {
    const auto start = std::chrono::steady_clock::now();
    std::memcpy(to.data(), from.data(), bytes);
    benchmark::DoNotOptimize(to.data());
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    best = std::min(best, time.count() / double(bytes));
  }
  return best;
}

// `bytes_a_key`: read and written by the algorithm.
void Report(benchmark::State& state, Layer& layer, uint32_t strands, double bytes_a_key) {
  using benchmark::Counter;
  // A copy reads and writes each byte.
  const double limit_ns = 0.5e9 * bytes_a_key * CopySecondsPerByte(strands * size_t(16));
  state.counters["a_key"] =
      Counter(double(strands), Counter::kIsIterationInvariantRate | Counter::kInvert);
  state.counters["limit_ns"] = limit_ns;
  state.counters["drawn"] = double(layer.visible);
  char label[32];
  std::snprintf(label, sizeof label, "digest %016llx", (unsigned long long)layer.Digest());
  state.SetLabel(label);
}

void SortWhole(benchmark::State& state, Isa isa) {
  const FrameTable* table = FindKernels(isa);
  if (!table) return state.SkipWithError("not on this processor");
  const uint32_t strands = uint32_t(state.range(0));
  Layer layer(strands);
  const Binding bindings[] = {layer.keys.Bind(), layer.words.Bind(), layer.order.Bind()};
  for (auto _ : state) {
    table->Find("sort_layer")->run(nullptr, bindings);
    benchmark::ClobberMemory();
  }
  // Scan 4, split 4 + 8 + 4, count 8, two scatters of 8 + 8 and 8 + 4.
  Report(state, layer, strands, 4 + 16 + 8 + 16 + 12);
}

void RunDigit(const FrameTable& table, Layer& layer, int digit) {
  // By name once a digit, among so few as not to be seen.
  const auto find = [&](const char* kernel) { return *table.Find(kernel + std::to_string(digit)); };
  const KernelDesc count = find("sort_count"), offsets = find("sort_offsets");
  const KernelDesc scatter = find("sort_scatter");
  const auto source = [&](uint32_t c) {
    return digit == 0 ? layer.keys.Bind(c) : digit == 2 ? layer.b.Bind(c) : layer.a.Bind(c);
  };
  const Binding target = digit == 3   ? layer.order.Bind()
                         : digit == 1 ? layer.b.Bind()
                                      : layer.a.Bind();
  for (uint32_t c = 0; c < layer.chunks; ++c) {
    const Binding bindings[] = {source(c), layer.digits.Bind(c)};
    count.run(nullptr, bindings);
  }
  const Binding all = layer.digits.Bind();
  offsets.run(nullptr, &all);
  for (uint32_t c = 0; c < layer.chunks; ++c) {
    const Binding first[] = {layer.state.Bind(c), source(c), layer.digits.Bind(c), target};
    scatter.run(nullptr, digit == 0 ? first : first + 1);
  }
}

void SortInPieces(benchmark::State& state, Isa isa) {
  const FrameTable* table = FindKernels(isa);
  if (!table) return state.SkipWithError("not on this processor");
  const uint32_t strands = uint32_t(state.range(0));
  Layer layer(strands);
  for (auto _ : state) {
    for (int digit = 0; digit < 4; ++digit) RunDigit(*table, layer, digit);
    benchmark::ClobberMemory();
  }
  // Counts 4 + 8 + 8 + 8, scatters 4 + 8, 16, 16, 8 + 4, and 4 KiB of digits a chunk and digit.
  const double digits = 4.0 * 4 * sizeof(DigitBlock) / kStrandsPerChunk;
  Report(state, layer, strands, 28 + 56 + digits);
}

BENCHMARK_CAPTURE(SortWhole, avx2, Isa::kAvx2)->Arg(600)->Arg(5000)->Arg(20000)->Arg(100000);
BENCHMARK_CAPTURE(SortWhole, sse4, Isa::kSse4)->Arg(20000);
BENCHMARK_CAPTURE(SortWhole, reference, Isa::kReference)->Arg(20000);
BENCHMARK_CAPTURE(SortInPieces, avx2, Isa::kAvx2)->Arg(20000)->Arg(100000);

}  // namespace
}  // namespace pelt
