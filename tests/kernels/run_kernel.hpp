// What the geometry kernels' tests share beyond every_vector.hpp: running a kernel on single blocks
// of the test's own, and comparing rows bit for bit.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <random>

#include "tests/kernels/every_vector.hpp"

namespace pelt::test {

// Runs K on one block for each port, in the order of its ports; `params` are null for a kernel that
// has none.
template <class K, class... Block>
void RunOnBlocks(const void* params, Block&... block) {
  static_assert(sizeof...(Block) == kMemberCount<typename K::Ports>);
  const Binding bindings[] = {{const_cast<void*>(static_cast<const void*>(&block)), nullptr, 1}...};
  KernelTraits<K>::Run(params, bindings);
}

// What an executor's poisoned memory holds: reading it gives NaN.
template <class Block>
void Poison(Block& block) {
  std::memset(static_cast<void*>(&block), 0xff, sizeof block);
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

}  // namespace pelt::test
