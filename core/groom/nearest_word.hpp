// What somebody meant who mistyped a word: for messages.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace pelt {

// Edits (insert, delete, replace, swap of neighbours) between two short words.
size_t CountEdits(std::string_view a, std::string_view b);

// The nearest of `known` to a mistyped word, or empty when none is near.
std::string_view FindNearestWord(std::string_view word, std::span<const std::string_view> known);

}  // namespace pelt
