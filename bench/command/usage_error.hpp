// Arguments that do not go together, reported in our own words: CLI11's own errors end in words of
// theirs ("... is required").
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace pelt {

// Exit code 2, as for every other mistake in the arguments.
struct UsageError : CLI::ParseError {
  explicit UsageError(std::string text)
      : ParseError("UsageError", std::move(text), CLI::ExitCodes::ValidationError) {}
};

}  // namespace pelt
