// Running a kernel on every vector type this translation unit can, without an executor.
#pragma once

#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <random>
#include <vector>

#include "core/kernel.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PELT_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PELT_SANITIZED
#endif
#endif

namespace pelt::test {

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

// Aligned blocks, every byte of them 0xFF to begin with: what an executor's poisoned memory holds.
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

// Uniform in [low, high), the same on every standard library.
inline float Uniform(std::mt19937& random, float low, float high) {
  return low + (high - low) * (float(random() >> 8) * 0x1p-24f);
}

}  // namespace pelt::test
