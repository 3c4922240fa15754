// How exactly the modal solver steps; substeps are of a frame of 1/60 s. The figures of each stand
// in README.md.
#pragma once

#include <cstdint>

namespace pelt {

enum class ModalQuality : uint8_t {
  kFast,  // one substep, two Newton steps
  kFine,  // three, four where the root's velocities are known
  kBest,  // three, three Newton steps in each, and the constraint force turns within the step
};

}  // namespace pelt
