// What a page shows, as the text that the program writes into it and its module reads.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/scenarios/scenarios.hpp"

namespace pelt {

// Options of `pelt run` by their names without dashes, and the values that the request has for them.
std::vector<std::pair<std::string_view, std::string>> RequestOptions(
    const ScenarioRequest& request);
// As TOML; and back, with `setup_texts` besides. Throws Error for what is no such text.
std::string WriteRequest(const ScenarioRequest& request);
ScenarioRequest ReadRequest(std::string_view text);

}  // namespace pelt
