#include "platform_sim/frame/modelled_frame.hpp"

namespace pelt {

std::string_view UnitWorkName(UnitWork work) {
  constexpr std::string_view kNames[kUnitWorkCount] = {
      "dispatch", "commands", "code", "get stall", "compute", "put stall", "imbalance", "barrier"};
  return kNames[size_t(work)];
}

}  // namespace pelt
