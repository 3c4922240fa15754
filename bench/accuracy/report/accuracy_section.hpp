// The accuracy sections of the report page: what `pelt accuracy --json` wrote, of solvers or, with
// --scene, of a scene's frames, checked and passed on.
//
// Measuring takes longer than a report may, so the report reads it from a file. Invariant: the file
// comes from outside; only members that are known, of the right type and within limits reach the
// page, and a file that lacks one is an Error that names it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "bench/report/json_text.hpp"

namespace pelt {

inline constexpr uint64_t kAccuracyBytesLimit = 16u << 20;

// Adds one object, or throws. `path` is for messages.
void AddAccuracySection(JsonText& json, std::string_view text, const std::string& path);

}  // namespace pelt
