// How exactly the modal solver steps, from cheapest to most exact. The figures of each stand in
// modal_table.hpp.
#pragma once

#include <cstdint>

namespace pelt {

enum class ModalQuality : uint8_t {
  kFast,     // one step per frame
  kDefault,  // two
  kBest,     // two, three Newton steps, and the constraint force turns within the step
};

}  // namespace pelt
