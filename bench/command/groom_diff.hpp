// Where two grooms first differ, in the order of the groom file.
#pragma once

#include <optional>

#include "core/groom/groom.hpp"
#include "traces/diff.hpp"

namespace pelt {

// The place names section, item (the chunk or layer), field and lane.
std::optional<Difference> FindDifference(const Groom& left, const Groom& right);

}  // namespace pelt
