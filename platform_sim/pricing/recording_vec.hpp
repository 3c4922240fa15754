// A vector value that records: the kernels' own source, run with it, says which operations a stage
// is made of, on what operands and at which addresses. Nothing is counted by hand.
//
// Idea: ArrayVec's values, each with the number of the operation that made it (recorder.hpp). What
// real vectors do between registers (transposing, spreading a lane, records) is one operation here,
// where ArrayVec goes through memory; a reciprocal root is one too, for consoles have estimates.
// Scalar words are a type of their own, for sorting.
//
// Invariant: the values are the reference's, bit for bit, recorder or not.
//
// Not seen: scalar code on plain integers and floats, such as a layer's parameters, loop counters
// and whole kernels that are a few scalars an item (stage_costs.hpp charges those by a rule).
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

#include "core/simd/array_vec.hpp"
#include "core/simd/maths.hpp"
#include "core/simd/records.hpp"
#include "platform_sim/pricing/recorder.hpp"

namespace pelt {

namespace recording {

inline uint32_t Make(RecordedKind kind, std::initializer_list<uint32_t> operands,
                     uint32_t results = 1, uint32_t bits = 0) {
  return Recorder::installed ? Recorder::installed->Make(kind, operands, results, bits) : kNoValue;
}
inline uint32_t Splat(uint32_t bits) {
  return Recorder::installed ? Recorder::installed->Splat(bits) : kNoValue;
}
inline uint32_t Load(RecordedKind kind, const void* p, uint32_t bytes, uint32_t index = kNoValue) {
  return Recorder::installed ? Recorder::installed->Load(kind, p, bytes, index) : kNoValue;
}
inline void Store(RecordedKind kind, const void* p, uint32_t bytes, uint32_t value,
                  uint32_t index = kNoValue) {
  if (Recorder::installed) Recorder::installed->Store(kind, p, bytes, value, index);
}

}  // namespace recording

// A scalar of sorting code. A constant of the code has no number, and operations on constants, or
// with a constant that changes nothing, are not there, as in compiled code.
template <class T>
struct RecordingWord {
  T value = 0;
  uint32_t id = kNoValue;
  bool is_constant = true;

  RecordingWord() = default;
  template <class Number>
  requires std::is_arithmetic_v<Number> RecordingWord(Number constant) : value(T(constant)) {}
  RecordingWord(T v, uint32_t number) : value(v), id(number), is_constant(false) {}
  // Widened or cut: the same register.
  template <class U>
  requires(!std::is_same_v<T, U>) explicit RecordingWord(RecordingWord<U> other)
      : value(T(other.value)), id(other.id), is_constant(other.is_constant) {}

  bool Is(T constant) const { return is_constant && value == constant; }

  static RecordingWord Record(RecordedKind kind, T result, RecordingWord a, RecordingWord b) {
    if (a.is_constant && b.is_constant) return result;
    return {result, Recorder::installed ? Recorder::installed->Word(kind, sizeof(T), a.id, b.id)
                                        : kNoValue};
  }
  friend RecordingWord operator+(RecordingWord a, RecordingWord b) {
    if (a.Is(0)) return b;
    if (b.Is(0)) return a;
    return Record(RecordedKind::kWordAdd, T(a.value + b.value), a, b);
  }
  friend RecordingWord operator-(RecordingWord a, RecordingWord b) {
    if (b.Is(0)) return a;
    return Record(RecordedKind::kWordSubtract, T(a.value - b.value), a, b);
  }
  friend RecordingWord operator&(RecordingWord a, RecordingWord b) {
    if (a.Is(0) || b.Is(0)) return T(0);
    if (a.Is(T(~T(0)))) return b;
    if (b.Is(T(~T(0)))) return a;
    return Record(RecordedKind::kWordAnd, T(a.value & b.value), a, b);
  }
  friend RecordingWord operator|(RecordingWord a, RecordingWord b) {
    if (a.Is(0)) return b;
    if (b.Is(0)) return a;
    return Record(RecordedKind::kWordOr, T(a.value | b.value), a, b);
  }
  friend RecordingWord operator~(RecordingWord a) { return T(~T(0)) - a; }
  friend RecordingWord operator<<(RecordingWord a, uint32_t n) {
    if (n == 0) return a;
    return Record(RecordedKind::kWordShiftLeft, T(a.value << n), a, T(n));
  }
  friend RecordingWord operator>>(RecordingWord a, uint32_t n) {
    if (n == 0) return a;
    return Record(RecordedKind::kWordShiftRight, T(a.value >> n), a, T(n));
  }
  friend RecordingWord operator!=(RecordingWord a, RecordingWord b) {
    return Record(RecordedKind::kWordDiffers, T(a.value != b.value), a, b);
  }
  RecordingWord& operator+=(RecordingWord b) { return *this = *this + b; }
};

struct RecordingVec {
  static constexpr int kLanes = 4;
  static constexpr bool kHasManyRegisters = true;  // 128
  using Base = ArrayVec<kLanes>;
  using Kind = RecordedKind;

  struct Mask {
    Base::Mask m;
    uint32_t id = kNoValue;
    friend Mask operator&(Mask a, Mask b) {
      return {a.m & b.m, recording::Make(Kind::kMaskAnd, {a.id, b.id})};
    }
    friend Mask operator|(Mask a, Mask b) {
      return {a.m | b.m, recording::Make(Kind::kMaskOr, {a.id, b.id})};
    }
    friend Mask operator!(Mask a) { return {!a.m, recording::Make(Kind::kMaskNot, {a.id})}; }
    friend bool Any(Mask a) {
      recording::Make(Kind::kAny, {a.id}, 0);
      return Any(a.m);
    }
    friend bool AllSet(Mask a) {
      recording::Make(Kind::kAllSet, {a.id}, 0);
      return AllSet(a.m);
    }
  };

#define PELT_RECORD_TWO(Type, name, field, kind)                                \
  friend Type name(Type a, Type b) {                                            \
    return {name(a.field, b.field), recording::Make(Kind::kind, {a.id, b.id})}; \
  }
#define PELT_RECORD_OPERATOR(Type, op, field, kind)                         \
  friend Type operator op(Type a, Type b) {                                 \
    return {a.field op b.field, recording::Make(Kind::kind, {a.id, b.id})}; \
  }
#define PELT_RECORD_COMPARE(Type, op, field, kind, first, second)                    \
  friend Mask operator op(Type a, Type b) {                                          \
    return {a.field op b.field, recording::Make(Kind::kind, {first.id, second.id})}; \
  }

  struct Int {
    Base::Int i;
    uint32_t id = kNoValue;
    Int() = default;
    Int(Base::Int value, uint32_t number) : i(value), id(number) {}
    Int(int32_t scalar) : i(scalar), id(recording::Splat(uint32_t(scalar))) {}
    static Int Load(const int32_t* p) {
      return {Base::Int::Load(p), recording::Load(Kind::kLoad, p, 16)};
    }
    static Int Load(const uint32_t* p) {
      return {Base::Int::Load(p), recording::Load(Kind::kLoad, p, 16)};
    }
    static Int LoadBytes(const uint8_t* p) {
      return {Base::Int::LoadBytes(p), recording::Load(Kind::kLoadBytes, p, 4)};
    }
    static Int Iota(int32_t first) {
      return {Base::Int::Iota(first), recording::Make(Kind::kIota, {}, 1, uint32_t(first))};
    }
    void Store(int32_t* p) const {
      i.Store(p);
      recording::Store(Kind::kStore, p, 16, id);
    }
    void Store(uint32_t* p) const {
      i.Store(p);
      recording::Store(Kind::kStore, p, 16, id);
    }
    int32_t operator[](int lane) const {
      recording::Make(Kind::kExtract, {id}, 0, uint32_t(lane));
      return i[lane];
    }
    PELT_RECORD_OPERATOR(Int, +, i, kIntAdd)
    PELT_RECORD_OPERATOR(Int, -, i, kIntSubtract)
    PELT_RECORD_OPERATOR(Int, *, i, kIntMultiply)
    PELT_RECORD_OPERATOR(Int, &, i, kIntAnd)
    PELT_RECORD_OPERATOR(Int, |, i, kIntOr)
    PELT_RECORD_OPERATOR(Int, ^, i, kIntXor)
    friend Int operator<<(Int a, int n) {
      return {a.i << n, recording::Make(Kind::kIntShiftLeft, {a.id}, 1, uint32_t(n))};
    }
    friend Int operator>>(Int a, int n) {
      return {a.i >> n, recording::Make(Kind::kIntShiftRight, {a.id}, 1, uint32_t(n))};
    }
    PELT_RECORD_COMPARE(Int, ==, i, kIntEqual, a, b)
    PELT_RECORD_COMPARE(Int, <, i, kIntLess, a, b)
    PELT_RECORD_COMPARE(Int, >, i, kIntLess, b, a)
    friend Int Select(Mask m, Int a, Int b) {
      return {Select(m.m, a.i, b.i), recording::Make(Kind::kSelect, {m.id, a.id, b.id})};
    }
  };

  Base v;
  uint32_t id = kNoValue;
  RecordingVec() = default;
  RecordingVec(Base value, uint32_t number) : v(value), id(number) {}
  RecordingVec(float scalar) : v(scalar), id(recording::Splat(std::bit_cast<uint32_t>(scalar))) {}
  static RecordingVec Load(const float* p) {
    return {Base::Load(p), recording::Load(Kind::kLoad, p, 16)};
  }
  void Store(float* p) const {
    v.Store(p);
    recording::Store(Kind::kStore, p, 16, id);
  }
  float operator[](int lane) const {
    recording::Make(Kind::kExtract, {id}, 0, uint32_t(lane));
    return v[lane];
  }
  PELT_RECORD_OPERATOR(RecordingVec, +, v, kAdd)
  PELT_RECORD_OPERATOR(RecordingVec, -, v, kSubtract)
  PELT_RECORD_OPERATOR(RecordingVec, *, v, kMultiply)
  PELT_RECORD_OPERATOR(RecordingVec, /, v, kDivide)
  friend RecordingVec operator-(RecordingVec a) {
    return {-a.v, recording::Make(Kind::kNegate, {a.id})};
  }
  PELT_RECORD_COMPARE(RecordingVec, <, v, kLess, a, b)
  PELT_RECORD_COMPARE(RecordingVec, >, v, kLess, b, a)
  PELT_RECORD_COMPARE(RecordingVec, <=, v, kLessEqual, a, b)
  PELT_RECORD_COMPARE(RecordingVec, >=, v, kLessEqual, b, a)
  PELT_RECORD_COMPARE(RecordingVec, ==, v, kEqual, a, b)
  friend RecordingVec Select(Mask m, RecordingVec a, RecordingVec b) {
    return {Select(m.m, a.v, b.v), recording::Make(Kind::kSelect, {m.id, a.id, b.id})};
  }
  PELT_RECORD_TWO(RecordingVec, Min, v, kMin)
  PELT_RECORD_TWO(RecordingVec, Max, v, kMax)
#undef PELT_RECORD_TWO
#undef PELT_RECORD_OPERATOR
#undef PELT_RECORD_COMPARE
  // The same register, read as another type.
  friend Int Bits(RecordingVec a) { return {Bits(a.v), a.id}; }
  friend RecordingVec FromBits(Int a) { return {FromBits(a.i), a.id}; }
  friend Int Truncate(RecordingVec a) {
    return {Truncate(a.v), recording::Make(Kind::kTruncate, {a.id})};
  }
  friend RecordingVec ToFloat(Int a) {
    return {ToFloat(a.i), recording::Make(Kind::kToFloat, {a.id})};
  }

  // What core/kernels/unrolled.hpp asks for.
  static void SideBySide(uint32_t a, uint32_t b) {
    if (Recorder::installed) Recorder::installed->SideBySide(a, b);
  }

  // What core/simd/maths.hpp and records.hpp ask for.
  static RecordingVec ReciprocalRoot(RecordingVec a) {
    return {Rsqrt(a.v), recording::Make(Kind::kReciprocalRoot, {a.id})};
  }
  // What rows/measured_kernels.hpp asks for.
  static RecordingVec ReciprocalEstimate(RecordingVec a) {
    return {Base(1.0f) / a.v, recording::Make(Kind::kReciprocalEstimate, {a.id})};
  }
  static RecordingVec ReciprocalRootEstimate(RecordingVec a) {
    return {Rsqrt(a.v), recording::Make(Kind::kReciprocalRootEstimate, {a.id})};
  }
  template <class Index>
  static RecordingVec LoadSplat(const float* base, Index index) {
    const Word<uint32_t> at(index);
    const float* p = base + at.value;
    return {Base(*p), recording::Load(Kind::kLoadSplat, p, sizeof(float), at.id)};
  }
  // Of picked lanes (core/simd/records.hpp): consoles have neither gather nor scatter, so a load for each
  // lane that all but it forget, and for each a quad that is read, changed and written.
  static RecordingVec LoadPicked(const float* row, const int32_t* lanes) {
    RecordingVec picked = LoadSplat(row, uint32_t(lanes[0]));
    for (int l = 1; l < kLanes; ++l) {
      const RecordingVec next = LoadSplat(row, uint32_t(lanes[l]));
      picked.v.v[l] = next.v.v[l];
      picked.id = recording::Make(Kind::kSelect, {LaneMask(l), next.id, picked.id});
    }
    return picked;
  }
  static void StorePicked(RecordingVec a, float* row, const int32_t* lanes) {
    for (int l = 0; l < kLanes; ++l) {
      row[lanes[l]] = a.v.v[l];
      const float* quad = row + lanes[l] / kLanes * kLanes;
      const uint32_t old = recording::Load(Kind::kLoad, quad, 16);
      recording::Store(Kind::kStore, quad, 16,
                       recording::Make(Kind::kSelect, {LaneMask(l), a.id, old}));
    }
  }
  using Record = RecordingVec;
  static RecordingVec LoadRecord(const float* p) {
    return {Base::Load(p), recording::Load(Kind::kLoadRecord, p, 16)};
  }
  static RecordingVec SplatLane(RecordingVec a, int lane) {
    return {Base(a.v.v[lane]), recording::Make(Kind::kSplatInFours, {a.id}, 1, uint32_t(lane))};
  }
  static void Transpose(RecordingVec& a, RecordingVec& b, RecordingVec& c, RecordingVec& d) {
    const uint32_t first = recording::Make(Kind::kTranspose, {a.id, b.id, c.id, d.id}, 4);
    TransposeFours(a.v, b.v, c.v, d.v);
    RecordingVec* const all[4] = {&a, &b, &c, &d};
    for (uint32_t r = 0; r < 4; ++r) all[r]->id = first == kNoValue ? kNoValue : first + r;
  }

  // What core/simd/words.hpp asks for.
  template <class T>
  using Word = RecordingWord<T>;
  template <class T, class Index>
  static Word<T> LoadWord(const T* base, Index index) {
    const Word<uint32_t> at(index);
    const T* p = base + at.value;
    return {*p, recording::Load(Kind::kWordLoad, p, sizeof(T), at.id)};
  }
  template <class T, class Index>
  static void StoreWord(T* base, Index index, Word<T> value) {
    const Word<uint32_t> at(index);
    T* p = base + at.value;
    *p = value.value;
    recording::Store(Kind::kWordStore, p, sizeof(T), value.id, at.id);
  }

 private:
  // The constant that picks one lane.
  static uint32_t LaneMask(int lane) { return recording::Splat(1u << lane); }
};

}  // namespace pelt
