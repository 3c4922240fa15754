// Where two logs first differ.
//
// Values are compared by their bits, in the order they have in a frame: what comes first in time
// is named first, since all that follows may only follow from it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "traces/digest_log.hpp"
#include "traces/input_log.hpp"

namespace pelt {

struct Difference {
  // From the outside in: {"frame", "3"}, {"stage", "skin"}, {"stream", "skinned"}.
  std::vector<std::pair<std::string, std::string>> place;
  std::string left, right;  // hex; of floats the decimal too
  std::string remark;       // what else there is to know; may be empty
};

// "frame 3, stage skin, stream skinned: 0x... and 0x..."
std::string DescribeDifference(const Difference& difference);

// Value texts: "0x3f800000 (1)".
std::string ShowFloat(uint32_t bits);
std::string ShowDouble(uint64_t bits);
std::string ShowWhole(uint64_t value, int hex_digits);

// Logs of different scenes, chunk capacities or vertex orders differ in their head. Logs whose
// frames list different lines (a layer sorted whole in one, in pieces in the other) are compared in
// the lines both have, the digest of the whole frame among them.
std::optional<Difference> FindDifference(const DigestLog& left, const DigestLog& right);

// Scene names and notes are for people and are not compared. Grooms are compared as bytes: the
// place is then {"character", c}, {"groom byte", offset}.
std::optional<Difference> FindDifference(const InputLog& left, const InputLog& right);

}  // namespace pelt
