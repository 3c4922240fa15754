// What code for a console uses and Pelt's own kernels do not, for any vector value V: estimates
// without a Newton step, and a number of memory on all lanes.
//
// A type that records takes each as one operation (recording_vec.hpp); others compute it exactly,
// so a kernel written with these can be run anywhere.
#pragma once

#include <cstdint>

#include "core/simd/maths.hpp"
#include "core/simd/words.hpp"

namespace pelt {

template <class V>
V ReciprocalEstimate(V a) {
  if constexpr (requires { V::ReciprocalEstimate(a); })
    return V::ReciprocalEstimate(a);
  else
    return V(1.0f) / a;
}
template <class V>
V ReciprocalRootEstimate(V a) {
  if constexpr (requires { V::ReciprocalRootEstimate(a); })
    return V::ReciprocalRootEstimate(a);
  else
    return Rsqrt(a);
}

// base[index] on all lanes; the index is a word of V or a plain number.
template <class V, class Index>
V LoadSplat(const float* base, Index index) {
  if constexpr (requires { V::LoadSplat(base, index); })
    return V::LoadSplat(base, index);
  else
    return V(base[index]);
}

}  // namespace pelt
