// Running a kernel without an executor, on every vector type that this translation unit can, and
// comparing what it writes bit for bit.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <random>
#include <vector>

#include "bench/accuracy/double3.hpp"
#include "core/kernel.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PELT_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PELT_SANITIZED
#endif
#endif

namespace pelt::test {

using accuracy::Double3, accuracy::Length, accuracy::Unit;

// Calls fn.operator()<V>(name) for each V. Sanitizers run the widest arrays through a compiler for
// minutes and find nothing there that narrow ones do not have.
template <class Fn>
void ForEveryVector(Fn fn) {
  fn.template operator()<ArrayVec<4>>("array of 4");
#if !defined(PELT_SANITIZED)
  fn.template operator()<ArrayVec<8>>("array of 8");
  fn.template operator()<ArrayVec<16>>("array of 16");
#endif
  fn.template operator()<Vec<IsaSse4>>("sse4");
#if defined(__AVX2__)
  if (__builtin_cpu_supports("avx2")) fn.template operator()<Vec<IsaAvx2>>("avx2");
#endif
#if defined(__AVX512F__)
  if (__builtin_cpu_supports("avx512f")) fn.template operator()<Vec<IsaAvx512>>("avx512");
#endif
}

// `make`.operator()<V>() has the bits of `expected` for each V; `what` names the case.
template <class Block, class Make, class What>
void ExpectOnEveryVector(const Block& expected, Make make, const What& what) {
  ForEveryVector([&]<class V>(const char* name) {
    const Block found = make.template operator()<V>();
    EXPECT_EQ(std::memcmp(&found, &expected, sizeof found), 0) << name << " " << what;
  });
}

// What an executor's poisoned memory holds: reading it gives NaN.
template <class Block>
void Poison(Block& block) {
  std::memset(static_cast<void*>(&block), 0xff, sizeof block);
}

// Aligned blocks, poisoned to begin with.
template <class T>
class Blocks {
 public:
  explicit Blocks(size_t count, int fill = 0xff)
      : blocks_(static_cast<T*>(::operator new(count * sizeof(T), std::align_val_t(128))), Free{}),
        count_(count) {
    std::memset(static_cast<void*>(blocks_.get()), fill, count * sizeof(T));
  }
  T& operator[](size_t i) { return blocks_.get()[i]; }
  const T& operator[](size_t i) const { return blocks_.get()[i]; }
  T* begin() { return blocks_.get(); }
  T* end() { return blocks_.get() + count_; }
  size_t size() const { return count_; }
  Binding Bind() { return {blocks_.get(), nullptr, uint32_t(count_)}; }
  Binding Bind(size_t block) { return {blocks_.get() + block, nullptr, 1}; }
  Binding BindList(uint32_t* index) { return {blocks_.get(), index, 0}; }
  bool SameBits(const Blocks& other) const {
    return count_ == other.count_ &&
           std::memcmp(static_cast<const void*>(blocks_.get()),
                       static_cast<const void*>(other.blocks_.get()), count_ * sizeof(T)) == 0;
  }

 private:
  struct Free {
    void operator()(T* p) const { ::operator delete(static_cast<void*>(p), std::align_val_t(128)); }
  };
  std::unique_ptr<T, Free> blocks_;
  size_t count_;
};

// Vertices that lie anywhere in a layer's patches, each in another place, and the halo that lists
// them.
template <class Block>
struct Scattered {
  static constexpr uint32_t kPatches = 3, kPlaces = kPatches * kVerticesPerChunk;
  Blocks<Block> patches{kPatches};
  Blocks<HaloBlock> halo{1};

  Scattered(const Block& from, uint32_t count, uint32_t shift) {
    for (uint32_t i = 0; i < count; ++i) {
      const uint32_t place = (i * 101 + shift) % kPlaces;
      halo[0].vertex[i] = place;
      patches[place / kVerticesPerChunk].vertex[place % kVerticesPerChunk] = from.vertex[i];
    }
  }
  Binding Bind() { return patches.BindList(halo[0].vertex); }
};

// Runs kernel K on one item; bindings in the order of its ports.
template <class K>
void RunKernel(std::initializer_list<Binding> bindings) {
  KernelTraits<K>::Run(nullptr, bindings.begin());
}
template <class K>
requires requires { typename K::Params; }
void RunKernel(const typename K::Params& params, std::initializer_list<Binding> bindings) {
  KernelTraits<K>::Run(&params, bindings.begin());
}

// The same on single blocks of the test's own, or bindings; `params` are null for a kernel that has
// none.
template <class Block>
Binding BindOne(const Block& block) {
  return {const_cast<void*>(static_cast<const void*>(&block)), nullptr, 1};
}
inline Binding BindOne(const Binding& binding) { return binding; }
template <class K, class... Block>
void RunOnBlocks(const void* params, const Block&... block) {
  static_assert(sizeof...(Block) == KernelTraits<K>::kDescs.size());
  const Binding bindings[] = {BindOne(block)...};
  KernelTraits<K>::Run(params, bindings);
}
// A kernel as it is built for an instruction set: compiling it again for each test takes minutes.
template <class... Block>
void RunOnBlocks(const KernelDesc& kernel, const void* params, const Block&... block) {
  ASSERT_EQ(kernel.ports.size(), sizeof...(Block));
  const Binding bindings[] = {BindOne(block)...};
  kernel.run(params, bindings);
}
// What K writes to its last port, a block of poison, from the others.
template <class K, class Out, class... Block>
Out OutputOf(const void* params, const Block&... block) {
  Out out;
  Poison(out);
  RunOnBlocks<K>(params, block..., out);
  return out;
}

inline uint32_t BitsOf(float a) {
  uint32_t bits;
  std::memcpy(&bits, &a, 4);
  return bits;
}

// Equal bits in the first `lanes` lanes of rows.
template <size_t R, size_t S>
void ExpectSameBits(const float (&a)[R][S], const float (&b)[R][S], uint32_t lanes,
                    const char* what) {
  for (size_t r = 0; r < R; ++r) {
    for (uint32_t l = 0; l < lanes; ++l) {
      ASSERT_EQ(BitsOf(a[r][l]), BitsOf(b[r][l]))
          << what << " row " << r << " lane " << l << ": " << a[r][l] << " and " << b[r][l];
    }
  }
}

// Uniform in [low, high), the same on every standard library.
inline float Uniform(std::mt19937& random, float low, float high) {
  return low + (high - low) * (float(random() >> 8) * 0x1p-24f);
}

inline Double3 RandomUnit(std::mt19937& random) {
  for (;;) {
    const Double3 p = {Uniform(random, -1, 1), Uniform(random, -1, 1), Uniform(random, -1, 1)};
    const double length = Length(p);
    if (length > 0.1 && length < 1.0) return p * (1.0 / length);
  }
}

// A lane of three rows.
template <size_t S>
Double3 At(const float (&rows)[3][S], uint32_t lane) {
  return {rows[0][lane], rows[1][lane], rows[2][lane]};
}
template <size_t S>
void SetAt(float (&rows)[3][S], uint32_t lane, Double3 v) {
  rows[0][lane] = float(v.x);
  rows[1][lane] = float(v.y);
  rows[2][lane] = float(v.z);
}
// Three floats, or more of which the first three count.
inline Double3 Of(const float* v) { return {v[0], v[1], v[2]}; }

}  // namespace pelt::test
