// What is said to arguments that make no sense.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace pelt {

// Arguments that do not go together, reported in our own words: CLI11's own errors end in words of
// theirs ("... is required"). Exit code 2, as for every other mistake in the arguments.
struct UsageError : CLI::ParseError {
  explicit UsageError(std::string text)
      : ParseError("UsageError", std::move(text), CLI::ExitCodes::ValidationError) {}
};

// Of what `root` threw while it parsed: with the word that was meant, where one is near.
std::string DescribeUsage(const CLI::App& root, const CLI::ParseError& error);

}  // namespace pelt
