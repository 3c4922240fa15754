// 16-byte records: the one irregular access of the frame; and lanes of a row.
//
// A record is four floats (a skinned vertex holds four of them). Records are loaded whole, blended
// whole and transposed between registers. Measured against element-by-element loads (6.7 ns for
// nine values) and hardware gathers (3.6 ns) this costs 3.1 ns.
//
// Two views of the same lanes, in groups of four:
//
//      columns   x = [ x0 x1 x2 x3 | x4 x5 x6 x7 | ... ]    records   a = [ record 0 | record 4 |
//      ..
//                y = [ y0 y1 y2 y3 | y4 ...                           b = [ record 1 | record 5 |
//                .. z, w                                                 c, d: records 2 | 6, 3 | 7
//
// TransposeFours turns one into the other inside each group of four, and is its own inverse.
// LoadRecords<k> loads the records of lanes k, k + 4, ...; SplatInFours<k> spreads a per-lane value
// over the record of its lane. Only data moves here: no result can depend on the lane count.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "core/simd/maths.hpp"
#include "core/simd/vec.hpp"

namespace pelt {

// Types that are not bare registers go through memory, but for those that name what they do there: a recording
// type (V::LoadRecord, V::SplatLane, V::Transpose, V::Record), and two vectors side by side (V::LoadHalves,
// V::StoreHalves, V::SplatHalves, V::Transpose).
struct Record4 {
  simd_detail::F4 r;
};

PELT_INLINE Record4 LoadRecord(const float* p) {
  Record4 out;
  std::memcpy(&out.r, p, 16);
  return out;
}
PELT_INLINE void StoreRecord(float* p, Record4 a) { std::memcpy(p, &a.r, 16); }
// Sixteen bytes and their arithmetic as V sees them.
namespace simd_detail {
template <class V>
struct RecordType {
  using Type = Record4;
  static PELT_INLINE Type Load(const float* p) { return LoadRecord(p); }
  static PELT_INLINE void Store(float* p, Type a) { StoreRecord(p, a); }
};
template <class V>
requires requires { typename V::Record; }
struct RecordType<V> {
  using Type = typename V::Record;
  static PELT_INLINE Type Load(const float* p) { return Type::Load(p); }
  static PELT_INLINE void Store(float* p, Type a) { a.Store(p); }
};
}  // namespace simd_detail
template <class V>
using RecordOf = typename simd_detail::RecordType<V>::Type;
template <class V>
PELT_INLINE RecordOf<V> LoadRecordAs(const float* p) {
  return simd_detail::RecordType<V>::Load(p);
}
template <class V>
PELT_INLINE void StoreRecordAs(float* p, RecordOf<V> a) {
  simd_detail::RecordType<V>::Store(p, a);
}
// *to = *from, for records that are a whole number of sixteen bytes.
template <class V, class T>
PELT_INLINE void CopyRecord(T* to, const T* from) {
  if constexpr (requires { typename V::Record; }) {
    static_assert(sizeof(T) % 16 == 0);
    const float* in = reinterpret_cast<const float*>(from);
    float* out = reinterpret_cast<float*>(to);
    for (size_t f = 0; f < sizeof(T) / 4; f += 4) V::LoadRecord(in + f).Store(out + f);
  } else {
    *to = *from;
  }
}
// *to = T{}, for records that are all zero then.
template <class V, class T>
PELT_INLINE void ClearRecord(T* to) {
  if constexpr (requires { typename V::Record; }) {
    static_assert(sizeof(T) % 16 == 0);
    float* out = reinterpret_cast<float*>(to);
    for (size_t f = 0; f < sizeof(T) / 4; f += 4) V(0.0f).Store(out + f);
  } else {
    *to = T{};
  }
}

PELT_INLINE Record4 operator+(Record4 a, Record4 b) { return {a.r + b.r}; }
PELT_INLINE Record4 operator-(Record4 a, Record4 b) { return {a.r - b.r}; }
PELT_INLINE Record4 operator*(Record4 a, float s) { return {a.r * (s - simd_detail::F4{})}; }

namespace simd_detail {

// A V that is a bare register of the machine; others go through memory.
template <class V>
concept IsRegister = requires {
  typename V::Raw;
};

// In each group of four lanes: elements k0..k3 of (a0 a1 a2 a3 b0 b1 b2 b3).
template <int k0, int k1, int k2, int k3, class Raw, size_t... kLane>
PELT_INLINE Raw ShuffleFours(Raw a, Raw b, std::index_sequence<kLane...>) {
  constexpr int kPick[4] = {k0, k1, k2, k3};
  constexpr int kToB = int(sizeof...(kLane)) - 4;
  return __builtin_shufflevector(
      a, b, (int(kLane) / 4 * 4 + kPick[kLane % 4] + (kPick[kLane % 4] < 4 ? 0 : kToB))...);
}

// Groups 0.. of a register from separate records, and back. The intrinsics are what g++ 12 does not
// find by itself.
template <class V, class RecordOfGroup>
PELT_INLINE V JoinRecords(RecordOfGroup record) {
  if constexpr (IsRegister<V> && V::kLanes == 4) {
    return V(record(0).r);
  }
#if defined(__AVX__)
  else if constexpr (IsRegister<V> && V::kLanes == 8) {
    const F4 a = record(0).r, b = record(1).r;
    return V(
        typename V::Raw(_mm256_insertf128_ps(_mm256_castps128_ps256(__m128(a)), __m128(b), 1)));
  }
#endif
#if defined(__AVX512F__)
  else if constexpr (IsRegister<V> && V::kLanes == 16) {
    const F4 a = record(0).r, b = record(1).r, c = record(2).r, d = record(3).r;
    const __m256 low = _mm256_insertf128_ps(_mm256_castps128_ps256(__m128(a)), __m128(b), 1);
    const __m256 high = _mm256_insertf128_ps(_mm256_castps128_ps256(__m128(c)), __m128(d), 1);
    return V(typename V::Raw(
        __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)));
  }
#endif
  else {
    alignas(64) float lanes[V::kLanes];
    for (int g = 0; g < V::kLanes / 4; ++g) StoreRecord(lanes + 4 * g, record(g));
    return V::Load(lanes);
  }
}

template <class V, class StoreGroup>
PELT_INLINE void SplitRecords(V a, StoreGroup store) {
  if constexpr (IsRegister<V> && V::kLanes == 4) {
    store(0, Record4{a.v});
  }
#if defined(__AVX__)
  else if constexpr (IsRegister<V> && V::kLanes == 8) {
    store(0, Record4{F4(_mm256_castps256_ps128(__m256(a.v)))});
    store(1, Record4{F4(_mm256_extractf128_ps(__m256(a.v), 1))});
  }
#endif
#if defined(__AVX512F__)
  else if constexpr (IsRegister<V> && V::kLanes == 16) {
    // Shuffles and maskless 256-bit intrinsics: g++ 12 warns inside its own 512-bit extractions.
    const auto low = __builtin_shufflevector(a.v, a.v, 0, 1, 2, 3, 4, 5, 6, 7);
    const auto high = __builtin_shufflevector(a.v, a.v, 8, 9, 10, 11, 12, 13, 14, 15);
    store(0, Record4{F4(_mm256_castps256_ps128(__m256(low)))});
    store(1, Record4{F4(_mm256_extractf128_ps(__m256(low), 1))});
    store(2, Record4{F4(_mm256_castps256_ps128(__m256(high)))});
    store(3, Record4{F4(_mm256_extractf128_ps(__m256(high), 1))});
  }
#endif
  else {
    alignas(64) float lanes[V::kLanes];
    a.Store(lanes);
    for (int g = 0; g < V::kLanes / 4; ++g) store(g, LoadRecord(lanes + 4 * g));
  }
}

}  // namespace simd_detail

// The records of lanes kFirst, kFirst + 4, ...; address(lane) -> const float* to 16 bytes.
template <class V, int kFirst, class AddressOfLane>
PELT_INLINE V LoadRecords(AddressOfLane address) {
  if constexpr (requires { V::LoadRecord(address(0)); })
    return V::LoadRecord(address(kFirst));
  else if constexpr (requires { V::template LoadHalves<kFirst>(address); })
    return V::template LoadHalves<kFirst>(address);
  else
    return simd_detail::JoinRecords<V>([&](int g) __attribute__((always_inline)) {
      return LoadRecord(address(kFirst + 4 * g));
    });
}
// One part of records[index[kFirst]], records[index[kFirst + 4]], ...
template <class V, int kFirst, class Records, class T>
PELT_INLINE V LoadParts(const Records& records, const uint8_t* index, float (T::*part)[4]) {
  // Left to the compiler, a wide register gets a call for each record.
  return LoadRecords<V, kFirst>([&](int lane) __attribute__((always_inline)) {
    return records[index[lane]].*part;
  });
}
template <int kFirst, class V, class AddressOfLane>
PELT_INLINE void StoreRecords(V a, AddressOfLane address) {
  if constexpr (requires { V::LoadRecord(address(0)); })
    a.Store(address(kFirst));
  else if constexpr (requires { V::template StoreHalves<kFirst>(a, address); })
    V::template StoreHalves<kFirst>(a, address);
  else
    simd_detail::SplitRecords(
        a, [&](int g, Record4 r)
               __attribute__((always_inline)) { StoreRecord(address(kFirst + 4 * g), r); });
}

// Lane 4 g + kFirst of each group g, on all four lanes of the group.
template <int kFirst, class V>
PELT_INLINE V SplatInFours(V a) {
  if constexpr (simd_detail::IsRegister<V>) {
    return V(simd_detail::ShuffleFours<kFirst, kFirst, kFirst, kFirst>(
        a.v, a.v, std::make_index_sequence<size_t(V::kLanes)>{}));
  } else if constexpr (requires { V::SplatLane(a, kFirst); }) {
    return V::SplatLane(a, kFirst);
  } else if constexpr (requires { V::template SplatHalves<kFirst>(a); }) {
    return V::template SplatHalves<kFirst>(a);
  } else {
    alignas(64) float lanes[V::kLanes];
    a.Store(lanes);
    for (int l = 0; l < V::kLanes; ++l)
      if (l % 4 != kFirst) lanes[l] = lanes[l / 4 * 4 + kFirst];
    return V::Load(lanes);
  }
}

// Records to columns or columns to records, in each group of four lanes.
template <class V>
PELT_INLINE void TransposeFours(V& a, V& b, V& c, V& d) {
  if constexpr (simd_detail::IsRegister<V>) {
    constexpr auto kAll = std::make_index_sequence<size_t(V::kLanes)>{};
    using simd_detail::ShuffleFours;
    const auto ab_low = ShuffleFours<0, 4, 1, 5>(a.v, b.v, kAll);
    const auto ab_high = ShuffleFours<2, 6, 3, 7>(a.v, b.v, kAll);
    const auto cd_low = ShuffleFours<0, 4, 1, 5>(c.v, d.v, kAll);
    const auto cd_high = ShuffleFours<2, 6, 3, 7>(c.v, d.v, kAll);
    a = V(ShuffleFours<0, 1, 4, 5>(ab_low, cd_low, kAll));
    b = V(ShuffleFours<2, 3, 6, 7>(ab_low, cd_low, kAll));
    c = V(ShuffleFours<0, 1, 4, 5>(ab_high, cd_high, kAll));
    d = V(ShuffleFours<2, 3, 6, 7>(ab_high, cd_high, kAll));
  } else if constexpr (requires { V::Transpose(a, b, c, d); }) {
    V::Transpose(a, b, c, d);
  } else {
    alignas(64) float in[4][V::kLanes], out[4][V::kLanes];
    a.Store(in[0]);
    b.Store(in[1]);
    c.Store(in[2]);
    d.Store(in[3]);
    for (int l = 0; l < V::kLanes; ++l)
      for (int r = 0; r < 4; ++r) out[r][l] = in[l % 4][l / 4 * 4 + r];
    a = V::Load(out[0]);
    b = V::Load(out[1]);
    c = V::Load(out[2]);
    d = V::Load(out[3]);
  }
}

// Loads the records of kLanes lanes, address(lane) -> const float* to 16 bytes, and returns the
// four columns.
template <class V, class AddressOfLane>
PELT_INLINE void GatherColumns(AddressOfLane address, V& x, V& y, V& z, V& w) {
  static_assert(V::kLanes % 4 == 0);
  x = LoadRecords<V, 0>(address);
  y = LoadRecords<V, 1>(address);
  z = LoadRecords<V, 2>(address);
  w = LoadRecords<V, 3>(address);
  TransposeFours(x, y, z, w);
}

// Writes the lanes of four columns as kLanes records; address(lane) -> float* to 16 bytes.
template <class V, class AddressOfLane>
PELT_INLINE void ScatterRecords(AddressOfLane address, V x, V y, V z, V w) {
  static_assert(V::kLanes % 4 == 0);
  TransposeFours(x, y, z, w);
  StoreRecords<0>(x, address);
  StoreRecords<1>(y, address);
  StoreRecords<2>(z, address);
  StoreRecords<3>(w, address);
}

// ---- Lanes of a row --------------------------------------------------------------------------
//
// Where the lanes of a group stand in a chunk's rows: side by side from a first one on, or picked
// one by one, so that the few lanes of many groups that need more work make full groups.
//
// Code that is to run on both takes the place as a parameter `at` of its own type: a uint32_t, the
// first lane, or PickedLanes<V>.
//
// Invariant: only data moves here; a lane's bits do not depend on where it stood in its group.

// A lane may be there twice: both are the same, and so is what is stored of them.
template <class V>
struct PickedLanes {
  alignas(64) int32_t lane[V::kLanes];
};

template <class V>
PELT_INLINE V LoadLanes(const float* row, uint32_t first) {
  return V::Load(row + first);
}
template <class V>
PELT_INLINE V LoadLanes(const float* row, const PickedLanes<V>& at) {
  if constexpr (requires { V::LoadPicked(row, at.lane); }) return V::LoadPicked(row, at.lane);
#if defined(__AVX2__)
  const auto eight = [&](int first) __attribute__((always_inline)) {
    const void* lanes = at.lane + first;
    return _mm256_i32gather_ps(row, _mm256_load_si256(static_cast<const __m256i*>(lanes)), 4);
  };
  if constexpr (simd_detail::IsRegister<V> && V::kLanes == 8) return V(typename V::Raw(eight(0)));
  // Two halves: g++ 12 does not compile its own 512-bit gather without optimisation.
  if constexpr (simd_detail::IsRegister<V> && V::kLanes == 16) {
    const __m256 low = eight(0), high = eight(8);
    return V(typename V::Raw(
        __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)));
  }
#endif
  alignas(64) float lanes[V::kLanes];
  for (int l = 0; l < V::kLanes; ++l) lanes[l] = row[at.lane[l]];
  return V::Load(lanes);
}

template <class V>
PELT_INLINE void StoreLanes(V a, float* row, uint32_t first) {
  a.Store(row + first);
}
template <class V>
PELT_INLINE void StoreLanes(V a, float* row, const PickedLanes<V>& at) {
  if constexpr (requires { V::StorePicked(a, row, at.lane); })
    return V::StorePicked(a, row, at.lane);
  alignas(64) float lanes[V::kLanes];
  a.Store(lanes);
  PELT_UNROLL
  for (int l = 0; l < V::kLanes; ++l) row[at.lane[l]] = lanes[l];
}

// The lanes' numbers.
template <class V>
PELT_INLINE typename V::Int NumberLanes(uint32_t first) {
  return V::Int::Iota(int32_t(first));
}
template <class V>
PELT_INLINE typename V::Int NumberLanes(const PickedLanes<V>& at) {
  return V::Int::Load(at.lane);
}

// Three rows (x, y, z) of one block.
template <class V, int S, class At>
PELT_INLINE Vec3<V> Load3(const float (&rows)[3][S], const At& at) {
  return {LoadLanes<V>(rows[0], at), LoadLanes<V>(rows[1], at), LoadLanes<V>(rows[2], at)};
}
template <class V, int S>
PELT_INLINE void Store3(float (&rows)[3][S], uint32_t lane, Vec3<V> a) {
  a.x.Store(rows[0] + lane);
  a.y.Store(rows[1] + lane);
  a.z.Store(rows[2] + lane);
}

}  // namespace pelt
