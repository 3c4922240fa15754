// .rept N ... .endr of a listing, written out as the assembler would: a loop that is unrolled by
// hand is written so.
//
// Invariant: every statement keeps the line that it stands on, and there are never more than
// kMaxListingStatements, regardless of what the counts multiply to.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform_sim/pipeline/listing_text.hpp"

namespace pelt {

inline constexpr uint32_t kMaxListingStatements = 1u << 20;

// Nothing, and the reason in `error` with its place in `line`, for a count that is none, too many
// statements, or a .rept and a .endr that do not belong to each other.
std::optional<std::vector<Statement>> WriteOutRepeats(std::vector<Statement> statements,
                                                      std::string& error, uint32_t& line);

}  // namespace pelt
