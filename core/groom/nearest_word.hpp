// What a user meant who mistyped a word: for messages.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pelt {

// Edits (insert, delete, replace, swap of neighbours) between two short words.
size_t CountEdits(std::string_view a, std::string_view b);

// The nearest of `known` to a mistyped word, or empty when none is near.
std::string_view FindNearestWord(std::string_view word, std::span<const std::string_view> known);

// "; did you mean 'monster'?" behind a list of texts, or nothing.
std::string DidYouMean(std::string_view word, const auto& known) {
  const std::vector<std::string_view> names(known.begin(), known.end());
  const std::string_view nearest = FindNearestWord(word, names);
  return nearest.empty() ? std::string() : "; did you mean '" + std::string(nearest) + "'?";
}

}  // namespace pelt
