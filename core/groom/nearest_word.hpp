// What somebody meant who mistyped a word: for messages.
#pragma once

#include <span>
#include <string_view>

namespace pelt {

// The nearest of `known` to a mistyped word, or empty when none is near.
std::string_view FindNearestWord(std::string_view word, std::span<const std::string_view> known);

}  // namespace pelt
