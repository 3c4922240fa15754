// What may stand between two frames and changes no bit of any frame after it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "bench/verify/lockstep.hpp"

namespace pelt {

enum class Interlude : uint8_t {
  kRefused,   // a frame is refused
  kPause,     // time stands still, and the eye is elsewhere
  kReplaced,  // the grooms are replaced by the same ones
  kMoved,     // another scene goes on from the state
};
inline constexpr uint32_t kInterludes = 4;
std::string_view InterludeName(Interlude what);

// A scene that is run by a case, and may go over to another scene of that case.
struct CaseTurn {
  VerifyCase what;
  std::unique_ptr<CaseRun> run;
  std::string last;  // interlude, and ahead of which frame
};

// Ahead of frame `frame`. What does not happen as it should is returned.
std::optional<Finding> Interrupt(CaseTurn& turn, Interlude interlude, Scenario& scenario,
                                 const FrameSettings& settings, uint32_t frame,
                                 const VerifyOptions& options);

}  // namespace pelt
