// Scalar words as a vector type sees them.
//
// Sorting is scalar code on integers. A vector type that records what a kernel does (platform_sim)
// must see it too, so that code takes its words from V: WordOf<V> is plain uint32_t for every real
// vector, and LoadWord and StoreWord are an indexing, so nothing is added to what is compiled.
#pragma once

#include <cstdint>

#include "core/simd/vec.hpp"

namespace pelt {

namespace simd_detail {

template <class V>
concept HasWords = requires {
  typename V::template Word<uint32_t>;
};
template <class V, class T>
struct WordType {
  using Type = T;
};
template <HasWords V, class T>
struct WordType<V, T> {
  using Type = typename V::template Word<T>;
};

}  // namespace simd_detail

template <class V, class T = uint32_t>
using WordOf = typename simd_detail::WordType<V, T>::Type;

// base[index]; the index is a word of V or a plain number.
template <class V, class T, class Index>
PELT_INLINE WordOf<V, T> LoadWord(const T* base, Index index) {
  if constexpr (simd_detail::HasWords<V>)
    return V::LoadWord(base, index);
  else
    return base[index];
}
template <class V, class T, class Index>
PELT_INLINE void StoreWord(T* base, Index index, WordOf<V, T> value) {
  if constexpr (simd_detail::HasWords<V>)
    V::StoreWord(base, index, value);
  else
    base[index] = value;
}

}  // namespace pelt
