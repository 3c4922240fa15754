// Kernels that are wrong in one way each, and the healthy ones they are made from. A check that
// none of them can trip is a defect: tests/determinism/planted_faults_test.cpp.
//
// The healthy frame: `advance` turns every chunk's keys over (a state that moves from frame to
// frame), `derive` writes the chunk's order from keys and baked rows. Faulty kernels take
// `derive`'s place and are wrong only in the way they are named after.
#pragma once

#include <cstdint>
#include <cstring>

#include "core/kernel.hpp"
#include "tests/jobs/toys.hpp"

namespace pelt::testing {

struct FaultParams {
  uint32_t salt;
};

// The address as a number the compiler knows nothing about: the kernels below go where the language
// does not let them.
template <class T>
inline T* Launder(T* p) {
  asm volatile("" : "+r"(p));
  return p;
}

PELT_INLINE uint32_t Mix(uint32_t a, uint32_t b) {
  const uint32_t x = (a ^ b) * 2654435761u;
  return x ^ (x >> 15);
}

PELT_INLINE uint32_t BitsOf(float value) {
  uint32_t bits;
  std::memcpy(&bits, &value, 4);
  return bits;
}

// What most kernels below have: the ports of `derive` and of what stands in for it.
struct FaultKernel {
  using Params = FaultParams;
  struct Ports {
    In<&Toys::baked> baked;
    In<&Toys::keys> keys;
    Out<&Toys::order> order;
  };
};

struct Advance : FaultKernel {
  static constexpr std::string_view kName = "advance";
  struct Ports {
    InOut<&Toys::keys> keys;
  };
  static void Run(const Params& p, const Ports& ports) {
    for (uint32_t& key : ports.keys->key) key = Mix(key, p.salt);
  }
};

// The right result, which every faulty kernel starts from.
PELT_INLINE void DeriveOrder(const FaultKernel::Ports& ports) {
  for (uint32_t i = 0; i < kToyLanes; ++i)
    ports.order->place[i] = Mix(ports.keys->key[i], BitsOf(ports.baked->a[0][i]));
}

struct Derive : FaultKernel {
  static constexpr std::string_view kName = "derive";
  static void Run(const Params&, const Ports& ports) { DeriveOrder(ports); }
};

// Reads the next chunk's keys, which `advance` changes in the same pass.
struct ReadsMovingNeighbour : FaultKernel {
  static constexpr std::string_view kName = "reads_moving_neighbour";
  static void Run(const Params&, const Ports& ports) {
    DeriveOrder(ports);
    ports.order->place[0] ^= Launder(ports.keys.block)[1].key[0];
  }
};

// Reads the next chunk's baked rows, which nothing writes: no order of execution shows it.
struct ReadsConstantNeighbour : FaultKernel {
  static constexpr std::string_view kName = "reads_constant_neighbour";
  static void Run(const Params&, const Ports& ports) {
    DeriveOrder(ports);
    ports.order->place[0] ^= BitsOf(Launder(ports.baked.block)[1].a[0][0]);
  }
};

struct WritesThroughConstCast : FaultKernel {
  static constexpr std::string_view kName = "writes_through_const_cast";
  static void Run(const Params&, const Ports& ports) {
    DeriveOrder(ports);
    const_cast<KeyBlock*>(Launder(ports.keys.block))->key[3] ^= 1u;
  }
};

// Counts its runs: what an item gets depends on how many ran before it.
struct KeepsStaticState : FaultKernel {
  static constexpr std::string_view kName = "keeps_static_state";
  static inline uint32_t runs = 0;
  static void Run(const Params&, const Ports& ports) {
    DeriveOrder(ports);
    ports.order->place[0] ^= runs++;
  }
};

// Looks at what it declared Out: last frame's order in main memory.
struct ReadsItsOut : FaultKernel {
  static constexpr std::string_view kName = "reads_its_out";
  static void Run(const Params&, const Ports& ports) {
    const uint32_t before = Launder(ports.order.block)->place[0];
    DeriveOrder(ports);
    ports.order->place[0] ^= before;
  }
};

// Writes one lane past its block: the next chunk's first lane in main memory.
struct WritesPastItsBlock : FaultKernel {
  static constexpr std::string_view kName = "writes_past_its_block";
  static void Run(const Params&, const Ports& ports) {
    DeriveOrder(ports);
    Launder(ports.order->place)[kToyLanes] = 7;
  }
};

// Reads the keys of every chunk of its layer, found by going back from its own block, as if `In`
// were `All`: no barrier is derived for that.
struct ReachesAcrossTheLayer : FaultKernel {
  static constexpr std::string_view kName = "reaches_across_the_layer";
  struct Ports {
    In<&Toys::state> state;
    In<&Toys::keys> keys;
    Out<&Toys::order> order;
  };
  static void Run(const Params&, const Ports& ports) {
    const uint32_t place = ports.state->first_place / kToyLanes;
    const KeyBlock* first = Launder(ports.keys.block) - place;
    for (uint32_t i = 0; i < kToyLanes; ++i)
      ports.order->place[i] = Mix(ports.keys->key[i], first->key[i]);
  }
};

// The same wish, declared: the first chunk's keys as the first records of a gather. The plan puts a
// barrier in front.
struct GathersAcrossTheLayer : FaultKernel {
  static constexpr std::string_view kName = "gathers_across_the_layer";
  struct Ports {
    In<&Toys::pairs_a> list;
    In<&Toys::keys> keys;
    Gather<&Toys::keys, &Toys::pairs_a> first;
    Out<&Toys::order> order;
  };
  static void Run(const Params&, const Ports& ports) {
    for (uint32_t i = 0; i < kToyLanes; ++i)
      ports.order->place[i] = Mix(ports.keys->key[i], ports.first[i]);
  }
};

// Scatters every strand to a place of its own; the faulty one gives every chunk the same places.
template <bool kCollide>
struct ScatterStrands : FaultKernel {
  static constexpr std::string_view kName = kCollide ? "scatter_collides" : "scatter_strands";
  struct Ports {
    In<&Toys::state> state;
    In<&Toys::keys> keys;
    Scatter<&Toys::order> order;
  };
  static void Run(const Params&, const Ports& ports) {
    const uint32_t first = kCollide ? 0 : ports.state->first_place;
    for (uint32_t i = 0; i < kToyLanes; ++i)
      ports.order.Put(i, first + (kToyLanes - 1 - i), ports.keys->key[i]);
  }
};

// Sums all lanes of a row. In single floats a sum depends on its order, and so on the lane count;
// the healthy kernel adds one strand after the other for every V.
template <class V, bool kByLanes>
struct SumRow : FaultKernel {
  static constexpr std::string_view kName = kByLanes ? "sum_by_lanes" : "sum_in_order";
  struct Ports {
    In<&Toys::baked> baked;
    InOut<&Toys::keys> keys;
  };
  static void Run(const Params&, const Ports& ports) {
    const float* row = ports.baked->a[0];
    float sum = 0.0f;
    if constexpr (kByLanes) {
      V lanes(0.0f);
      for (uint32_t i = 0; i < kToyLanes; i += V::kLanes) lanes = lanes + V::Load(row + i);
      for (int l = 0; l < V::kLanes; ++l) sum += lanes[l];
    } else {
      for (uint32_t i = 0; i < kToyLanes; ++i) sum += row[i];
    }
    std::memcpy(ports.keys->key, &sum, 4);
  }
};

// a * b + c over rows: two roundings, as written, if the compiler keeps to it.
// planted_contraction.cpp builds it again with contraction allowed; the tag keeps the two functions
// apart.
template <class Tag>
struct MultiplyAdd : FaultKernel {
  static constexpr std::string_view kName = "multiply_add";
  struct Ports {
    In<&Toys::baked> baked;
    Out<&Toys::made> made;
  };
  static void Run(const Params&, const Ports& ports) {
    const RowBlock& r = *ports.baked;
    for (int row = 0; row < 3; ++row)
      for (uint32_t i = 0; i < kToyLanes; ++i) {
        // Loaded first: a sanitizer's checks between the two operations would keep them apart.
        const float a = r.a[row][i], b = r.b[row][i], c = r.c[row][i];
        ports.made->value[row][i] = a * b + c;
      }
  }
};

// planted_contraction.cpp, built with -mfma -ffp-contract=fast; null where the processor has no
// fused multiply-add or the compiler was not asked.
KernelDesc ContractedMultiplyAdd();

}  // namespace pelt::testing
