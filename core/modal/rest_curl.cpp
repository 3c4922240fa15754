#include "core/modal/rest_curl.hpp"

#include "core/exact_math.hpp"
#include "core/float_rules.hpp"

namespace pelt {

template <uint32_t kPoints>
bool HasCurl(const RestBlock<kPoints>& rest) {
  const float straight = float(exact::Cos(double(kLeastCurl_degrees) * exact::kRadiansPerDegree));
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    if (!(rest.strength[lane] > 0.0f)) continue;
    float last[3] = {}, before[3] = {};  // link and point
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      float turn = 0.0f;
      for (int k = 0; k < 3; ++k) {
        const float link = rest.offset[i][k][lane] - before[k];
        before[k] = rest.offset[i][k][lane];
        turn += link * last[k];
        last[k] = link;
      }
      const float length = rest.segment_length[lane];
      if (i > 0 && turn < straight * length * length) return true;
    }
  }
  return false;
}

template bool HasCurl(const RestBlock<4>&);
template bool HasCurl(const RestBlock<5>&);
template bool HasCurl(const RestBlock<9>&);

}  // namespace pelt
