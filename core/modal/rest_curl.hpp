// Whether chains rest bent. Where all lie straight, a curl that turns with the strand
// (kernels/modal_curl.hpp) and one that follows the root are the same, and the latter costs less.
#pragma once

#include "core/chunk.hpp"

namespace pelt {

// A joint that rests bent by less than this turns with the root regardless of the setup. By how much
// of the secondary motion the two models differ (calibrated chains, dangly / soft / medium / stiff,
// per cent): at 2 degrees a joint 1 / 2 / 2 / 1, which is what the default quality gets wrong besides;
// at 3 degrees 1 / 4 / 4 / 2, at 5 2 / 13 / 8 / 6, at 10 5 / 26 / 22 / 19, at 20 12 / 55 / 47 / 44.
inline constexpr float kLeastCurl_degrees = 2.0f;

// Some chain with simulation strength has a joint that rests bent by more.
template <uint32_t kPoints>
bool HasCurl(const RestBlock<kPoints>& rest);

}  // namespace pelt
