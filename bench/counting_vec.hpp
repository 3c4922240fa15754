// A vector value that counts: the kernels' own source, run with it, says how many operations a
// stage needs. Nothing is counted by hand.
//
// One operation is one arithmetic, compare, select, logic or conversion on one lane. Loads, stores
// and moves between lanes are not counted: bytes are accounted for by the ports. Sorting is scalar
// code on integers and counts nothing here.
//
// Invariant: the values are ArrayVec's, so a counted frame has the reference's digests.
#pragma once

#include <cstdint>

#include "core/simd/array_vec.hpp"

namespace pelt {

// Lane operations since the program began. The counting kernels run on one thread only.
extern uint64_t counted_lane_operations;

struct CountingVec {
  static constexpr int kLanes = 4;
  using Base = ArrayVec<kLanes>;

  template <class T>
  static T Count(T result) {
    counted_lane_operations += kLanes;
    return result;
  }

  struct Mask {
    Base::Mask m;
    friend Mask operator&(Mask a, Mask b) { return Count(Mask{a.m & b.m}); }
    friend Mask operator|(Mask a, Mask b) { return Count(Mask{a.m | b.m}); }
    friend Mask operator!(Mask a) { return Count(Mask{!a.m}); }
    friend bool Any(Mask a) { return Count(Any(a.m)); }
    friend bool AllSet(Mask a) { return Count(AllSet(a.m)); }
  };

  struct Int {
    Base::Int i;
    Int() = default;
    Int(Base::Int base) : i(base) {}
    Int(int32_t scalar) : i(scalar) {}
    static Int Load(const int32_t* p) { return Base::Int::Load(p); }
    static Int Load(const uint32_t* p) { return Base::Int::Load(p); }
    static Int LoadBytes(const uint8_t* p) { return Base::Int::LoadBytes(p); }
    static Int Iota(int32_t first) { return Base::Int::Iota(first); }
    void Store(int32_t* p) const { i.Store(p); }
    void Store(uint32_t* p) const { i.Store(p); }
    int32_t operator[](int lane) const { return i[lane]; }
    friend Int operator+(Int a, Int b) { return Count(Int(a.i + b.i)); }
    friend Int operator-(Int a, Int b) { return Count(Int(a.i - b.i)); }
    friend Int operator*(Int a, Int b) { return Count(Int(a.i * b.i)); }
    friend Int operator&(Int a, Int b) { return Count(Int(a.i & b.i)); }
    friend Int operator|(Int a, Int b) { return Count(Int(a.i | b.i)); }
    friend Int operator^(Int a, Int b) { return Count(Int(a.i ^ b.i)); }
    friend Int operator<<(Int a, int n) { return Count(Int(a.i << n)); }
    friend Int operator>>(Int a, int n) { return Count(Int(a.i >> n)); }
    friend Mask operator==(Int a, Int b) { return Count(Mask{a.i == b.i}); }
    friend Mask operator<(Int a, Int b) { return Count(Mask{a.i < b.i}); }
    friend Mask operator>(Int a, Int b) { return Count(Mask{a.i > b.i}); }
    friend Int Select(Mask m, Int a, Int b) { return Count(Int(Select(m.m, a.i, b.i))); }
  };

  Base v;
  CountingVec() = default;
  CountingVec(Base base) : v(base) {}
  CountingVec(float scalar) : v(scalar) {}
  static CountingVec Load(const float* p) { return Base::Load(p); }
  void Store(float* p) const { v.Store(p); }
  float operator[](int lane) const { return v[lane]; }
  friend CountingVec operator+(CountingVec a, CountingVec b) {
    return Count(CountingVec(a.v + b.v));
  }
  friend CountingVec operator-(CountingVec a, CountingVec b) {
    return Count(CountingVec(a.v - b.v));
  }
  friend CountingVec operator*(CountingVec a, CountingVec b) {
    return Count(CountingVec(a.v * b.v));
  }
  friend CountingVec operator/(CountingVec a, CountingVec b) {
    return Count(CountingVec(a.v / b.v));
  }
  friend CountingVec operator-(CountingVec a) { return Count(CountingVec(-a.v)); }
  friend Mask operator<(CountingVec a, CountingVec b) { return Count(Mask{a.v < b.v}); }
  friend Mask operator>(CountingVec a, CountingVec b) { return Count(Mask{a.v > b.v}); }
  friend Mask operator<=(CountingVec a, CountingVec b) { return Count(Mask{a.v <= b.v}); }
  friend Mask operator>=(CountingVec a, CountingVec b) { return Count(Mask{a.v >= b.v}); }
  friend Mask operator==(CountingVec a, CountingVec b) { return Count(Mask{a.v == b.v}); }
  friend CountingVec Select(Mask m, CountingVec a, CountingVec b) {
    return Count(CountingVec(Select(m.m, a.v, b.v)));
  }
  friend CountingVec Min(CountingVec a, CountingVec b) { return Count(CountingVec(Min(a.v, b.v))); }
  friend CountingVec Max(CountingVec a, CountingVec b) { return Count(CountingVec(Max(a.v, b.v))); }
  friend Int Bits(CountingVec a) { return Int(Bits(a.v)); }
  friend CountingVec FromBits(Int a) { return CountingVec(FromBits(a.i)); }
  friend Int Truncate(CountingVec a) { return Count(Int(Truncate(a.v))); }
  friend CountingVec ToFloat(Int a) { return Count(CountingVec(ToFloat(a.i))); }
};

}  // namespace pelt
